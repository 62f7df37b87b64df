//! The steps of a measurement, sorted into its periods; a period from which a step is missing counts for nothing.

use rotor::C64;
use study::measured::{MeasuredPoint, Tones};
use wire::{Flags, Step};

use super::Subject;
use super::plan::Plan;

/// What has been taken in.
pub(super) struct Collector {
    start: u64,
    settle: u64,
    period: u64,
    revision: u64,
    speed: f64,
    /// Steps seen of those that were made under the excitation, up to the last.
    seen: u64,
    lost: u64,
    periods: Vec<Vec<(f64, C64)>>,
    /// Steps that were measured; of these those in contact at each mass, and those at the limit of the actuator.
    measured: u64,
    in_contact: Vec<u64>,
    saturated: u64,
}

/// What came of a measurement.
pub(super) struct Measured {
    /// Frequencies rising.
    pub(super) points: Vec<MeasuredPoint>,
    /// The time at which it began.
    pub(super) from: f64,
    /// Periods that were measured.
    pub(super) periods: usize,
    pub(super) lost: u64,
    /// Share of the time that each mass pressed on its bearing.
    pub(super) contact: Vec<f64>,
    /// Share of the time that the actuator was at its limit.
    pub(super) saturated: f64,
}

impl Collector {
    pub(super) fn new(plan: &Plan, subject: &Subject, start: u64) -> Self {
        Self {
            start,
            settle: plan.settle,
            period: plan.period,
            revision: subject.revision,
            speed: subject.settings.speed,
            seen: 0,
            lost: 0,
            periods: vec![Vec::with_capacity(plan.period as usize); plan.periods as usize],
            measured: 0,
            in_contact: vec![0; subject.rotor.len()],
            saturated: 0,
        }
    }

    /// Takes a step in.
    ///
    /// # Errors
    /// The machine is no longer the one that was to be measured.
    pub(super) fn take(&mut self, state: &impl Step) -> Result<(), String> {
        let Some(place) = state.seq().checked_sub(self.start) else { return Ok(()) };
        if self.is_full() {
            return Ok(());
        }
        if state.flags().has(Flags::TRIPPED) {
            return Err("the machine tripped meanwhile".into());
        }
        if state.revision() != self.revision {
            return Err("the settings were changed meanwhile: nothing can be said of either".into());
        }
        if state.speed() != self.speed {
            return Err("the speed changed meanwhile".into());
        }
        if place < self.seen {
            return Err("the machine was restarted meanwhile".into());
        }
        self.lost += place - self.seen;
        self.seen = place + 1;
        let Some(since) = place.checked_sub(self.settle) else { return Ok(()) };
        let Some(period) = self.periods.get_mut((since / self.period) as usize) else { return Ok(()) };
        let [y, z] = state.force_commanded();
        period.push((state.tau(), C64::new(y, z)));
        self.measured += 1;
        self.saturated += u64::from(state.flags().has(Flags::SATURATED));
        for (mass, count) in self.in_contact.iter_mut().enumerate() {
            *count += u64::from(state.flags().in_contact(mass));
        }
        Ok(())
    }

    /// How many steps have been seen, or were lost.
    pub(super) fn seen(&self) -> u64 {
        self.seen
    }

    /// Whether all are there.
    pub(super) fn is_full(&self) -> bool {
        self.seen >= self.settle + self.period * self.periods.len() as u64
    }

    /// Takes the periods apart that are whole; the excitation began at `from`.
    ///
    /// # Errors
    /// Fewer than two are.
    pub(super) fn finish(self, plan: &Plan, subject: &Subject, from: f64) -> Result<Measured, String> {
        let tones =
            Tones { tones: plan.tones.clone(), from, speed: self.speed, sample: subject.settings.feedback.sample() };
        let whole = self.periods.iter().filter(|period| period.len() as u64 == self.period);
        let periods: Vec<Vec<C64>> = whole.filter_map(|period| tones.identify(period)).collect();
        if periods.len() < 2 {
            return Err(format!(
                "{} of {} periods could be measured, {} steps were lost: two are needed",
                periods.len(),
                plan.periods,
                self.lost
            ));
        }
        let share = |count: u64| count as f64 / self.measured.max(1) as f64;
        Ok(Measured {
            points: tones.averaged(&periods),
            from,
            periods: periods.len(),
            lost: self.lost,
            contact: self.in_contact.iter().map(|count| share(*count)).collect(),
            saturated: share(self.saturated),
        })
    }
}
