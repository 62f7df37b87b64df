//! The same machine with other numbers.

use beam::{Drawing, Sketch};
use control::Filter;
use rotor::{FIELDS, Feedback, Gain, Mass, Rotor};

use super::Model;
use crate::parameter::{Parameter, Quantity};
use crate::variation_error::VariationError;

impl Model {
    /// The same machine with other values of some of its parameters. A drawing keeps its scales, shapes and places.
    ///
    /// # Errors
    /// A value that a parameter cannot have, or a machine that cannot be.
    pub fn with(&self, changes: &[(&Parameter, f64)]) -> Result<Self, VariationError> {
        let mut made = self.clone();
        let mut chain: Option<(Vec<Mass>, Vec<f64>)> = None;
        let mut sketch: Option<Sketch> = None;
        let of_beam = |beam: &rotor::BeamRotor| beam.drawing().clone().into_sketch();
        let drawn = || self.rotor.beam().map(of_beam).unwrap_or_default();
        let lumped = || (self.rotor.masses().to_vec(), self.rotor.shafts().to_vec());
        for (parameter, value) in changes {
            let value = *value;
            let admit = |is_allowed: bool, expected: &str| match is_allowed {
                true => Ok(()),
                false => {
                    let (name, expected) = (parameter.name.clone(), expected.to_owned());
                    Err(VariationError::Value { name, found: value, expected })
                }
            };
            match &parameter.quantity {
                Quantity::Setting(key) => made.settings.set(*key, value)?,
                Quantity::Field { field, mass } => {
                    let domain = FIELDS[*field].domain;
                    admit(domain.admits(value), domain.words())?;
                    let (masses, _) = chain.get_or_insert_with(lumped);
                    let mut values = masses[*mass].values();
                    values[*field] = value;
                    masses[*mass] = Mass::from_values(values);
                }
                Quantity::Shaft(shaft) => {
                    admit(value.is_finite() && value >= 0.0, "a finite number, not negative")?;
                    chain.get_or_insert_with(lumped).1[*shaft] = value;
                }
                Quantity::Drawn { row, at } => {
                    admit(value.is_finite(), "a finite number")?;
                    (row.set)(sketch.get_or_insert_with(drawn), *at, value);
                }
                Quantity::Factor(_) => admit((0.0..=1.0).contains(&value), "a number from 0 to 1")?,
                Quantity::LoopGain(_) => admit(value.is_finite(), "a finite number")?,
                Quantity::Filter { .. } | Quantity::Together { .. } => {
                    admit(value.is_finite() && value > 0.0, "a finite number greater than 0")?;
                }
            }
        }
        // Factors act on whatever the other changes have left.
        for (parameter, value) in changes {
            match &parameter.quantity {
                Quantity::Factor(mass) => {
                    chain.get_or_insert_with(lumped).0[*mass].bearing_stiffness *= value;
                }
                Quantity::Together { of, at } => {
                    let sketch = sketch.get_or_insert_with(drawn);
                    for row in of.rows(sketch, *at) {
                        let own = (row.get)(sketch, *at).unwrap_or_default();
                        (row.set)(sketch, *at, own * value);
                    }
                }
                Quantity::LoopGain(bearing) => scale(&mut made.settings.feedback, *bearing, *value),
                Quantity::Filter { filter, number } => {
                    if let Some(of) = filter_mut(&mut made.settings.feedback, *filter)
                        && let Some(place) = of.positive_mut(*number)
                    {
                        *place = *value;
                    }
                }
                _ => {}
            }
        }
        if let Some((masses, shafts)) = chain {
            made.rotor = Rotor::new(self.rotor.name(), masses, shafts)?;
        }
        if let Some(sketch) = sketch {
            made.rotor = self.rotor.redrawn(Drawing::new(sketch)?)?;
        }
        Ok(made)
    }
}

/// The `place`-th of [`super::filters`], to change.
fn filter_mut(feedback: &mut Feedback, place: usize) -> Option<&mut Filter> {
    let all = feedback.bearings.iter_mut().flat_map(|bearing| {
        bearing.signals.iter_mut().flat_map(|signal| &mut signal.filters).chain(&mut bearing.filters)
    });
    all.into_iter().nth(place)
}

fn scale(feedback: &mut Feedback, bearing: Option<usize>, factor: f64) {
    for (k, of) in feedback.bearings.iter_mut().enumerate() {
        if bearing.is_none_or(|bearing| bearing == k) {
            let gains = of.signals.iter_mut().flat_map(|signal| &mut signal.gains);
            gains.for_each(|gain: &mut Gain| *gain = gain.scaled(factor));
        }
    }
}
