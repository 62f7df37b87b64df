//! Many trajectories at once: steps of chains under ideal loops at steady speeds, one trajectory in each lane of the processor's registers.
//!
//! The method is that of the [`crate::stepper`] of one trajectory, and so are the numbers, to the last bit: a lane does what that does, in
//! the same order. How many lanes there are (8 with AVX-512, 4 with AVX2, 1 with neither) is found out when the program runs and changes no
//! number. What is kept of a motion, the largest force and radii and the sums of radii, is kept in the same pass.

mod extremes;
mod kernel;
mod rows;
mod vector;

use pulp::Arch;

use crate::stepper::TURNS_BETWEEN;
use crate::{C64, ClosedLoop, MAX_MASSES};
use kernel::{Block, Terms};
use rows::{KEPT, Rows};

/// Trajectories start at samples whose number is a multiple of this: where the unbalance is put on its angle anew.
pub const BETWEEN_STARTS: usize = TURNS_BETWEEN as usize;

/// What was kept of a lane's samples since it was asked for last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Largest `|u|^2`, then `|p|^2` of every mass; between samples too ([`crate::Peaks`]).
    pub maxima: [f64; 1 + MAX_MASSES],
    /// Sum of `|p|` over the samples, per mass.
    pub radius_sums: [f64; MAX_MASSES],
}

#[derive(Clone, Copy, Debug)]
struct Lane {
    speed: f64,
    dtau: f64,
    /// The number of its first sample.
    from: usize,
}

/// Trajectories side by side, of rotors that have as many masses.
#[derive(Clone, Debug)]
pub struct Batch {
    arch: Arch,
    rows: Rows,
    terms: Vec<Terms>,
    lanes: Vec<Option<Lane>>,
    /// The number of the next sample.
    sample: usize,
}

impl Batch {
    /// A batch for rotors of so many masses, as wide as the processor's registers.
    #[must_use]
    pub fn new(masses: usize) -> Self {
        Self::on(Arch::new(), masses)
    }

    /// The same with at most so many lanes: 8, 4 or 1 on x86.
    #[must_use]
    pub fn narrow(masses: usize, lanes: usize) -> Self {
        let widest = Self::new(masses);
        if widest.lanes() <= lanes {
            return widest;
        }
        #[cfg(target_arch = "x86_64")]
        if lanes >= 4
            && let Some(simd) = pulp::x86::V3::try_new()
        {
            return Self::on(Arch::V3(simd), masses);
        }
        Self::on(Arch::Scalar, masses)
    }

