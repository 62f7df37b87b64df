//! A drawing written down.

use text::number::toml as number;
use text::{Lines, numbers, string};

use super::shaft::SHEAR;
use crate::drawing::Sketch;
use crate::{Amount, Bearing, Coefficient, Drawing, Magnetic, Matrices, Section};

/// Writes a drawing as TOML with comments. What [`read`](super::read) makes of it is the same drawing, bit for bit.
#[must_use]
pub fn write(drawing: &Drawing) -> String {
    write_and(drawing, |_, _| (), |_| ())
}

/// Writes a drawing with what else the file is to hold: `magnetic` adds to each `[[magnetic]]`, by its index, and `rest` to the end.
#[must_use]
pub fn write_and(drawing: &Drawing, magnetic: impl Fn(&mut Lines, usize), rest: impl FnOnce(&mut Lines)) -> String {
    let mut lines = Lines::default();
    top(&mut lines, drawing);
    if let Some(matrices) = &drawing.matrices {
        plant(&mut lines, matrices);
    }
    for section in &drawing.sections {
        lines.header("section");
        lines.key("length", number(section.length), "m");
        if let Some(of) = &section.coupling {
            let pairs = [
                ("stiffness", of.stiffness),
                ("damping", of.damping),
                ("tilt_stiffness", of.tilt_stiffness),
                ("tilt_damping", of.tilt_damping),
            ];
            let given = pairs.iter().filter(|(_, value)| *value != 0.0);
            let text: Vec<String> = given.map(|(key, value)| format!("{key} = {}", number(*value))).collect();
            lines.key("coupling", format!("{{ {} }}", text.join(", ")), "N/m, N s/m, N m/rad, N m s/rad");
            continue;
        }
        layer(&mut lines, drawing, section);
        if section.elements != 1 {
            lines.key("elements", section.elements, "of equal length");
        }
    }
    for sleeve in &drawing.sleeves {
        lines.header("sleeve");
        lines.key("section", sleeve.section + 1, "that it sits on, counted from 1");
        layer(&mut lines, drawing, &sleeve.layer);
    }
    for disc in &drawing.discs {
        lines.header("disc");
        station(&mut lines, disc.station);
        lines.key("mass", number(disc.mass), "kg");
        lines.key("polar_inertia", number(disc.polar_inertia), "kg m^2, about the axis");
        lines.key("diametral_inertia", number(disc.diametral_inertia), "kg m^2, about a diameter");
    }
    for point in &drawing.point_masses {
        lines.header("point_mass");
        station(&mut lines, point.station);
        lines.key("mass", number(point.mass), "kg");
    }
    for pedestal in &drawing.pedestals {
        lines.header("pedestal");
        lines.key("mass", number(pedestal.mass), "kg");
        optional(&mut lines, "stiffness", pedestal.stiffness, 0.0, "N/m, to the ground");
        optional(&mut lines, "damping", pedestal.damping, 0.0, "N s/m, to the ground");
        optional(&mut lines, "cross_stiffness", pedestal.cross_stiffness, 0.0, "N/m, to the ground");
    }
    drawing.bearings.iter().for_each(|it| bearing(&mut lines, "bearing", it));
    drawing.seals.iter().for_each(|it| bearing(&mut lines, "seal", it));
    for (i, it) in drawing.magnetics.iter().enumerate() {
        magnet(&mut lines, it);
        magnetic(&mut lines, i);
    }
    for sensor in &drawing.sensors {
        lines.header("sensor");
        lines.key("name", string(&sensor.name), "");
        station(&mut lines, sensor.station);
    }
    for unbalance in &drawing.unbalances {
        lines.header("unbalance");
        station(&mut lines, unbalance.station);
        match unbalance.amount {
            Amount::GramMillimetres(product) => lines.key("gmm", number(product), "g mm"),
            Amount::Grade { millimetres_per_second, speed } => {
                lines.key("grade", string(&format!("G{millimetres_per_second:?}")), "ISO 21940-11");
                if let Some(speed) = speed {
                    lines.key("speed", number(speed), "rpm");
                }
            }
        }
        optional(&mut lines, "angle", unbalance.angle, 0.0, "degrees");
    }
    rest(&mut lines);
    lines.into_text()
}

fn top(lines: &mut Lines, drawing: &Drawing) {
    let Sketch { name, reference_length, coordinates, mass_damping, stiffness_damping, .. } = &**drawing;
    lines.key("name", string(name), "");
    lines.key("units", string("si"), "kg, m, N, s; speeds in rpm; stations are counted from 1 at the left end");
    if let Some(length) = reference_length {
        lines.key("reference_length", number(*length), "m, stands for 1");
    }
    if let Some(coordinates) = coordinates {
        lines.key("coordinates", coordinates, "kept for stepping");
    }
    optional(lines, "mass_damping", *mass_damping, 0.0, "1/s, of shaft and discs");
    optional(lines, "stiffness_damping", *stiffness_damping, 0.0, "s, of the shaft");
    for material in &drawing.materials {
        lines.table(&format!("material.{}", key(&material.name)));
        lines.key("density", number(material.density), "kg/m^3");
        lines.key("youngs_modulus", number(material.youngs_modulus), "N/m^2");
        lines.key("shear_modulus", number(material.shear_modulus), "N/m^2");
    }
}

