//! Drills: one fault at a time on a running machine, so that whoever runs it learns its fingerprint.
//!
//! A fault is a change of settings whose reason begins with `drill: `. So it is checked, answered, recorded, played again and undone like any
//! other change, and what a bench does with it is what a recording of it says. [`FaultOrder`] is a fault as it is asked for, and what it
//! changes; [`Drill`] is a row of them over time, a file; [`DrillLog`] knows from the events of a run which fault is there, and what it was
//! put in place of.

mod file;
mod log;

use std::fmt;

use rotor::{Key, Rotor, Settings, SettingsError};
use units::{Dimension, Typed, TypedError};

use crate::units::{ScreenUnits, Unit};
pub use file::{BUILTIN, Drill, DrillStep, builtin, read_drill};
pub use log::{ActiveFault, DrillLog};

/// What stands before the cause of every change that a drill makes.
pub const CAUSE: &str = "drill: ";
/// Why settings change when a fault is put back.
pub const OVER: &str = "drill over";

/// A clearance that nothing ever closes, in `e_t`.
const OPEN: f64 = 1e6;
/// How much later a delay comes that jumps, where the loop has no samples to count by, in `tau`.
const JUMP: f64 = 0.1;

/// What can go wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Sensors read a share of what is there.
    SensorGain,
    /// Sensors read nothing.
    SensorLost,
    /// An amplifier gives a share of what is asked for.
    AmplifierGain,
    /// An amplifier follows no faster than this.
    AmplifierSlew,
    /// An amplifier gives nothing along one axis.
    AxisLost,
    /// A support bearing carries nothing.
    StiffnessLost,
    /// Measurement and computation take longer.
    DelayJump,
    /// A mass comes on.
    UnbalanceAdded,
}

/// Where a fault can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Where {
    Sensor,
    Bearing,
    Support,
    Place,
    Machine,
}

