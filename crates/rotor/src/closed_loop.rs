//! Rotor and feedback at one operating point: the coefficients of the equations of motion.
//!
//! ```text
//! p_i'' = damping_i p_i' + stiffness_i p_i - bearing_i s(|p_i|) p_i
//!         + left_i p_{i-1} + right_i p_{i+1} + unbalance_i exp(j angle) + [i = b] u
//! s(r) = 0 for r <= g,  1 - g / r for r > g                                        (3.2)-(3.4)
//! ```
//!
//! It is what a [`crate::Stepper`] steps at a steady speed ([`crate::LoopOverSpeed`] has what it needs beside it through a changing one) and what [`ClosedLoop::state_matrix`] linearises: one place where the
//! parameters enter, fixed in size and cheap to copy, so that a running simulation swaps it without allocating.

use nalgebra::DMatrix;

use crate::{C64, ControlRow, Feedback, MAX_MASSES, Rotor};

/// The coefficients of the equations of motion at one spin speed, per mass; zero beyond the last mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedLoop {
    pub(crate) masses: usize,
    pub(crate) speed: f64,
    /// On the mass's own velocity: `-2 zeta + 2 j zeta_q`.
    pub(crate) damping: [C64; MAX_MASSES],
    /// On the mass's own displacement: `j zeta R - (Rs + Rf_{i-1} + Rf_i) / Rm`.
    pub(crate) stiffness: [C64; MAX_MASSES],
    /// Shaft coupling to the mass before, `Rf_{i-1} / Rm`.
    pub(crate) left: [f64; MAX_MASSES],
    /// Shaft coupling to the mass after, `Rf_i / Rm`.
    pub(crate) right: [f64; MAX_MASSES],
    /// Support bearing with deadband, `Rb / Rm`.
    pub(crate) bearing: [f64; MAX_MASSES],
    /// Clearance of that bearing, in `e_t`.
    pub(crate) deadband: [f64; MAX_MASSES],
    /// `Re R^2`.
    pub(crate) unbalance: [f64; MAX_MASSES],
    pub(crate) control: ControlRow,
}

impl ClosedLoop {
    /// Whether these equations are those of `rotor` under `feedback`: a chain under gains alone, at one control bearing.
    #[must_use]
    pub fn describes(rotor: &Rotor, feedback: &Feedback) -> bool {
        rotor.is_chain() && feedback.only().is_some() && feedback.is_ideal()
    }

    /// Assembles the equations of motion of a chain under the gains of the first control bearing: see [`ClosedLoop::describes`].
    ///
    /// `feedback` must have passed [`Feedback::check`] for this rotor and `deadband` holds one clearance a mass;
    /// missing ones count as zero.
    ///
    /// # Panics
    /// A rotor that is no chain.
    #[must_use]
    pub fn new(rotor: &Rotor, feedback: &Feedback, speed: f64, deadband: &[f64]) -> Self {
        assert!(rotor.is_chain(), "only chains have these equations");
        let zero = [0.0; MAX_MASSES];
        let mut made = Self {
            masses: rotor.len(),
            speed,
            damping: [C64::ZERO; MAX_MASSES],
            stiffness: [C64::ZERO; MAX_MASSES],
            left: zero,
            right: zero,
            bearing: zero,
            deadband: zero,
            unbalance: zero,
            control: feedback.first().at(speed),
        };
        for (i, m) in rotor.masses().iter().enumerate() {
            let before = if i == 0 { 0.0 } else { rotor.shafts()[i - 1] };
            let after = rotor.shafts().get(i).copied().unwrap_or(0.0);
            made.damping[i] = C64::new(-2.0 * m.damping, 2.0 * m.cross_damping);
            made.stiffness[i] = C64::new(-(m.seal_stiffness + before + after) / m.mass, m.damping * speed);
            made.left[i] = before / m.mass;
            made.right[i] = after / m.mass;
            made.bearing[i] = m.bearing_stiffness / m.mass;
            made.deadband[i] = deadband.get(i).copied().unwrap_or(0.0);
            made.unbalance[i] = m.unbalance * speed * speed;
        }
        made
    }

    /// How many masses the rotor has.
    #[must_use]
    pub fn masses(&self) -> usize {
        self.masses
    }

    /// Spin speed `R`.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// The control acceleration `u` for a state, in units of `w0^2 e_t`.
    #[must_use]
    pub fn control(&self, displacement: &[C64], velocity: &[C64]) -> C64 {
        let row = &self.control;
        let on_p: C64 = row.displacement.iter().zip(displacement).map(|(g, p)| g * p).sum();
        let on_v: C64 = row.velocity.iter().zip(velocity).map(|(g, v)| g * v).sum();
        -(on_p + on_v)
    }

    /// The complex `2n x 2n` matrix `A` of `[p; p']' = A [p; p']` with the deadband neglected: every support bearing at
    /// its full stiffness.
    #[must_use]
    pub fn state_matrix(&self) -> DMatrix<C64> {
        self.state_matrix_with(&[])
    }

    /// The same with the stiffness of support bearing `i` scaled by `factors[i]` (1 where it is missing): the exact
    /// linear dynamics of a circular orbit whose deadband leaves the factor `s(|p_i|)`.
    #[must_use]
    pub fn state_matrix_with(&self, factors: &[f64]) -> DMatrix<C64> {
        let n = self.masses;
        let mut a = DMatrix::zeros(2 * n, 2 * n);
        for i in 0..n {
            a[(i, n + i)] = C64::ONE;
            let factor = factors.get(i).copied().unwrap_or(1.0);
            a[(n + i, i)] = self.stiffness[i] - self.bearing[i] * factor;
            a[(n + i, n + i)] = self.damping[i];
            if i > 0 {
                a[(n + i, i - 1)] += self.left[i];
            }
            if i + 1 < n {
                a[(n + i, i + 1)] += self.right[i];
            }
        }
        let b = n + self.control.bearing;
        for k in 0..n {
            a[(b, k)] -= self.control.displacement[k];
            a[(b, n + k)] -= self.control.velocity[k];
        }
        a
    }
}