fn plant(lines: &mut Lines, matrices: &Matrices) {
    lines.table("plant");
    let stations: Vec<String> = matrices.stations.iter().map(|row| (row + 1).to_string()).collect();
    lines.key("stations", format!("[{}]", stations.join(", ")), "coordinates that are displacements");
    lines.key("positions", numbers(matrices.positions.iter().copied()), "m");
    if !matrices.names.is_empty() {
        let names: Vec<String> = matrices.names.iter().map(|name| string(name)).collect();
        lines.key("names", format!("[{}]", names.join(", ")), "of all coordinates");
    }
    for (name, matrix) in matrices.all() {
        // Without a matrix there is nothing; a mass there is always.
        if name == "mass" || matrix.iter().any(|entry| entry.to_bits() != 0) {
            let rows = matrix.row_iter().map(|row| format!("    {},\n", numbers(row.iter().copied())));
            lines.key(name, format!("[\n{}]", rows.collect::<String>()), "");
        }
    }
}

/// A name as a key: bare where it can be.
fn key(name: &str) -> String {
    let bare = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if bare && !name.is_empty() { name.to_owned() } else { string(name) }
}

fn station(lines: &mut Lines, station: usize) {
    lines.key("station", station + 1, "");
}

/// A number that need not be written where it is what absence means.
fn optional(lines: &mut Lines, key: &str, value: f64, absent: f64, comment: &str) {
    if value.to_bits() != absent.to_bits() {
        lines.key(key, number(value), comment);
    }
}

fn layer(lines: &mut Lines, drawing: &Drawing, section: &Section) {
    lines.key("outer", number(section.outer), "m, diameter");
    optional(lines, "inner", section.inner, 0.0, "m, diameter");
    optional(lines, "outer_right", section.outer_right, section.outer, "m, at the right end");
    optional(lines, "inner_right", section.inner_right, section.inner, "m, at the right end");
    lines.key("material", string(&drawing.materials[section.material].name), "");
    if let Some((word, _)) = SHEAR.iter().skip(1).find(|(_, shear)| *shear == section.shear) {
        lines.key("shear", string(word), "");
    }
    for (key, given) in [("rotary_inertia", section.rotary_inertia), ("gyroscopic", section.gyroscopic)] {
        if !given {
            lines.key(key, given, "");
        }
    }
    optional(lines, "axial_force", section.axial_force, 0.0, "N, tension");
    optional(lines, "torque", section.torque, 0.0, "N m");
    optional(lines, "mass_damping", section.mass_damping, 0.0, "1/s, does not turn");
    optional(lines, "stiffness_damping", section.stiffness_damping, 0.0, "s, does not turn");
    optional(lines, "internal_damping", section.internal_damping, 0.0, "s, turns with the shaft");
}

fn bearing(lines: &mut Lines, kind: &str, bearing: &Bearing) {
    lines.header(kind);
    station(lines, bearing.station);
    for (key, coefficient, comment) in [
        ("stiffness", &bearing.stiffness, "N/m"),
        ("damping", &bearing.damping, "N s/m"),
        ("cross_stiffness", &bearing.cross_stiffness, "N/m, drives forward whirl"),
        ("cross_damping", &bearing.cross_damping, "N s/m"),
    ] {
        match coefficient {
            Coefficient::Constant(value) => optional(lines, key, *value, 0.0, comment),
            Coefficient::Table(points) => {
                let (speeds, values): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
                let table = format!("{{ speed = {}, value = {} }}", numbers(speeds), numbers(values));
                lines.key(key, table, comment);
            }
        }
    }
    optional(lines, "mass", bearing.mass, 0.0, "kg, moves with the rotor");
    optional(lines, "clearance", bearing.clearance, 0.0, "m, radial");
    if let Some(pedestal) = bearing.pedestal {
        lines.key("pedestal", pedestal + 1, "that it stands on, counted from 1");
    }
}

fn magnet(lines: &mut Lines, magnetic: &Magnetic) {
    lines.header("magnetic");
    lines.key("name", string(&magnetic.name), "");
    station(lines, magnetic.station);
    if magnetic.sensor != magnetic.station {
        lines.key("sensor", magnetic.sensor + 1, "station");
    }
    lines.key("force_per_current", number(magnetic.force_per_current), "N/A");
    lines.key("negative_stiffness", number(magnetic.negative_stiffness), "N/m, pushes away");
    optional(lines, "clearance", magnetic.clearance, 0.0, "m, of the touchdown bearing");
    if let Some(stiffness) = magnetic.touchdown_stiffness {
        lines.key("touchdown_stiffness", number(stiffness), "N/m");
    }
    if let Some(controller) = &magnetic.controller {
        let [numerator, denominator] =
            [&controller.numerator, &controller.denominator].map(|row| numbers(row.iter().copied()));
        let text = format!("{{ numerator = {numerator}, denominator = {denominator} }}");
        lines.key("controller", text, "A/m, falling powers of s");
    }
}
