//! The edit thread: it carries edits to the simulation and waits for its answers.
//!
//! An edit is applied to the newest settings known, whoever made them, and sent whole with the revision it is based on.
//! If somebody else's change came between, the simulation refuses and the edit is applied anew. A change that would make a
//! stable rotor unstable, or trip it at once, is not sent, whatever makes it: a person is asked first. [`edit`] is what can be
//! asked for, [`undo`] what can be taken back.

mod edit;
#[cfg(test)]
mod tests;
mod undo;

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, select_biased};
use machine::{StabilityLoss, TripAtOnce};
use rotor::{Rotor, Settings};
use wire::{Answer, BenchName, BenchStatus, Carrier, Change, Commander, Event, WireError};

use crate::feed::Feed;
use crate::history::StepQuantity;
use crate::reader::{SharedFeed, lock};
use crate::units::ScreenUnits;
use crate::view_time::ViewTime;
pub use edit::{Edit, carry_over};
use undo::UndoHistory;

/// How long the simulation may take to answer.
const PATIENCE: Duration = Duration::from_secs(1);
/// How long we wait for the news of a change that we know of.
const NEWS: Duration = Duration::from_millis(300);
/// Seconds over which an orbit is the present one: some turns of whatever is not very slow.
const OF_LATE: f64 = 0.5;
/// How often an edit is applied anew before we give up.
const TRIES: usize = 4;
/// Why settings change, on the record, where we must know it again.
const NUDGED: &str = "nudged";
const UNDO: &str = "undo";
const REDO: &str = "redo";

/// What the reader passes on to the edit thread.
#[derive(Clone, Debug)]
pub enum BenchNews {
    /// The newest bench status.
    BenchStatus(Arc<BenchStatus>),
    /// Something has happened.
    Event(Box<Event>),
}

/// What became of an edit, in words.
#[derive(Clone, Debug, PartialEq)]
pub enum EditOutcome {
    /// It is in force.
    Done(String),
    /// It is, and these were before.
    Swapped(String, Box<Settings>),
    /// It is not, and why.
    Refused(String),
    /// A person must say yes to these settings, for what they would do to the machine.
    Asks(Edit, Box<Settings>, Vec<Harm>),
}

/// What speaks against a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Harm {
    /// A stable rotor would be unstable, with this minimum damping.
    Unstable(f64),
    /// Whether a rotor that is stable now would be cannot be told.
    Unjudged,
    /// The machine would trip at once.
    Trips(TripAtOnce),
}

impl From<String> for EditOutcome {
    fn from(why: String) -> Self {
        Self::Refused(why)
    }
}

/// Starts the edit thread. It ends when `edits` closes. How the machine moves it reads from `feed`.
pub fn spawn<C: Carrier>(
    carrier: C,
    bench: BenchName,
    feed: SharedFeed,
    edits: Receiver<Edit>,
    news: Receiver<BenchNews>,
    outcomes: Sender<EditOutcome>,
) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("edits".into()).spawn(move || {
        let who = format!("dash:{}", std::process::id());
        let mut edit_thread = EditThread {
            carrier,
            bench,
            feed,
            who,
            news,
            commander: None,
            rotor: None,
            known: None,
            present_speed: 0.0,
            undo_history: UndoHistory::default(),
        };
        loop {
            select_biased! {
                recv(edit_thread.news) -> news => match news {
                    Ok(news) => edit_thread.learn(news),
                    // The reader has ended: edits may still come until the screen has.
                    Err(_) => edit_thread.news = crossbeam::channel::never(),
                },
                recv(edits) -> edit => {
                    let Ok(edit) = edit else { return };
                    let outcome = edit_thread.carry_out(&edit);
                    tracing::debug!(?edit, ?outcome);
                    if outcomes.send(outcome).is_err() {
                        return;
                    }
                }
            }
        }
    })
}

/// The newest settings.
#[derive(Clone, Debug)]
struct KnownSettings {
    run: u64,
    revision: u64,
    settings: Settings,
    by: String,
}

/// A change that has been accepted.
struct AppliedChange {
    before: Settings,
    after: Settings,
    answer: Answer,
}

struct EditThread<C: Carrier> {
    carrier: C,
    bench: BenchName,
    feed: SharedFeed,
    who: String,
    news: Receiver<BenchNews>,
    commander: Option<C::Commander>,
    rotor: Option<Rotor>,
    known: Option<KnownSettings>,
    /// The last spin speed that a bench status or an event had.
    present_speed: f64,
    undo_history: UndoHistory,
}

