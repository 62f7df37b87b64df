//! The loop opened at the control bearing's command at one condition: how near it comes to -1, and what delay more it bears, with
//! the slope of both in each gain.
//!
//! The gain of the loop is linear in the gains of the feedback, `L(j w) = sum_k g_k l_k(j w)`, where `l_k` is what gain `k` alone,
//! being 1, sends back of a unit of command. So at a frequency
//!
//! ```text
//! d|1 + L| / dg_k = Re(conj(1 + L) l_k) / |1 + L|
//! ```
//!
//! which is the slope of its minimum over frequency too, because there it does not change with `w`. A delay `T` turns the crossing
//! `|L(j w)| = 1` onto -1 where `w T = pi + arg L`; the crossing moves with the gains so that `|L|` stays 1.
//!
//! Distances are what is asked for, not peaks: `|1 + L|` goes to 0 where the machine goes unstable, and `|S|` to infinity.

use std::convert::Infallible;
use std::f64::consts::TAU;

use control::LinearLoop;
use linear::least;
use rotor::{C64, Quadratic};

use crate::Problem;

/// Frequencies looked at on each side of 0 before the search between them.
const GRID: usize = 80;
/// Decades over which they are spread.
const DECADES: f64 = 3.0;
/// The band ends at so many times the fastest pole of the open loop, or of the largest gains.
const BAND: f64 = 4.0;
/// How near a minimum is found, in parts of the stretch that it is on: it is flat to the last place after half the digits.
const NEAR: f64 = 3e-8;
/// Gains of the loop this little below 1 may soon cross it.
const NEARLY: f64 = 0.8;
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
    /// In radians per `tau`, forward positive.
    pub(crate) frequency: f64,
    /// What there is over what is asked, less 1: not to be negative.
    pub(crate) in_hand: f64,
}

/// A loop at one condition.
#[derive(Clone, Debug)]
pub(crate) struct Opened {
    open: Quadratic,
    speed: f64,
    delay: f64,
    /// What each gain alone makes of the loop, where it is more than gains and a delay.
    around: Vec<LinearLoop>,
    grid: Vec<f64>,
    /// `l_k` at every frequency of the grid.
    answers: Vec<C64>,
}

impl Opened {
    /// At a condition of `problem`; `None` if nothing of the kind is asked for.
    pub(crate) fn at(problem: &Problem, point: &[f64]) -> Option<Self> {
        if !problem.asks_margins() {
            return None;
        }
        let (structure, speed, delay) = (&problem.structure, point[0], problem.delay(point));
        let around = if structure.has_loop() {
            let of = |k| LinearLoop::new(&structure.unit(Some(k), delay), structure.masses(), speed).ok();
            (0..structure.gains()).map(of).collect::<Option<_>>()?
        } else {
            Vec::new()
        };
        let open = problem.family.open(point);
        let poles = open.poles().unwrap_or_default();
        let fastest = poles.iter().map(|pole| pole.norm()).fold(1.0, f64::max);
        let end = BAND * fastest.max(problem.bound * (structure.gains() as f64 / 4.0).sqrt());
        let mut grid = vec![0.0];
        for k in 0..GRID {
            let w = end * 10.0_f64.powf(-DECADES * k as f64 / (GRID - 1) as f64);
            grid.extend([w, -w]);
        }
        // Where the open loop resonates the gain changes fastest.
        for pole in &poles {
            grid.extend([-2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 2.0].map(|part| pole.im + part * pole.re));
        }
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        let mut made = Self { open, speed, delay, around, answers: Vec::new(), grid };
        made.answers = made.grid.iter().flat_map(|w| made.answer(problem, *w)).collect();
        Some(made)
    }

    /// `l_k` at a frequency.
    fn answer(&self, problem: &Problem, frequency: f64) -> Vec<C64> {
        let structure = &problem.structure;
        let s = C64::new(0.0, frequency);
        let mut whirl = vec![C64::ZERO; structure.masses()];
        whirl[structure.bearing()] = C64::ONE;
        self.open.respond(s, &mut whirl);
        if self.around.is_empty() {
            let late = C64::cis(-frequency * self.delay);
            return structure.gain_sensitivities(&whirl, s).into_iter().map(|gain| gain * late).collect();
        }
        let of = |around: &LinearLoop| {
            let answer = around.fundamental(frequency)?;
            Some(-around.sensors.iter().zip(&answer).map(|(at, h)| h * whirl[*at]).sum::<C64>())
        };
        self.around.iter().map(|around| of(around).unwrap_or(C64::ZERO)).collect()
    }

    fn gain(&self, problem: &Problem, gains: &[f64], frequency: f64) -> C64 {
        sum(&self.answer(problem, frequency), gains)
    }

