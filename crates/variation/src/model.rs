//! A machine as it is said to be, and the same with other numbers.

mod changed;

use control::Filter;
use machine::{CountedModes, MachinePoles};
use rotor::{C64, FIELDS, Feedback, LinearForm, OperatingPoint, Plant, Rotor, Settings, SettingsError};

use crate::drawn::{DRAWN, Drawn, TOGETHER, Together};
use crate::parameter::{Parameter, Quantity};
use crate::variation_error::VariationError;

/// A machine as it is said to be: rotor and settings, its speed among them.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The rotor.
    pub rotor: Rotor,
    /// Settings that fit it.
    pub settings: Settings,
    /// Of which modes its smallest damping is told; where nobody says, of those that count at its speed.
    counted: Option<CountedModes>,
}

impl Model {
    /// That of a rotor under settings, which must have passed [`Settings::check`].
    #[must_use]
    pub fn new(rotor: Rotor, settings: Settings) -> Self {
        Self { rotor, settings, counted: None }
    }

    /// The same, its smallest damping that of these modes at every speed.
    #[must_use]
    pub fn counting(self, modes: CountedModes) -> Self {
        Self { counted: Some(modes), ..self }
    }

    /// The modes that count whatever its poles and speed are, if that was said.
    #[must_use]
    pub fn counted_everywhere(&self) -> Option<CountedModes> {
        self.counted
    }

    /// The modes that count, of a machine with these poles.
    pub(crate) fn counted(&self, poles: impl IntoIterator<Item = C64>) -> CountedModes {
        self.counted.unwrap_or_else(|| CountedModes::at(&self.rotor, self.settings.speed, poles))
    }

    /// The parameter that is typed as `name`: a setting as `whirl set` has it, a parameter of a mass such as `damping.1`, `shaft.2`,
    /// `factor.1`, a number of a drawing such as `bearing.1.stiffness` or several by one factor as `disc.1.inertia`, `gain` or a filter's `filter.1.corner`.
    ///
    /// # Errors
    /// No such parameter: what there is.
    pub fn parameter(&self, name: &str) -> Result<Parameter, VariationError> {
        let made = |quantity| Ok(Parameter { quantity, name: name.to_owned() });
        if let Some(quantity) = self.of_rotor(name).or_else(|| self.of_loop(name)) {
            return made(quantity);
        }
        match self.settings.key(name) {
            Ok(key) => {
                self.settings.get(key)?;
                made(Quantity::Setting(key))
            }
            Err(SettingsError::UnknownKey(_)) => {
                let all: Vec<String> = self.parameters().into_iter().map(|of| of.name).collect();
                Err(VariationError::Unknown { found: name.to_owned(), known: all.join(", ") })
            }
            Err(error) => Err(error.into()),
        }
    }

    fn of_rotor(&self, name: &str) -> Option<Quantity> {
        let counted = |typed: &str| typed.parse::<usize>().ok()?.checked_sub(1);
        let (first, rest) = name.split_once('.')?;
        if let Some(beam) = self.rotor.beam() {
            let (number, field) = rest.split_once('.')?;
            let of_name = || beam.drawing().magnetics.iter().position(|m| first == "magnetic" && m.name == number);
            let at = counted(number).or_else(of_name)?;
            if let Some(of) = TOGETHER.into_iter().find(|of| (of.part, of.name) == (first, field)) {
                return (!of.rows(beam.drawing(), at).is_empty()).then_some(Quantity::Together { of, at });
            }
            let row = *DRAWN.iter().find(|row| (row.part, row.field) == (first, field))?;
            return (row.get)(beam.drawing(), at).map(|_| Quantity::Drawn { row, at });
        }
        let at = counted(rest)?;
        match first {
            "shaft" => (at < self.rotor.shafts().len()).then_some(Quantity::Shaft(at)),
            "factor" => self.rotor.has_contact(at).then_some(Quantity::Factor(at)),
            _ => {
                let field = FIELDS.iter().position(|row| row.name == first && first != "deadband")?;
                (at < self.rotor.len()).then_some(Quantity::Field { field, mass: at })
            }
        }
    }

    fn of_loop(&self, name: &str) -> Option<Quantity> {
        let feedback = &self.settings.feedback;
        if name == "gain" {
            return Some(Quantity::LoopGain(None));
        }
        if let Some(bearing) = name.strip_prefix("gain.").or_else(|| name.strip_suffix(".gain")) {
            return feedback.find(bearing).map(|bearing| Quantity::LoopGain(Some(bearing)));
        }
        let (number, key) = name.strip_prefix("filter.")?.split_once('.')?;
        let filter = number.parse::<usize>().ok()?.checked_sub(1)?;
        let numbers = filters(feedback).nth(filter)?.positive();
        let number = numbers.iter().position(|(of, _)| *of == key)?;
        Some(Quantity::Filter { filter, number })
    }