impl<C: Carrier> EditThread<C> {
    fn learn(&mut self, news: BenchNews) {
        match news {
            BenchNews::Event(event) => {
                self.undo_history.push_event(&event);
                // It may come before the bench status that tells the same.
                if let Some(known) = &mut self.known
                    && known.run == event.run_id
                    && known.revision < event.revision
                {
                    (known.revision, known.settings) = (event.revision, event.settings.get().clone());
                    known.by = event.who.as_str().to_owned();
                }
            }
            BenchNews::BenchStatus(bench_status) => {
                let (run, revision) = (bench_status.run_id, bench_status.revision);
                self.present_speed = bench_status.present_speed();
                if self.known.as_ref().is_none_or(|known| known.run != run) {
                    self.rotor = bench_status.rotor().ok();
                } else if self.known.as_ref().is_some_and(|known| known.revision >= revision) {
                    return;
                }
                let by = bench_status.changed_by.as_str().to_owned();
                self.known = Some(KnownSettings { run, revision, settings: bench_status.settings.get().clone(), by });
            }
        }
    }

    fn carry_out(&mut self, edit: &Edit) -> EditOutcome {
        while let Ok(news) = self.news.try_recv() {
            self.learn(news);
        }
        let (wanted, agreed) = match edit {
            Edit::Sure(edit, agreed) => (&**edit, Some(&**agreed)),
            edit => (edit, None),
        };
        let units = self.units();
        let done = match wanted {
            Edit::Impulse(mass, velocity) => self.order(wanted, &Change::Impulse { mass: *mass, velocity: *velocity }),
            Edit::Restart => self.order(wanted, &Change::Restart),
            Edit::Note(text) => self.order(wanted, &Change::Note { text: text.clone() }),
            Edit::Undo | Edit::Redo => self.retrace(wanted, agreed),
            _ => self
                .apply(wanted, agreed, |settings| {
                    wanted.apply(settings).map(|_| ()).map_err(|error| units.fault(&error))
                })
                .map(|applied| {
                    let words = told(&applied.answer, &wanted.describe_in(&applied.after, &self.units()));
                    if matches!(wanted, Edit::Swap(_)) {
                        EditOutcome::Swapped(words, Box::new(applied.before))
                    } else {
                        EditOutcome::Done(words)
                    }
                }),
        };
        done.unwrap_or_else(|not| not)
    }

    /// The units of the rotor.
    fn units(&self) -> ScreenUnits {
        match (&self.rotor, &self.known) {
            (Some(rotor), Some(known)) => ScreenUnits::of_machine(rotor, &known.settings.feedback),
            _ => ScreenUnits::DIMENSIONLESS,
        }
    }

    /// Has something done that changes no settings.
    fn order(&mut self, edit: &Edit, change: &Change) -> Result<EditOutcome, EditOutcome> {
        let answer = self.ask(change, "")?;
        let words = told(&answer, &edit.describe(&self.units()));
        Ok(if answer.is_accepted() { EditOutcome::Done(words) } else { EditOutcome::Refused(words) })
    }

    /// Takes the last change back, or makes it again.
    fn retrace(&mut self, edit: &Edit, agreed: Option<&Settings>) -> Result<EditOutcome, EditOutcome> {
        self.catch_up();
        let back = *edit == Edit::Undo;
        let step = if back { self.undo_history.to_undo() } else { self.undo_history.to_redo() };
        let step = step.cloned().ok_or_else(|| format!("nothing to {}", edit.reason()))?;
        let (from, to) = if back { (&step.after, &step.before) } else { (&step.before, &step.after) };
        let units = self.units();
        let applied = self.apply(edit, agreed, |settings| {
            // What was to be taken back is what the person saw last.
            if settings != from {
                return Err(format!("not {}: somebody else has changed the settings meanwhile", edit.describe(&units)));
            }
            settings.clone_from(to);
            Ok(())
        })?;
        let who = if step.who == self.who { String::new() } else { format!(", made by {}", step.who) };
        let difference = units.difference(&applied.before, &applied.after);
        Ok(EditOutcome::Done(told(&applied.answer, &format!("{}: {difference}{who}", edit.describe(&units)))))
    }

