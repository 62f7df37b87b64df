//! From what a person types to a machine: rotors and feedback by name or from a file, and the settings they start with.

use std::fs::File;
use std::io::{IsTerminal, Read};
use std::path::Path;

use rotor::file;
use rotor::profile::Profile;
use rotor::typed::{Assigned, PairError, Undone, pair};
use rotor::{Feedback, Key, Rotor, Settings, builtin};
use text::{Faults, MAX_BYTES};

use crate::failure::Failure;
use crate::machine_args::{MachineArgs, Whole};
use crate::quantity::{QuantityRange, TypedQuantity};
use crate::range::Range;
use crate::units::Units;

/// Why there is nothing to be had from a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum FileError {
    /// Its bytes cannot be read.
    #[error("{file}: {found}: expected a TOML file that can be read")]
    Unreadable {
        /// The file as typed.
        file: String,
        /// What is there instead.
        found: String,
    },
    /// What it says is wrong.
    #[error("{}", faults.in_file(file))]
    Wrong {
        /// The file as typed.
        file: String,
        /// What it says.
        text: String,
        /// What is wrong with it.
        faults: Faults,
    },
}

impl FileError {
    /// What is wrong with a file that says `text`.
    pub(crate) fn wrong(file: &str, text: &str, faults: Faults) -> Self {
        Self::Wrong { file: file.to_owned(), text: text.to_owned(), faults }
    }

    /// It as stderr has it: a line a fault for scripts, and on a terminal the file's own line under each.
    pub(crate) fn told(&self) -> String {
        match self {
            Self::Wrong { file, text, faults } if std::io::stderr().is_terminal() => faults.drawn(file, text),
            _ => self.to_string(),
        }
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self::Usage(error.told())
    }
}

/// Whether what was typed means a file: it ends in `.toml` or has a path separator.
pub(crate) fn is_file(typed: &str) -> bool {
    typed.contains(std::path::is_separator) || typed.ends_with(".toml")
}

/// The text of a file, which may be a pipe, up to the largest size that is read.
///
/// # Errors
/// It is not there, not a file, not readable, too large or not UTF-8.
pub(crate) fn text(path: &str) -> Result<String, FileError> {
    let unreadable = |found: String| FileError::Unreadable { file: path.to_owned(), found };
    let failed = |error: std::io::Error| {
        unreadable(match error.kind() {
            std::io::ErrorKind::NotFound => "no such file".into(),
            std::io::ErrorKind::PermissionDenied => "no permission to read it".into(),
            std::io::ErrorKind::IsADirectory => "a directory".into(),
            _ => error.to_string(),
        })
    };
    let opened = File::open(path).map_err(failed)?;
    if opened.metadata().is_ok_and(|data| data.is_dir()) {
        return Err(unreadable("a directory".into()));
    }
    let mut bytes = Vec::new();
    // One byte more than allowed, so that too much is seen without reading all of it.
    opened.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(failed)?;
    let text = text::utf8(&bytes, "a TOML file").map_err(|faults| FileError::wrong(path, "", faults))?;
    Ok(text.to_owned())
}

/// The rotor in a file's text; the file's stem is its name if it gives none.
///
/// # Errors
/// All that is wrong with it.
pub(crate) fn rotor_of(path: &str, text: &str) -> Result<Rotor, FileError> {
    let stem = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
    // Files that it names lie beside it.
    let folder = Path::new(path).parent().unwrap_or(Path::new("")).to_owned();
    let open = move |name: &str| {
        let of_matrices = folder.join(name);
        std::fs::read(&of_matrices)
            .map_err(|error| format!("{}: {error}: expected a file of matrices", of_matrices.display()))
    };
    file::read_rotor_with(text, &stem, &open).map_err(|faults| FileError::wrong(path, text, faults))
}

/// The feedback in a file's text, for a rotor if it is known.
///
/// # Errors
/// All that is wrong with it.
pub(crate) fn feedback_of(path: &str, text: &str, rotor: Option<&Rotor>) -> Result<Feedback, FileError> {
    let read = rotor.map_or_else(|| file::read_feedback(text, None), |rotor| file::read_feedback_for(text, rotor));
    read.map_err(|faults| FileError::wrong(path, text, faults))
}

