//! What a drawing of a rotor holds, in SI units. [`Sketch`] can be anything; a [`Drawing`] has been checked.

use std::ops::Deref;

use crate::check::{DrawingError, faults};
use crate::{Coefficient, Matrices};

/// What a shaft or disc is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name, by which sections call it in a file.
    pub name: String,
    /// Density in kg/m^3, greater than 0.
    pub density: f64,
    /// Young's modulus `E` in N/m^2, greater than 0.
    pub youngs_modulus: f64,
    /// Shear modulus `G` in N/m^2, greater than 0.
    pub shear_modulus: f64,
}

impl Material {
    /// Poisson's ratio `E / (2 G) - 1`.
    #[must_use]
    pub fn poisson(&self) -> f64 {
        self.youngs_modulus / (2.0 * self.shear_modulus) - 1.0
    }
}

/// How a section bends under shear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shear {
    /// Timoshenko's beam with the shear coefficient of G. R. Cowper (1966).
    #[default]
    Cowper,
    /// Timoshenko's beam with the shear coefficient of J. R. Hutchinson (2001).
    Hutchinson,
    /// The same divided by `1 + nu`, as ROSS 2.3 and earlier have it: for rotors that are to be theirs.
    HutchinsonOfRoss,
    /// None: the beam of Euler and Bernoulli.
    Rigid,
}

/// A piece of shaft: a tube, or a cone, in one or more elements of the same length.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Length in m, greater than 0.
    pub length: f64,
    /// Outer diameter at the left end in m, greater than 0.
    pub outer: f64,
    /// Inner diameter at the left end in m, at least 0 and less than `outer`.
    pub inner: f64,
    /// Outer diameter at the right end in m.
    pub outer_right: f64,
    /// Inner diameter at the right end in m.
    pub inner_right: f64,
    /// Into how many elements it is cut, at least 1.
    pub elements: usize,
    /// Which of the drawing's materials, counted from 0.
    pub material: usize,
    /// Its shear.
    pub shear: Shear,
    /// Whether tilting of its slices has inertia.
    pub rotary_inertia: bool,
    /// Whether that inertia is gyroscopic.
    pub gyroscopic: bool,
    /// Axial force in N; tension is positive and stiffens.
    pub axial_force: f64,
    /// Axial torque in N m; couples the two planes of bending.
    pub torque: f64,
    /// Damping that does not turn with the shaft, as a multiple of its mass, in 1/s.
    pub mass_damping: f64,
    /// Damping that does not turn with the shaft, as a multiple of its stiffness, in s.
    pub stiffness_damping: f64,
    /// Viscous damping inside the material, which turns with the shaft, as a multiple of its elastic stiffness, in s. Above the first
    /// critical speed it drives forward whirl.
    pub internal_damping: f64,
    /// A coupling in place of shaft: of all the rest only its length counts.
    pub coupling: Option<Coupling>,
}

/// A coupling between the two ends of a section, whose displacements and tilts `d` it holds together: force `k d + c d'` each. What it
/// weighs are discs at its ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coupling {
    /// Stiffness against a step of the axis in N/m.
    pub stiffness: f64,
    /// Damping of a step in N s/m.
    pub damping: f64,
    /// Stiffness against a kink of the axis in N m/rad.
    pub tilt_stiffness: f64,
    /// Damping of a kink in N m s/rad.
    pub tilt_damping: f64,
}

impl Section {
    /// A solid cylinder of the drawing's first material in one element.
    #[must_use]
    pub fn cylinder(length: f64, outer: f64) -> Self {
        Self::tube(length, outer, 0.0)
    }

    /// A tube of the drawing's first material in one element.
    #[must_use]
    pub fn tube(length: f64, outer: f64, inner: f64) -> Self {
        Self {
            length,
            outer,
            inner,
            outer_right: outer,
            inner_right: inner,
            elements: 1,
            material: 0,
            shear: Shear::Cowper,
            rotary_inertia: true,
            gyroscopic: true,
            axial_force: 0.0,
            torque: 0.0,
            mass_damping: 0.0,
            stiffness_damping: 0.0,
            internal_damping: 0.0,
            coupling: None,
        }
    }

    /// A coupling of a length.
    #[must_use]
    pub fn coupling(length: f64, coupling: Coupling) -> Self {
        // A diameter that is not asked for, of what is drawn as wide as it is long.
        Self { coupling: Some(coupling), ..Self::cylinder(length, length) }
    }
}

/// Something that sits on the same stretch of shaft as a section and bends with it: a second layer of elements between the
/// same nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Sleeve {
    /// Which section it sits on, counted from 0. Length and number of elements are that section's.
    pub section: usize,
    /// What it is; length and number of elements are the same as the section's.
    pub layer: Section,
}

