//! A fault as it is asked for, and what it changes on a machine.

use std::fmt;

use rotor::{Key, Rotor, Settings, SettingsError};
use units::{Dimension, Typed};

use super::{ActiveFault, CAUSE, DrillError, Fault};
use crate::units::{ScreenUnits, Unit};

/// A clearance that nothing ever closes, in `e_t`.
const OPEN: f64 = 1e6;

/// How much later a delay comes that jumps, where the loop has no samples to count by, in `tau`.
const JUMP: f64 = 0.1;

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
                _ => return Err(DrillError::Words(word.to_owned())),
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
