//! The numbers of a drawing that may be others: one table.

use beam::{Bearing, Coefficient, Sketch};

/// A number of a part of a drawing.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    /// Which part, as files call it.
    pub part: &'static str,
    /// Which of its numbers.
    pub field: &'static str,
    /// Reads it; `None` if there is no such part.
    pub(crate) get: fn(&Sketch, usize) -> Option<f64>,
    /// Writes it; of what is a table over speed every entry by the same factor.
    pub(crate) set: fn(&mut Sketch, usize, f64),
}

impl PartialEq for Drawn {
    fn eq(&self, other: &Self) -> bool {
        (self.part, self.field) == (other.part, other.field)
    }
}

macro_rules! number {
    ($part:literal, $list:ident, $field:ident) => {
        Drawn {
            part: $part,
            field: stringify!($field),
            get: |sketch, at| sketch.$list.get(at).map(|of| of.$field),
            set: |sketch, at, value| sketch.$list[at].$field = value,
        }
    };
}

macro_rules! coefficient {
    ($part:literal, $list:ident, $field:ident) => {
        Drawn {
            part: $part,
            field: stringify!($field),
            get: |sketch, at| sketch.$list.get(at).map(|of: &Bearing| first(&of.$field)),
            set: |sketch, at, value| sketch.$list[at].$field = scaled(&sketch.$list[at].$field, value),
        }
    };
}

/// Every number of a drawing that has a part in its linear motion and may be another, in SI units.
pub(crate) const DRAWN: [Drawn; 22] = [
    number!("material", materials, density),
    number!("material", materials, youngs_modulus),
    number!("material", materials, shear_modulus),
    number!("section", sections, internal_damping),
    number!("section", sections, stiffness_damping),
    number!("section", sections, mass_damping),
    number!("section", sections, axial_force),
    number!("disc", discs, mass),
    number!("disc", discs, polar_inertia),
    number!("disc", discs, diametral_inertia),
    number!("point_mass", point_masses, mass),
    coefficient!("bearing", bearings, stiffness),
    coefficient!("bearing", bearings, damping),
    coefficient!("bearing", bearings, cross_stiffness),
    coefficient!("bearing", bearings, cross_damping),
    number!("bearing", bearings, mass),
    coefficient!("seal", seals, stiffness),
    coefficient!("seal", seals, damping),
    coefficient!("seal", seals, cross_stiffness),
    coefficient!("seal", seals, cross_damping),
    number!("seal", seals, mass),
    number!("magnetic", magnetics, negative_stiffness),
];

/// Numbers of one part of a drawing that no maker's error moves one by one, and that cannot move far alone: they are multiplied by one factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Together {
    /// Which part, as files call it.
    pub part: &'static str,
    /// What they are called as one.
    pub name: &'static str,
    /// Which of its numbers.
    pub fields: &'static [&'static str],
}

/// Moduli apart leave Poisson's ratio behind, and inertias apart what anything round can have: `Ip <= 2 Id`. Moved together a material is
/// as stiff as another of its kind, and a disc as heavy as one of the same shape.
pub(crate) const TOGETHER: [Together; 2] = [
    Together { part: "material", name: "moduli", fields: &["youngs_modulus", "shear_modulus"] },
    Together { part: "disc", name: "inertia", fields: &["mass", "polar_inertia", "diametral_inertia"] },
];

impl Together {
    /// The numbers that are moved, of the part at a place: those that are not 0.
    pub(crate) fn rows(self, sketch: &Sketch, at: usize) -> Vec<Drawn> {
        let is_one = |row: &Drawn| row.part == self.part && self.fields.contains(&row.field);
        let is_there = |row: &Drawn| (row.get)(sketch, at).is_some_and(|value| value != 0.0);
        DRAWN.into_iter().filter(|row| is_one(row) && is_there(row)).collect()
    }

    /// What a number of a drawing moves with.
    pub(crate) fn of(row: &Drawn) -> Option<Self> {
        TOGETHER.into_iter().find(|of| of.part == row.part && of.fields.contains(&row.field))
    }
}

/// A coefficient as one number: at its lowest speed.
fn first(coefficient: &Coefficient) -> f64 {
    coefficient.values().next().unwrap_or_default()
}

/// The coefficient that begins with `value`, at all speeds by the same factor.
fn scaled(coefficient: &Coefficient, value: f64) -> Coefficient {
    match coefficient {
        Coefficient::Constant(_) => Coefficient::Constant(value),
        Coefficient::Table(points) => {
            let factor = value / first(coefficient);
            Coefficient::Table(points.iter().map(|(speed, v)| (*speed, v * factor)).collect())
        }
    }
}
