//! Margins of a machine at one speed: its loop, whatever parts are on, opened at the command of each of its control bearings in turn.
//!
//! Everything counts every support bearing at its full stiffness, as poles do. Noise, resolution and limits play no part.

use control::{Feedback, LinearLoop};
use linear::peak::top;
use linear::{
    AmplitudePeak, CertifiedPeak, DelayError, DelayMargin, DelaySystem, GainMargin, LoopGain, Margins, SeveralLoops,
};
use rotor::{C64, Characteristic, ControlMasses, LinearForm, OperatingPoint, Plant, Rotor, Settings};

use crate::poles::PolesError;

/// How far left of the first crossing a delay margin of samples is looked for, in periods.
const STEPS_PER_PERIOD: f64 = 8.0;
/// States of the largest loop that is proven anything of: the matrix of a level has twice as many.
const MOST_CERTIFIED: usize = 100;
/// How far above what was found the bound of a sensitivity with a delay is, relative to it.
const CERTIFIED_WITHIN: f64 = 1e-3;
/// The longest delay of a sampled loop that is looked at, in periods.
const MOST_PERIODS: f64 = 60.0;

/// Why there are no margins.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MarginsError {
    /// The loop is not stable.
    #[error("the machine is not stable at R = {speed}: it has a pole at {re} {im:+} j, so its loop has no margins", re = pole.re, im = pole.im)]
    Unstable {
        /// The speed.
        speed: f64,
        /// Its rightmost pole.
        pole: C64,
    },
    /// Poles that cannot be had.
    #[error(transparent)]
    Poles(#[from] PolesError),
}

impl From<DelayError> for MarginsError {
    fn from(error: DelayError) -> Self {
        Self::Poles(error.into())
    }
}

impl From<control::FeedbackError> for MarginsError {
    fn from(error: control::FeedbackError) -> Self {
        Self::Poles(error.into())
    }
}

/// A machine's margins at one speed.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineMargins {
    /// The speed.
    pub speed: f64,
    /// Its poles, all of them that are found.
    pub poles: Vec<C64>,
    /// The margins of its loop. Of several control bearings, each opened with the others closed, the worst of each; but the delay is
    /// one in all commands at once, and the curve is that of the bearing with the largest sensitivity.
    pub margins: Margins,
    /// The largest force `|u|` per noise in the displacement that the sensors read, over all ways to spread noise of size 1
    /// over them; the velocities that they read are clean. The largest of all control bearings.
    pub force: AmplitudePeak,
    /// Each control bearing, opened with the others closed.
    pub bearings: Vec<BearingMargins>,
    /// What several bearings have together; `None` of one.
    pub together: Option<SeveralLoops>,
}

/// The margins of one control bearing, the others closed.
#[derive(Clone, Debug, PartialEq)]
pub struct BearingMargins {
    /// Its margins; the delay is one in its own command alone.
    pub margins: Margins,
    /// The largest force per noise: see [`MachineMargins::force`].
    pub force: AmplitudePeak,
}

/// A machine's loop at one speed, opened at the command of one of its control bearings.
#[derive(Clone, Debug)]
pub struct MachineLoop {
    plant: Plant,
    /// Which of the control bearings is opened.
    bearing: usize,
    /// The station that carries it.
    station: usize,
    form: LinearForm,
    around: LinearLoop,
    /// The gain.
    pub gain: LoopGain,
}

