//! Feedback files.

use std::ops::Range as Span;

use text::{Domain, Faults, Reader, Table, Value, as_number};
use toml::de::DeValue;
use units::Units;

use super::document::is_plain;
use super::loop_toml;
use super::write::{Lines, number, numbers, string};
use crate::{ControlBearing, Feedback, Gain, GainKind, MAX_MASSES, PARAMETERS, Rotor, Signal};
use control::MAX_BEARINGS;

/// Reads feedback for `rotor`, whose units a file may use for its loop: `units = "si"`.
///
/// # Errors
/// All that is wrong with the file, or does not fit the rotor, with lines and columns.
pub fn read_feedback_for(text: &str, rotor: &Rotor) -> Result<Feedback, Faults> {
    read(text, Some(rotor.len()), Some(rotor))
}

/// Reads feedback for a rotor of `masses` masses. Without a rotor at hand, the number of masses is what the weights
/// say, or the least that has the bearing and every sensor.
///
/// # Errors
/// All that is wrong with the file, or does not fit the rotor, with lines and columns.
pub fn read_feedback(text: &str, masses: Option<usize>) -> Result<Feedback, Faults> {
    read(text, masses, None)
}

/// The rotor that feedback is read for, as far as it is known.
struct Place<'r> {
    /// How many masses it has.
    masses: usize,
    /// What a number of a mass is, in words that follow "expected".
    of: &'static str,
    rotor: Option<&'r Rotor>,
}

