//! What is shown of a player beside the data of the frame, and the machine run beside the recorded one, by the steps of that data.

use wire::Channel;
use wire::message::{Flags, Trip};

use super::RecordedEvent;
use super::branch::Branch;
use super::loaded_steps::LoadedSteps;
use super::player::{LoopRange, Player};
use crate::frame_data::FrameData;
use crate::history::StepQuantity;

/// What is shown of a player beside the data of the frame.
#[derive(Clone, Debug)]
pub struct ReplayStatus<'a> {
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
    pub repeat: LoopRange,
    /// What happened, in order.
    pub events: &'a [RecordedEvent],
    /// Steps that are not on file.
    pub missing: &'a [std::ops::Range<u64>],
    /// What is to be told about the recording.
    pub notices: Vec<String>,
    /// Whether alarms were judged while it was made.
    pub judged: bool,
    /// The machine that is run on beside it, if there is one.
    pub beside: Option<WhatIfRun<'a>>,
}

/// The machine that is run on beside the recorded one, by the steps of the frame's track.
#[derive(Clone, Copy)]
pub struct WhatIfRun<'a> {
    branch: &'a Branch,
    loaded: &'a LoadedSteps,
    /// Place of the track's first step.
    first: u64,
    /// The step we stand at.
    seq: u64,
}

impl std::fmt::Debug for WhatIfRun<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WhatIfRun").field("from", &self.branch.from()).finish_non_exhaustive()
    }
}

impl WhatIfRun<'_> {
    /// Displacement `[y, z]` of a mass at step `step` of the track; none before it begins.
    pub fn displacement(&self, step: usize, mass: usize) -> Option<[f64; 2]> {
        self.branch.displacement(self.loaded.seq_of(self.first + step as u64), mass)
    }

    /// Control `[y, z]` of a control bearing, counted from 0, at step `step` of the track.
    pub fn force(&self, step: usize, bearing: usize) -> Option<[f64; 2]> {
        self.branch.force(self.loaded.seq_of(self.first + step as u64), bearing)
    }

    /// A quantity at step `step` of the track: of displacements and of the control; nothing of any other.
    pub fn value(&self, quantity: StepQuantity, step: usize) -> Option<f64> {
        let size = |[y, z]: [f64; 2]| y.hypot(z);
        match quantity {
            StepQuantity::Of(Channel::Y, mass) => self.displacement(step, mass).map(|[y, _]| y),
            StepQuantity::Of(Channel::Z, mass) => self.displacement(step, mass).map(|[_, z]| z),
            StepQuantity::Of(Channel::ForceY | Channel::FurtherForceY, _) => {
                self.force(step, quantity.bearing()?).map(|[y, _]| y)
            }
            StepQuantity::Of(Channel::ForceZ | Channel::FurtherForceZ, _) => {
                self.force(step, quantity.bearing()?).map(|[_, z]| z)
            }
            StepQuantity::Size(..) if quantity.bearing().is_some_and(|k| quantity == StepQuantity::force(k)) => {
                self.force(step, quantity.bearing()?).map(size)
            }
            StepQuantity::Size(_, mass) if quantity == StepQuantity::radius(mass) => {
                self.displacement(step, mass).map(size)
            }
            _ => None,
        }
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
    pub fn length(&self) -> u64 {
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
    /// Adapts the data of a frame to a recording: what is of the present on a live bench is of the moment we stand at here.
    pub fn adapt(&self, data: &mut FrameData) {
        data.tripped = data.now.is_some_and(|now| data.track.flags(now).has(Flags::TRIPPED));
        data.lost = self.missing.iter().map(|gap| self.seq().min(gap.end).saturating_sub(gap.start)).sum();
        data.rate = if self.is_playing() { self.rate() * self.speed() } else { 0.0 };
        data.age = None;
    }

    /// What is shown of it beside the data of the frame.
    pub fn status(&self, data: &FrameData) -> ReplayStatus<'_> {
        let beside = |branch| WhatIfRun { branch, loaded: &self.loaded, first: data.track.first(), seq: self.seq() };
        ReplayStatus {
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
