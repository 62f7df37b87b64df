//! The steady control force of the linear rotor under its unbalance, exact, with its slope in each gain.
//!
//! Synchronous whirl `p = c exp(j R tau)` solves `Q0(j R) c = Re R^2 + sum_b column_b u_b` with the loop open, and the loops answer
//! `u = sum_k g_k e_b(k) U_k c`, where `U_k` is what gain `k` alone, being 1, answers at its bearing `b(k)`. With `Q0 c0 = Re R^2` and
//! `Q0 d_b = column_b`, and `alpha_k = U_k c0`, `beta_kb = U_k d_b`,
//!
//! ```text
//! (I - B) u = a,   a = sum_k g_k e_b(k) alpha_k,   B = sum_k g_k e_b(k) beta_k^T,   du / dg_k = (I - B)^-1 e_b(k) (alpha_k + beta_k u)
//! ```
//!
//! Of several bearings the largest force counts, as that of the first ([`rotor::ControlMasses`]). Of a sampled loop it is the fundamental of the held force.

use nalgebra::{DMatrix, DVector};
use rotor::C64;

use crate::Problem;
use crate::answers::Answers;
use crate::corners::Weights;

/// What the force at one condition is made from, control off.
#[derive(Clone, Debug)]
pub(crate) struct Synchronous {
    /// What each gain answers to whirl under the unbalance.
    alpha: Vec<C64>,
    /// What it answers to whirl under a unit of control at each bearing, gain by gain.
    beta: Vec<C64>,
    bearing_of: Vec<usize>,
    /// What the control of each bearing is worth in control of the first.
    worth: Vec<f64>,
    speed: f64,
}

impl Synchronous {
    /// At a condition of `problem`.
    pub(crate) fn new(problem: &Problem, point: &[f64]) -> Self {
        let (speed, bearing_of) = (point[0], problem.structure.bearing_of_gains());
        let gains = bearing_of.len();
        let Some(answers) = Answers::at(problem, point) else {
            let none = vec![C64::ZERO; gains];
            return Self { alpha: none.clone(), beta: none, bearing_of, worth: vec![1.0], speed };
        };
        let mut whirls = vec![answers.whirl_under(C64::new(0.0, speed), &problem.family.unbalance(point))];
        whirls.extend(answers.whirls(C64::new(0.0, speed)));
        // An integrator at rest holds whatever there is: without spin there is no force to hold.
        let force = |z: &C64| if z.is_finite() { -z } else { C64::ZERO };
        let mut by_whirl = answers.to(problem, speed, &whirls).into_iter();
        let alpha = by_whirl.next().unwrap_or_default().iter().map(force).collect();
        let by_bearing: Vec<Vec<C64>> = by_whirl.collect();
        let beta = (0..gains).flat_map(|k| by_bearing.iter().map(move |of| force(&of[k]))).collect();
        let mass = |place| problem.family.rotor().control_mass(place);
        let worth = problem.structure.bearings().map(|place| mass(place) / mass(problem.structure.bearing())).collect();
        Self { alpha, beta, bearing_of, worth, speed }
    }

    /// `|u|` for gains `variables`, and its slope in each of them if there is room for it in `slope`.
    pub(crate) fn force(&self, problem: &Problem, variables: &[f64], slope: &mut [f64]) -> f64 {
        let (weights, m) = (Weights::of(&problem.structure, variables, self.speed), self.worth.len());
        let s = C64::new(0.0, self.speed);
        let (mut around, mut driven) = (DMatrix::<C64>::identity(m, m), DVector::<C64>::zeros(m));
        for (k, weight) in weights.at(s).iter().enumerate().filter(|(_, weight)| weight.is_finite()) {
            let at = self.bearing_of[k];
            driven[at] += self.alpha[k] * weight;
            (0..m).for_each(|b| around[(at, b)] -= self.beta[k * m + b] * weight);
        }
        let Some(inverse) = around.try_inverse() else {
            slope.fill(0.0);
            return f64::INFINITY;
        };
        let forces = &inverse * driven;
        let size_of = |b: usize| forces[b].norm() * self.worth[b];
        let largest = (0..m).fold(0, |most, b| if size_of(b) > size_of(most) { b } else { most });
        let size = size_of(largest);
        if !slope.is_empty() {
            // At no force at all there is no direction in which it grows.
            let worth = self.worth[largest];
            let toward = if size > 0.0 { forces[largest].conj() * (worth * worth / size) } else { C64::ZERO };
            let by_weight: Vec<C64> = (0..self.alpha.len())
                .map(|k| {
                    let back: C64 = (0..m).map(|b| self.beta[k * m + b] * forces[b]).sum();
                    toward * inverse[(largest, self.bearing_of[k])] * (self.alpha[k] + back)
                })
                .collect();
            let along = |z: C64| if z.is_finite() { z.re } else { 0.0 };
            let by: Vec<f64> = weights.chain(s, &by_weight).into_iter().map(along).collect();
            problem.structure.spread(self.speed, &by, 0.0, slope);
        }
        size
    }
}