fn read(text: &str, masses: Option<usize>, rotor: Option<&Rotor>) -> Result<Feedback, Faults> {
    let (mut reader, file) = Reader::parse(text)?;
    let of = if masses.is_some() { "a mass of the rotor" } else { "a mass" };
    let place = Place { masses: masses.unwrap_or_else(|| implied_masses(&file)), of, rotor };
    let bearings = match file.get("bearing").map(Value::get_ref) {
        Some(DeValue::Array(_)) => {
            reader.only(&file, &["units", "bearing"]);
            let tables = reader.tables(&file, "bearing", Some(MAX_BEARINGS));
            let one = |(i, (table, at)): (usize, (&Table<'_>, Span<usize>))| {
                reader.only(table, &["name", "mass", "filter", "signal", "loop"]);
                let station = station(&mut reader, table, "mass", &place).unwrap_or_else(|| {
                    let expected = format!("mass = {of} that carries it, 1 to {}", place.masses);
                    reader.fault(at, format!("[[bearing]] {} without mass", i + 1), expected);
                    0
                });
                let name = reader.string(table, "name", "a name in quotes").map(str::to_owned);
                if let (Some(name), Some(value)) = (&name, table.get("name"))
                    && !is_label(name)
                {
                    reader.wrong(
                        "name",
                        value,
                        "a name of letters, digits, - and _ that begins with a letter and is no setting",
                    );
                }
                ControlBearing { name, ..bearing(&mut reader, &file, table, station, &place) }
            };
            tables.into_iter().enumerate().map(one).collect()
        }
        _ => {
            reader.only(&file, &["units", "bearing", "filter", "signal", "loop"]);
            let station = station(&mut reader, &file, "bearing", &place).unwrap_or_else(|| {
                let expected = format!("bearing = {of} that carries the control bearing, 1 to {}", place.masses);
                reader.fault(0..0, "no bearing", expected);
                0
            });
            vec![bearing(&mut reader, &file, &file, station, &place)]
        }
    };
    reader.check()?;
    let feedback = Feedback { bearings };
    if let Err(error) = feedback.check(place.masses) {
        // What each bearing has wrong was told at its place.
        let at = file.get("bearing").map_or(0..0, |value| value.span());
        reader.told(at, &error.to_string(), "bearings that can be closed together");
    }
    reader.finish(feedback)
}

/// The mass under a key, counted from 0.
fn station(reader: &mut Reader<'_>, table: &Table<'_>, key: &str, place: &Place<'_>) -> Option<usize> {
    reader.counted(table, key, place.masses, place.of)
}

/// Whether a control bearing can be called so: in front of a key it must not be taken for one.
fn is_label(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(plain)
        && PARAMETERS.iter().all(|p| p.name != name)
        && name != "feedback"
}

/// What drives the bearing at `station`: its keys stand in `table`, the units in `file`.
fn bearing(
    reader: &mut Reader<'_>,
    file: &Table<'_>,
    table: &Table<'_>,
    station: usize,
    place: &Place<'_>,
) -> ControlBearing {
    let units = units(reader, file, place.rotor, station);
    let tables = reader.tables(table, "signal", Some(MAX_MASSES));
    let signals = (tables.into_iter().enumerate())
        .map(|(i, (table, at))| Signal {
            filters: loop_toml::filters(reader, table, &units),
            ..signal(reader, table, &format!("[[signal]] {}", i + 1), &at, place)
        })
        .collect();
    let filters = loop_toml::filters(reader, table, &units);
    let parts = loop_toml::parts(reader, table, &units);
    ControlBearing { signals, filters, parts, ..ControlBearing::new(station, vec![]) }
}

/// What the numbers of the loop count in.
fn units(reader: &mut Reader<'_>, file: &Table<'_>, rotor: Option<&Rotor>, bearing: usize) -> Units {
    let chosen = reader.choice(file, "units", &["dimensionless", "si"]);
    let (Some("si"), Some(value)) = (chosen, file.get("units")) else { return Units::DIMENSIONLESS };
    rotor.and_then(|rotor| loop_toml::si_units(rotor, bearing)).unwrap_or_else(|| {
        reader.wrong("units", value, "\"dimensionless\": \"si\" needs a rotor in SI units, whose scales it takes");
        Units::DIMENSIONLESS
    })
}

/// How many masses a file without a rotor is meant for.
fn implied_masses(file: &Table<'_>) -> usize {
    let counted = |value: &Value<'_>| match value.get_ref() {
        DeValue::Integer(i) => i.as_str().parse().unwrap_or(0),
        _ => 0,
    };
    fn tables<'v, 't>(table: &'v Table<'t>, key: &str) -> Vec<&'v Table<'t>> {
        let list = table.get(key).and_then(|value| value.get_ref().as_array());
        list.into_iter().flatten().filter_map(|item| item.get_ref().as_table()).collect()
    }
    let bearings = tables(file, "bearing");
    let signals: Vec<&Table<'_>> =
        std::iter::once(file).chain(bearings.iter().copied()).flat_map(|table| tables(table, "signal")).collect();
    let listed = (signals.iter())
        .flat_map(|table| ["displacement", "velocity"].map(|key| table.get(key)))
        .find_map(|value| value?.get_ref().as_array().map(|list| list.len()));
    let masses = bearings.iter().chain(&signals).filter_map(|table| table.get("mass"));
    let named = file.get("bearing").into_iter().chain(masses).map(counted);
    listed.unwrap_or_else(|| named.max().unwrap_or(0)).clamp(1, MAX_MASSES)
}

/// The largest weight of a sensor, as large as the largest gain: beyond it sums leave the range of numbers.
const MOST_WEIGHT: f64 = 1e6;

