//! What a rotor is made of, and which values are allowed. Not its motion: see [`crate::ClosedLoop`].

use crate::MAX_MASSES;

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

/// A chain of 1 to 16 masses joined by massless flexible shafts. Always valid: it is checked where it is made.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Rotor {
    name: String,
    masses: Vec<Mass>,
    shafts: Vec<f64>,
}

/// Why a set of parameters is not a rotor.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RotorError {
    /// The number of masses is outside 1 to 16.
    #[error("a rotor has 1 to {MAX_MASSES} masses, found {0}")]
    Masses(usize),
    /// The number of shafts does not fit the number of masses.
    #[error("{masses} masses are joined by {} shafts, found {found}", masses - 1)]
    Shafts {
        /// How many masses there are.
        masses: usize,
        /// How many shafts were given.
        found: usize,
    },
    /// One value is outside its range.
    #[error("{what} {index}: {field} = {found}: expected {expected}")]
    Value {
        /// `mass` or `shaft`.
        what: &'static str,
        /// Which one, counted from 1.
        index: usize,
        /// The name of the parameter.
        field: &'static str,
        /// The offending value.
        found: f64,
        /// The range in words.
        expected: &'static str,
    },
}

impl Rotor {
    /// Checks the parameters and makes a rotor of them. `shafts[i]` is the stiffness ratio `Rf = Kf / K_t` between
    /// masses `i` and `i + 1`.
    ///
    /// # Errors
    /// The first parameter that is out of its range, or the wrong number of masses or shafts.
    pub fn new(name: impl Into<String>, masses: Vec<Mass>, shafts: Vec<f64>) -> Result<Self, RotorError> {
        if masses.is_empty() || masses.len() > MAX_MASSES {
            return Err(RotorError::Masses(masses.len()));
        }
        if shafts.len() + 1 != masses.len() {
            return Err(RotorError::Shafts { masses: masses.len(), found: shafts.len() });
        }
        for (i, m) in masses.iter().enumerate() {
            let value =
                |field, found, expected| RotorError::Value { what: "mass", index: i + 1, field, found, expected };
            if !(m.mass.is_finite() && m.mass > 0.0) {
                return Err(value("mass", m.mass, "a finite number greater than 0"));
            }
            for (field, found) in [
                ("damping", m.damping),
                ("cross_damping", m.cross_damping),
                ("bearing_stiffness", m.bearing_stiffness),
                ("seal_stiffness", m.seal_stiffness),
                ("deadband", m.deadband),
            ] {
                if !(found.is_finite() && found >= 0.0) {
                    return Err(value(field, found, "a finite number, not negative"));
                }
            }
            if !m.unbalance.is_finite() {
                return Err(value("unbalance", m.unbalance, "a finite number"));
            }
        }
        for (i, &found) in shafts.iter().enumerate() {
            if !(found.is_finite() && found >= 0.0) {
                return Err(RotorError::Value {
                    what: "shaft",
                    index: i + 1,
                    field: "stiffness",
                    found,
                    expected: "a finite number, not negative",
                });
            }
        }
        Ok(Self { name: name.into(), masses, shafts })
    }

    /// The rotor's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How many masses it has, 1 to 16.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "a rotor is never empty")]
    pub fn len(&self) -> usize {
        self.masses.len()
    }

    /// Its masses, from one end to the other.
    #[must_use]
    pub fn masses(&self) -> &[Mass] {
        &self.masses
    }

    /// Stiffness ratios of its shafts; shaft `i` joins masses `i` and `i + 1`.
    #[must_use]
    pub fn shafts(&self) -> &[f64] {
        &self.shafts
    }

    /// The clearance of every support bearing, in `e_t`.
    #[must_use]
    pub fn deadbands(&self) -> Vec<f64> {
        self.masses.iter().map(|m| m.deadband).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Mass {
        Mass { mass: 1.0, ..Mass::default() }
    }

    #[test]
    fn refuses_what_is_out_of_range_and_names_it() {
        let told = |masses: Vec<Mass>, shafts: Vec<f64>| Rotor::new("x", masses, shafts).unwrap_err().to_string();
        assert_eq!(told(vec![], vec![]), "a rotor has 1 to 16 masses, found 0");
        assert_eq!(told(vec![unit(); 17], vec![1.0; 16]), "a rotor has 1 to 16 masses, found 17");
        assert_eq!(told(vec![unit(); 3], vec![1.0]), "3 masses are joined by 2 shafts, found 1");
        assert_eq!(
            told(vec![unit(), Mass { mass: 0.0, ..unit() }], vec![1.0]),
            "mass 2: mass = 0: expected a finite number greater than 0"
        );
        assert_eq!(
            told(vec![Mass { deadband: -1.0, ..unit() }], vec![]),
            "mass 1: deadband = -1: expected a finite number, not negative"
        );
        assert_eq!(
            told(vec![Mass { unbalance: f64::NAN, ..unit() }], vec![]),
            "mass 1: unbalance = NaN: expected a finite number"
        );
        assert_eq!(
            told(vec![unit(); 2], vec![f64::INFINITY]),
            "shaft 1: stiffness = inf: expected a finite number, not negative"
        );
    }
}
