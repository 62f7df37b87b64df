//! A rotor and the settings it runs under, from the options that most commands share.

use rotor::typed::pair;
use rotor::{Rotor, Settings, builtin};

use super::{assign_all, feedback, rotor};
use crate::failure::Failure;
use crate::machine_args::{MachineArgs, Whole};
use crate::output::Cell;
use crate::quantity::{QuantityRange, TypedQuantity};
use crate::range::Range;
use crate::units::CommandUnits;

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
    /// The feedback that was taken because none was named, where there are others.
    taken: Option<&'static str>,
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
        let units = CommandUnits::of(&rotor);
        for (key, typed) in [("speed", typed_speed.map(|(_, speed)| speed)), ("deadband", args.deadband)] {
            if let Some(typed) = typed {
                units.set(&rotor, &mut settings, key.parse()?, typed.typed)?;
            }
        }
        settings.check(&rotor)?;
        let taken = if default == Default::Live { None } else { args.feedback_taken(&rotor) };
        let mut machine = Self { rotor, settings, taken };
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

    /// The feedback that was taken because none was named, in words for `not said, so taken`.
    pub(crate) fn taken(&self) -> Option<String> {
        self.taken.map(|name| format!("feedback {name} (--feedback)"))
    }

    /// What a place, counted from 0, is called in a table for people: a mass by its number, a place of a shaft by its name.
    pub(crate) fn place_cell(&self, place: usize) -> Cell {
        if self.rotor.is_chain() { Cell::from(&(place + 1)) } else { Cell::from(&self.rotor.place_name(place)) }
    }

    /// What stands over such a column.
    pub(crate) fn place_heading(&self) -> &'static str {
        if self.rotor.is_chain() { "mass" } else { "place" }
    }

    /// What is told to people, with what was taken because it was not said below.
    pub(crate) fn with_taken(&self, told: &str) -> String {
        let Some(taken) = self.taken() else { return told.to_owned() };
        let told = told.trim_end_matches('\n');
        format!("{told}{}not said, so taken: {taken}", if told.is_empty() { "" } else { "\n" })
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
    pub(crate) fn units(&self) -> CommandUnits {
        CommandUnits::of(&self.rotor)
    }
}
