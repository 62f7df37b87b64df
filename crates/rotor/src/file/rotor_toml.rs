//! Rotor files.

use text::number::counted;
use text::{Domain, Fault, Faults, Reader, Table};
use toml::de::DeValue;

use super::write::{Lines, number, string};
use crate::parameters::{NO_SETTING, is_setting};
use crate::rotor::is_name;
use crate::{FIELDS, MAX_MASSES, MAX_NAME, Mass, PARAMETERS, PhysicalMass, Rotor, RotorError};

/// Reads a rotor; `default_name` is its name if the file gives none.
///
/// # Errors
/// All that is wrong with the file, with lines and columns.
pub fn read_rotor(text: &str, default_name: &str) -> Result<Rotor, Faults> {
    read(text, default_name, None)
}

/// The same of a rotor whose file may name files of matrices, which `open` gives the bytes of.
///
/// # Errors
/// All that is wrong with the file, with lines and columns.
pub fn read_rotor_with(text: &str, default_name: &str, open: &beam::Open) -> Result<Rotor, Faults> {
    read(text, default_name, Some(open))
}

fn read(text: &str, default_name: &str, open: Option<&beam::Open>) -> Result<Rotor, Faults> {
    let (mut reader, file) = Reader::parse(text)?;
    if beam::is_drawing(&file) {
        return read_drawing(text, default_name, open);
    }
    reader.only(&file, &["name", "units", "reference_length", "mass", "shaft"]);
    let name = name(&mut reader, &file).unwrap_or_else(|| fitting(default_name));
    let si = is_si(&mut reader, &file);
    let reference_length = reader.number(&file, "reference_length", Domain::Positive);
    if let (Some(value), false) = (file.get("reference_length"), si) {
        reader.wrong("reference_length", value, "units = \"si\" with it: dimensionless lengths are in e_t");
    }

    let tables = reader.tables(&file, "mass", Some(MAX_MASSES));
    let known: Vec<&str> = FIELDS.iter().map(|field| field.name).collect();
    let mut masses = Vec::with_capacity(tables.len());
    for (i, (table, at)) in tables.iter().enumerate() {
        reader.only(table, &known);
        let within = format!("[[mass]] {}", i + 1);
        masses.push(FIELDS.map(|field| match field.domain {
            Domain::Positive => reader.required(table, (&within, at.clone()), field.name, field.domain),
            _ => reader.number(table, field.name, field.domain).unwrap_or(0.0),
        }));
    }

    let shafts = reader.tables(&file, "shaft", None);
    let needed = masses.len().saturating_sub(1);
    if shafts.len() != needed && !masses.is_empty() {
        let at = shafts.get(needed).or(shafts.last()).or(tables.last()).map_or(0..0, |(_, at)| at.clone());
        let (found, needed) = (counted(shafts.len(), "shaft", "shafts"), counted(needed, "[[shaft]]", "[[shaft]]"));
        let masses = counted(masses.len(), "mass", "masses");
        reader.fault(at, format!("{masses} and {found}"), format!("{needed}, one between each two masses"));
    }
    let stiffness: Vec<f64> = (shafts.iter().enumerate())
        .map(|(i, (table, at))| {
            reader.only(table, &["stiffness"]);
            reader.required(table, (&format!("[[shaft]] {}", i + 1), at.clone()), "stiffness", Domain::NotNegative)
        })
        .collect();
    reader.check()?;

    let made = if si {
        Rotor::from_si(name, masses.into_iter().map(PhysicalMass::from_values).collect(), stiffness, reference_length)
    } else {
        Rotor::new(name, masses.into_iter().map(Mass::from_values).collect(), stiffness)
    };
    let rotor = made.map_err(|error| out_of_scale(&file, text, &error))?;
    within_settings(&mut reader, &rotor, &tables);
    reader.finish(rotor)
}

/// Reads a rotor of shaft elements: see [`beam::read`].
fn read_drawing(text: &str, default_name: &str, open: Option<&beam::Open>) -> Result<Rotor, Faults> {
    let also = beam::Also { open, ..beam::Also::default() };
    let (drawing, ()) = beam::read_and(text, default_name, also, |reader, file, drawing| {
        let magnets = reader.tables(file, "magnetic", None);
        for ((table, at), magnetic) in
            magnets.into_iter().zip(&drawing.magnetics).filter(|(_, of)| is_setting(&of.name))
        {
            let at = table.get("name").map_or(at, |name| name.span());
            reader.fault(at, format!("name = {:?}", magnetic.name), NO_SETTING);
        }
    })?;
    // What only the whole has wrong has no line of its own.
    Rotor::from_drawing(drawing).map_err(|error| {
        let told = error.to_string();
        let (found, expected) = told.split_once(": expected ").unwrap_or((&told, "a rotor that can be simulated"));
        Fault::at(text, 0..0, found, expected).into()
    })
}

