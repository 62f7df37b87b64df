//! The loops opened at the control bearings' commands at one condition: how near they come to -1, and what delay more they bear,
//! with the slope of both in each gain.
//!
//! The gain of the loop is linear in the gains of the feedback, `L(j w) = sum_k g_k e_b(k) a_k(j w)^T`, where `a_k` is what gain `k`
//! alone, being 1, sends back to its bearing `b(k)` of a unit of command at each bearing. Bearing `b`, opened with the others closed,
//! has the loop `L_b` and the distance
//!
//! ```text
//! S = (I + L)^-1,   L_b = 1 / S_bb - 1,   |1 + L_b|,   dS_bb / dg_k = -S_b,b(k) (a_k^T S)_b,   dL_b = -dS_bb / S_bb^2
//! ```
//!
//! whose slope is that of its minimum over frequency too, because there it does not change with `w`. A delay `T` in all commands at
//! once turns a locus, an eigenvalue `l` of `L`, onto -1 where `|l(j w)| = 1` and `w T = pi + arg l`; the crossing moves with the gains
//! so that `|l|` stays 1, and `dl = y dL x / (y x)` with its two vectors. Of one bearing both loops are `L` itself.
//!
//! Distances are what is asked for, not peaks: `|1 + L|` goes to 0 where the machine goes unstable, and `|S|` to infinity.

mod margins;
mod slope;

use linear::{borne, loci, unit_loci};
use nalgebra::DMatrix;
use rotor::C64;

use crate::Problem;
use crate::answers::Answers;
use crate::corners::Weights;
use crate::loci::{minimum, nearest, opened};

pub use margins::LoopMargins;
pub(crate) use margins::margins_at;

/// Frequencies looked at on each side of 0 before the search between them.
const GRID: usize = 80;
/// Decades over which they are spread.
const DECADES: f64 = 3.0;
/// The same with shaft elements, whose fastest pole is far above what matters.
const GRID_OF_SHAFTS: usize = 110;
const DECADES_OF_SHAFTS: f64 = 5.0;
/// The band ends at so many times the fastest pole of the open loop, or of the largest gains.
const BAND: f64 = 4.0;
/// Gains of the loop this little below 1 may soon cross it.
const NEARLY: f64 = 0.8;
/// Points about a pole, in its distances from the axis, ...
const ABOUT: [f64; 4] = [0.0, 0.3, 1.0, 2.0];
/// ... and from the last of them on each so many times as far out, ...
const FARTHER: f64 = 4.0;
/// ... up to this part of its frequency, where the others are as near.
const OUT: f64 = 0.1;
/// What has so many times what is asked for is far from falling short.
const FAR: f64 = 1.6;

/// What is asked of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ask {
    /// `|1 + L|` over its least allowed, at a minimum.
    Distance,
    /// The delay that a crossing bears over the least allowed.
    Delay,
    /// 1 over `|L|`, at a maximum below 1 that would bear too little delay if it crossed.
    Gain,
}

/// One place where a loop may fall short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) ask: Ask,
    /// The bearing opened, of a distance; 0 of a locus.
    pub(crate) bearing: usize,
    /// In radians per `tau`, forward positive.
    pub(crate) frequency: f64,
    /// What the loop is there.
    gain: C64,
    /// What there is over what is asked, less 1: not to be negative.
    pub(crate) in_hand: f64,
}

/// The loops at one condition.
#[derive(Clone, Debug)]
pub(crate) struct Opened {
    open: Answers,
    speed: f64,
    grid: Vec<f64>,
    /// `a_k` at every frequency of the grid, gain by gain.
    answers: Vec<C64>,
}

impl Opened {
    /// At a condition of `problem`; `None` if nothing of the kind is asked for.
    pub(crate) fn at(problem: &Problem, point: &[f64]) -> Option<Self> {
        if !problem.asks_margins() {
            return None;
        }
        let structure = &problem.structure;
        let open = Answers::at(problem, point)?;
        let poles = open.poles();
        let fastest = poles.iter().map(|pole| pole.norm()).fold(1.0, f64::max);
        let (points, decades, end) = if structure.is_chain() {
            (GRID, DECADES, BAND * fastest.max(problem.bound * (structure.gains() as f64 / 4.0).sqrt()))
        } else {
            (GRID_OF_SHAFTS, DECADES_OF_SHAFTS, BAND * fastest)
        };
        let mut grid = vec![0.0];
        for k in 0..points {
            let w = end * 10.0_f64.powf(-decades * k as f64 / (points - 1) as f64);
            grid.extend([w, -w]);
        }
        // Where the open loop resonates the gain changes fastest, and the flank of a resonance may be 1 anywhere on it.
        poles.iter().for_each(|pole| grid.extend(about(*pole)));
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        let own = structure.own();
        let law = Weights::of(structure, &own, point[0]);
        let mut made = Self { open, speed: point[0], answers: Vec::new(), grid: Vec::new() };
        for w in grid {
            let answer = made.answer(problem, w);
            // An integrator has no answer at rest.
            if answer.iter().chain(law.at(C64::new(0.0, w)).iter()).all(|z| z.is_finite()) {
                made.grid.push(w);
                made.answers.extend(answer);
            }
        }
        Some(made)
    }

