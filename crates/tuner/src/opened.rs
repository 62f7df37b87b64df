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

use std::convert::Infallible;
use std::f64::consts::TAU;

use linear::{eigenvalues_in_place, least};
use nalgebra::DMatrix;
use rotor::C64;

use crate::Problem;
use crate::answers::Answers;

/// Frequencies looked at on each side of 0 before the search between them.
const GRID: usize = 80;
/// Decades over which they are spread.
const DECADES: f64 = 3.0;
/// The same with shaft elements, whose fastest pole is far above what matters.
const GRID_OF_SHAFTS: usize = 110;
const DECADES_OF_SHAFTS: f64 = 5.0;
/// The band ends at so many times the fastest pole of the open loop, or of the largest gains.
const BAND: f64 = 4.0;
/// How near a minimum is found, in parts of the stretch that it is on: it is flat to the last place after half the digits.
const NEAR: f64 = 3e-8;
/// Gains of the loop this little below 1 may soon cross it.
const NEARLY: f64 = 0.8;
/// Loci whose sizes differ by less pass each other.
const CORNER: f64 = 1e-5;
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
        // Where the open loop resonates the gain changes fastest.
        for pole in &poles {
            grid.extend([-2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 2.0].map(|part| pole.im + part * pole.re));
        }
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        let mut made = Self { open, speed: point[0], answers: Vec::new(), grid: Vec::new() };
        for w in grid {
            let answer = made.answer(problem, w);
            // An integrator has no answer at rest.
            if answer.iter().all(|z| z.is_finite()) {
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

    /// `L` of answers with these gains.
    fn sum(&self, answer: &[C64], gains: &[f64]) -> DMatrix<C64> {
        let m = self.open.count();
        let mut made = DMatrix::zeros(m, m);
        for ((own, gain), at) in answer.chunks_exact(m).zip(gains).zip(&self.open.bearing_of) {
            own.iter().enumerate().for_each(|(b, own)| made[(*at, b)] += own * gain);
        }
        made
    }

    fn gain(&self, problem: &Problem, gains: &[f64], frequency: f64) -> DMatrix<C64> {
        self.sum(&self.answer(problem, frequency), gains)
    }

    /// Of `loci` at a frequency, the one nearest to `to`.
    fn locus(&self, problem: &Problem, gains: &[f64], frequency: f64, to: C64) -> C64 {
        nearest(&loci(&self.gain(problem, gains, frequency)), to)
    }

    /// Every place at which the loop with these variables has no more than `far` times what is asked for, `near` being frequencies
    /// worth a look (its poles').
    fn places_within(&self, problem: &Problem, variables: &[f64], near: &[f64], far: f64) -> Vec<Place> {
        let gains = problem.structure.gains_at(variables, self.speed);
        let many = gains.len() * self.open.count();
        let mut curve: Vec<(f64, DMatrix<C64>)> =
            self.grid.iter().zip(self.answers.chunks(many)).map(|(w, answer)| (*w, self.sum(answer, &gains))).collect();
        let looked = near.iter().map(|w| (*w, self.gain(problem, &gains, *w)));
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
                    if b <= a && b < c && (b - 0.5 * (a.max(c) - b)) * limit < far {
                        let distance = |w: f64| (C64::ONE + opened(&self.gain(problem, &gains, w), bearing)).norm();
                        let at = minimum(p[0].0, p[2].0, distance);
                        let gain = opened(&self.gain(problem, &gains, at), bearing);
                        places.push(self.place(problem, Ask::Distance, bearing, (at, gain)));
                    }
                }
            }
        }
        if let Some(asked) = problem.min_delay {
            let loci: Vec<(f64, Vec<C64>)> = curve.iter().map(|(w, gain)| (*w, loci(gain))).collect();
            for rank in 0..self.open.count() {
                let branch: Vec<(f64, C64)> = loci.iter().map(|(w, all)| (*w, all[rank])).collect();
                self.delays(problem, &gains, (rank, &branch), (asked, far), &mut places);
            }
        }
        places.retain(|place| place.in_hand + 1.0 < far);
        places
    }

    /// Places where the locus of a rank bears little delay. The largest locus, or the next, is never one and the same thing for long,
    /// but its size is continuous, and so are its crossings.
    fn delays(
        &self,
        problem: &Problem,
        gains: &[f64],
        (rank, branch): (usize, &[(f64, C64)]),
        (asked, far): (f64, f64),
        places: &mut Vec<Place>,
    ) {
        let of = |w: f64| loci(&self.gain(problem, gains, w))[rank];
        // Of several loci the ends need not be the same one, and say little of what is between them.
        let several = self.open.count() > 1;
        for p in branch.windows(2) {
            let [a, b] = [0, 1].map(|k| p[k].1.norm() - 1.0);
            let bears = || [0, 1].map(|k| borne(p[k].1, p[k].0)).into_iter().fold(f64::INFINITY, f64::min);
            // Between two points the delay may jump by a turn, from much to nothing.
            let jumps = || (p[0].1.im < 0.0) != (p[1].1.im < 0.0);
            if (a < 0.0) != (b < 0.0) && (several || bears() < 1.5 * far * asked || jumps()) {
                let at = zero(p[0].0, p[1].0, |w| of(w).norm() - 1.0);
                places.push(self.place(problem, Ask::Delay, 0, (at, of(at))));
            }
        }
        for p in branch.windows(3) {
            let [a, b, c] = [0, 1, 2].map(|k| p[k].1.norm());
            if b >= a && b > c && b > 0.5 * NEARLY {
                let at = minimum(p[0].0, p[2].0, |w| -of(w).norm());
                let all = loci(&self.gain(problem, gains, at));
                let top = all[rank];
                // Where two loci pass each other in size, the smaller of the two has a corner and neither a maximum.
                let corner = all.iter().filter(|l| (l.norm() - top.norm()).abs() < CORNER).count() > 1;
                if corner {
                    continue;
                }
                if top.norm() < 1.0 && top.norm() > NEARLY && borne(top, at) < asked {
                    places.push(self.place(problem, Ask::Gain, 0, (at, top)));
                }
            }
        }
    }

    /// The same of those that matter to a search.
    pub(crate) fn places(&self, problem: &Problem, variables: &[f64], near: &[f64]) -> Vec<Place> {
        self.places_within(problem, variables, near, FAR)
    }

    fn place(&self, problem: &Problem, ask: Ask, bearing: usize, (frequency, gain): (f64, C64)) -> Place {
        let in_hand = match ask {
            Ask::Distance => (C64::ONE + gain).norm() * problem.max_sensitivity.unwrap_or(1.0) - 1.0,
            Ask::Delay => borne(gain, frequency) / problem.min_delay.unwrap_or(1.0) - 1.0,
            Ask::Gain => 1.0 / gain.norm() - 1.0,
        };
        Place { ask, bearing, frequency, gain, in_hand }
    }

    /// What the loop of a place changes by with each gain, and what it is.
    fn moved(&self, problem: &Problem, gains: &[f64], place: &Place) -> (C64, Vec<C64>) {
        let (answer, m) = (self.answer(problem, place.frequency), self.open.count());
        let whole = self.sum(&answer, gains);
        if m == 1 {
            return (whole[0], answer);
        }
        let each = answer.chunks_exact(m).zip(&self.open.bearing_of);
        match place.ask {
            Ask::Distance => {
                let b = place.bearing;
                let Some(s) = (&whole + DMatrix::<C64>::identity(m, m)).try_inverse() else {
                    return (-C64::ONE, vec![C64::ZERO; gains.len()]);
                };
                let square = s[(b, b)] * s[(b, b)];
                let of = |(own, at): (&[C64], &usize)| {
                    let through: C64 = (0..m).map(|j| own[j] * s[(j, b)]).sum();
                    s[(b, *at)] * through / square
                };
                (s[(b, b)].inv() - C64::ONE, each.map(of).collect())
            }
            Ask::Delay | Ask::Gain => {
                let locus = nearest(&loci(&whole), place.gain);
                // A column of the right vector times a row of the left one.
                let adjugate = adjugate(&(DMatrix::<C64>::identity(m, m) * locus - &whole));
                let give = adjugate.trace();
                let give = if give.norm() < 1e-12 { C64::from(1e-12) } else { give };
                let of = |(own, at): (&[C64], &usize)| (0..m).map(|j| own[j] * adjugate[(j, *at)]).sum::<C64>() / give;
                (locus, each.map(of).collect())
            }
        }
    }

    /// The slope of what a place has in hand in each variable, into `slope`.
    pub(crate) fn slope(&self, problem: &Problem, variables: &[f64], place: &Place, slope: &mut [f64]) {
        let gains = problem.structure.gains_at(variables, self.speed);
        let w = place.frequency;
        let (l, moved) = self.moved(problem, &gains, place);
        let by_gain: Vec<f64> = match place.ask {
            Ask::Distance => {
                let by =
                    problem.max_sensitivity.unwrap_or(1.0) * (C64::ONE + l).conj() / (C64::ONE + l).norm().max(1e-12);
                moved.iter().map(|own| (by * own).re).collect()
            }
            Ask::Gain => moved.iter().map(|own| -(l.conj() * own).re / l.norm().powi(3).max(1e-12)).collect(),
            Ask::Delay => {
                let h = 1e-6 * (1e-3 + w.abs());
                let along = (self.locus(problem, &gains, w + h, l) - self.locus(problem, &gains, w - h, l)) / (2.0 * h);
                let size = l.norm_sqr().max(1e-12);
                // How fast |L| and its angle change along the crossing.
                let [grows, turns] = [(l.conj() * along).re / size, (l.conj() * along).im / size];
                let steep = if grows.abs() < 1e-6 { 1e-6_f64.copysign(grows) } else { grows };
                let delay = borne(l, w);
                let least = problem.min_delay.unwrap_or(1.0);
                let of = |own: &C64| {
                    let moved = -(l.conj() * own).re / size / steep;
                    let angle = (l.conj() * own).im / size + turns * moved;
                    (angle - delay * moved) / w / least
                };
                moved.iter().map(of).collect()
            }
        };
        problem.structure.spread(self.speed, &by_gain, 0.0, slope);
    }
}

