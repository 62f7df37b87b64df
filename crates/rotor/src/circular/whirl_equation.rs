//! The algebraic equation of circular whirl, its residual and its derivatives, for a given set of bearings in contact.

use std::cell::RefCell;
use std::rc::Rc;

use nalgebra::{DMatrix, DVector, Dyn, LU};

use super::CircularError;
use super::around::{Answer, Around};
use super::problem::Contact;
use crate::{BeamRotor, C64, ClosedLoop, ControlRow, J, OperatingPoint, PoleError, eigenvalues};

/// A mass matrix and its inverse.
#[derive(Clone)]
struct Inertia {
    matrix: DMatrix<C64>,
    inverse: DMatrix<C64>,
}

/// The coordinates that are not unknown, solved for at one frequency.
struct Under {
    /// `h^-1`.
    stiffness: DMatrix<C64>,
    /// `H`.
    whirl: DMatrix<C64>,
    /// `Z`, ready to be solved with.
    lu: LU<C64, Dyn, Dyn>,
}

impl Under {
    /// Of the dynamic stiffness of all coordinates, with the unknowns among them; `None` where it is singular.
    fn of(whole: DMatrix<C64>, seen: &[usize]) -> Option<Self> {
        let unit = DMatrix::from_fn(whole.nrows(), seen.len(), |i, k| if seen[k] == i { C64::ONE } else { C64::ZERO });
        let lu = whole.lu();
        let whirl = lu.solve(&unit)?;
        let own = DMatrix::from_fn(seen.len(), seen.len(), |i, k| whirl[(seen[i], k)]);
        Some(Self { stiffness: own.try_inverse()?, whirl, lu })
    }
}

/// The equation of circular whirl at one spin speed.
///
/// Of shaft elements only the amplitudes `c` at places with play are unknown, because only there it is not linear. With the dynamic stiffness
/// `Z(s)` of all coordinates, `H = Z^-1 E` the whirl of all under a force at each of those places, and `h = E^T H`, what is left is
///
/// ```text
/// h^-1 (c - E^T Z^-1 f) + b s(|c|) c = 0
/// ```
///
/// which is small, and of numbers like each other: the places of a stiff shaft are so near each other that `Z` spans nine decades.
#[derive(Clone)]
pub(super) struct Equation {
    /// The rate at which the whirl grows; zero on an orbit.
    growth: f64,
    /// Of a chain every row is divided by its mass; shaft elements have a matrix.
    mass: Option<Inertia>,
    stiffness: DMatrix<C64>,
    damping: DMatrix<C64>,
    /// Of each unknown.
    bearing: Vec<f64>,
    clearance: Vec<f64>,
    forcing: DVector<C64>,
    /// The coordinates that are the unknowns, where not all are.
    seen: Option<Rc<[usize]>>,
    /// What was found at the frequency that was asked for last.
    last: RefCell<Option<(f64, Option<Rc<Under>>)>>,
    control: ControlRow,
    /// A loop that is more than gains, in place of them.
    around: Option<Around>,
    pub gapped: Contact,
}

impl Equation {
    /// The equation of a rotor at its operating point, under its unbalance or without.
    pub(super) fn of(closed_loop: &ClosedLoop, forced: bool) -> Self {
        let n = closed_loop.masses;
        let is_gapped = |k: &usize| closed_loop.bearing[*k] > 0.0 && closed_loop.deadband[*k] > 0.0;
        // Without clearance a bearing is linear: it belongs to the matrix.
        let factors: Vec<f64> = (0..n).map(|k| if is_gapped(&k) { 0.0 } else { 1.0 }).collect();
        let state = closed_loop.state_matrix_with(&factors);
        Self {
            growth: 0.0,
            mass: None,
            stiffness: -state.view((n, 0), (n, n)),
            damping: -state.view((n, n), (n, n)),
            bearing: closed_loop.bearing[..n].to_vec(),
            clearance: closed_loop.deadband[..n].to_vec(),
            forcing: DVector::from_iterator(
                n,
                closed_loop.unbalance[..n].iter().map(|f| C64::from(if forced { *f } else { 0.0 })),
            ),
            control: closed_loop.control,
            seen: None,
            last: RefCell::default(),
            around: None,
            gapped: (0..n).filter(is_gapped).fold(0, |set, k| set | 1 << k),
        }
    }

