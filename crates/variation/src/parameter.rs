//! What may be another number, and how it is called.

use std::fmt;

use rotor::{FIELDS, Key};

use crate::drawn::{Drawn, Together};
use crate::stencil::{STEP, STEP_OF_DRAWINGS};

/// What a [`Parameter`] is.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// A setting, as `whirl set` knows it.
    Setting(Key),
    /// A factor on all gains of a control bearing (from 0); of all if none is said. It is 1 as the machine stands: what a wrong
    /// force constant does.
    LoopGain(Option<usize>),
    /// A corner, frequency or width of a filter: which filter, counted through all of the feedback, and which of its numbers.
    Filter {
        /// The filter, from 0.
        filter: usize,
        /// Which of [`control::Filter::positive`].
        number: usize,
    },
    /// A parameter of a mass of a chain: the row of [`rotor::FIELDS`] and the mass, from 0.
    Field {
        /// Index in [`rotor::FIELDS`].
        field: usize,
        /// The mass.
        mass: usize,
    },
    /// The stiffness ratio of a shaft of a chain, from 0.
    Shaft(usize),
    /// The factor from 0 to 1 that a clearance leaves of the stiffness of the support bearing at a mass of a chain, from 0. It is 1 as
    /// linear analysis has it.
    Factor(usize),
    /// A number of a drawing, in SI units.
    Drawn {
        /// Which.
        row: Drawn,
        /// Of which part, from 0.
        at: usize,
    },
    /// A factor on several numbers of one part of a drawing: `disc.1.inertia`, `material.1.moduli`. It is 1 as the machine stands.
    Together {
        /// Which.
        of: Together,
        /// Of which part, from 0.
        at: usize,
    },
}

/// A number that a machine is made of. Made by [`crate::Model::parameter`].
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// What it is.
    pub quantity: Quantity,
    pub(crate) name: String,
}

impl Parameter {
    /// Its name as typed: `speed`, `kd.2`, `damping.1`, `shaft.2`, `disc.1.mass`, `gain`, `filter.1.corner`.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether it is of the rotor, and not of what holds it by feedback or of its speed: what `whirl margin --box` takes to be unsure.
    #[must_use]
    pub fn is_of_rotor(&self) -> bool {
        matches!(self.quantity, Quantity::Field { .. } | Quantity::Shaft(_)) || self.is_drawn()
    }

    fn is_drawn(&self) -> bool {
        matches!(self.quantity, Quantity::Drawn { .. } | Quantity::Together { .. })
    }

    /// The step of differences by it, relative to its value.
    pub(crate) fn step(&self) -> f64 {
        if self.is_drawn() { STEP_OF_DRAWINGS } else { STEP }
    }

    /// Whether linear analysis knows it: clearance, unbalance, noise and limits play no part there.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        const NOT: [&str; 12] = [
            "ramp",
            "coast_down",
            "deadband",
            "trip",
            "noise",
            "quantum",
            "seed",
            "limit",
            "slew",
            "external",
            "external_trip",
            "unbalance_added",
        ];
        match &self.quantity {
            Quantity::Setting(key) => !NOT.contains(&key.parameter.name),
            Quantity::Field { field, .. } => FIELDS[*field].name != "unbalance",
            _ => true,
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.name)
    }
}
