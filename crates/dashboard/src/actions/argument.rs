//! What follows the name of an action, as it is typed.

use alarms::Watch;
use rotor::typed::{Assigned, RangeError, TypedRange};
use rotor::{Key, MAX_MASSES};
use units::{Dimension, Typed};

use super::action::{Action, TypedLimit, TypedScaling};
use crate::axis::Scaling;
use telemetry::units::dimension_of;

pub(super) fn number(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("'{text}': expected a number"))
}

pub(super) fn positive(number: f64) -> Result<f64, String> {
    if number > 0.0 { Ok(number) } else { Err(format!("{number}: expected a number above 0")) }
}

pub(super) fn whole(text: &str) -> Result<i64, String> {
    text.parse().map_err(|_| format!("'{text}': expected a whole number"))
}

/// A number by which something moves: 0 would do nothing.
pub(super) fn moves<T: Default + PartialEq + std::fmt::Display>(by: T) -> Result<T, String> {
    if by == T::default() { Err(format!("{by}: expected a number other than 0")) } else { Ok(by) }
}

/// So many times as much: once would change nothing.
pub(super) fn times(times: f64) -> Result<f64, String> {
    if times == 1.0 { Err("1: expected a number other than 1".into()) } else { positive(times) }
}

/// A finite quantity.
fn quantity(dimension: Dimension, text: &str) -> Result<Typed, String> {
    match Typed::read(dimension, text) {
        Ok(typed) if typed.number().is_finite() => Ok(typed),
        Ok(_) => Err(format!("'{text}': expected a number")),
        Err(expected) => Err(format!("'{text}': {expected}")),
    }
}

/// The words of a row of quantities: a unit that stands behind a blank belongs to the number before it.
fn quantities(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let is_unit = word.starts_with(char::is_alphabetic) && word.parse::<f64>().is_err();
        match words.last_mut().filter(|last| is_unit && last.ends_with(|c: char| c.is_ascii_digit() || c == '.')) {
            Some(number) => *number += word,
            None => words.push(word.to_owned()),
        }
    }
    words
}

/// `6 0.01`, or `0..6 0.01`, or `50Hz 10rpm/s`: where the speed goes, and how fast.
pub(super) fn run_up(text: &str) -> Result<Action, String> {
    let words = quantities(text);
    let [way, rate] = &words[..] else {
        return Err(format!("'{text}': expected where the speed goes and how fast: 6 0.01"));
    };
    // A coast-down is a range that falls.
    let ends = match way.contains("..") {
        true => {
            rotor::typed::ends(way).map(|(from, to)| (Some(from), to)).map_err(|error| format!("'{way}': {error}"))?
        }
        false => (None, way.as_str()),
    };
    let speed = |text| quantity(Dimension::Speed, text);
    let to = speed(ends.1)?;
    let from = ends.0.map(speed).transpose()?;
    // A unit at the end is that of both.
    let from = from.map(|from| if from.is_alone() { from.counted_as(to) } else { from });
    if from.is_some_and(|from| !from.is_alone() && to.is_alone()) {
        return Err(format!("'{way}': {}", RangeError::UpperUnit));
    }
    let rate = quantity(Dimension::SpeedRate, rate)?;
    positive(rate.number())?;
    Ok(Action::RunUp { from, to, rate })
}

/// `force 2 4`, `orbit 100um 200um`, `force off`, `force machine`.
pub(super) fn limit(text: &str) -> Result<Action, String> {
    let (name, rest) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
    let rest = quantities(rest);
    let watch = |name: &str| -> Result<Watch, String> {
        let known = || Watch::ALL.into_iter().filter(|watch| watch.has_limits());
        known().find(|watch| watch.name() == name).ok_or_else(|| {
            let names: Vec<&str> = known().map(Watch::name).collect();
            format!("'{name}': {}expected one of {}", text::meant(name, &names), names.join(", "))
        })
    };
    if name.is_empty() {
        return Err("'': expected what is watched, and its limits".into());
    }
    let watch = watch(name)?;
    let limit = match rest.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["off"] => TypedLimit::Off,
        ["machine"] => TypedLimit::Machine,
        [warning, alarm] => {
            let quantity = |text| quantity(dimension_of(watch), text);
            TypedLimit::Pair([quantity(warning)?, quantity(alarm)?])
        }
        _ => return Err(format!("'{text}': expected {name} WARNING ALARM, off or machine")),
    };
    Ok(Action::Limit(watch, limit))
}

/// A number within limits, which is not made to fit.
pub(super) fn within(number: f64, [low, high]: [f64; 2]) -> Result<f64, String> {
    if (low..=high).contains(&number) {
        Ok(number)
    } else {
        Err(format!("{number}: expected a number from {low} to {high}"))
    }
}

