//! What a person types, read in one way by the command line and the dashboard: ranges `A..B`, `KEY=VALUE` each key once,
//! and rows of settings none of which undoes another.
//!
//! What is typed and does nothing, or is typed twice, is an error here: it is a slip of the hand that a table of numbers
//! would not show.

use std::fmt;

use units::{Dimension, Typed, TypedError, Units};

use crate::{Key, Scope};

/// Why a text is no range.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RangeError {
    /// Not two finite numbers with two dots between them, the lesser first.
    #[error("expected A..B with finite numbers A < B, such as 0..6")]
    Form,
    /// More dots than two in a row: `0...3` is 0 to 3 for one reader, and 0 to 0.3 for another.
    #[error("more than two dots in a row: expected A..B such as 0..3, or 0..0.3")]
    Dots,
    /// The lower end says its unit, and the upper one does not.
    #[error("expected a unit at the upper end, which is that of both, or at each, such as 0..300Hz")]
    UpperUnit,
    /// An end is no value of the quantity.
    #[error("each end: {0}")]
    End(TypedError),
}

/// The ends of a range as typed, `A..B`: finite, the lesser first. Blanks around the numbers do no harm.
///
/// # Errors
/// What is no range, or could be read as two.
pub fn range(typed: &str) -> Result<[f64; 2], RangeError> {
    let (from, to) = ends(typed)?;
    let end = |text: &str| text.trim().parse::<f64>().ok().filter(|end| end.is_finite()).ok_or(RangeError::Form);
    let (from, to) = (end(from)?, end(to)?);
    if from < to { Ok([from, to]) } else { Err(RangeError::Form) }
}

/// A range of a quantity as typed. A unit at the upper end alone is that of the lower one too: `0..300Hz`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypedRange {
    /// The lower end.
    pub from: Typed,
    /// The upper end.
    pub to: Typed,
}

impl TypedRange {
    /// Reads a range.
    ///
    /// # Errors
    /// What is no range, or could be read as two; a unit of something else.
    pub fn read(dimension: Dimension, typed: &str) -> Result<Self, RangeError> {
        let (from, to) = ends(typed)?;
        let end = |text: &str| match Typed::read(dimension, text) {
            Ok(end) if end.number().is_finite() => Ok(end),
            Ok(_) | Err(TypedError::NotANumber) => Err(RangeError::Form),
            Err(error) => Err(RangeError::End(error)),
        };
        let (from, to) = (end(from)?, end(to)?);
        if to.is_alone() && !from.is_alone() {
            return Err(RangeError::UpperUnit);
        }
        let from = if from.is_alone() { from.counted_as(to) } else { from };
        // Ends in different units are compared once there is a machine.
        let is_falling = from.number() >= to.number() && from.counted_as(to) == from;
        if is_falling { Err(RangeError::Form) } else { Ok(Self { from, to }) }
    }

    /// The dimensionless ends; `alone` is that of a number that does not say what it is counted in.
    ///
    /// # Errors
    /// An SI unit where there are no scales; the upper end not above the lower.
    pub fn value(
        self,
        units: &Units,
        dimension: Dimension,
        alone: impl Fn(f64) -> f64,
    ) -> Result<[f64; 2], RangeError> {
        let end = |end: Typed| end.value(units, dimension, &alone).map_err(RangeError::End);
        let (from, to) = (end(self.from)?, end(self.to)?);
        if from < to { Ok([from, to]) } else { Err(RangeError::Form) }
    }
}

impl fmt::Display for TypedRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.from.counted_as(self.to) == self.from {
            write!(f, "{}..{}", self.from.number(), self.to)
        } else {
            write!(f, "{}..{}", self.from, self.to)
        }
    }
}

/// The numbers at the ends of a range as typed, `A..B`, whatever they are counted in.
///
/// # Errors
/// What is no range, or could be read as two.
pub fn range_numbers(typed: &str) -> Result<[f64; 2], RangeError> {
    let (from, to) = ends(typed)?;
    let end = |text| units::parts(text).filter(|(number, _)| number.is_finite()).ok_or(RangeError::Form);
    let ((from, unit), (to, _)) = (end(from)?, end(to)?);
    if unit.is_empty() && from >= to { Err(RangeError::Form) } else { Ok([from, to]) }
}

/// What stands on both sides of the two dots of a range as typed.
///
/// # Errors
/// No two dots, or three, which could be read as two and a number that begins with one.
pub fn ends(typed: &str) -> Result<(&str, &str), RangeError> {
    if typed.contains("...") {
        return Err(RangeError::Dots);
    }
    typed.split_once("..").ok_or(RangeError::Form)
}

/// Why a text is no `KEY=VALUE`, or a row of them not what was meant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PairError {
    /// No `=`, or nothing before or behind it.
    #[error("'{0}': expected KEY=VALUE")]
    Form(String),
    /// The same key again: one of the two values would be lost.
    #[error("{key} is given twice: expected each key once")]
    Twice {
        /// The key.
        key: String,
    },
}