/// The rotor of that name, or in that file.
///
/// # Errors
/// No such rotor: the message lists what there is. Or all that is wrong with the file.
pub(crate) fn rotor(typed: &str) -> Result<Rotor, Failure> {
    if is_file(typed) {
        return Ok(rotor_of(typed, &text(typed)?)?);
    }
    builtin::rotor(typed).ok_or_else(|| {
        let known = builtin::ROTORS.join(", ");
        let meant = text::meant(typed, &builtin::ROTORS);
        Failure::Usage(format!("no rotor '{typed}': {meant}built in are {known}; {A_FILE_TOO}"))
    })
}

/// The profile of speed in a file, for `rotor`.
///
/// # Errors
/// A file that cannot be read, or all that is wrong with it.
pub(crate) fn profile(rotor: &Rotor, path: &str) -> Result<Profile, Failure> {
    let text = text(path)?;
    Ok(file::read_profile(&text, rotor).map_err(|faults| FileError::wrong(path, &text, faults))?)
}

/// The feedback of that name for `rotor`, or in that file.
///
/// # Errors
/// No such feedback for this rotor: the message lists what there is. Or all that is wrong with the file, or does not
/// fit the rotor.
pub(crate) fn feedback(rotor: &Rotor, typed: &str) -> Result<Feedback, Failure> {
    if is_file(typed) {
        let text = text(typed)?;
        return Ok(file::read_feedback_for(&text, rotor).map_err(|faults| FileError::wrong(typed, &text, faults))?);
    }
    builtin::feedback(rotor, typed).ok_or_else(|| {
        let known = builtin::feedback_names(rotor).join(", ");
        let (meant, name) = (text::meant(typed, builtin::feedback_names(rotor)), rotor.name());
        Failure::Usage(format!("no feedback '{typed}' for {name}: {meant}built in are {known}; {A_FILE_TOO}"))
    })
}

const A_FILE_TOO: &str = "a path or a name that ends in .toml is a file";

/// What feedback a command takes when none is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Default {
    /// Analysis looks at the rotor as it is: `off`, or on magnetic bearings of its own the law that these have.
    Analysis,
    /// The same of a motion that a trip ends.
    Trips,
    /// A live bench starts stable: `cancel`, `composite`, or `off` for a rotor that has neither.
    Live,
}

/// A rotor and the settings it runs under.
#[derive(Clone, Debug)]
pub(crate) struct Machine {
    /// The rotor.
    pub rotor: Rotor,
    /// Settings that fit it.
    pub settings: Settings,
}

impl Machine {
    /// The machine that the common options describe, at a speed as typed; at standstill if there is none.
    ///
    /// # Errors
    /// An unknown name, a file with something wrong, or a value that does not fit the rotor.
    pub(crate) fn open(
        args: &MachineArgs,
        typed_speed: Option<TypedQuantity>,
        default: Default,
    ) -> Result<Self, Failure> {
        Self::open_at(args, typed_speed.map(|speed| ("--speed", speed)), default)
    }

    /// The same at a speed as typed for the option that is named.
    fn open_at(
        args: &MachineArgs,
        typed_speed: Option<(&str, TypedQuantity)>,
        default: Default,
    ) -> Result<Self, Failure> {
        let rotor = rotor(&args.rotor)?;
        let name = args.feedback.as_deref().unwrap_or(match default {
            Default::Analysis | Default::Trips => builtin::analysis_feedback_name(&rotor),
            Default::Live => builtin::live_feedback_name(&rotor),
        });
        let mut settings = Settings::new(&rotor, 0.0, feedback(&rotor, name)?);
        let units = Units::of(&rotor);
        for (key, typed) in [("speed", typed_speed.map(|(_, speed)| speed)), ("deadband", args.deadband)] {
            if let Some(typed) = typed {
                units.set(&rotor, &mut settings, key.parse()?, typed.typed)?;
            }
        }
        settings.check(&rotor)?;
        let mut machine = Self { rotor, settings };
        // A live bench has defaults of its own, which `--set` changes too.
        if default != Default::Live {
            let mut said: Vec<(&str, &str)> = args.said(&[]);
            said.extend(typed_speed.map(|(option, _)| (option, "speed")));
            if default == Default::Trips {
                machine.assign(&said, &args.set)?;
            } else {
                machine.set(&said, &args.set)?;
            }
        }
        Ok(machine)
    }

