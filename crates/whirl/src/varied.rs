//! Parameters over a range as typed: `KEY=A..B`, or `KEY=P%` either way of what the machine has.

use std::str::FromStr;

use rotor::ControlMasses;
use rotor::typed::pair;
use units::Dimension;
use variation::{Model, Parameter, Quantity, VariationError};

use crate::catalog::Machine;
use crate::failure::Failure;
use crate::output::{rounded, warn};
use crate::quantity::{Ends, QuantityRange};
use crate::range::Range;

/// A parameter that varies.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Varied {
    /// Its name.
    pub key: String,
    /// By how much.
    pub by: By,
}

/// How far a parameter varies.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum By {
    /// From here to there.
    Range(Ends),
    /// Either way of the machine's own value.
    Part(f64),
}

impl FromStr for Varied {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let expected = || {
            format!("'{typed}': expected KEY=A..B with A below B, or KEY=P%, such as damping.1=0.2..0.3 or shaft.2=10%")
        };
        let (key, by) = pair(typed).map_err(|_| expected())?;
        Ok(Self { key: key.to_owned(), by: by.parse().map_err(|()| expected())? })
    }
}

impl FromStr for By {
    type Err = ();

    fn from_str(typed: &str) -> Result<Self, ()> {
        match typed.parse() {
            Ok(range) => Ok(Self::Range(range)),
            Err(_) => percent(typed.trim()).map(Self::Part).ok_or(()),
        }
    }
}

/// The part that `P%` is; more than nothing and less than all.
pub(crate) fn percent(typed: &str) -> Option<f64> {
    let percent: f64 = typed.strip_suffix('%')?.trim().parse().ok()?;
    (percent > 0.0 && percent < 100.0).then_some(percent / 100.0)
}

/// The parameter that is typed as `key`.
///
/// # Errors
/// There is none.
pub(crate) fn parameter(model: &Model, key: &str) -> Result<Parameter, Failure> {
    Ok(model.parameter(key)?)
}

/// What the unit of a parameter is counted in: settings are typed as `whirl set` takes them, everything else is dimensionless, or of a
/// drawing in SI units.
pub(crate) fn dimension(parameter: &Parameter) -> Dimension {
    match parameter.quantity {
        Quantity::Setting(key) => key.parameter.dimension,
        _ => Dimension::Number,
    }
}

/// A value of a parameter in the unit that it is shown in.
pub(crate) fn shown(machine: &Machine, parameter: &Parameter, value: f64) -> f64 {
    match parameter.quantity {
        Quantity::Setting(key) => {
            let masses = ControlMasses::of(&machine.rotor, &machine.settings.feedback);
            machine.units().value(masses, key, value)
        }
        _ => value,
    }
}

/// The range that was typed for a key, now that it is known what the key is.
///
/// # Errors
/// A unit of something else.
pub(crate) fn read(key: &str, ends: &Ends, dimension: Dimension) -> Result<QuantityRange, Failure> {
    ends.of(dimension).map_err(|error| Failure::Usage(format!("'{key}': {error}")))
}

/// The range of a parameter of a machine.
///
/// # Errors
/// No such parameter, a part of 0, or a value at either end that it cannot have.
pub(crate) fn range(machine: &Machine, model: &Model, varied: &Varied) -> Result<variation::Range, Failure> {
    let parameter = parameter(model, &varied.key)?;
    let own = model.value(&parameter);
    let (from, to) = match &varied.by {
        By::Range(ends) => {
            let mass = match parameter.quantity {
                Quantity::Setting(key) => ControlMasses::of(&machine.rotor, &machine.settings.feedback).of_key(key),
                _ => 1.0,
            };
            let unit = shown(machine, &parameter, 1.0);
            let ends = read(&varied.key, ends, dimension(&parameter))?;
            let Range { from, to } = machine.units().read_ends(mass, &varied.key, ends, |alone| alone / unit)?;
            (from, to)
        }
        &By::Part(part) if own != 0.0 && own.is_finite() => (own - part * own.abs(), own + part * own.abs()),
        By::Part(_) => {
            let found = if own == 0.0 { "0: a part of it is nothing" } else { "off" };
            return Err(Failure::Usage(format!("'{}' is {found}; give a range", varied.key)));
        }
    };
    for end in [from, to] {
        model.with(&[(&parameter, end)])?;
    }
    // The file of an SI rotor has kilograms where parameters of its masses are ratios: whoever types kilograms here is far off.
    let is_of_chain = matches!(parameter.quantity, Quantity::Field { .. } | Quantity::Shaft(_));
    if is_of_chain && machine.units().scales().is_some() && !(from..=to).contains(&own) {
        let (key, own) = (&varied.key, rounded(own));
        warn(&format!("{key} is dimensionless here, and {own} as the rotor stands, which this range leaves out"));
    }
    Ok(variation::Range { parameter, from, to })
}

impl From<VariationError> for Failure {
    fn from(error: VariationError) -> Self {
        match error {
            VariationError::Poles(error) => error.into(),
            VariationError::Margins(error) => error.into(),
            error => Self::Usage(error.to_string()),
        }
    }
}
