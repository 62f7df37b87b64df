//! What is shown of a player beside the picture, and the machine beside the recorded one, by the steps of the picture.

use wire::message::{Flags, Trip};

use super::PastEvent;
use super::branch::Branch;
use super::loaded::Loaded;
use super::player::{Player, Repeat};
use crate::frame_data::Picture;

/// What is shown of a player beside the picture.
#[derive(Clone, Debug)]
pub struct Show<'a> {
    /// What it is called.
    pub name: String,
    /// The number of the step we stand at.
    pub seq: u64,
    /// The numbers of the first step and the last.
    pub ends: [u64; 2],
    /// Steps a second when it was recorded.
    pub rate: f64,
    /// Whether it moves on by itself.
    pub playing: bool,
    /// How fast, in times the speed at which it was recorded.
    pub speed: f64,
    /// The part that is played over and over.
    pub repeat: Repeat,
    /// What happened, in order.
    pub events: &'a [PastEvent],
    /// Steps that are not on file.
    pub missing: &'a [std::ops::Range<u64>],
    /// What is to be told about the recording.
    pub notices: Vec<String>,
    /// Whether alarms were judged while it was made.
    pub judged: bool,
    /// The machine that is run on beside it, if there is one.
    pub beside: Option<Beside<'a>>,
}

/// The machine that is run on beside the recorded one, by the steps of the picture's track.
#[derive(Clone, Copy)]
pub struct Beside<'a> {
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
    pub fn place(&self, step: usize, mass: usize) -> Option<[f64; 2]> {
        self.branch.place(self.loaded.seq_of(self.first + step as u64), mass)
    }

    /// Control `[y, z]` at step `step` of the track.
    pub fn force(&self, step: usize) -> Option<[f64; 2]> {
        self.branch.force(self.loaded.seq_of(self.first + step as u64))
    }

    /// The step from which it runs on.
    pub fn from(&self) -> u64 {
        self.branch.from()
    }

    /// The dimensionless time from which it runs on.
    pub fn tau(&self) -> f64 {
        self.branch.tau()
    }

    /// How many steps there are from there to the step we stand at.
    pub fn way(&self) -> u64 {
        self.seq - self.branch.from()
    }

    /// How many of them it has still to go.
    pub fn lag(&self) -> u64 {
        self.branch.lag(self.seq)
    }

    /// Its smallest damping ratio, if its poles are known.
    pub fn min_damping(&self) -> Option<f64> {
        self.branch.judged().map(|judged| judged.min_damping)
    }

    /// What has tripped it.
    pub fn trip(&self) -> Option<Trip> {
        self.branch.trip()
    }
}

impl Player {
    /// Makes a picture of the feed one of the moment we stand at: what is live elsewhere is of that moment here.
    pub fn finish(&self, picture: &mut Picture) {
        picture.tripped = picture.now.is_some_and(|now| picture.track.flags(now).has(Flags::TRIPPED));
        picture.lost = self.missing.iter().map(|gap| self.seq().min(gap.end).saturating_sub(gap.start)).sum();
        picture.rate = if self.is_playing() { self.rate() * self.speed() } else { 0.0 };
        picture.age = None;
    }

    /// What is shown of it beside the picture.
    pub fn shown(&self, picture: &Picture) -> Show<'_> {
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
