//! The clerk: a thread that carries edits to the simulation, waits for its answers, and keeps the undo stacks.
//!
//! An edit is applied to the newest settings known, whoever made them, and sent whole with the revision it is based on.
//! If somebody else's change came between, the simulation refuses and the edit is applied anew.

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, select_biased};
use rotor::{C64, Difference, Key, Settings};
use wire::{Answer, BenchName, Bulletin, Carrier, Change, Commander, WireError};

/// How long the simulation may take to answer.
const PATIENCE: Duration = Duration::from_secs(1);
/// How long we wait for the bulletin that tells of somebody else's change.
const NEWS: Duration = Duration::from_millis(300);
/// How often an edit is applied anew before we give up.
const TRIES: usize = 4;
/// Nudges of one key that follow each other within this time are undone together.
const ONE_GESTURE: Duration = Duration::from_millis(700);
/// Changes that can be taken back.
const REMEMBERED: usize = 256;

/// What a person wants changed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Edit {
    /// Raise a setting.
    Nudge(Key, f64),
    /// Set these, all at once.
    Set(Vec<(Key, f64)>),
    /// All gains to zero.
    Off,
    /// Put other settings in force, and what to call that; only what differs from those that were looked at is changed.
    Become(Box<(Settings, Settings)>, String),
    /// Put a note on the record.
    Note(String),
    /// Take back the last change, whoever made it.
    Undo,
    /// Make it again.
    Redo,
    /// A change of velocity of one mass.
    Impulse(usize, C64),
    /// Back to rest.
    Restart,
}

impl Edit {
    /// What `settings` would become; `None` if the edit changes no settings that are known here, or does not fit them.
    pub(crate) fn applied(&self, settings: &Settings) -> Option<Settings> {
        let mut settings = settings.clone();
        match self {
            Self::Nudge(key, delta) => settings.nudge(*key, *delta).ok()?,
            Self::Set(values) => values.iter().try_for_each(|(key, value)| settings.set(*key, *value)).ok()?,
            Self::Off => settings.feedback = settings.feedback.off(),
            Self::Become(change, _) => carry_over(&change.0, &change.1, &mut settings),
            Self::Undo | Self::Redo | Self::Impulse(..) | Self::Restart | Self::Note(_) => return None,
        }
        Some(settings)
    }
}

/// What became of an edit, in words.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// It is in force.
    Done(String),
    /// It is not, and why.
    Refused(String),
}

/// Starts the clerk. It ends when `edits` closes.
pub(crate) fn spawn<C: Carrier>(
    carrier: C,
    bench: BenchName,
    edits: Receiver<Edit>,
    bulletins: Receiver<Arc<Bulletin>>,
    outcomes: Sender<Outcome>,
) -> std::io::Result<JoinHandle<()>> {
    std::thread::Builder::new().name("clerk".into()).spawn(move || {
        let who = format!("dash:{}", std::process::id());
        let mut clerk = Clerk {
            carrier,
            bench,
            who,
            bulletins,
            commander: None,
            known: None,
            done: Vec::new(),
            undone: Vec::new(),
        };
        loop {
            select_biased! {
                recv(clerk.bulletins) -> bulletin => match bulletin {
                    Ok(bulletin) => clerk.learn(&bulletin),
                    // The reader has ended: edits may still come until the screen has.
                    Err(_) => clerk.bulletins = crossbeam::channel::never(),
                },
                recv(edits) -> edit => {
                    let Ok(edit) = edit else { return };
                    let outcome = clerk.carry(&edit);
                    if outcomes.send(outcome).is_err() {
                        return;
                    }
                }
            }
        }
    })
}

/// One change that can be taken back.
#[derive(Clone, Debug)]
struct Step {
    before: Settings,
    after: Settings,
    nudged: Option<(Key, Instant)>,
    /// Who made it, if it was not us.
    who: Option<String>,
}

struct Clerk<C: Carrier> {
    carrier: C,
    bench: BenchName,
    who: String,
    bulletins: Receiver<Arc<Bulletin>>,
    commander: Option<C::Commander>,
    /// The newest settings: run, revision, and themselves.
    known: Option<(u64, u64, Settings)>,
    done: Vec<Step>,
    undone: Vec<Step>,
}

