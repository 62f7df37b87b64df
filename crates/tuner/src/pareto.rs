//! What damping costs: the best worst mode for a row of limits on control force, on gains, or on the peak of the sensitivity.

use crate::{Options, Problem, ProblemError, Progress, Stop, Tuned, tune};

/// What is limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Price {
    /// The steady control force of the linear rotor.
    Force,
    /// The largest gain.
    Gain,
    /// The largest peak of the sensitivity.
    Sensitivity,
}

/// One point of the front.
#[derive(Clone, Debug, PartialEq)]
pub struct ParetoPoint {
    /// The limit.
    pub limit: f64,
    /// What was found within it.
    pub tuned: Tuned,
}

impl Price {
    /// What given gains cost.
    #[must_use]
    pub fn of(self, tuned: &Tuned) -> f64 {
        match self {
            Self::Force => tuned.force,
            Self::Gain => tuned.largest_gain(),
            Self::Sensitivity => tuned.peak_sensitivity().unwrap_or(f64::INFINITY),
        }
    }

    fn limited(self, problem: &Problem, limit: f64) -> Problem {
        match self {
            Self::Force => Problem { force_limit: Some(limit), ..problem.clone() },
            Self::Gain => Problem { bound: limit, ..problem.clone() },
            Self::Sensitivity => Problem { max_sensitivity: Some(limit.max(LOWEST_PEAK)), ..problem.clone() },
        }
    }
}

/// A front of the sensitivity begins no further out: beyond, damping gains nothing that anybody would buy.
pub const WIDEST_PEAK: f64 = 10.0;
/// Below this no peak of the sensitivity can be.
const LOWEST_PEAK: f64 = 1.0 + 1e-6;
/// How far below the cost of the best gains limits are tried.
const HALVINGS: i32 = 12;

/// The front of `problem` with `points` points, at least two, dearest first: from the best there is down to the tightest
/// limit, found by halving it, that still leaves every mode decaying. Limits between are spread evenly in their logarithm.
/// Every search also starts from the gains of its dearer neighbour.
///
/// # Errors
/// A problem that makes no sense.
pub fn pareto(
    problem: &Problem,
    price: Price,
    points: usize,
    options: &Options,
    progress: &(dyn Fn(&Progress) + Sync),
    stop: Stop,
) -> Result<Vec<ParetoPoint>, ProblemError> {
    let best = match price {
        Price::Sensitivity => tune(&price.limited(problem, WIDEST_PEAK), options, progress, stop)?,
        _ => tune(problem, options, progress, stop)?,
    };
    let top = price.of(&best);
    let mut front = vec![ParetoPoint { limit: top, tuned: best }];
    if !(top > 0.0 && front[0].tuned.worst.stable() == Some(true)) {
        return Ok(front);
    }
    let at = |limit: f64, from: &Tuned| {
        let mut options = options.clone();
        let scale = if price == Price::Gain { limit / price.of(from).max(limit) } else { 1.0 };
        let mut first = from.gains.clone();
        first[..problem.structure.gain_variables()].iter_mut().for_each(|gain| *gain *= scale);
        options.first = vec![first];
        tune(&price.limited(problem, limit), &options, progress, stop)
    };
    let within =
        |tuned: &Tuned, limit: f64| tuned.worst.stable() == Some(true) && price.of(tuned) <= limit * (1.0 + 1e-3);
    // The tightest limit, to a factor of two, then of the fourth root of two.
    let (mut low, mut high) = (top * 0.5_f64.powi(HALVINGS), top);
    let mut tightest = front[0].tuned.clone();
    for k in 1..=HALVINGS {
        let limit = top * 0.5_f64.powi(k);
        let tuned = at(limit, &tightest)?;
        if stop.is_set() || !within(&tuned, limit) {
            low = limit;
            break;
        }
        (high, tightest) = (limit, tuned);
    }
    for _ in 0..2 {
        let limit = (low * high).sqrt();
        let tuned = at(limit, &tightest)?;
        if within(&tuned, limit) {
            (high, tightest) = (limit, tuned);
        } else {
            low = limit;
        }
    }
    let last = points.max(2) - 1;
    for k in 1..=last {
        if stop.is_set() {
            break;
        }
        let limit = top * (high / top).powf(k as f64 / last as f64);
        let dearer = &front[front.len() - 1].tuned;
        let mut tuned = at(limit, dearer)?;
        if k == last && tightest.worst.value > tuned.worst.value {
            tuned = tightest.clone();
        }
        if within(&tuned, limit) {
            front.push(ParetoPoint { limit, tuned });
        }
    }
    Ok(front)
}
