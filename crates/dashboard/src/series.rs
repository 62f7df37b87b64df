//! What strips can show: series by name, and strips of one or several series that share a unit.
//!
//! `y` is a series of every mass, `y.2` that of mass 2; `y.1+z.1` are two in one strip.

use std::ops::Range;

use ratatui::style::Color;

use units::Dimension;
use wire::{CHANNELS, PAIRS, Scope, StepLayout};

use crate::theme;
use telemetry::frame_data::FrameData;
use telemetry::history::StepQuantity;
use telemetry::units::{ScreenUnits, Unit};

/// Where the values of a series come from: every number of the table of channels and the size of every pair of them is a
/// series by its name there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    /// A channel.
    Told(wire::Channel),
    /// The size of a pair, by its place in the table.
    Size(usize),
    /// The minimum damping of the settings in force.
    Damping,
    /// Both components of the control delivered.
    Control,
}

impl Source {
    fn all() -> impl Iterator<Item = Self> {
        let told = CHANNELS.iter().map(|row| row.channel).filter(|channel| channel.is_number()).map(Self::Told);
        told.chain((0..PAIRS.len()).map(Self::Size)).chain([Self::Damping, Self::Control])
    }

    fn name(self) -> &'static str {
        match self {
            Self::Told(channel) => channel.row().label,
            Self::Size(pair) => PAIRS[pair].label,
            Self::Damping => "damping",
            Self::Control => "u",
        }
    }

    /// The channel that says what it counts; none for a ratio.
    fn kind(self) -> Option<wire::Channel> {
        match self {
            Self::Told(channel) => Some(channel),
            Self::Size(pair) => Some(PAIRS[pair].channels[0]),
            Self::Damping => None,
            Self::Control => Some(wire::Channel::ForceY),
        }
    }

    fn dimension(self) -> Option<Dimension> {
        self.kind().map(|channel| channel.row().dimension)
    }

    /// Whether there is one for each mass, sensor or further control bearing.
    fn is_of_masses(self) -> bool {
        self.scope() != Scope::Once
    }

    fn scope(self) -> Scope {
        self.kind().map_or(Scope::Once, |channel| channel.row().scope)
    }

    /// The number by which the first of them is called.
    fn first_number(self) -> usize {
        self.kind().and_then(|channel| wire::Column { channel, index: 0 }.number()).unwrap_or(1)
    }

    /// Whether it is never negative.
    fn is_size(self) -> bool {
        match self {
            Self::Told(_) => self.dimension() == Some(Dimension::Speed),
            Self::Size(_) | Self::Damping => true,
            Self::Control => false,
        }
    }

    /// What it shows of a mass, or at all.
    fn channel(self, mass: usize) -> Option<StepQuantity> {
        match self {
            Self::Told(channel) => Some(StepQuantity::Of(channel, mass)),
            Self::Size(pair) => Some(StepQuantity::Size(pair, mass)),
            Self::Damping | Self::Control => None,
        }
    }
}

/// Every name that can be typed for a series.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    Source::all().map(Source::name)
}

/// One strip: what it is called, and its series.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Strip {
    /// As it was typed.
    pub(crate) name: String,
    /// Its series, and the mass that each is of, counted from 0.
    parts: Vec<(Source, Option<usize>)>,
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
    pub(crate) channel: Option<StepQuantity>,
}

impl Trace {
    /// The least and the greatest value over some steps, dimensionless; forces as those of the first control bearing.
    pub(crate) fn range(&self, data: &FrameData, steps: Range<usize>) -> Option<[f64; 2]> {
        match self.channel {
            Some(channel) => Some(data.track.range(channel, steps)?.map(|value| value * data.factor_of(channel))),
            None => data.least_damping(&steps).map(|least| [least, least]),
        }
    }