/// The loop of one bearing with the others closed.
fn opened(gain: &DMatrix<C64>, bearing: usize) -> C64 {
    let m = gain.nrows();
    if m == 1 {
        return gain[0];
    }
    match (gain + DMatrix::<C64>::identity(m, m)).try_inverse() {
        Some(s) => s[(bearing, bearing)].inv() - C64::ONE,
        None => -C64::ONE,
    }
}

/// The eigenvalues of a loop, the largest first.
fn loci(gain: &DMatrix<C64>) -> Vec<C64> {
    let m = gain.nrows();
    if m == 1 {
        return vec![gain[0]];
    }
    let (mut rows, mut values): (Vec<C64>, _) = (gain.transpose().as_slice().to_vec(), vec![C64::ZERO; m]);
    match eigenvalues_in_place(&mut rows, &mut values) {
        Ok(()) => {
            values.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()));
            values
        }
        Err(_) => vec![C64::ZERO; m],
    }
}

fn nearest(loci: &[C64], to: C64) -> C64 {
    let distance = |l: &C64| (l - to).norm_sqr();
    loci.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(to)
}

/// The adjugate of a square matrix: of a singular one, its right null vector times its left one.
fn adjugate(of: &DMatrix<C64>) -> DMatrix<C64> {
    let m = of.nrows();
    DMatrix::from_fn(m, m, |i, j| {
        let minor = of.clone().remove_row(j).remove_column(i).determinant();
        if (i + j) % 2 == 0 { minor } else { -minor }
    })
}