/// The key and the value of `KEY=VALUE`, without the blanks around them.
///
/// # Errors
/// No `=`, or nothing on one side of it.
pub fn pair(typed: &str) -> Result<(&str, &str), PairError> {
    let parts = typed.split_once('=').map(|(key, value)| (key.trim(), value.trim()));
    parts.filter(|(key, value)| !key.is_empty() && !value.is_empty()).ok_or_else(|| PairError::Form(typed.to_owned()))
}

/// The keys and values of a row of `KEY=VALUE`, no key of which comes twice.
///
/// # Errors
/// As for [`pair`], or a key that is there already.
pub fn pairs<'t>(row: impl IntoIterator<Item = &'t str>) -> Result<Vec<(&'t str, &'t str)>, PairError> {
    let mut read: Vec<(&str, &str)> = Vec::new();
    for typed in row {
        let (key, value) = pair(typed)?;
        if read.iter().any(|(before, _)| *before == key) {
            return Err(PairError::Twice { key: key.to_owned() });
        }
        read.push((key, value));
    }
    Ok(read)
}

/// Something that was typed to set a value, which what was typed behind it sets again.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{first}' does nothing: '{then}' sets the same. Expected each once")]
pub struct Undone {
    /// What does nothing, as typed.
    pub first: String,
    /// What undoes it, as typed.
    pub then: String,
}

/// What a row of assignments has set so far, to notice when a later one leaves nothing of an earlier one: `kd=1 kd.1=2`,
/// `deadband.2=1 deadband=3`, `kd=1 feedback=off`. One that refines another is fine: `deadband=1 deadband.2=0.5`.
#[derive(Clone, Debug)]
pub struct Assigned {
    masses: usize,
    said: Vec<(String, Vec<ValueName>)>,
}