    /// The value at a step, likewise.
    pub(crate) fn value(&self, data: &FrameData, step: usize) -> Option<f64> {
        match self.channel {
            Some(channel) => Some(data.track.value(channel, step) * data.factor_of(channel)),
            None => data.least_damping(&(step..step + 1)),
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
        let dimension = parts[0].0.dimension();
        match parts.iter().find(|(source, _)| source.dimension() != dimension) {
            Some((source, _)) => {
                Err(format!("'{word}': expected series of one unit, and {} has another", source.name()))
            }
            None => Ok(Self { name: word.to_owned(), parts }),
        }
    }

    /// The unit of its values.
    pub(crate) fn unit(&self, units: &ScreenUnits) -> Unit {
        self.parts[0].0.dimension().map_or(Unit { factor: 1.0, name: "" }, |dimension| units.of_dimension(dimension))
    }

    /// Whether its values are sizes, which begin at zero.
    pub(crate) fn is_size(&self) -> bool {
        self.parts.iter().all(|(source, _)| source.is_size())
    }

    /// Whether it shows a series of every mass: then the masses need telling apart, not the series.
    pub(crate) fn is_of_every_mass(&self) -> bool {
        self.parts.len() == 1 && self.parts[0].1.is_none() && self.parts[0].0.is_of_masses()
    }

    /// Its lines of steps that are laid out like this. A strip of more masses than colours would be a tangle: the first few stand for
    /// all.
    pub(crate) fn traces(&self, layout: StepLayout) -> Vec<Trace> {
        let mut traces = Vec::new();
        for (source, mass) in &self.parts {
            let (name, colors) = (source.name(), theme::TRACES);
            let alone = |label: &str, color, channel| Trace {
                label: label.to_owned(),
                mark: label.rsplit('.').next().and_then(|part| part.chars().next()).unwrap_or('?'),
                color,
                channel,
            };
            match source {
                source if source.is_of_masses() => {
                    let count = layout.count(source.scope());
                    let chosen = mass.map_or(0..count.min(colors.len()), |mass| mass..(mass + 1).min(count));
                    let number = |mass: usize| mass + source.first_number();
                    traces.extend(chosen.map(|mass| Trace {
                        label: format!("{name}.{}", number(mass)),
                        mark: char::from_digit(number(mass) as u32 % 36, 36).unwrap_or('?'),
                        color: colors[mass % colors.len()],
                        channel: source.channel(mass),
                    }));
                }
                Source::Control => {
                    traces.push(alone("u.y", theme::FORWARD, Some(StepQuantity::FORCE_Y)));
                    traces.push(alone("u.z", theme::BACKWARD, Some(StepQuantity::FORCE_Z)));
                }
                Source::Damping => traces.push(alone(name, theme::FORCE, None)),
                source => {
                    let color = if name.ends_with('z') { theme::BACKWARD } else { theme::FORWARD };
                    traces.push(alone(name, color, source.channel(0)));
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
        let colors = theme::TRACES.into_iter().chain([theme::FORCE, theme::BACKWARD, theme::KEYPHASOR]).cycle();
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
fn part(word: &str) -> Result<(Source, Option<usize>), String> {
    let source = |wanted: &str| Source::all().find(|source| source.name() == wanted);
    if let Some(source) = source(word) {
        return Ok((source, None));
    }
    let indexed = word.rsplit_once('.').and_then(|(name, mass)| {
        let source = source(name).filter(|source| source.is_of_masses())?;
        Some((source, Some(mass.parse::<usize>().ok()?.checked_sub(source.first_number())?)))
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
        Strip::read(word)
            .unwrap()
            .traces(StepLayout::new(3).with_bearings(2))
            .into_iter()
            .map(|trace| trace.label)
            .collect()
    }

    #[test]
    fn words_are_strips_of_series_that_share_a_unit() {
        assert_eq!(labels("y"), ["y.1", "y.2", "y.3"]);
        assert_eq!(labels("radius.2"), ["radius.2"]);
        assert_eq!(labels("u"), ["u.y", "u.z"]);
        assert_eq!(labels("force+command"), ["force", "command"]);
        assert_eq!(labels("bearing.force.2+force"), ["bearing.force.2", "force"]);
        assert_eq!(labels("bearing.u.y"), ["bearing.u.y.2"], "the second control bearing");
        assert_eq!(labels("bearing.u.y.3"), [""; 0], "a control bearing that this machine does not have");
        assert_eq!(labels("y.7"), [""; 0], "a mass that this rotor does not have");
        for (word, wrong) in [
            ("x", "'x': expected tau, angle, speed"),
            ("y.0", "'y.0': expected tau"),
            ("speed.1", "'speed.1': expected tau"),
            ("y.1+force", "'y.1+force': expected series of one unit, and force has another"),
            ("y.1+", "'': expected tau"),
        ] {
            let told = Strip::read(word).unwrap_err();
            assert!(told.starts_with(wrong), "{told}");
        }
        assert!(Strip::read_all("  ").is_err() && Strip::read_all("y z u").unwrap().len() == 3);
    }

    #[test]
    fn lines_of_one_strip_differ_in_colour_and_in_mark() {
        for word in ["y", "y.1+z.1", "u", "force+command+u.z", "y.1+y.2+z.2+radius.1", "command.y+command.z"] {
            let traces = Strip::read(word).unwrap().traces(StepLayout::new(3).with_bearings(2));
            for (at, trace) in traces.iter().enumerate() {
                assert!(
                    traces[..at].iter().all(|other| other.mark != trace.mark && other.color != trace.color),
                    "{word}"
                );
            }
        }
    }

    #[test]
    fn every_number_that_is_told_of_a_step_and_every_size_is_a_series() {
        let told = CHANNELS.iter().filter(|row| row.channel.is_number()).map(|row| row.label);
        let expected: Vec<&str> = told.chain(PAIRS.map(|pair| pair.label)).chain(["damping", "u"]).collect();
        assert_eq!(names().collect::<Vec<_>>(), expected);
        assert_eq!(labels("reading.y"), ["reading.y.1", "reading.y.2", "reading.y.3"]);
        assert_eq!(labels("reading.2"), ["reading.2"]);
    }

    #[test]
    fn every_name_reads_back() {
        for name in names() {
            assert_eq!(Strip::read(name).unwrap().name, name);
        }
    }
}
