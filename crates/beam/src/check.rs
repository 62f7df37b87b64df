//! What can be wrong with a drawing. Asked in one place, whoever made it: a file, an import or a program.

mod held;

use std::collections::BTreeSet;
use std::fmt;

use text::number::counted;

use crate::drawing::{Amount, Material, Section, Sketch};
use crate::{MAX_COORDINATES, MAX_ELEMENTS, MAX_NAME, Matrices};

/// By how much, in parts of itself, a number that was computed may be beyond what it can be.
const ROUNDING: f64 = 1e-6;

/// One thing that is wrong with a drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawingFault {
    /// The table of the file that it would stand in, such as `section`; empty for the whole drawing.
    pub table: &'static str,
    /// Which of those tables, counted from 0.
    pub index: usize,
    /// The key there.
    pub key: &'static str,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

impl fmt::Display for DrawingFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.table.is_empty() {
            write!(f, "{} {}: ", self.table, self.index + 1)?;
        }
        write!(f, "{}: expected {}", self.found, self.expected)
    }
}

/// All that is wrong with a drawing; never empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawingError(pub Vec<DrawingFault>);

impl fmt::Display for DrawingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.0.iter().enumerate() {
            write!(f, "{}{fault}", if i > 0 { "\n" } else { "" })?;
        }
        Ok(())
    }
}

impl std::error::Error for DrawingError {}

/// Whether `name` can be a rotor's.
pub(crate) fn is_name(name: &str) -> bool {
    (1..=MAX_NAME).contains(&name.len()) && !name.chars().any(char::is_control)
}