    /// Every place at which the loop with these variables has no more than `far` times what is asked for, `near` being frequencies
    /// worth a look (its poles').
    fn places_within(&self, problem: &Problem, variables: &[f64], near: &[f64], far: f64) -> Vec<Place> {
        let gains = problem.structure.gains_at(variables, self.speed);
        let many = gains.len();
        let mut curve: Vec<(f64, C64)> =
            self.grid.iter().zip(self.answers.chunks(many)).map(|(w, answer)| (*w, sum(answer, &gains))).collect();
        curve.extend(near.iter().map(|w| (*w, self.gain(problem, &gains, *w))));
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        curve.dedup_by(|a, b| a.0 == b.0);
        let mut places = Vec::new();
        if let Some(limit) = problem.max_sensitivity.filter(|limit| limit.is_finite()) {
            let distance = |l: C64| (C64::ONE + l).norm();
            for p in curve.windows(3) {
                let [a, b, c] = [0, 1, 2].map(|k| distance(p[k].1));
                // The minimum is below the least of the three, by less than half of what they differ by.
                if b <= a && b < c && (b - 0.5 * (a.max(c) - b)) * limit < far {
                    let at = minimum(p[0].0, p[2].0, |w| distance(self.gain(problem, &gains, w)));
                    places.push(self.place(problem, &gains, Ask::Distance, at));
                }
            }
        }
        if let Some(asked) = problem.min_delay {
            for p in curve.windows(2) {
                let [a, b] = [0, 1].map(|k| p[k].1.norm() - 1.0);
                let bears = || [0, 1].map(|k| borne(p[k].1, p[k].0)).into_iter().fold(f64::INFINITY, f64::min);
                // Between two points the delay may jump by a turn, from much to nothing.
                let jumps = || (p[0].1.im < 0.0) != (p[1].1.im < 0.0);
                if (a < 0.0) != (b < 0.0) && (bears() < 1.5 * far * asked || jumps()) {
                    let at = zero(p[0].0, p[1].0, |w| self.gain(problem, &gains, w).norm() - 1.0);
                    places.push(self.place(problem, &gains, Ask::Delay, at));
                }
            }
            for p in curve.windows(3) {
                let [a, b, c] = [0, 1, 2].map(|k| p[k].1.norm());
                if b >= a && b > c && b > 0.5 * NEARLY {
                    let at = minimum(p[0].0, p[2].0, |w| -self.gain(problem, &gains, w).norm());
                    let top = self.gain(problem, &gains, at).norm();
                    if top < 1.0 && top > NEARLY && self.bears(problem, &gains, at) < problem.min_delay.unwrap_or(0.0) {
                        places.push(self.place(problem, &gains, Ask::Gain, at));
                    }
                }
            }
        }
        places.retain(|place| place.in_hand + 1.0 < far);
        places
    }

    /// The same of those that matter to a search.
    pub(crate) fn places(&self, problem: &Problem, variables: &[f64], near: &[f64]) -> Vec<Place> {
        self.places_within(problem, variables, near, FAR)
    }

    fn bears(&self, problem: &Problem, gains: &[f64], frequency: f64) -> f64 {
        borne(self.gain(problem, gains, frequency), frequency)
    }

    fn place(&self, problem: &Problem, gains: &[f64], ask: Ask, frequency: f64) -> Place {
        let l = self.gain(problem, gains, frequency);
        let in_hand = match ask {
            Ask::Distance => (C64::ONE + l).norm() * problem.max_sensitivity.unwrap_or(1.0) - 1.0,
            Ask::Delay => self.bears(problem, gains, frequency) / problem.min_delay.unwrap_or(1.0) - 1.0,
            Ask::Gain => 1.0 / l.norm() - 1.0,
        };
        Place { ask, frequency, in_hand }
    }

    /// The slope of what a place has in hand in each variable, into `slope`.
    pub(crate) fn slope(&self, problem: &Problem, variables: &[f64], place: &Place, slope: &mut [f64]) {
        let gains = problem.structure.gains_at(variables, self.speed);
        let w = place.frequency;
        let answer = self.answer(problem, w);
        let l = sum(&answer, &gains);
        let by_gain: Vec<f64> = match place.ask {
            Ask::Distance => {
                let by =
                    problem.max_sensitivity.unwrap_or(1.0) * (C64::ONE + l).conj() / (C64::ONE + l).norm().max(1e-12);
                answer.iter().map(|own| (by * own).re).collect()
            }
            Ask::Gain => answer.iter().map(|own| -(l.conj() * own).re / l.norm().powi(3).max(1e-12)).collect(),
            Ask::Delay => {
                let h = 1e-6 * (1e-3 + w.abs());
                let along = (self.gain(problem, &gains, w + h) - self.gain(problem, &gains, w - h)) / (2.0 * h);
                let size = l.norm_sqr().max(1e-12);
                // How fast |L| and its angle change along the crossing.
                let [grows, turns] = [(l.conj() * along).re / size, (l.conj() * along).im / size];
                let steep = if grows.abs() < 1e-6 { 1e-6_f64.copysign(grows) } else { grows };
                let delay = self.bears(problem, &gains, w);
                let least = problem.min_delay.unwrap_or(1.0);
                let of = |own: &C64| {
                    let moved = -(l.conj() * own).re / size / steep;
                    let angle = (l.conj() * own).im / size + turns * moved;
                    (angle - delay * moved) / w / least
                };
                answer.iter().map(of).collect()
            }
        };
        problem.structure.spread(self.speed, &by_gain, 0.0, slope);
    }
}

/// The delay that turns a gain at a frequency onto the negative real axis.
fn borne(gain: C64, frequency: f64) -> f64 {
    let angle = (-gain).arg();
    let turn = if angle * frequency < 0.0 { angle + TAU.copysign(frequency) } else { angle };
    if frequency == 0.0 { f64::INFINITY } else { turn / frequency }
}

fn sum(answer: &[C64], gains: &[f64]) -> C64 {
    answer.iter().zip(gains).map(|(own, gain)| own * gain).sum()
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
