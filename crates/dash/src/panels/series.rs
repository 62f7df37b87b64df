//! What strips can show: series by name, and strips of one or several series that share a unit.
//!
//! `y` is a series of every mass, `y.2` that of mass 2; `y.1+z.1` are two in one strip.

use std::ops::Range;

use ratatui::style::Color;

use crate::history::Channel;
use crate::picture::Picture;
use crate::theme;
use crate::units::{Unit, Units};

/// What a series counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Length,
    Velocity,
    Force,
    Speed,
    Ratio,
}

/// Where the values of a series come from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// One for each mass.
    Masses(fn(usize) -> Channel),
    /// The same for all.
    One(Channel),
    /// The minimum damping of the settings in force.
    Damping,
}

/// A name that series go by.
struct Name {
    name: &'static str,
    source: Source,
    quantity: Quantity,
    /// Whether it is never negative.
    is_size: bool,
}

const fn name(name: &'static str, source: Source, quantity: Quantity, is_size: bool) -> Name {
    Name { name, source, quantity, is_size }
}

/// Every name.
const NAMES: [Name; 14] = [
    name("y", Source::Masses(Channel::Y), Quantity::Length, false),
    name("z", Source::Masses(Channel::Z), Quantity::Length, false),
    name("radius", Source::Masses(Channel::Radius), Quantity::Length, true),
    name("vy", Source::Masses(Channel::Vy), Quantity::Velocity, false),
    name("vz", Source::Masses(Channel::Vz), Quantity::Velocity, false),
    name("u.y", Source::One(Channel::ForceY), Quantity::Force, false),
    name("u.z", Source::One(Channel::ForceZ), Quantity::Force, false),
    name("force", Source::One(Channel::Force), Quantity::Force, true),
    name("command.y", Source::One(Channel::CommandY), Quantity::Force, false),
    name("command.z", Source::One(Channel::CommandZ), Quantity::Force, false),
    name("command", Source::One(Channel::Command), Quantity::Force, true),
    name("speed", Source::One(Channel::Speed), Quantity::Speed, true),
    name("damping", Source::Damping, Quantity::Ratio, true),
    // Both of its components.
    name("u", Source::One(Channel::Force), Quantity::Force, false),
];

/// Every name that can be typed for a series.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    NAMES.iter().map(|name| name.name)
}

/// One strip: what it is called, and its series.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Strip {
    /// As it was typed.
    pub(crate) name: String,
    /// Rows of [`NAMES`], and the mass that each is of, counted from 0.
    parts: Vec<(usize, Option<usize>)>,
}

/// One line of a strip.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Trace {
    /// Its name.
    pub(crate) label: String,
    /// A sign of one letter or digit that tells it from others where there is no colour.
    pub(crate) mark: char,
    pub(crate) color: Color,
    /// What it shows; the minimum damping if that is none.
    pub(crate) channel: Option<Channel>,
}

impl Trace {
    /// The least and the greatest value over some steps, dimensionless.
    pub(crate) fn range(&self, picture: &Picture, steps: Range<usize>) -> Option<[f64; 2]> {
        match self.channel {
            Some(channel) => picture.track.range(channel, steps),
            None => picture.least_damping(&steps).map(|least| [least, least]),
        }
    }

    /// The value at a step, dimensionless.
    pub(crate) fn value(&self, picture: &Picture, step: usize) -> Option<f64> {
        match self.channel {
            Some(channel) => Some(picture.track.value(channel, step)),
            None => picture.least_damping(&(step..step + 1)),
        }
    }
}

impl Strip {
    /// The strips of a line of words.
    ///
    /// # Errors
    /// In words: the word that is wrong, and what was expected.
    pub(crate) fn read_all(words: &str) -> Result<Vec<Self>, String> {
        let strips: Vec<Self> = words.split_whitespace().map(Self::read).collect::<Result<_, _>>()?;
        if let Some(again) = (1..strips.len()).find(|&i| strips[..i].contains(&strips[i])) {
            return Err(format!("'{}' is given twice: expected each strip once", strips[again].name));
        }
        if strips.is_empty() { Err(format!("'': expected series: {}", known())) } else { Ok(strips) }
    }

    /// The strip of one word.
    ///
    /// # Errors
    /// In words: what is wrong with it.
    pub(crate) fn read(word: &str) -> Result<Self, String> {
        let parts = word.split('+').map(part).collect::<Result<Vec<_>, _>>()?;
        if (1..parts.len()).any(|i| parts[..i].contains(&parts[i])) {
            return Err(format!("'{word}': expected each series once"));
        }
        let quantity = NAMES[parts[0].0].quantity;
        match parts.iter().find(|(row, _)| NAMES[*row].quantity != quantity) {
            Some((row, _)) => {
                Err(format!("'{word}': expected series of one unit, and {} has another", NAMES[*row].name))
            }
            None => Ok(Self { name: word.to_owned(), parts }),
        }
    }

    /// The unit of its values.
    pub(crate) fn unit(&self, units: &Units) -> Unit {
        match NAMES[self.parts[0].0].quantity {
            Quantity::Length => units.length,
            Quantity::Velocity => units.velocity,
            Quantity::Force => units.force,
            Quantity::Speed => units.speed,
            Quantity::Ratio => Unit { factor: 1.0, name: "" },
        }
    }

    /// Whether its values are sizes, which begin at zero.
    pub(crate) fn is_size(&self) -> bool {
        self.parts.iter().all(|(row, _)| NAMES[*row].is_size)
    }

    /// Whether it shows a series of every mass: then the masses need telling apart, not the series.
    pub(crate) fn is_of_every_mass(&self) -> bool {
        self.parts.len() == 1 && self.parts[0].1.is_none() && matches!(NAMES[self.parts[0].0].source, Source::Masses(_))
    }

