//! The names in a recording: timelines, entities and columns. From version 1 on, every version stays readable.
//!
//! | entity | what |
//! |---|---|
//! | `/session` | static: versions, run, rotor, as one JSON document |
//! | `/steps` | every step, one row each, one struct with the fields of [`columns`] |
//! | `/settings` | every change: the settings whole, as JSON, and as text for people; `/settings/values`, each as a series |
//! | `/poles` | under each of them: the poles as points, exact in JSON with the settings; `/poles/min_damping` |
//! | `/events` | who did what, when and why; trips, alarms, losses |
//! | `/health` | how the simulation and the recorder keep up, as often as bench statuses come |
//! | `/snapshots` | all of the machine now and then, to go on from: step made next, its length (bits of a double), [`machine::Machine::save`] |
//! | `/orbits/massN` | curves for the eye, thinned out; `/orbits/massN/deadband`, the clearance in force |

use wire::StepLayout;

/// Version of what recordings hold. Raised when a reader of the older version would misread; never lowered.
pub const VERSION: u32 = 1;

/// Application id in the file, by which viewers group recordings and layouts.
pub const APPLICATION: &str = "whirl";

/// Step number since the simulation started.
pub const STEP: &str = "step";
/// Dimensionless time as a duration, 1 s for 1; falls back to 0 with a restart. Rounded to 1e-9; exact in the steps.
pub const TAU: &str = "tau";
/// Wall clock when a step was due, nanoseconds since 1970.
pub const WALL: &str = "wall";

/// The document about the whole file.
pub const SESSION: &str = "session";
/// The steps.
pub const STEPS: &str = "steps";
/// Settings in force.
pub const SETTINGS: &str = "settings";
/// Poles under them.
pub const POLES: &str = "poles";
/// What happened.
pub const EVENTS: &str = "events";
/// How well simulation and recorder keep up.
pub const HEALTH: &str = "health";
/// All of the machine.
pub const SNAPSHOTS: &str = "snapshots";
/// Curves for the eye.
pub const ORBITS: &str = "orbits";
/// The rotor in space, for the eye.
pub const SHAFT: &str = "shaft";

/// The component that carries a JSON document of ours.
pub const DOCUMENT: &str = "whirl:document";
/// The component that carries a step.
pub const ROW: &str = "whirl:step";
/// The component that carries a snapshot: words of 64 bits.
pub const SNAPSHOT: &str = "whirl:snapshot";

/// A column of numbers in `/steps`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NumberColumn {
    /// Its name.
    pub name: String,
    /// What it is.
    pub meaning: String,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
}

/// The columns of doubles of steps that are laid out like this, in order: those of the table of channels ([`wire::CHANNELS`]). The
/// columns `revision` (64 bits) and `flags` (32 bits) follow them.
#[must_use]
pub fn columns(layout: StepLayout) -> Vec<NumberColumn> {
    let described = |column: wire::Column| NumberColumn {
        name: column.name(),
        meaning: column.meaning(),
        unit: column.channel.row().dimension.unit(),
    };
    layout.number_columns().map(described).collect()
}

/// Settings revision of a step.
pub const REVISION: &str = "revision";
/// Flags of a step, as in `wire::Flags`.
pub const FLAGS: &str = "flags";

#[cfg(test)]
mod tests {
    use rotor::MAX_MASSES;

    use super::*;

    #[test]
    fn names_are_unique_and_counted() {
        for masses in [1, 3, MAX_MASSES] {
            let layout = StepLayout::new(masses).with_bearings(masses.min(rotor::MAX_BEARINGS));
            let columns = columns(layout);
            assert_eq!(columns.len(), layout.numbers());
            let mut names: Vec<_> = columns.iter().map(|c| c.name.as_str()).chain([REVISION, FLAGS]).collect();
            names.sort_unstable();
            let count = names.len();
            names.dedup();
            assert_eq!(names.len(), count);
        }
    }
}
