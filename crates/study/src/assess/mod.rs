//! What standards ask of a machine, line by line: what was found, what is asked, whether that is enough, and where.
//!
//! An aid for whoever writes a test plan, not a certificate: the limits are those commonly quoted of API 617, API 684, ISO 14839
//! and ISO 21940, stand in [`Limits`] with their origin, and can be changed.
//!
//! Linear lines (decrement, cross-coupling, critical speeds, sensitivity, response to unbalance) count every support bearing at its
//! full stiffness; orbit and force are those of the exact circular orbits, clearances and all.

mod critical_speeds;
mod cross_coupling;
mod decrement;
mod limits;
mod line;
mod orbit;
mod page;
mod sensitivity;
mod unbalance;

use linear::DelayError;
use machine::{CountedModes, MarginsError, PolesError};
use plot::Chart;
use rotor::circular::CircularError;
use rotor::{Rotor, Settings};

pub use cross_coupling::CrossCoupling;
pub use limits::{LIMITS, Limit, Limits};
pub use line::{Asked, Finding, Quantity, Where};
pub use page::{AID, PageWords};
pub use unbalance::{Grade, GradeError};

/// Speeds at which a range is looked at; the worst is sought between them too.
const SPEEDS: usize = 201;

/// What is to be assessed.
#[derive(Clone, Debug)]
pub struct AssessmentCase<'a> {
    /// The rotor.
    pub rotor: &'a Rotor,
    /// Its settings; their speed is not looked at.
    pub settings: &'a Settings,
    /// The speeds that the machine passes, `R`.
    pub over: [f64; 2],
    /// Of them those at which it stays.
    pub operating: [f64; 2],
    /// The mass, counted from 0, to which cross-coupled stiffness is added.
    pub cross_at: usize,
    /// The cross-coupled stiffness that is expected there, `Q_A / K_t`.
    pub cross_stiffness: Option<f64>,
    /// The modes whose damping counts.
    pub modes: CountedModes,
    /// The balance quality that the rotor is made to.
    pub grade: Option<Grade>,
    /// The smallest radial clearance in `e_t`, if it is another than that of the bearings.
    pub clearance: Option<f64>,
    /// The largest force that each control bearing can hold, as `|u|` in `w0^2 e_t` on the mass of the first, if it is another than the
    /// limit of its loop.
    pub force: Option<f64>,
    /// What is asked.
    pub limits: &'a Limits,
}

impl AssessmentCase<'_> {
    /// The smallest clearance there is.
    fn smallest_clearance(&self) -> Option<f64> {
        let set = self.settings.deadband.iter().copied().filter(|g| *g > 0.0).min_by(f64::total_cmp);
        self.clearance.or(set)
    }

    /// Speeds of a range, evenly spaced, both ends among them.
    fn speeds([from, to]: [f64; 2]) -> Vec<f64> {
        let last = (SPEEDS - 1) as f64;
        (0..SPEEDS).map(|k| k as f64 / last).map(|s| from * (1.0 - s) + to * s).collect()
    }
}

/// Why there is nothing to be said.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AssessError {
    /// Poles that cannot be had.
    #[error(transparent)]
    Poles(#[from] PolesError),
    /// Roots that cannot be had.
    #[error(transparent)]
    Roots(#[from] DelayError),
    /// Feedback that does not fit.
    #[error(transparent)]
    Feedback(#[from] control::FeedbackError),
    /// Margins that cannot be had.
    #[error(transparent)]
    Margins(#[from] MarginsError),
    /// Circular orbits that cannot be had.
    #[error(transparent)]
    Orbits(#[from] CircularError),
}

/// The answer.
#[derive(Clone, Debug)]
pub struct Assessment {
    /// Line by line.
    pub lines: Vec<Finding>,
    /// How the rotor bears cross-coupled stiffness at the top of its operating range.
    pub cross_coupling: CrossCoupling,
    /// Curves over speed and over cross-coupled stiffness.
    pub charts: Vec<Chart>,
}

impl Assessment {
    /// Whether every line that could be judged was passed, and any was.
    #[must_use]
    pub fn passed(&self) -> bool {
        let judged: Vec<bool> = self.lines.iter().filter_map(|line| line.passed).collect();
        !judged.is_empty() && judged.iter().all(|passed| *passed)
    }
}

/// Everything that is asked, in the order of the page.
///
/// # Errors
/// A loop that does not fit the rotor, or poles that cannot be had. What a machine cannot be asked (orbits of a sampled loop, say)
/// is a line that says why.
pub fn assess(question: &AssessmentCase<'_>) -> Result<Assessment, AssessError> {
    let (mut lines, mut charts) = decrement::lines(question)?;
    let (found, cross_coupling, chart) = cross_coupling::lines(question)?;
    lines.extend(found);
    charts.extend(chart);
    for part in [critical_speeds::lines, unbalance::lines, orbit::lines, sensitivity::lines] {
        let (found, drawn) = part(question)?;
        lines.extend(found);
        charts.extend(drawn);
    }
    Ok(Assessment { lines, cross_coupling, charts })
}

/// What a part of the page has to say and to show.
type Findings = (Vec<Finding>, Vec<Chart>);
