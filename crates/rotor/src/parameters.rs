//! The one table of what can be changed on a running machine: [`PARAMETERS`], and the keys that name its rows.
//!
//! It makes the keys of `whirl set`, the rows of the gain panel and the names in recordings.

use std::fmt;
use std::str::FromStr;

use control::{FAULTS, PARTS, Part};
use units::{Dimension, Typed, TypedError, Units};

use crate::{Gain, GainKind, Settings, SettingsError};

/// What a parameter belongs to, and so what the index in `key.index` counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// The whole machine: no index.
    Machine,
    /// One value a mass; without an index, all of them.
    Mass,
    /// One value a feedback signal, counted through all control bearings; without an index, the first of the only bearing.
    Signal,
    /// One value a control bearing; without an index, all of them.
    Bearing,
}

/// One row of the table of settings.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its key, as typed.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// What it measures, and so its unit.
    pub dimension: Dimension,
    /// The least allowed value.
    pub min: f64,
    /// The greatest allowed value.
    pub max: f64,
    /// What one key press adds.
    pub step: f64,
    /// What it belongs to.
    pub scope: Scope,
    /// The value that means "not there", typed as `off`; it is allowed beside the range.
    pub off: Option<f64>,
    /// Which gain it is, if it is one: gains may be schedules.
    pub gain: Option<GainKind>,
    /// Reads it; the place is of a mass, signal or control bearing that exists, and 0 for the whole machine.
    pub(crate) get: fn(&Settings, usize) -> f64,
    /// Writes it, likewise.
    pub(crate) set: fn(&mut Settings, usize, f64),
}

impl PartialEq for Parameter {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Parameter {
    /// Whether a value is allowed.
    #[must_use]
    pub fn admits(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value) || self.off == Some(value)
    }

    /// Whether it is a fault where it is there: no part of a machine as it was designed.
    #[must_use]
    pub fn is_fault(&self) -> bool {
        FAULTS.contains(&self.name) || self.name == "unbalance_added"
    }

    /// The name of its unit where a rotor has no scales; empty if it is a ratio. Times are told by their symbol, `tau`.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        match self.dimension {
            Dimension::Time => "tau",
            // Gains are known by their numbers.
            Dimension::Stiffness | Dimension::Damping => "",
            dimension => dimension.unit(),
        }
    }

    /// A value as typed, with a unit or without; `off` is one where that means something.
    ///
    /// # Errors
    /// What is neither.
    pub fn read(&self, typed: &str) -> Result<Typed, TypedError> {
        match (typed.trim(), self.off) {
            // Nothing and without end are so in any unit.
            ("off", Some(off)) => Ok(off.into()),
            (typed, _) => Typed::read(self.dimension, typed),
        }
    }
}

const fn gain(
    kind: GainKind,
    name: &'static str,
    meaning: &'static str,
    get: fn(&Settings, usize) -> f64,
    set: fn(&mut Settings, usize, f64),
) -> Parameter {
    Parameter {
        name,
        meaning,
        dimension: match kind {
            GainKind::Kd | GainKind::Kc => Dimension::Stiffness,
            GainKind::Cd | GainKind::Cc => Dimension::Damping,
        },
        min: -1e6,
        max: 1e6,
        step: 0.01,
        scope: Scope::Signal,
        off: None,
        gain: Some(kind),
        get,
        set,
    }
}

/// Rows for the four gains: a function of its own for each, because a row holds plain functions.
macro_rules! gains {
    ($($kind:ident $name:literal $meaning:literal)+) => {
        [$(gain(
            GainKind::$kind,
            $name,
            $meaning,
            |settings, signal| {
                let signal = settings.feedback.signal(signal);
                signal.map_or(f64::NAN, |signal| signal.gain(GainKind::$kind).at(settings.speed))
            },
            |settings, signal, value| {
                if let Some(signal) = settings.feedback.signal_mut(signal) {
                    *signal.gain_mut(GainKind::$kind) = Gain::Constant(value);
                }
            },
        )),+]
    };
}

const GAINS: [Parameter; 4] = gains![
    Kd "kd" "direct stiffness (report: g11)"
    Cd "cd" "direct damping (report: g13 in chapter III, g12 in chapter IV)"
    Kc "kc" "cross-coupled stiffness (report: g12 in chapter III, g13 in chapter IV)"
    Cc "cc" "cross-coupled damping (report: g14)"
];

/// A row for a number of the loop.
macro_rules! part {
    ($at:literal) => {{
        const PART: Part = PARTS[$at];
        Parameter {
            name: PART.name,
            meaning: PART.meaning,
            dimension: PART.dimension,
            min: PART.min,
            max: PART.max,
            step: PART.step,
            scope: Scope::Bearing,
            off: Some(PART.absent),
            gain: None,
            get: |settings, bearing| (PART.get)(&settings.feedback.bearings[bearing].parts),
            set: |settings, bearing, value| (PART.set)(&mut settings.feedback.bearings[bearing].parts, value),
        }
    }};
}

