//! The control law: which sensors drive the control bearing, with which gains.
//!
//! `u = - sum_k [ (kd_k - j kc_k) p_k + (cd_k - j cc_k) p_k' ]`, the most general radially symmetric static output
//! feedback. Each [`Signal`] is a weighted sum of displacements and of velocities with four gains. One signal with
//! several weights is the report's *composite* output (4.25)-(4.27); one signal per sensor is *individual* feedback.

use crate::{C64, Filter, FilterError, Gain, GainKind, MAX_BEARINGS, MAX_SENSORS, PartError, Parts};

/// One measured signal: weighted sums of displacements and of velocities, and the four gains that act on them.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Weight of each mass's displacement: `a b c ...` of (4.26).
    pub displacement: Vec<f64>,
    /// Weight of each mass's velocity: `d e f ...` of (4.26).
    pub velocity: Vec<f64>,
    /// The gains, in the order of [`GainKind::ALL`].
    pub gains: [Gain; 4],
    /// What shapes it, in a row; empty for the law alone.
    pub filters: Vec<Filter>,
}

impl Signal {
    /// A signal over the same weights for displacement and velocity, with constant gains `[kd, cd, kc, cc]`.
    #[must_use]
    pub fn composite(weights: &[f64], gains: [f64; 4]) -> Self {
        Self {
            displacement: weights.to_vec(),
            velocity: weights.to_vec(),
            gains: gains.map(Gain::Constant),
            filters: vec![],
        }
    }

    /// The signal of the sensor at mass `mass` (counted from 0) of `masses`, with constant gains `[kd, cd, kc, cc]`.
    #[must_use]
    pub fn at_mass(mass: usize, masses: usize, gains: [f64; 4]) -> Self {
        let mut weights = vec![0.0; masses];
        if let Some(weight) = weights.get_mut(mass) {
            *weight = 1.0;
        }
        Self::composite(&weights, gains)
    }

    /// One of its gains.
    #[must_use]
    pub fn gain(&self, kind: GainKind) -> &Gain {
        &self.gains[kind as usize]
    }

    /// One of its gains, to change.
    pub fn gain_mut(&mut self, kind: GainKind) -> &mut Gain {
        &mut self.gains[kind as usize]
    }
}

/// One control bearing: where it is, and what drives it. Always fits the rotor it was checked for.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlBearing {
    /// What it is called, where it has a name: `left`.
    pub name: Option<String>,
    /// The station that carries it (of a chain: the mass), counted from 0.
    pub station: usize,
    /// The signals, at least one.
    pub signals: Vec<Signal>,
    /// What shapes the sum of the signals, in a row; empty for the law alone.
    pub filters: Vec<Filter>,
    /// What stands around the law; the default is the ideal loop.
    pub parts: Parts,
}