    /// The equation of shaft elements at an operating point, without their control; `places` are the unknowns, all with play among them.
    pub(super) fn of_beam(
        beam: &BeamRotor,
        speed: f64,
        clearances: &[f64],
        places: &Rc<[usize]>,
        forced: bool,
    ) -> Self {
        let (plant, n) = (beam.plant(), beam.plant().order());
        let stiffness_of = |k: usize| plant.contacts()[k].stiffness;
        let is_gapped = |k: usize| stiffness_of(k) > 0.0 && clearances[k] > 0.0;
        let contact_factors = (0..n).map(|k| if is_gapped(k) { 0.0 } else { 1.0 }).collect();
        let [damping, stiffness] = plant.linear(&OperatingPoint { speed, contact_factors });
        let matrix = beam.mass();
        let inverse = matrix.clone().try_inverse().unwrap_or_else(|| DMatrix::zeros(n, n));
        let load = if forced { speed * speed } else { 0.0 };
        Self {
            growth: 0.0,
            stiffness: -(&matrix * stiffness),
            damping: -(&matrix * damping),
            forcing: &matrix * DVector::from_iterator(n, plant.unbalance().iter().map(|u| u * load)),
            mass: Some(Inertia { matrix, inverse }),
            control: ControlRow::default(),
            seen: Some(places.clone()),
            last: RefCell::default(),
            around: None,
            gapped: (places.iter().enumerate()).filter(|(_, k)| is_gapped(**k)).fold(0, |set, (i, _)| set | 1 << i),
            bearing: places.iter().map(|k| stiffness_of(*k)).collect(),
            clearance: places.iter().map(|k| clearances[*k]).collect(),
        }
    }

    /// The same with a loop that is more than gains, if there is one.
    pub(super) fn with(self, around: Option<Around>) -> Self {
        Self { around, ..self }
    }

    /// How many amplitudes are unknown.
    pub(super) fn unknowns(&self) -> usize {
        self.bearing.len()
    }

    /// How many coordinates there are.
    pub(super) fn order(&self) -> usize {
        self.stiffness.nrows()
    }

    /// Which coordinate an unknown is.
    pub(super) fn coordinate(&self, unknown: usize) -> usize {
        self.seen.as_ref().map_or(unknown, |seen| seen[unknown])
    }

    /// What a force at coordinate `k` does to the accelerations.
    pub(super) fn push(&self, k: usize) -> DVector<C64> {
        let n = self.order();
        match &self.mass {
            Some(mass) => mass.inverse.column(k).into_owned(),
            None => DVector::from_fn(n, |i, _| if i == k { C64::ONE } else { C64::ZERO }),
        }
    }

    /// The same under another unbalance.
    pub(super) fn loaded(&self, factor: f64) -> Self {
        Self { forcing: &self.forcing * C64::from(factor), ..self.clone() }
    }

    /// The same for whirl that grows at this rate.
    pub(super) fn growing(&self, growth: f64) -> Self {
        Self { growth, last: RefCell::default(), ..self.clone() }
    }

    /// Dynamic stiffness as the unknowns have it: `Z`, or `h^-1`; not a number where there is none.
    pub(super) fn dynamic_stiffness(&self, frequency: f64) -> DMatrix<C64> {
        let Some(seen) = &self.seen else { return self.whole_stiffness(frequency) };
        self.under(frequency, seen).map_or_else(
            || DMatrix::from_element(seen.len(), seen.len(), C64::from(f64::NAN)),
            |under| under.stiffness.clone(),
        )
    }

    /// What is left of the coordinates that are not unknown, at a frequency; the last is kept, as whoever asks asks several times.
    fn under(&self, frequency: f64, seen: &[usize]) -> Option<Rc<Under>> {
        if let Some((at, under)) = &*self.last.borrow()
            && *at == frequency
        {
            return under.clone();
        }
        let under = Under::of(self.whole_stiffness(frequency), seen).map(Rc::new);
        *self.last.borrow_mut() = Some((frequency, under.clone()));
        under
    }

