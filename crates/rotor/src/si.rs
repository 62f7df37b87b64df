//! Rotors given in SI units, and the scales ([`Scales`]) between them and the dimensionless form that everything computes in.
//!
//! ```text
//! M_t = sum m_i    K_t = sum (K_i + Ks_i)    w0 = sqrt(K_t / M_t)    e_t = sum e_i, or a reference length
//! Rm = m / M_t     zeta = C / (2 m w0)       zeta_q = Cq / (2 m w0)
//! Rb = K / K_t     Rs = Ks / K_t             Rf = Kf / K_t           Re = e / e_t     g / e_t
//! ```
//!
//! A rotor keeps the physical numbers that it was made of, so that writing it out again loses nothing to rounding.

use units::Scales;

use crate::mass::parameters_in_order;
use crate::rotor::{Body, check};
use crate::{Mass, Rotor, RotorError};

/// One lumped mass with what acts on it, in SI units. The ranges are those of [`Mass`].
#[derive(Clone, Copy, Debug, PartialEq, Default, serde::Serialize)]
pub struct PhysicalMass {
    /// `m` in kg.
    pub mass: f64,
    /// Seal damping `C` in N s/m. It brings the cross-coupled stiffness `C w / 2` with it (3.1).
    pub damping: f64,
    /// Seal cross-coupled damping `Cq` in N s/m.
    pub cross_damping: f64,
    /// Stiffness of the support bearing, the part with deadband, `K` in N/m.
    pub bearing_stiffness: f64,
    /// Linear stiffness of the seal, `Ks` in N/m.
    pub seal_stiffness: f64,
    /// Unbalance radius `e` in m, any sign.
    pub unbalance: f64,
    /// Radial clearance of the support bearing, `g` in m.
    pub deadband: f64,
}

parameters_in_order!(PhysicalMass);

/// The physical numbers that a rotor was made of.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Physical {
    masses: Vec<PhysicalMass>,
    shafts: Vec<f64>,
    reference_length: Option<f64>,
    /// Follows from the rest.
    #[serde(skip)]
    scales: Scales,
}

impl Physical {
    /// The masses, from one end to the other.
    #[must_use]
    pub fn masses(&self) -> &[PhysicalMass] {
        &self.masses
    }

    /// Stiffness of the shafts, `Kf` in N/m; shaft `i` joins masses `i` and `i + 1`.
    #[must_use]
    pub fn shafts(&self) -> &[f64] {
        &self.shafts
    }

    /// The length in m that stands for `e_t`, where one was given.
    #[must_use]
    pub fn reference_length(&self) -> Option<f64> {
        self.reference_length
    }

    /// What one dimensionless unit is.
    #[must_use]
    pub fn scales(&self) -> &Scales {
        &self.scales
    }
}

/// The scales of a set of physical parameters.
fn scales_of(masses: &[PhysicalMass], reference_length: Option<f64>) -> Result<Scales, RotorError> {
    let positive = |what, found: f64, expected| match found.is_finite() && found > 0.0 {
        true => Ok(found),
        false => Err(RotorError::Scale { what, found, expected }),
    };
    let sum = |of: fn(&PhysicalMass) -> f64| masses.iter().map(of).sum::<f64>();
    let m_t = positive("the sum of mass", sum(|m| m.mass), "a finite number of kg greater than 0")?;
    let k_t = positive(
        "the sum of bearing_stiffness and seal_stiffness",
        sum(|m| m.bearing_stiffness + m.seal_stiffness),
        "a finite number of N/m greater than 0, because w0 = sqrt(K_t / M_t)",
    )?;
    let w0 = positive("w0 = sqrt(K_t / M_t)", (k_t / m_t).sqrt(), "a finite number of rad/s greater than 0")?;
    let e_t = match reference_length {
        Some(length) => positive("reference_length", length, "a finite number of m greater than 0")?,
        None => {
            // Opposite unbalances leave only rounding of their sum: no length to measure by.
            let (sum, size) = (sum(|m| m.unbalance), sum(|m| m.unbalance.abs()));
            positive(
                "the sum of unbalance",
                if sum.abs() <= size * 1e-12 { 0.0 } else { sum },
                "a finite number of m greater than 0, or a reference_length in m to measure displacements by",
            )?
        }
    };
    Ok(Scales { w0, k_t, m_t, e_t })
}

/// The dimensionless ratios of a mass.
fn ratios(scales: &Scales, m: &PhysicalMass) -> Mass {
    let twice_critical = 2.0 * m.mass * scales.w0;
    Mass {
        mass: m.mass / scales.m_t,
        damping: m.damping / twice_critical,
        cross_damping: m.cross_damping / twice_critical,
        bearing_stiffness: m.bearing_stiffness / scales.k_t,
        seal_stiffness: m.seal_stiffness / scales.k_t,
        unbalance: m.unbalance / scales.e_t,
        deadband: m.deadband / scales.e_t,
    }
}

impl Rotor {
    /// A rotor of physical parameters: `masses` in SI units, `shafts[i]` the stiffness in N/m between masses `i` and
    /// `i + 1`.
    ///
    /// Displacements are measured in `e_t`, the sum of the unbalance radii. Where there is no unbalance, or opposite
    /// ones cancel, `reference_length` in m has to stand for it; where both are given, it holds.
    ///
    /// # Errors
    /// What [`Rotor::new`] refuses, in the given units; a sum of stiffness or of unbalance that is not positive; or
    /// parameters so far apart that their ratios are not finite.
    pub fn from_si(
        name: impl Into<String>,
        masses: Vec<PhysicalMass>,
        shafts: Vec<f64>,
        reference_length: Option<f64>,
    ) -> Result<Self, RotorError> {
        let name = name.into();
        check(&name, masses.iter().map(PhysicalMass::values), &shafts)?;
        let scales = scales_of(&masses, reference_length)?;
        let shaft_ratios = shafts.iter().map(|stiffness| stiffness / scales.k_t).collect();
        let mut rotor = Self::new(name, masses.iter().map(|m| ratios(&scales, m)).collect(), shaft_ratios)?;
        if let Body::Chain { physical, .. } = &mut rotor.body {
            *physical = Some(Physical { masses, shafts, reference_length, scales });
        }
        Ok(rotor)
    }

    /// The physical numbers that a chain was made of; `None` for a dimensionless one, and for shaft elements.
    #[must_use]
    pub fn physical(&self) -> Option<&Physical> {
        match &self.body {
            Body::Chain { physical, .. } => physical.as_ref(),
            Body::Beam(_) => None,
        }
    }

    /// What one dimensionless unit is; `None` for a dimensionless rotor.
    #[must_use]
    pub fn scales(&self) -> Option<&Scales> {
        match &self.body {
            Body::Chain { physical, .. } => physical.as_ref().map(Physical::scales),
            Body::Beam(beam) => Some(beam.scales()),
        }
    }

    /// The same rotor without its scales; shaft elements keep theirs.
    #[must_use]
    pub fn dimensionless(&self) -> Self {
        let mut made = self.clone();
        if let Body::Chain { physical, .. } = &mut made.body {
            *physical = None;
        }
        made
    }
}