    /// Changes the newest settings and has the result put in force; asks first if the rotor would become unstable or trip at once,
    /// unless that result has been agreed to.
    fn apply(
        &mut self,
        edit: &Edit,
        agreed: Option<&Settings>,
        change: impl Fn(&mut Settings) -> Result<(), String>,
    ) -> Result<AppliedChange, EditOutcome> {
        let mut refusal = String::from("no settings are known yet");
        for _ in 0..TRIES {
            let Some(KnownSettings { run, revision, settings: before, .. }) = self.known.clone() else { break };
            let mut after = before.clone();
            change(&mut after)?;
            let harms = if agreed == Some(&after) { Vec::new() } else { self.harms(&before, &after) };
            if !harms.is_empty() {
                return Err(EditOutcome::Asks(edit.clone(), Box::new(after), harms));
            }
            let request = Change::Settings { base_revision: revision, settings: after.clone() };
            let answer = self.ask(&request, &edit.reason())?;
            if answer.is_accepted() {
                let by = self.who.clone();
                self.known = Some(KnownSettings { run, revision: answer.revision, settings: after.clone(), by });
                return Ok(AppliedChange { before, after, answer });
            }
            refusal = answer.reason.as_str().to_owned();
            if answer.outdated == 0 {
                break;
            }
            self.wait_until(|edit_thread| edit_thread.known.as_ref().is_some_and(|known| known.revision != revision));
        }
        Err(refusal.into())
    }

    /// What a change would do to the machine, as far as can be told.
    fn harms(&self, before: &Settings, after: &Settings) -> Vec<Harm> {
        let loss = self.rotor.as_ref().and_then(|rotor| {
            let loss = StabilityLoss::between(rotor, before, after, self.present_speed)?;
            Some(loss.then.map_or(Harm::Unjudged, |(_, damping)| Harm::Unstable(damping)))
        });
        let orbit = TripAtOnce::is_possible(before, after).then(|| present_orbit(&lock(&self.feed))).flatten();
        let trips = orbit.and_then(|orbit| TripAtOnce::between(before, after, orbit)).map(Harm::Trips);
        loss.into_iter().chain(trips).collect()
    }

    /// Waits until every change that led to the newest settings has come as an event. Those that have not come in time count as one.
    fn catch_up(&mut self) {
        let is_told = |edit_thread: &Self| {
            let reaches = edit_thread.undo_history.known_up_to();
            edit_thread.known.as_ref().is_none_or(|known| reaches.0 == known.run && reaches.1 >= known.revision)
        };
        self.wait_until(is_told);
        if let (false, Some(known)) = (is_told(self), &self.known) {
            self.undo_history.push_missed(known.run, known.revision, &known.settings, &known.by);
        }
    }

    /// Takes in news until `enough`, though not for long.
    fn wait_until(&mut self, enough: impl Fn(&Self) -> bool) {
        let deadline = Instant::now() + NEWS;
        while !enough(self) {
            match self.news.recv_deadline(deadline) {
                Ok(news) => self.learn(news),
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn ask(&mut self, change: &Change, why: &str) -> Result<Answer, String> {
        let asked = self.try_ask(change, why);
        if asked.is_err() {
            // The next edit starts with a fresh port: the simulation may have been replaced.
            self.commander = None;
        }
        asked.map_err(|error| error.to_string())
    }

    fn try_ask(&mut self, change: &Change, why: &str) -> Result<Answer, WireError> {
        let commander = match &mut self.commander {
            Some(commander) => commander,
            none => none.insert(self.carrier.command(&self.bench)?),
        };
        commander.ask(&*change.request(&self.who, why)?, PATIENCE)
    }
}

/// The largest orbit of any place of late, in `e_t`; nothing of a machine that has tripped, or has not moved yet.
fn present_orbit(feed: &Feed) -> Option<f64> {
    let (history, kept) = (feed.history(), feed.history().kept());
    if kept.is_empty() || history.is_tripped() {
        return None;
    }
    let steps = ViewTime::steps_of(OF_LATE, feed.step_seconds());
    let track = history.track(&(kept.end.saturating_sub(steps).max(kept.start)..kept.end));
    let radii = (0..track.masses()).filter_map(|mass| track.range(StepQuantity::radius(mass), 0..track.len()));
    radii.map(|[_, most]| most).reduce(f64::max)
}

/// Puts an answer in words.
fn told(answer: &Answer, what: &str) -> String {
    if answer.is_accepted() {
        let [now, before] = answer.substeps;
        let pace = if now == before { String::new() } else { format!(", {now} substeps a step") };
        format!("{what}, from step {}{pace}", answer.applied_at_step)
    } else {
        format!("{what}: {}", answer.reason.as_str())
    }
}
