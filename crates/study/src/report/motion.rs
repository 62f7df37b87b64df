//! The report's simulations: from rest, kept as a trajectory.

use std::io;
use std::sync::atomic::AtomicBool;

use machine::Machine;
use rotor::step::Fastest;
use rotor::{C64, ClosedLoop, Feedback, Rotor};

use super::ReportError;
use crate::run::{self, Impulse, Observer, Outcome, Plan, Settle, Settled};
use crate::spectrum::{self, Collector, Peak, Spectrum};

/// One simulation, as the report's figures show them.
#[derive(Clone, Copy)]
pub(super) struct Case<'a> {
    pub rotor: &'a Rotor,
    pub feedback: &'a Feedback,
    pub speed: f64,
    /// Clearance of every support bearing.
    pub deadband: f64,
    /// A change of velocity of mass 1 at the start.
    pub impulse: C64,
    pub duration: f64,
    pub settle: Settle,
    /// A trajectory is kept until here.
    pub keep_until: f64,
    /// And from here on, counted back from the end.
    pub keep_last: f64,
    /// The spectrum of mass 1 once transients have died.
    pub spectrum: bool,
}

/// What came out.
pub(super) struct Record {
    pub speed: f64,
    pub deadband: f64,
    /// Every sample that was kept, in time; a gap where nothing was.
    pub samples: Vec<Sample>,
    pub outcome: Outcome,
    pub spectrum: Option<(Spectrum, Vec<Peak>)>,
}

/// One moment.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub tau: f64,
    pub displacement: Vec<C64>,
    pub control: C64,
}

/// Keeps one sample in `stride` of two stretches of time.
struct StridedSamples {
    stride: u64,
    seen: u64,
    until: f64,
    from: f64,
    samples: Vec<Sample>,
}

impl Observer for StridedSamples {
    fn sample(&mut self, machine: &Machine) -> io::Result<()> {
        let (motion, control) = (machine.motion(), machine.outputs()[0].delivered);
        let wanted = motion.tau <= self.until + 1e-9 || motion.tau >= self.from - 1e-9;
        if wanted && self.seen.is_multiple_of(self.stride) {
            self.samples.push(Sample { tau: motion.tau, displacement: motion.displacement.to_vec(), control });
        }
        self.seen += 1;
        Ok(())
    }
}

impl Case<'_> {
    /// Simulates it.
    ///
    /// # Errors
    /// Eigenvalues that do not converge, too little motion for a spectrum, or `stop`.
    pub(super) fn run(&self, stop: &AtomicBool) -> Result<Record, ReportError> {
        let clearances = vec![self.deadband; self.rotor.len()];
        let steady = Plan::steady(self.rotor, self.feedback, self.speed, &clearances, self.duration, self.settle)?;
        let plan = Plan { impulses: vec![Impulse { mass: 0, change: self.impulse, at: 0.0 }], ..steady };
        let closed_loop = ClosedLoop::new(self.rotor, self.feedback, self.speed, &clearances);
        let fastest = Fastest::of(&closed_loop)?;
        // A tenth of a radian of the fastest turn between samples: a smooth line.
        let stride = (0.1 / (plan.dtau * fastest.frequency())).max(1.0) as u64;
        let mut kept = StridedSamples {
            stride,
            seen: 0,
            until: self.keep_until,
            from: self.duration - self.keep_last,
            samples: Vec::new(),
        };
        let mut collector = Collector::new(0, 2 * stride, 0.0);
        let mut observers: Vec<&mut dyn Observer> = vec![&mut kept];
        if self.spectrum {
            observers.push(&mut collector);
        }
        let outcome = run::run(&plan, &mut observers, stop)?;
        let spectrum = if self.spectrum {
            let (samples, apart) = collector.samples_from(outcome.maxima_from);
            let spectrum = spectrum::welch(samples, apart, spectrum::segment_length(samples.len()))?;
            let peaks = spectrum.peaks(self.speed);
            Some((spectrum, peaks))
        } else {
            None
        };
        Ok(Record { speed: self.speed, deadband: self.deadband, samples: kept.samples, outcome, spectrum })
    }
}

/// How far off the maxima of a run may be, relatively: the integration is off by a few millionths; of what beats, two long
/// stretches of time agree to a thousandth; of what has not settled nothing is sure.
pub(super) fn off(settled: Settled) -> f64 {
    match settled {
        Settled::Steady | Settled::Given => 5e-6,
        Settled::Beating => 1e-3,
        Settled::No => 1.0,
    }
}

impl Record {
    /// Samples from `from` to `to`, of one mass, counted from 0.
    pub(super) fn orbit(&self, mass: usize, from: f64, to: f64) -> Vec<(f64, f64)> {
        let within = self.samples.iter().filter(|s| (from - 1e-9..=to + 1e-9).contains(&s.tau));
        within.map(|s| (s.displacement[mass].re, s.displacement[mass].im)).collect()
    }

    /// The largest radius of one mass among the samples from `from` to `to`.
    pub(super) fn widest(&self, mass: usize, from: f64, to: f64) -> f64 {
        self.orbit(mass, from, to).into_iter().map(|(y, z)| y.hypot(z)).fold(0.0, f64::max)
    }

    /// When the last sample was.
    pub(super) fn end(&self) -> f64 {
        self.outcome.last.tau
    }

    /// Whether mass 1 whirls slower than the spin over what was kept last: by its mean angle a unit of time.
    pub(super) fn is_subsynchronous(&self) -> bool {
        let from = self.end() - 100.0;
        let kept: Vec<&Sample> = self.samples.iter().filter(|s| s.tau >= from).collect();
        let angle: f64 = kept.windows(2).map(|w| (w[1].displacement[0] * w[0].displacement[0].conj()).arg()).sum();
        let time = kept.last().map_or(0.0, |last| last.tau - kept[0].tau);
        time > 0.0 && (angle / time).abs() < 0.95 * self.speed
    }

    /// How far off its maxima and means may be, relative to the largest of them.
    pub(super) fn off(&self) -> f64 {
        off(self.outcome.settled)
    }

    /// The part of the power of mass 1 that lies at whirl frequencies between 5 and 95 % of the spin, forward.
    pub(super) fn subsynchronous_part(&self) -> Option<f64> {
        let (spectrum, _) = self.spectrum.as_ref()?;
        let band = |from: f64, to: f64| -> f64 {
            let within = spectrum.frequency.iter().zip(&spectrum.density).filter(|(f, _)| (from..to).contains(*f));
            within.map(|(_, d)| d).sum()
        };
        Some(band(0.05 * self.speed, 0.95 * self.speed) / band(f64::NEG_INFINITY, f64::INFINITY))
    }
}
