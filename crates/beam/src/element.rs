//! One shaft element: Timoshenko's beam between two nodes, tubes and cones alike.
//!
//! Displacement and tilt inside follow from `(p, psi)` at both ends by shape functions that are exact for a uniform beam under
//! forces at its ends, `phi = 12 E I / (kappa G A L^2)` being what shear adds to bending (Przemieniecki 1968, ch. 5; Nelson 1980). With
//! `x` from 0 to 1 along the element, rows `N` for displacement, `P` for tilt and the constant `S = N' - P` for shear:
//!
//! ```text
//! M  = int rho A N^T N + int rho I P^T P        G = 2 int rho I P^T P
//! K  = int E I P'^T P' + int kappa G A S^T S + F int N'^T N'
//! Kc = T [ .. ]      of the torque, see `torque`
//! ```
//!
//! Area and second moment of a cone are polynomials in `x` of degree 2 and 4. Five points of Gauss are exact up to degree 9, so
//! these integrals are exact. As in other programs with this element, `phi` is that of the middle.

use nalgebra::{Matrix4, RowVector4};

use crate::drawing::{Coupling, Material, Section, Shear};

/// Abscissae on -1..1 and weights of Gauss with five points.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// The matrices of an element in `p` and `psi` of its left, then of its right end.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub(crate) mass: Matrix4<f64>,
    pub(crate) damping: Matrix4<f64>,
    pub(crate) gyroscopic: Matrix4<f64>,
    pub(crate) stiffness: Matrix4<f64>,
    pub(crate) cross_stiffness: Matrix4<f64>,
    pub(crate) internal: Matrix4<f64>,
    pub(crate) shape: Shape,
}

/// The shape functions of an element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    length: f64,
    phi: f64,
}

impl Shape {
    /// Displacement at `x`, from 0 to 1.
    pub(crate) fn displacement(self, x: f64) -> RowVector4<f64> {
        let Self { length, phi } = self;
        let bubble = 0.5 * phi * x * (1.0 - x);
        RowVector4::new(
            1.0 + phi * (1.0 - x) - x * x * (3.0 - 2.0 * x),
            length * (x * (1.0 - x) * (1.0 - x) + bubble),
            phi * x + x * x * (3.0 - 2.0 * x),
            -length * (x * x * (1.0 - x) + bubble),
        ) / (1.0 + phi)
    }

    /// Its slope.
    fn slope(self, x: f64) -> RowVector4<f64> {
        self.tilt(x) + self.shear()
    }

    /// Tilt of the slice at `x`.
    fn tilt(self, x: f64) -> RowVector4<f64> {
        let Self { length, phi } = self;
        let turn = 6.0 * x * (1.0 - x) / length;
        RowVector4::new(-turn, 1.0 + phi * (1.0 - x) - x * (4.0 - 3.0 * x), turn, phi * x - x * (2.0 - 3.0 * x))
            / (1.0 + phi)
    }

    /// Curvature.
    fn curvature(self, x: f64) -> RowVector4<f64> {
        let Self { length, phi } = self;
        let turn = 6.0 * (1.0 - 2.0 * x) / length;
        RowVector4::new(-turn, 6.0 * x - 4.0 - phi, turn, 6.0 * x - 2.0 + phi) / (length * (1.0 + phi))
    }

    /// Slope less tilt, the same all along.
    fn shear(self) -> RowVector4<f64> {
        let Self { length, phi } = self;
        RowVector4::new(-1.0 / length, -0.5, 1.0 / length, -0.5) * (phi / (1.0 + phi))
    }
}

/// A coupling as an element: its ends are held together, displacement by displacement and tilt by tilt.
#[rustfmt::skip]
fn coupled(of: &Coupling, length: f64) -> Element {
    let between = |p: f64, t: f64| Matrix4::new(
          p, 0.0,  -p, 0.0,
        0.0,   t, 0.0,  -t,
         -p, 0.0,   p, 0.0,
        0.0,  -t, 0.0,   t,
    );
    Element {
        mass: Matrix4::zeros(),
        damping: between(of.damping, of.tilt_damping),
        gyroscopic: Matrix4::zeros(),
        stiffness: between(of.stiffness, of.tilt_stiffness),
        cross_stiffness: Matrix4::zeros(),
        internal: Matrix4::zeros(),
        shape: Shape { length, phi: 0.0 },
    }
}

