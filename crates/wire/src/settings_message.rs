//! Settings as they travel: [`rotor::Settings`] with every list given a fixed place.

use control::PARTS;
use iceoryx2::prelude::ZeroCopySend;
use rotor::{Feedback, Filter, Gain, GainKind, MAX_MASSES, Parts, Settings, Signal};

use crate::WireError;
use crate::filter_message::{FilterMessage, MAX_FILTERS};

/// Points of all tabulated gains together.
pub const MAX_KNOTS: usize = 1024;

/// The settings of a machine, whole. Lists are filled from the front; counts say how far.
#[derive(Clone, Copy, Debug, ZeroCopySend)]
#[repr(C)]
pub struct SettingsMessage {
    /// Spin speed `R`.
    pub speed: f64,
    /// Orbit radius at which the machine trips, in `e_t`.
    pub trip: f64,
    /// Greatest rate of change of the speed; infinite where it jumps.
    pub ramp: f64,
    /// The loop around the law, in the order of [`control::PARTS`].
    pub parts: [f64; PARTS.len()],
    /// Clearance of each mass's support bearing, in `e_t`.
    pub deadband: [f64; MAX_MASSES],
    /// How many masses there are.
    pub masses: u32,
    /// The mass that carries the control bearing, counted from 0.
    pub bearing: u32,
    /// How many signals there are.
    pub signals: u32,
    /// How many entries of `knots` are used.
    pub knots_used: u32,
    /// The signals.
    pub signal: [SignalMessage; MAX_MASSES],
    /// What shapes signals and their sum, those of each in a row; the first without a kind ends them.
    pub filters: [FilterMessage; MAX_FILTERS],
    /// The `[speed, value]` points of all tabulated gains, one table after the other.
    pub knots: [[f64; 2]; MAX_KNOTS],
}

/// One feedback signal.
#[derive(Clone, Copy, Debug, Default, ZeroCopySend)]
#[repr(C)]
pub struct SignalMessage {
    /// Weight of each displacement.
    pub displacement: [f64; MAX_MASSES],
    /// Weight of each velocity.
    pub velocity: [f64; MAX_MASSES],
    /// The gains `kd cd kc cc`.
    pub gains: [GainMessage; 4],
}

/// One gain over speed.
#[derive(Clone, Copy, Debug, Default, ZeroCopySend)]
#[repr(C)]
pub struct GainMessage {
    /// 0 constant, 1 linear, 2 table.
    pub kind: u32,
    /// Table: its first entry in `knots`.
    pub first: u32,
    /// Table: how many entries.
    pub count: u32,
    /// Always 0.
    pub reserved: u32,
    /// Constant: the value. Linear: the value at `R = 0`.
    pub value: f64,
    /// Linear: change per unit of speed.
    pub slope: f64,
}

impl Default for SettingsMessage {
    fn default() -> Self {
        Self {
            speed: 0.0,
            trip: 0.0,
            ramp: 0.0,
            parts: [0.0; PARTS.len()],
            deadband: [0.0; MAX_MASSES],
            masses: 0,
            bearing: 0,
            signals: 0,
            knots_used: 0,
            signal: [SignalMessage::default(); MAX_MASSES],
            filters: [FilterMessage::default(); MAX_FILTERS],
            knots: [[0.0; 2]; MAX_KNOTS],
        }
    }
}

impl SettingsMessage {
    /// Packs settings for the journey.
    ///
    /// # Errors
    /// Tables with more than [`MAX_KNOTS`] points in all, or lists longer than any rotor has.
    pub fn pack(settings: &Settings) -> Result<Self, WireError> {
        let mut packed = Self {
            speed: settings.speed,
            trip: settings.trip,
            ramp: settings.ramp,
            parts: PARTS.map(|part| (part.get)(&settings.feedback.parts)),
            masses: settings.deadband.len() as u32,
            bearing: settings.feedback.bearing as u32,
            signals: settings.feedback.signals.len() as u32,
            ..Self::default()
        };
        copy(&mut packed.deadband, &settings.deadband)?;
        if settings.feedback.signals.len() > MAX_MASSES {
            return Err(WireError::DoesNotFit(format!("{} signals, at most {MAX_MASSES} fit", packed.signals)));
        }
        let filters = filters_of(&settings.feedback);
        if filters.len() > MAX_FILTERS {
            return Err(WireError::DoesNotFit(format!("{} filters, at most {MAX_FILTERS} fit", filters.len())));
        }
        packed.filters[..filters.len()].copy_from_slice(&filters);
        for (place, signal) in packed.signal.iter_mut().zip(&settings.feedback.signals) {
            copy(&mut place.displacement, &signal.displacement)?;
            copy(&mut place.velocity, &signal.velocity)?;
            for (place, gain) in place.gains.iter_mut().zip(&signal.gains) {
                *place = match gain {
                    Gain::Constant(value) => GainMessage { value: *value, ..GainMessage::default() },
                    Gain::Linear { at_zero, slope } => {
                        GainMessage { kind: 1, value: *at_zero, slope: *slope, ..GainMessage::default() }
                    }
                    Gain::Table(points) => {
                        let first = packed.knots_used as usize;
                        let room = packed.knots.get_mut(first..first + points.len()).ok_or_else(|| {
                            WireError::DoesNotFit(format!("gain tables have more than {MAX_KNOTS} points in all"))
                        })?;
                        for (knot, (speed, value)) in room.iter_mut().zip(points) {
                            *knot = [*speed, *value];
                        }
                        packed.knots_used += points.len() as u32;
                        GainMessage {
                            kind: 2,
                            first: first as u32,
                            count: points.len() as u32,
                            ..GainMessage::default()
                        }
                    }
                };
            }
        }
        Ok(packed)
    }

