//! What can go wrong with a machine: the table of faults.

use std::fmt;

use super::DrillError;

/// What can go wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Sensors read a share of what is there.
    SensorGain,
    /// Sensors read nothing.
    SensorLost,
    /// An amplifier gives a share of what is asked for.
    AmplifierGain,
    /// An amplifier follows no faster than this.
    AmplifierSlew,
    /// An amplifier gives nothing along one axis.
    AxisLost,
    /// A support bearing carries nothing.
    StiffnessLost,
    /// Measurement and computation take longer.
    DelayJump,
    /// A mass comes on.
    UnbalanceAdded,
}

/// Where a fault can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Where {
    Sensor,
    Bearing,
    Support,
    Place,
    Machine,
}

/// A row of the table of faults.
struct FaultRow {
    name: &'static str,
    meaning: &'static str,
    is_at: Where,
    /// What its size is; empty if it has none.
    size: &'static str,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::SensorGain,
        Self::SensorLost,
        Self::AmplifierGain,
        Self::AmplifierSlew,
        Self::AxisLost,
        Self::StiffnessLost,
        Self::DelayJump,
        Self::UnbalanceAdded,
    ];

    fn row(self) -> FaultRow {
        use Where::{Bearing, Machine, Place, Sensor, Support};
        let (name, meaning, is_at, size) = match self {
            Self::SensorGain => ("sensor-gain", "sensors read a share of what is there", Sensor, "the share, else 0.5"),
            Self::SensorLost => ("sensor-lost", "sensors read nothing", Sensor, ""),
            Self::AmplifierGain => {
                ("amplifier-gain", "an amplifier gives a share of what is asked for", Bearing, "the share, else 0.5")
            }
            Self::AmplifierSlew => (
                "amplifier-slew",
                "an amplifier follows no faster than this",
                Bearing,
                "force per time, else 1 m_b w0^3 e_t",
            ),
            Self::AxisLost => ("axis-lost", "an amplifier gives nothing along one axis", Bearing, "y or z, else y"),
            Self::StiffnessLost => ("stiffness-lost", "a support bearing carries nothing", Support, ""),
            Self::DelayJump => (
                "delay-jump",
                "measurement and computation take longer",
                Machine,
                "by how much, else two samples or 0.1 tau",
            ),
            Self::UnbalanceAdded => (
                "unbalance-added",
                "a mass comes on at one place",
                Place,
                "eccentricity U / m of the whole rotor, else 1 e_t",
            ),
        };
        FaultRow { name, meaning, is_at, size }
    }

    /// Its name, as typed and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// What it is, in a few words.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        self.row().meaning
    }

    /// What its size is, and what it is where nothing is said; empty of a fault without one.
    #[must_use]
    pub fn size(self) -> &'static str {
        self.row().size
    }

    /// Where it can be, in words.
    #[must_use]
    pub fn place(self) -> &'static str {
        match self.row().is_at {
            Where::Sensor => "a sensor's mass, else all sensors",
            Where::Bearing => "a control bearing, else the first",
            Where::Support => "a mass with a support bearing, else the first",
            Where::Place => "a mass, else that of the first control bearing",
            Where::Machine => "",
        }
    }

    /// The fault of this name.
    ///
    /// # Errors
    /// There is none.
    pub fn named(name: &str) -> Result<Self, DrillError> {
        let names = Self::ALL.map(Self::name);
        let found = Self::ALL.into_iter().find(|fault| fault.name() == name);
        found.ok_or_else(|| DrillError::Fault {
            found: name.to_owned(),
            known: names.join(", "),
            meant: text::nearest(name, &names).map_or_else(String::new, |meant| format!("; did you mean '{meant}'?")),
        })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
