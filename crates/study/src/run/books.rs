//! The books of a run: what is kept of every sample, and what it comes to.

use machine::Machine;
use rotor::{ControlMasses, Peaks};

use super::{Final, Observer, Outcome, Plan, Settle};
use crate::disturbance::DisturbanceGrowth;
use crate::settle::{Detector, Settled, Stretch};

/// An orbit this wide is taken for divergence, in `e_t`, beside a thousand times the largest clearance.
const DIVERGED: f64 = 1e6;

/// The radius beyond which a run has diverged, in `e_t`.
pub(crate) fn orbit_limit(plan: &Plan) -> f64 {
    DIVERGED + 1e3 * plan.program.clearances().iter().copied().fold(0.0, f64::max)
}

/// How long the windows are in which a run is looked at: whole turns.
pub(crate) fn window_of(plan: &Plan) -> f64 {
    let turn = std::f64::consts::TAU / plan.program.speed().abs();
    // Rest needs no turns; a crawling spin is cut off.
    let window = if turn.is_finite() { (turn * (8.0 / turn).ceil()).min(200.0) } else { 8.0 };
    window.max(8.0)
}

/// Whether transients had died, and the stretch that maxima are of, which `rest` ends.
pub(crate) fn kept(settle: Settle, detector: &Detector, rest: Stretch, has_diverged: bool) -> (Settled, Stretch) {
    let (settled, kept) = match settle {
        Settle::From(from) => (Settled::Given, Stretch { from, ..rest }),
        Settle::Detect | Settle::DetectAndStop => {
            let (settled, windows) = detector.result();
            (settled, windows.map_or(rest, |windows| windows.joined(&rest)))
        }
    };
    (if has_diverged && settled != Settled::Given { Settled::No } else { settled }, kept)
}

/// The books of a run.
pub(super) struct Books {
    pub(super) masses: usize,
    control_masses: ControlMasses,
    settle: Settle,
    /// Before this nothing counts.
    begins: f64,
    window: f64,
    limit_squared: f64,
    stretch: Stretch,
    pub(super) peaks: Peaks,
    detector: Detector,
    pub(super) steps: u64,
    saturated_steps: u64,
    pub(super) step: (f64, f64),
    pub(super) diverged_at: Option<f64>,
}

impl Books {
    pub(super) fn new(plan: &Plan) -> Self {
        let masses = plan.program.order();
        let begins = match plan.settle {
            Settle::From(from) => from,
            Settle::Detect => 0.0,
            Settle::DetectAndStop => {
                let felt = plan.impulses.iter().map(|impulse| impulse.at).filter(|at| *at <= plan.duration);
                felt.fold(0.0, f64::max)
            }
        };
        Self {
            masses,
            begins,
            control_masses: *plan.program.control_masses(),
            settle: plan.settle,
            window: window_of(plan),
            limit_squared: orbit_limit(plan).powi(2),
            stretch: Stretch::new(if plan.settle == Settle::DetectAndStop { begins } else { 0.0 }),
            peaks: Peaks::new(3 + masses),
            detector: Detector::new(masses),
            steps: 0,
            saturated_steps: 0,
            step: (0.0, 0.0),
            diverged_at: None,
        }
    }

    /// Takes one sample; whether the run goes on.
    pub(super) fn see(&mut self, rotor: &Machine, observers: &mut [&mut dyn Observer]) -> std::io::Result<bool> {
        let motion = rotor.motion();
        let outputs = rotor.outputs();
        self.saturated_steps += u64::from(outputs.iter().any(|output| output.saturated));
        let mut samples = [0.0; 3 + rotor::MAX_MASSES];
        for (bearing, output) in outputs.iter().enumerate() {
            let u = output.delivered * self.control_masses.as_of_first(bearing, 1.0);
            // Of several control bearings the largest; what is not a number must not be lost in it.
            for (place, square) in samples.iter_mut().zip([u.norm_sqr(), u.re * u.re, u.im * u.im]) {
                *place = if square.is_nan() { square } else { place.max(square) };
            }
        }
        let mut widest = 0.0_f64;
        for (sample, p) in samples[3..].iter_mut().zip(motion.displacement) {
            *sample = p.norm_sqr();
            widest = if sample.is_nan() { f64::INFINITY } else { widest.max(*sample) };
        }
        let bounded = widest <= self.limit_squared && samples[0].is_finite();
        if !bounded {
            self.diverged_at = Some(motion.tau);
        }
        if bounded && motion.tau >= self.begins - 1e-9 {
            let all = 3 + self.masses;
            self.peaks.push(&samples[..all], &mut self.stretch.maxima[..all]);
            for (sum, squared) in self.stretch.radius_sum.iter_mut().zip(&samples[3..all]) {
                *sum += squared.sqrt();
            }
            self.stretch.samples += 1;
        }
        if !observers.is_empty() && motion.is_finite() {
            observers.iter_mut().try_for_each(|observer| observer.sample(rotor))?;
        }
        if !matches!(self.settle, Settle::From(_)) && motion.tau >= self.stretch.from + self.window {
            let window = std::mem::replace(&mut self.stretch, Stretch::new(motion.tau));
            let settled = self.detector.push(window);
            if settled && self.settle == Settle::DetectAndStop {
                return Ok(false);
            }
        }
        Ok(bounded)
    }

    /// Whether transients had died, and the stretch that maxima are of.
    pub(super) fn kept(&self) -> (Settled, Stretch) {
        kept(self.settle, &self.detector, self.stretch, self.diverged_at.is_some())
    }

    pub(super) fn outcome(&self, rotor: &Machine, centre: Option<DisturbanceGrowth>) -> Outcome {
        let motion = rotor.motion();
        let (steps, saturated_steps, step) = (self.steps, self.saturated_steps, self.step);
        let (masses, diverged_at) = (self.masses, self.diverged_at);
        let (settled, kept) = self.kept();
        Outcome {
            steps,
            saturated_steps,
            step,
            diverged_at,
            settled,
            stability: None,
            centre,
            maxima_from: kept.from,
            max_force: kept.maxima[0].sqrt(),
            // Each maximum is that of a curve through samples: where one bends sharply, a part must not pass the whole.
            max_force_component: kept.maxima[1].max(kept.maxima[2]).min(kept.maxima[0]).sqrt(),
            max_displacement: kept.maxima[3..3 + masses].iter().map(|m| m.sqrt()).collect(),
            mean_radius: (0..masses).map(|k| kept.mean_radius(k)).collect(),
            last: Final {
                tau: motion.tau,
                speed: rotor.sample().speed,
                displacement: motion.displacement.to_vec(),
                velocity: motion.velocity.to_vec(),
            },
        }
    }
}
