//! What a controller is put together from: rows of the law, filters in a row, noise.

use crate::block::Sampled;
use crate::{C64, Gain, Signal};

/// One row of the law: weights of what the sensors read, the gains on it, and what shapes it.
#[derive(Clone, Debug)]
pub(super) struct LawRow {
    pub(super) displacement: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    pub(super) gains: [Gain; 4],
    /// `kd - j kc` and `cd - j cc` at the speed of the moment.
    pub(super) now: [C64; 2],
    pub(super) filters: Chain,
}

/// Filters in a row, with the place of their states.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub(super) blocks: Vec<Sampled>,
    pub(super) first: usize,
}

/// Draws noise: the same seed, the same noise.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    pub(super) deviation: f64,
    pub(super) random: fastrand::Rng,
    pub(super) displacement: Vec<C64>,
    pub(super) velocity: Vec<C64>,
}

impl Noise {
    pub(super) fn draw(&mut self) {
        for place in self.displacement.iter_mut().chain(&mut self.velocity) {
            // Box and Muller: two independent normal numbers at once.
            let radius = (-2.0 * (1.0 - self.random.f64()).ln()).sqrt();
            *place = C64::from_polar(self.deviation * radius, std::f64::consts::TAU * self.random.f64());
        }
    }
}

impl LawRow {
    pub(super) fn new(signal: &Signal, sensors: &[usize], filters: Chain) -> Self {
        let picked =
            |weights: &[f64]| sensors.iter().map(|station| weights.get(*station).copied().unwrap_or(0.0)).collect();
        Self {
            displacement: picked(&signal.displacement),
            velocity: picked(&signal.velocity),
            gains: signal.gains.clone(),
            now: [C64::ZERO; 2],
            filters,
        }
    }

    pub(super) fn is_scheduled(&self) -> bool {
        !self.gains.iter().all(|gain| matches!(gain, Gain::Constant(_)))
    }

    /// `(kd - j kc) sum of displacements + (cd - j cc) sum of velocities`.
    #[inline]
    pub(super) fn of(&self, [displacement, velocity]: &[Vec<C64>; 2]) -> C64 {
        let on = |weights: &[f64], readings: &[C64]| -> C64 { weights.iter().zip(readings).map(|(w, r)| r * *w).sum() };
        self.now[0] * on(&self.displacement, displacement) + self.now[1] * on(&self.velocity, velocity)
    }
}

impl Chain {
    pub(super) fn follows_speed(&self) -> bool {
        self.blocks.iter().any(|block| block.block.follows_speed)
    }
}