impl MachineLoop {
    /// The loop of `rotor` under `settings` at a speed, opened at its first control bearing.
    ///
    /// # Errors
    /// A loop that does not fit, or eigenvalues that cannot be had.
    pub fn at(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<Self, MarginsError> {
        Ok(Self::each(rotor, settings, speed)?.remove(0))
    }

    /// The same opened at each of its control bearings, the others closed: at least one.
    ///
    /// # Errors
    /// A loop that does not fit, or eigenvalues that cannot be had.
    pub fn each(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<Vec<Self>, MarginsError> {
        Self::of_plant(&Plant::of(rotor), &settings.feedback, &OperatingPoint::at(speed))
    }

    /// The same of any plant at any operating point.
    fn of_plant(plant: &Plant, feedback: &Feedback, at: &OperatingPoint) -> Result<Vec<Self>, MarginsError> {
        let form = LinearForm::of(plant, feedback, at)?;
        let gains = match (form.sampled(), form.continuous()) {
            (Some(step), _) => LoopGain::each_sampled(step.open, &step.b, &step.c, step.period)?,
            (None, Some([a, b, c])) => LoopGain::each(&DelaySystem::new(a, b, c, form.delay)?)?,
            (None, None) => unreachable!("a loop is sampled or continuous"),
        };
        let opened = feedback.bearings.iter().zip(gains).enumerate().map(|(bearing, (of, gain))| {
            let around = LinearLoop::new(of, plant.stations().len(), at.speed)?;
            Ok(Self { plant: plant.clone(), bearing, station: of.station, form: form.clone(), around, gain })
        });
        opened.collect()
    }

    /// The rotor without control.
    #[must_use]
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Which of the control bearings is opened, counted from 0.
    #[must_use]
    pub fn bearing(&self) -> usize {
        self.bearing
    }

    /// The station that carries it.
    #[must_use]
    pub fn station(&self) -> usize {
        self.station
    }

    /// The matrices.
    #[must_use]
    pub fn form(&self) -> &LinearForm {
        &self.form
    }

    /// The peak of the sensitivity with what no frequency exceeds, within about 1e-3 where there is a delay; nothing of a sampled loop.
    ///
    /// # Errors
    /// Eigenvalues that cannot be had, or a pole on the axis.
    pub fn certified_peak(&self) -> Result<Option<CertifiedPeak>, MarginsError> {
        let Some([a, b, c]) = self.form.continuous().filter(|[a, ..]| a.nrows() <= MOST_CERTIFIED) else {
            return Ok(None);
        };
        Ok(Some(DelaySystem::new(a, b, c, self.form.delay)?.certified_peak(CERTIFIED_WITHIN)?))
    }

    /// The largest amplification from noise of displacement readings to force, without the loop's feedback, at a frequency.
    #[must_use]
    pub fn noise_to_force(&self, frequency: f64) -> f64 {
        let clean = self.around.of_displacement(frequency);
        clean.map_or(f64::NAN, |row| row.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt())
    }

    /// The force `|u|` of this bearing per noise of size 1 in the displacements that its sensors read, at a frequency, the loop closed.
    #[must_use]
    pub fn force_per_noise(&self, frequency: f64) -> f64 {
        self.noise_to_force(frequency) * self.gain.at(frequency).sensitivity().norm()
    }

    /// The peak of force per noise, on the curve of its gain.
    fn force_peak(&self, curve: &[linear::FrequencyGain]) -> AmplitudePeak {
        let of = |w: f64| self.force_per_noise(w);
        let values: Vec<f64> =
            curve.iter().map(|p| self.noise_to_force(p.frequency) * p.sensitivity().norm()).collect();
        let best =
            (0..values.len()).filter(|k| values[*k].is_finite()).max_by(|a, b| values[*a].total_cmp(&values[*b]));
        let Some(best) = best else { return AmplitudePeak { amplitude: f64::NAN, frequency: None } };
        if best == 0 || best + 1 == values.len() {
            return AmplitudePeak { amplitude: values[best], frequency: None };
        }
        let w = top(curve[best - 1].frequency, curve[best + 1].frequency, of);
        AmplitudePeak { amplitude: of(w).max(values[best]), frequency: Some(w) }
    }
}

/// All margins of `rotor` under `settings` at a speed.
///
/// # Errors
/// A machine that is not stable there, with its rightmost pole, or poles that cannot be had.
pub fn margins(rotor: &Rotor, settings: &Settings, speed: f64) -> Result<MachineMargins, MarginsError> {
    let each = MachineLoop::each(rotor, settings, speed)?;
    let roots = Characteristic::of(&each[0].form)?.roots()?;
    if let Some(worst) = roots.iter().max_by(|a, b| a.pole.re.total_cmp(&b.pole.re)).filter(|root| root.pole.re >= 0.0)
    {
        return Err(MarginsError::Unstable { speed, pole: worst.pole });
    }
    let poles = roots.iter().map(|root| root.pole).collect();
    let LoopMargins { margins, bearings, together } =
        of_loops(&each, &Plant::of(rotor), &settings.feedback, &OperatingPoint::at(speed))?;
    let larger = |a: AmplitudePeak, b: AmplitudePeak| if b.amplitude > a.amplitude { b } else { a };
    let masses = ControlMasses::of(rotor, &settings.feedback);
    let forces = bearings
        .iter()
        .enumerate()
        .map(|(k, of)| AmplitudePeak { amplitude: masses.as_of_first(k, of.force.amplitude), ..of.force });
    let force = forces.reduce(larger).unwrap_or(none());
    Ok(MachineMargins { speed, poles, margins, force, bearings, together })
}

/// The margins of a loop that is known to be stable.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopMargins {
    /// Of the whole: see [`MachineMargins::margins`].
    pub margins: Margins,
    /// Of each control bearing, opened with the others closed.
    pub bearings: Vec<BearingMargins>,
    /// What several bearings have together; `None` of one.
    pub together: Option<SeveralLoops>,
}

/// The margins of a plant under some feedback at an operating point at which it is known to be stable: all that judges margins does it
/// here.
///
/// # Errors
/// A loop that does not fit, or eigenvalues that cannot be had.
pub fn loop_margins(plant: &Plant, feedback: &Feedback, at: &OperatingPoint) -> Result<LoopMargins, MarginsError> {
    of_loops(&MachineLoop::of_plant(plant, feedback, at)?, plant, feedback, at)
}

fn of_loops(
    each: &[MachineLoop],
    plant: &Plant,
    feedback: &Feedback,
    at: &OperatingPoint,
) -> Result<LoopMargins, MarginsError> {
    let bearings: Vec<BearingMargins> = (each.iter())
        .map(|machine| {
            let margins = machine.gain.margins();
            BearingMargins { force: machine.force_peak(&margins.curve), margins }
        })
        .collect();
    let together = match each.len() {
        1 => None,
        _ => Some(SeveralLoops::of(&each.iter().map(|machine| machine.gain.clone()).collect::<Vec<_>>())?),
    };
    let mut margins = worst_of(&bearings);
    if let Some(together) = &together {
        margins.delay = together.delay;
    }
    if each[0].gain.period() > 0.0 {
        margins.delay = sampled_delay(plant, feedback, at)?;
    }
    Ok(LoopMargins { margins, bearings, together })
}

fn none() -> AmplitudePeak {
    AmplitudePeak { amplitude: f64::NAN, frequency: None }
}

/// The worst of each margin among the bearings, with the curve of the most sensitive.
fn worst_of(bearings: &[BearingMargins]) -> Margins {
    let all = || bearings.iter().map(|of| &of.margins);
    let most = |of: fn(&Margins) -> AmplitudePeak| {
        all().map(of).reduce(|a, b| if b.amplitude > a.amplitude { b } else { a }).unwrap_or(none())
    };
    let curve = all().max_by(|a, b| a.sensitivity().amplitude.total_cmp(&b.sensitivity().amplitude));
    let nearest = |of: fn(&Margins) -> Option<GainMargin>| {
        all().filter_map(of).min_by(|a, b| (a.factor - 1.0).abs().total_cmp(&(b.factor - 1.0).abs()))
    };
    Margins {
        delay: all().filter_map(|m| m.delay).min_by(|a, b| a.delay.total_cmp(&b.delay)),
        gain_up: nearest(|m| m.gain_up),
        gain_down: nearest(|m| m.gain_down),
        phase: all().filter_map(|m| m.phase).min_by(|a, b| a.angle.total_cmp(&b.angle)),
        forward: most(|m| m.forward),
        backward: most(|m| m.backward),
        axis: most(|m| m.axis),
        complementary: most(|m| m.complementary),
        curve: curve.map_or_else(Vec::new, |m| m.curve.clone()),
    }
}

/// What delay more a sampled loop bears: its step is made anew for each, as a delay shifts when a held command acts.
fn sampled_delay(plant: &Plant, feedback: &Feedback, at: &OperatingPoint) -> Result<Option<DelayMargin>, MarginsError> {
    let (own, period) = (feedback.delay(), feedback.sample());
    // The outermost root, with `more` delay.
    let outermost = |more: f64| -> Result<C64, MarginsError> {
        let mut feedback = feedback.clone();
        feedback.set_delay(own + more);
        let form = LinearForm::of(plant, &feedback, at)?;
        let roots = Characteristic::of(&form)?.roots()?;
        let outermost = roots.iter().map(|root| root.root).max_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr()));
        Ok(outermost.unwrap_or(C64::ZERO))
    };
    let step = period / STEPS_PER_PERIOD;
    let mut low = 0.0;
    while outermost(low + step)?.norm() < 1.0 {
        low += step;
        if low > MOST_PERIODS * period {
            return Ok(None);
        }
    }
    let mut high = low + step;
    while high - low > 1e-14 * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if outermost(middle)?.norm() < 1.0 { low = middle } else { high = middle }
    }
    Ok(Some(DelayMargin { delay: low, frequency: outermost(high)?.arg() / period }))
}
