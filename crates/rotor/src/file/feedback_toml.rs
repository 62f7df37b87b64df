//! Feedback files.

use std::ops::Range as Span;

use text::{Domain, Faults, Reader, Table, Value, as_number};
use toml::de::DeValue;
use units::Units;

use super::known_rotor::KnownRotor;
use super::loop_toml;
use crate::parameters::is_setting;
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

fn read(text: &str, masses: Option<usize>, rotor: Option<&Rotor>) -> Result<Feedback, Faults> {
    let (mut reader, file) = Reader::parse(text)?;
    let of = if masses.is_some() { "a mass of the rotor" } else { "a mass" };
    let place = KnownRotor { masses: masses.unwrap_or_else(|| implied_masses(&file)), of, rotor };
    let bearings = match file.get("bearing").map(Value::get_ref) {
        Some(DeValue::Array(_)) => {
            reader.only(&file, &["units", "gains", "bearing"]);
            let tables = reader.tables(&file, "bearing", Some(MAX_BEARINGS));
            let one = |(i, (table, at)): (usize, (&Table<'_>, Span<usize>))| {
                reader.only(table, &["name", place.key(), "filter", "signal", "loop"]);
                let name = reader.string(table, "name", "a name in quotes").map(str::to_owned);
                let own = || place.named(name.as_deref()?, false);
                let station =
                    station(&mut reader, table, place.key(), &place, false).or_else(own).unwrap_or_else(|| {
                        let expected = format!("{} that carries it", place.words());
                        reader.fault(at, format!("[[bearing]] {} without {}", i + 1, place.key()), expected);
                        0
                    });
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
            reader.only(&file, &["units", "gains", "bearing", "filter", "signal", "loop"]);
            let station = station(&mut reader, &file, "bearing", &place, false).unwrap_or_else(|| {
                let expected = format!("bearing = {of} that carries the control bearing, 1 to {}", place.most());
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

/// The place under a key, counted from 0: of a chain its mass; of shaft elements a station of the drawing, by its number or by the name of
/// what is there.
fn station(
    reader: &mut Reader<'_>,
    table: &Table<'_>,
    key: &str,
    place: &KnownRotor<'_>,
    senses: bool,
) -> Option<usize> {
    let Some(beam) = place.beam() else { return reader.counted(table, key, place.masses, place.of) };
    let value = table.get(key)?;
    let found = match value.get_ref() {
        DeValue::String(name) => place.named(name, senses),
        DeValue::Integer(i) => {
            let station = usize::from_str_radix(i.as_str(), i.radix()).ok().and_then(|i| i.checked_sub(1));
            station.and_then(|station| beam.coordinate(station))
        }
        _ => None,
    };
    if found.is_none() {
        let stations = beam.places().iter().filter_map(|place| Some((place.station? + 1).to_string()));
        let known = stations.collect::<Vec<_>>().join(", ");
        reader.wrong(
            key,
            value,
            format!("a station that is simulated ({known}), or the name of a magnetic bearing or sensor"),
        );
    }
    Some(found.unwrap_or(0))
}

/// How many dimensionless units one unit of a gain is, on displacement and on velocity: of a file that says `gains = \"si\"` (N/m and
/// N s/m) or `gains = \"current\"` (A/m and A s/m); 1 otherwise.
fn gain_units(reader: &mut Reader<'_>, file: &Table<'_>, station: usize, place: &KnownRotor<'_>) -> [f64; 2] {
    let chosen = reader.choice(file, "gains", &["dimensionless", "si", "current"]);
    let (Some(unit), Some(value)) = (chosen.filter(|unit| *unit != "dimensionless"), file.get("gains")) else {
        return [1.0; 2];
    };
    let Some((rotor, scales)) = place.rotor.and_then(|rotor| Some((rotor, rotor.scales()?))) else {
        reader.wrong("gains", value, "\"dimensionless\": others need a rotor in SI units, whose scales they take");
        return [1.0; 2];
    };
    let per_newton = 1.0 / (rotor.control_mass(station) * scales.k_t);
    let per_unit = match unit {
        "current" => {
            let magnetic = rotor.beam().and_then(|beam| {
                beam.drawing().magnetics.iter().find(|of| beam.coordinate(of.station) == Some(station))
            });
            let Some(magnetic) = magnetic else {
                reader.wrong("gains", value, "\"si\": a current is one of a magnetic bearing of the rotor");
                return [1.0; 2];
            };
            per_newton * magnetic.force_per_current
        }
        _ => per_newton,
    };
    [per_unit, per_unit * scales.w0]
}

/// Whether a control bearing can be called so: in front of a key it must not be taken for one.
fn is_label(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(plain) && !is_setting(name)
}

/// What drives the bearing at `station`: its keys stand in `table`, the units in `file`.
fn bearing(
    reader: &mut Reader<'_>,
    file: &Table<'_>,
    table: &Table<'_>,
    station: usize,
    place: &KnownRotor<'_>,
) -> ControlBearing {
    let units = units(reader, file, place.rotor, station);
    let per_unit = gain_units(reader, file, station, place);
    let tables = reader.tables(table, "signal", Some(MAX_MASSES));
    let signals = (tables.into_iter().enumerate())
        .map(|(i, (table, at))| Signal {
            filters: loop_toml::filters(reader, table, &units),
            ..signal(reader, table, (&format!("[[signal]] {}", i + 1), &at), place, per_unit)
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

fn signal(
    reader: &mut Reader<'_>,
    table: &Table<'_>,
    (within, at): (&str, &Span<usize>),
    place: &KnownRotor<'_>,
    per_unit: [f64; 2],
) -> Signal {
    let masses = place.masses;
    reader.only(table, &[place.key(), "displacement", "velocity", "kd", "cd", "kc", "cc", "filter"]);
    let mut weights = |key: &str| {
        if let Some(DeValue::Table(named)) = table.get(key).map(|value| value.get_ref()) {
            return Some(weights_by_place(reader, key, named, place));
        }
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
    let mass = station(reader, table, place.key(), place, true);
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
            let expected = format!("either {} = N, or displacement = [..] and velocity = [..]", place.key());
            reader.fault(at.clone(), format!("{within} {found}"), expected);
            Signal::at_mass(0, masses, [0.0; 4])
        }
    };
    for kind in GainKind::ALL {
        if let Some(value) = table.get(kind.name()) {
            let per_unit = per_unit[usize::from(matches!(kind, GainKind::Cd | GainKind::Cc))];
            *signal.gain_mut(kind) = gain(reader, kind.name(), value, per_unit);
        }
    }
    signal
}

/// Weights that are called by their places, `{ left = 0.5, right = -0.5 }`: all others are 0.
fn weights_by_place(reader: &mut Reader<'_>, key: &str, named: &Table<'_>, place: &KnownRotor<'_>) -> Vec<f64> {
    let mut weights = vec![None; place.masses];
    for (name, value) in named {
        let name_text: &str = name.get_ref().as_ref();
        let number = name_text.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let found = match place.beam() {
            Some(beam) => place.named(name_text, true).or_else(|| beam.coordinate(number?)),
            None => number.filter(|mass| *mass < place.masses),
        };
        match (found, as_number(value)) {
            (Some(at), Some(_)) if weights[at].is_some() => {
                reader.fault(
                    name.span(),
                    format!("{key} of {name_text}, a place that has one already"),
                    "each place once",
                );
            }
            (Some(at), Some(weight)) if weight.abs() <= MOST_WEIGHT => weights[at] = Some(weight),
            (None, _) => reader.fault(name.span(), format!("{key} of {name_text}"), place.words()),
            _ => reader.wrong(name_text, value, format!("a weight from -{MOST_WEIGHT} to {MOST_WEIGHT}")),
        }
    }
    weights.into_iter().map(|weight| weight.unwrap_or(0.0)).collect()
}

/// A gain, of which one typed is `per_unit`.
fn gain(reader: &mut Reader<'_>, key: &str, value: &Value<'_>, per_unit: f64) -> Gain {
    let DeValue::Table(table) = value.get_ref() else {
        return Gain::Constant(bounded(reader, key, value, per_unit));
    };
    let has = |key: &str| table.contains_key(key);
    if has("at_zero") || has("slope") {
        reader.only(table, &["at_zero", "slope"]);
        let within = (key, value.span());
        let at_zero = reader.required(table, within.clone(), "at_zero", Domain::Finite);
        let slope = reader.required(table, within, "slope", Domain::Finite);
        let (min, max) = limits(key, per_unit);
        for (part, number) in [("at_zero", at_zero), ("slope", slope)] {
            if let (Some(value), true) = (table.get(part), number.is_finite() && !(min..=max).contains(&number)) {
                reader.wrong(part, value, format!("a number from {min} to {max}"));
            }
        }
        return Gain::Linear { at_zero: at_zero * per_unit, slope: slope * per_unit };
    }
    if has("speed") && has("value") {
        reader.only(table, &["speed", "value"]);
        return Gain::Table(points(reader, key, table, value, per_unit));
    }
    reader.wrong(key, value, "a number, { at_zero = A, slope = B } or { speed = [..], value = [..] }");
    Gain::Constant(0.0)
}

/// A constant gain, in the range that settings allow.
fn bounded(reader: &mut Reader<'_>, key: &str, value: &Value<'_>, per_unit: f64) -> f64 {
    let number = match value.get_ref() {
        DeValue::Integer(_) | DeValue::Float(_) => as_number(value),
        _ => {
            reader.wrong(key, value, "a number, { at_zero = A, slope = B } or { speed = [..], value = [..] }");
            return 0.0;
        }
    };
    let (min, max) = limits(key, per_unit);
    match number {
        Some(number) if (min..=max).contains(&number) => number * per_unit,
        _ => {
            reader.wrong(key, value, format!("a number from {min} to {max}"));
            0.0
        }
    }
}

/// What settings allow, as typed.
fn limits(key: &str, per_unit: f64) -> (f64, f64) {
    let all = (f64::MIN, f64::MAX);
    PARAMETERS.iter().find(|p| p.name == key).map_or(all, |p| (p.min / per_unit, p.max / per_unit))
}

fn points(reader: &mut Reader<'_>, key: &str, table: &Table<'_>, whole: &Value<'_>, per_unit: f64) -> Vec<(f64, f64)> {
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
    let (min, max) = limits(key, per_unit);
    for (value, at) in &values {
        if value.is_finite() && !(min..=max).contains(value) {
            reader.fault(at.clone(), format!("{key} value {value}"), format!("a number from {min} to {max}"));
        }
    }
    speeds.into_iter().zip(values).map(|((speed, _), (value, _))| (speed, value * per_unit)).collect()
}