const fn machine(
    name: &'static str,
    meaning: &'static str,
    dimension: Dimension,
    [min, max, step]: [f64; 3],
    get: fn(&Settings, usize) -> f64,
    set: fn(&mut Settings, usize, f64),
) -> Parameter {
    Parameter { name, meaning, dimension, min, max, step, scope: Scope::Machine, off: None, gain: None, get, set }
}

/// Every numeric setting, in the order in which panels show them.
pub const PARAMETERS: [Parameter; 26] = [
    machine(
        "speed",
        "spin speed R = w / w0; with a ramp, where it goes",
        Dimension::Speed,
        [0.0, 1000.0, 0.05],
        |settings, _| settings.speed,
        |settings, _, value| settings.speed = value,
    ),
    Parameter {
        off: Some(f64::INFINITY),
        ..machine(
            "ramp",
            "greatest rate of change of the speed; off: it jumps",
            Dimension::SpeedRate,
            [1e-9, 1e6, 0.01],
            |settings, _| settings.ramp,
            |settings, _, value| settings.ramp = value,
        )
    },
    Parameter {
        scope: Scope::Mass,
        ..machine(
            "deadband",
            "radial clearance of the support bearings, g / e_t",
            Dimension::Length,
            [0.0, 1e6, 0.1],
            |settings, mass| settings.deadband[mass],
            |settings, mass, value| settings.deadband[mass] = value,
        )
    },
    GAINS[0],
    GAINS[1],
    GAINS[2],
    GAINS[3],
    machine(
        "trip",
        "orbit radius at which the machine trips",
        Dimension::Length,
        [1e-3, 1e9, 10.0],
        |settings, _| settings.trip,
        |settings, _, value| settings.trip = value,
    ),
    Parameter {
        off: Some(0.0),
        ..machine(
            "coast_down",
            "rate at which the speed falls at first after a trip; off: it is held",
            Dimension::SpeedRate,
            [1e-9, 1e6, 0.01],
            |settings, _| settings.coast_down,
            |settings, _, value| settings.coast_down = value,
        )
    },
    part!(0),
    part!(1),
    part!(2),
    part!(3),
    part!(4),
    part!(5),
    part!(6),
    part!(7),
    part!(8),
    part!(9),
    part!(10),
    part!(11),
    part!(12),
    part!(13),
    part!(14),
    part!(15),
    Parameter {
        scope: Scope::Mass,
        off: Some(0.0),
        ..machine(
            "unbalance_added",
            "unbalance added at a place, U / (m_t e_t)",
            Dimension::Length,
            [-1e6, 1e6, 0.1],
            |settings, mass| settings.unbalance_added.get(mass).copied().unwrap_or(0.0),
            |settings, mass, value| settings.unbalance_added.get_mut(mass).into_iter().for_each(|added| *added = value),
        )
    },
];

/// Whether a name is that of a setting, so that nothing in front of a key can be called so.
#[must_use]
pub(crate) fn is_setting(name: &str) -> bool {
    name == "feedback" || PARAMETERS.iter().any(|parameter| parameter.name == name)
}

/// What is expected of a name in front of a key, in words.
pub(crate) const NO_SETTING: &str = "a name that is no setting: it stands in front of keys, as in left.kd";

/// One settable value: a row of [`PARAMETERS`], and the mass, signal or control bearing it is meant for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// The row.
    pub parameter: &'static Parameter,
    /// Mass, signal or control bearing, counted from 0. `None` is every mass, every control bearing, or the first signal.
    pub index: Option<usize>,
}

impl Key {
    /// The dimensionless value of what was typed for it, as `name`; `alone` is that of a number that does not say what it is counted in.
    ///
    /// # Errors
    /// What is no value of it, or says an SI unit where there are no scales.
    pub fn value_of(
        self,
        name: &str,
        typed: &str,
        units: &Units,
        alone: impl FnOnce(f64) -> f64,
    ) -> Result<f64, SettingsError> {
        let read = self.parameter.read(typed);
        let value = read.and_then(|read| read.value(units, self.parameter.dimension, alone));
        value.map_err(|expected| SettingsError::NoValue {
            key: name.to_owned(),
            found: typed.to_owned(),
            expected,
            or_off: self.parameter.off.is_some(),
        })
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.index {
            None => f.pad(self.parameter.name),
            Some(i) => f.pad(&format!("{}.{}", self.parameter.name, i + 1)),
        }
    }
}

impl FromStr for Key {
    type Err = SettingsError;

    /// Reads `speed`, `deadband`, `deadband.2`, `kd.2` ...; the index counts from 1. Keys that name a control bearing are read by
    /// [`Settings::key`].
    fn from_str(typed: &str) -> Result<Self, SettingsError> {
        let unknown = || SettingsError::UnknownKey(typed.to_owned());
        let (name, index) = match typed.split_once('.') {
            None => (typed, None),
            Some((name, index)) => {
                let counted: usize = index.parse().map_err(|_| unknown())?;
                (name, Some(counted.checked_sub(1).ok_or_else(unknown)?))
            }
        };
        let parameter = PARAMETERS.iter().find(|p| p.name == name).ok_or_else(unknown)?;
        if parameter.scope == Scope::Machine && index.is_some() {
            return Err(unknown());
        }
        Ok(Self { parameter, index })
    }
}
