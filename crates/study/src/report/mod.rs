//! The NASA report again: every figure as chart and data, every printed number beside ours, and one page about both.
//!
//! [`make`] computes everything; [`Report::markdown`] and [`Report::html`] are the page, and [`mod@write`] puts all of it into
//! a folder. Where the report is silent, damaged or wrong, and what is a reconstruction, the page says so; the list is in
//! `corrections`. Gains over speed (Figs. 4.7 to 4.11), and how far gains reach, come from the gain search of the crate `tuner`.

mod chapter3;
mod chapter4;
mod chapter4_tracked;
mod compare;
mod corrections;
mod criteria;
mod data;
mod evidence;
mod figure;
mod figures;
mod force_chart;
mod motion;
mod numbers;
mod numbers4;
mod numbers_search;
mod orbit_chart;
mod page;
mod pole_chart;
mod searched;
mod shape_chart;
mod spectrum_chart;
pub mod write;

use std::sync::atomic::AtomicBool;

use rotor::{PoleError, TraceError};

pub use compare::{Comparison, Ours, Printed, Verdict};
pub use data::Data;
pub use figure::Figure;

use plot::RasterError;

use crate::force::ForceError;
use crate::run::RunError;
use crate::spectrum::SpectrumError;

/// Who looks on while a report is made.
#[derive(Clone, Copy)]
pub struct Onlooker<'a> {
    /// Raised to stop.
    pub stop: &'a AtomicBool,
    /// Called after every one of [`steps`], from any thread.
    pub done: &'a (dyn Fn() + Sync),
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// Poles that cannot be computed.
    #[error(transparent)]
    Poles(#[from] PoleError),
    /// Orbits that cannot be had.
    #[error(transparent)]
    Orbits(#[from] rotor::circular::CircularError),
    /// A machine that cannot be stepped.
    #[error(transparent)]
    Program(#[from] machine::ProgramError),
    /// Poles that cannot be followed.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// A simulation that failed.
    #[error(transparent)]
    Run(RunError),
    /// A spectrum of too little.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
    /// A picture that cannot be drawn.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// A file that is there and is to be kept, or one that cannot be written.
    #[error(transparent)]
    File(#[from] files::FileError),
    /// A file that cannot be written.
    #[error("cannot write '{}': {error}", path.display())]
    Write {
        /// Which file.
        path: std::path::PathBuf,
        /// Why.
        error: std::io::Error,
    },
}

impl From<RunError> for ReportError {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Interrupted => Self::Interrupted,
            other => Self::Run(other),
        }
    }
}

impl From<ForceError> for ReportError {
    fn from(error: ForceError) -> Self {
        match error {
            ForceError::Program(error) => error.into(),
            ForceError::Run(error) => error.into(),
        }
    }
}

/// All of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The figures, in the report's order.
    pub figures: Vec<Figure>,
    /// The printed numbers and claims, in the report's order.
    pub comparisons: Vec<Comparison>,
}

/// How many steps [`make`] tells its onlooker of.
#[must_use]
pub fn steps() -> usize {
    evidence::steps()
}

/// How many more [`write::folder`] tells its onlooker of.
#[must_use]
pub fn steps_of_files() -> usize {
    write::FILES_PER_FIGURE * figures::count() + write::PAGES
}

/// Computes all of it, on all cores.
///
/// # Errors
/// A computation that does not converge, or a request to stop.
pub fn make(onlooker: &Onlooker<'_>) -> Result<Report, ReportError> {
    let evidence = evidence::Evidence::gather(onlooker)?;
    Ok(Report { figures: figures::all(&evidence)?, comparisons: numbers::all(&evidence)? })
}