/// `LOW..HIGH`.
fn range(text: &str) -> Option<[f64; 2]> {
    rotor::typed::range(text).ok()
}

/// `poles -1..0.1 0..3`, `0.5`, `orbits auto`.
pub(super) fn scale(text: &str) -> Result<Action, String> {
    let of = |word: &str| match (word, range(word)) {
        ("auto", _) => Some(Scaling::Auto),
        (_, Some(range)) => Some(Scaling::Fix(range)),
        (word, None) => number(word).and_then(times).ok().map(Scaling::Times),
    };
    let mut words = text.split_whitespace().peekable();
    let plot = words.next_if(|word| of(word).is_none()).map(str::to_owned);
    let scalings = words.map(|word| of(word).ok_or(word)).collect::<Result<Vec<_>, _>>();
    match scalings {
        Err(found) => Err(format!("'{found}': expected auto, TIMES above 0 and other than 1, or LOW..HIGH")),
        Ok(scalings) if scalings.is_empty() => {
            Err(format!("{text}: expected auto, TIMES or LOW..HIGH").trim_start().into())
        }
        Ok(scalings) if scalings.len() > 2 => {
            Err(format!("{text}: expected one scale, or two for a plot with two axes of values"))
        }
        Ok(scalings) => Ok(Action::Scale(plot, scalings)),
    }
}

/// `2`, `2 -3..3`, `0..500Hz`, `auto`.
pub(super) fn spectra(text: &str) -> Result<Action, String> {
    let (mut mass, mut along) = (None, None);
    for word in &quantities(text) {
        let range = TypedRange::read(Dimension::Frequency, word);
        if let Err(why @ (RangeError::End(_) | RangeError::UpperUnit)) = range {
            return Err(format!("'{word}': {why}"));
        }
        let (its_mass, its_along) = match (word.as_str(), range.ok(), word.parse::<usize>()) {
            ("auto", ..) => (Some(None), Some(TypedScaling::Auto)),
            (_, Some(range), _) => (None, Some(TypedScaling::Fix(range))),
            (_, _, Ok(number @ 1..)) => (Some(Some(number - 1)), None),
            _ => return Err(format!("'{word}': expected a mass, LOW..HIGH or auto")),
        };
        if mass.is_some() && its_mass.is_some() || along.is_some() && its_along.is_some() {
            return Err(format!("'{word}' sets again what stands before it: expected each once"));
        }
        (mass, along) = (mass.or(its_mass), along.or(its_along));
    }
    Ok(Action::Spectra(mass, along))
}

/// Nothing, or `last 10min`.
pub(super) fn recording(text: &str) -> Result<Action, String> {
    let Some(last) = Some(text.trim()).filter(|text| !text.is_empty()) else { return Ok(Action::Record) };
    let duration = last.strip_prefix("last").filter(|rest| rest.starts_with(' '));
    let duration =
        duration.ok_or_else(|| format!("'{last}': expected nothing, or last and a duration such as 10min"))?;
    text::amount::seconds(duration).map(Action::RecordLast).map_err(|error| error.to_string())
}

/// `kd=0.1 speed=3`, or `speed 3`; a value may say its unit, behind a blank too: `cd = 120 N s/m`.
pub(super) fn assignments(text: &str) -> Result<Action, String> {
    let spaced = text.replace('=', " = ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let (mut at, is_sign) = (0, |at: usize| words.get(at) == Some(&"="));
    let mut set = Vec::new();
    // How many masses there are is not known here: as many as there can be.
    let mut assigned = Assigned::new(MAX_MASSES);
    while let Some(name) = words.get(at) {
        let key: Key = name.parse().map_err(|error: rotor::SettingsError| error.to_string())?;
        at += if is_sign(at + 1) { 2 } else { 1 };
        let mut value = (*words.get(at).ok_or_else(|| format!("{key}: expected {key}=VALUE"))?).to_owned();
        at += 1;
        assigned.key(key, &format!("{name}={value}")).map_err(|error| error.to_string())?;
        // What follows and is no setting, nor meant as one, belongs to the value.
        let is_unit = |word: &&&str| word.parse::<Key>().is_err() && word.parse::<f64>().is_err();
        while let Some(unit) = words.get(at).filter(is_unit).filter(|_| !is_sign(at) && !is_sign(at + 1)) {
            value = format!("{value} {unit}");
            at += 1;
        }
        let or_off = if key.parameter.off.is_some() { ", or off" } else { "" };
        let typed = key.parameter.read(&value);
        set.push((key, typed.map_err(|expected| format!("{key} = '{value}': {expected}{or_off}"))?));
    }
    Ok(Action::SetTyped(set))
}
