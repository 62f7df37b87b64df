//! The margins at one condition, told of gains that were found.

use rotor::C64;

use super::{Ask, Opened};
use crate::Problem;

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
