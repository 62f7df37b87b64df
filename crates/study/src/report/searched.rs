//! What the gain search finds for the report's structure: gains over speed (Fig. 4.7), and how far gains reach.

use std::sync::atomic::Ordering;

use rayon::prelude::*;
use rotor::{Gain, Rotor, Signal, Threshold, Trace, builtin, thresholds, trace};
use tuner::{Family, Options, Problem, Schedule, Stop, Structure, Tracked, Tuned, track, tune};

use super::{Onlooker, ReportError};

/// Speeds at which gains are tracked, over `0..=8`.
const STATIONS: usize = 41;
/// The price of changes: what reads well, see [`tuner::track()`].
const STIFFNESS: f64 = 1e-3;
/// Gains are searched up to this magnitude; none of the answers comes near it.
const BOUND: f64 = 20.0;
/// The report's threshold, whose gains it holds constant.
const PRINTED_EDGE: f64 = 7.2;

/// All of it.
pub(super) struct Searched {
    /// Gains that follow the speed.
    pub tracked: Tracked,
    /// The poles with them.
    pub trace: Trace,
    /// The best at whole speeds, each by itself.
    pub alone: Vec<Tuned>,
    /// Where the rotor changes stability with the gains that are best at [`PRINTED_EDGE`] by itself.
    pub at_edge_thresholds: Vec<Threshold>,
    /// Up to here gains of one speed can damp every mode of that speed.
    pub reach_alone: f64,
    /// Up to here one constant set of gains can damp every mode of all speeds from 0.
    pub reach_constant: f64,
}

/// How many steps [`Searched::gather`] counts.
pub(super) const STEPS: usize = 4;

/// The speeds of [`Searched::alone`].
pub(super) fn whole_speeds() -> impl Iterator<Item = f64> {
    (0..=8).map(f64::from)
}

impl Searched {
    /// Searches.
    ///
    /// # Errors
    /// Poles that cannot be followed, or a request to stop.
    pub(super) fn gather(rotor: &Rotor, onlooker: &Onlooker<'_>) -> Result<Self, ReportError> {
        let over = |from: f64, to: f64| problem(rotor, from, to);
        let stop = Stop::when(onlooker.stop);
        // Following is one long chain; the rest fills the other cores.
        let (tracked, (alone, reaches)) = rayon::join(
            || {
                let speeds: Vec<f64> = (0..STATIONS).map(|i| 8.0 * i as f64 / (STATIONS - 1) as f64).collect();
                let whole = over(0.0, 8.0);
                let options = Options { prove: false, ..Options::for_problem(&whole) };
                counted(onlooker, track(&whole, &speeds, STIFFNESS, &options, &|_| (), stop))
            },
            || {
                let speeds: Vec<f64> = whole_speeds().chain([PRINTED_EDGE]).collect();
                let best = |speed: &f64| {
                    let problem = over(*speed, *speed);
                    tune(&problem, &Options::for_problem(&problem), &|_| (), stop)
                };
                let alone = counted(onlooker, speeds.par_iter().map(best).collect::<Result<Vec<Tuned>, _>>());
                let reach_alone = counted(onlooker, reach(&|speed| over(speed, speed), PRINTED_EDGE, stop));
                let reach_constant = counted(onlooker, reach(&|speed| over(0.0, speed), 7.0, stop));
                (alone, [reach_alone, reach_constant])
            },
        );
        if onlooker.stop.load(Ordering::Relaxed) {
            return Err(ReportError::Interrupted);
        }
        let sensible = "a problem that makes sense";
        let (tracked, mut alone, [reach_alone, reach_constant]) =
            (tracked.expect(sensible), alone.expect(sensible), reaches.map(|reach| reach.expect(sensible)));
        let at_edge = alone.pop().expect("one search a speed");
        let speeds: Vec<f64> = (0..=400).map(|i| 0.02 * f64::from(i)).collect();
        Ok(Self {
            trace: trace(rotor, tracked.feedback(), &speeds)?,
            at_edge_thresholds: thresholds(rotor, &at_edge.feedback, 0.0, 8.0)?,
            tracked,
            alone,
            reach_alone,
            reach_constant,
        })
    }

    /// The most that any pole moves per unit of speed.
    pub(super) fn fastest_pole(&self) -> f64 {
        let step = self.trace.speeds[1] - self.trace.speeds[0];
        let moves = self.trace.branches.iter().flat_map(|b| b.poles.windows(2).map(|w| (w[1] - w[0]).norm() / step));
        moves.fold(0.0, f64::max)
    }

    /// What tracking gives up at the whole speeds from `from` on: the most by which the best there alone is better damped.
    pub(super) fn given_up(&self, from: f64) -> f64 {
        let tracked = |speed: f64| {
            let near = self.tracked.speeds.iter().position(|s| (s - speed).abs() < 1e-9);
            near.map_or(f64::NAN, |i| self.tracked.values[i])
        };
        let pairs = whole_speeds().zip(&self.alone).filter(|(speed, _)| *speed >= from);
        pairs.map(|(speed, best)| best.worst.value - tracked(speed)).fold(0.0, f64::max)
    }
}

fn counted<T>(onlooker: &Onlooker<'_>, made: T) -> T {
    (onlooker.done)();
    made
}

/// The report's structure: the weights and the bearing of the built-in `composite`.
fn problem(rotor: &Rotor, from: f64, to: f64) -> Problem {
    let template = builtin::feedback(rotor, "composite").expect("built-in feedback");
    let structure = Structure::new(rotor, &template, Schedule::Fixed).expect("feedback that fits");
    Problem::new(Family::new(rotor, from, to).expect("a range of speeds"), structure, BOUND)
}

/// The speed at which the best that can be had of `at` that speed falls to zero: secants from `near`, where it is searched
/// from many starts; from there on the gains are followed, and one random start looks whether there are better ones.
fn reach(at: &dyn Fn(f64) -> Problem, near: f64, stop: Stop) -> Result<f64, tuner::ProblemError> {
    let search = |speed: f64, first: Option<&Tuned>| {
        let problem = at(speed);
        let usual = Options { prove: false, ..Options::for_problem(&problem) };
        let options = match first {
            Some(first) => Options { starts: 2, first: vec![first.gains.clone()], ..usual },
            None => usual,
        };
        tune(&problem, &options, &|_| (), stop)
    };
    let mut last = (near, search(near, None)?);
    let mut speed = near + 0.2;
    for _ in 0..8 {
        let here = search(speed, Some(&last.1))?;
        let slope = (here.worst.value - last.1.worst.value) / (speed - last.0);
        let next = speed - here.worst.value / slope;
        if (next - speed).abs() < 1e-6 || stop.is_set() {
            return Ok(next);
        }
        last = (speed, here);
        speed = next;
    }
    Ok(speed)
}

/// The constant gains of the built-in feedback of this structure, in the order `kd cd kc cc`.
pub(super) fn constant_gains(rotor: &Rotor) -> [f64; 4] {
    let feedback = builtin::feedback(rotor, "composite").expect("built-in feedback");
    feedback.bearings[0]
        .signals
        .first()
        .map_or([0.0; 4], |signal: &Signal| signal.gains.each_ref().map(|gain: &Gain| gain.at(0.0)))
}