    /// Every amplitude of the orbit on which the unknowns are `c`.
    pub(super) fn expanded(&self, c: &DVector<C64>, frequency: f64, contact: Contact) -> DVector<C64> {
        let Some(seen) = &self.seen else { return c.clone() };
        let mut forces = self.forcing.clone();
        for k in (0..c.len()).filter(|k| contact >> k & 1 == 1) {
            forces[seen[k]] -= c[k] * self.bearing[k] - direction(c[k]) * self.deadband_force(k);
        }
        let whole = self.under(frequency, seen).and_then(|under| under.lu.solve(&forces));
        whole.unwrap_or_else(|| DVector::from_element(self.order(), C64::from(f64::NAN)))
    }

    /// Dynamic stiffness `Z = K + s C + s^2` with `s = j w`, plus the rate of growth; without the bearings that have
    /// clearance.
    fn whole_stiffness(&self, frequency: f64) -> DMatrix<C64> {
        let s = C64::new(self.growth, frequency);
        let mut z = &self.stiffness + &self.damping * s;
        match &self.mass {
            Some(mass) => z += &mass.matrix * (s * s),
            None => (0..z.nrows()).for_each(|k| z[(k, k)] += s * s),
        }
        if let Some(around) = &self.around {
            for Answer { bearing, sensor, gain, .. } in around.answers(s) {
                z[(bearing, sensor)] -= gain;
            }
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

    /// Shares of the bearings' stiffness in the linear rotor, of every coordinate, in which those with clearance have `factor(k)`.
    fn factors(&self, factor: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut factors = vec![1.0; self.order()];
        for k in (0..self.unknowns()).filter(|k| self.gapped >> k & 1 == 1) {
            factors[self.coordinate(k)] = factor(k);
        }
        factors
    }

    /// State matrix of the linear rotor whose bearings with clearance have `factor(k)` of their stiffness: displacements,
    /// velocities, then whatever the loop holds. `None` with a delay, which no matrix has.
    pub(super) fn state_matrix(&self, factor: impl Fn(usize) -> f64) -> Option<DMatrix<C64>> {
        if let Some(around) = &self.around {
            return around.state_matrix(self.factors(factor));
        }
        let n = self.order();
        let mut a = DMatrix::zeros(2 * n, 2 * n);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, n)).copy_from(&-self.stiffened(0.0, factor));
        a.view_mut((n, n), (n, n)).copy_from(&-&self.damping);
        Some(a)
    }

    /// Poles of the same rotor.
    ///
    /// # Errors
    /// Poles that cannot be had.
    pub(super) fn poles(&self, factor: impl Fn(usize) -> f64) -> Result<Vec<C64>, CircularError> {
        match &self.around {
            Some(around) => Ok(around.poles(self.factors(factor))?),
            None => Ok(self.state_matrix(factor).map_or(Ok(Vec::new()), eigenvalues).map_err(PoleError::from)?),
        }
    }

    /// The loop, if it is more than gains.
    pub(super) fn around(&self) -> Option<&Around> {
        self.around.as_ref()
    }

    /// What multiplies a small disturbance of each coordinate and its conjugate in the bearings: shares of the stiffness, and
    /// accelerations.
    pub(super) fn bearings_about(&self, c: &[C64], contact: Contact) -> (Vec<f64>, Vec<C64>) {
        let half = |k: usize| 0.5 * self.clearance[k] / c[k].norm();
        let presses = |k: usize| contact >> k & 1 == 1;
        let along = self.factors(|k| if presses(k) { 1.0 - half(k) } else { 0.0 });
        let turned = |k: usize| direction(c[k]).powi(2) * (self.bearing[k] * half(k));
        let mut pushes = vec![C64::ZERO; self.order()];
        (0..c.len()).filter(|k| presses(*k)).for_each(|k| pushes[self.coordinate(k)] = turned(k));
        (along, pushes)
    }

    /// Whether nothing drives the whirl.
    pub(super) fn is_balanced(&self) -> bool {
        self.forcing.iter().all(|f| *f == C64::ZERO)
    }

    /// What drives the unknowns: `Re R^2` per mass, or `h^-1 E^T Z^-1 f`; zero for a limit cycle.
    pub(super) fn forcing(&self, frequency: f64) -> DVector<C64> {
        let Some(seen) = &self.seen else { return self.forcing.clone() };
        if self.is_balanced() {
            return DVector::zeros(seen.len());
        }
        let driven = self.under(frequency, seen).and_then(|under| {
            let whole = under.lu.solve(&self.forcing)?;
            Some(&under.stiffness * DVector::from_iterator(seen.len(), seen.iter().map(|k| whole[*k])))
        });
        driven.unwrap_or_else(|| DVector::from_element(seen.len(), C64::from(f64::NAN)))
    }

