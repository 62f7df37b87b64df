//! Impulses and masses as typed on the command line.

use std::str::FromStr;

use rotor::C64;
use rotor::typed::{PairError, pair, pairs};
use units::{Dimension, Typed};

use crate::failure::Failure;
use crate::quantity::{self, TypedQuantity};
use crate::units::CommandUnits;

/// An impulse as typed, the mass counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ImpulseArg {
    pub(super) mass: usize,
    /// Along y and z.
    pub(super) change: [TypedQuantity; 2],
    pub(super) at: TypedQuantity,
}

/// Why what was typed is no impulse, or no mass.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum TypedError {
    /// Not what an impulse looks like.
    #[error("expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5")]
    Form,
    /// The same key again.
    #[error(transparent)]
    Twice(PairError),
    /// Not a finite number, or not in a unit of it.
    #[error("{key} = '{found}': {expected}")]
    Number {
        /// The key.
        key: String,
        /// What was typed.
        found: String,
        /// What was expected instead.
        expected: String,
    },
    /// A time before the start.
    #[error("at = {0}: expected a time of 0 or later")]
    Time(Typed),
    /// An impulse that changes no velocity.
    #[error("no velocity changes: expected vy=V or vz=V other than 0, such as mass=1,vy=-2.5")]
    Nothing,
    /// Not `mass=N`.
    #[error("expected mass=N, such as mass=1")]
    NoMass,
    /// Not a mass.
    #[error("mass = '{0}': expected a mass, counted from 1")]
    Mass(String),
}

impl FromStr for ImpulseArg {
    type Err = TypedError;

    fn from_str(typed: &str) -> Result<Self, TypedError> {
        let none = |dimension| TypedQuantity { dimension, typed: 0.0.into() };
        let (mut mass, mut change, mut at) = (None, [none(Dimension::Velocity); 2], none(Dimension::Time));
        let pairs = pairs(typed.split(',')).map_err(|error| match error {
            PairError::Form(_) => TypedError::Form,
            twice @ PairError::Twice { .. } => TypedError::Twice(twice),
        })?;
        for (key, value) in pairs {
            let number = |dimension| {
                let read = quantity::of(dimension)(value).map_err(|error| error.to_string());
                let finite = |read: &TypedQuantity| read.number().is_finite();
                let expected = || "expected a finite number".to_owned();
                let read = read.and_then(|read| Some(read).filter(finite).ok_or_else(expected));
                read.map_err(|expected| TypedError::Number { key: key.to_owned(), found: value.to_owned(), expected })
            };
            match key {
                "mass" => mass = Some(mass_number(value)?),
                "vy" => change[0] = number(Dimension::Velocity)?,
                "vz" => change[1] = number(Dimension::Velocity)?,
                "at" => at = number(Dimension::Time)?,
                _ => return Err(TypedError::Form),
            }
        }
        match mass {
            _ if at.number() < 0.0 => Err(TypedError::Time(at.typed)),
            None => Err(TypedError::Form),
            Some(_) if change.iter().all(|along| along.number() == 0.0) => Err(TypedError::Nothing),
            Some(mass) => Ok(Self { mass, change, at }),
        }
    }
}

impl ImpulseArg {
    /// The change of velocity in `e_t` per `tau`, and the `tau` of it, on a machine in these units.
    ///
    /// # Errors
    /// An SI unit for a rotor without scales.
    pub(super) fn value(&self, units: CommandUnits) -> Result<(C64, f64), Failure> {
        let [y, z] = self.change.map(|along| units.read("--impulse", along));
        Ok((C64::new(y?, z?), units.read_dimensionless("--impulse", self.at)?))
    }
}

/// A mass as typed, `mass=N`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MassArg(pub(super) usize);

impl FromStr for MassArg {
    type Err = TypedError;

    fn from_str(typed: &str) -> Result<Self, TypedError> {
        match pair(typed) {
            Ok(("mass", number)) => mass_number(number).map(Self),
            _ => Err(TypedError::NoMass),
        }
    }
}

fn mass_number(typed: &str) -> Result<usize, TypedError> {
    typed.parse().ok().filter(|n| *n > 0).ok_or_else(|| TypedError::Mass(typed.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impulses_read_as_typed() {
        let read = |typed: &str| typed.parse::<ImpulseArg>();
        // w0 = 300 rad/s and e_t = 20 um: a velocity of 1 is 6 mm/s.
        let scales = rotor::Scales { w0: 300.0, k_t: 3.6e6, m_t: 40.0, e_t: 20e-6 };
        let value = |typed: &str, scales| {
            let read = read(typed).unwrap();
            read.value(CommandUnits::with(scales)).map(|(change, at)| (read.mass, change, at))
        };
        assert_eq!(value("mass=1,vy=-2.5", None).unwrap(), (1, C64::new(-2.5, 0.0), 0.0));
        assert_eq!(value("vz=1,at=20,mass=3", None).unwrap(), (3, C64::new(0.0, 1.0), 20.0));
        let near = |typed: &str, [y, z, at]: [f64; 3]| {
            let (_, change, found) = value(typed, Some(scales)).unwrap();
            assert!((change - C64::new(y, z)).norm() < 1e-12 && (found - at).abs() < 1e-9, "{typed}: {change} {found}");
        };
        near("mass=1,vy=6mm/s,vz=-0.006m/s,at=20ms", [1.0, -1.0, 6.0]);
        // A number alone is in m/s, and a time in tau.
        near("mass=1,vy=0.006,at=20", [1.0, 0.0, 20.0]);
        assert!(value("mass=1,vy=6mm/s", None).is_err());
        for (typed, why) in [
            ("vy=1", "expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5"),
            ("", "expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5"),
            ("mass=0,vy=1", "mass = '0': expected a mass, counted from 1"),
            ("mass=1,vy=nan", "vy = 'nan': expected a finite number"),
            ("mass=1,vy=3rpm", "vy = '3rpm': expected a number, alone or in m/s, mm/s, um/s"),
            ("mass=1,vy=1,vy=2", "vy is given twice: expected each key once"),
            ("mass=1,vy=1,mass=1", "mass is given twice: expected each key once"),
            ("mass=1", "no velocity changes: expected vy=V or vz=V other than 0, such as mass=1,vy=-2.5"),
            ("mass=1,vy=0,vz=-0.0", "no velocity changes: expected vy=V or vz=V other than 0, such as mass=1,vy=-2.5"),
            ("mass=1,at=20", "no velocity changes: expected vy=V or vz=V other than 0, such as mass=1,vy=-2.5"),
            ("mass=1,vy=1,at=-3", "at = -3: expected a time of 0 or later"),
        ] {
            assert_eq!(read(typed).unwrap_err().to_string(), why, "{typed}");
        }
    }
}
