//! What happened, in words and in the units of the machine that it happened to.

use alarms::{Level, LevelChange, Watch};
use wire::Happening;
use wire::message::Trip;

use crate::replay::RecordedKind;
use crate::units::ScreenUnits;

impl ScreenUnits {
    /// What has tripped a machine.
    pub fn trip(&self, trip: &Trip) -> String {
        if self.scales.is_none() {
            return trip.to_string();
        }
        let (radius, limit) = (self.length.told(trip.radius, 5), self.length.told(trip.limit, 5));
        trip.words(&radius, &limit)
    }

    /// What happened on a bench.
    pub fn happening(&self, happening: &Happening) -> String {
        match happening {
            Happening::Tripped(trip) => format!("tripped: {}", self.trip(trip)),
            Happening::Impulse { mass, velocity } if self.scales.is_some() => {
                let [vy, vz] = [velocity.re, velocity.im].map(|part| self.velocity.short(part, 5));
                format!("impulse on mass {}: vy {vy}, vz {vz} {}", mass + 1, self.velocity.name)
            }
            excited @ Happening::Excited(_) => excited.told(self.scales),
            other => other.to_string(),
        }
    }

    /// What became of an alarm.
    pub fn turn(&self, turn: &LevelChange) -> String {
        let unit = match turn.watch {
            Watch::Orbit => self.length,
            Watch::Force => self.force,
            _ => return turn.to_string(),
        };
        if self.scales.is_none() || (turn.rises() && !turn.cause.is_empty()) {
            return turn.to_string();
        }
        let [value, limit, worst] = [turn.value, turn.limit, turn.worst].map(|value| unit.told(value, 4));
        let (watch, level) = (turn.watch, turn.level.name());
        match turn.level {
            Level::Fine => format!("{watch} within its limits again: {value}, at worst {worst}"),
            _ if turn.rises() => format!("{level}: {watch} {value}, limit {limit}"),
            _ => format!("{watch} back to a {level}: {value}, limit {limit}"),
        }
    }

    /// What a recording tells.
    pub fn past(&self, what: &RecordedKind) -> String {
        match what {
            RecordedKind::Happening(happening) => self.happening(happening),
            RecordedKind::Alarm(turn) => self.turn(turn),
            RecordedKind::Remark(words) => words.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use rotor::C64;
    use wire::Moment;

    use super::*;
    use crate::test_support::SI;

    #[test]
    fn val_what_happened_to_a_machine_in_si_units_is_told_in_them() {
        // e_t = 5 um, w0 = 1000 rad/s: 5 mm/s for one w0 e_t.
        let units = ScreenUnits::of(Some(SI), rotor::ControlMasses::default());
        let trip = Trip { cause: 1, mass: 2, step: 77, radius: 6.0, limit: 5.0 };
        assert_eq!(units.trip(&trip), "orbit of mass 2 reached 30.000 μm, past the limit of 25.000 μm");
        assert_eq!(units.happening(&Happening::Tripped(trip)), format!("tripped: {}", units.trip(&trip)));
        let impulse = Happening::Impulse { mass: 0, velocity: C64::new(0.5, -0.25) };
        assert_eq!(units.happening(&impulse), "impulse on mass 1: vy 2500.0, vz -1250.0 μm/s");
        assert_eq!(ScreenUnits::DIMENSIONLESS.happening(&impulse), impulse.to_string());
        assert_eq!(ScreenUnits::DIMENSIONLESS.trip(&trip), trip.to_string());
        let turn = LevelChange {
            at: Moment::default(),
            watch: Watch::Orbit,
            before: Level::Fine,
            level: Level::Warning,
            value: 2.0,
            limit: 1.0,
            worst: 2.0,
            cause: String::new(),
        };
        assert_eq!(units.turn(&turn), "warning: orbit 10.00 μm, limit 5.000 μm");
        let fell = LevelChange { before: Level::Warning, level: Level::Fine, ..turn };
        assert_eq!(units.turn(&fell), "orbit within its limits again: 10.00 μm, at worst 10.00 μm");
    }
}
