//! A recording as the bench told it: messages made again of what is on file.

use alarms::LevelChange;
use wire::message::{Analysis, Trip};
use wire::{BenchStatus, Happening, SettingsDocument, Text};

use super::Recording;
use crate::contents::Contents;
use crate::event::{self, Event, What};
use crate::session::Revision;

impl Recording {
    /// An event as it was sent, with the settings in force after it.
    #[must_use]
    pub fn wire_event(&self, event: &Event) -> Box<wire::Event> {
        let mut message = event.happening.event();
        message.run_id = self.contents.session.run_id;
        message.number = event.number;
        message.seq = event.at.seq;
        message.tau = event.at.tau;
        message.wall_ns = event.at.wall_ns;
        message.revision = event.revision;
        message.who = Text::new(&event.who);
        message.why = Text::new(&event.why);
        let revision = self.contents.revisions.iter().find(|r| r.revision == event.revision);
        if let Some(revision) = revision {
            message.settings = SettingsDocument::of(&revision.settings);
        }
        message
    }

    /// Every turn of an alarm, trips and the restarts after them among them, in order.
    #[must_use]
    pub fn turns(&self) -> Vec<LevelChange> {
        let mut held = false;
        let of_bench = self.contents.events.iter().filter_map(|event| match &event.happening {
            Happening::Tripped(trip) => {
                held = true;
                Some(event::turn_of(event.at, Some(trip)))
            }
            Happening::Restarted if std::mem::take(&mut held) => Some(event::turn_of(event.at, None)),
            _ => None,
        });
        let of_recorder = self.contents.remarks.iter().filter_map(|remark| match &remark.what {
            What::Alarm(turn) => Some(turn.clone()),
            _ => None,
        });
        let mut turns: Vec<LevelChange> = of_bench.chain(of_recorder).collect();
        turns.sort_by_key(|turn| turn.at.seq);
        turns
    }

    /// The whole slow picture as it stood at step `seq`.
    #[must_use]
    pub fn bench_status_at(&self, seq: u64) -> Box<BenchStatus> {
        let Contents { session, rotor, scales, health, .. } = &self.contents;
        let mut bench_status = Box::<BenchStatus>::default();
        bench_status.run_id = session.run_id;
        bench_status.started_ns = session.started_ns;
        bench_status.version = Text::new(&session.simulation);
        bench_status.set_rotor(rotor);
        bench_status.scales = scales.map_or([0.0; 4], |s| [s.w0, s.k_t, s.m_t, s.e_t]);
        bench_status.rate_hz = session.rate_hz;
        bench_status.dtau = session.dtau;
        if let Some(revision) = self.settings_at(seq) {
            bench_status.settings = SettingsDocument::of(&revision.settings);
            bench_status.revision = revision.revision;
            bench_status.substeps = revision.substeps;
            bench_status.applied_at_step = revision.from;
            bench_status.changed_by = Text::new(&revision.who);
            bench_status.analysis = analysis(revision);
        }
        let told = health.partition_point(|(at, _)| at.seq <= seq);
        bench_status.number = told as u64;
        if let Some((at, health)) = health.get(told.max(1) - 1) {
            bench_status.wall_ns = at.wall_ns;
            bench_status.health = *health;
        }
        let tripped = self.trips.partition_point(|(from, _)| *from <= seq);
        bench_status.trip = tripped.checked_sub(1).map_or_else(Trip::default, |at| self.trips[at].1);
        bench_status
    }
}

fn analysis(revision: &Revision) -> Analysis {
    let mut analysis = Analysis {
        revision: revision.revision,
        count: revision.poles.len().min(2 * rotor::MAX_MASSES) as u32,
        speed: revision.settings.speed,
        min_damping: revision.min_damping,
        ..Analysis::default()
    };
    for (place, pole) in analysis.poles.iter_mut().zip(&revision.poles) {
        *place = [pole.re, pole.im];
    }
    analysis
}

/// From which step on which trip is in force; none after a restart.
pub(super) fn trips(events: &[Event]) -> Vec<(u64, Trip)> {
    let trip = |event: &Event| match event.happening {
        Happening::Tripped(trip) => Some((event.at.seq, trip)),
        Happening::Restarted => Some((event.at.seq, Trip::default())),
        _ => None,
    };
    events.iter().filter_map(trip).collect()
}
