//! The spin at successive half steps, some of them at once.
//!
//! Sine and cosine of an angle are dear beside a step of a few masses. Over a stretch of half steps the angle grows by `d`, and `d` by the little
//! `e` from one stretch to the next: on a ramp `e` is the same throughout, on a decay it fades as the rate does. So the direction is
//! multiplied by `exp(j d)`, and that by `exp(j e)`, of which a few terms are enough. Four half steps are worked on side by side.

use rotor::{C64, SpeedStage};

use super::{Grid, SpinLaw};

/// Steps between two evaluations of sine and cosine: rounding grows with it, to 1e-14 or so.
const EVERY: u64 = 64;
/// Half steps worked on side by side.
const LANES: usize = 4;
/// Half steps kept: those of so many steps, both ends counted, in whole lanes.
const KEPT: usize = (2 * EVERY as usize + 1).next_multiple_of(LANES);
/// Below this angle five terms of sine and cosine are exact to the last bit but one.
const SMALL: f64 = 1e-2;

/// The spin over some steps of a grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Turning {
    /// The first of them.
    from: Grid,
    /// How many there are.
    steps: u64,
    stages: [SpeedStage; KEPT],
}

impl Turning {
    /// Over no steps.
    pub(super) fn none() -> Self {
        Self { from: Grid::default(), steps: 0, stages: [SpeedStage::AT_REST; KEPT] }
    }

    /// Forgets what is there: another leg has begun.
    pub(super) fn clear(&mut self) {
        self.steps = 0;
    }

    /// Where the spin at the beginning of a step stands, if it is there.
    #[inline]
    pub(super) fn place(&self, grid: Grid) -> Option<usize> {
        let since = grid.steps.wrapping_sub(self.from.steps);
        let is_there = since < self.steps && self.from.dtau == grid.dtau && self.from.from == grid.from;
        is_there.then(|| 2 * since as usize)
    }

    /// The spin at the beginning, in the middle and at the end of the step whose place this is.
    #[inline]
    pub(super) fn at(&self, place: usize) -> &[SpeedStage; 3] {
        self.stages.get(place..).and_then(<[_]>::first_chunk).unwrap_or(const { &[SpeedStage::AT_REST; 3] })
    }

    /// Makes those of a step and of the steps about it, as far as `law` holds beyond their ends: until `until`. They hang on the law and
    /// the grid alone, not on the step that is asked for.
    pub(super) fn make(&mut self, law: &SpinLaw, grid: Grid, until: f64) {
        // A leg that begins within rounding of a step begins with it.
        let first = ((law.from - grid.from) / grid.dtau - 1e-6).ceil().max(0.0) as u64;
        let begin = (grid.steps - grid.steps % EVERY).max(first).min(grid.steps);
        self.from = Grid { steps: begin, ..grid };
        // The angle is evaluated where EVERY divides the steps, whenever the leg began.
        let ends_within = |steps: &u64| Grid { steps: begin + steps, ..grid }.tau() < until;
        let most = EVERY - begin % EVERY;
        self.steps = if ends_within(&most) { most } else { (1..most).take_while(ends_within).last().unwrap_or(0) };
        let (tau, half) = (self.from.tau(), 0.5 * grid.dtau);
        let direction = C64::cis(law.angle_at(tau));
        if law.decay == 0.0 {
            self.ramp(law, tau, half, direction);
        } else {
            self.decay(law, tau, half, direction);
        }
    }

    fn ramp(&mut self, law: &SpinLaw, tau: f64, half: f64, direction: C64) {
        let (speed, rate) = (law.speed_at(tau), law.acceleration);
        let bend = rate * half * half;
        let mut turns = [C64::cis(speed * half + 0.5 * bend); TURNS];
        let twist = cis(bend);
        for i in 1..TURNS {
            turns[i] = turns[i - 1] * twist;
        }
        let mut lanes = Lanes::begin(direction, &turns);
        let twist = cis((LANES * LANES) as f64 * bend);
        let mut speeds: [f64; LANES] = std::array::from_fn(|i| speed + rate * (half * i as f64));
        let gained = rate * (half * LANES as f64);
        for stages in self.stages.chunks_exact_mut(LANES) {
            lanes.put(&speeds, &[rate; LANES], stages);
            lanes.turn(&[[twist.re; LANES], [twist.im; LANES]]);
            speeds = speeds.map(|speed| speed + gained);
        }
    }

    fn decay(&mut self, law: &SpinLaw, tau: f64, half: f64, direction: C64) {
        // R = asymptote + way left, where left = exp(-decay (tau - from)): the angle grows by asymptote h + way left (1 - exp(-decay h)) / decay.
        let (way, per_decay) = (law.speed - law.asymptote, 1.0 / law.decay);
        let [fades, fade_together] = [half, half * LANES as f64].map(|h| -(-law.decay * h).exp_m1());
        let begins = (-law.decay * (tau - law.from)).exp();
        let bend = -way * fade_together * fade_together * per_decay;
        if (bend * begins).abs() > SMALL {
            // It decays within a few steps: what it costs is nothing beside the rest of a motion.
            for (k, stage) in self.stages.iter_mut().enumerate() {
                *stage = law.spin_at(tau + k as f64 * half).into();
            }
            return;
        }
        let (mut left, mut kept) = ([begins; LANES], begins);
        let mut turns = [C64::cis(law.asymptote * half + way * begins * fades * per_decay); TURNS];
        for i in 1..TURNS {
            turns[i] = turns[i - 1] * cis(-way * fades * fades * per_decay * kept);
            kept *= 1.0 - fades;
            if let Some(left) = left.get_mut(i) {
                *left = kept;
            }
        }
        let mut lanes = Lanes::begin(direction, &turns);
        for stages in self.stages.chunks_exact_mut(LANES) {
            let speeds = left.map(|left| law.asymptote + way * left);
            lanes.put(&speeds, &left.map(|left| law.acceleration * left), stages);
            let twists = left.map(|left| few_terms(bend * left));
            lanes.turn(&[twists.map(|twist| twist.re), twists.map(|twist| twist.im)]);
            left = left.map(|left| left * (1.0 - fade_together));
        }
    }
}