impl<C: Carrier> Clerk<C> {
    fn learn(&mut self, bulletin: &Bulletin) {
        let is_older = self
            .known
            .as_ref()
            .is_some_and(|(run, revision, _)| *run == bulletin.run_id && *revision >= bulletin.revision);
        if is_older {
            return;
        }
        let settings = bulletin.settings.unpack();
        // What others change can be taken back here too.
        if let Some((run, _, before)) = self.known.take()
            && run == bulletin.run_id
            && before != settings
        {
            let who = Some(bulletin.changed_by.as_str().to_owned());
            self.remember(Step { before, after: settings.clone(), nudged: None, who });
        }
        self.known = Some((bulletin.run_id, bulletin.revision, settings));
    }

    fn carry(&mut self, edit: &Edit) -> Outcome {
        while let Ok(bulletin) = self.bulletins.try_recv() {
            self.learn(&bulletin);
        }
        let done = match edit {
            Edit::Impulse(mass, velocity) => self
                .ask(&Change::Impulse { mass: *mass, velocity: *velocity }, "")
                .map(|answer| told(&answer, &format!("impulse {} on mass {}", velocity.re, mass + 1))),
            Edit::Restart => self.ask(&Change::Restart, "").map(|answer| told(&answer, "restarted from rest")),
            Edit::Undo => match self.done.pop() {
                None => return Outcome::Refused("nothing to undo".into()),
                Some(step) => {
                    let (from, to) = (step.after.clone(), step.before.clone());
                    self.again(step, &from, &to, "undone")
                }
            },
            Edit::Redo => match self.undone.pop() {
                None => return Outcome::Refused("nothing to redo".into()),
                Some(step) => {
                    let (from, to) = (step.before.clone(), step.after.clone());
                    self.again(step, &from, &to, "done again")
                }
            },
            Edit::Nudge(key, delta) => self.remembered(Some(*key), &format!("{key}"), "nudged", |s| {
                s.nudge(*key, *delta).map_err(|e| e.to_string())
            }),
            Edit::Set(values) => self.remembered(None, &words(values), "typed", |s| {
                values.iter().try_for_each(|(key, value)| s.set(*key, *value)).map_err(|e| e.to_string())
            }),
            Edit::Become(change, what) => self.remembered(None, what, what, |settings| {
                carry_over(&change.0, &change.1, settings);
                Ok(())
            }),
            Edit::Note(text) => self.ask(&Change::Note { text: text.clone() }, "").map(|answer| told(&answer, "noted")),
            Edit::Off => self.remembered(None, "control off", "control off", |settings| {
                settings.feedback = settings.feedback.off();
                Ok(())
            }),
        };
        done.unwrap_or_else(Outcome::Refused)
    }

    /// Applies a change and puts it on the undo stack.
    fn remembered(
        &mut self,
        nudged: Option<Key>,
        what: &str,
        why: &str,
        change: impl Fn(&mut Settings) -> Result<(), String>,
    ) -> Result<Outcome, String> {
        let (before, after, answer) = self.apply(why, change)?;
        let now = Instant::now();
        let mut step = Step { before, after, nudged: nudged.map(|key| (key, now)), who: None };
        if let (Some(key), Some(last)) = (nudged, self.done.last())
            && last.nudged.is_some_and(|(other, at)| other == key && now - at < ONE_GESTURE)
            && last.after == step.before
        {
            step.before = last.before.clone();
            self.done.pop();
        }
        self.remember(step);
        self.undone.clear();
        Ok(told(&answer, what))
    }

    /// Puts a change on the undo stack, which forgets the oldest.
    fn remember(&mut self, step: Step) {
        if self.done.len() == REMEMBERED {
            self.done.remove(0);
        }
        self.done.push(step);
    }

