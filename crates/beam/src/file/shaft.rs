//! Materials, sections and sleeves.

use std::ops::Range as Span;

use text::{Domain, Table, Value};
use toml::de::DeValue;

use super::read::Reading;
use crate::{Coupling, MAX_ELEMENTS, Material, Section, Shear, Sleeve};

/// The words for [`Shear`] in a file.
pub(super) const SHEAR: [(&str, Shear); 4] = [
    ("cowper", Shear::Cowper),
    ("hutchinson", Shear::Hutchinson),
    ("hutchinson-ross", Shear::HutchinsonOfRoss),
    ("none", Shear::Rigid),
];

/// Keys of what is in a section and in a sleeve.
const LAYER: [&str; 13] = [
    "outer",
    "inner",
    "outer_right",
    "inner_right",
    "material",
    "shear",
    "rotary_inertia",
    "gyroscopic",
    "axial_force",
    "torque",
    "mass_damping",
    "stiffness_damping",
    "internal_damping",
];

/// Reads `[material.NAME]`.
pub(super) fn materials(reading: &mut Reading<'_, '_, '_>) {
    let file = reading.file;
    let Some(value) = file.get("material") else { return };
    let DeValue::Table(materials) = value.get_ref() else {
        reading.reader.wrong("material", value, "[material.NAME] and its keys on lines of their own");
        return;
    };
    // In the order of the file, which a table does not keep.
    let mut materials: Vec<_> = materials.iter().collect();
    materials.sort_by_key(|(name, _)| name.span().start);
    for (name, value) in materials {
        let DeValue::Table(table) = value.get_ref() else {
            reading.reader.wrong(name.get_ref(), value, format!("[material.{}] and its keys", name.get_ref()));
            continue;
        };
        let reader = &mut reading.reader;
        reader.only(table, &["density", "youngs_modulus", "shear_modulus", "poisson"]);
        let within = format!("[material.{}]", name.get_ref());
        let mut required = |key| reader.required(table, (&within, value.span()), key, Domain::Positive);
        let (density, youngs_modulus) = (required("density"), required("youngs_modulus"));
        let given = (table.get("shear_modulus"), table.get("poisson"));
        let shear_modulus = match given {
            (_, None) => required("shear_modulus"),
            (None, Some(poisson)) => {
                let ratio = text::as_number(poisson).filter(|ratio| (0.0..=0.5).contains(ratio));
                ratio.map_or_else(
                    || {
                        reader.wrong("poisson", poisson, "a number from 0 to 0.5");
                        f64::NAN
                    },
                    |ratio| youngs_modulus / (2.0 * (1.0 + ratio)),
                )
            }
            (Some(_), Some(poisson)) => {
                reader.wrong("poisson", poisson, "either shear_modulus or poisson: one follows from the other");
                f64::NAN
            }
        };
        let index = reading.sketch.materials.len();
        reading.place("material", index, table, value.span());
        let name = name.get_ref().to_string();
        reading.sketch.materials.push(Material { name, density, youngs_modulus, shear_modulus });
    }
}

