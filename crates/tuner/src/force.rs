//! The steady control force of the linear rotor under its unbalance, exact, with its slope in each gain.
//!
//! Synchronous whirl `p = c exp(j R tau)` solves `Q0(j R) c = Re R^2 + e_b u` with the loop open, and the loop answers `u = H c`,
//! where `H = sum g_k U_k`: what gain `k` alone, being 1, answers. With `Q0 c0 = Re R^2` and `Q0 d = e_b`, and
//! `alpha_k = U_k c0`, `beta_k = U_k d`,
//!
//! ```text
//! u = alpha g / (1 - beta g),      du / dg_k = (alpha_k + beta_k u) / (1 - beta g)
//! ```
//!
//! Of a sampled loop it is the fundamental of the held force.

use control::LinearLoop;
use rotor::C64;

use crate::Problem;

/// What the force at one condition is made from, control off.
#[derive(Clone, Debug)]
pub(crate) struct Synchronous {
    /// What each gain answers to whirl under the unbalance.
    alpha: Vec<C64>,
    /// What it answers to whirl under a unit of control.
    beta: Vec<C64>,
    speed: f64,
}

impl Synchronous {
    /// At a condition of `problem`.
    pub(crate) fn new(problem: &Problem, point: &[f64]) -> Self {
        let (structure, speed) = (&problem.structure, point[0]);
        let (open, unbalance) = (problem.family.open(point), problem.family.unbalance(point));
        let s = C64::new(0.0, speed);
        let mut free: Vec<C64> = unbalance.iter().map(|&u| C64::from(u)).collect();
        open.respond(s, &mut free);
        let mut per_force = vec![C64::ZERO; unbalance.len()];
        per_force[structure.bearing()] = C64::ONE;
        open.respond(s, &mut per_force);
        let delay = problem.delay(point);
        if !structure.has_loop() {
            // Gains alone, late.
            let late = -C64::cis(-speed * delay);
            let of = |whirl: &[C64]| structure.gain_sensitivities(whirl, s).into_iter().map(|x| x * late).collect();
            return Self { alpha: of(&free), beta: of(&per_force), speed };
        }
        let (alpha, beta) = (0..structure.gains())
            .map(|k| {
                let around = LinearLoop::new(&structure.unit(Some(k), delay), structure.masses(), speed).ok();
                let Some((around, answer)) = around.and_then(|a| a.fundamental(speed).map(|answer| (a, answer))) else {
                    return (C64::ZERO, C64::ZERO);
                };
                let of = |whirl: &[C64]| around.sensors.iter().zip(&answer).map(|(at, h)| h * whirl[*at]).sum::<C64>();
                (of(&free), of(&per_force))
            })
            .unzip();
        Self { alpha, beta, speed }
    }

    /// `|u|` for gains `variables`, and its slope in each of them if there is room for it in `slope`.
    pub(crate) fn force(&self, problem: &Problem, variables: &[f64], slope: &mut [f64]) -> f64 {
        let gains = problem.structure.gains_at(variables, self.speed);
        let sum = |of: &[C64]| of.iter().zip(&gains).map(|(of, gain)| of * gain).sum::<C64>();
        let loop_gain = C64::ONE - sum(&self.beta);
        let force = sum(&self.alpha) / loop_gain;
        let size = force.norm();
        if !slope.is_empty() {
            // At no force at all there is no direction in which it grows.
            let toward = if size > 0.0 { force.conj() / size } else { C64::ZERO };
            let by_gain: Vec<f64> =
                self.alpha.iter().zip(&self.beta).map(|(a, b)| (toward * (a + b * force) / loop_gain).re).collect();
            problem.structure.spread(self.speed, &by_gain, 0.0, slope);
        }
        size
    }
}