fn signal(reader: &mut Reader<'_>, table: &Table<'_>, within: &str, at: &Span<usize>, place: &Place<'_>) -> Signal {
    let masses = place.masses;
    reader.only(table, &["mass", "displacement", "velocity", "kd", "cd", "kc", "cc", "filter"]);
    let mut weights = |key: &str| {
        let list = reader.numbers(table, key, "weights, one a mass")?;
        for (weight, at) in &list {
            // What is not finite has been told already.
            if weight.is_finite() && weight.abs() > MOST_WEIGHT {
                let expected = format!("a weight from -{MOST_WEIGHT} to {MOST_WEIGHT}");
                reader.fault(at.clone(), format!("{key} weight {weight:?}"), expected);
            }
        }
        if let (Some(value), true) = (table.get(key), list.len() != masses)
            && value.get_ref().is_array()
        {
            let expected = format!("{masses}, one for each mass");
            reader.fault(value.span(), format!("{key} with {} weights", list.len()), expected);
        }
        Some(list.into_iter().map(|(weight, _)| weight).collect::<Vec<_>>())
    };
    let listed = (weights("displacement"), weights("velocity"));
    let mass = station(reader, table, "mass", place);
    let mut signal = match (mass, listed) {
        (Some(mass), (None, None)) => Signal::at_mass(mass, masses, [0.0; 4]),
        (None, (Some(displacement), Some(velocity))) => {
            Signal { displacement, velocity, ..Signal::at_mass(0, masses, [0.0; 4]) }
        }
        (mass, (displacement, velocity)) => {
            let found = match (mass, displacement, velocity) {
                (Some(_), ..) => "with both mass and weights",
                (None, Some(_), None) => "without velocity weights",
                (None, None, Some(_)) => "without displacement weights",
                _ => "without mass or weights",
            };
            let expected = "either mass = N, or displacement = [..] and velocity = [..]";
            reader.fault(at.clone(), format!("{within} {found}"), expected);
            Signal::at_mass(0, masses, [0.0; 4])
        }
    };
    for kind in GainKind::ALL {
        if let Some(value) = table.get(kind.name()) {
            *signal.gain_mut(kind) = gain(reader, kind.name(), value);
        }
    }
    signal
}

fn gain(reader: &mut Reader<'_>, key: &str, value: &Value<'_>) -> Gain {
    let DeValue::Table(table) = value.get_ref() else {
        return Gain::Constant(bounded(reader, key, value));
    };
    let has = |key: &str| table.contains_key(key);
    if has("at_zero") || has("slope") {
        reader.only(table, &["at_zero", "slope"]);
        let within = (key, value.span());
        let at_zero = reader.required(table, within.clone(), "at_zero", Domain::Finite);
        let slope = reader.required(table, within, "slope", Domain::Finite);
        let (min, max) = limits(key);
        for (part, number) in [("at_zero", at_zero), ("slope", slope)] {
            if let (Some(value), true) = (table.get(part), number.is_finite() && !(min..=max).contains(&number)) {
                reader.wrong(part, value, format!("a number from {min} to {max}"));
            }
        }
        return Gain::Linear { at_zero, slope };
    }
    if has("speed") && has("value") {
        reader.only(table, &["speed", "value"]);
        return Gain::Table(points(reader, key, table, value));
    }
    reader.wrong(key, value, "a number, { at_zero = A, slope = B } or { speed = [..], value = [..] }");
    Gain::Constant(0.0)
}

/// A constant gain, in the range that settings allow.
fn bounded(reader: &mut Reader<'_>, key: &str, value: &Value<'_>) -> f64 {
    let number = match value.get_ref() {
        DeValue::Integer(_) | DeValue::Float(_) => as_number(value),
        _ => {
            reader.wrong(key, value, "a number, { at_zero = A, slope = B } or { speed = [..], value = [..] }");
            return 0.0;
        }
    };
    let (min, max) = limits(key);
    match number {
        Some(number) if (min..=max).contains(&number) => number,
        _ => {
            reader.wrong(key, value, format!("a number from {min} to {max}"));
            0.0
        }
    }
}

fn limits(key: &str) -> (f64, f64) {
    PARAMETERS.iter().find(|p| p.name == key).map_or((f64::MIN, f64::MAX), |p| (p.min, p.max))
}