/// A rigid disc.
#[derive(Clone, Debug, PartialEq)]
pub struct Disc {
    /// Where, counted from 0.
    pub station: usize,
    /// Mass in kg.
    pub mass: f64,
    /// Moment of inertia about the axis in kg m^2.
    pub polar_inertia: f64,
    /// Moment of inertia about a diameter in kg m^2.
    pub diametral_inertia: f64,
}

impl Disc {
    /// The disc of a shape: mass `rho pi b (D^2 - d^2) / 4`, polar inertia `m (D^2 + d^2) / 8`, diametral inertia
    /// `Ip / 2 + m b^2 / 12`, with outer diameter `D`, inner diameter `d`, width `b`, all in m, and density `rho` in kg/m^3.
    #[must_use]
    pub fn of_shape(station: usize, outer: f64, inner: f64, width: f64, density: f64) -> Self {
        let mass = density * std::f64::consts::PI * width * (outer * outer - inner * inner) / 4.0;
        let polar_inertia = mass * (outer * outer + inner * inner) / 8.0;
        Self { station, mass, polar_inertia, diametral_inertia: polar_inertia / 2.0 + mass * width * width / 12.0 }
    }
}

/// A mass of no size.
#[derive(Clone, Debug, PartialEq)]
pub struct PointMass {
    /// Where, counted from 0.
    pub station: usize,
    /// Mass in kg.
    pub mass: f64,
}

/// A bearing that carries the rotor, or a seal: force on the rotor `-(k - j kc) p - (d - j dc) p' - m p''`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bearing {
    /// Where, counted from 0.
    pub station: usize,
    /// Direct stiffness `k` in N/m.
    pub stiffness: Coefficient,
    /// Direct damping `d` in N s/m.
    pub damping: Coefficient,
    /// Cross-coupled stiffness `kc` in N/m; where positive it drives forward whirl.
    pub cross_stiffness: Coefficient,
    /// Cross-coupled damping `dc` in N s/m.
    pub cross_damping: Coefficient,
    /// Mass that moves with the rotor, in kg.
    pub mass: f64,
    /// Radial play in m within which the stiffness does not act; 0 for a seal.
    pub clearance: f64,
    /// The pedestal that it stands on, counted from 0; without one, the ground.
    pub pedestal: Option<usize>,
}

/// What a bearing stands on that is no ground: a mass with a displacement of its own, force on it
/// `-(k - j kc) s - d s'` from the ground, and whatever its bearings push.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pedestal {
    /// Its mass in kg, greater than 0.
    pub mass: f64,
    /// Stiffness to the ground in N/m.
    pub stiffness: f64,
    /// Damping to the ground in N s/m.
    pub damping: f64,
    /// Cross-coupled stiffness to the ground in N/m.
    pub cross_stiffness: f64,
}

/// The controller of a magnetic bearing that came with an imported rotor: current `i = -C(s) p`, with `C` in A/m.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedController {
    /// Numerator of `C(s)`, falling powers of `s` in 1/s.
    pub numerator: Vec<f64>,
    /// Denominator of `C(s)`, falling powers of `s` in 1/s.
    pub denominator: Vec<f64>,
}

/// A magnetic bearing, linear about its bias: force on the rotor `ks p + ki i`.
#[derive(Clone, Debug, PartialEq)]
pub struct Magnetic {
    /// Its name, by which keys of settings call it: letters, digits, `-` and `_`, beginning with a letter.
    pub name: String,
    /// Where it pulls, counted from 0.
    pub station: usize,
    /// Where it measures, counted from 0.
    pub sensor: usize,
    /// `ki` in N/A.
    pub force_per_current: f64,
    /// `ks` in N/m, at least 0: it pushes away from the centre.
    pub negative_stiffness: f64,
    /// Radial play of the touchdown bearing in m; 0 if there is none.
    pub clearance: f64,
    /// Stiffness of the touchdown bearing in N/m.
    pub touchdown_stiffness: Option<f64>,
    /// The controller that an imported file has for it.
    pub controller: Option<ImportedController>,
}

/// A displacement sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Its name, written like that of a [`Magnetic`].
    pub name: String,
    /// Where, counted from 0.
    pub station: usize,
}

/// How much unbalance there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Mass times radius in **g mm**, as written.
    GramMillimetres(f64),
    /// A balance grade of ISO 21940-11.
    Grade {
        /// `G` in mm/s, such as 2.5.
        millimetres_per_second: f64,
        /// The spin speed in **rpm** that it is for; where absent, the one that whoever asks says: [`crate::FullModel::unbalance`].
        speed: Option<f64>,
    },
}

