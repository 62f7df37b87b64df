//! `--corners`: which frequencies of filters are searched beside the gains, how far they may move, and what was found.

use std::str::FromStr;

use rotor::{Feedback, Rotor};
use serde_json::{Value, json};
use tuner::{Corner, Structure, Tuned};

use crate::failure::Failure;
use crate::output::{Cell, Table};
use crate::units::CommandUnits;
use crate::varied::By;

/// Corners as typed: a key that names one or several, and how far they may move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Freed {
    key: String,
    by: Option<By>,
}

impl FromStr for Freed {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let expected = || {
            format!(
                "'{typed}': expected all or a corner such as left.filter.1.zero, alone or with KEY=A..B above 0 or KEY=P%"
            )
        };
        let Some((key, by)) = typed.split_once('=') else {
            let key = typed.trim();
            return if key.is_empty() { Err(expected()) } else { Ok(Self { key: key.to_owned(), by: None }) };
        };
        let by: By = by.parse().map_err(|()| expected())?;
        let is_above_0 = !matches!(&by, By::Range(ends) if ends.lowest() <= 0.0);
        if key.trim().is_empty() || !is_above_0 {
            return Err(expected());
        }
        Ok(Self { key: key.trim().to_owned(), by: Some(by) })
    }
}

/// The corners of the filters of `template` that are to be searched; of two ranges for one corner the later holds.
///
/// # Errors
/// Filters that are not there.
pub(super) fn chosen(
    typed: &[Freed],
    template: Option<&Feedback>,
    rotor: &Rotor,
    units: CommandUnits,
) -> Result<Vec<Corner>, Failure> {
    let Some(first) = typed.first() else { return Ok(Vec::new()) };
    let known = template.map_or_else(Vec::new, Corner::all);
    if known.is_empty() {
        return Err(Failure::Usage(format!(
            "--corners {}: the loop that is searched has no filters: give one that has, with --feedback FILE",
            first.key
        )));
    }
    let mut ranges: Vec<Option<[f64; 2]>> = vec![None; known.len()];
    for Freed { key, by } in typed {
        let named: Vec<usize> = (0..known.len()).filter(|k| names(key, &known[*k].name)).collect();
        if named.is_empty() {
            let all: Vec<&str> = known.iter().map(|corner| corner.name.as_str()).collect();
            let name = rotor.name();
            return Err(Failure::Usage(format!(
                "--corners: no corner '{key}': that law of {name} has {}",
                all.join(", ")
            )));
        }
        for k in named {
            let corner = &known[k];
            let unit = units.quantity(corner.dimension, 1.0, 1.0);
            ranges[k] = Some(match by {
                None => [corner.from, corner.to],
                Some(By::Part(part)) => [corner.own * (1.0 - part), corner.own * (1.0 + part)],
                Some(By::Range(ends)) => {
                    let ends = crate::varied::read(key, ends, corner.dimension)?;
                    let range = units.read_ends(1.0, key, ends, |alone| alone / unit)?;
                    [range.from, range.to]
                }
            });
        }
    }
    let each = known.into_iter().zip(ranges);
    Ok(each.filter_map(|(corner, range)| range.map(|[from, to]| corner.within(from, to))).collect())
}

/// Whether what was typed names a corner: `all`, or words of its name in their order, a number only behind the word that it counts.
fn names(typed: &str, name: &str) -> bool {
    let (typed, name) = (words(typed), words(name));
    let mut left = name.iter();
    typed.len() == 1 && typed[0] == ("all", None)
        || typed
            .iter()
            .all(|(word, number)| left.any(|(own, counted)| own == word && (number.is_none() || number == counted)))
}

/// The words of a key, each with the number behind it.
fn words(key: &str) -> Vec<(&str, Option<&str>)> {
    const COUNTED: [&str; 4] = ["signal", "filter", "zero", "pole"];
    let mut made: Vec<(&str, Option<&str>)> = Vec::new();
    for part in key.split('.') {
        let is_number = part.parse::<usize>().is_ok();
        match made.last_mut() {
            Some((word, number @ None)) if is_number && COUNTED.contains(word) => *number = Some(part),
            _ => made.push((part, None)),
        }
    }
    made
}

