//! What follows the name of an action, as it is typed.

use rotor::Key;

use super::action::Action;
use crate::axis::Scaling;

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

/// `LOW..HIGH`.
pub(super) fn range(text: &str) -> Option<[f64; 2]> {
    let (low, high) = text.split_once("..")?;
    Some([number(low).ok()?, number(high).ok()?])
}

/// `poles -1..0.1 0..3`, `0.5`, `orbits auto`.
pub(super) fn scale(text: &str) -> Result<Action, String> {
    let of = |word: &str| match (word, range(word)) {
        ("auto", _) => Some(Scaling::Auto),
        (_, Some(range)) => Some(Scaling::Fix(range)),
        (word, None) => number(word).and_then(positive).ok().map(Scaling::Times),
    };
    let mut words = text.split_whitespace().peekable();
    let plot = words.next_if(|word| of(word).is_none()).map(str::to_owned);
    let scalings = words.map(|word| of(word).ok_or(word)).collect::<Result<Vec<_>, _>>();
    match scalings {
        Err(found) => Err(format!("'{found}': expected auto, TIMES above 0 or LOW..HIGH")),
        Ok(scalings) if scalings.is_empty() => {
            Err(format!("{text}: expected auto, TIMES or LOW..HIGH").trim_start().into())
        }
        Ok(scalings) => Ok(Action::Scale(plot, scalings)),
    }
}

/// `2`, `2 -3..3`, `auto`.
pub(super) fn spectra(text: &str) -> Result<Action, String> {
    let (mut mass, mut along) = (None, None);
    for word in text.split_whitespace() {
        match (word, range(word), word.parse::<usize>()) {
            ("auto", ..) => (mass, along) = (Some(None), Some(Scaling::Auto)),
            (_, Some(range), _) => along = Some(Scaling::Fix(range)),
            (_, _, Ok(number @ 1..)) => mass = Some(Some(number - 1)),
            _ => return Err(format!("'{word}': expected a mass, LOW..HIGH or auto")),
        }
    }
    Ok(Action::Spectra(mass, along))
}

/// `kd=0.1 speed=3`, or `speed 3`.
pub(super) fn assignments(text: &str) -> Result<Action, String> {
    let spaced = text.replace('=', " = ");
    let words: Vec<&str> = spaced.split_whitespace().filter(|word| *word != "=").collect();
    let mut set = Vec::new();
    for pair in words.chunks(2) {
        let key: Key = pair[0].parse().map_err(|error: rotor::SettingsError| error.to_string())?;
        let value = pair.get(1).ok_or_else(|| format!("{key}: expected {key}=VALUE"))?;
        set.push((key, number(value).map_err(|error| format!("{key} = {error}"))?));
    }
    Ok(Action::Set(set))
}
