//! Gains that follow the speed: the report's Fig. 4.7, with a penalty on jumps.
//!
//! At every one of a list of speeds the gains are to damp the worst mode well, and from speed to speed they are to change
//! little:
//!
//! ```text
//! max  sum_k f_k(x_k) - stiffness sum_k |x_{k+1} - x_k|^2 / (R_{k+1} - R_k)^2
//! ```
//!
//! It begins at one speed with a full search, continues from there to both ends, each speed from the gains of its
//! neighbour and held by them, and then goes up and down over all speeds, each held by both neighbours, until the gains
//! settle. Between the speeds gains are interpolated; what that does to the poles is evaluated over the whole range in the end.

use rotor::Feedback;

use crate::conditions::counts;
use crate::evaluate::Evaluator;
use crate::exchange::{COARSE, FINE, exchange, improve};
use crate::stop::Stop;
use crate::{Method, Options, Problem, ProblemError, Progress, Schedule, Tuned, evaluate, tune};

/// Gains over speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// The speeds, rising.
    pub speeds: Vec<f64>,
    /// The gains at each of them.
    pub gains: Vec<Vec<f64>>,
    /// What the worst mode is worth at each of them.
    pub values: Vec<f64>,
    /// The feedback that interpolates, evaluated over the whole range.
    pub evaluated: Tuned,
}

impl Tracked {
    /// The largest change of any gain per unit of speed.
    #[must_use]
    pub fn steepest(&self) -> f64 {
        let pairs = self.speeds.windows(2).zip(self.gains.windows(2));
        let changes =
            pairs.flat_map(|(r, x)| x[0].iter().zip(&x[1]).map(move |(a, b)| ((b - a) / (r[1] - r[0])).abs()));
        changes.fold(0.0, f64::max)
    }

    /// The feedback: tables over speed.
    #[must_use]
    pub fn feedback(&self) -> &Feedback {
        &self.evaluated.feedback
    }
}

/// Sweeps up and down over all speeds.
const SWEEPS: usize = 12;
/// The gains have settled when no sweep moves any by more than this.
const SETTLED: f64 = 1e-4;

/// Follows `problem`, whose structure has fixed gains, over `speeds`, rising, at least two. `stiffness` is what a gain that
/// changes by 1 per unit of speed costs, in worth at each speed; above 0.
///
/// # Errors
/// A problem that makes no sense.
///
/// # Panics
/// If there are fewer than two speeds, or they do not rise.
pub fn track(
    problem: &Problem,
    speeds: &[f64],
    stiffness: f64,
    options: &Options,
    progress: &(dyn Fn(&Progress) + Sync),
    stop: Stop,
) -> Result<Tracked, ProblemError> {
    assert!(speeds.windows(2).all(|w| w[0] < w[1]) && speeds.len() > 1, "at least two speeds, rising");
    problem.check()?;
    if let Some(corner) = problem.structure.corners().first() {
        return Err(ProblemError::Followed(corner.name.clone()));
    }
    let last = speeds.len() - 1;
    let at = |speed: f64| Problem { family: problem.family.at_speed(speed), ..problem.clone() };
    // The highest speed is the hardest to hold and has the fewest ways: there the search is worth most.
    let found = tune(&at(speeds[last]), options, progress, stop)?;
    let mut stations: Vec<Station> =
        speeds.iter().map(|&speed| Station { problem: at(speed), gains: Vec::new(), value: 0.0 }).collect();
    (stations[last].gains, stations[last].value) = (found.gains, found.worst.value);
    for k in (0..last).rev() {
        let (from, price) = (stations[k + 1].gains.clone(), stiffness / (speeds[k + 1] - speeds[k]).powi(2));
        stations[k].gains = from.clone();
        stations[k].settle(Some((from, price)), &stop);
    }
    for _ in 0..SWEEPS {
        let mut moved: f64 = 0.0;
        for k in (0..=last).chain((0..last).rev()) {
            let near = [k.checked_sub(1), (k < last).then_some(k + 1)].into_iter().flatten();
            let each: Vec<(f64, &Vec<f64>)> =
                near.map(|i| (stiffness / (speeds[i] - speeds[k]).powi(2), &stations[i].gains)).collect();
            // Two springs are one, at the mean that they pull to.
            let price: f64 = each.iter().map(|(price, _)| price).sum();
            let mean: Vec<f64> = (0..stations[k].gains.len())
                .map(|i| each.iter().map(|(price, gains)| price * gains[i]).sum::<f64>() / price)
                .collect();
            let before = stations[k].gains.clone();
            stations[k].settle(Some((mean, price)), &stop);
            moved = before.iter().zip(&stations[k].gains).fold(moved, |m, (a, b)| m.max((a - b).abs()));
        }
        if moved < SETTLED || stop.is_set() {
            break;
        }
    }
    let (gains, values): (Vec<_>, Vec<_>) = stations.into_iter().map(|s| (s.gains, s.value)).unzip();
    let evaluated = evaluate_table(problem, speeds, &gains, options, stop)?;
    Ok(Tracked { speeds: speeds.to_vec(), gains, values, evaluated })
}

/// One speed.
struct Station {
    problem: Problem,
    gains: Vec<f64>,
    value: f64,
}

impl Station {
    /// Improves the gains, held by a tether.
    fn settle(&mut self, tether: Option<(Vec<f64>, f64)>, stop: &Stop) {
        let family = &self.problem.family;
        let mut points = family.grid(&counts(family, self.problem.points(COARSE)));
        let mut evaluator = Evaluator::new(&self.problem, &points).until(*stop);
        evaluator.tether = tether;
        improve(&mut evaluator, &mut self.gains, 0.1, stop);
        exchange(
            &mut evaluator,
            &mut points,
            &mut self.gains,
            &counts(family, self.problem.points(FINE)),
            Method::Nonsmooth,
            stop,
        );
        self.value = evaluator.evaluate(&self.gains);
    }
}

/// The interpolated gains over the whole range.
fn evaluate_table(
    problem: &Problem,
    speeds: &[f64],
    gains: &[Vec<f64>],
    options: &Options,
    stop: Stop,
) -> Result<Tuned, ProblemError> {
    let (from, to) = (speeds[0], speeds[speeds.len() - 1]);
    let structure = problem.structure.with_schedule(Schedule::Table(speeds.to_vec()));
    let each = gains[0].len();
    let variables: Vec<f64> = (0..each).flat_map(|i| gains.iter().map(move |at| at[i])).collect();
    let family = problem.family.over_speeds(from, to);
    evaluate(&Problem { family, structure, ..problem.clone() }, options, &variables, stop)
}
