//! The smallest damping around the settings in force: over the speed and one setting.

use std::sync::Arc;

use rotor::{Key, Rotor, Settings};
use variation::{Model, Parameter, Quantity};

/// Cells across and up; the settings in force are in the middle.
const CELLS: [usize; 2] = [41, 21];
/// Of shaft elements, where each takes a thousand times as long.
const CELLS_OF_SHAFTS: [usize; 2] = [17, 9];
/// A setting near 0 is looked at so many steps either way.
const STEPS: f64 = 25.0;
/// Likewise a speed, in units of `w0`.
const LEAST_SPEED: f64 = 0.5;

/// What is asked: everything that the answer depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct DampingMapRequest {
    rotor: Arc<Rotor>,
    settings: Settings,
    key: Key,
}

impl DampingMapRequest {
    /// What to ask about settings of a rotor at a speed, up along the setting `key`, or along the first gain where that is the speed itself.
    /// Nothing where linear analysis knows no such setting, or there is none.
    #[must_use]
    pub fn with(rotor: Arc<Rotor>, settings: &Settings, speed: f64, key: Key) -> Option<Self> {
        let settings = Settings::new(&rotor, speed, settings.feedback.clone());
        let first_gain = || settings.keys().into_iter().find(|key| key.parameter.gain.is_some());
        let key = if key.parameter.name == "speed" { first_gain()? } else { key };
        let made = Self { rotor, settings, key };
        made.up()?.is_linear().then_some(made)
    }

    fn model(&self) -> Model {
        Model::new(self.rotor.as_ref().clone(), self.settings.clone())
    }

    fn up(&self) -> Option<Parameter> {
        let made = self.model().parameter(&self.settings.label(self.key)).ok()?;
        matches!(made.quantity, Quantity::Setting(_)).then_some(made)
    }
}

/// The map.
#[derive(Clone, Debug, PartialEq)]
pub struct DampingMap {
    /// The setting that varies up.
    pub key: Key,
    /// The speeds at its left and right edge, in units of `w0`.
    pub speeds: [f64; 2],
    /// The values of the setting at its lower and upper edge.
    pub values: [f64; 2],
    /// The smallest damping, `[across][up]`, at least two of either; not a number where there is no such machine.
    pub damping: Vec<Vec<f64>>,
}

impl DampingMap {
    /// Computes the answer: some milliseconds for three masses, a second for shafts.
    pub fn of(request: &DampingMapRequest) -> Self {
        let DampingMapRequest { rotor, settings, key } = request;
        let parameter = key.parameter;
        let value = settings.get(*key).unwrap_or(0.0);
        let span = value.abs().max(STEPS * parameter.step);
        let low = if parameter.off == Some(value) { value } else { (value - span).max(parameter.min) };
        let values = [low, (value + span).min(parameter.max)];
        let speeds = [0.0, 2.0 * settings.speed.max(LEAST_SPEED)];
        let [across, up] = if rotor.is_chain() { CELLS } else { CELLS_OF_SHAFTS };
        let model = request.model();
        let (speed, own) = (model.parameter("speed"), request.up());
        let place = |[from, to]: [f64; 2], at: usize, of: usize| from + (to - from) * at as f64 / (of - 1) as f64;
        let damping = |x: usize, y: usize| {
            let (Ok(speed), Some(own)) = (&speed, &own) else { return f64::NAN };
            let changes = [(speed, place(speeds, x, across)), (own, place(values, y, up))];
            model.with(&changes).and_then(|there| there.min_damping()).unwrap_or(f64::NAN)
        };
        let damping = (0..across).map(|x| (0..up).map(|y| damping(x, y)).collect()).collect();
        Self { key: *key, speeds, values, damping }
    }

    /// The cell nearest to a place that is so far across and so far up, from 0 to 1.
    #[must_use]
    pub fn at(&self, across: f64, up: f64) -> f64 {
        let nearest = |part: f64, count: usize| ((part * (count - 1) as f64).round() as usize).min(count - 1);
        let column = &self.damping[nearest(across, self.damping.len())];
        column[nearest(up, column.len())]
    }

    /// Where settings are on it, from 0 to 1 across and up; outside, they are not on it.
    #[must_use]
    pub fn place(&self, settings: &Settings) -> Option<[f64; 2]> {
        let part = |value: f64, [from, to]: [f64; 2]| (value - from) / (to - from);
        let made = [part(settings.speed, self.speeds), part(settings.get(self.key).ok()?, self.values)];
        made.iter().all(|part| (0.0..=1.0).contains(part)).then_some(made)
    }

    /// The largest damping on it; 0 where there is none.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.damping.iter().flatten().copied().filter(|damping| damping.is_finite()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    #[test]
    fn the_middle_is_the_machine_as_it_is() {
        let rotor = Arc::new(builtin::rotor("three-mass").unwrap());
        let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
        let ask = |name: &str| {
            let key = settings.key(name).unwrap();
            DampingMapRequest::with(rotor.clone(), &settings, 2.5, key).map(|request| DampingMap::of(&request))
        };
        let map = ask("kc").unwrap();
        let here = machine::min_damping(&rotor, &settings, 2.5).unwrap();
        assert_eq!(map.place(&settings), Some([0.5, 0.5]));
        assert!((map.at(0.5, 0.5) - here).abs() < 1e-9, "{} {here}", map.at(0.5, 0.5));
        assert!(map.largest() > here && map.damping.iter().flatten().any(|damping| *damping < 0.0));
        // Along the speed itself there is a gain; clearances the linear rotor does not know.
        assert_eq!(ask("speed").unwrap().key.parameter.name, "kd");
        assert!(ask("deadband.1").is_none());
        // What is off begins there.
        let delay = ask("delay").unwrap();
        assert!(delay.values[0] == 0.0 && delay.place(&settings) == Some([0.5, 0.0]), "{:?}", delay.values);
    }
}
