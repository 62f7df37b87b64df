//! Every control bearing of a machine, closed as one loop: each has sensors, a law, filters and an actuator of its own, and a
//! signal may read any sensor, so that laws that decouple tilt from translation are laws like others.
//!
//! One computer samples and computes for all of them: [`Parts::sample`] and `delay` are the same for all.

use crate::{ControlBearing, FeedbackError, MAX_BEARINGS, Parts, Signal};

/// The control bearings of a machine, at least one. Always fits the rotor it was checked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback {
    /// The bearings, in the order of the machine.
    pub bearings: Vec<ControlBearing>,
}

impl From<ControlBearing> for Feedback {
    fn from(bearing: ControlBearing) -> Self {
        Self { bearings: vec![bearing] }
    }
}

impl Feedback {
    /// One bearing at `station` (counted from 0), driven by signals through an ideal loop.
    #[must_use]
    pub fn new(station: usize, signals: Vec<Signal>) -> Self {
        ControlBearing::new(station, signals).into()
    }

    /// The first bearing.
    ///
    /// # Panics
    /// Feedback without a bearing, which [`Feedback::check`] refuses.
    #[must_use]
    pub fn first(&self) -> &ControlBearing {
        &self.bearings[0]
    }

    /// The first bearing, to change.
    ///
    /// # Panics
    /// As [`Feedback::first`].
    pub fn first_mut(&mut self) -> &mut ControlBearing {
        &mut self.bearings[0]
    }

    /// The bearing of a machine that has no other.
    #[must_use]
    pub fn only(&self) -> Option<&ControlBearing> {
        match &self.bearings[..] {
            [bearing] => Some(bearing),
            _ => None,
        }
    }

    /// What bearing `bearing` (counted from 0) is called: its name, or its number counted from 1.
    #[must_use]
    pub fn label(&self, bearing: usize) -> String {
        let named = self.bearings.get(bearing).and_then(|b| b.name.clone());
        named.unwrap_or_else(|| (bearing + 1).to_string())
    }

    /// The bearing that is called so, counted from 0: by its name, or by its number counted from 1.
    #[must_use]
    pub fn find(&self, label: &str) -> Option<usize> {
        let named = self.bearings.iter().position(|b| b.name.as_deref() == Some(label));
        let numbered = || label.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
        named.or_else(numbered).filter(|at| *at < self.bearings.len())
    }

    /// Every signal, those of the first bearing first.
    pub fn signals(&self) -> impl Iterator<Item = &Signal> {
        self.bearings.iter().flat_map(|bearing| &bearing.signals)
    }

    /// How many signals there are in all.
    #[must_use]
    pub fn signal_count(&self) -> usize {
        self.bearings.iter().map(|bearing| bearing.signals.len()).sum()
    }

    /// Where the `place`-th of all signals is: its bearing, and its place there; `None` if there are not so many.
    #[must_use]
    pub fn place_of_signal(&self, place: usize) -> Option<(usize, usize)> {
        let mut left = place;
        for (k, bearing) in self.bearings.iter().enumerate() {
            match left.checked_sub(bearing.signals.len()) {
                None => return Some((k, left)),
                Some(rest) => left = rest,
            }
        }
        None
    }

    /// The `place`-th of all signals.
    #[must_use]
    pub fn signal(&self, place: usize) -> Option<&Signal> {
        self.signals().nth(place)
    }

    /// The `place`-th of all signals, to change.
    pub fn signal_mut(&mut self, place: usize) -> Option<&mut Signal> {
        self.bearings.iter_mut().flat_map(|bearing| &mut bearing.signals).nth(place)
    }

    /// Whether force follows displacement and velocity at once and exactly: gains alone.
    #[must_use]
    pub fn is_ideal(&self) -> bool {
        self.bearings.iter().all(ControlBearing::is_ideal)
    }

    /// The sampling and hold period of all loops; 0 is continuous.
    #[must_use]
    pub fn sample(&self) -> f64 {
        self.bearings.first().map_or(0.0, |bearing| bearing.parts.sample)
    }

    /// The delay of measurement and computation of all loops.
    #[must_use]
    pub fn delay(&self) -> f64 {
        self.bearings.first().map_or(0.0, |bearing| bearing.parts.delay)
    }

    /// Samples that a controller outside may miss before the laws here take over; `None` where there is none outside.
    #[must_use]
    pub fn external(&self) -> Option<u64> {
        let samples = self.bearings.first().map_or(0.0, |bearing| bearing.parts.external);
        (samples > 0.0).then_some(samples.ceil() as u64)
    }

    /// Samples missed by it that trip the machine; `None` for never.
    #[must_use]
    pub fn external_trip(&self) -> Option<u64> {
        let samples = self.bearings.first().map_or(0.0, |bearing| bearing.parts.external_trip);
        (samples > 0.0).then_some(samples.ceil() as u64)
    }

    /// The same with these parts of the loop at every bearing.
    #[must_use]
    pub fn with_parts(mut self, parts: Parts) -> Self {
        self.bearings.iter_mut().for_each(|bearing| bearing.parts = parts);
        self
    }