/// Why feedback does not fit a rotor.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FeedbackError {
    /// The control bearing is on a mass that does not exist.
    #[error("control bearing at mass {found}, but the rotor has masses 1 to {masses}")]
    Bearing {
        /// The mass asked for, counted from 1.
        found: usize,
        /// How many there are.
        masses: usize,
    },
    /// No signal, or more than a message can carry.
    #[error("feedback has 1 to {MAX_SENSORS} signals, found {0}")]
    Signals(usize),
    /// A weight vector has the wrong length.
    #[error("signal {signal}: {field} has {found} weights, but the rotor has {masses} masses")]
    Weights {
        /// Which signal, counted from 1.
        signal: usize,
        /// `displacement` or `velocity`.
        field: &'static str,
        /// How many weights there are.
        found: usize,
        /// How many masses there are.
        masses: usize,
    },
    /// A weight is not finite.
    #[error("signal {signal}: a weight of {field} is not finite")]
    NotFinite {
        /// Which signal, counted from 1.
        signal: usize,
        /// `displacement` or `velocity`.
        field: &'static str,
    },
    /// A gain is not finite, or its table is empty or not in rising order of speed.
    #[error("signal {signal}: {gain} must be finite, and a table non-empty with rising speeds")]
    Gain {
        /// Which signal, counted from 1.
        signal: usize,
        /// The gain's name.
        gain: &'static str,
    },
    /// A filter of a signal is not in order.
    #[error("signal {signal}: {why}")]
    Filter {
        /// Which signal, counted from 1.
        signal: usize,
        /// What is wrong with it.
        why: FilterError,
    },
    /// A filter of the bearing is not in order.
    #[error("bearing: {0}")]
    BearingFilter(FilterError),
    /// A number of the loop is not allowed.
    #[error(transparent)]
    Part(#[from] PartError),
    /// A controller outside of a loop without samples.
    #[error(
        "external = {0} without sample: expected sample = T beside it, the period at which a controller outside is asked"
    )]
    ExternalUnsampled(f64),
    /// A trip for want of a controller that nobody waits for.
    #[error(
        "external_trip = {0} without external: expected external = N beside it, the samples that a controller outside may miss"
    )]
    ExternalTripAlone(f64),
    /// A sensor that is not there.
    #[error("sensor_at = {found}: expected a mass from 1 to {masses}, whose sensor has that gain")]
    NoSensor {
        /// What was asked for.
        found: f64,
        /// How many masses there are.
        masses: usize,
    },
    /// A sensor that nobody reads.
    #[error("sensor_at = {0}: expected a place whose sensor a control bearing reads")]
    Unread(usize),
    /// A sensor of which nothing is said.
    #[error(
        "sensor_at = {0} without sensor_gain: expected sensor_gain = G beside it, what that sensor reads of what is there"
    )]
    SensorAtAlone(f64),
    /// An amplifier that is not the same along both axes.
    #[error(
        "amplifier_y = {y}, amplifier_z = {z}: a bearing that acts along its axes differently has no poles of forward and backward whirl"
    )]
    Anisotropic {
        /// Gain along y.
        y: f64,
        /// Gain along z.
        z: f64,
    },
    /// No control bearing, or more than a message can carry.
    #[error("feedback has 1 to {MAX_BEARINGS} control bearings, found {0}")]
    Bearings(usize),
    /// Two control bearings that cannot be told apart.
    #[error("two control bearings {0}")]
    Twice(String),
    /// What one machine computes for all its bearings differs between them.
    #[error("bearing {bearing}: {key} = {found}, but {first} at the first bearing: all are computed by one clock")]
    Clock {
        /// Which bearing.
        bearing: String,
        /// `sample`, `delay`, `external` or `external_trip`.
        key: &'static str,
        /// Its value there.
        found: f64,
        /// Its value at the first.
        first: f64,
    },
    /// One of several bearings does not fit.
    #[error("bearing {bearing}: {why}")]
    OfBearing {
        /// Which, by its name or counted from 1.
        bearing: String,
        /// What is wrong with it.
        why: Box<FeedbackError>,
    },
}

impl ControlBearing {
    /// Signals that drive the bearing at `station` (counted from 0) through an ideal loop.
    #[must_use]
    pub fn new(station: usize, signals: Vec<Signal>) -> Self {
        Self { name: None, station, signals, filters: vec![], parts: Parts::default() }
    }

    /// Whether force follows displacement and velocity at once and exactly: gains alone.
    #[must_use]
    pub fn is_ideal(&self) -> bool {
        self.parts.is_ideal() && self.filters.is_empty() && self.signals.iter().all(|s| s.filters.is_empty())
    }

    /// Checks that it can be a bearing of a rotor of `masses` masses.
    ///
    /// # Errors
    /// The first part that does not fit, by name.
    pub fn check(&self, masses: usize) -> Result<(), FeedbackError> {
        if self.station >= masses {
            return Err(FeedbackError::Bearing { found: self.station + 1, masses });
        }
        if self.signals.is_empty() || self.signals.len() > MAX_SENSORS {
            return Err(FeedbackError::Signals(self.signals.len()));
        }
        for (i, signal) in self.signals.iter().enumerate() {
            for (field, weights) in [("displacement", &signal.displacement), ("velocity", &signal.velocity)] {
                if weights.len() != masses {
                    return Err(FeedbackError::Weights { signal: i + 1, field, found: weights.len(), masses });
                }
                if !weights.iter().all(|w| w.is_finite()) {
                    return Err(FeedbackError::NotFinite { signal: i + 1, field });
                }
            }
            for kind in GainKind::ALL {
                if !signal.gain(kind).is_sound() {
                    return Err(FeedbackError::Gain { signal: i + 1, gain: kind.name() });
                }
            }
            for filter in &signal.filters {
                filter.check().map_err(|why| FeedbackError::Filter { signal: i + 1, why })?;
            }
        }
        self.filters.iter().try_for_each(Filter::check).map_err(FeedbackError::BearingFilter)?;
        self.parts.check()?;
        if self.parts.external > 0.0 && self.parts.sample == 0.0 {
            return Err(FeedbackError::ExternalUnsampled(self.parts.external));
        }
        if self.parts.external_trip > 0.0 && self.parts.external == 0.0 {
            return Err(FeedbackError::ExternalTripAlone(self.parts.external_trip));
        }
        let Parts { sensor_at, sensor_gain, .. } = self.parts;
        if sensor_at.fract() != 0.0 || sensor_at > masses as f64 {
            return Err(FeedbackError::NoSensor { found: sensor_at, masses });
        }
        if sensor_at > 0.0 && sensor_gain == 1.0 {
            return Err(FeedbackError::SensorAtAlone(sensor_at));
        }
        Ok(())
    }

