//! What is shown of a player beside the picture, and the machine beside the recorded one, by the steps of the picture.

use wire::message::{Flags, Trip};

use super::PastEvent;
use super::branch::Branch;
use super::loaded::Loaded;
use super::player::{Player, Repeat};
use crate::picture::Picture;

/// What is shown of a player beside the picture.
#[derive(Clone, Debug)]
pub(crate) struct Show<'a> {
    pub(crate) name: String,
    /// The step we stand at, and the first and the last.
    pub(crate) seq: u64,
    pub(crate) ends: [u64; 2],
    pub(crate) rate: f64,
    pub(crate) playing: bool,
    pub(crate) speed: f64,
    pub(crate) repeat: Repeat,
    pub(crate) events: &'a [PastEvent],
    pub(crate) missing: &'a [std::ops::Range<u64>],
    pub(crate) notices: Vec<String>,
    /// Whether alarms were judged while it was made.
    pub(crate) judged: bool,
    pub(crate) beside: Option<Beside<'a>>,
}

/// The machine that is run on beside the recorded one, by the steps of the picture's track.
#[derive(Clone, Copy)]
pub(crate) struct Beside<'a> {
    branch: &'a Branch,
    loaded: &'a Loaded,
    /// Place of the track's first step.
    first: u64,
    /// The step we stand at.
    seq: u64,
}

impl std::fmt::Debug for Beside<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Beside").field("from", &self.branch.from()).finish_non_exhaustive()
    }
}

impl Beside<'_> {
    /// Displacement `[y, z]` of a mass at step `step` of the track; none before it begins.
    pub(crate) fn place(&self, step: usize, mass: usize) -> Option<[f64; 2]> {
        self.branch.place(self.loaded.seq_of(self.first + step as u64), mass)
    }

    /// Control `[y, z]` at step `step` of the track.
    pub(crate) fn force(&self, step: usize) -> Option<[f64; 2]> {
        self.branch.force(self.loaded.seq_of(self.first + step as u64))
    }

    /// The step from which it runs on.
    pub(crate) fn from(&self) -> u64 {
        self.branch.from()
    }

    /// The dimensionless time from which it runs on.
    pub(crate) fn tau(&self) -> f64 {
        self.branch.tau()
    }

    /// How many steps there are from there to the step we stand at.
    pub(crate) fn way(&self) -> u64 {
        self.seq - self.branch.from()
    }

    /// How many of them it has still to go.
    pub(crate) fn lag(&self) -> u64 {
        self.branch.lag(self.seq)
    }

    /// Its smallest damping ratio, if its poles are known.
    pub(crate) fn min_damping(&self) -> Option<f64> {
        self.branch.judged().map(|judged| judged.min_damping)
    }

    /// What has tripped it.
    pub(crate) fn trip(&self) -> Option<Trip> {
        self.branch.trip()
    }
}

impl Player {
    /// Makes a picture of the feed one of the moment we stand at: what is live elsewhere is of that moment here.
    pub(crate) fn finish(&self, picture: &mut Picture) {
        picture.tripped = picture.now.is_some_and(|now| picture.track.flags(now).has(Flags::TRIPPED));
        picture.lost = self.missing.iter().map(|gap| self.seq().min(gap.end).saturating_sub(gap.start)).sum();
        picture.rate = if self.is_playing() { self.rate() * self.speed() } else { 0.0 };
        picture.age = None;
    }

    /// What is shown of it beside the picture.
    pub(crate) fn shown(&self, picture: &Picture) -> Show<'_> {
        let beside = |branch| Beside { branch, loaded: &self.loaded, first: picture.track.first(), seq: self.seq() };
        Show {
            name: self.name(),
            seq: self.seq(),
            ends: self.ends(),
            rate: self.rate(),
            playing: self.is_playing(),
            speed: self.speed(),
            repeat: self.repeat,
            events: &self.events,
            missing: &self.missing,
            notices: self.notices(),
            judged: self.judged,
            beside: self.branch.as_ref().map(beside),
        }
    }
}