/// Whether `name` can be part of a setting's key, as in `left.kd`.
pub(crate) fn is_key(name: &str) -> bool {
    name.len() <= MAX_NAME
        && name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

/// All that is wrong with `sketch`. Whoever has told already what is no number at all says so with `told`, and hears of it no more.
pub(crate) fn faults(sketch: &Sketch, told: bool) -> Vec<DrawingFault> {
    let mut check = Check { faults: Vec::new(), stations: sketch.station_count(), told };
    check.whole(sketch);
    for (i, material) in sketch.materials.iter().enumerate() {
        let at = ("material", i);
        let numbers = [
            ("density", material.density),
            ("youngs_modulus", material.youngs_modulus),
            ("shear_modulus", material.shear_modulus),
        ];
        numbers.into_iter().for_each(|(key, value)| check.positive(at, key, value));
        check.poisson(at, material);
        if material.name.is_empty() || sketch.materials[..i].iter().any(|other| other.name == material.name) {
            check.fault(at, "name", format!("name = {:?}", material.name), "a name of its own");
        }
    }
    for (i, section) in sketch.sections.iter().enumerate() {
        check.section(("section", i), section, sketch.materials.len());
    }
    for (i, sleeve) in sketch.sleeves.iter().enumerate() {
        let at = ("sleeve", i);
        check.section(at, &sleeve.layer, sketch.materials.len());
        match sketch.sections.get(sleeve.section) {
            None => {
                let expected = format!("one of {}", counted(sketch.sections.len(), "section", "sections"));
                check.fault(at, "section", format!("section = {}", sleeve.section + 1), expected);
            }
            Some(under) if under.length.is_nan() => {}
            Some(under) if under.length != sleeve.layer.length || under.elements != sleeve.layer.elements => {
                let found = format!("{} m in {} elements", sleeve.layer.length, sleeve.layer.elements);
                let expected = format!("{} m in {}, as the section under it", under.length, under.elements);
                check.fault(at, "section", found, expected);
            }
            Some(_) => {}
        }
    }
    for (i, disc) in sketch.discs.iter().enumerate() {
        let at = ("disc", i);
        check.station(at, "station", disc.station);
        check.not_negative(at, "mass", disc.mass);
        check.not_negative(at, "polar_inertia", disc.polar_inertia);
        check.not_negative(at, "diametral_inertia", disc.diametral_inertia);
        // Ip = sum m r^2 and Id = Ip / 2 + sum m z^2 of anything round.
        let [polar, diametral] = [disc.polar_inertia, disc.diametral_inertia];
        if polar > 2.0 * diametral * (1.0 + ROUNDING) && diametral >= 0.0 && polar.is_finite() {
            let expected =
                format!("at most {}, twice the diametral inertia, as a disc of no width has", 2.0 * diametral);
            check.fault(at, "polar_inertia", format!("polar_inertia = {polar}"), expected);
        }
    }
    for (i, point) in sketch.point_masses.iter().enumerate() {
        check.station(("point_mass", i), "station", point.station);
        check.not_negative(("point_mass", i), "mass", point.mass);
    }
    for (i, bearing) in sketch.bearings.iter().enumerate() {
        check.bearing(("bearing", i), bearing);
    }
    check.pedestals(sketch);
    for (i, seal) in sketch.seals.iter().enumerate() {
        check.bearing(("seal", i), seal);
        if seal.clearance != 0.0 {
            check.fault(("seal", i), "clearance", format!("clearance = {}", seal.clearance), "none: that of a bearing");
        }
        if let Some(pedestal) = seal.pedestal {
            check.fault(("seal", i), "pedestal", format!("pedestal = {}", pedestal + 1), "none: that of a bearing");
        }
    }
    check.magnetics(sketch);
    let mut names = BTreeSet::new();
    for (i, sensor) in sketch.sensors.iter().enumerate() {
        check.station(("sensor", i), "station", sensor.station);
        check.key(("sensor", i), &sensor.name, &mut names);
    }
    for (i, unbalance) in sketch.unbalances.iter().enumerate() {
        let at = ("unbalance", i);
        check.station(at, "station", unbalance.station);
        check.finite(at, "angle", unbalance.angle);
        match unbalance.amount {
            Amount::GramMillimetres(product) => check.not_negative(at, "gmm", product),
            Amount::Grade { millimetres_per_second, speed } => {
                check.positive(at, "grade", millimetres_per_second);
                speed.into_iter().for_each(|speed| check.positive(at, "speed", speed));
            }
        }
    }
    check.faults
}

/// A table and which of its kind.
type At = (&'static str, usize);

struct Check {
    faults: Vec<DrawingFault>,
    stations: usize,
    told: bool,
}

impl Check {
    fn fault(&mut self, (table, index): At, key: &'static str, found: String, expected: impl Into<String>) {
        self.faults.push(DrawingFault { table, index, key, found, expected: expected.into() });
    }

    fn number(&mut self, at: At, key: &'static str, value: f64, domain: text::Domain) {
        let known = self.told && value.is_nan();
        if !known && !domain.admits(value) {
            self.fault(at, key, format!("{key} = {value}"), domain.words());
        }
    }

    fn finite(&mut self, at: At, key: &'static str, value: f64) {
        self.number(at, key, value, text::Domain::Finite);
    }

    fn positive(&mut self, at: At, key: &'static str, value: f64) {
        self.number(at, key, value, text::Domain::Positive);
    }

    fn not_negative(&mut self, at: At, key: &'static str, value: f64) {
        self.number(at, key, value, text::Domain::NotNegative);
    }

    /// A material that grows thicker when it is pulled, or changes its volume the wrong way, is a slip in one of the moduli.
    fn poisson(&mut self, at: At, material: &Material) {
        let Material { youngs_modulus, shear_modulus, .. } = *material;
        let ratio = material.poisson();
        let is_known = [youngs_modulus, shear_modulus].iter().all(|modulus| *modulus > 0.0 && modulus.is_finite());
        if is_known && !(-ROUNDING..=0.5 + ROUNDING).contains(&ratio) {
            let [low, high] = [3.0, 2.0].map(|part| youngs_modulus / part);
            let found = format!("shear_modulus = {shear_modulus:e} beside youngs_modulus = {youngs_modulus:e}");
            let expected = format!(
                "{low:.4e} to {high:.4e}: Poisson's ratio E / (2 G) - 1 is {ratio:.4}, outside 0 to 0.5 (a section that does not yield to shear has shear = \"none\")"
            );
            self.fault(at, "shear_modulus", found, expected);
        }
    }

    fn station(&mut self, at: At, key: &'static str, station: usize) {
        if station >= self.stations {
            let expected = format!("a station of the shaft, 1 to {}", self.stations);
            self.fault(at, key, format!("{key} = {}", station + 1), expected);
        }
    }

    fn key(&mut self, at: At, name: &str, taken: &mut BTreeSet<String>) {
        if !is_key(name) {
            let expected = format!(
                "letters, digits, '-' and '_', beginning with a letter, at most {MAX_NAME} of them: it begins keys of settings"
            );
            self.fault(at, "name", format!("name = {name:?}"), expected);
        } else if !taken.insert(name.to_owned()) {
            self.fault(at, "name", format!("name = {name:?} again"), "a name of its own");
        }
    }

    fn whole(&mut self, sketch: &Sketch) {
        let at = ("", 0);
        if !is_name(&sketch.name) {
            let expected = format!("1 to {MAX_NAME} bytes of printable text");
            self.fault(at, "name", format!("name = {:?}", sketch.name), expected);
        }
        self.not_negative(at, "mass_damping", sketch.mass_damping);
        self.not_negative(at, "stiffness_damping", sketch.stiffness_damping);
        sketch.reference_length.into_iter().for_each(|length| self.positive(at, "reference_length", length));
        if let Some(matrices) = &sketch.matrices {
            self.matrices(sketch, matrices);
            return;
        }
        if !sketch.sections.is_empty() && sketch.sections.iter().all(|section| section.coupling.is_some()) {
            self.fault(
                ("section", 0),
                "coupling",
                "couplings alone".into(),
                "shaft on one side of a coupling at least",
            );
        }
        let elements = sketch.sections.iter().fold(0, |sum: usize, section| sum.saturating_add(section.elements));
        if sketch.sections.is_empty() || elements > MAX_ELEMENTS {
            let found = if elements == 0 { "no [[section]]".to_owned() } else { format!("{elements} elements") };
            self.fault(at, "section", found, format!("1 to {MAX_ELEMENTS} elements in all sections together"));
            return;
        }
        let pedestals = sketch.pedestals.len();
        let (least, most) = (pedestals + 1, MAX_COORDINATES.min(2 * (elements + 1) + pedestals));
        if let Some(coordinates) = sketch.coordinates
            && !(least..=most).contains(&coordinates)
        {
            let each = if pedestals > 0 { ", one a pedestal and one of the shaft at least" } else { "" };
            let expected = format!("{least} to {most}, at most {MAX_COORDINATES} and two an end of an element{each}");
            self.fault(at, "coordinates", format!("coordinates = {coordinates}"), expected);
        }
    }

    /// Matrices stand for all that is made of sections.
    fn matrices(&mut self, sketch: &Sketch, matrices: &Matrices) {
        for (key, found, expected) in matrices.faults() {
            self.fault(("plant", 0), key, found, expected);
        }
        for (table, count) in [
            ("section", sketch.sections.len()),
            ("sleeve", sketch.sleeves.len()),
            ("disc", sketch.discs.len()),
            ("material", sketch.materials.len()),
            ("pedestal", sketch.pedestals.len()),
        ] {
            if count > 0 {
                let expected = "none beside [plant], whose matrices stand for the shaft and all discs";
                self.fault((table, 0), "", format!("{table} beside matrices"), expected);
            }
        }
        for (key, value) in [("mass_damping", sketch.mass_damping), ("stiffness_damping", sketch.stiffness_damping)] {
            if value != 0.0 {
                let expected = "none beside [plant], which has a matrix of damping";
                self.fault(("", 0), key, format!("{key} = {value}"), expected);
            }
        }
        let most = MAX_COORDINATES.min(self.stations);
        if let Some(coordinates) = sketch.coordinates
            && !(1..=most).contains(&coordinates)
        {
            let expected = format!("1 to {most}, at most {MAX_COORDINATES} and one a station");
            self.fault(("", 0), "coordinates", format!("coordinates = {coordinates}"), expected);
        }
    }

    fn section(&mut self, at: At, section: &Section, materials: usize) {
        self.positive(at, "length", section.length);
        if let Some(coupling) = &section.coupling {
            let numbers = [coupling.stiffness, coupling.damping, coupling.tilt_stiffness, coupling.tilt_damping];
            let is_known = |number: f64| self.told && number.is_nan();
            let is_right = |number: f64| is_known(number) || text::Domain::NotNegative.admits(number);
            if !numbers.into_iter().all(is_right) {
                self.fault(at, "coupling", format!("coupling of {numbers:?}"), "finite numbers of at least 0");
            }
            if section.elements != 1 || at.0 == "sleeve" {
                self.fault(at, "coupling", "a coupling that is cut or sits on a section".into(), "one section, whole");
            }
            return;
        }
        self.positive(at, "outer", section.outer);
        self.positive(at, "outer_right", section.outer_right);
        self.not_negative(at, "inner", section.inner);
        self.not_negative(at, "inner_right", section.inner_right);
        for (key, inner, outer) in
            [("inner", section.inner, section.outer), ("inner_right", section.inner_right, section.outer_right)]
        {
            if inner >= outer {
                self.fault(at, key, format!("{key} = {inner}"), format!("less than the outer diameter there, {outer}"));
            }
        }
        if section.elements == 0 {
            self.fault(at, "elements", "elements = 0".into(), "at least 1");
        }
        if section.material >= materials {
            let found = format!("material {} of {materials}", section.material + 1);
            self.fault(at, "material", found, "a material of the drawing");
        }
        self.finite(at, "axial_force", section.axial_force);
        self.finite(at, "torque", section.torque);
        self.not_negative(at, "mass_damping", section.mass_damping);
        self.not_negative(at, "stiffness_damping", section.stiffness_damping);
        self.not_negative(at, "internal_damping", section.internal_damping);
    }
}
