//! What is typed of a search: choices, places, spans and what varies, each read and named in the user's terms.

use std::str::FromStr;

use rotor::typed::{PairError, RangeError, TypedRange, pairs};
use rotor::{FIELDS, Rotor};
use tuner::{FamilyAxis, FamilyQuantity};
use units::{Dimension, Typed};

use crate::failure::Failure;
use crate::quantity::TypedQuantity;
use crate::units::CommandUnits;
use crate::varied::{By, Varied};

/// What drives the bearing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Signal {
    /// The sum of all sensors, with four gains: the report's
    Composite,
    /// Every sensor by itself, with four gains each
    Individual,
}

/// Which deadband states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Robust {
    /// The factor of each support bearing anywhere from 0 to 1, each by itself
    Deadband,
    /// One factor from 0 to 1 for all support bearings
    DeadbandCommon,
}

/// What a mode is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum MeasureName {
    /// Damping ratio, -Re / |lambda|
    Ratio,
    /// Decay rate, -Re lambda per tau
    Decay,
    /// How deep in the region of --region it is
    Region,
    /// The mean square of motion and force under unbalance and noise, made small: see --cost
    Cost,
}

/// What gains are searched for, side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Criterion {
    /// Every one below
    All,
    /// Damping ratio
    Ratio,
    /// Decay rate
    Decay,
    /// Damping ratio, forward and backward whirl by --mode-weights [default: 2,1]
    Weighted,
    /// The region of --region [default: damping=0.1,decay=0.1,frequency=4]
    Region,
    /// Damping ratio under --max-sensitivity [default: 2]
    Sensitivity,
    /// The cost of --cost
    Cost,
}

impl Criterion {
    /// All but `all`.
    pub(super) const EACH: [Self; 6] =
        [Self::Ratio, Self::Decay, Self::Weighted, Self::Region, Self::Sensitivity, Self::Cost];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Ratio => "ratio",
            Self::Decay => "decay",
            Self::Weighted => "weighted",
            Self::Region => "region",
            Self::Sensitivity => "sensitivity",
            Self::Cost => "cost",
        }
    }
}

/// A region of poles, as typed: damping ratio, decay rate and frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TypedRegion([Option<TypedQuantity>; 3]);

/// What a cost weighs, as typed: force, noise and its corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TypedCost([Option<TypedQuantity>; 3]);

const REGION: [(&str, Dimension); 3] =
    [("damping", Dimension::Number), ("decay", Dimension::Rate), ("frequency", Dimension::Frequency)];
const COST: [(&str, Dimension); 3] =
    [("force", Dimension::Number), ("noise", Dimension::Length), ("corner", Dimension::Frequency)];

impl FromStr for TypedRegion {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        Ok(Self(parts(typed, REGION)?))
    }
}

impl FromStr for TypedCost {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        Ok(Self(parts(typed, COST)?))
    }
}

impl TypedRegion {
    /// The region, dimensionless.
    ///
    /// # Errors
    /// A unit of a machine that has none.
    pub(super) fn value(self, units: CommandUnits) -> Result<tuner::Region, Failure> {
        let [damping, decay, frequency] = self.0.map(|part| part.map(|of| units.read("--region", of)).transpose());
        Ok(tuner::Region { damping: damping?, decay: decay?, frequency: frequency? })
    }
}

impl TypedCost {
    /// The cost, dimensionless; what was not typed is as usual.
    ///
    /// # Errors
    /// A unit of a machine that has none.
    pub(super) fn value(self, units: CommandUnits) -> Result<tuner::Cost, Failure> {
        let [force, noise, corner] = self.0.map(|part| part.map(|of| units.read("--cost", of)).transpose());
        let usual = tuner::Cost::default();
        Ok(tuner::Cost {
            force: force?.unwrap_or(usual.force),
            noise: noise?.unwrap_or(usual.noise),
            corner: corner?.unwrap_or(usual.corner),
        })
    }
}

/// `NAME=QUANTITY,NAME=QUANTITY`, each name once.
fn parts(typed: &str, names: [(&str, Dimension); 3]) -> Result<[Option<TypedQuantity>; 3], String> {
    let expected = || {
        let [a, b, c] = names.map(|(name, _)| name);
        format!("'{typed}': expected {a}=NUMBER, {b}=NUMBER or {c}=NUMBER, one or more with commas between")
    };
    let mut made = [None; 3];
    let read = pairs(typed.split(',')).map_err(|error| match error {
        PairError::Twice { .. } => format!("'{typed}': {error}"),
        PairError::Form(_) => expected(),
    })?;
    for (name, value) in read {
        let place = names.iter().position(|(known, _)| *known == name).ok_or_else(expected)?;
        let dimension = names[place].1;
        let quantity =
            Typed::read(dimension, value).map_err(|error| format!("'{typed}': {name} = {value}: {error}"))?;
        made[place] = Some(TypedQuantity { dimension, typed: quantity });
    }
    Ok(made)
}

