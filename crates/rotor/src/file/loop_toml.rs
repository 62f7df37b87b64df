//! The loop in feedback files: `[loop]` and `filter = [..]`, dimensionless or in SI units.
//!
//! In SI files times are seconds, displacements metres, forces newtons, and the frequencies of filters hertz; what is read is
//! always dimensionless. A transfer function is then one in `s` of 1/s, and a state space moves in seconds.

use std::ops::Range;

use control::{FILTERS, Filter, PARTS, Part, Parts, STATE_SPACE};
use nalgebra::{DMatrix, DVector, RowDVector};
use text::{Domain, Reader, Table, Value, as_number};
use toml::de::DeValue;
use units::{Dimension, Units};

use super::write::{Lines, number, numbers};
use crate::Rotor;

/// What an SI file for `rotor` counts in: seconds, metres, newtons on the mass that carries the bearing, and hertz; `None` for
/// a rotor without scales.
pub(super) fn si_units(rotor: &Rotor, bearing: usize) -> Option<Units> {
    let mass = rotor.control_mass(bearing);
    rotor.scales().map(|scales| Units::of(Some(*scales), mass))
}

/// Reads `[loop]`; absent keys are absent parts.
pub(super) fn parts(reader: &mut Reader<'_>, file: &Table<'_>, units: &Units) -> Parts {
    let mut parts = Parts::default();
    let Some(table) = reader.table(file, "loop") else { return parts };
    let known: Vec<&str> = PARTS.iter().map(|part| part.name).collect();
    reader.only(table, &known);
    for part in &PARTS {
        let Some(value) = table.get(part.name) else { continue };
        match as_number(value).map(|typed| units.typed(part.dimension, typed)) {
            Some(number) if part.admits(number) => (part.set)(&mut parts, number),
            _ => reader.wrong(part.name, value, allowed(part, units)),
        }
    }
    if parts.lag_damping > 0.0
        && parts.lag == 0.0
        && let Some(value) = table.get("lag_damping")
    {
        reader.wrong("lag_damping", value, "lag = T beside it: the damping is that of the actuator's lag");
    }
    if parts.external > 0.0
        && parts.sample == 0.0
        && let Some(value) = table.get("external")
    {
        reader.wrong("external", value, "sample = T beside it: the period at which a controller outside is asked");
    }
    if parts.external_trip > 0.0
        && parts.external == 0.0
        && let Some(value) = table.get("external_trip")
    {
        reader.wrong("external_trip", value, "external = N beside it: the samples that a controller outside may miss");
    }
    if parts.sensor_at > 0.0
        && let Some(value) = table.get("sensor_at")
    {
        if parts.sensor_at.fract() != 0.0 {
            reader.wrong("sensor_at", value, "a whole number: the station of the sensor, counted from 1");
        } else if parts.sensor_gain == 1.0 {
            reader.wrong("sensor_at", value, "sensor_gain = G beside it: what that sensor reads of what is there");
        }
    }
    parts
}

fn allowed(part: &Part, units: &Units) -> String {
    let absent = if part.absent.is_finite() { format!("{} or ", part.absent) } else { String::new() };
    let [min, max] = [part.min, part.max].map(|end| units.shown(part.dimension, end));
    format!("{absent}a number from {min} to {max}")
}

/// Reads `filter = [..]` of a signal or of the bearing; there need not be any.
pub(super) fn filters(reader: &mut Reader<'_>, table: &Table<'_>, units: &Units) -> Vec<Filter> {
    let Some(value) = table.get("filter") else { return vec![] };
    let DeValue::Array(list) = value.get_ref() else {
        reader.wrong("filter", value, "a list of filters: [{ kind = \"lowpass\", corner = 8.0, order = 2 }]");
        return vec![];
    };
    list.iter().filter_map(|item| filter(reader, item, units)).collect()
}

fn filter(reader: &mut Reader<'_>, item: &Value<'_>, units: &Units) -> Option<Filter> {
    let DeValue::Table(table) = item.get_ref() else {
        reader.wrong("filter", item, "a filter: { kind = .. }");
        return None;
    };
    let kinds: Vec<&str> = FILTERS.iter().map(|(kind, _)| *kind).chain([STATE_SPACE.0]).collect();
    if !table.contains_key("kind") {
        reader.fault(item.span(), "a filter without kind", format!("kind = one of {}", kinds.join(", ")));
    }
    let chosen = reader.choice(table, "kind", &kinds)?;
    if chosen == STATE_SPACE.0 {
        return state_space(reader, table, item.span(), units);
    }
    let (kind, keys) = FILTERS.iter().find(|(kind, _)| *kind == chosen)?;
    let known: Vec<&str> = std::iter::once("kind").chain(keys.iter().copied()).collect();
    reader.only(table, &known);
    let within = (*kind, item.span());
    let mut hertz = |key| {
        let typed = reader.required(table, within.clone(), key, Domain::Positive);
        units.typed(Dimension::Frequency, typed)
    };
    let made = match *kind {
        "lowpass" => {
            let corner = hertz("corner");
            let order = reader.counted(table, "order", control::MAX_ORDER, "an order").map_or(1, |order| order + 1);
            Filter::Lowpass { corner, order }
        }
        "lead" => Filter::Lead { zero: hertz("zero"), pole: hertz("pole") },
        "notch" => Filter::Notch { frequency: hertz("frequency"), width: hertz("width") },
        "synchronous-notch" => Filter::SynchronousNotch { width: hertz("width") },
        "integrator" => {
            let rate = reader.required(table, within, "rate", Domain::Positive);
            Filter::Integrator { rate: units.typed(Dimension::Rate, rate) }
        }
        "derivative" => Filter::Derivative { corner: hertz("corner") },
        _ => {
            let mut polynomial = |key: &str| {
                let list = reader.numbers(table, key, "coefficients in falling powers of s").unwrap_or_default();
                // s of the file is s of ours times what one of ours is in theirs.
                let rate = units.typed(Dimension::Rate, 1.0);
                let scaled = |(power, (c, _)): (usize, (f64, _))| c * rate.powi(-(power as i32));
                let mut rising: Vec<f64> = list.into_iter().rev().enumerate().map(scaled).collect();
                rising.reverse();
                rising
            };
            let (numerator, denominator) = (polynomial("numerator"), polynomial("denominator"));
            Filter::Transfer { numerator, denominator }
        }
    };
    match made.check() {
        Ok(()) => Some(made),
        Err(why) => {
            // What is not a number has been told already.
            if !matches!(why, control::FilterError::NotPositive { .. }) {
                reader.fault(item.span(), why.to_string(), format!("a {kind} in order"));
            }
            None
        }
    }
}