/// An unbalance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unbalance {
    /// Where, counted from 0.
    pub station: usize,
    /// How much.
    pub amount: Amount,
    /// Its angle in **degrees**, in the direction of spin.
    pub angle: f64,
}

/// The content of a drawing, not checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sketch {
    /// The rotor's name: 1 to [`MAX_NAME`](crate::MAX_NAME) bytes of printable text.
    pub name: String,
    /// What stands in place of a shaft, where another program has made it.
    pub matrices: Option<Matrices>,
    /// What there is to make it of.
    pub materials: Vec<Material>,
    /// The shaft from left to right. Stations are the ends of its sections.
    pub sections: Vec<Section>,
    /// What sits on the shaft and bends with it.
    pub sleeves: Vec<Sleeve>,
    /// Discs.
    pub discs: Vec<Disc>,
    /// Masses of no size.
    pub point_masses: Vec<PointMass>,
    /// Bearings that carry it.
    pub bearings: Vec<Bearing>,
    /// What bearings stand on where it is not the ground.
    pub pedestals: Vec<Pedestal>,
    /// Seals.
    pub seals: Vec<Bearing>,
    /// Magnetic bearings.
    pub magnetics: Vec<Magnetic>,
    /// Displacement sensors beside those of the magnetic bearings.
    pub sensors: Vec<Sensor>,
    /// Unbalances.
    pub unbalances: Vec<Unbalance>,
    /// Damping of shaft and discs that does not turn with them, as a multiple of their mass, in 1/s.
    pub mass_damping: f64,
    /// Damping of the shaft that does not turn with it, as a multiple of its stiffness, in s.
    pub stiffness_damping: f64,
    /// A length in m that stands for 1 where lengths are dimensionless.
    pub reference_length: Option<f64>,
    /// How many coordinates to keep for stepping.
    pub coordinates: Option<usize>,
}

impl Sketch {
    /// How many stations there are.
    pub(crate) fn station_count(&self) -> usize {
        self.matrices.as_ref().map_or(self.sections.len() + 1, |matrices| matrices.stations.len())
    }
}

/// A rotor as a drawing, checked when it was made. Its content is read as fields: `drawing.sections`.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing(Sketch);

impl Deref for Drawing {
    type Target = Sketch;

    fn deref(&self) -> &Sketch {
        &self.0
    }
}

impl Drawing {
    /// Checks a sketch.
    ///
    /// # Errors
    /// All that is wrong with it: stations that are not there, lengths that are not positive, inner diameters that are not less than
    /// outer ones, tables over speed that do not rise, names that are there twice, and whatever is not finite.
    pub fn new(sketch: Sketch) -> Result<Self, DrawingError> {
        let faults = faults(&sketch, false);
        if faults.is_empty() { Ok(Self(sketch)) } else { Err(DrawingError(faults)) }
    }

    /// The content, to be changed and checked anew.
    #[must_use]
    pub fn into_sketch(self) -> Sketch {
        self.0
    }

    /// How many stations there are: one more than sections, or as many as the matrices have.
    #[must_use]
    pub fn stations(&self) -> usize {
        self.0.station_count()
    }

    /// Where the stations are, in m from the left end.
    #[must_use]
    pub fn station_positions(&self) -> Vec<f64> {
        if let Some(matrices) = &self.matrices {
            return matrices.positions.clone();
        }
        let ends = self.sections.iter().scan(0.0, |at, section| {
            *at += section.length;
            Some(*at)
        });
        std::iter::once(0.0).chain(ends).collect()
    }

    /// How many elements the shaft is cut into; there is one node more than that.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.sections.iter().map(|section| section.elements).sum()
    }

    /// Mass of shaft, sleeves, discs and point masses in kg, without pedestals; of matrices, what moves when all stations move together.
    #[must_use]
    pub fn mass(&self) -> f64 {
        let layers = self.sections.iter().chain(self.sleeves.iter().map(|sleeve| &sleeve.layer));
        let cone = |left: f64, right: f64| left * left + left * right + right * right;
        let shaft = layers.filter(|layer| layer.coupling.is_none()).map(|layer| {
            let squares = cone(layer.outer, layer.outer_right) - cone(layer.inner, layer.inner_right);
            self.materials[layer.material].density * std::f64::consts::PI / 12.0 * layer.length * squares
        });
        let points = self.point_masses.iter().map(|point| point.mass);
        let given = self.matrices.as_ref().map_or(0.0, Matrices::whole_mass);
        given + shaft.sum::<f64>() + self.discs.iter().map(|disc| disc.mass).sum::<f64>() + points.sum::<f64>()
    }
}
