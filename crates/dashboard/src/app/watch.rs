//! Alarms on a live bench: what has come in is held against the limits, and a run-up may be stopped by what rises.

use alarms::{Level, LevelChange, Watch};
use rotor::Settings;
use telemetry::edits::Edit;
use telemetry::history::StepQuantity;
use telemetry::reader::lock;
use wire::Channel;

use super::App;
use crate::on_alarm::OnAlarm;

impl App<'_> {
    /// Holds what has come in against the limits: alarms go on while the view stands, and no peak falls between two
    /// looks. Returns whether an alarm rose or fell.
    pub(crate) fn watch_alarms(&mut self) -> bool {
        // What a recording tells is past, and comes in any order.
        if self.player.is_some() {
            return false;
        }
        let (mut reading, loop_in_force) = {
            let mut feed = lock(&self.feed);
            if let Some(bench_status) = feed.bench_status() {
                self.alarms.learn(bench_status);
            }
            (feed.take_alarm_reading(), feed.loop_request())
        };
        let is_watched = |watch: Watch| self.alarms.limits().of(watch).is_some();
        if (is_watched(Watch::Sensitivity) || is_watched(Watch::DelayMargin))
            && let Some(opened) = loop_in_force.and_then(|request| self.jobs.opened_watched(&request))
        {
            match opened.peak() {
                Some((peak, _)) => reading.set_margins(peak, opened.delay()),
                None => reading.set_no_margins(),
            }
        }
        let turns = self.alarms.read(&reading);
        self.rings |= self.alarms.has_risen() && self.bell;
        if let Some(turn) = turns.iter().find(|turn| is_of_the_machine(turn))
            && let Some(edit) = self.stop_run_up(turn.watch)
        {
            self.send(edit);
        }
        !turns.is_empty()
    }

    /// What an alarm does to a speed that rises, if anything.
    fn stop_run_up(&self, watch: Watch) -> Option<Edit> {
        if self.on_alarm == OnAlarm::GoOn || self.read_only || self.locked {
            return None;
        }
        let (speed, rate) = self.present_motion()?;
        let present = self.settings().filter(|_| rate > 0.0)?;
        let (wanted, what) = match self.on_alarm {
            OnAlarm::CoastDown => (Settings { speed: 0.0, ramp: rate, ..present.clone() }, "the speed coasts down"),
            _ => (Settings { speed, ..present.clone() }, "the speed is held"),
        };
        Some(Edit::Become(Box::new((present, wanted)), format!("{what}: alarm of {watch}")))
    }

    /// Speed and rate of change of the newest step.
    pub(super) fn present_motion(&self) -> Option<(f64, f64)> {
        let feed = lock(&self.feed);
        let places = feed.history().kept();
        let last = places.end.checked_sub(1).filter(|last| *last >= places.start)?;
        let track = feed.history().track(&(last..last + 1));
        (!track.is_empty()).then(|| (track.speed(0), track.value(StepQuantity::Of(Channel::SpeedRate, 0), 0)))
    }
}

/// Whether it is the machine that something has come to an alarm of: not its computer, and not a trip, after which it stands.
fn is_of_the_machine(turn: &LevelChange) -> bool {
    turn.rises() && turn.level == Level::Alarm && !matches!(turn.watch, Watch::Trip | Watch::Lateness | Watch::Losses)
}