    /// Goes from `from` to `to` over one step of a stack, leaving alone what others have changed since.
    fn again(&mut self, step: Step, from: &Settings, to: &Settings, word: &str) -> Result<Outcome, String> {
        let back = word == "undone";
        let applied = self.apply(if back { "undo" } else { "redo" }, |settings| {
            carry_over(from, to, settings);
            Ok(())
        });
        match applied {
            Ok((before, after, answer)) => {
                let who = step.who.as_ref().map_or_else(String::new, |who| format!(", made by {who}"));
                if back { &mut self.undone } else { &mut self.done }.push(step);
                Ok(told(&answer, &format!("{word}: {}{who}", Difference::between(&before, &after))))
            }
            Err(why) => {
                if back { &mut self.done } else { &mut self.undone }.push(step);
                Err(why)
            }
        }
    }

    /// Changes the newest settings and has the result put in force. Returns what was, what is, and the answer.
    fn apply(
        &mut self,
        why: &str,
        change: impl Fn(&mut Settings) -> Result<(), String>,
    ) -> Result<(Settings, Settings, Answer), String> {
        let mut refusal = String::from("no settings are known yet");
        for _ in 0..TRIES {
            let Some((run_id, revision, before)) = self.known.clone() else { break };
            let mut after = before.clone();
            change(&mut after)?;
            let answer = self.ask(&Change::Settings { base_revision: revision, settings: after.clone() }, why)?;
            if answer.is_accepted() {
                self.known = Some((run_id, answer.revision, after.clone()));
                return Ok((before, after, answer));
            }
            refusal = answer.reason.as_str().to_owned();
            if answer.outdated == 0 {
                break;
            }
            self.wait_for_news(revision);
        }
        Err(refusal)
    }