    /// The same, its rotor with all coordinates of its shaft elements if that is asked for.
    ///
    /// # Errors
    /// A chain, which has no others; matrices that are no plant.
    pub(crate) fn whole(mut self, whole: Whole) -> Result<Self, Failure> {
        if whole.full {
            if self.rotor.is_chain() {
                let why = "--full: a chain of masses is looked at in its own coordinates already";
                return Err(Failure::Usage(format!("{why}: {} is one", self.rotor.name())));
            }
            self.rotor = self.rotor.in_full().map_err(|error| Failure::Work(error.to_string()))?;
        }
        Ok(self)
    }

    /// The machine of a sweep over the speeds `over` as typed, all of which must be allowed, and that range of `R`.
    ///
    /// # Errors
    /// As for [`Machine::open`].
    pub(crate) fn open_over(args: &MachineArgs, over: QuantityRange) -> Result<(Self, Range), Failure> {
        let at = |typed| {
            let end = TypedQuantity { dimension: over.dimension, typed };
            Self::open_at(args, Some(("--over", end)), Default::Analysis)
        };
        at(over.typed.to)?;
        let machine = at(over.typed.from)?;
        // Ends that differ in the last place may fall together.
        let range = machine.units().read_range("--over", over)?;
        Ok((machine, range))
    }

    /// Changes its settings for work offline by `KEY=VALUE` each. `said` are the options that have set something
    /// already, each with its key: `--set` is there for what has no option.
    ///
    /// # Errors
    /// As for [`assign_all`]; an assignment that undoes an option; what only a live bench looks at: the trip limit, and the ramp
    /// to a speed, at which everything offline is already.
    pub(crate) fn set(&mut self, said: &[(&str, &str)], assignments: &[String]) -> Result<(), Failure> {
        const LIVE: [(&str, &str); 6] = [
            ("trip", "trips"),
            ("ramp", "is on its way to a speed"),
            ("coast_down", "coasts down after a trip"),
            ("external", "has a controller outside"),
            ("external_trip", "has a controller outside"),
            ("unbalance_added", "is unbalanced further while it turns: offline the rotor's own file says how much"),
        ];
        for typed in assignments {
            // Whichever mass or bearing it is of.
            let name = |typed: &str| self.settings.key(typed).ok().map(|key| key.parameter.name);
            let live = |(key, _): (&str, &str)| LIVE.into_iter().find(|(live, _)| Some(*live) == name(key.trim()));
            if let Some((_, does)) = pair(typed).ok().and_then(live) {
                return Err(Failure::Usage(format!("'{typed}' does nothing here: only a live bench {does}")));
            }
        }
        self.assign(said, assignments)
    }

    fn assign(&mut self, said: &[(&str, &str)], assignments: &[String]) -> Result<(), Failure> {
        assign_all(&self.rotor, self.units(), &mut self.settings, said, assignments)?;
        Ok(self.settings.check(&self.rotor)?)
    }

    /// Mass ratio `Rm` of the mass that carries the first control bearing: the largest force of several is counted as its own.
    #[must_use]
    pub(crate) fn bearing_mass(&self) -> f64 {
        self.rotor.control_mass(self.settings.feedback.first().station)
    }

    /// What its numbers are typed and shown in.
    #[must_use]
    pub(crate) fn units(&self) -> Units {
        Units::of(&self.rotor)
    }
}

/// Applies each `KEY=VALUE` to `settings`, in the order in which they stand. `said` are options that have set something
/// before, each with its key.
///
/// # Errors
/// As for [`assign`], or one that leaves nothing of another one, or of an option.
pub(crate) fn assign_all(
    rotor: &Rotor,
    units: Units,
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
    units: Units,
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
    use rotor::PhysicalMass;

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
            assign(&rotor, Units::of(&rotor), &mut settings, assignment).map(drop).map_err(|error| error.to_string())
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
            let key = assign(rotor, Units::of(rotor), &mut settings, assignment).map_err(|error| error.to_string())?;
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
        let units = Units::of(&rotor);
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
            let told = assign_all(&rotor, Units::of(&rotor), &mut settings.clone(), said, &typed);
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

    #[test]
    fn a_path_or_a_toml_name_is_a_file() {
        for typed in ["a.toml", "./a", "/dev/stdin", "folder/"] {
            assert!(is_file(typed), "{typed}");
        }
        for typed in ["jeffcott", "three-mass", "toml", "."] {
            assert!(!is_file(typed), "{typed}");
        }
    }
}