fn points(reader: &mut Reader<'_>, key: &str, table: &Table<'_>, whole: &Value<'_>) -> Vec<(f64, f64)> {
    let speeds = reader.numbers(table, "speed", "speeds").unwrap_or_default();
    let values = reader.numbers(table, "value", "gains").unwrap_or_default();
    if speeds.len() != values.len() || speeds.is_empty() {
        let found = format!("{key} with {} speeds and {} values", speeds.len(), values.len());
        reader.fault(whole.span(), found, "as many values as speeds, at least one");
    }
    for pair in speeds.windows(2) {
        let [(before, _), (after, at)] = pair else { continue };
        // Not a number was told already.
        if after <= before {
            reader.fault(at.clone(), format!("speed {after} after {before}"), "rising speeds");
        }
    }
    let (min, max) = limits(key);
    for (value, at) in &values {
        if value.is_finite() && !(min..=max).contains(value) {
            reader.fault(at.clone(), format!("{key} value {value}"), format!("a number from {min} to {max}"));
        }
    }
    speeds.into_iter().zip(values).map(|((speed, _), (value, _))| (speed, value)).collect()
}

/// Writes feedback as TOML with comments. What [`read_feedback`] makes of it is the same feedback, bit for bit.
#[must_use]
pub fn write_feedback(feedback: &Feedback) -> String {
    let mut lines = Lines::default();
    lines.comment(
        "Dimensionless for any rotor: displacements in e_t, time tau = w0 t, schedules over speed R = w / w0.",
    );
    if let Some(bearing) = is_plain(feedback) {
        lines.key("bearing", bearing.station + 1, "the mass that carries the control bearing");
        write_bearing(&mut lines, bearing, "");
    } else {
        for bearing in &feedback.bearings {
            lines.header("bearing");
            if let Some(name) = &bearing.name {
                lines.key("name", string(name), "what it is called in front of its settings");
            }
            lines.key("mass", bearing.station + 1, "the mass that carries it");
            write_bearing(&mut lines, bearing, "bearing.");
        }
    }
    lines.into_text()
}

/// What drives a bearing, its tables under `within`.
fn write_bearing(lines: &mut Lines, bearing: &ControlBearing, within: &str) {
    loop_toml::write_filters(lines, &bearing.filters, "what shapes the sum of the signals");
    for signal in &bearing.signals {
        lines.header(&format!("{within}signal"));
        match sensor(signal) {
            Some(mass) => lines.key("mass", mass + 1, "the mass that carries the sensor"),
            None => {
                lines.key("displacement", numbers(signal.displacement.iter().copied()), "weights a, b, c...");
                lines.key("velocity", numbers(signal.velocity.iter().copied()), "weights d, e, f...");
            }
        }
        for kind in GainKind::ALL {
            let meaning = PARAMETERS.iter().find(|p| p.name == kind.name()).map_or("", |p| p.meaning);
            lines.key(kind.name(), gain_text(signal.gain(kind)), meaning);
        }
        loop_toml::write_filters(lines, &signal.filters, "what shapes it");
    }
    loop_toml::write_parts(lines, &bearing.parts, &format!("{within}loop"));
}

/// The one mass that a signal measures, if its weights pick exactly one.
pub(super) fn sensor(signal: &Signal) -> Option<usize> {
    let mass = signal.displacement.iter().position(|&weight| weight == 1.0)?;
    let picked = Signal::at_mass(mass, signal.displacement.len(), [0.0; 4]);
    // By bits: a weight of -0 is kept as it is.
    let bits = |weights: &[f64]| weights.iter().map(|w| w.to_bits()).collect::<Vec<_>>();
    let same = |a: &[f64], b: &[f64]| bits(a) == bits(b);
    (same(&signal.displacement, &picked.displacement) && same(&signal.velocity, &picked.velocity)).then_some(mass)
}

fn gain_text(gain: &Gain) -> String {
    match gain {
        Gain::Constant(value) => number(*value),
        Gain::Linear { at_zero, slope } => format!("{{ at_zero = {}, slope = {} }}", number(*at_zero), number(*slope)),
        Gain::Table(points) => {
            let (speeds, values): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
            format!("{{ speed = {}, value = {} }}", numbers(speeds), numbers(values))
        }
    }
}
