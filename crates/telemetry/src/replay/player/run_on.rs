//! The machine that is run on beside what happened: begun with the first edit, from the very state that was recorded.

use rotor::Settings;
use wire::{Happening, State, Step};

use super::Player;
use crate::edits::Edit;
use crate::feed::Feed;
use crate::replay::ReplayError;
use crate::replay::branch::Branch;
use crate::replay::machine::{BranchPoint, ClockOrigin, RecordedChange};
use crate::units::ScreenUnits;
use crate::view_time::ViewTime;

impl Player {
    /// What was done to the machine, taken out: to be put back.
    pub(super) fn gathered(&mut self) -> Vec<(u64, RecordedChange)> {
        if let Some(acts) = self.acts.take() {
            return acts;
        }
        let mut acts: Vec<(u64, RecordedChange)> = self
            .events
            .iter()
            .filter_map(|event| match event.happening()? {
                Happening::Impulse { mass, velocity } => {
                    Some((event.at.seq, RecordedChange::Impulse(*mass, *velocity)))
                }
                Happening::Restarted => Some((event.at.seq, RecordedChange::Restart)),
                Happening::Excited(multisine) => {
                    Some((event.at.seq, RecordedChange::Excitation(Some(multisine.clone()))))
                }
                // That of itself, at the same time; where it was ended, then.
                Happening::ExcitationOver => Some((event.at.seq, RecordedChange::Excitation(None))),
                _ => None,
            })
            .collect();
        let changes = self.past.changes();
        acts.extend(changes.into_iter().map(|seq| {
            let there = self.past.bench_status_at(seq);
            (seq, RecordedChange::Settings(there.settings.get().clone(), there.substeps.max(1)))
        }));
        acts.extend(self.past.paces().into_iter().map(|(seq, dtau)| (seq, RecordedChange::Pace(dtau))));
        // Stable: what came first within a step stays first.
        acts.sort_by_key(|(seq, _)| *seq);
        acts
    }

    /// Makes an edit of the past: from the first edit on, the machine runs on beside what happened.
    pub fn edit(&mut self, edit: &Edit, feed: &mut Feed, time: &mut ViewTime) -> Result<String, ReplayError> {
        if matches!(edit, Edit::Note(_)) {
            return Err(ReplayError::NoNotes);
        }
        let here = self.seq();
        let fresh = self.branch.is_none();
        if self.branch.as_ref().is_none_or(|branch| branch.from() > here) {
            if fresh && matches!(edit, Edit::Undo | Edit::Redo) {
                return Err(ReplayError::Happened);
            }
            let root = self.root(here)?;
            self.branch = Some(match &self.branch {
                None => Branch::new(root)?,
                Some(branch) => branch.moved_to(root)?,
            });
        }
        let words = match &mut self.branch {
            Some(branch) => branch.edit(edit, here).inspect(|_| branch.begin()),
            None => Err(ReplayError::NoStep),
        };
        if words.is_err() && fresh {
            self.branch = None;
        }
        self.show(feed, time, false)?;
        words.map(|words| format!("what if {words}: esc drops it"))
    }

    /// Whether there is a machine beside the recorded one.
    #[must_use]
    pub fn has_branch(&self) -> bool {
        self.branch.is_some()
    }

    /// Drops what is run on beside. Returns whether there was anything.
    pub fn drop_branch(&mut self, feed: &mut Feed, time: &mut ViewTime) -> Result<bool, ReplayError> {
        let dropped = self.branch.take().is_some();
        if dropped {
            self.show(feed, time, false)?;
        }
        Ok(dropped)
    }