    /// Its lines on a rotor of `masses` masses. A strip of more masses than colours would be a tangle: the first few
    /// stand for all.
    pub(crate) fn traces(&self, masses: usize) -> Vec<Trace> {
        let mut traces = Vec::new();
        for (row, mass) in &self.parts {
            let Name { name, source, .. } = &NAMES[*row];
            let colors = theme::TRACES;
            match (source, mass) {
                (Source::Masses(of), mass) => {
                    let chosen = mass.map_or(0..masses.min(colors.len()), |mass| mass..(mass + 1).min(masses));
                    traces.extend(chosen.map(|mass| Trace {
                        label: format!("{name}.{}", mass + 1),
                        mark: char::from_digit((mass as u32 + 1) % 36, 36).unwrap_or('?'),
                        color: colors[mass % colors.len()],
                        channel: Some(of(mass)),
                    }));
                }
                (Source::One(_), _) if *name == "u" => {
                    let of = |label: &str, mark, color, channel| Trace {
                        label: label.into(),
                        mark,
                        color,
                        channel: Some(channel),
                    };
                    traces.push(of("u.y", 'y', theme::FORCE, Channel::ForceY));
                    traces.push(of("u.z", 'z', theme::BACKWARD, Channel::ForceZ));
                }
                (Source::One(channel), _) => traces.push(Trace {
                    label: (*name).to_owned(),
                    mark: name.rsplit('.').next().and_then(|part| part.chars().next()).unwrap_or('?'),
                    color: if name.ends_with('z') { theme::BACKWARD } else { theme::FORCE },
                    channel: Some(*channel),
                }),
                (Source::Damping, _) => {
                    let label = "damping".to_owned();
                    traces.push(Trace { label, mark: 'd', color: theme::GOOD, channel: None });
                }
            }
        }
        tell_apart(&mut traces);
        traces
    }
}

/// Gives every trace a colour and a mark of its own, as far as there are any.
fn tell_apart(traces: &mut [Trace]) {
    let distinct = |of: fn(&Trace, &Trace) -> bool, traces: &[Trace]| {
        (1..traces.len()).all(|at| traces[..at].iter().all(|other| !of(other, &traces[at])))
    };
    if !distinct(|a, b| a.color == b.color, traces) {
        let colors = theme::TRACES.into_iter().chain([theme::FORCE, theme::BACKWARD, theme::KEY]).cycle();
        traces.iter_mut().zip(colors).for_each(|(trace, color)| trace.color = color);
    }
    if !distinct(|a, b| a.mark == b.mark, traces) {
        let letter = |trace: &Trace| trace.label.trim_end_matches(|c: char| !c.is_alphabetic()).chars().next_back();
        traces.iter_mut().for_each(|trace| trace.mark = letter(trace).unwrap_or(trace.mark));
    }
    if !distinct(|a, b| a.mark == b.mark, traces) {
        traces.iter_mut().zip('a'..='z').for_each(|(trace, mark)| {
            trace.mark = mark;
            trace.label = format!("{mark}:{}", trace.label);
        });
    }
}

/// `y`, `y.2`, `u.z`.
fn part(word: &str) -> Result<(usize, Option<usize>), String> {
    let row = |wanted: &str| NAMES.iter().position(|name| name.name == wanted);
    if let Some(row) = row(word) {
        return Ok((row, None));
    }
    let indexed = word.rsplit_once('.').and_then(|(name, mass)| {
        let row = row(name).filter(|row| matches!(NAMES[*row].source, Source::Masses(_)))?;
        Some((row, Some(mass.parse::<usize>().ok()?.checked_sub(1)?)))
    });
    indexed.ok_or_else(|| format!("'{word}': expected {}", known()))
}

/// What series there are, in words.
fn known() -> String {
    let names: Vec<&str> = names().collect();
    format!("{}, with .N for mass N and + between series in one strip", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(word: &str) -> Vec<String> {
        Strip::read(word).unwrap().traces(3).into_iter().map(|trace| trace.label).collect()
    }

    #[test]
    fn words_are_strips_of_series_that_share_a_unit() {
        assert_eq!(labels("y"), ["y.1", "y.2", "y.3"]);
        assert_eq!(labels("radius.2"), ["radius.2"]);
        assert_eq!(labels("u"), ["u.y", "u.z"]);
        assert_eq!(labels("force+command"), ["force", "command"]);
        assert_eq!(labels("y.7"), [""; 0], "a mass that this rotor does not have");
        for (word, wrong) in [
            ("x", "'x': expected y, z, radius"),
            ("y.0", "'y.0': expected y"),
            ("speed.1", "'speed.1': expected y"),
            ("y.1+force", "'y.1+force': expected series of one unit, and force has another"),
            ("y.1+", "'': expected y"),
        ] {
            let told = Strip::read(word).unwrap_err();
            assert!(told.starts_with(wrong), "{told}");
        }
        assert!(Strip::read_all("  ").is_err() && Strip::read_all("y z u").unwrap().len() == 3);
    }

    #[test]
    fn lines_of_one_strip_differ_in_colour_and_in_mark() {
        for word in ["y", "y.1+z.1", "u", "force+command+u.z", "y.1+y.2+z.2+radius.1", "command.y+command.z"] {
            let traces = Strip::read(word).unwrap().traces(3);
            for (at, trace) in traces.iter().enumerate() {
                assert!(
                    traces[..at].iter().all(|other| other.mark != trace.mark && other.color != trace.color),
                    "{word}"
                );
            }
        }
    }

    #[test]
    fn every_name_reads_back() {
        for name in names() {
            assert_eq!(Strip::read(name).unwrap().name, name);
        }
    }
}
