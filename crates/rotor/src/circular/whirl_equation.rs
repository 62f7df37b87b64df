//! The algebraic equation of circular whirl, its residual and its derivatives, for a given set of bearings in contact.

use nalgebra::{DMatrix, DVector};

use crate::{C64, ClosedLoop, ControlRow, Feedback, J, Rotor};

/// Which masses press on their support bearing: bit `k` for mass `k`.
pub(super) type Contact = u32;

/// A rotor whose circular orbits are sought.
pub(super) struct Problem<'a> {
    rotor: &'a Rotor,
    feedback: &'a Feedback,
    deadband: Vec<f64>,
    /// Synchronous under unbalance; otherwise self-excited without.
    pub forced: bool,
    /// Masses whose bearing has both stiffness and clearance.
    pub gapped: Contact,
    pub masses: usize,
}

impl<'a> Problem<'a> {
    pub(super) fn new(rotor: &'a Rotor, feedback: &'a Feedback, deadband: &[f64], forced: bool) -> Self {
        let deadband: Vec<f64> = (0..rotor.len()).map(|k| deadband.get(k).copied().unwrap_or(0.0)).collect();
        let gapped =
            rotor.masses().iter().zip(&deadband).enumerate().fold(0, |set, (k, (mass, g))| {
                if mass.bearing_stiffness > 0.0 && *g > 0.0 { set | 1 << k } else { set }
            });
        Self { rotor, feedback, deadband, forced, gapped, masses: rotor.len() }
    }

    /// The equation at one spin speed.
    pub(super) fn at(&self, speed: f64) -> Equation {
        let n = self.masses;
        let closed_loop = ClosedLoop::new(self.rotor, self.feedback, speed, &self.deadband);
        // Without clearance a bearing is linear: it belongs to the matrix.
        let factors: Vec<f64> = (0..n).map(|k| if self.gapped >> k & 1 == 1 { 0.0 } else { 1.0 }).collect();
        let state = closed_loop.state_matrix_with(&factors);
        Equation {
            stiffness: -state.view((n, 0), (n, n)),
            damping: -state.view((n, n), (n, n)),
            bearing: closed_loop.bearing[..n].to_vec(),
            clearance: self.deadband.clone(),
            forcing: DVector::from_iterator(
                n,
                closed_loop.unbalance[..n].iter().map(|f| C64::from(if self.forced { *f } else { 0.0 })),
            ),
            control: closed_loop.control,
            gapped: self.gapped,
        }
    }

    /// The largest clearance that matters, in `e_t`; 0 without any.
    pub(super) fn largest_clearance(&self) -> f64 {
        self.contacts(self.gapped).map(|k| self.deadband[k]).fold(0.0, f64::max)
    }

    /// Clearance of mass `k`.
    pub(super) fn clearance(&self, k: usize) -> f64 {
        self.deadband[k]
    }

    /// The masses in a set, ascending.
    pub(super) fn contacts(&self, set: Contact) -> impl Iterator<Item = usize> + Clone + use<> {
        (0..self.masses).filter(move |k| set >> k & 1 == 1)
    }

    /// Whether the radii agree with the set of bearings in contact that they were computed for, to a relative `slack`.
    pub(super) fn is_consistent(&self, c: &[C64], contact: Contact, slack: f64) -> bool {
        self.contacts(self.gapped).all(|k| {
            let (radius, g) = (c[k].norm(), self.deadband[k]);
            if contact >> k & 1 == 1 { radius > g * (1.0 - slack) } else { radius <= g * (1.0 + slack) }
        })
    }
}

/// The equation of circular whirl at one spin speed.
pub(super) struct Equation {
    stiffness: DMatrix<C64>,
    damping: DMatrix<C64>,
    bearing: Vec<f64>,
    clearance: Vec<f64>,
    forcing: DVector<C64>,
    control: ControlRow,
    pub gapped: Contact,
}

impl Equation {
    /// Dynamic stiffness `Z(w) = K + j w C - w^2`, without the bearings that have clearance.
    pub(super) fn dynamic_stiffness(&self, frequency: f64) -> DMatrix<C64> {
        let mut z = &self.stiffness + &self.damping * (J * frequency);
        for k in 0..z.nrows() {
            z[(k, k)] -= frequency * frequency;
        }
        z
    }