/// Turns over single half steps that make those of the first lanes.
const TURNS: usize = 2 * LANES - 1;

/// The direction at [`LANES`] half steps in a row, and by what each is turned to be that of as many half steps later: real and
/// imaginary parts apart, so that the compiler works on several at once.
struct Lanes {
    direction: [[f64; LANES]; 2],
    turn: [[f64; LANES]; 2],
}

impl Lanes {
    /// From a direction on, with the turns over the half steps that follow.
    fn begin(direction: C64, turns: &[C64; TURNS]) -> Self {
        let mut made = Self { direction: [[0.0; LANES]; 2], turn: [[0.0; LANES]; 2] };
        let mut now = direction;
        for i in 0..LANES {
            let turn: C64 = turns[i..i + LANES].iter().product();
            [made.direction[0][i], made.direction[1][i]] = [now.re, now.im];
            [made.turn[0][i], made.turn[1][i]] = [turn.re, turn.im];
            now *= turns[i];
        }
        made
    }

    /// Writes down what drives the unbalance here.
    #[inline]
    fn put(&self, speeds: &[f64; LANES], rates: &[f64; LANES], stages: &mut [SpeedStage]) {
        let squares = speeds.map(|speed| speed * speed);
        let [re, im] = times(&self.direction, &[squares, rates.map(|rate| -rate)]);
        for (i, stage) in stages.iter_mut().enumerate() {
            *stage = SpeedStage { speed: speeds[i], unbalance: C64::new(re[i], im[i]) };
        }
    }

    /// Goes on by [`LANES`] half steps, after which turns are `twist` times as they were.
    #[inline]
    fn turn(&mut self, twist: &[[f64; LANES]; 2]) {
        self.direction = times(&self.direction, &self.turn);
        self.turn = times(&self.turn, twist);
    }
}

/// Complex products, one by one.
#[inline]
fn times([a, b]: &[[f64; LANES]; 2], [c, d]: &[[f64; LANES]; 2]) -> [[f64; LANES]; 2] {
    [std::array::from_fn(|i| a[i] * c[i] - b[i] * d[i]), std::array::from_fn(|i| a[i] * d[i] + b[i] * c[i])]
}

/// `exp(j angle)`.
fn cis(angle: f64) -> C64 {
    if angle.abs() > SMALL { C64::cis(angle) } else { few_terms(angle) }
}

/// `exp(j angle)` of an angle up to [`SMALL`].
#[inline]
fn few_terms(angle: f64) -> C64 {
    let square = angle * angle;
    C64::new(1.0 - square * (0.5 - square / 24.0), angle * (1.0 - square * (1.0 / 6.0 - square / 120.0)))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rotor::profile::Leg;

    use super::*;
    use crate::motion::Motion;

    fn legs() -> impl Strategy<Value = Leg> {
        prop_oneof![
            (0.0..6.0f64, 1e-4..10.0f64).prop_map(|(speed, rate)| Leg::To { speed, rate }),
            (0.0..6.0f64, 1e-4..10.0f64).prop_map(|(speed, rate)| Leg::Decay { speed, rate }),
            (0.1..9.0f64).prop_map(|duration| Leg::Dwell { duration }),
        ]
    }

    proptest! {
        /// It is the spin of the leg's own equation, wherever on a grid the leg began, and taken up at any step to the last bit.
        #[test]
        fn worked_out_together_it_is_the_leg_s_own_spin(
            leg in legs(),
            speed in 0.0..6.0f64,
            steps in 0..200u64,
            dtau in 1e-3..0.05f64,
        ) {
            let mut motion = Motion::steady(speed);
            let mut grid = Grid { from: 3.0, steps, dtau };
            motion.follow(grid.tau(), &[leg]);
            while grid.steps < steps + 100 && grid.tau() + dtau < motion.until() {
                let Some(stages) = motion.stages_over(grid).copied() else { break };
                for (stage, share) in stages.iter().zip([0.0, 0.5, 1.0]) {
                    let expected = SpeedStage::from(motion.spin_at(grid.tau() + share * dtau));
                    let off = (stage.unbalance - expected.unbalance).norm().max((stage.speed - expected.speed).abs());
                    prop_assert!(off < 2e-12 * (1.0 + expected.unbalance.norm()), "{stage:?} {expected:?}");
                }
                let mut other = motion.clone();
                other.turning.clear();
                prop_assert_eq!(other.stages_over(grid), Some(&stages));
                grid.steps += 1;
            }
        }
    }
}
