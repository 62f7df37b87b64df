//! What the watched things are at one moment.

use rotor::MAX_BEARINGS;
use wire::Moment;

use crate::Watch;

/// A value, and when it was so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The value; [`Watch::meaning`] says what it is.
    pub value: f64,
    /// The step it belongs to: of a peak, the one that had it.
    pub at: Moment,
}

/// The delay margin of a loop that no delay makes unstable, in `tau`: files of events have no infinite numbers.
const ENDLESS: f64 = 1e6;

/// What the watched things are at one moment. What is unknown changes nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The newest step that it takes in.
    pub at: Moment,
    /// Why the machine has tripped; empty while it runs.
    pub cause: String,
    samples: [Option<Sample>; Watch::COUNT],
    /// The force of every control bearing.
    forces: [Option<Sample>; MAX_BEARINGS],
    /// The loop is known to have no margins.
    is_without_margins: bool,
}

impl Reading {
    /// Nothing is known yet.
    #[must_use]
    pub fn new(at: Moment) -> Self {
        Self { at, ..Self::default() }
    }

    /// The same with a value that is so at its own moment.
    #[must_use]
    pub fn with(mut self, watch: Watch, value: f64) -> Self {
        self.set(watch, Some(Sample { value, at: self.at }));
        self
    }

    /// The same with a trip, or without one if there is no cause.
    #[must_use]
    pub fn tripped(mut self, cause: &str) -> Self {
        cause.clone_into(&mut self.cause);
        self.with(Watch::Trip, f64::from(u8::from(!cause.is_empty())))
    }

    /// What is known of something.
    #[must_use]
    pub fn get(&self, watch: Watch) -> Option<Sample> {
        self.samples[watch as usize]
    }

    /// Sets the margins of the loop: the peak of its sensitivity, and what delay more it bears, in `tau`; `None` is any. A loop that is
    /// not stable has no margins, and its damping says so.
    pub fn set_margins(&mut self, sensitivity: f64, delay: Option<f64>) {
        let at = self.at;
        self.set(Watch::Sensitivity, Some(Sample { value: sensitivity, at }));
        self.set(Watch::DelayMargin, Some(Sample { value: delay.unwrap_or(ENDLESS).min(ENDLESS), at }));
    }

    /// The loop has no margins, because it is not stable or is none: those of before are not its own.
    pub fn set_no_margins(&mut self) {
        self.is_without_margins = true;
    }

    /// Whether what was known of something holds no more.
    #[must_use]
    pub fn forgets(&self, watch: Watch) -> bool {
        self.is_without_margins && matches!(watch, Watch::Sensitivity | Watch::DelayMargin)
    }

    /// What is known of the force of every control bearing, as that of the first.
    #[must_use]
    pub fn forces(&self) -> &[Option<Sample>; MAX_BEARINGS] {
        &self.forces
    }

    /// Sets what is known of the force of every control bearing, as that of the first; the largest stands for all.
    pub fn set_forces(&mut self, forces: [Option<Sample>; MAX_BEARINGS]) {
        let larger = |a: Sample, b: Sample| if a.value.is_nan() || a.value >= b.value { a } else { b };
        self.set(Watch::Force, forces.into_iter().flatten().reduce(larger));
        self.forces = forces;
    }

    /// Sets what is known of something.
    pub fn set(&mut self, watch: Watch, sample: Option<Sample>) {
        self.samples[watch as usize] = sample;
    }
}
