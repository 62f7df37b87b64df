//! All figures, in the report's order.

use super::evidence::Evidence;
use super::figure::{Entry, Figure};
use super::{ReportError, chapter3, chapter4, chapter4_tracked};

/// How many there are.
pub(super) fn count() -> usize {
    chapter3::FIGURES.len() + chapter4::FIGURES.len() + chapter4_tracked::FIGURES.len()
}

/// Every figure.
///
/// # Errors
/// Poles that cannot be computed.
pub(super) fn all(evidence: &Evidence) -> Result<Vec<Figure>, ReportError> {
    let (open, constant) = chapter4::FIGURES.split_at(chapter4::UNCONTROLLED);
    let entries = chapter3::FIGURES.iter().chain(open).chain(&chapter4_tracked::FIGURES).chain(constant);
    entries
        .map(|entry| {
            let (chart, data) = (entry.make)(evidence, &format!("Fig. {}  {}", entry.number, entry.title))?;
            let &Entry { number, title, caption, agreement, .. } = entry;
            Ok(Figure { number, title, caption, agreement, chart, data })
        })
        .collect()
}