    /// The same structure with every gain zero: control off, ready to be tuned up again.
    #[must_use]
    pub fn off(&self) -> Self {
        let mut off = self.clone();
        for signal in &mut off.signals {
            signal.gains = [const { Gain::Constant(0.0) }; 4];
        }
        off
    }

    /// Whether the sensor at `station`, counted from 0, is read: by a signal, or, where a controller outside acts, by that one, which is
    /// given all that can be read.
    #[must_use]
    pub fn senses(&self, station: usize) -> bool {
        let weighs = |weights: &[f64]| weights.get(station).is_some_and(|weight| *weight != 0.0);
        self.parts.external > 0.0 || self.signals.iter().any(|s| weighs(&s.displacement) || weighs(&s.velocity))
    }

    /// The speeds at which the table of a gain has a corner, rising, each once.
    #[must_use]
    pub fn corner_speeds(&self) -> Vec<f64> {
        let gains = self.signals.iter().flat_map(|signal| &signal.gains);
        let mut corners: Vec<f64> = gains.flat_map(Gain::corner_speeds).collect();
        corners.sort_by(f64::total_cmp);
        corners.dedup();
        corners
    }

    /// Whether every gain is zero at every speed.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.signals.iter().all(|s| s.gains.iter().all(|g| *g == Gain::Constant(0.0)))
    }

    /// The law at one spin speed, as complex gains on each mass.
    #[must_use]
    pub fn at(&self, speed: f64) -> ControlRow {
        self.row(|gain| gain.at(speed))
    }

    /// The law with a number for each of its gains, as complex gains on each mass.
    pub(crate) fn row(&self, number: impl Fn(&Gain) -> f64) -> ControlRow {
        let mut row = ControlRow { bearing: self.station, ..ControlRow::default() };
        for signal in &self.signals {
            let [kd, cd, kc, cc] = [0, 1, 2, 3].map(|i| number(&signal.gains[i]));
            let on_displacement = C64::new(kd, -kc);
            let on_velocity = C64::new(cd, -cc);
            for (gain, weight) in row.displacement.iter_mut().zip(&signal.displacement) {
                *gain += on_displacement * weight;
            }
            for (gain, weight) in row.velocity.iter_mut().zip(&signal.velocity) {
                *gain += on_velocity * weight;
            }
        }
        row
    }
}

/// The control law at one speed: `u = - sum_k (displacement_k p_k + velocity_k p_k')` at mass `bearing`.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ControlRow {
    /// The mass that carries the bearing, counted from 0.
    pub bearing: usize,
    /// Complex gain on each displacement, `sum (kd - j kc) weight`; zero beyond the last mass.
    pub displacement: [C64; MAX_SENSORS],
    /// Complex gain on each velocity, `sum (cd - j cc) weight`; zero beyond the last mass.
    pub velocity: [C64; MAX_SENSORS],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn composite_weights_act_on_every_sensor_they_name() {
        let feedback = ControlBearing::new(0, vec![Signal::composite(&[1.0, 2.0], [3.0, 5.0, 7.0, 11.0])]);
        let row = feedback.at(0.0);
        assert_eq!(row.displacement[..2], [C64::new(3.0, -7.0), C64::new(6.0, -14.0)]);
        assert_eq!(row.velocity[..2], [C64::new(5.0, -11.0), C64::new(10.0, -22.0)]);
        assert!(!feedback.is_off() && feedback.off().is_off());
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let told = |f: ControlBearing| f.check(2).unwrap_err().to_string();
        let sound = Signal::at_mass(0, 2, [0.0; 4]);
        assert_eq!(
            told(ControlBearing::new(2, vec![sound.clone()])),
            "control bearing at mass 3, but the rotor has masses 1 to 2"
        );
        assert_eq!(told(ControlBearing::new(0, vec![])), "feedback has 1 to 16 signals, found 0");
        assert_eq!(
            told(ControlBearing::new(0, vec![Signal::at_mass(0, 3, [0.0; 4])])),
            "signal 1: displacement has 3 weights, but the rotor has 2 masses"
        );
        let mut bad = sound;
        *bad.gain_mut(GainKind::Cd) = Gain::Table(vec![(1.0, 0.0), (1.0, 2.0)]);
        assert_eq!(
            told(ControlBearing::new(0, vec![bad])),
            "signal 1: cd must be finite, and a table non-empty with rising speeds"
        );
    }
}
