//! Impulses and masses as typed on the command line.

use std::str::FromStr;

use rotor::C64;
use rotor::typed::{PairError, pair, pairs};

/// An impulse as typed, the mass counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ImpulseArg {
    pub(super) mass: usize,
    pub(super) change: C64,
    pub(super) at: f64,
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
    /// Not a finite number.
    #[error("{key} = '{found}': expected a finite number")]
    Number {
        /// The key.
        key: String,
        /// What was typed.
        found: String,
    },
    /// A time before the start.
    #[error("at = {0}: expected a time of 0 or later")]
    Time(f64),
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
        let (mut mass, mut change, mut at) = (None, C64::ZERO, 0.0);
        let pairs = pairs(typed.split(',')).map_err(|error| match error {
            PairError::Form(_) => TypedError::Form,
            twice @ PairError::Twice { .. } => TypedError::Twice(twice),
        })?;
        for (key, value) in pairs {
            let number = || {
                let parsed = value.parse::<f64>().ok().filter(|v| v.is_finite());
                parsed.ok_or_else(|| TypedError::Number { key: key.to_owned(), found: value.to_owned() })
            };
            match key {
                "mass" => mass = Some(mass_number(value)?),
                "vy" => change.re = number()?,
                "vz" => change.im = number()?,
                "at" => at = number()?,
                _ => return Err(TypedError::Form),
            }
        }
        match mass {
            _ if at < 0.0 => Err(TypedError::Time(at)),
            None => Err(TypedError::Form),
            Some(_) if change == C64::ZERO => Err(TypedError::Nothing),
            Some(mass) => Ok(Self { mass, change, at }),
        }
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
        assert_eq!(read("mass=1,vy=-2.5"), Ok(ImpulseArg { mass: 1, change: C64::new(-2.5, 0.0), at: 0.0 }));
        assert_eq!(read("vz=1,at=20,mass=3"), Ok(ImpulseArg { mass: 3, change: C64::new(0.0, 1.0), at: 20.0 }));
        for (typed, why) in [
            ("vy=1", "expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5"),
            ("", "expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5"),
            ("mass=0,vy=1", "mass = '0': expected a mass, counted from 1"),
            ("mass=1,vy=nan", "vy = 'nan': expected a finite number"),
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