    /// The same without faults of sensors and amplifiers.
    #[must_use]
    pub fn sound(&self) -> Self {
        let mut sound = self.clone();
        sound.bearings.iter_mut().for_each(|bearing| bearing.parts = bearing.parts.sound());
        sound
    }

    /// Sets the delay of all loops.
    pub fn set_delay(&mut self, delay: f64) {
        self.bearings.iter_mut().for_each(|bearing| bearing.parts.delay = delay);
    }

    /// Checks that this feedback can drive a rotor of `stations` stations.
    ///
    /// # Errors
    /// The first part that does not fit, by name.
    pub fn check(&self, stations: usize) -> Result<(), FeedbackError> {
        if !(1..=MAX_BEARINGS).contains(&self.bearings.len()) {
            return Err(FeedbackError::Bearings(self.bearings.len()));
        }
        for (k, bearing) in self.bearings.iter().enumerate() {
            let of_this = |why: FeedbackError| match self.bearings.len() {
                1 => why,
                _ => FeedbackError::OfBearing { bearing: self.label(k), why: Box::new(why) },
            };
            bearing.check(stations).map_err(of_this)?;
            for before in &self.bearings[..k] {
                if before.station == bearing.station {
                    let before = self.bearings.iter().position(|b| std::ptr::eq(b, before)).unwrap_or(0);
                    return Err(FeedbackError::Twice(format!(
                        "in one place: {} and {}",
                        self.label(before),
                        self.label(k)
                    )));
                }
                if bearing.name.is_some() && before.name == bearing.name {
                    return Err(FeedbackError::Twice(format!("called '{}'", self.label(k))));
                }
            }
            let at = bearing.parts.sensor_at as usize;
            if at > 0 && !self.bearings.iter().any(|bearing| bearing.senses(at - 1)) {
                return Err(of_this(FeedbackError::Unread(at)));
            }
            let (own, first) = (bearing.parts, self.first().parts);
            for (key, found, first) in [
                ("sample", own.sample, first.sample),
                ("delay", own.delay, first.delay),
                ("external", own.external, first.external),
                ("external_trip", own.external_trip, first.external_trip),
            ] {
                if found != first {
                    return Err(FeedbackError::Clock { bearing: self.label(k), key, found, first });
                }
            }
        }
        Ok(())
    }

    /// The same structure with every gain zero: control off, ready to be tuned up again.
    #[must_use]
    pub fn off(&self) -> Self {
        Self { bearings: self.bearings.iter().map(ControlBearing::off).collect() }
    }

    /// Whether every gain is zero at every speed.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.bearings.iter().all(ControlBearing::is_off)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Gain;

    fn two() -> Feedback {
        let at = |station, name: &str, count| ControlBearing {
            name: Some(name.to_owned()),
            ..ControlBearing::new(station, (0..count).map(|k| Signal::at_mass(k, 3, [k as f64; 4])).collect())
        };
        Feedback { bearings: vec![at(0, "left", 2), at(2, "right", 1)] }
    }

    #[test]
    fn signals_are_counted_through_all_bearings() {
        let mut feedback = two();
        feedback.check(3).expect("fits");
        assert_eq!(feedback.signal_count(), 3);
        assert_eq!([0, 1, 2, 3].map(|k| feedback.place_of_signal(k)), [Some((0, 0)), Some((0, 1)), Some((1, 0)), None]);
        feedback.signal_mut(2).expect("there is").gains[0] = Gain::Constant(7.0);
        assert_eq!(feedback.bearings[1].signals[0].gains[0], Gain::Constant(7.0));
        assert_eq!((feedback.find("right"), feedback.find("2"), feedback.find("3")), (Some(1), Some(1), None));
    }

    #[test]
    fn bearings_that_cannot_be_closed_together_are_refused_by_name() {
        let told = |change: &dyn Fn(&mut Feedback)| {
            let mut feedback = two();
            change(&mut feedback);
            feedback.check(3).expect_err("refused").to_string()
        };
        assert_eq!(told(&|f| f.bearings.clear()), "feedback has 1 to 8 control bearings, found 0");
        // Signals read masses 1 and 2.
        let lost = |f: &mut Feedback| {
            (f.bearings[0].parts.sensor_gain, f.bearings[0].parts.sensor_at) = (0.0, 3.0);
        };
        assert!(told(&lost).ends_with("sensor_at = 3: expected a place whose sensor a control bearing reads"));
        assert_eq!(told(&|f| f.bearings[1].station = 0), "two control bearings in one place: left and right");
        assert_eq!(told(&|f| f.bearings[1].name = Some("left".into())), "two control bearings called 'left'");
        assert_eq!(
            told(&|f| f.bearings[1].station = 3),
            "bearing right: control bearing at mass 4, but the rotor has masses 1 to 3"
        );
        assert_eq!(
            told(&|f| f.bearings[1].parts.delay = 0.5),
            "bearing right: delay = 0.5, but 0 at the first bearing: all are computed by one clock"
        );
    }
}