    /// Unpacks them again. Counts from a foreign writer are held within bounds; [`Settings::check`] judges the rest.
    #[must_use]
    pub fn unpack(&self) -> Settings {
        let masses = (self.masses as usize).min(MAX_MASSES);
        let gain = |message: &GainMessage| match message.kind {
            0 => Gain::Constant(message.value),
            1 => Gain::Linear { at_zero: message.value, slope: message.slope },
            _ => {
                let (first, count) = (message.first as usize, message.count as usize);
                let knots = self.knots.get(first..first.saturating_add(count)).unwrap_or_default();
                Gain::Table(knots.iter().map(|[speed, value]| (*speed, *value)).collect())
            }
        };
        let mut signals: Vec<Signal> = self.signal[..(self.signals as usize).min(MAX_MASSES)]
            .iter()
            .map(|signal| Signal {
                displacement: signal.displacement[..masses].to_vec(),
                velocity: signal.velocity[..masses].to_vec(),
                gains: GainKind::ALL.map(|kind| gain(&signal.gains[kind as usize])),
                filters: vec![],
            })
            .collect();
        let mut filters = Vec::new();
        for message in &self.filters {
            let Some(filter) = message.unpack() else { break };
            match (message.signal as usize).checked_sub(1) {
                None => filters.push(filter),
                Some(signal) => {
                    if let Some(signal) = signals.get_mut(signal) {
                        signal.filters.push(filter);
                    }
                }
            }
        }
        let mut parts = Parts::default();
        PARTS.iter().zip(self.parts).for_each(|(part, value)| (part.set)(&mut parts, value));
        Settings {
            speed: self.speed,
            deadband: self.deadband[..masses].to_vec(),
            trip: self.trip,
            ramp: self.ramp,
            feedback: Feedback { bearing: self.bearing as usize, signals, filters, parts },
        }
    }
}

/// Those of the bearing, then those of every signal.
fn filters_of(feedback: &Feedback) -> Vec<FilterMessage> {
    let of = |filters: &[Filter], signal| -> Vec<FilterMessage> {
        filters.iter().map(|filter| FilterMessage::pack(filter, signal)).collect()
    };
    let mut all = of(&feedback.filters, 0);
    all.extend(feedback.signals.iter().enumerate().flat_map(|(i, signal)| of(&signal.filters, i + 1)));
    all
}

fn copy(place: &mut [f64; MAX_MASSES], values: &[f64]) -> Result<(), WireError> {
    let room = place
        .get_mut(..values.len())
        .ok_or_else(|| WireError::DoesNotFit(format!("{} values, at most {MAX_MASSES} fit", values.len())))?;
    room.copy_from_slice(values);
    Ok(())
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    #[test]
    fn settings_survive_the_journey() {
        for name in builtin::ROTORS {
            let rotor = builtin::rotor(name).unwrap();
            for feedback in builtin::feedback_names(&rotor) {
                let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).unwrap());
                settings.deadband[0] = 0.75;
                settings.feedback.signals[0].gains[1] = Gain::Table(vec![(0.0, 1.0), (2.0, 3.0)]);
                settings.feedback.signals[0].gains[3] = Gain::Table(vec![(1.0, -1.0)]);
                settings.ramp = 0.25;
                settings.feedback.parts = Parts { delay: 0.02, limit: 20.0, seed: 3.0, ..Parts::default() };
                settings.feedback.filters = vec![Filter::SynchronousNotch { width: 0.1 }];
                settings.feedback.signals[0].filters = vec![
                    Filter::Lowpass { corner: 8.0, order: 3 },
                    Filter::Lead { zero: 1.0, pole: 2.0 },
                    Filter::Notch { frequency: 3.0, width: 0.2 },
                    Filter::Integrator { rate: 0.1 },
                    Filter::Derivative { corner: 9.0 },
                    Filter::Transfer { numerator: vec![1.0; 9], denominator: vec![2.0; 9] },
                ];
                assert_eq!(SettingsMessage::pack(&settings).unwrap().unpack(), settings);
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let rotor = builtin::rotor("jeffcott").unwrap();
        let mut settings = Settings::new(&rotor, 1.0, builtin::feedback(&rotor, "off").unwrap());
        settings.feedback.signals[0].gains[0] = Gain::Table((0..1025).map(|i| (f64::from(i), 0.0)).collect());
        assert!(SettingsMessage::pack(&settings).unwrap_err().to_string().contains("1024 points"));
    }

    #[test]
    fn foreign_counts_do_not_reach_out_of_bounds() {
        let mut message = SettingsMessage { masses: 99, signals: 99, ..SettingsMessage::default() };
        message.signal[0].gains[0] = GainMessage { kind: 7, first: 1000, count: u32::MAX, ..GainMessage::default() };
        let settings = message.unpack();
        assert_eq!((settings.deadband.len(), settings.feedback.signals.len()), (16, 16));
        assert!(settings.check(&builtin::rotor("jeffcott").unwrap()).is_err());
    }
}