/// Reads `[[section]]` and `[[sleeve]]`.
pub(super) fn sections(reading: &mut Reading<'_, '_, '_>) {
    let keys: Vec<&str> = ["length", "elements", "coupling"].into_iter().chain(LAYER).collect();
    let tables = reading.tables("section", &keys);
    if reading.sketch.materials.is_empty()
        && let Some((_, at)) = tables.first()
    {
        let expected = "[material.NAME] with density, youngs_modulus and shear_modulus";
        reading.reader.fault(at.clone(), "no material", expected);
        // A stand-in, so that sections are not told to lack it one by one.
        let [density, youngs_modulus, shear_modulus] = [1.0, 1.0, 0.4];
        reading.sketch.materials.push(Material { name: "none".into(), density, youngs_modulus, shear_modulus });
    }
    for (i, (table, at)) in tables.into_iter().enumerate() {
        let within = format!("[[section]] {}", i + 1);
        let length = reading.reader.required(table, (&within, at.clone()), "length", Domain::Positive);
        if let Some(value) = table.get("coupling") {
            let made = coupling(reading, table, value, length);
            reading.sketch.sections.push(made);
            continue;
        }
        let elements = reading.reader.counted(table, "elements", MAX_ELEMENTS, "a number of elements");
        let elements = elements.map_or(1, |elements| elements + 1);
        let layer = layer(reading, table, (&within, at), length, elements);
        reading.sketch.sections.push(layer);
    }
    let keys: Vec<&str> = std::iter::once("section").chain(LAYER).collect();
    for (i, (table, at)) in reading.tables("sleeve", &keys).into_iter().enumerate() {
        let within = format!("[[sleeve]] {}", i + 1);
        let sections = reading.sketch.sections.len();
        let Some(section) = reading.reader.counted(table, "section", sections, "a section of the shaft") else {
            let expected = format!("section = the section that it sits on, 1 to {sections}");
            reading.reader.fault(at, format!("{within} without section"), expected);
            continue;
        };
        let under = reading.sketch.sections.get(section).map(|under| (under.length, under.elements));
        let (length, elements) = under.unwrap_or((f64::NAN, 1));
        let layer = layer(reading, table, (&within, at), length, elements);
        reading.sketch.sleeves.push(Sleeve { section, layer });
    }
}

fn layer(
    reading: &mut Reading<'_, '_, '_>,
    table: &Table<'_>,
    within: (&str, Span<usize>),
    length: f64,
    elements: usize,
) -> Section {
    let material = reading.material(table, within.clone());
    let reader = &mut reading.reader;
    let outer = reader.required(table, within, "outer", Domain::Positive);
    let mut number = |key, domain, otherwise| reader.number(table, key, domain).unwrap_or(otherwise);
    let inner = number("inner", Domain::NotNegative, 0.0);
    let outer_right = number("outer_right", Domain::Positive, outer);
    let inner_right = number("inner_right", Domain::NotNegative, inner);
    let [axial_force, torque] = ["axial_force", "torque"].map(|key| number(key, Domain::Finite, 0.0));
    let [mass_damping, stiffness_damping, internal_damping] =
        ["mass_damping", "stiffness_damping", "internal_damping"].map(|key| number(key, Domain::NotNegative, 0.0));
    let chosen = reader.choice(table, "shear", &SHEAR.map(|(word, _)| word));
    let shear = SHEAR.iter().find(|(word, _)| Some(*word) == chosen).map_or(Shear::Cowper, |&(_, shear)| shear);
    let [rotary_inertia, gyroscopic] =
        ["rotary_inertia", "gyroscopic"].map(|key| reader.boolean(table, key).unwrap_or(true));
    Section {
        length,
        outer,
        inner,
        outer_right,
        inner_right,
        elements,
        material,
        shear,
        rotary_inertia,
        gyroscopic,
        axial_force,
        torque,
        mass_damping,
        stiffness_damping,
        internal_damping,
        coupling: None,
    }
}

/// `coupling = { stiffness, damping, tilt_stiffness, tilt_damping }` of a section.
fn coupling(reading: &mut Reading<'_, '_, '_>, table: &Table<'_>, value: &Value<'_>, length: f64) -> Section {
    let reader = &mut reading.reader;
    reader.only(table, &["length", "coupling"]);
    let keys = ["stiffness", "damping", "tilt_stiffness", "tilt_damping"];
    let DeValue::Table(own) = value.get_ref() else {
        let expected = "{ stiffness = N/m, tilt_stiffness = N m/rad, damping = N s/m, tilt_damping = N m s/rad }";
        reader.wrong("coupling", value, expected);
        return Section::coupling(length, Coupling::default());
    };
    reader.only(own, &keys);
    let [stiffness, damping, tilt_stiffness, tilt_damping] =
        keys.map(|key| reader.number(own, key, Domain::NotNegative).unwrap_or(0.0));
    Section::coupling(length, Coupling { stiffness, damping, tilt_stiffness, tilt_damping })
}
