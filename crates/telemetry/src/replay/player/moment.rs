//! The moment that is shown: the steps around it in the feed, the settings in force, and how alarms stood.

use alarms::{Alarms, Level, Watch};
use rotor::ControlMasses;
use wire::{BenchStatus, SettingsDocument};

use super::Player;
use crate::feed::Feed;
use crate::replay::ReplayError;
use crate::view_time::ViewTime;

/// Seconds before the moment that are at hand: what the longest panel shows.
const LOOK_BACK: f64 = 61.0;
/// Steps before the moment that are at hand at least, and at most.
const BACK: [u64; 2] = [10_500, 250_000];
/// Steps that are fetched ahead at once.
const AHEAD: u64 = 2_000;
/// Steps that are fetched in passing, while there is nothing else to do.
const IN_PASSING: u64 = 10_000;

impl Player {
    /// Sees to it that the feed has the steps around the moment, and that everything shows that moment.
    pub(super) fn show(&mut self, feed: &mut Feed, time: &mut ViewTime, jumped: bool) -> Result<(), ReplayError> {
        let seq = self.seq();
        let back = (LOOK_BACK * self.rate) as u64;
        let back = back.max(time.steps(1.0 / self.rate)).clamp(BACK[0], BACK[1]);
        // What comes ahead needs room too.
        let back = back.min(feed.history().capacity_for(self.masses) / 2);
        self.loaded.let_go(feed);
        let wanted = seq.saturating_sub(back).max(self.ends[0])..seq + 1;
        if !(self.loaded.range().contains(&wanted.start) && self.loaded.range().end > seq) {
            let wanted = wanted.start..(wanted.end + AHEAD).min(self.ends[1] + 1);
            self.loaded.cover(&mut *self.past, feed, &wanted)?;
            self.reads_on = true;
        }
        if let Some(place) = self.loaded.index_of(seq) {
            let kept = feed.history().kept();
            if jumped {
                time.jump_to(place.clamp(kept.start, kept.end.saturating_sub(1)));
            } else {
                time.look_at(place, &kept, 1.0 / self.rate);
            }
        }
        let mut bench_status = self.past.bench_status_at(seq);
        if self.branch.is_some() {
            let acts = self.gathered();
            if let Some(branch) = &mut self.branch {
                branch.advance(wanted.start..seq + 1, &acts);
                // What edits apply to is what is in force beside, once there is something beside.
                bench_status.settings = SettingsDocument::of(branch.settings());
            }
            self.acts = Some(acts);
        }
        self.recall_alarms(seq, &bench_status, feed);
        feed.set_present(bench_status);
        Ok(())
    }

    /// Has alarms stand as they stood at step `seq`.
    fn recall_alarms(&mut self, seq: u64, bench_status: &BenchStatus, feed: &Feed) {
        let turned = self.turns.partition_point(|turn| turn.at.seq <= seq);
        if self.alarms.0 != turned {
            self.alarms = (turned, Alarms::recalled(self.limits.clone(), &self.turns[..turned]));
        }
        let alarms = &mut self.alarms.1;
        alarms.learn(bench_status);
        let place = self.loaded.index_of(seq);
        let track = place.map(|place| feed.history().track(&(place..place + 1))).filter(|track| !track.is_empty());
        let [mut orbit, mut force] = [None; 2];
        if let Some(track) = track {
            let radii = (0..track.masses()).map(|mass| track.displacement(0, mass)).map(|[y, z]| y.hypot(z));
            orbit = Some(radii.fold(0.0, f64::max));
            let feedback = &bench_status.settings.get().feedback;
            let masses = bench_status.rotor_document().map(|rotor| ControlMasses::of(rotor.get(), feedback));
            let delivered = (0..track.layout().bearings()).map(|bearing| track.forces(0, bearing)[1]);
            force = Some(masses.unwrap_or_default().largest(delivered.map(|[y, z]| y.hypot(z))));
        }
        let damping = (bench_status.analysis.count > 0).then_some(bench_status.analysis.min_damping);
        // Margins, and shares and counts over a stretch of time are known where they crossed a limit, and nowhere else.
        let past = |watch: Watch| alarms.standings().find(|(of, ..)| *of == watch).map(|(_, standing, _)| standing);
        let kept = |watch| past(watch).filter(|standing| standing.at > Level::Fine).and_then(|standing| standing.value);
        let values = Watch::ALL.map(|watch| match watch {
            Watch::Trip => Some(f64::from(u8::from(bench_status.trip.is_tripped()))),
            Watch::Damping => damping,
            Watch::Orbit => orbit,
            Watch::Force => force,
            Watch::Sensitivity | Watch::DelayMargin | Watch::Saturation | Watch::Lateness | Watch::Losses => {
                kept(watch)
            }
        });
        Watch::ALL.into_iter().zip(values).for_each(|(watch, value)| alarms.see(watch, value));
    }

    /// While paused the recording is read on, as far as there is room: going there is then immediate.
    pub(super) fn fetch_in_passing(&mut self, feed: &mut Feed) -> Result<(), ReplayError> {
        let range = self.loaded.range();
        let steps = self.ends[1] + 1 - range.start.min(self.ends[1]);
        self.reads_on = range.end <= self.ends[1] && feed.history().capacity_for(self.masses) >= steps;
        if !self.reads_on {
            return Ok(());
        }
        let end = (range.end + IN_PASSING).min(self.ends[1] + 1);
        self.loaded.extend(&mut *self.past, feed, end)
    }
}
