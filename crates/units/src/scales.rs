//! The scales of a rotor in SI units.

use std::f64::consts::TAU;

/// What one dimensionless unit is in SI units. All finite and greater than 0.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Scales {
    /// Speed `R = 1` and inverse time: `w0 = sqrt(K_t / M_t)` in rad/s.
    pub w0: f64,
    /// `K_t = sum (K + Ks)` in N/m.
    pub k_t: f64,
    /// `M_t = sum m` in kg.
    pub m_t: f64,
    /// Displacement: `e_t = sum e`, or the reference length, in m.
    pub e_t: f64,
}

/// Radians per second in one revolution per minute.
const RPM: f64 = TAU / 60.0;

impl Scales {
    /// Spin speed in rpm of the dimensionless speed `R = w / w0`.
    #[must_use]
    pub fn rpm(&self, speed: f64) -> f64 {
        speed * self.w0 / RPM
    }

    /// Dimensionless spin speed `R` of a speed in rpm.
    #[must_use]
    pub fn speed(&self, rpm: f64) -> f64 {
        rpm * RPM / self.w0
    }

    /// Length in m of a length in `e_t`.
    #[must_use]
    pub fn metres(&self, length: f64) -> f64 {
        length * self.e_t
    }

    /// Length in `e_t` of a length in m.
    #[must_use]
    pub fn length(&self, metres: f64) -> f64 {
        metres / self.e_t
    }

    /// Time in s of a dimensionless time `tau = w0 t`.
    #[must_use]
    pub fn seconds(&self, tau: f64) -> f64 {
        tau / self.w0
    }

    /// Dimensionless time `tau` of a time in s.
    #[must_use]
    pub fn tau(&self, seconds: f64) -> f64 {
        seconds * self.w0
    }

    /// Force in N of a control acceleration `u` on a mass of ratio `mass_ratio` (`Rm`, dimensionless):
    /// `u Rm M_t w0^2 e_t`.
    #[must_use]
    pub fn newtons(&self, acceleration: f64, mass_ratio: f64) -> f64 {
        // M_t w0^2 is K_t, without the rounding of the square root.
        acceleration * mass_ratio * self.k_t * self.e_t
    }

    /// Control acceleration `u` in `w0^2 e_t` of a force in N on a mass of ratio `mass_ratio`.
    #[must_use]
    pub fn acceleration(&self, newtons: f64, mass_ratio: f64) -> f64 {
        newtons / (mass_ratio * self.k_t * self.e_t)
    }
}