    /// Waits for the bulletin of a revision beyond `revision`.
    fn wait_for_news(&mut self, revision: u64) {
        let deadline = Instant::now() + NEWS;
        while self.known.as_ref().is_some_and(|(_, known, _)| *known == revision) {
            match self.bulletins.recv_deadline(deadline) {
                Ok(bulletin) => self.learn(&bulletin),
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

/// Puts what is set in words.
pub(crate) fn words(values: &[(Key, f64)]) -> String {
    values.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
}

/// Puts an answer in words.
fn told(answer: &Answer, what: &str) -> Outcome {
    if answer.is_accepted() {
        Outcome::Done(format!("{what}, from step {}", answer.applied_at_step))
    } else {
        Outcome::Refused(format!("{what}: {}", answer.reason.as_str()))
    }
}

/// Makes in `settings` the changes that lead from `from` to `to`, and no others.
pub(crate) fn carry_over(from: &Settings, to: &Settings, settings: &mut Settings) {
    if from.speed != to.speed {
        settings.speed = to.speed;
    }
    if from.trip != to.trip {
        settings.trip = to.trip;
    }
    if from.feedback != to.feedback {
        settings.feedback = to.feedback.clone();
    }
    for (place, (from, to)) in settings.deadband.iter_mut().zip(from.deadband.iter().zip(&to.deadband)) {
        if from != to {
            *place = *to;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use crossbeam::channel;
    use wire::{BulletinSender, Host, Inbox, Memory, SettingsMessage};

    use super::*;
    use crate::feed::tests::bulletin;

    /// A clerk with a simulation that takes every change; returns the outcomes of the edits and the last settings.
    /// Before the edit number `elsewhere`, another console sets the speed to 6.
    fn carried(edits: &[Edit], elsewhere: Option<usize>) -> (Vec<Outcome>, Settings) {
        let carrier = Memory::default();
        let bench = BenchName::default();
        let host = carrier.host(&bench).unwrap();
        let (send_edit, edit) = channel::unbounded();
        let (send_bulletin, bulletins) = channel::unbounded();
        let (outcome, outcomes) = channel::unbounded();
        let mut current = bulletin("three-mass", "composite");
        send_bulletin.send(Arc::new(*current)).unwrap();
        spawn(carrier.clone(), bench, edit, bulletins, outcome).unwrap();
        let mut told = Vec::new();
        let mut inbox = host.inbox().unwrap();
        let mut sender = host.bulletins().unwrap();
        for (number, edit) in edits.iter().enumerate() {
            if elsewhere == Some(number) {
                let mut settings = current.settings.unpack();
                settings.speed = 6.0;
                current.settings = SettingsMessage::pack(&settings).unwrap();
                current.revision += 1;
            }
            send_edit.send(edit.clone()).unwrap();
            let start = Instant::now();
            let outcome = loop {
                assert!(start.elapsed() < Duration::from_secs(10), "no outcome of {edit:?}");
                inbox
                    .serve(Duration::from_millis(5), |request| match Change::of(request).unwrap() {
                        Change::Settings { base_revision, .. } if base_revision != current.revision => {
                            // The news that another console has been at work comes after the refusal.
                            send_bulletin.send(Arc::new(*current)).unwrap();
                            Answer { outdated: 1, ..Answer::refused(current.revision, "changed meanwhile") }
                        }
                        Change::Settings { .. } => {
                            current.settings = request.settings;
                            current.revision += 1;
                            Answer::accepted(current.revision, 42, 0.42)
                        }
                        _ => Answer::accepted(current.revision, 43, 0.43),
                    })
                    .unwrap();
                if let Ok(outcome) = outcomes.try_recv() {
                    break outcome;
                }
            };
            told.push(outcome);
            sender.send(&current).unwrap();
            thread::yield_now();
        }
        (told, current.settings.unpack())
    }

    fn key(name: &str) -> Key {
        name.parse().unwrap()
    }

    #[test]
    fn undo_and_redo_walk_the_changes_made_here() {
        let start = bulletin("three-mass", "composite").settings.unpack();
        let edits = [Edit::Set(vec![(key("speed"), 3.0)]), Edit::Off, Edit::Undo, Edit::Undo, Edit::Undo, Edit::Redo];
        let (outcomes, settings) = carried(&edits, None);
        assert_eq!(outcomes[0], Outcome::Done("speed = 3, from step 42".into()));
        assert_eq!(outcomes[4], Outcome::Refused("nothing to undo".into()));
        assert_eq!(settings, Settings { speed: 3.0, ..start });
    }

    #[test]
    fn nudges_of_one_gesture_are_undone_together() {
        let start = bulletin("three-mass", "composite").settings.unpack();
        let nudge = || Edit::Nudge(key("kd"), 0.01);
        let (_, nudged) = carried(&[nudge(), nudge(), nudge()], None);
        assert_eq!(nudged.get(key("kd")).unwrap(), -0.5579);
        let (_, settings) = carried(&[nudge(), nudge(), nudge(), Edit::Undo], None);
        assert_eq!(settings, start);
    }

    #[test]
    fn an_edit_is_applied_anew_over_what_others_changed_and_undo_leaves_theirs_alone() {
        let edits = [Edit::Nudge(key("kd"), 0.1), Edit::Nudge(key("deadband"), 1.0), Edit::Undo];
        let (outcomes, settings) = carried(&edits, Some(1));
        assert!(outcomes.iter().all(|outcome| matches!(outcome, Outcome::Done(_))), "{outcomes:?}");
        assert_eq!((settings.speed, settings.deadband), (6.0, vec![1.0; 3]));
        assert_eq!(settings.feedback.signals[0].gains[0], rotor::Gain::Constant(-0.4879));
    }

    #[test]
    fn impulses_and_restarts_are_answered_with_their_step() {
        let (outcomes, _) = carried(&[Edit::Impulse(0, C64::new(-2.5, 0.0)), Edit::Restart], None);
        assert_eq!(outcomes[0], Outcome::Done("impulse -2.5 on mass 1, from step 43".into()));
        assert_eq!(outcomes[1], Outcome::Done("restarted from rest, from step 43".into()));
    }

    #[test]
    fn what_cannot_be_is_refused_without_asking() {
        let (outcomes, _) = carried(&[Edit::Set(vec![(key("speed"), -1.0)]), Edit::Redo], None);
        assert_eq!(outcomes[0], Outcome::Refused("speed = -1: expected a number from 0 to 1000".into()));
        assert_eq!(outcomes[1], Outcome::Refused("nothing to redo".into()));
    }
}