    /// Every parameter that linear analysis knows, in the order of files and settings.
    #[must_use]
    pub fn parameters(&self) -> Vec<Parameter> {
        let (feedback, mut all) = (&self.settings.feedback, Vec::new());
        let mut add = |quantity, name| all.push(Parameter { quantity, name });
        // Faults are no parameters of a machine.
        for key in self.settings.keys().into_iter().filter(|key| !key.parameter.is_fault()) {
            // Without a lag there is nothing to be damped.
            let has_part = key.parameter.name != "lag_damping"
                || feedback.bearings.iter().any(|bearing| bearing.parts.lag > 0.0 && bearing.parts.lag_damping > 0.0);
            if has_part {
                add(Quantity::Setting(key), self.settings.label(key));
            }
        }
        match feedback.bearings.len() {
            1 => add(Quantity::LoopGain(None), "gain".into()),
            several => {
                for k in 0..several {
                    add(Quantity::LoopGain(Some(k)), format!("{}.gain", feedback.label(k)));
                }
            }
        }
        for (filter, of) in filters(feedback).enumerate() {
            for (number, (key, _)) in of.positive().into_iter().enumerate() {
                add(Quantity::Filter { filter, number }, format!("filter.{}.{key}", filter + 1));
            }
        }
        for mass in 0..self.rotor.masses().len() {
            for (field, row) in FIELDS.iter().enumerate().filter(|(_, row)| row.name != "deadband") {
                add(Quantity::Field { field, mass }, format!("{}.{}", row.name, mass + 1));
            }
            if self.rotor.has_contact(mass) {
                add(Quantity::Factor(mass), format!("factor.{}", mass + 1));
            }
        }
        (0..self.rotor.shafts().len()).for_each(|k| add(Quantity::Shaft(k), format!("shaft.{}", k + 1)));
        if let Some(beam) = self.rotor.beam() {
            let drawing = beam.drawing();
            // What is not there has no size that a change of it could be measured by. An inertia that is not on its own is not there.
            for row in DRAWN {
                for at in 0.. {
                    let Some(value) = (row.get)(drawing, at) else { break };
                    if value != 0.0 {
                        add(Quantity::Drawn { row, at }, format!("{}.{}.{}", row.part, at + 1, row.field));
                    }
                }
            }
        }
        all.retain(Parameter::is_linear);
        all
    }

    /// The parameters of the rotor of which a machine is unsure as a whole, beside those that are `said` one by one: every one that is not 0;
    /// of a drawing those that hang together as one factor, and none of these where one of them is said.
    #[must_use]
    pub fn unsure(&self, said: &[&Parameter]) -> Vec<Parameter> {
        let is_said = |quantity: &Quantity| said.iter().any(|of| of.quantity == *quantity);
        let mut made: Vec<Parameter> = Vec::new();
        for parameter in self.parameters() {
            if !parameter.is_of_rotor() || self.value(&parameter) == 0.0 || is_said(&parameter.quantity) {
                continue;
            }
            let joined = match &parameter.quantity {
                Quantity::Drawn { row, at } => Together::of(row).map(|of| (of, *at)),
                _ => None,
            };
            let Some((of, at)) = joined else {
                made.push(parameter);
                continue;
            };
            let one = Parameter {
                quantity: Quantity::Together { of, at },
                name: format!("{}.{}.{}", of.part, at + 1, of.name),
            };
            let members = self.members(&one);
            let is_any_said = is_said(&one.quantity) || members.iter().any(|member| is_said(&member.quantity));
            if members.len() < 2 {
                made.push(parameter);
            } else if !is_any_said && !made.contains(&one) {
                made.push(one);
            }
        }
        made
    }

    /// The parameters that one multiplies by its factor; none of what is a number itself.
    #[must_use]
    pub fn members(&self, parameter: &Parameter) -> Vec<Parameter> {
        let (Quantity::Together { of, at }, Some(beam)) = (&parameter.quantity, self.rotor.beam()) else {
            return Vec::new();
        };
        let (at, drawing) = (*at, beam.drawing());
        let named = |row: Drawn| Parameter {
            quantity: Quantity::Drawn { row, at },
            name: format!("{}.{}.{}", row.part, at + 1, row.field),
        };
        of.rows(drawing, at).into_iter().map(named).collect()
    }

    /// The value of a parameter.
    #[must_use]
    pub fn value(&self, parameter: &Parameter) -> f64 {
        match &parameter.quantity {
            Quantity::Setting(key) => self.settings.get(*key).unwrap_or(f64::NAN),
            Quantity::LoopGain(_) | Quantity::Factor(_) | Quantity::Together { .. } => 1.0,
            Quantity::Filter { filter, number } => {
                let of = filters(&self.settings.feedback).nth(*filter);
                of.and_then(|of| of.positive().get(*number).map(|(_, value)| *value)).unwrap_or(f64::NAN)
            }
            Quantity::Field { field, mass } => self.rotor.masses()[*mass].values()[*field],
            Quantity::Shaft(shaft) => self.rotor.shafts()[*shaft],
            Quantity::Drawn { row, at } => {
                self.rotor.beam().and_then(|beam| (row.get)(beam.drawing(), *at)).unwrap_or(f64::NAN)
            }
        }
    }

    /// Its smallest damping ratio, of the modes that count.
    ///
    /// # Errors
    /// Poles that cannot be had.
    pub fn min_damping(&self) -> Result<f64, VariationError> {
        let (rotor, settings) = (&self.rotor, &self.settings);
        let counted = |poles: &[C64]| self.counted(poles.iter().copied());
        Ok(machine::damping_among(rotor, settings, settings.speed, counted)?)
    }

    /// Its poles.
    ///
    /// # Errors
    /// Poles that cannot be had.
    pub fn poles(&self) -> Result<MachinePoles, VariationError> {
        Ok(MachinePoles::of(&self.rotor, &self.settings)?)
    }

    /// It as matrices at its speed.
    pub(crate) fn form(&self) -> Result<LinearForm, VariationError> {
        let at = OperatingPoint::at(self.settings.speed);
        Ok(LinearForm::of(&Plant::of(&self.rotor), &self.settings.feedback, &at)?)
    }
}

/// Every filter of a feedback: bearing by bearing, of its signals and then its own.
fn filters(feedback: &Feedback) -> impl Iterator<Item = &Filter> {
    feedback
        .bearings
        .iter()
        .flat_map(|bearing| bearing.signals.iter().flat_map(|signal| &signal.filters).chain(&bearing.filters))
}