    /// The same with bearing `k` at `factor(k)` of its stiffness, for those with clearance.
    pub(super) fn stiffened(&self, frequency: f64, factor: impl Fn(usize) -> f64) -> DMatrix<C64> {
        let mut z = self.dynamic_stiffness(frequency);
        for k in 0..z.nrows() {
            if self.gapped >> k & 1 == 1 {
                z[(k, k)] += self.bearing[k] * factor(k);
            }
        }
        z
    }

    /// State matrix of the linear rotor whose bearings with clearance have `factor(k)` of their stiffness.
    pub(super) fn state_matrix(&self, factor: impl Fn(usize) -> f64) -> DMatrix<C64> {
        let n = self.bearing.len();
        let mut a = DMatrix::zeros(2 * n, 2 * n);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, n)).copy_from(&-self.stiffened(0.0, factor));
        a.view_mut((n, n), (n, n)).copy_from(&-&self.damping);
        a
    }

    /// `Re R^2` per mass; zero for a limit cycle.
    pub(super) fn forcing(&self) -> &DVector<C64> {
        &self.forcing
    }

    /// Restoring force of bearing `k` at the edge of contact extended: `b_k g_k`, what `s` takes away in contact.
    pub(super) fn slack_force(&self, k: usize) -> f64 {
        self.bearing[k] * self.clearance[k]
    }

    /// Left side minus right side, with `s = 1 - g / r` on the masses in `contact` and 0 on the others, wherever they are.
    pub(super) fn residual(&self, c: &DVector<C64>, frequency: f64, contact: Contact) -> DVector<C64> {
        let mut f = self.dynamic_stiffness(frequency) * c - &self.forcing;
        for k in 0..c.len() {
            if contact >> k & 1 == 1 {
                f[k] += c[k] * self.bearing[k] - direction(c[k]) * self.slack_force(k);
            }
        }
        f
    }

    /// Size of the terms that cancel in the residual: rounding errors are small against it.
    pub(super) fn scale(&self, c: &DVector<C64>, frequency: f64) -> f64 {
        let biggest = self.dynamic_stiffness(frequency).iter().map(|z| z.norm()).fold(0.0, f64::max);
        let bearing = self.bearing.iter().copied().fold(0.0, f64::max);
        (biggest + bearing) * c.norm() + self.forcing.norm()
    }

    /// Derivative of the residual by `c` as the pair `(A, B)` of `A q + B conj(q)`.
    ///
    /// `d(s p) = (1 - g / 2r) q + (g / 2r) (c / r)^2 conj(q)`: stiffness 1 along the radius, `s` across it.
    pub(super) fn slope(&self, c: &[C64], frequency: f64, contact: Contact) -> (DMatrix<C64>, Vec<C64>) {
        let mut a = self.dynamic_stiffness(frequency);
        let mut b = vec![C64::ZERO; c.len()];
        for (k, (b, c)) in b.iter_mut().zip(c).enumerate() {
            if contact >> k & 1 == 1 {
                let half = 0.5 * self.clearance[k] / c.norm();
                a[(k, k)] += self.bearing[k] * (1.0 - half);
                *b = direction(*c).powi(2) * (self.bearing[k] * half);
            }
        }
        (a, b)
    }

    /// Derivative of the residual by the frequency: `(j C - 2 w) c`.
    pub(super) fn by_frequency(&self, c: &DVector<C64>, frequency: f64) -> DVector<C64> {
        &self.damping * c * J - c * C64::from(2.0 * frequency)
    }

    /// Damping matrix `C` of `p'' + C p' + K p`.
    pub(super) fn damping(&self) -> &DMatrix<C64> {
        &self.damping
    }

    /// The control acceleration of the orbit, `|u|`, in `w0^2 e_t`.
    pub(super) fn force(&self, c: &[C64], frequency: f64) -> f64 {
        let row = &self.control;
        let gains = row.displacement.iter().zip(&row.velocity).map(|(p, v)| p + v * J * frequency);
        gains.zip(c).map(|(gain, c)| gain * c).sum::<C64>().norm()
    }
}

/// Unit vector along `c`.
fn direction(c: C64) -> C64 {
    let size = c.norm();
    if size > 0.0 { c / size } else { C64::ONE }
}
