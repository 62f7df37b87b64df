//! What of a recording is kept.

use files::Existing;
use wire::Keeping;

/// What is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Keep {
    /// Everything, the last so many seconds, or so many before a trip.
    pub keeping: Keeping,
    /// A new file whenever one has so many bytes.
    pub split: Option<u64>,
    /// Recording ends in good order when the disk has fewer bytes free than this.
    pub min_free: u64,
    /// What becomes of files that are there already.
    pub existing: Existing,
}

impl Keep {
    /// The free space that a recording leaves on its disk unless told otherwise, in bytes.
    pub const MIN_FREE: u64 = 200_000_000;
    /// A rolling recording is this many files, so that it is longer than asked for by at most one of them.
    pub(super) const ROLLING_PARTS: f64 = 8.0;
    /// A trip is followed no longer than this, in seconds.
    pub const AFTER_TRIP: f64 = 10.0;

    /// How long a trip is followed, in seconds, where so many before it are kept: as long, but no longer than
    /// [`Keep::AFTER_TRIP`].
    #[must_use]
    pub fn after_trip(before: f64) -> f64 {
        before.min(Self::AFTER_TRIP)
    }
}

impl Default for Keep {
    fn default() -> Self {
        Self { keeping: Keeping::All, split: None, min_free: Self::MIN_FREE, existing: Existing::Keep }
    }
}
