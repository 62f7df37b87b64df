//! One lumped mass, and the table of its parameters.

use text::Domain;

/// One lumped mass with what acts on it, in the dimensionless ratios of Tables 3.1 and 4.1.
#[derive(Clone, Copy, Debug, PartialEq, Default, serde::Serialize)]
pub struct Mass {
    /// Mass ratio `Rm = m / M_t`, greater than 0.
    pub mass: f64,
    /// Seal damping ratio `zeta = C / (2 m w0)`, at least 0. It brings the cross-coupled stiffness `zeta R` with it.
    pub damping: f64,
    /// Seal cross-coupled damping ratio `zeta_q = Cq / (2 m w0)`, at least 0.
    pub cross_damping: f64,
    /// Stiffness ratio of the support bearing, the part with deadband, `Rb = K / K_t`, at least 0.
    pub bearing_stiffness: f64,
    /// Linear stiffness ratio of the seal, `Rs = Ks / K_t`, at least 0.
    pub seal_stiffness: f64,
    /// Unbalance radius ratio `Re = e / e_t`, any finite sign: all unbalances lie in one plane.
    pub unbalance: f64,
    /// Radial clearance of the support bearing, `g / e_t`, at least 0.
    pub deadband: f64,
}

/// One parameter of a mass: a row of [`FIELDS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Its name in files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// The symbol of the dimensionless ratio, as in Table 4.1.
    pub ratio: &'static str,
    /// The symbol of the physical quantity.
    pub symbol: &'static str,
    /// The SI unit of the physical quantity.
    pub unit: &'static str,
    /// What it may be, in either system.
    pub domain: Domain,
}

const fn field(
    name: &'static str,
    meaning: &'static str,
    [ratio, symbol, unit]: [&'static str; 3],
    domain: Domain,
) -> Field {
    Field { name, meaning, ratio, symbol, unit, domain }
}

/// The parameters of a mass, in the order of [`Mass::values`]: one table for files, checks and printing.
pub const FIELDS: [Field; 7] = [
    field("mass", "lumped mass", ["Rm", "m", "kg"], Domain::Positive),
    field("damping", "seal damping", ["zeta", "C", "N s/m"], Domain::NotNegative),
    field("cross_damping", "seal cross-coupled damping", ["zeta_q", "Cq", "N s/m"], Domain::NotNegative),
    field("bearing_stiffness", "support bearing, the part with deadband", ["Rb", "K", "N/m"], Domain::NotNegative),
    field("seal_stiffness", "seal, linear", ["Rs", "Ks", "N/m"], Domain::NotNegative),
    field("unbalance", "unbalance radius", ["Re", "e", "m"], Domain::Finite),
    field("deadband", "clearance of the support bearing", ["g / e_t", "g", "m"], Domain::NotNegative),
];

/// Gives a kind of mass its parameters as one list, in the order of [`FIELDS`].
macro_rules! parameters_in_order {
    ($mass:ty) => {
        impl $mass {
            /// Its parameters, in the order of [`FIELDS`](crate::FIELDS).
            #[must_use]
            pub fn values(&self) -> [f64; 7] {
                [
                    self.mass,
                    self.damping,
                    self.cross_damping,
                    self.bearing_stiffness,
                    self.seal_stiffness,
                    self.unbalance,
                    self.deadband,
                ]
            }

            /// A mass of parameters in the order of [`FIELDS`](crate::FIELDS).
            #[must_use]
            pub fn from_values(values: [f64; 7]) -> Self {
                let [mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband] = values;
                Self { mass, damping, cross_damping, bearing_stiffness, seal_stiffness, unbalance, deadband }
            }
        }
    };
}

pub(crate) use parameters_in_order;

parameters_in_order!(Mass);