/// The elements of a section from left to right.
pub(crate) fn elements<'a>(section: &'a Section, material: &'a Material) -> impl Iterator<Item = Element> + 'a {
    let count = section.elements;
    (0..count).map(move |i| {
        let at = |left: f64, right: f64, x: f64| left + (right - left) * x;
        let [from, to] = [i, i + 1].map(|end| end as f64 / count as f64);
        let [outer, outer_right] = [from, to].map(|x| at(section.outer, section.outer_right, x));
        let [inner, inner_right] = [from, to].map(|x| at(section.inner, section.inner_right, x));
        let length = section.length / count as f64;
        element(&Section { length, outer, inner, outer_right, inner_right, ..section.clone() }, material)
    })
}

/// Area and second moment of area of a slice.
fn slice(section: &Section, x: f64) -> (f64, f64) {
    let outer = section.outer + (section.outer_right - section.outer) * x;
    let inner = section.inner + (section.inner_right - section.inner) * x;
    let (outer, inner) = (outer * outer, inner * inner);
    let quarter = std::f64::consts::PI / 4.0;
    (quarter * (outer - inner), quarter / 16.0 * (outer * outer - inner * inner))
}

/// Shear stiffness of a slice over `G A`: the shear coefficient `kappa`.
fn shear_coefficient(section: &Section, poisson: f64) -> Option<f64> {
    let ratio = (section.inner + section.inner_right) / (section.outer + section.outer_right);
    let square = ratio * ratio;
    let whole = (1.0 + square) * (1.0 + square);
    let below = match section.shear {
        Shear::Rigid => return None,
        Shear::Cowper => whole * (7.0 + 6.0 * poisson) + square * (20.0 + 12.0 * poisson),
        Shear::Hutchinson | Shear::HutchinsonOfRoss => {
            let poisson2 = poisson * poisson;
            whole * (7.0 + 12.0 * poisson + 4.0 * poisson2) + 4.0 * square * (5.0 + 6.0 * poisson + 2.0 * poisson2)
        }
    };
    let factor = if section.shear == Shear::Hutchinson { (1.0 + poisson) * (1.0 + poisson) } else { 1.0 + poisson };
    Some(6.0 * whole * factor / below)
}

/// The matrices of `section` as one element.
fn element(section: &Section, material: &Material) -> Element {
    let length = section.length;
    if let Some(coupling) = &section.coupling {
        return coupled(coupling, length);
    }
    let (area, moment) = slice(section, 0.5);
    let bending = 12.0 * material.youngs_modulus * moment / (length * length);
    let kappa = shear_coefficient(section, material.poisson());
    let phi = kappa.map_or(0.0, |kappa| bending / (kappa * material.shear_modulus * area));
    let shape = Shape { length, phi };

    let (mut translating, mut tilting) = (Matrix4::zeros(), Matrix4::zeros());
    let (mut elastic, mut tense) = (Matrix4::zeros(), Matrix4::zeros());
    for (abscissa, weight) in GAUSS {
        let x = 0.5 * (1.0 + abscissa);
        let along = 0.5 * weight * length;
        let (area, moment) = slice(section, x);
        let square = |row: RowVector4<f64>| row.transpose() * row;
        translating += square(shape.displacement(x)) * (along * material.density * area);
        tilting += square(shape.tilt(x)) * (along * material.density * moment);
        elastic += square(shape.curvature(x)) * (along * material.youngs_modulus * moment);
        if let Some(kappa) = kappa {
            elastic += square(shape.shear()) * (along * kappa * material.shear_modulus * area);
        }
        tense += square(shape.slope(x)) * along;
    }
    let mass = if section.rotary_inertia { translating + tilting } else { translating };
    let stiffness = elastic + tense * section.axial_force;
    Element {
        mass,
        damping: mass * section.mass_damping + stiffness * section.stiffness_damping,
        gyroscopic: if section.gyroscopic { tilting * 2.0 } else { Matrix4::zeros() },
        stiffness,
        cross_stiffness: torque(length) * section.torque,
        internal: elastic * section.internal_damping,
        shape,
    }
}

/// What a torque of 1 adds to `Kc`: the moment turns with the slope, so that bending in one plane pushes in the other.
#[rustfmt::skip]
fn torque(length: f64) -> Matrix4<f64> {
    let (a, b) = (1.0 / length, 0.5);
    Matrix4::new(
        0.0,  -a, 0.0,   a,
          a,  -b,  -a,   b,
        0.0,   a, 0.0,  -a,
         -a,  -b,   a,   b,
    )
}