    /// `a_k` at a frequency, gain by gain.
    fn answer(&self, problem: &Problem, frequency: f64) -> Vec<C64> {
        self.open.loops(problem, frequency)
    }

    /// `L` of answers under this law.
    fn sum(&self, answer: &[C64], law: &Weights<'_>, frequency: f64) -> DMatrix<C64> {
        let m = self.open.count();
        let mut made = DMatrix::zeros(m, m);
        let weights = law.at(C64::new(0.0, frequency));
        for ((own, weight), at) in answer.chunks_exact(m).zip(weights.iter()).zip(&self.open.bearing_of) {
            own.iter().enumerate().for_each(|(b, own)| made[(*at, b)] += own * weight);
        }
        made
    }

    fn gain(&self, problem: &Problem, law: &Weights<'_>, frequency: f64) -> DMatrix<C64> {
        self.sum(&self.answer(problem, frequency), law, frequency)
    }

    /// Of `loci` at a frequency, the one nearest to `to`.
    fn locus(&self, problem: &Problem, law: &Weights<'_>, frequency: f64, to: C64) -> C64 {
        nearest(&loci(&self.gain(problem, law, frequency)), to)
    }

    /// Every place at which the loop with these variables has so little of what is asked for that it matters to a search, `near` being its
    /// poles, about which it may be near -1.
    pub(crate) fn places(&self, problem: &Problem, variables: &[f64], near: &[C64]) -> Vec<Place> {
        let law = Weights::of(&problem.structure, variables, self.speed);
        let many = law.gains.len() * self.open.count();
        let mut curve: Vec<(f64, DMatrix<C64>)> = self
            .grid
            .iter()
            .zip(self.answers.chunks(many))
            .map(|(w, answer)| (*w, self.sum(answer, &law, *w)))
            .collect();
        let frequencies = near.iter().flat_map(|pole| [-1.0, 0.0, 1.0].map(|part| pole.im + part * pole.re));
        let looked = frequencies.map(|w| (w, self.gain(problem, &law, w)));
        curve.extend(looked.filter(|(_, gain)| gain.iter().all(|z| z.is_finite())));
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        curve.dedup_by(|a, b| a.0 == b.0);
        let mut places = Vec::new();
        if let Some(limit) = problem.max_sensitivity.filter(|limit| limit.is_finite()) {
            for bearing in 0..self.open.count() {
                let distances: Vec<(f64, f64)> =
                    curve.iter().map(|(w, gain)| (*w, (C64::ONE + opened(gain, bearing)).norm())).collect();
                for p in distances.windows(3) {
                    let [a, b, c] = [0, 1, 2].map(|k| p[k].1);
                    // The minimum is below the least of the three, by less than half of what they differ by.
                    if b <= a && b < c && (b - 0.5 * (a.max(c) - b)) * limit < FAR {
                        let distance = |w: f64| (C64::ONE + opened(&self.gain(problem, &law, w), bearing)).norm();
                        let at = minimum(p[0].0, p[2].0, distance);
                        let gain = opened(&self.gain(problem, &law, at), bearing);
                        places.push(self.place(problem, Ask::Distance, bearing, (at, gain)));
                    }
                }
            }
        }
        if let Some(asked) = problem.min_delay {
            let loci_at: Vec<(f64, Vec<C64>)> = curve.iter().map(|(w, gain)| (*w, loci(gain))).collect();
            let of = |w: f64| loci(&self.gain(problem, &law, w));
            for locus in unit_loci(&loci_at, &of, NEARLY) {
                let ask = if locus.crosses { Ask::Delay } else { Ask::Gain };
                if locus.crosses || borne(locus.gain, locus.frequency) < asked {
                    places.push(self.place(problem, ask, 0, (locus.frequency, locus.gain)));
                }
            }
        }
        places.retain(|place| place.in_hand + 1.0 < FAR);
        places
    }

    fn place(&self, problem: &Problem, ask: Ask, bearing: usize, (frequency, gain): (f64, C64)) -> Place {
        let in_hand = match ask {
            Ask::Distance => (C64::ONE + gain).norm() * problem.max_sensitivity.unwrap_or(1.0) - 1.0,
            Ask::Delay => borne(gain, frequency) / problem.min_delay.unwrap_or(1.0) - 1.0,
            Ask::Gain => 1.0 / gain.norm() - 1.0,
        };
        Place { ask, bearing, frequency, gain, in_hand }
    }
}

/// Frequencies about a pole.
fn about(pole: C64) -> impl Iterator<Item = f64> {
    let width = pole.re.abs();
    let last = ABOUT[ABOUT.len() - 1];
    let farther = std::iter::successors(Some(FARTHER * last), |part| Some(FARTHER * part));
    let parts = ABOUT.into_iter().chain(farther.take_while(move |part| part * width < OUT * pole.norm()));
    let is_apart = width > 0.0;
    parts
        .take_while(move |part| is_apart || *part == 0.0)
        .flat_map(move |part| [pole.im - part * width, pole.im + part * width])
}
