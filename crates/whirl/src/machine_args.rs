//! Which machine: the words that every command on a rotor shares.

use clap::Args;
use machine::CountedModes;
use rotor::{C64, Rotor, Settings, builtin};
use units::Dimension;

use crate::failure::Failure;
use crate::output::rounded;
use crate::quantity::{self, TypedQuantity};
use crate::units::CommandUnits;

/// Which machine: the options that every command on a rotor shares.
#[derive(Clone, Debug, Args)]
pub(crate) struct MachineArgs {
    /// The rotor: jeffcott, three-mass, rig, or a TOML file
    #[arg(value_name = "ROTOR", default_value = "three-mass")]
    pub rotor: String,
    /// The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub feedback: Option<String>,
    /// Clearance of every support bearing, in e_t (SI rotors: in m)
    #[arg(long, value_name = "G", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Length))]
    pub deadband: Option<TypedQuantity>,
    /// Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// How much of a rotor linear analysis looks at.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Whole {
    /// Look at all coordinates of shaft elements, not at those that are stepped
    #[arg(long)]
    pub full: bool,
}

/// Which modes the smallest damping is told of.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct BelowArgs {
    /// With shaft elements: the damping of modes counts up to this frequency in Hz, while all are to be stable [default: 4 times the
    /// top speed, and past the fourth forward mode]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Frequency))]
    pub below: Option<TypedQuantity>,
}

impl BelowArgs {
    /// Up to where modes count, in radians per `tau`, if somebody has said so.
    ///
    /// # Errors
    /// A frequency that leaves no modes, or is given for a chain.
    pub(crate) fn typed(self, rotor: &Rotor) -> Result<Option<f64>, Failure> {
        let Some(typed) = self.below else { return Ok(None) };
        if rotor.is_chain() {
            return Err(Failure::Usage("--below: every mode of a chain of masses counts: leave it out".into()));
        }
        if !(typed.number().is_finite() && typed.number() > 0.0) {
            return Err(Failure::Usage(format!("--below {typed}: expected a frequency in Hz above 0")));
        }
        CommandUnits::of(rotor).read("--below", typed).map(Some)
    }

    /// The modes that count, `top` being the highest speed that is looked at.
    ///
    /// # Errors
    /// As for [`BelowArgs::typed`], or poles that cannot be had.
    pub(crate) fn modes(self, rotor: &Rotor, settings: &Settings, top: f64) -> Result<CountedModes, Failure> {
        match self.typed(rotor)? {
            Some(below) => Ok(CountedModes::up_to(below)),
            None => Ok(CountedModes::usual(rotor, settings, top)?),
        }
    }

    /// The same of a rotor whose poles at the top speed are known.
    ///
    /// # Errors
    /// As for [`BelowArgs::typed`].
    pub(crate) fn among(
        self,
        rotor: &Rotor,
        poles: impl IntoIterator<Item = C64>,
        top: f64,
    ) -> Result<CountedModes, Failure> {
        Ok(match self.typed(rotor)? {
            Some(below) => CountedModes::up_to(below),
            None => CountedModes::at(rotor, top, poles),
        })
    }
}

/// What is said of the modes that count: nothing where all do. `others` are poles of those that do not.
pub(crate) fn counted(modes: &CountedModes, units: CommandUnits) -> Option<String> {
    let hertz = rounded(units.frequency(modes.below()?));
    Some(format!("modes up to {hertz} Hz count, those above where they do not decay: --below"))
}

impl MachineArgs {
    /// The feedback and the settings that were typed, as the end of a title: pictures of one rotor under several are told apart by it.
    pub(crate) fn subtitle(&self) -> String {
        let feedback = self.feedback.iter().map(|name| format!("feedback {name}"));
        let typed: Vec<String> = feedback.chain(self.set.iter().cloned()).collect();
        if typed.is_empty() { String::new() } else { format!("; {}", typed.join(", ")) }
    }

    /// Whether `--set` sets this key.
    pub(crate) fn sets(&self, key: &str) -> bool {
        self.set.iter().any(|typed| rotor::typed::pair(typed).is_ok_and(|(name, _)| name == key))
    }

    /// The feedback that analysis takes of this rotor where none is named, if none is: there are others.
    pub(crate) fn feedback_taken(&self, rotor: &Rotor) -> Option<&'static str> {
        let names = builtin::feedback_names(rotor);
        let is_named = self.feedback.is_some() || self.sets("feedback");
        (!is_named && names.len() > 1).then(|| builtin::analysis_feedback_name(rotor))
    }

    /// Refuses settings of the speed beside what sets it all along.
    ///
    /// # Errors
    /// `speed` or `ramp` among the settings, with the name of what sets it.
    pub(crate) fn leaves_speed_alone(&self, along: &str) -> Result<(), Failure> {
        let sets_speed = |typed: &&String| {
            rotor::typed::pair(typed).is_ok_and(|(key, _)| key.trim() == "speed" || key.trim() == "ramp")
        };
        match self.set.iter().find(sets_speed) {
            None => Ok(()),
            Some(typed) => Err(Failure::Usage(format!(
                "'{typed}' does nothing: the speed follows {along}. Expected one of the two"
            ))),
        }
    }

    /// The options among these that were given and set something, each with its key, beside `others` of the command.
    #[must_use]
    pub(crate) fn said(&self, others: &[(&'static str, &'static str)]) -> Vec<(&'static str, &'static str)> {
        let ours = [
            self.feedback.as_ref().map(|_| ("--feedback", "feedback")),
            self.deadband.map(|_| ("--deadband", "deadband")),
        ];
        ours.into_iter().flatten().chain(others.iter().copied()).collect()
    }
}