/// Masses, counted from 1, or a choice among all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Places {
    /// These.
    These(Vec<usize>),
    /// These, some of them by name.
    Named(Vec<String>),
    /// Every choice of so many.
    Any(usize),
}

impl FromStr for Places {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let expected = || format!("'{typed}': expected masses counted from 1 such as 1,2, or any, or any:2");
        if let Some(rest) = typed.strip_prefix("any") {
            let count = if rest.is_empty() { Some(1) } else { rest.strip_prefix(':').and_then(|n| n.parse().ok()) };
            return count.filter(|&n| n > 0).map(Self::Any).ok_or_else(expected);
        }
        let names: Vec<String> = typed.split(',').map(|name| name.trim().to_owned()).collect();
        let is_name = |name: &String| name.starts_with(char::is_alphabetic);
        if names.iter().any(is_name) && names.iter().all(|name| !name.is_empty()) {
            return Ok(Self::Named(names));
        }
        let masses: Option<Vec<usize>> =
            typed.split(',').map(|mass| mass.trim().parse().ok().filter(|&mass: &usize| mass > 0)).collect();
        let masses = masses.ok_or_else(expected)?;
        let mut once = masses.clone();
        once.sort_unstable();
        once.dedup();
        if once.len() == masses.len() {
            Ok(Self::These(once))
        } else {
            Err(format!("'{typed}': a mass is named twice"))
        }
    }
}

/// How gains depend on speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Gains {
    /// Not at all.
    Fixed,
    /// Linearly.
    Linear,
    /// Through so many values.
    Table(usize),
}

impl FromStr for Gains {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let table = || typed.strip_prefix("table:")?.parse().ok().filter(|n| (2..=64).contains(n)).map(Self::Table);
        match typed {
            "fixed" => Ok(Self::Fixed),
            "linear" => Ok(Self::Linear),
            _ => table().ok_or_else(|| format!("'{typed}': expected fixed, linear, or table:N with N from 2 to 64")),
        }
    }
}

/// One time or a range of times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    from: Typed,
    to: Typed,
}

impl FromStr for Span {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        if let Ok(TypedRange { from, to }) = TypedRange::read(Dimension::Time, typed) {
            return Ok(Self { from, to });
        }
        let time = Typed::read(Dimension::Time, typed).ok().filter(|x| x.number().is_finite());
        let time =
            time.ok_or_else(|| format!("'{typed}': expected a number or a range A..B, such as 0.02 or 0..200us"))?;
        Ok(Self { from: time, to: time })
    }
}

impl Span {
    /// The ends, in `tau`.
    pub(super) fn ends(self, option: &str, units: CommandUnits) -> Result<[f64; 2], Failure> {
        let end = |typed| units.read(option, TypedQuantity { dimension: Dimension::Time, typed });
        let (from, to) = (end(self.from)?, end(self.to)?);
        if from <= to { Ok([from, to]) } else { Err(Failure::Usage(format!("{option}: {}", RangeError::Form))) }
    }
}

/// The coordinate of a family that a parameter of `rotor` is.
pub(super) fn axis(varied: &Varied, rotor: &Rotor) -> Result<FamilyAxis, Failure> {
    let unknown = || {
        let names: Vec<&str> = FIELDS.iter().map(|field| field.name).filter(|name| *name != "deadband").collect();
        Failure::Usage(format!(
            "'{}' is no parameter: expected {} or shaft, a dot, and a number from 1, such as damping.1",
            varied.key,
            names.join(", ")
        ))
    };
    let (name, number) = varied.key.split_once('.').ok_or_else(unknown)?;
    let number: usize = number.parse().ok().filter(|&n| n > 0).ok_or_else(unknown)?;
    let missing = || {
        let (masses, shafts) = (rotor.len(), rotor.shafts().len());
        Failure::Usage(format!("'{}': {} has {masses} masses and {shafts} shafts", varied.key, rotor.name()))
    };
    let (quantity, value) = if name == "shaft" {
        (FamilyQuantity::Shaft(number - 1), *rotor.shafts().get(number - 1).ok_or_else(missing)?)
    } else {
        // Clearance has no part in the linear rotor: deadband states are what --robust is for.
        let known = FIELDS.iter().position(|field| field.name == name && name != "deadband");
        let field = known.ok_or_else(unknown)?;
        let mass = rotor.masses().get(number - 1).ok_or_else(missing)?;
        (FamilyQuantity::Parameter { field, mass: number - 1 }, mass.values()[field])
    };
    let (from, to) = match &varied.by {
        By::Range(ends) => {
            let ends = crate::varied::read(&varied.key, ends, Dimension::Number)?;
            let range = CommandUnits::of(rotor).read_ends(1.0, &varied.key, ends, |alone| alone)?;
            (range.from, range.to)
        }
        &By::Part(part) => {
            let width = part * value.abs();
            if width == 0.0 {
                return Err(Failure::Usage(format!("'{}' is 0: a part of it is nothing; give a range", varied.key)));
            }
            (value - width, value + width)
        }
    };
    Ok(FamilyAxis { quantity, from, to })
}