    /// Restoring force of bearing `k` at the edge of contact extended: `b_k g_k`, what `s` takes away in contact.
    pub(super) fn deadband_force(&self, k: usize) -> f64 {
        self.bearing[k] * self.clearance[k]
    }

    /// Left side minus right side, with `s = 1 - g / r` on the masses in `contact` and 0 on the others, wherever they are.
    pub(super) fn residual(&self, c: &DVector<C64>, frequency: f64, contact: Contact) -> DVector<C64> {
        let mut f = self.dynamic_stiffness(frequency) * c - self.forcing(frequency);
        for k in 0..c.len() {
            if contact >> k & 1 == 1 {
                f[k] += c[k] * self.bearing[k] - direction(c[k]) * self.deadband_force(k);
            }
        }
        f
    }

    /// Size of the terms that cancel in the residual: rounding errors are small against it.
    pub(super) fn scale(&self, c: &DVector<C64>, frequency: f64) -> f64 {
        let biggest = self.dynamic_stiffness(frequency).iter().map(|z| z.norm()).fold(0.0, f64::max);
        let bearing = self.bearing.iter().copied().fold(0.0, f64::max);
        (biggest + bearing) * c.norm() + self.forcing(frequency).norm()
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

    /// Derivative of the residual by the frequency: `j (C + 2 s M) c`.
    pub(super) fn by_frequency(&self, c: &DVector<C64>, frequency: f64) -> DVector<C64> {
        self.by_growth(c, frequency) * J
    }

    /// Derivative of the residual by the rate of growth: `(C + 2 s) c`, or `h^-1 E^T Z^-1 (C + 2 s M) H h^-1 c`.
    pub(super) fn by_growth(&self, c: &DVector<C64>, frequency: f64) -> DVector<C64> {
        let Some(seen) = &self.seen else { return self.by_growth_of_all(c, frequency) };
        let moved = self.under(frequency, seen).and_then(|under| {
            let moved = under.lu.solve(&self.by_growth_of_all(&(&under.whirl * (&under.stiffness * c)), frequency))?;
            Some(&under.stiffness * DVector::from_iterator(seen.len(), seen.iter().map(|k| moved[*k])))
        });
        moved.unwrap_or_else(|| DVector::from_element(seen.len(), C64::from(f64::NAN)))
    }

    /// `dZ/ds c` of all coordinates.
    fn by_growth_of_all(&self, c: &DVector<C64>, frequency: f64) -> DVector<C64> {
        let s = C64::new(self.growth, frequency);
        let inertia = self.mass.as_ref().map_or_else(|| c.clone(), |mass| &mass.matrix * c);
        let mut by = &self.damping * c + inertia * (s * 2.0);
        if let Some(around) = &self.around {
            for Answer { bearing, sensor, slope, .. } in around.answers(s) {
                by[bearing] -= slope * c[sensor];
            }
        }
        by
    }

    /// Stiffness of bearing `k`, `b_k`.
    pub(super) fn bearing_stiffness(&self, k: usize) -> f64 {
        self.bearing[k]
    }

    /// Damping matrix `C` of `p'' + C p' + K p`.
    pub(super) fn damping(&self) -> &DMatrix<C64> {
        &self.damping
    }

    /// The control acceleration of the orbit with all amplitudes `c` at each control bearing, `|u|`, in `w0^2 e_t`.
    pub(super) fn forces(&self, c: &[C64], frequency: f64) -> Vec<f64> {
        if let Some(around) = &self.around {
            let mut forces = vec![C64::ZERO; around.count()];
            for Answer { place, sensor, gain, .. } in around.answers(J * frequency) {
                forces[place] += gain * c[sensor];
            }
            return forces.iter().map(|force| force.norm()).collect();
        }
        let row = &self.control;
        let gains = row.displacement.iter().zip(&row.velocity).map(|(p, v)| p + v * J * frequency);
        vec![gains.zip(c).map(|(gain, c)| gain * c).sum::<C64>().norm()]
    }
}

/// Unit vector along `c`.
fn direction(c: C64) -> C64 {
    let size = c.norm();
    if size > 0.0 { c / size } else { C64::ONE }
}
