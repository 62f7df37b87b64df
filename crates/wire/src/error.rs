//! What can go wrong at a process border, in words for the person at the terminal.

use std::path::PathBuf;

use crate::BenchName;

/// Why a port could not be opened or used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WireError {
    /// Not a name that a bench can have.
    #[error("bench '{0}': expected 1 to 32 letters, digits, '-', '_' or '.', beginning with a letter or digit")]
    BenchName(String),
    /// Nobody simulates under this name.
    #[error("no bench '{0}' is running: start one with `whirl sim --bench {0}`, or see `whirl status`")]
    NoBench(BenchName),
    /// Somebody else simulates under this name.
    #[error("bench '{0}' is taken by a running simulation: choose another with --bench NAME, or see `whirl status`")]
    Taken(BenchName),
    /// Somebody else records this bench.
    #[error("bench '{0}' is being recorded already: see `whirl status`")]
    Recorded(BenchName),
    /// Somebody else controls this bench from outside.
    #[error("bench '{0}' is controlled from outside already: see `whirl status`")]
    Controlled(BenchName),
    /// The bench speaks another schema version, or another version of iceoryx2.
    #[error("bench '{bench}' was started by another version of whirl ({detail}): use the same version on both sides")]
    Version {
        /// The bench.
        bench: BenchName,
        /// How it was noticed.
        detail: String,
    },
    /// The bench has as many readers or clients as it can take.
    #[error("bench '{bench}' is full: it has the {most} {what} that it can take; end one, `whirl status` lists them")]
    Full {
        /// The bench.
        bench: BenchName,
        /// What there is no room for.
        what: &'static str,
        /// How many of them it can take.
        most: usize,
    },
    /// A process died while it set up or used the bench.
    #[error("bench '{bench}' was left behind half-made ({detail}): run `whirl clean`")]
    LeftBehind {
        /// The bench.
        bench: BenchName,
        /// How it was noticed.
        detail: String,
    },
    /// The folder for shared memory cannot be used.
    #[error("{}: {problem}: set WHIRL_ROOT to a folder of your own", path.display())]
    Root {
        /// The folder.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The simulation did not answer in time.
    #[error("bench '{0}' did not answer: it may be stopped or overloaded, see `whirl status`")]
    NoAnswer(BenchName),
    /// Settings that do not fit in a message.
    #[error("{0}")]
    DoesNotFit(String),
    /// Anything else, as iceoryx2 names it.
    #[error("shared memory: {0}")]
    Internal(String),
}