/// Reads a controller as matrices, which is its transfer function from then on.
fn state_space(reader: &mut Reader<'_>, table: &Table<'_>, at: Range<usize>, units: &Units) -> Option<Filter> {
    let (kind, keys) = STATE_SPACE;
    let known: Vec<&str> = std::iter::once("kind").chain(keys.iter().copied()).collect();
    reader.only(table, &known);
    for key in ["a", "b", "c"] {
        if !table.contains_key(key) {
            let expected = format!("{key} = [..]: x' = a x + b y, u = c x + d y");
            reader.fault(at.clone(), format!("{kind} without {key}"), expected);
        }
    }
    let rows: Vec<Vec<f64>> = match table.get("a").map(|value| value.get_ref()) {
        Some(DeValue::Array(rows)) => rows.iter().map(|row| row_of(reader, row)).collect(),
        _ => {
            if let Some(value) = table.get("a") {
                reader.wrong("a", value, "rows of finite numbers, [[..], ..]");
            }
            return None;
        }
    };
    let columns = rows.first().map_or(0, Vec::len);
    if let Some((i, row)) = rows.iter().enumerate().find(|(_, row)| row.len() != columns) {
        let found = format!("a, row {}, of {} numbers", i + 1, row.len());
        reader.fault(at, found, format!("{columns}, as in the first row"));
        return None;
    }
    let mut list = |key: &str| -> Option<Vec<f64>> {
        Some(reader.numbers(table, key, "finite numbers, one a state")?.into_iter().map(|(number, _)| number).collect())
    };
    let (b, c) = (list("b")?, list("c")?);
    let d = reader.number(table, "d", Domain::Finite).unwrap_or(0.0);
    // A rate of the file is so many of ours: `x' = a x + b y` runs in its time.
    let rate = units.typed(Dimension::Rate, 1.0);
    let a = DMatrix::from_fn(rows.len(), columns, |i, k| rows[i][k] * rate);
    let b = DVector::from_vec(b) * rate;
    let c = RowDVector::from_vec(c);
    let are_numbers = a.iter().chain(b.iter()).chain(c.iter()).all(|number| number.is_finite());
    match Filter::of_state_space(&a, &b, &c, d) {
        Ok(made) => Some(made),
        // What is not a number has been told already.
        Err(control::FilterError::Improper) if !are_numbers => None,
        Err(why) => {
            let told = why.to_string();
            let (found, expected) = told.split_once(": expected ").unwrap_or((&told, "a controller in order"));
            reader.fault(at, found, expected);
            None
        }
    }
}

fn row_of(reader: &mut Reader<'_>, row: &Value<'_>) -> Vec<f64> {
    let DeValue::Array(row) = row.get_ref() else {
        reader.wrong("a", row, "rows of finite numbers, [[..], ..]");
        return vec![];
    };
    let number = |item: &Value<'_>| {
        as_number(item).filter(|number| number.is_finite()).unwrap_or_else(|| {
            let written = reader.written(item.span());
            reader.fault(item.span(), format!("a: {written}"), "a finite number");
            f64::NAN
        })
    };
    row.iter().map(number).collect()
}

/// Writes `filter = [..]`, unless there is none.
pub(super) fn write_filters(lines: &mut Lines, filters: &[Filter], of: &str) {
    if !filters.is_empty() {
        let list: Vec<String> = filters.iter().map(filter_text).collect();
        lines.key("filter", format!("[{}]", list.join(", ")), of);
    }
}

fn filter_text(filter: &Filter) -> String {
    let pairs = match filter {
        Filter::Lowpass { corner, order } => format!("corner = {}, order = {order}", number(*corner)),
        Filter::Lead { zero, pole } => format!("zero = {}, pole = {}", number(*zero), number(*pole)),
        Filter::Notch { frequency, width } => {
            format!("frequency = {}, width = {}", number(*frequency), number(*width))
        }
        Filter::SynchronousNotch { width } => format!("width = {}", number(*width)),
        Filter::Integrator { rate } => format!("rate = {}", number(*rate)),
        Filter::Derivative { corner } => format!("corner = {}", number(*corner)),
        Filter::Transfer { numerator, denominator } => format!(
            "numerator = {}, denominator = {}",
            numbers(numerator.iter().copied()),
            numbers(denominator.iter().copied())
        ),
    };
    format!("{{ kind = \"{}\", {pairs} }}", filter.kind())
}

/// Writes `[header]` with the parts of a loop, unless it is ideal.
pub(super) fn write_parts(lines: &mut Lines, parts: &Parts, header: &str) {
    if *parts == Parts::default() {
        return;
    }
    lines.table(header);
    for part in &PARTS {
        let value = (part.get)(parts);
        if value != part.absent {
            lines.key(part.name, number(value), part.meaning);
        }
    }
}
