//! `KEY=VALUE` as a person types it.

use rotor::typed::{Assigned, PairError, Undone, pair};
use rotor::{Key, Rotor, Settings};

use super::feedback;
use crate::failure::Failure;
use crate::units::CommandUnits;

/// Applies each `KEY=VALUE` to `settings`, in the order in which they stand. `said` are options that have set something
/// before, each with its key.
///
/// # Errors
/// As for [`assign`], or one that leaves nothing of another one, or of an option.
pub(crate) fn assign_all(
    rotor: &Rotor,
    units: CommandUnits,
    settings: &mut Settings,
    said: &[(&str, &str)],
    assignments: &[String],
) -> Result<(), Failure> {
    let mut assigned = Assigned::new(rotor.len());
    let mut note = |key: &str, typed: &str, settings: &Settings| match key {
        "feedback" => Ok(assigned.feedback(typed)?),
        key => Ok::<_, Failure>(assigned.key(settings.key(key)?, typed)?),
    };
    for (option, key) in said {
        note(key, option, settings)?;
    }
    for typed in assignments {
        let key = assign(rotor, units, settings, typed)?;
        note(key, typed, settings)?;
    }
    Ok(())
}

/// Applies one `KEY=VALUE` to `settings`, and returns the key; `feedback` takes a name or a file, every other key a
/// number, which says its unit or is in rpm, m, N/m and N s/m where `units` are SI.
///
/// # Errors
/// No `=`, or whatever the key or the value has wrong.
pub(crate) fn assign<'t>(
    rotor: &Rotor,
    units: CommandUnits,
    settings: &mut Settings,
    assignment: &'t str,
) -> Result<&'t str, Failure> {
    let (key, value) = pair(assignment)?;
    if key == "feedback" {
        settings.feedback = feedback(rotor, value)?;
        return Ok(key);
    }
    let parsed: Key = settings.key(key)?;
    units.assign(rotor, settings, parsed, (key, value)).map(|()| key)
}

impl From<PairError> for Failure {
    fn from(error: PairError) -> Self {
        match error {
            PairError::Form(_) => Self::Usage(format!("{error}, such as speed=3")),
            PairError::Twice { .. } => Self::Usage(error.to_string()),
        }
    }
}

