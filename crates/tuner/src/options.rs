//! How much is searched, and how.

use crate::Problem;

/// Climbs of a rotor of shaft elements: one from the template's gains, others from around them.
const STARTS_OF_SHAFTS: usize = 4;
/// Climbs of a chain where corners are searched.
const STARTS_WITH_CORNERS: usize = 16;

/// How a climb goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Smoothing continuation with slopes, then sequential convex steps: see [`crate::smooth`] and [`crate::minimax`].
    #[default]
    Nonsmooth,
    /// Powell's direction sets, as in the report.
    Powell,
}

/// How much is searched.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// How a climb goes.
    pub method: Method,
    /// How many climbs; at least 1.
    pub starts: usize,
    /// What random numbers start from. The same seed gives the same answer, whatever the number of threads.
    pub seed: u64,
    /// Random gains are drawn evenly from `-spread` to `spread`, of shaft elements around the template's, never beyond the bound; the
    /// logarithms of corners likewise, of chains over all of their range.
    pub spread: f64,
    /// How sharply the worst over a continuous family is to be bounded, see [`crate::Certificate::tolerance`].
    pub tolerance: f64,
    /// Gains to start from beside the random ones: the first climbs.
    pub first: Vec<Vec<f64>>,
    /// Whether the worst is to be proven; otherwise the answer has the worst that was found.
    pub prove: bool,
    /// How many threads climb; all cores if not said. The answer does not depend on it.
    pub threads: Option<usize>,
}

impl Options {
    /// What suits a problem: more starts and wider ones the more there is to get wrong. Over a range of speeds every start with
    /// four gains ends at the same value; with eight gains, one in two or three does; with corners there are many optima, one in eight
    /// starts may end at the best, and the law as it is comes first.
    #[must_use]
    pub fn for_problem(problem: &Problem) -> Self {
        let conditions = problem.family.varying().count();
        let gains = problem.structure.gain_variables();
        let has_corners = !problem.structure.corners().is_empty();
        let starts = match (conditions, gains) {
            _ if has_corners => STARTS_WITH_CORNERS,
            (0, 0..=4) => 8,
            (0, _) => 24,
            (1, 0..=4) => 4,
            (1, _) => 32,
            _ => 16,
        };
        let own = problem.structure.own();
        if !problem.structure.is_chain() {
            // What there is comes first, and the others begin around it.
            return Self { starts: STARTS_OF_SHAFTS, spread: 0.5, first: vec![own], ..Self::plain(starts) };
        }
        let spread = if gains <= 4 && !has_corners { 1.0 } else { problem.bound.min(5.0) };
        let is_law = has_corners && own[..gains].iter().any(|gain| *gain != 0.0);
        Self { spread, first: if is_law { vec![own] } else { Vec::new() }, ..Self::plain(starts) }
    }

    fn plain(starts: usize) -> Self {
        Self {
            method: Method::Nonsmooth,
            starts,
            seed: 1,
            spread: 1.0,
            tolerance: 1e-4,
            first: Vec::new(),
            prove: true,
            threads: None,
        }
    }
}