    /// The moment at step `seq`, or at the last one before it that is there, to run on from.
    fn root(&mut self, seq: u64) -> Result<BranchPoint, ReplayError> {
        let place = self.loaded.index_of(seq).ok_or(ReplayError::NoStep)?;
        let at = self.state(seq)?.map_or_else(|| self.state(self.loaded.seq_of(place)), |state| Ok(Some(state)))?;
        let state = at.ok_or(ReplayError::MissingStep)?;
        let bench_status = self.past.bench_status_at(state.seq());
        let rotor = bench_status.rotor()?;
        let settings = bench_status.settings.get().clone();
        settings.check(&rotor).map_err(|error| ReplayError::settings(error, &ScreenUnits::DIMENSIONLESS))?;
        let substeps = bench_status.substeps.max(1);
        let line = self.line(&state, &settings, substeps)?;
        let (dtau, rate_hz) = (bench_status.dtau, bench_status.rate_hz);
        let mut root = BranchPoint { rotor, dtau, rate_hz, state, settings, substeps, line, restored: None };
        // What cannot be read costs what the loop held, and no more.
        if let Ok(Some(snapshot)) = self.past.snapshot_before(root.state.seq()) {
            let then = self.past.bench_status_at(snapshot.0);
            let acts = self.gathered();
            root.restored = root.recalled(snapshot, (then.settings.get(), then.substeps.max(1)), &acts);
            self.acts = Some(acts);
        }
        if root.restored.is_none() {
            let acts = self.gathered();
            let excited = is_excited(&acts, root.state.seq(), dtau);
            self.acts = Some(acts);
            if excited {
                return Err(ReplayError::Excited);
            }
        }
        Ok(root)
    }

    fn state(&mut self, seq: u64) -> Result<Option<State>, ReplayError> {
        let mut found = None;
        self.past.visit(seq..seq + 1, &mut |state| found = Some(*state))?;
        Ok(found)
    }

    /// The line of time that the run was on at `state`: since the last restart or change of speed or of substeps, if that is
    /// on file. A line that begins at the first step on file differs from the true one by rounding only.
    fn line(&mut self, state: &State, settings: &Settings, substeps: u32) -> Result<ClockOrigin, ReplayError> {
        let restart = self
            .events
            .iter()
            .rev()
            .find(|event| event.happening() == Some(&Happening::Restarted) && event.at.seq <= state.seq());
        // Before its first step a machine is at rest.
        let rest = restart.map_or(0, |event| event.at.seq);
        let changes = self.past.changes();
        let faster = changes.into_iter().rev().take_while(|from| *from > rest).filter(|from| *from <= state.seq());
        let turned = faster.into_iter().find(|from| {
            let [before, after] = [from - 1, *from].map(|seq| self.past.bench_status_at(seq));
            before.settings.get().speed != after.settings.get().speed || before.substeps.max(1) != after.substeps.max(1)
        });
        let made = |steps: u64| steps * u64::from(substeps);
        let line = match turned {
            None => Some(ClockOrigin { tau: 0.0, angle: 0.0, steps: made(state.seq() + 1 - rest) }),
            Some(from) => self.state(from - 1)?.map(|before| ClockOrigin {
                tau: before.tau(),
                angle: before.angle(),
                steps: made(state.seq() + 1 - from),
            }),
        };
        let here = ClockOrigin { tau: state.tau(), angle: state.angle(), steps: 0 };
        let first = self.state(self.ends[0])?;
        let begun = first.map(|first| ClockOrigin {
            tau: first.tau(),
            angle: first.angle(),
            steps: made(state.seq() - first.seq()),
        });
        let dtau = self.past.bench_status_at(state.seq()).dtau / f64::from(substeps);
        // Whichever arrives at the time and the angle that were recorded.
        let arrives = |line: &ClockOrigin| {
            let passed = line.steps as f64 * dtau;
            line.tau + passed == state.tau() && line.angle + settings.speed * passed == state.angle()
        };
        Ok(line.filter(arrives).or(begun.filter(arrives)).unwrap_or(here))
    }
}

/// Whether what was done to the machine has left it excited at the end of step `seq`.
fn is_excited(acts: &[(u64, RecordedChange)], seq: u64, dtau: f64) -> bool {
    let mut until = None;
    for (at, act) in acts.iter().take_while(|(at, _)| *at <= seq) {
        match act {
            RecordedChange::Excitation(Some(multisine)) => {
                until = Some(at + (multisine.duration / dtau * (1.0 - 1e-12)).ceil() as u64);
            }
            RecordedChange::Excitation(None) | RecordedChange::Settings(..) | RecordedChange::Restart => until = None,
            RecordedChange::Impulse(..) | RecordedChange::Pace(_) => {}
        }
    }
    until.is_some_and(|until| seq + 1 < until)
}
