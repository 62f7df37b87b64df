//! What every setting does to the smallest damping, at one speed: its slope, from the derivatives of poles.

use std::sync::Arc;

use rotor::{Key, Rotor, Settings};
use variation::{DampingSlope, Model, Parameter, Quantity, damping_sensitivities};

/// What is asked: everything that the answer depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeRequest {
    rotor: Arc<Rotor>,
    settings: Settings,
}

impl SlopeRequest {
    /// What to ask about settings of a rotor at a speed; clearances and limits play no part.
    #[must_use]
    pub fn with(rotor: Arc<Rotor>, settings: &Settings, speed: f64) -> Self {
        let settings = Settings::new(&rotor, speed, settings.feedback.clone());
        Self { rotor, settings }
    }
}

/// The slopes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SettingSlopes(Vec<(Key, DampingSlope)>);

impl SettingSlopes {
    /// Computes the answer: a tenth of a millisecond for three masses. Nothing is known where the poles cannot be had.
    pub fn of(request: &SlopeRequest) -> Self {
        let SlopeRequest { rotor, settings } = request;
        let model = Model::new(rotor.as_ref().clone(), settings.clone());
        let key_of = |of: &Parameter| match of.quantity {
            Quantity::Setting(key) if of.is_linear() => Some(key),
            _ => None,
        };
        let own: Vec<Parameter> = model.parameters().into_iter().filter(|of| key_of(of).is_some()).collect();
        let Ok(found) = damping_sensitivities(&model, &own) else { return Self::default() };
        let each = found.each.into_iter();
        Self(each.filter_map(|one| Some((key_of(&one.parameter)?, one.min_damping.ok()?))).collect())
    }

    /// That of a setting, of the first of its kind where the key does not say which; nothing where it has none.
    #[must_use]
    pub fn slope(&self, key: Key) -> Option<DampingSlope> {
        let is_it =
            |other: &Key| other.parameter == key.parameter && other.index.unwrap_or(0) == key.index.unwrap_or(0);
        self.0.iter().find(|(other, _)| is_it(other)).map(|(_, slope)| *slope)
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    #[test]
    fn slopes_are_those_of_differences() {
        let rotor = Arc::new(builtin::rotor("three-mass").unwrap());
        let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
        let found = SettingSlopes::of(&SlopeRequest::with(rotor.clone(), &settings, 2.5));
        for name in ["kd", "cd", "kc", "cc", "speed"] {
            let key = settings.key(name).unwrap();
            let at = |by: f64| {
                let mut moved = settings.clone();
                moved.set(key, settings.get(key).unwrap() + by).unwrap();
                machine::min_damping(&rotor, &moved, moved.speed).unwrap()
            };
            let slope = found.slope(key).unwrap().one().unwrap();
            let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert!((slope - difference).abs() < 1e-6 * (1.0 + slope.abs()), "{name}: {slope} {difference}");
        }
        assert_eq!(found.slope(settings.key("trip").unwrap()), None);
    }
}