/// A row of the table of faults.
struct FaultRow {
    name: &'static str,
    meaning: &'static str,
    is_at: Where,
    /// What its size is; empty if it has none.
    size: &'static str,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::SensorGain,
        Self::SensorLost,
        Self::AmplifierGain,
        Self::AmplifierSlew,
        Self::AxisLost,
        Self::StiffnessLost,
        Self::DelayJump,
        Self::UnbalanceAdded,
    ];

    fn row(self) -> FaultRow {
        use Where::{Bearing, Machine, Place, Sensor, Support};
        let (name, meaning, is_at, size) = match self {
            Self::SensorGain => ("sensor-gain", "sensors read a share of what is there", Sensor, "the share, else 0.5"),
            Self::SensorLost => ("sensor-lost", "sensors read nothing", Sensor, ""),
            Self::AmplifierGain => {
                ("amplifier-gain", "an amplifier gives a share of what is asked for", Bearing, "the share, else 0.5")
            }
            Self::AmplifierSlew => (
                "amplifier-slew",
                "an amplifier follows no faster than this",
                Bearing,
                "force per time, else 1 m_b w0^3 e_t",
            ),
            Self::AxisLost => ("axis-lost", "an amplifier gives nothing along one axis", Bearing, "y or z, else y"),
            Self::StiffnessLost => ("stiffness-lost", "a support bearing carries nothing", Support, ""),
            Self::DelayJump => (
                "delay-jump",
                "measurement and computation take longer",
                Machine,
                "by how much, else two samples or 0.1 tau",
            ),
            Self::UnbalanceAdded => (
                "unbalance-added",
                "a mass comes on at one place",
                Place,
                "eccentricity U / m of the whole rotor, else 1 e_t",
            ),
        };
        FaultRow { name, meaning, is_at, size }
    }

    /// Its name, as typed and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// What it is, in a few words.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        self.row().meaning
    }

    /// What its size is, and what it is where nothing is said; empty of a fault without one.
    #[must_use]
    pub fn size(self) -> &'static str {
        self.row().size
    }

    /// Where it can be, in words.
    #[must_use]
    pub fn place(self) -> &'static str {
        match self.row().is_at {
            Where::Sensor => "a sensor's mass, else all sensors",
            Where::Bearing => "a control bearing, else the first",
            Where::Support => "a mass with a support bearing, else the first",
            Where::Place => "a mass, else that of the first control bearing",
            Where::Machine => "",
        }
    }

    /// The fault of this name.
    ///
    /// # Errors
    /// There is none.
    pub fn named(name: &str) -> Result<Self, DrillError> {
        let names = Self::ALL.map(Self::name);
        let found = Self::ALL.into_iter().find(|fault| fault.name() == name);
        found.ok_or_else(|| DrillError::Fault {
            found: name.to_owned(),
            known: names.join(", "),
            meant: text::nearest(name, &names).map_or_else(String::new, |meant| format!("; did you mean '{meant}'?")),
        })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Why there is no such drill, or it cannot be held on this machine.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DrillError {
    /// No such fault.
    #[error("no fault '{found}': expected one of {known}{meant}")]
    Fault {
        /// What was asked for.
        found: String,
        /// What there is.
        known: String,
        /// What was probably meant, in words.
        meant: String,
    },
    /// Words that say nothing.
    #[error("'{0}': expected NAME, and perhaps at=PLACE and size=SIZE")]
    StateWords(String),
    /// A place that it cannot be at.
    #[error("{fault} at '{found}': expected {expected}")]
    Place {
        /// The fault.
        fault: Fault,
        /// What was asked for.
        found: String,
        /// What there is.
        expected: String,
    },
    /// Nowhere that it could be.
    #[error("{0}: {1}")]
    Nowhere(Fault, &'static str),
    /// A size that it cannot have.
    #[error("{fault} of size '{found}': expected {expected}")]
    Size {
        /// The fault.
        fault: Fault,
        /// What was asked for.
        found: String,
        /// What there is.
        expected: &'static str,
    },
    /// A size in a unit that this machine does not have.
    #[error("{0}: size = {1}: {2}")]
    Unit(Fault, Typed, TypedError),
    /// It is like that already.
    #[error("{0} would change nothing: the machine is like that already")]
    Nothing(Fault),
    /// What the machine does not take.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

/// What a size without a unit is counted in.
pub type CountedAlone = fn(&ScreenUnits, Key) -> Unit;

/// A fault as it is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultOrder {
    /// Which.
    pub fault: Fault,
    /// Where: the number of a mass or control bearing counted from 1, or its name; nothing for where it is by itself.
    pub at: Option<String>,
    /// How large; nothing for the size that it has by itself. Of [`Fault::AxisLost`] 1 is y, and 2 is z.
    pub size: Option<Typed>,
}

impl FaultOrder {
    /// Reads `sensor-gain at=2 size=0.5`.
    ///
    /// # Errors
    /// No such fault, words that say nothing, or a size that it cannot have.
    pub fn read(words: &str) -> Result<Self, DrillError> {
        let mut words = words.split_whitespace();
        let fault = Fault::named(words.next().unwrap_or_default())?;
        let mut order = Self { fault, at: None, size: None };
        for word in words {
            match word.split_once('=') {
                Some(("at", place)) if !place.is_empty() && order.at.is_none() => order.at = Some(place.to_owned()),
                Some(("size", size)) if order.size.is_none() => order.size = Some(order.read_size(size)?),
                _ => return Err(DrillError::StateWords(word.to_owned())),
            }
        }
        Ok(order)
    }

    /// A size as typed.
    ///
    /// # Errors
    /// One that it cannot have.
    pub fn read_size(&self, typed: &str) -> Result<Typed, DrillError> {
        let expected = match self.fault.size() {
            "" => "none: it has no size",
            size => size,
        };
        let refused = || DrillError::Size { fault: self.fault, found: typed.to_owned(), expected };
        let dimension = match self.fault {
            Fault::AmplifierSlew => Dimension::ForceRate,
            Fault::DelayJump => Dimension::Time,
            Fault::UnbalanceAdded => Dimension::Length,
            _ => Dimension::Number,
        };
        let size = Typed::read(dimension, typed).ok().filter(|size| size.number().is_finite());
        match (self.fault, typed) {
            (Fault::SensorLost | Fault::StiffnessLost, _) => Err(refused()),
            (Fault::AxisLost, "y") => Ok(1.0.into()),
            (Fault::AxisLost, "z") => Ok(2.0.into()),
            (Fault::AxisLost, _) => Err(refused()),
            (Fault::SensorGain | Fault::AmplifierGain, _) => size.filter(|s| s.number() >= 0.0).ok_or_else(refused),
            (Fault::AmplifierSlew | Fault::DelayJump, _) => size.filter(|s| s.number() > 0.0).ok_or_else(refused),
            (Fault::UnbalanceAdded, _) => size.filter(|s| s.number() != 0.0).ok_or_else(refused),
        }
    }

    /// Why the settings change, for the record.
    #[must_use]
    pub fn cause(&self) -> String {
        format!("{CAUSE}{self}")
    }

    /// What it changes under settings of `rotor`, where `active` is the fault that is there already and goes for it: values by key,
    /// dimensionless. A size without a unit is counted in what `alone` says of `units`: [`ScreenUnits::setting`] where people look at a screen,
    /// [`ScreenUnits::setting_in_files`] elsewhere.
    ///
    /// # Errors
    /// A place or size that this machine has not, or nothing to change.
    pub fn changes(
        &self,
        rotor: &Rotor,
        settings: &Settings,
        (units, alone): (&ScreenUnits, CountedAlone),
        active: Option<&ActiveFault>,
    ) -> Result<Vec<(Key, f64)>, DrillError> {
        let back = active.map_or(&[][..], |active| &active.back);
        let mut sound = settings.clone();
        back.iter().try_for_each(|(key, value)| sound.set(*key, *value))?;
        let changes = self.onto(rotor, &sound, (units, alone))?;
        let mut then = sound.clone();
        changes.iter().try_for_each(|(key, value)| then.set(*key, *value))?;
        if then == sound {
            return Err(DrillError::Nothing(self.fault));
        }
        then.check(rotor)?;
        let stays = |(key, _): &&(Key, f64)| !changes.iter().any(|(changed, _)| changed == key);
        Ok(back.iter().filter(stays).copied().chain(changes.iter().copied()).collect())
    }

    fn onto(
        &self,
        rotor: &Rotor,
        settings: &Settings,
        (units, alone): (&ScreenUnits, CountedAlone),
    ) -> Result<Vec<(Key, f64)>, DrillError> {
        let feedback = &settings.feedback;
        let sized = |key: Key, by_itself: f64| {
            let Some(size) = self.size else { return Ok(by_itself) };
            let value = units.value_of(key, size, |number| number / alone(units, key).factor);
            value.map_err(|expected| DrillError::Unit(self.fault, size, expected))
        };
        let share = self.size.map_or(0.5, Typed::number);
        Ok(match self.fault {
            // Whichever sensor it would be of.
            Fault::SensorGain if share == 1.0 => return Err(DrillError::Nothing(self.fault)),
            Fault::SensorGain | Fault::SensorLost => {
                let gain = if self.fault == Fault::SensorLost { 0.0 } else { share };
                let station = self.at.as_deref().map(|at| self.sensor(at, rotor, settings)).transpose()?;
                let meant = feedback.bearings.iter().enumerate();
                let meant = meant.filter(|(_, bearing)| station.is_none_or(|station| bearing.senses(station)));
                let number = station.map_or(0.0, |station| (station + 1) as f64);
                let mut changes = Vec::new();
                for (k, _) in meant {
                    changes.extend([(key("sensor_gain", k)?, gain), (key("sensor_at", k)?, number)]);
                }
                changes
            }
            Fault::AmplifierGain => {
                let bearing = self.bearing(settings)?;
                vec![(key("amplifier_y", bearing)?, share), (key("amplifier_z", bearing)?, share)]
            }
            Fault::AmplifierSlew => {
                let slew = key("slew", self.bearing(settings)?)?;
                vec![(slew, sized(slew, 1.0)?)]
            }
            Fault::AxisLost => {
                let axis = if self.size == Some(2.0.into()) { "amplifier_z" } else { "amplifier_y" };
                vec![(key(axis, self.bearing(settings)?)?, 0.0)]
            }
            Fault::StiffnessLost => vec![(key("deadband", self.support(rotor)?)?, OPEN)],
            Fault::DelayJump => {
                let delay: Key = "delay".parse()?;
                let by_itself = if feedback.sample() > 0.0 { 2.0 * feedback.sample() } else { JUMP };
                vec![(delay, feedback.delay() + sized(delay, by_itself)?)]
            }
            Fault::UnbalanceAdded => {
                let place = match self.at.as_deref() {
                    Some(at) => self.place_of(at, rotor)?,
                    None => feedback.first().station,
                };
                let added = key("unbalance_added", place)?;
                vec![(added, sized(added, 1.0)?)]
            }
        })
    }

    fn no_place(&self, found: &str, expected: String) -> DrillError {
        DrillError::Place { fault: self.fault, found: found.to_owned(), expected }
    }

    /// The place of the rotor, counted from 0, that is called so.
    fn place_of(&self, at: &str, rotor: &Rotor) -> Result<usize, DrillError> {
        let named = (0..rotor.len()).find(|place| rotor.place_name(*place) == at);
        let numbered = at.parse::<usize>().ok().and_then(|n| n.checked_sub(1)).filter(|place| *place < rotor.len());
        named.or(numbered).ok_or_else(|| self.no_place(at, format!("a place from 1 to {}, or its name", rotor.len())))
    }

    fn sensor(&self, at: &str, rotor: &Rotor, settings: &Settings) -> Result<usize, DrillError> {
        let place = self.place_of(at, rotor)?;
        let is_sensed = |place: &usize| settings.feedback.bearings.iter().any(|bearing| bearing.senses(*place));
        if is_sensed(&place) {
            return Ok(place);
        }
        let known: Vec<String> = (0..rotor.len()).filter(is_sensed).map(|place| (place + 1).to_string()).collect();
        Err(self.no_place(at, format!("a place with a sensor: {}", known.join(", "))))
    }

    fn bearing(&self, settings: &Settings) -> Result<usize, DrillError> {
        let feedback = &settings.feedback;
        let Some(at) = self.at.as_deref() else { return Ok(0) };
        feedback.find(at).ok_or_else(|| {
            let known: Vec<String> = (0..feedback.bearings.len()).map(|k| feedback.label(k)).collect();
            self.no_place(at, format!("a control bearing: {}", known.join(", ")))
        })
    }

    fn support(&self, rotor: &Rotor) -> Result<usize, DrillError> {
        let met: Vec<usize> = (0..rotor.len()).filter(|place| rotor.has_contact(*place)).collect();
        let first = *met.first().ok_or(DrillError::Nowhere(self.fault, "no support bearing carries this rotor"))?;
        let Some(at) = self.at.as_deref() else { return Ok(first) };
        let place = self.place_of(at, rotor)?;
        let known = || met.iter().map(|place| (place + 1).to_string()).collect::<Vec<_>>().join(", ");
        if met.contains(&place) {
            Ok(place)
        } else {
            Err(self.no_place(at, format!("a place with a support bearing: {}", known())))
        }
    }
}

impl fmt::Display for FaultOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.fault)?;
        if let Some(at) = &self.at {
            write!(f, " at={at}")?;
        }
        match (self.fault, self.size) {
            (_, None) => Ok(()),
            (Fault::AxisLost, Some(axis)) => write!(f, " size={}", if axis == 2.0.into() { "z" } else { "y" }),
            // In one word, as it is typed.
            (_, Some(size)) => write!(f, " size={}", size.to_string().replace(' ', "")),
        }
    }
}

/// The key of a setting of this place.
fn key(name: &str, place: usize) -> Result<Key, SettingsError> {
    format!("{name}.{}", place + 1).parse()
}

#[cfg(test)]
mod tests;
