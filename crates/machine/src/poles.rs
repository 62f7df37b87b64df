//! Poles of a machine as it is: ideal, with states of its own in the loop, late, or sampled.
//!
//! * An ideal loop has the rotor's own `2n` poles, by the fast path of crate `rotor`.
//! * A continuous loop has those of the joined matrix; with a delay, infinitely many: all right of a stated line are given,
//!   proven complete by crate `linear`.
//! * A sampled loop has poles `z` of the step from one sample to the next; `s = ln(z) / h` says how fast they decay and turn.

use linear::{DelayError, DelaySystem};
use nalgebra::DMatrix;
use rotor::{C64, ClosedLoop, Mode, OperatingPoint, Plant, PoleError, Rotor, Settings, Spectrum, damping_ratio};

use rotor::LinearForm;

/// What is over within a sample is no motion: poles `z` smaller than this have no `s` to speak of.
const OVER_AT_ONCE: f64 = 1e-9;
/// Last places a state that rounding may cost.
const LAST_PLACES: f64 = 64.0;

/// Why there are no poles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PolesError {
    /// The loop does not fit the rotor.
    #[error(transparent)]
    Feedback(#[from] control::FeedbackError),
    /// Eigenvalues that cannot be had.
    #[error(transparent)]
    Poles(#[from] PoleError),
    /// Roots that cannot be had, all of them.
    #[error(transparent)]
    Roots(#[from] DelayError),
    /// Orbits that cannot be had.
    #[error(transparent)]
    Orbits(#[from] rotor::circular::CircularError),
}

/// The poles of a machine at one speed, every support bearing at its full stiffness.
#[derive(Clone, Debug, PartialEq)]
pub struct MachinePoles {
    /// The modes, least damped first; shapes are displacements of the masses.
    pub modes: Vec<Mode>,
    /// Of a sampled loop, the pole `z` of each mode.
    pub z: Option<Vec<C64>>,
    /// The line right of which all poles are here, where there are infinitely many.
    pub right_of: Option<f64>,
}

impl MachinePoles {
    /// The poles of `rotor` under `settings`, at their speed.
    ///
    /// # Errors
    /// A loop that does not fit, or poles that cannot be had.
    pub fn of(rotor: &Rotor, settings: &Settings) -> Result<Self, PolesError> {
        Self::at(rotor, settings, settings.speed)
    }

    /// The same at another speed.
    ///
    /// # Errors
    /// A loop that does not fit, or poles that cannot be had.
    pub fn at(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<Self, PolesError> {
        let feedback = &settings.feedback;
        if feedback.is_ideal() {
            let closed_loop = ClosedLoop::new(rotor, feedback, speed, &settings.deadband);
            return Ok(Self { modes: Spectrum::of(&closed_loop)?.modes, z: None, right_of: None });
        }
        let form = LinearForm::of(&Plant::of(rotor), feedback, &OperatingPoint::at(speed))?;
        let machine = Characteristic::of(&form)?;
        let n = form.coordinates;
        let mode = |pole: C64, root: C64| {
            let state = machine.system.sensitivity(root).map(|vectors| vectors.right);
            let mut shape: Vec<C64> = state.map_or_else(Vec::new, |state| state.iter().take(n).copied().collect());
            rotor::scale_to_largest(&mut shape);
            Mode { pole, shape }
        };
        let roots = machine.roots()?;
        let mut modes: Vec<(Mode, C64)> = roots.iter().map(|root| (mode(root.pole, root.root), root.root)).collect();
        modes.sort_by(|(a, _), (b, _)| {
            a.damping().total_cmp(&b.damping()).then_with(|| b.pole.im.total_cmp(&a.pole.im))
        });
        let z = machine.period.map(|_| modes.iter().map(|(_, z)| *z).collect());
        Ok(Self { modes: modes.into_iter().map(|(mode, _)| mode).collect(), z, right_of: machine.right_of })
    }

    /// The same in a form that knows only modes.
    #[must_use]
    pub fn spectrum(self) -> Spectrum {
        Spectrum { modes: self.modes }
    }
}

/// A root of a machine's characteristic equation, and the pole that it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Root {
    /// `s`, or `z` of a sampled loop: what moves continuously when the speed does.
    pub(crate) root: C64,
    /// `s`.
    pub(crate) pole: C64,
}

/// A machine's characteristic equation.
pub(crate) struct Characteristic {
    system: DelaySystem,
    /// Sampling period, if its roots are `z`.
    period: Option<f64>,
    right_of: Option<f64>,
    /// What a real part may be by rounding alone.
    rounding: f64,
}

impl Characteristic {
    pub(crate) fn of(form: &LinearForm) -> Result<Self, PolesError> {
        let none = |n: usize| (DMatrix::zeros(n, 0), DMatrix::zeros(0, n));
        let rounding = |a: &DMatrix<C64>| LAST_PLACES * f64::EPSILON * a.nrows() as f64 * a.norm();
        if let Some(step) = form.sampled() {
            let (b, c) = none(step.a.nrows());
            let rounding = rounding(&step.a) / step.period;
            let system = DelaySystem::new(step.a, b, c, 0.0)?;
            return Ok(Self { system, period: Some(step.period), right_of: None, rounding });
        }
        let Some([a, b, c]) = form.continuous() else { unreachable!("a loop is sampled or continuous") };
        let rounding = rounding(&(&a + &b * &c));
        let system = DelaySystem::new(a, b, c, form.delay)?;
        let right_of = (form.delay > 0.0).then(|| system.echo_line());
        Ok(Self { system, period: None, right_of, rounding })
    }

    /// The line right of which its roots are found, where there are infinitely many.
    pub(crate) fn right_of(&self) -> Option<f64> {
        self.right_of
    }

    /// What a real part may be by rounding alone.
    pub(crate) fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Its roots, all of them, or all right of the line.
    pub(crate) fn roots(&self) -> Result<Vec<Root>, PolesError> {
        let found = self.system.roots_right_of(self.right_of.unwrap_or(f64::NEG_INFINITY))?.roots;
        let pole = |root: C64| match self.period {
            Some(period) => root.ln() / period,
            None => root,
        };
        let settled = |s: C64| C64::new(if s.re.abs() <= self.rounding { 0.0 } else { s.re }, s.im);
        Ok(found
            .into_iter()
            .filter(|root| self.period.is_none() || root.norm() > OVER_AT_ONCE)
            .map(|root| Root { root, pole: settled(pole(root)) })
            .collect())
    }
}

/// The smallest damping ratio of `rotor` under `settings` at a speed.
///
/// # Errors
/// A loop that does not fit, or poles that cannot be had.
pub fn min_damping(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<f64, PolesError> {
    let feedback = &settings.feedback;
    if feedback.is_ideal() {
        let poles = rotor::poles(&ClosedLoop::new(rotor, feedback, speed, &settings.deadband))?;
        return Ok(poles.first().map_or(f64::NAN, |pole| damping_ratio(*pole)));
    }
    let form = LinearForm::of(&Plant::of(rotor), feedback, &OperatingPoint::at(speed))?;
    let roots = Characteristic::of(&form)?.roots()?;
    Ok(roots.iter().map(|root| damping_ratio(root.pole)).fold(f64::INFINITY, f64::min))
}
