//! Analysis that the simulation does not send along: poles and damping over speed, what settings and clearances do, margins, spectra, run-ups. Too long for the drawing thread,
//! so it is asked for there and computed by [`Jobs`].

mod damping_map;
mod deadband;
mod latest_answer;
pub mod loop_analysis;
pub mod pole_trace;
pub mod run_up;
mod slopes;
mod spectra;

use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::Sender;

pub use damping_map::{DampingMap, DampingMapRequest};
pub use deadband::{DeadbandEffects, DeadbandRequest, LimitCycle};
pub use latest_answer::LatestAnswer;
pub use loop_analysis::{LoopAnalysis, LoopRequest};
pub use pole_trace::{PoleTrace, PoleTraceRequest};
pub use run_up::{RunUpRequest, SpeedLegs};
pub use slopes::{SettingSlopes, SlopeRequest};
pub use spectra::{OrbitSpectrum, SpectrumRequest, Waterfall, WaterfallOrder, WaterfallRequest, WaterfallRow};

/// How long a frame may wait for what a person is typing at this moment.
const PART_OF_A_FRAME: Duration = Duration::from_millis(12);

/// What is being computed for the panels. Asking hardly waits: it brings the newest answer there is.
#[derive(Debug)]
pub struct Jobs {
    current: LatestAnswer<PoleTraceRequest, PoleTrace>,
    candidate: LatestAnswer<PoleTraceRequest, PoleTrace>,
    deadband: LatestAnswer<DeadbandRequest, DeadbandEffects>,
    opened: LatestAnswer<LoopRequest, LoopAnalysis>,
    opened_candidate: LatestAnswer<LoopRequest, LoopAnalysis>,
    opened_watched: LatestAnswer<LoopRequest, LoopAnalysis>,
    run_up: LatestAnswer<RunUpRequest, SpeedLegs>,
    slopes: LatestAnswer<SlopeRequest, SettingSlopes>,
    map: LatestAnswer<DampingMapRequest, DampingMap>,
    spectrum: LatestAnswer<SpectrumRequest, OrbitSpectrum>,
    waterfalls: [LatestAnswer<WaterfallRequest, Waterfall>; 2],
}

impl Jobs {
    /// Jobs on threads of its own, which end with it. Every answer puts a token into `wake`.
    ///
    /// # Errors
    /// No thread can be started.
    pub fn start(wake: &Sender<()>) -> std::io::Result<Self> {
        let wake = {
            let wake = wake.clone();
            move || {
                // A token that still lies there will do.
                let _ = wake.try_send(());
            }
        };
        Ok(Self {
            current: LatestAnswer::spawn("over-speed", PoleTrace::of, wake.clone())?,
            candidate: LatestAnswer::spawn("what-if", PoleTrace::of, wake.clone())?,
            deadband: LatestAnswer::spawn("deadband", DeadbandEffects::of, wake.clone())?,
            opened: LatestAnswer::spawn("loop", LoopAnalysis::of, wake.clone())?,
            opened_candidate: LatestAnswer::spawn("loop", LoopAnalysis::of, wake.clone())?,
            opened_watched: LatestAnswer::spawn("loop", LoopAnalysis::of, wake.clone())?,
            run_up: LatestAnswer::spawn("run-up", SpeedLegs::of, wake.clone())?,
            slopes: LatestAnswer::spawn("slopes", SettingSlopes::of, wake.clone())?,
            map: LatestAnswer::spawn("map", DampingMap::of, wake.clone())?,
            spectrum: LatestAnswer::spawn("spectrum", OrbitSpectrum::of, wake.clone())?,
            waterfalls: [
                LatestAnswer::spawn("waterfall", Waterfall::of, wake.clone())?,
                LatestAnswer::spawn("waterfall", Waterfall::of, wake)?,
            ],
        })
    }

    /// Jobs that are done at once, on the thread that asks: for screenshots and tests.
    pub fn inline() -> Self {
        Self {
            current: LatestAnswer::inline(PoleTrace::of),
            candidate: LatestAnswer::inline(PoleTrace::of),
            deadband: LatestAnswer::inline(DeadbandEffects::of),
            opened: LatestAnswer::inline(LoopAnalysis::of),
            opened_candidate: LatestAnswer::inline(LoopAnalysis::of),
            opened_watched: LatestAnswer::inline(LoopAnalysis::of),
            run_up: LatestAnswer::inline(SpeedLegs::of),
            slopes: LatestAnswer::inline(SettingSlopes::of),
            map: LatestAnswer::inline(DampingMap::of),
            spectrum: LatestAnswer::inline(OrbitSpectrum::of),
            waterfalls: [LatestAnswer::inline(Waterfall::of), LatestAnswer::inline(Waterfall::of)],
        }
    }

    /// Poles and damping over speed of the settings in force; for a moment, of those before.
    pub fn pole_trace(&self, question: &PoleTraceRequest) -> Option<Arc<PoleTrace>> {
        self.current.ask(question)
    }

    /// The same of settings that would be: theirs and no others. Waits a part of a frame; nothing if it takes longer.
    pub fn pole_trace_of_candidate(&self, question: &PoleTraceRequest) -> Option<Arc<PoleTrace>> {
        self.candidate.ask_for(question, PART_OF_A_FRAME)
    }

    /// What the clearances make of the settings in force; for a moment, of those before.
    pub fn deadband(&self, question: &DeadbandRequest) -> Option<Arc<DeadbandEffects>> {
        self.deadband.ask(question)
    }

    /// The loop under the settings of the moment that is looked at; for a moment, of those before.
    pub fn opened(&self, question: &LoopRequest) -> Option<Arc<LoopAnalysis>> {
        self.opened.ask(question)
    }

    /// The same of settings that would be: theirs and no others. Waits a part of a frame; nothing if it takes longer.
    pub fn opened_of_candidate(&self, question: &LoopRequest) -> Option<Arc<LoopAnalysis>> {
        self.opened_candidate.ask_for(question, PART_OF_A_FRAME)
    }

    /// The same of the settings in force, whatever is looked at: for alarms.
    pub fn opened_watched(&self, question: &LoopRequest) -> Option<Arc<LoopAnalysis>> {
        self.opened_watched.ask(question)
    }

    /// What settings do to the smallest damping; for a moment, what those before did.
    pub fn slopes(&self, question: &SlopeRequest) -> Option<Arc<SettingSlopes>> {
        self.slopes.ask(question)
    }

    /// The smallest damping around settings; for a moment, around those before.
    pub fn damping_map(&self, question: &DampingMapRequest) -> Option<Arc<DampingMap>> {
        self.map.ask(question)
    }

    /// The first order over the speeds that were run through; for a moment, an earlier answer.
    pub fn run_up(&self, question: &RunUpRequest) -> Option<Arc<SpeedLegs>> {
        self.run_up.ask(question)
    }

    /// The spectrum of an orbit; for a moment, of an earlier one.
    pub fn spectrum(&self, orbit: &SpectrumRequest) -> Option<Arc<OrbitSpectrum>> {
        self.spectrum.ask(orbit)
    }

    /// Rows of spectra; for a moment, earlier ones.
    pub fn waterfall(&self, fall: &WaterfallRequest) -> Option<Arc<Waterfall>> {
        let [time, speed] = &self.waterfalls;
        match fall.over {
            WaterfallOrder::Time => time.ask(fall),
            WaterfallOrder::Speed => speed.ask(fall),
        }
    }
}
