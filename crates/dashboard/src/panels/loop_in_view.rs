//! What the panels of the loop have in common: the loop at the moment that is looked at, beside the one that would be.

use std::sync::Arc;

use machine::MarginsError;
use telemetry::jobs::{LoopAnalysis, LoopRequest};
use telemetry::units::ScreenUnits;
use text::number::short;

use crate::view::View;

/// The loop in view.
#[derive(Clone, Debug)]
pub(super) struct LoopInView {
    /// Under the settings of the moment that is looked at, at its speed.
    pub(super) now: Arc<LoopAnalysis>,
    /// Under what is being typed or offered, once that is computed.
    pub(super) candidate: Option<Arc<LoopAnalysis>>,
    /// The speed, in units of `w0`.
    pub(super) speed: f64,
}

impl LoopInView {
    /// What is known of it; nothing as long as the rotor is not, and for a moment after that.
    pub(super) fn of(view: &View<'_>) -> Option<Self> {
        let request = LoopRequest::of(view.data.era.as_ref()?)?;
        let now = view.jobs.opened(&request)?;
        let would_be = view.what_if.map(|what_if| request.with(&what_if.settings));
        let candidate = would_be.and_then(|request| view.jobs.opened_of_candidate(&request));
        Some(Self { now, candidate, speed: request.speed })
    }
}

/// Why there are no margins, in a few words.
pub(super) fn why_none(error: &MarginsError, units: &ScreenUnits) -> String {
    match error {
        MarginsError::Unstable { pole, .. } => {
            let [re, im] = [pole.re, pole.im].map(|part| short(part * units.rate.factor, 4));
            let plus = if pole.im < 0.0 { "" } else { "+" };
            format!("UNSTABLE: pole {re} {plus}{im}j")
        }
        MarginsError::Poles(error) => error.to_string(),
    }
}
