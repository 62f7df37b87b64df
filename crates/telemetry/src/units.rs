//! The one place that turns the dimensionless quantities of a bench into those on the screen: of a rotor given in SI units
//! micrometres, newtons, rpm and hertz, of any other what it is counted in. `tau` stays `tau`, with seconds beside it where there is room.

mod told;
mod typed;

use alarms::Watch;
use rotor::{ControlMasses, Feedback, Key, Rotor, Scales};
use units::Dimension;

pub use units::Unit;

/// What is watched, as a quantity.
#[must_use]
pub fn dimension_of(watch: Watch) -> Dimension {
    match watch {
        Watch::Orbit => Dimension::Length,
        Watch::Force => Dimension::Force,
        Watch::DelayMargin => Dimension::Time,
        _ => Dimension::Number,
    }
}

/// The units of a bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenUnits {
    /// Scales of a rotor in SI units.
    pub scales: Option<Scales>,
    /// Displacements and clearances.
    pub length: Unit,
    /// Velocities of masses.
    pub velocity: Unit,
    /// The control force of the first control bearing, in which the largest of several is told too.
    pub force: Unit,
    /// By which control is a force, bearing by bearing.
    pub masses: ControlMasses,
    /// Frequencies of whirl.
    pub frequency: Unit,
    /// Real and imaginary parts of poles.
    pub rate: Unit,
    /// Spin speeds.
    pub speed: Unit,
}

impl ScreenUnits {
    /// Those of a rotor that is counted in its own scales.
    pub const DIMENSIONLESS: Self = Self {
        scales: None,
        length: Unit { factor: 1.0, name: "e_t" },
        velocity: Unit { factor: 1.0, name: "w0 e_t" },
        force: Unit { factor: 1.0, name: "m_b w0² e_t" },
        masses: ControlMasses::ONES,
        frequency: Unit { factor: 1.0, name: "w0" },
        rate: Unit { factor: 1.0, name: "w0" },
        speed: Unit { factor: 1.0, name: "R" },
    };

    /// Those of a machine.
    pub fn of_machine(rotor: &Rotor, feedback: &Feedback) -> Self {
        Self::of(rotor.scales().copied(), ControlMasses::of(rotor, feedback))
    }

    /// Those of a bench whose bench status has `scales`, with control bearings that carry these masses.
    pub fn of(scales: Option<Scales>, masses: ControlMasses) -> Self {
        let Some(scales) = scales else { return Self { masses, ..Self::DIMENSIONLESS } };
        // One prefix for a rotor, whatever it does: numbers must not jump.
        let (per_metre, length, velocity) = match scales.e_t {
            ..1e-3 => (1e6, "μm", "μm/s"),
            ..1.0 => (1e3, "mm", "mm/s"),
            _ => (1.0, "m", "m/s"),
        };
        let si = |dimension: Dimension| dimension.si(&scales, masses.ratio(0));
        let with_prefix = |dimension, name| Unit { factor: si(dimension).factor * per_metre, name };
        Self {
            scales: Some(scales),
            length: with_prefix(Dimension::Length, length),
            velocity: with_prefix(Dimension::Velocity, velocity),
            force: si(Dimension::Force),
            masses,
            frequency: si(Dimension::Frequency),
            rate: si(Dimension::Rate),
            speed: si(Dimension::Speed),
        }
    }

    /// The control force of a control bearing, counted from 0.
    pub fn force_of(&self, bearing: usize) -> Unit {
        Unit { factor: self.factor_of(bearing) * self.force.factor, ..self.force }
    }

    /// How many times the force of the first control bearing one of the same number is at another; 1 where things are told as they are.
    pub fn factor_of(&self, bearing: usize) -> f64 {
        if self.scales.is_some() { self.masses.as_of_first(bearing, 1.0) } else { 1.0 }
    }

    /// What a quantity of a step is counted in; forces as those of the first control bearing.
    pub fn of_dimension(&self, dimension: Dimension) -> Unit {
        match dimension {
            // `tau` stays `tau`.
            Dimension::Whole | Dimension::Number | Dimension::Time => Unit { factor: 1.0, name: "" },
            Dimension::Angle => Unit { factor: 1.0, name: "rad" },
            Dimension::Speed => self.speed,
            Dimension::SpeedRate => match self.scales {
                Some(scales) => dimension.si(&scales, 1.0),
                None => Unit { factor: 1.0, name: "w0²" },
            },
            Dimension::Length => self.length,
            Dimension::Velocity => self.velocity,
            Dimension::Force => self.force,
            Dimension::ForceRate => match self.scales {
                Some(scales) => Unit { factor: self.force.factor * scales.w0, name: "N/s" },
                None => Unit { factor: 1.0, name: "m_b w0³ e_t" },
            },
            Dimension::Frequency => self.frequency,
            Dimension::Rate => self.rate,
            Dimension::Stiffness | Dimension::Damping => match self.scales {
                Some(scales) => dimension.si(&scales, self.masses.ratio(0)),
                None => Unit { factor: 1.0, name: "" },
            },
        }
    }

    /// What a setting is counted in where it is shown, and typed without a unit: clearances in what radii are in.
    pub fn setting(&self, key: Key) -> Unit {
        match (self.scales, key.parameter.dimension) {
            (None, _) => Unit { factor: 1.0, name: key.parameter.unit() },
            (Some(_), Dimension::Length) => self.length,
            (Some(scales), dimension) => dimension.si(&scales, self.masses.of_key(key)),
        }
    }

    /// The same on the command line and in files, which count lengths in metres.
    pub fn setting_in_files(&self, key: Key) -> Unit {
        match self.scales {
            None => self.setting(key),
            Some(_) => self.table_of(key).unit(key.parameter.dimension),
        }
    }

    /// The table of units for a setting.
    fn table_of(&self, key: Key) -> units::Units {
        units::Units::of(self.scales, self.masses.of_key(key))
    }

    /// The table of units, forces being those of the first control bearing.
    pub fn table(&self) -> units::Units {
        units::Units::of(self.scales, self.masses.ratio(0))
    }
}

#[cfg(test)]
mod tests;