/// One value: the name of its setting, and the mass, signal or control bearing.
type ValueName = (&'static str, usize);

/// The place of the control law as a whole.
const LAW: ValueName = ("feedback", 0);

impl Assigned {
    /// Nothing yet, on a machine of so many masses.
    #[must_use]
    pub fn new(masses: usize) -> Self {
        Self { masses, said: Vec::new() }
    }

    /// Notes that `typed` sets `key`.
    ///
    /// # Errors
    /// Nothing is left of something before it.
    pub fn key(&mut self, key: Key, typed: &str) -> Result<(), Undone> {
        let name = key.parameter.name;
        let places = match (key.parameter.scope, key.index) {
            (Scope::Mass, None) => (0..self.masses).map(|mass| (name, mass)).collect(),
            (Scope::Bearing, None) => (0..crate::MAX_BEARINGS).map(|bearing| (name, bearing)).collect(),
            (_, index) => vec![(name, index.unwrap_or(0))],
        };
        let again = |place: &ValueName| places.contains(place);
        self.note(typed, places.clone(), again)
    }

    /// Notes that `typed` sets the control law, with the gains of all its signals.
    ///
    /// # Errors
    /// Nothing is left of something before it.
    pub fn feedback(&mut self, typed: &str) -> Result<(), Undone> {
        let is_gain = |name: &str| crate::PARAMETERS.iter().any(|p| p.name == name && p.scope == Scope::Signal);
        self.note(typed, vec![LAW], |place| *place == LAW || is_gain(place.0))
    }

    fn note(&mut self, typed: &str, places: Vec<ValueName>, sets: impl Fn(&ValueName) -> bool) -> Result<(), Undone> {
        for (first, left) in &mut self.said {
            left.retain(|place| !sets(place));
            if left.is_empty() {
                return Err(Undone { first: first.clone(), then: typed.to_owned() });
            }
        }
        self.said.push((typed.to_owned(), places));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_read_as_typed() {
        for (typed, ends) in [
            ("0..6", [0.0, 6.0]),
            ("-1.5..2e3", [-1.5, 2e3]),
            (" .5 .. 1. ", [0.5, 1.0]),
            ("0.. .5", [0.0, 0.5]),
            ("1. ..2", [1.0, 2.0]),
            ("+0..+3", [0.0, 3.0]),
        ] {
            assert_eq!(range(typed), Ok(ends), "{typed}");
        }
        for typed in
            ["", "3", "..", "0..", "..6", "6..0", "2..2", "0..inf", "nan..1", "0..=6", "a..b", "0..1..2", "0-6", "0.3"]
        {
            assert_eq!(range(typed), Err(RangeError::Form), "{typed}");
        }
    }

    #[test]
    fn val_a_range_may_say_what_it_is_counted_in() {
        // 300 rad/s are 47.7465 Hz.
        let scales = units::Scales { w0: 300.0, k_t: 3.6e6, m_t: 40.0, e_t: 20e-6 };
        let units = Units::of(Some(scales), 1.0);
        let read = |dimension, typed| {
            TypedRange::read(dimension, typed).and_then(|range| range.value(&units, dimension, |alone| alone))
        };
        for (dimension, typed, [from, to]) in [
            (Dimension::Speed, "0..6", [0.0, 6.0]),
            (Dimension::Speed, "0..47.7464829275686Hz", [0.0, 1.0]),
            (Dimension::Speed, "-2864.788975654116 rpm .. 47.7464829275686 Hz", [-1.0, 1.0]),
            (Dimension::Speed, "1w0..2w0", [1.0, 2.0]),
            (Dimension::Length, "20..100um", [1.0, 5.0]),
            (Dimension::Length, "100um..0.2mm", [5.0, 10.0]),
        ] {
            let found = read(dimension, typed).expect(typed);
            assert!((found[0] - from).abs() < 1e-12 && (found[1] - to).abs() < 1e-12, "{typed}: {found:?}");
        }
        for (typed, why) in [
            ("6..0", RangeError::Form),
            ("2mm..100um", RangeError::Form),
            ("200..100um", RangeError::Form),
            ("0..x", RangeError::Form),
            ("0...3um", RangeError::Dots),
            ("0um..3", RangeError::UpperUnit),
        ] {
            assert_eq!(read(Dimension::Length, typed), Err(why), "{typed}");
        }
        let wrong = read(Dimension::Length, "0..3N").expect_err("a force").to_string();
        assert_eq!(wrong, "each end: expected a number, alone or in m, mm, um, nm");
        let plain = TypedRange::read(Dimension::Speed, "0..50Hz").expect("a range");
        let refused = plain.value(&Units::DIMENSIONLESS, Dimension::Speed, |alone| alone);
        assert_eq!(refused, Err(RangeError::End(TypedError::NoScales)));
        assert_eq!(plain.to_string(), "0..50 Hz");
        assert_eq!(range_numbers("1mm..3"), Ok([1.0, 3.0]));
        assert_eq!(range_numbers("3..1um"), Err(RangeError::Form));
    }

    #[test]
    fn three_dots_are_not_read_as_one_of_the_two_things_they_could_mean() {
        for typed in ["0...3", "0....3", "...", "1...", "...1", "0...5..7"] {
            assert_eq!(range(typed), Err(RangeError::Dots), "{typed}");
        }
        assert_eq!(RangeError::Dots.to_string(), "more than two dots in a row: expected A..B such as 0..3, or 0..0.3");
    }

    #[test]
    fn every_key_of_a_row_stands_once() {
        assert_eq!(pairs(["mass=1", " vy = -2.5 "]), Ok(vec![("mass", "1"), ("vy", "-2.5")]));
        assert_eq!(pairs(["vy=1", "vy=2"]), Err(PairError::Twice { key: "vy".into() }));
        assert_eq!(pairs(["vy=1", "mass=1", " vy =1"]), Err(PairError::Twice { key: "vy".into() }));
        for typed in ["vy", "", "=", "vy=", "=1"] {
            assert_eq!(pairs([typed]), Err(PairError::Form(typed.into())), "{typed}");
        }
        assert_eq!(pair("path=a=b"), Ok(("path", "a=b")), "what is behind the first = belongs to the value");
    }

    /// What is said of a row of assignments to a machine of three masses.
    fn row(typed: &[&str]) -> Result<(), Undone> {
        let mut assigned = Assigned::new(3);
        typed.iter().try_for_each(|typed| match pair(typed).unwrap() {
            ("feedback", _) => assigned.feedback(typed),
            (key, _) => assigned.key(key.parse().unwrap(), typed),
        })
    }

    #[test]
    fn an_assignment_that_leaves_nothing_of_an_earlier_one_is_noticed() {
        for fine in [
            &["speed=1", "kd=2", "kd.2=2"][..],
            &["deadband=1", "deadband.2=0.5"],
            &["deadband.1=1", "deadband.2=1"],
            &["feedback=off", "kd=1", "cd.2=3"],
            &["speed=1", "trip=9", "deadband=1", "deadband.1=1", "deadband.2=2"],
        ] {
            assert_eq!(row(fine), Ok(()), "{fine:?}");
        }
        for (undone, first, then) in [
            (&["speed=1", "kd=1", "speed=2"][..], "speed=1", "speed=2"),
            (&["speed=1", "speed=1"], "speed=1", "speed=1"),
            (&["kd=1", "kd.1=2"], "kd=1", "kd.1=2"),
            (&["kd.1=1", "kd=2"], "kd.1=1", "kd=2"),
            (&["deadband.2=1", "deadband=3"], "deadband.2=1", "deadband=3"),
            (&["deadband=1", "deadband.1=1", "deadband.2=1", "deadband.3=1"], "deadband=1", "deadband.3=1"),
            (&["cc.2=1", "feedback=off"], "cc.2=1", "feedback=off"),
            (&["feedback=a", "kd=1", "feedback=b"], "feedback=a", "feedback=b"),
        ] {
            assert_eq!(row(undone), Err(Undone { first: first.into(), then: then.into() }), "{undone:?}");
        }
    }
}