fn name(reader: &mut Reader<'_>, file: &Table<'_>) -> Option<String> {
    let value = file.get("name")?;
    match value.get_ref() {
        DeValue::String(name) if is_name(name) => return Some(name.to_string()),
        _ => reader.wrong("name", value, format!("1 to {MAX_NAME} bytes of printable text in quotes")),
    }
    None
}

fn is_si(reader: &mut Reader<'_>, file: &Table<'_>) -> bool {
    reader.choice(file, "units", &["dimensionless", "si"]) == Some("si")
}

/// What of `name` can be a rotor's name.
fn fitting(name: &str) -> String {
    let mut fitting: String = name.chars().filter(|c| !c.is_control()).collect();
    fitting.truncate(fitting.floor_char_boundary(MAX_NAME));
    if fitting.is_empty() { "rotor".into() } else { fitting }
}

/// What only the whole file has wrong, such as a sum, is told where it says that it is in SI units.
fn out_of_scale(file: &Table<'_>, text: &str, error: &RotorError) -> Faults {
    let at = file.get("units").map_or(0..0, |value| value.span());
    let told = match error {
        // The number itself was fine, or it would have been told at its place.
        RotorError::Value { .. } => format!("in dimensionless form, {error}"),
        _ => error.to_string(),
    };
    let (found, expected) = told.split_once(": expected ").unwrap_or((&told, "a rotor"));
    Fault::at(text, at, found, expected).into()
}

/// A bench can carry clearances only so large: told here, where there is a line to point to.
fn within_settings(reader: &mut Reader<'_>, rotor: &Rotor, tables: &[(&Table<'_>, std::ops::Range<usize>)]) {
    let Some(limit) = PARAMETERS.iter().find(|p| p.name == "deadband") else { return };
    for (mass, (table, _)) in rotor.masses().iter().zip(tables) {
        if let (Some(value), true) = (table.get("deadband"), mass.deadband > limit.max) {
            let most = rotor.scales().map_or_else(
                || format!("at most {}", limit.max),
                |scales| format!("at most {} e_t = {} m", limit.max, scales.metres(limit.max)),
            );
            reader.wrong("deadband", value, most);
        }
    }
}

/// Writes a rotor as TOML with comments. What [`read_rotor`] makes of it is the same rotor, bit for bit.
#[must_use]
pub fn write_rotor(rotor: &Rotor) -> String {
    if let Some(beam) = rotor.beam() {
        return beam::write(beam.drawing());
    }
    let mut lines = Lines::default();
    lines.key("name", string(rotor.name()), "");
    let Some(physical) = rotor.physical() else {
        lines.key("units", string("dimensionless"), "");
        for mass in rotor.masses() {
            lines.header("mass");
            for (field, value) in FIELDS.iter().zip(mass.values()) {
                lines.key(field.name, number(value), &format!("{}: {}", field.ratio, field.meaning));
            }
        }
        for (i, &stiffness) in rotor.shafts().iter().enumerate() {
            lines.header("shaft");
            lines.key("stiffness", number(stiffness), &format!("Rf: between masses {} and {}", i + 1, i + 2));
        }
        return lines.into_text();
    };

    let scales = physical.scales();
    lines.key("units", string("si"), "kg, N/m, N s/m, m; speeds in rpm");
    if let Some(length) = physical.reference_length() {
        lines.key("reference_length", number(length), "m, stands for e_t");
    }
    lines.comment("");
    lines.comment("Scales, and in the comments below the dimensionless values that follow from them:");
    lines.comment(&format!("w0 = {} rad/s, so R = 1 is {} rpm", scales.w0, scales.rpm(1.0)));
    lines.comment(&format!("K_t = {} N/m, M_t = {} kg, e_t = {} m", scales.k_t, scales.m_t, scales.e_t));
    for (mass, ratios) in physical.masses().iter().zip(rotor.masses()) {
        lines.header("mass");
        for ((field, value), ratio) in FIELDS.iter().zip(mass.values()).zip(ratios.values()) {
            let comment = format!("{} in {}: {}; {} = {ratio}", field.symbol, field.unit, field.meaning, field.ratio);
            lines.key(field.name, number(value), &comment);
        }
    }
    for (i, (&stiffness, ratio)) in physical.shafts().iter().zip(rotor.shafts()).enumerate() {
        lines.header("shaft");
        let comment = format!("Kf in N/m: between masses {} and {}; Rf = {ratio}", i + 1, i + 2);
        lines.key("stiffness", number(stiffness), &comment);
    }
    lines.into_text()
}