    fn on(arch: Arch, masses: usize) -> Self {
        struct Width;
        impl pulp::WithSimd for Width {
            type Output = usize;
            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) -> usize {
                S::F64_LANES
            }
        }
        let width = arch.dispatch(Width);
        Self {
            arch,
            rows: Rows::new(masses, width),
            terms: vec![Terms::default(); masses],
            lanes: vec![None; width],
            sample: 0,
        }
    }

    /// How many trajectories there can be at once.
    #[must_use]
    pub fn lanes(&self) -> usize {
        self.lanes.len()
    }

    /// How many samples are to be taken before a trajectory can start.
    #[must_use]
    pub fn until_start(&self) -> usize {
        self.sample.next_multiple_of(BETWEEN_STARTS) - self.sample
    }

    /// Starts a trajectory in a lane, at `tau` = 0 and angle 0, in steps of `dtau`, where [`Batch::until_start`] is 0. `start` is the
    /// displacement and velocity of every mass (missing ones are at rest in the centre); a radius above `limit` is not bounded.
    ///
    /// # Panics
    /// A lane that is none, another number of masses, or a start between two that can be.
    pub fn start(&mut self, lane: usize, of: &ClosedLoop, start: [&[C64]; 2], dtau: f64, limit: f64) {
        assert!(of.masses == self.rows.masses && self.until_start() == 0, "no such start");
        self.stop(lane);
        let at = of.control.bearing.min(of.masses - 1);
        let rows = &mut self.rows;
        for i in 0..of.masses {
            let mut set = |row: usize, number: f64| rows.set(Rows::mass(i, row), lane, number);
            let mut both = |pair: [usize; 2], number: C64| {
                set(pair[0], number.re);
                set(pair[1], number.im);
            };
            both(rows::DAMPING, of.damping[i]);
            both(rows::STIFFNESS, of.stiffness[i] - of.bearing[i]);
            both(rows::GAIN_P, of.control.displacement[i]);
            both(rows::GAIN_V, of.control.velocity[i]);
            both(rows::P, start[0].get(i).copied().unwrap_or_default());
            both(rows::V, start[1].get(i).copied().unwrap_or_default());
            let deadband_force = of.bearing[i] * of.deadband[i];
            set(rows::LEFT, of.left[i]);
            set(rows::RIGHT, of.right[i]);
            set(rows::INSIDE, if deadband_force > 0.0 { of.bearing[i] } else { 0.0 });
            set(rows::DEADBAND_FORCE, deadband_force);
            set(rows::EDGE_SQUARED, of.deadband[i] * of.deadband[i]);
            set(rows::UNBALANCE, of.unbalance[i]);
            set(rows::CONTROLLED, if i == at { 1.0 } else { 0.0 });
        }
        let half_turn = C64::cis(of.speed * (0.5 * dtau));
        for (row, number) in [
            (rows::DTAU, dtau),
            (rows::HALF_TURN[0], half_turn.re),
            (rows::HALF_TURN[1], half_turn.im),
            (rows::LIMIT_SQUARED, limit * limit),
        ] {
            rows.set(rows.common(row), lane, number);
        }
        self.break_off(lane);
        self.lanes[lane] = Some(Lane { speed: of.speed, dtau, from: self.sample });
        self.note_terms();
    }

    /// Ends what is in a lane: from here on it is at rest.
    pub fn stop(&mut self, lane: usize) {
        let (width, rows) = (self.rows.width, &mut self.rows);
        rows.all_mut().iter_mut().skip(lane).step_by(width).for_each(|number| *number = 0.0);
        // What rests is bounded, and steps of some length keep it so.
        self.lanes[lane] = None;
        self.note_terms();
    }

    /// Forgets the last samples of a lane: its signals jump here.
    pub fn break_off(&mut self, lane: usize) {
        let signals = self.rows.masses + 1;
        for number in 0..KEPT {
            let row = self.rows.sample(number);
            (0..signals).for_each(|signal| self.rows.set(row + signal, lane, f64::NAN));
        }
    }

    fn note_terms(&mut self) {
        let rows = &self.rows;
        for (i, terms) in self.terms.iter_mut().enumerate() {
            let used = |of: &[usize]| of.iter().any(|row| rows.is_used(i, *row));
            *terms = Terms {
                seal: used(&rows::DAMPING) || used(&[rows::STIFFNESS[1]]),
                clearance: used(&[rows::DEADBAND_FORCE]),
                unbalance: used(&[rows::UNBALANCE]),
                gain: used(&rows::GAIN_P) || used(&rows::GAIN_V),
                controlled: used(&[rows::CONTROLLED]),
            };
        }
    }

    /// Takes `samples` samples with a step after each, or fewer: those before one that is not bounded in some lane, which is to be
    /// stopped then ([`Batch::is_bounded`]). Returns how many.
    pub fn run(&mut self, samples: usize) -> usize {
        let mut taken = 0;
        while taken < samples {
            if self.until_start() == 0 {
                self.turn();
            }
            let wanted = (samples - taken).min(BETWEEN_STARTS - self.sample % BETWEEN_STARTS);
            let ran = self.block(wanted);
            self.sample += ran;
            taken += ran;
            if ran < wanted {
                break;
            }
        }
        taken
    }

    /// Puts the unbalance of every lane on its angle.
    fn turn(&mut self) {
        for (k, lane) in self.lanes.iter().enumerate() {
            let Some(lane) = lane else { continue };
            let phasor = C64::cis(lane.speed * ((self.sample - lane.from) as f64 * lane.dtau));
            self.rows.set(self.rows.common(rows::PHASOR[0]), k, phasor.re);
            self.rows.set(self.rows.common(rows::PHASOR[1]), k, phasor.im);
        }
    }

    fn block(&mut self, samples: usize) -> usize {
        let Self { arch, rows, terms, sample, .. } = self;
        macro_rules! of_size {
            ($($n:literal)+) => {
                match rows.masses {
                    $($n => arch.dispatch(Block::<'_, $n> { rows, terms, sample: *sample, samples }),)+
                    _ => arch.dispatch(Block::<'_, MAX_MASSES> { rows, terms, sample: *sample, samples }),
                }
            };
        }
        of_size!(1 2 3 4)
    }

    /// Whether the next sample of a lane is bounded: every radius within its limit, and the force finite.
    #[must_use]
    pub fn is_bounded(&self, lane: usize) -> bool {
        let of = |i: usize, [y, z]: [usize; 2]| {
            C64::new(self.rows.get(Rows::mass(i, y), lane), self.rows.get(Rows::mass(i, z), lane))
        };
        let limit = self.rows.get(self.rows.common(rows::LIMIT_SQUARED), lane);
        let mut parts = [C64::ZERO; 2];
        for i in 0..self.rows.masses {
            let (p, v) = (of(i, rows::P), of(i, rows::V));
            if p.norm_sqr().is_nan() || p.norm_sqr() > limit {
                return false;
            }
            parts[i % 2] += of(i, rows::GAIN_P) * p + of(i, rows::GAIN_V) * v;
        }
        (parts[0] + parts[1]).norm_sqr().is_finite()
    }

    /// What was kept of a lane; from here on it is kept anew.
    pub fn take(&mut self, lane: usize) -> Extremes {
        let mut extremes = Extremes { maxima: [0.0; 1 + MAX_MASSES], radius_sums: [0.0; MAX_MASSES] };
        let masses = self.rows.masses;
        let signals = (0..=masses).zip(&mut extremes.maxima).map(|(k, to)| (self.rows.maximum(k), to));
        let sums = (0..masses).zip(&mut extremes.radius_sums).map(|(i, to)| (Rows::mass(i, rows::RADIUS_SUM), to));
        let all: Vec<(usize, &mut f64)> = signals.chain(sums).collect();
        for (row, to) in all {
            *to = self.rows.get(row, lane);
            self.rows.set(row, lane, 0.0);
        }
        extremes
    }

    /// Displacement and velocity of every mass at the last sample of a lane.
    #[must_use]
    pub fn last(&self, lane: usize) -> [Vec<C64>; 2] {
        let of = |y: usize, z: usize| {
            let get = |i: usize, row: usize| self.rows.get(Rows::mass(i, rows::BEFORE[row]), lane);
            (0..self.rows.masses).map(|i| C64::new(get(i, y), get(i, z))).collect()
        };
        [of(0, 1), of(2, 3)]
    }
}