/// The delay that turns a gain at a frequency onto the negative real axis.
fn borne(gain: C64, frequency: f64) -> f64 {
    let angle = (-gain).arg();
    let turn = if angle * frequency < 0.0 { angle + TAU.copysign(frequency) } else { angle };
    if frequency == 0.0 { f64::INFINITY } else { turn / frequency }
}

/// Where `of` is smallest between two places around one minimum.
fn minimum(low: f64, high: f64, of: impl Fn(f64) -> f64) -> f64 {
    let Ok((at, _)) = least([low, high], NEAR * (high - low), |x| Ok::<_, Infallible>(of(x)));
    at
}

/// Where `of` changes sign between two places, by halving.
fn zero(mut low: f64, mut high: f64, of: impl Fn(f64) -> f64) -> f64 {
    let is_low = of(low) < 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (of(middle) < 0.0) == is_low { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The margins at one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopMargins {
    /// The largest `|S|` over frequency, and where, in radians per `tau`.
    pub sensitivity: (f64, f64),
    /// The least delay more that makes it unstable and the frequency that goes; nothing if none does.
    pub delay: Option<(f64, f64)>,
}

/// The margins of a stable machine at `point`; of one that is not, an infinite peak and no delay borne.
pub(crate) fn margins_at(problem: &Problem, variables: &[f64], point: &[f64], poles: &[C64]) -> Option<LoopMargins> {
    // Every minimum and crossing, whatever is asked for.
    let asked = Problem { max_sensitivity: Some(1.0), min_delay: Some(1.0), ..problem.clone() };
    let opened = Opened::at(&asked, point)?;
    if poles.is_empty() || poles.iter().any(|pole| pole.re >= 0.0) {
        return Some(LoopMargins { sensitivity: (f64::INFINITY, f64::NAN), delay: Some((0.0, f64::NAN)) });
    }
    let near: Vec<f64> = poles.iter().map(|pole| pole.im).collect();
    // Far out the gain is nothing and |S| is 1.
    let mut found = LoopMargins { sensitivity: (1.0, f64::INFINITY), delay: None };
    for place in opened.places_within(&asked, variables, &near, f64::INFINITY) {
        let value = place.in_hand + 1.0;
        match place.ask {
            Ask::Distance if 1.0 / value > found.sensitivity.0 => found.sensitivity = (1.0 / value, place.frequency),
            Ask::Delay if found.delay.is_none_or(|(least, _)| value < least) => {
                found.delay = Some((value, place.frequency));
            }
            _ => {}
        }
    }
    Some(found)
}