/// What was found, for scripts: in radians per `tau`.
pub(super) fn document(structure: &Structure, tuned: &Tuned) -> Vec<Value> {
    let each = structure.corners().iter().zip(&tuned.corners);
    each.map(|(corner, found)| {
        json!({ "corner": corner.name, "value": found, "before": corner.own, "from": corner.from, "to": corner.to })
    })
    .collect()
}

/// Adds what was found to a table of gains, in the units of feedback files; `wide` has a column of speeds.
pub(super) fn add(table: &mut Table, structure: &Structure, tuned: &Tuned, units: CommandUnits, wide: bool) {
    for (corner, found) in structure.corners().iter().zip(&tuned.corners) {
        let (filter, number) = parts(&corner.name);
        let value = Cell::from(units.quantity(corner.dimension, 1.0, *found));
        let names = [Cell::from(&filter.to_owned()), Cell::from(&number.to_owned())];
        let speed = wide.then_some(Cell::Without("any"));
        table.row(names.into_iter().chain(speed).chain([value]));
    }
}

/// The filter of a corner's name, and which of its numbers.
fn parts(name: &str) -> (&str, &str) {
    let at = name.find("filter.").map_or(0, |at| at + "filter.".len());
    let end = name[at..].find('.').map_or(name.len(), |dot| at + dot);
    (&name[..end], name.get(end + 1..).unwrap_or(""))
}

/// Corners at an end of what they may be, by name.
pub(super) fn ends<'s>(structure: &'s Structure, tuned: &Tuned) -> Vec<&'s str> {
    let each = structure.corners().iter().zip(&tuned.corners);
    let is_end = |found: f64, end: f64| (found / end - 1.0).abs() < 1e-9;
    each.filter(|(corner, found)| is_end(**found, corner.from) || is_end(**found, corner.to))
        .map(|(corner, _)| corner.name.as_str())
        .collect()
}

/// The same in words; `None` if there are none.
pub(super) fn at_ends(structure: &Structure, tuned: &Tuned) -> Option<String> {
    let named = ends(structure, tuned);
    (!named.is_empty()).then(|| format!("corners at an end of what they may be: {}", named.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_names_every_corner_that_has_its_words_in_their_order() {
        for (typed, name, expected) in [
            ("all", "left.signal.1.filter.2.corner", true),
            ("left.signal.1.filter.2.corner", "left.signal.1.filter.2.corner", true),
            ("left", "left.signal.1.filter.2.corner", true),
            ("filter.2", "left.signal.1.filter.2.corner", true),
            ("signal.2", "left.signal.1.filter.2.corner", false),
            ("corner.left", "left.signal.1.filter.2.corner", false),
            ("right", "left.signal.1.filter.2.corner", false),
            ("zero", "filter.1.zero.2", true),
            ("zero.1", "filter.1.zero.2", false),
            ("pole", "filter.1.pole", true),
            ("2.filter.1", "2.filter.1.corner", true),
            ("1", "2.filter.1.corner", false),
            ("", "filter.1.corner", false),
        ] {
            assert_eq!(names(typed, name), expected, "{typed} {name}");
        }
        assert_eq!(parts("left.signal.1.filter.2.zero.1"), ("left.signal.1.filter.2", "zero.1"));
    }

    #[test]
    fn a_corner_is_typed_alone_with_a_range_above_0_or_with_a_part_of_itself() {
        let read = |typed: &str| typed.parse::<Freed>();
        assert_eq!(read("all"), Ok(Freed { key: "all".into(), by: None }));
        let range = By::Range("20..90".parse().expect("a range"));
        assert_eq!(read(" zero = 20..90"), Ok(Freed { key: "zero".into(), by: Some(range) }));
        assert_eq!(read("zero=50%"), Ok(Freed { key: "zero".into(), by: Some(By::Part(0.5)) }));
        for wrong in
            ["", "=1..2", "zero=", "zero=3", "zero=0..3", "zero=-1..3", "zero=3..1", "zero=100%", "zero=1..nan"]
        {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