impl From<Undone> for Failure {
    fn from(error: Undone) -> Self {
        Self::Usage(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use rotor::{PhysicalMass, file};

    use super::*;

    /// 40 kg with w0 = 300 rad/s and e_t = 20 um.
    fn rig() -> (Rotor, Settings) {
        let mass = PhysicalMass { mass: 40.0, bearing_stiffness: 3.6e6, unbalance: 20e-6, ..PhysicalMass::default() };
        let rotor = Rotor::from_si("rig", vec![mass], vec![], None).expect("valid");
        let settings = Settings::new(&rotor, 0.0, feedback(&rotor, "off").expect("any rotor has it"));
        (rotor, settings)
    }

    #[test]
    fn assignments_to_an_si_rotor_are_in_rpm_and_metres() {
        let (rotor, mut settings) = rig();
        let mut set = |assignment: &str| {
            assign(&rotor, CommandUnits::of(&rotor), &mut settings, assignment)
                .map(drop)
                .map_err(|error| error.to_string())
        };
        set("speed=6000").expect("in range");
        set("deadband=50e-6").expect("in range");
        set("trip=1e-3").expect("in range");
        set("kd=1.8e6").expect("in range");
        set("cd=-6 kN.s/m").expect("in range");
        assert_eq!(
            set("trip=1e-9").expect_err("too small"),
            "trip = 0.000000001 m: expected a number from 2.00000e-8 to 20000.0 m"
        );
        assert_eq!(set("speed=fast").expect_err("no number"), "speed = 'fast': expected a number");
        // 6000 rpm are 200 pi rad/s.
        assert!((settings.speed - 200.0 * std::f64::consts::PI / 300.0).abs() < 1e-12);
        assert!((settings.deadband[0] - 2.5).abs() < 1e-12);
        assert!((settings.trip - 50.0).abs() < 1e-12);
        // 40 kg (300/s)^2 = 3.6e6 N/m, and 40 kg 300/s = 12 000 N s/m.
        assert!((settings.get("kd".parse().expect("a key")).expect("exists") - 0.5).abs() < 1e-12);
        assert!((settings.get("cd".parse().expect("a key")).expect("exists") + 0.5).abs() < 1e-12);
    }

    #[test]
    fn an_assignment_may_say_what_it_is_counted_in() {
        let (rotor, mut settings) = rig();
        let mut set = |rotor: &Rotor, assignment: &str, value: f64| {
            let key =
                assign(rotor, CommandUnits::of(rotor), &mut settings, assignment).map_err(|error| error.to_string())?;
            let found = settings.get(key.parse().expect("a key")).expect("exists");
            assert!((found / value - 1.0).abs() < 1e-12, "{assignment}: {found} for {value}");
            Ok::<_, String>(())
        };
        // 50 Hz are 100 pi rad/s.
        set(&rotor, "speed=50Hz", std::f64::consts::PI / 3.0).expect("in range");
        set(&rotor, "deadband=50um", 2.5).expect("in range");
        set(&rotor, "kd=0.25w0^2", 0.25).expect("in range");
        set(&rotor, "delay=1ms", 0.3).expect("in range");
        let wrong = set(&rotor, "kd=3N", 0.0).expect_err("a force");
        assert_eq!(wrong, "kd = '3N': expected a number, alone or in N/m, kN/m, MN/m, N/mm, N/um");
        let plain = rotor.dimensionless();
        let wrong = set(&plain, "speed=50Hz", 0.0).expect_err("no scales");
        assert_eq!(wrong, "speed = '50Hz': expected a number without a unit: the rotor is not one in SI units");
    }

    /// 30 kg and 10 kg with a control bearing each, `left` on the second.
    fn unequal() -> (Rotor, Settings) {
        let mass = |mass| PhysicalMass { mass, bearing_stiffness: 1.8e6, unbalance: 10e-6, ..PhysicalMass::default() };
        let rotor = Rotor::from_si("rig", vec![mass(30.0), mass(10.0)], vec![1e6], None).expect("valid");
        let one = |name: &str, mass| {
            format!("[[bearing]]\nname = '{name}'\nmass = {mass}\n[[bearing.signal]]\nmass = {mass}\n")
        };
        let feedback = file::read_feedback_for(&(one("left", 2) + &one("right", 1)), &rotor).expect("fits");
        let settings = Settings::new(&rotor, 0.0, feedback);
        (rotor, settings)
    }

    /// K_t e_t are 72 N, so that u = 1 is 18 N on 10 kg of 40 and 54 N on 30 kg.
    #[test]
    fn val_newtons_are_by_the_mass_of_their_own_control_bearing() {
        let (rotor, mut settings) = unequal();
        let units = CommandUnits::of(&rotor);
        let mut set = |typed: &str| {
            let told = assign(&rotor, units, &mut settings, typed).map(drop).map_err(|error| error.to_string());
            told.map(|()| settings.feedback.bearings.iter().map(|b| [b.parts.limit, b.parts.slew]).collect::<Vec<_>>())
        };
        let near = |found: Vec<[f64; 2]>, expected: [[f64; 2]; 2]| {
            for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!(found == expected || (found / expected - 1.0).abs() < 1e-12, "{found} and {expected}");
            }
        };
        let off = f64::INFINITY;
        near(set("left.limit=90").expect("in range"), [[5.0, off], [off, off]]);
        near(set("right.limit=108").expect("in range"), [[5.0, off], [2.0, off]]);
        // What is typed for all is that for each.
        near(set("limit=54").expect("in range"), [[3.0, off], [1.0, off]]);
        // Per second: w0 = 300 rad/s.
        near(set("slew=16200").expect("in range"), [[3.0, 3.0], [1.0, 1.0]]);
        assert_eq!(
            set("limit=1e-9").expect_err("too small"),
            "left.limit = 0.000000001 N: expected a number from 1.80000e-8 to 1.80000e13 N, or off"
        );
        near(set("limit=off").expect("in range"), [[off, 3.0], [off, 1.0]]);
    }

    #[test]
    fn what_is_set_twice_or_by_an_option_and_again_is_refused() {
        let (rotor, settings) = rig();
        let set = |said: &[(&str, &str)], typed: &[&str]| {
            let typed: Vec<String> = typed.iter().map(|typed| (*typed).to_owned()).collect();
            let told = assign_all(&rotor, CommandUnits::of(&rotor), &mut settings.clone(), said, &typed);
            told.map_err(|error| error.to_string())
        };
        let undone = |first: &str, then: &str| {
            Err(format!("'{first}' does nothing: '{then}' sets the same. Expected each once"))
        };
        assert_eq!(set(&[("--speed", "speed")], &["deadband=20e-6"]), Ok(()));
        assert_eq!(set(&[], &["speed=1", "speed=2"]), undone("speed=1", "speed=2"));
        assert_eq!(set(&[("--speed", "speed")], &["speed=2"]), undone("--speed", "speed=2"));
        assert_eq!(set(&[("--deadband", "deadband")], &["deadband.1=0"]), undone("--deadband", "deadband.1=0"));
        assert_eq!(set(&[("--feedback", "feedback")], &["feedback=off"]), undone("--feedback", "feedback=off"));
        assert_eq!(set(&[], &["kd=1", "feedback=off"]), undone("kd=1", "feedback=off"));
    }
}
