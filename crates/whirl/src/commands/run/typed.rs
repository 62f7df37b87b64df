//! Impulses and masses as typed on the command line.

use std::str::FromStr;

use rotor::C64;

/// An impulse as typed, the mass counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ImpulseArg {
    pub(super) mass: usize,
    pub(super) change: C64,
    pub(super) at: f64,
}

impl FromStr for ImpulseArg {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let expected = "expected mass=N[,vy=V][,vz=V][,at=TAU], such as mass=1,vy=-2.5";
        let (mut mass, mut change, mut at) = (None, C64::ZERO, 0.0);
        for part in typed.split(',') {
            let (key, value) = part.split_once('=').ok_or(expected)?;
            let number = || {
                let parsed = value.trim().parse::<f64>().ok().filter(|v| v.is_finite());
                parsed.ok_or_else(|| format!("{key} = '{value}': expected a finite number"))
            };
            match key.trim() {
                "mass" => mass = Some(mass_number(value)?),
                "vy" => change.re = number()?,
                "vz" => change.im = number()?,
                "at" => at = number()?,
                _ => return Err(expected.into()),
            }
        }
        if at < 0.0 {
            return Err(format!("at = {at}: expected a time of 0 or later"));
        }
        Ok(Self { mass: mass.ok_or(expected)?, change, at })
    }
}

/// A mass as typed, `mass=N`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MassArg(pub(super) usize);

impl FromStr for MassArg {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let number = typed.strip_prefix("mass=").ok_or("expected mass=N, such as mass=1")?;
        mass_number(number).map(Self)
    }
}

fn mass_number(typed: &str) -> Result<usize, String> {
    let parsed = typed.trim().parse().ok().filter(|n| *n > 0);
    parsed.ok_or_else(|| format!("mass = '{typed}': expected a mass, counted from 1"))
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
            ("mass=1,vy=1,at=-3", "at = -3: expected a time of 0 or later"),
        ] {
            assert_eq!(read(typed), Err(why.to_owned()), "{typed}");
        }
    }
}
