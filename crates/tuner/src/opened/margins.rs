//! The margins at one condition, told of gains that were found: on the way that all margins are found on, which knows nothing of the grid of
//! a search.

use rotor::C64;

use crate::Problem;

/// The margins at one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopMargins {
    /// The largest `|S|` over frequency, and where, in radians per `tau`.
    pub sensitivity: (f64, f64),
    /// The least delay more that makes it unstable and the frequency that goes; nothing if none does.
    pub delay: Option<(f64, f64)>,
}

/// The margins of a stable machine at `point`; of one that is not, an infinite peak and no delay borne; nothing where they cannot be had.
pub(crate) fn margins_at(problem: &Problem, variables: &[f64], point: &[f64], poles: &[C64]) -> Option<LoopMargins> {
    if poles.is_empty() || poles.iter().any(|pole| pole.re >= 0.0) {
        return Some(LoopMargins { sensitivity: (f64::INFINITY, f64::NAN), delay: Some((0.0, f64::NAN)) });
    }
    let (plant, at) = (problem.family.plant(point), problem.family.operating(point));
    let mut feedback = problem.structure.feedback(variables);
    feedback.set_delay(problem.delay(point));
    let found = machine::loop_margins(&plant, &feedback, &at).ok()?.margins;
    let peak = found.sensitivity();
    Some(LoopMargins {
        // Far out the gain is nothing and |S| is 1.
        sensitivity: (peak.amplitude, peak.frequency.unwrap_or(f64::INFINITY)),
        delay: found.delay.map(|margin| (margin.delay, margin.frequency)),
    })
}
