//! What one frame is drawn from: all panels look at the same moment, the one under the cursor.

use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use rotor::{C64, ControlMasses, MAX_BEARINGS, Rotor, Settings};
use wire::message::Trip;
use wire::{BenchStatus, RecorderStatus};

use crate::connection::Connection;
use crate::event_log::LoggedEvent;
use crate::history::{Era, Mark, StepQuantity, Track};
use crate::units::ScreenUnits;

/// What one frame is drawn from. Everything is at the cursor's moment, unless it says that it is live.
#[derive(Clone, Debug)]
pub struct FrameData {
    /// Steps around the window and before the cursor.
    pub track: Track,
    /// Live: all steps that are kept.
    pub kept: Track,
    /// The steps in view.
    pub window: Range<usize>,
    /// A longer look back, for what changes slowly: a minute, or the window if that is longer; ends with the window.
    pub overview: Range<usize>,
    /// The step under the cursor: while live, the newest.
    pub now: Option<usize>,
    /// The settings and poles in force at the cursor.
    pub era: Option<Arc<Era>>,
    /// Those in force over the overview, each with the first step that it holds for.
    pub eras: Vec<(usize, Arc<Era>)>,
    /// What happened during the overview, each before the step of that number.
    pub marks: Vec<(usize, Mark)>,
    /// The largest control of every bearing between the last change of settings or restart and the cursor.
    pub peak_forces: [f64; MAX_BEARINGS],
    /// Seconds from step to step, as the simulation means it; 0 while unknown.
    pub seconds: f64,
    /// Live: the settings in force, once they are known.
    pub settings: Option<Settings>,
    /// Live: the rotor, once it is known.
    pub rotor: Option<Arc<Rotor>>,
    /// Live: the latest bench status.
    pub bench_status: Option<Arc<BenchStatus>>,
    /// Live: what has happened, the oldest first.
    pub events: Arc<Vec<LoggedEvent>>,
    /// Live: steps that were sent and did not reach us.
    pub lost: u64,
    /// Live: steps a second that reach us.
    pub rate: f64,
    /// Live: age of the latest step.
    pub age: Option<Duration>,
    /// Live: how things stand.
    pub connection: Connection,
    /// Live: what is known of a recorder.
    pub recorder: Option<Box<RecorderStatus>>,
    /// A recorder was started here, and has not spoken up yet.
    pub recorder_starts: bool,
    /// Live: whether the machine has tripped.
    pub tripped: bool,
    /// Steps from the cursor to the newest one.
    pub behind: u64,
}

impl FrameData {
    /// How many masses have been heard of.
    pub fn masses(&self) -> usize {
        self.track.masses()
    }

    /// The minimum damping and the poles, least damped first, if they are known.
    pub fn poles(&self) -> Option<(f64, &[C64])> {
        let era = self.era.as_ref()?;
        (!era.poles.is_empty()).then_some((era.min_damping, &era.poles))
    }

    /// The least damped of the poles that count, whose damping is the minimum damping.
    pub fn least_damped(&self) -> Option<C64> {
        let (least, poles) = self.poles()?;
        let away = |pole: &C64| (rotor::damping_ratio(*pole) - least).abs();
        poles.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b)))
    }

    /// What turns control into a force at each control bearing.
    pub fn masses_of_bearings(&self) -> ControlMasses {
        let masses = self.era.as_ref().and_then(|era| {
            let rotor = era.rotor.as_ref().or(self.rotor.as_ref())?;
            Some(ControlMasses::of(rotor, &era.settings.feedback))
        });
        masses.unwrap_or_default()
    }

    /// The units that things are shown in.
    pub fn units(&self) -> ScreenUnits {
        let scales = self.bench_status.as_ref().and_then(|bench_status| bench_status.scales());
        // Before the first step no era is known, but the scales may be.
        ScreenUnits::of(scales, self.masses_of_bearings())
    }

    /// The largest of [`FrameData::peak_forces`], as that of the first control bearing.
    pub fn peak_force(&self) -> f64 {
        self.masses_of_bearings().largest(self.peak_forces)
    }

    /// How many times its number a quantity counts in the unit of its kind: the control of each bearing is a force of its own.
    pub fn factor_of(&self, quantity: StepQuantity) -> f64 {
        quantity.bearing().map_or(1.0, |bearing| self.units().factor_of(bearing))
    }

    /// The mass that is looked at where nobody has chosen one, counted from 0: the one with the first control bearing.
    pub fn bearing_mass(&self) -> usize {
        self.era.as_ref().map_or(0, |era| era.settings.feedback.first().station)
    }

    /// The least minimum damping that was in force over some steps, if any is known.
    pub fn least_damping(&self, steps: &Range<usize>) -> Option<f64> {
        let from = self.eras.partition_point(|(first, _)| *first <= steps.start).saturating_sub(1);
        let over = self.eras.iter().skip(from).take_while(|(first, _)| *first < steps.end.max(steps.start + 1));
        over.filter(|(_, era)| !era.poles.is_empty()).map(|(_, era)| era.min_damping).reduce(f64::min)
    }

    /// The era in force at the first of some steps.
    pub fn era_of(&self, steps: &Range<usize>) -> Option<&Arc<Era>> {
        let at = self.eras.partition_point(|(first, _)| *first <= steps.start).checked_sub(1)?;
        self.eras.get(at).map(|(_, era)| era)
    }

    /// The trip, while there is one; live.
    pub fn trip(&self) -> Option<Trip> {
        self.bench_status.as_ref().map(|bench_status| bench_status.trip).filter(Trip::is_tripped)
    }

    /// How long before the newest step the cursor is.
    pub fn ago(&self) -> Duration {
        Duration::from_secs_f64((self.behind as f64 * self.seconds).clamp(0.0, 1e9))
    }
}
