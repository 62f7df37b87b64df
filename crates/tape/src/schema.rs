//! The names in a recording: timelines, entities and columns. From version 1 on, every version stays readable.
//!
//! | entity | what |
//! |---|---|
//! | `/session` | static: versions, run, rotor, as one JSON document |
//! | `/steps` | every step, one row each, one struct with the fields of [`columns`] |
//! | `/settings` | every change: the settings whole, as JSON, and as text for people; `/settings/values`, each as a series |
//! | `/poles` | under each of them: the poles as points, exact in JSON with the settings; `/poles/min_damping` |
//! | `/events` | who did what, when and why; trips, alarms, losses |
//! | `/health` | how the simulation and the recorder keep up, as often as bulletins come |
//! | `/orbits/massN` | curves for the eye, thinned out; `/orbits/massN/deadband`, the clearance in force |

use rotor::MAX_MASSES;

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
/// Curves for the eye.
pub const ORBITS: &str = "orbits";

/// The component that carries a JSON document of ours.
pub const DOCUMENT: &str = "whirl:document";
/// The component that carries a step.
pub const ROW: &str = "whirl:step";

/// A column of numbers in `/steps`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// What it is.
    pub meaning: String,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
}

/// Columns before those of the masses.
pub const HEAD: usize = 7;
/// Columns a mass has.
pub const PER_MASS: usize = 4;

/// The columns of doubles for a rotor of `masses` masses, in order: time, angle, speed, control, then `y z vy vz` a mass.
/// The columns `revision` (64 bits) and `flags` (32 bits) follow them.
#[must_use]
pub fn columns(masses: usize) -> Vec<Column> {
    let column = |name: &str, meaning: &str, unit| Column { name: name.into(), meaning: meaning.into(), unit };
    let head: [Column; HEAD] = [
        column("tau", "time since the rotor was last at rest", "1/w0"),
        column("angle", "spin angle, unwrapped", "rad"),
        column("speed", "spin speed R", "w0"),
        column("uy_commanded", "control that the feedback asks for, y", "w0^2 e_t"),
        column("uz_commanded", "control that the feedback asks for, z", "w0^2 e_t"),
        column("uy", "control that the bearing delivers, y", "w0^2 e_t"),
        column("uz", "control that the bearing delivers, z", "w0^2 e_t"),
    ];
    let per_mass = (1..=masses.min(MAX_MASSES)).flat_map(|k| {
        [
            ("y", "displacement", "e_t"),
            ("z", "displacement", "e_t"),
            ("vy", "velocity", "w0 e_t"),
            ("vz", "velocity", "w0 e_t"),
        ]
        .map(|(name, meaning, unit)| column(&format!("{name}{k}"), &format!("{meaning} of mass {k}"), unit))
    });
    head.into_iter().chain(per_mass).collect()
}

/// Settings revision of a step.
pub const REVISION: &str = "revision";
/// Flags of a step, as in `wire::Flags`.
pub const FLAGS: &str = "flags";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_counted() {
        for masses in [1, 3, MAX_MASSES] {
            let columns = columns(masses);
            assert_eq!(columns.len(), HEAD + PER_MASS * masses);
            let mut names: Vec<_> = columns.iter().map(|c| c.name.as_str()).chain([REVISION, FLAGS]).collect();
            names.sort_unstable();
            let count = names.len();
            names.dedup();
            assert_eq!(names.len(), count);
        }
    }
}
