use std::thread;

use crossbeam::channel;
use rotor::{C64, Key};
use wire::{Happening, Host, Inbox, Memory, NewsSender, SettingsDocument, Text};

use super::*;
use crate::test_support::bench_status;

/// What another console does before an edit, by its number.
type Elsewhere<'a> = &'a [(usize, &'a str, f64)];

/// An edit thread with a simulation that takes every change and tells of it as the real one does; returns the outcomes of the
/// edits and the last settings. What others do is told only after the edit thread's next request was refused.
fn carried(edits: &[Edit], elsewhere: Elsewhere<'_>) -> (Vec<EditOutcome>, Settings) {
    carried_at(0.0, edits, elsewhere)
}

/// The same of a machine whose last mass whirls on an orbit so large.
fn carried_at(orbit: f64, edits: &[Edit], elsewhere: Elsewhere<'_>) -> (Vec<EditOutcome>, Settings) {
    let feed = SharedFeed::new(std::sync::Mutex::new(crate::feed::Feed::new("")));
    for seq in 0..100 {
        let (z, y) = (0.1 * seq as f64).sin_cos();
        let point = wire::Point { y: orbit * y, z: orbit * z, ..wire::Point::default() };
        lock(&feed).push_step(
            &crate::test_support::state(3, seq)
                .with_point(0, wire::Point::default())
                .with_point(1, wire::Point::default())
                .with_point(2, point),
            Instant::now(),
        );
    }
    let carrier = Memory::default();
    let bench = BenchName::default();
    let host = carrier.host(&bench).unwrap();
    let (send_edit, edit) = channel::unbounded();
    let (tell, news) = channel::unbounded();
    let (outcome, outcomes) = channel::unbounded();
    let mut current = bench_status("three-mass", "composite");
    let event = |current: &BenchStatus, happening: Happening, who: &str, why: &str| {
        let mut event = happening.event();
        (event.run_id, event.revision) = (current.run_id, current.revision);
        event.settings = current.settings.clone();
        (event.who, event.why) = (Text::new(who), Text::new(why));
        event.wall_ns = 1_000_000_000;
        BenchNews::Event(event)
    };
    tell.send(BenchNews::BenchStatus(Arc::new((*current).clone()))).unwrap();
    tell.send(event(&current, Happening::Started, "sim", "")).unwrap();
    spawn(carrier.clone(), bench, feed, edit, news, outcome).unwrap();
    let mut told = Vec::new();
    let mut untold = Vec::new();
    let mut inbox = host.inbox().unwrap();
    let mut sender = host.news().unwrap();
    for (number, edit) in edits.iter().enumerate() {
        for (_, key, value) in elsewhere.iter().filter(|(before, ..)| *before == number) {
            let mut settings = current.settings.get().clone();
            settings.set(key.parse().unwrap(), *value).unwrap();
            current.settings = SettingsDocument::of(&settings);
            current.revision += 1;
            untold.push(event(&current, Happening::Settings, "set:3", "typed"));
        }
        send_edit.send(edit.clone()).unwrap();
        let start = Instant::now();
        let outcome = loop {
            assert!(start.elapsed() < Duration::from_secs(10), "no outcome of {edit:?}");
            inbox
                .serve(Duration::from_millis(5), |request| match Change::of(request).unwrap() {
                    Change::Settings { base_revision, .. } if base_revision != current.revision => {
                        // The news that another console has been at work comes after the refusal.
                        untold.drain(..).for_each(|event| tell.send(event).unwrap());
                        tell.send(BenchNews::BenchStatus(Arc::new((*current).clone()))).unwrap();
                        Answer { outdated: 1, ..Answer::refused(current.revision, "changed meanwhile") }
                    }
                    Change::Settings { settings, .. } => {
                        current.settings = SettingsDocument::of(&settings);
                        current.revision += 1;
                        let (who, why) = (request.who.as_str(), request.why.as_str());
                        tell.send(event(&current, Happening::Settings, who, why)).unwrap();
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
        sender.bench_status(&current).unwrap();
        thread::yield_now();
    }
    (told, current.settings.get().clone())
}

fn start() -> Settings {
    bench_status("three-mass", "composite").settings.get().clone()
}

fn key(name: &str) -> Key {
    name.parse().unwrap()
}

fn set(name: &str, value: f64) -> Edit {
    Edit::Set(vec![(key(name), value)])
}

#[test]
fn undo_and_redo_walk_the_changes_made_here() {
    let edits = [set("speed", 3.0), set("kd", -0.5), Edit::Undo, Edit::Undo, Edit::Undo, Edit::Redo];
    let (outcomes, settings) = carried(&edits, &[]);
    assert_eq!(outcomes[0], EditOutcome::Done("speed = 3, from step 42".into()));
    assert_eq!(outcomes[3], EditOutcome::Done("undone: speed 3 -> 2.5, from step 42".into()));
    assert_eq!(outcomes[4], EditOutcome::Refused("nothing to undo".into()));
    assert_eq!(settings, Settings { speed: 3.0, ..start() });
}

#[test]
fn nudges_of_one_gesture_are_undone_together() {
    let nudge = || Edit::Nudge(key("kd"), 0.01);
    let (_, nudged) = carried(&[nudge(), nudge(), nudge()], &[]);
    assert_eq!(nudged.get(key("kd")).unwrap(), -0.5579);
    let (_, settings) = carried(&[nudge(), nudge(), nudge(), Edit::Undo], &[]);
    assert_eq!(settings, start());
}

#[test]
fn an_edit_is_applied_anew_over_what_others_changed_and_undo_leaves_theirs_alone() {
    let edits = [Edit::Nudge(key("kd"), 0.1), Edit::Nudge(key("deadband"), 1.0), Edit::Undo];
    let (outcomes, settings) = carried(&edits, &[(1, "speed", 6.0)]);
    assert!(outcomes.iter().all(|outcome| matches!(outcome, EditOutcome::Done(_))), "{outcomes:?}");
    assert_eq!((settings.speed, settings.deadband), (6.0, vec![1.0; 3]));
    assert_eq!(settings.feedback.bearings[0].signals[0].gains[0], rotor::Gain::Constant(-0.4879));
}

#[test]
fn regress_quick_changes_of_others_are_undone_one_by_one_with_their_author() {
    let edits = [set("kd", -0.5), Edit::Undo, Edit::Undo, Edit::Undo, Edit::Undo, Edit::Redo];
    let (outcomes, settings) = carried(&edits, &[(1, "speed", 6.0), (1, "trip", 50.0)]);
    // The first finds that the settings have changed, and takes nothing back that nobody has seen.
    assert_eq!(
        outcomes[1],
        EditOutcome::Refused("not undone: somebody else has changed the settings meanwhile".into())
    );
    assert_eq!(outcomes[2], EditOutcome::Done("undone: trip 50 -> 1000, made by set:3, from step 42".into()));
    assert_eq!(outcomes[3], EditOutcome::Done("undone: speed 6 -> 2.5, made by set:3, from step 42".into()));
    assert_eq!(outcomes[4], EditOutcome::Done("undone: kd.1 -0.5 -> -0.5879, from step 42".into()));
    assert_eq!(settings.get(key("kd")), Ok(-0.5));
}

#[test]
fn whatever_makes_a_stable_rotor_unstable_asks_first_and_yes_means_what_was_shown() {
    let off = Settings { feedback: start().feedback.off(), ..start() };
    let sure = |edit: Edit, settings: &Settings| Edit::Sure(Box::new(edit), Box::new(settings.clone()));
    let become_off = || Edit::Become(Box::new((start(), off.clone())), "gains 'off'".into());
    for edit in [Edit::Off, Edit::Swap(Box::new(off.clone())), become_off(), set("speed", 9.0)] {
        let (outcomes, settings) = carried(std::slice::from_ref(&edit), &[]);
        assert!(
            matches!(&outcomes[..], [EditOutcome::Asks(asked, _, harms)] if *asked == edit && matches!(harms[..], [Harm::Unstable(damping)] if damping < 0.0))
        );
        assert_eq!(settings, start(), "{edit:?}");
    }
    // Off, agreed to; stable again; undo would be unstable, and so would redo.
    let back = Settings { speed: 2.5, ..start() };
    let edits = [
        sure(Edit::Off, &off),
        Edit::Swap(Box::new(back.clone())),
        Edit::Undo,
        sure(Edit::Undo, &off),
        Edit::Undo,
        Edit::Redo,
        sure(Edit::Redo, &off),
    ];
    let (outcomes, settings) = carried(&edits, &[]);
    assert!(matches!(&outcomes[0], EditOutcome::Done(words) if words == "control off, from step 42"), "{outcomes:?}");
    assert!(matches!(&outcomes[1], EditOutcome::Swapped(_, before) if **before == off), "{outcomes:?}");
    assert!(matches!(&outcomes[2], EditOutcome::Asks(Edit::Undo, then, _) if **then == off), "{outcomes:?}");
    assert!(matches!(&outcomes[3], EditOutcome::Done(words) if words.starts_with("undone")), "{outcomes:?}");
    assert!(matches!(&outcomes[4], EditOutcome::Done(_)), "back to a stable one asks nothing: {outcomes:?}");
    assert!(matches!(&outcomes[5], EditOutcome::Asks(Edit::Redo, ..)), "{outcomes:?}");
    assert!(matches!(&outcomes[6], EditOutcome::Done(_)) && settings == off, "{outcomes:?}");
    // Yes to other settings than would come into force is no yes.
    let (outcomes, _) = carried(&[sure(Edit::Off, &back)], &[]);
    assert!(matches!(&outcomes[0], EditOutcome::Asks(Edit::Off, ..)), "{outcomes:?}");
}

#[test]
fn a_limit_below_the_present_orbit_asks_first_also_where_undo_puts_it_there() {
    let below = [set("trip", 5.0)];
    let (outcomes, settings) = carried_at(12.5, &below, &[]);
    let EditOutcome::Asks(asked, then, harms) = &outcomes[0] else { panic!("{outcomes:?}") };
    assert_eq!((asked, then.trip, &settings), (&below[0], 5.0, &start()));
    assert!(matches!(harms[..], [Harm::Trips(TripAtOnce { orbit, limit: 5.0 })] if (orbit - 12.5).abs() < 1e-9));
    // With both reasons where there are both, and agreed to in one.
    let off = Edit::Swap(Box::new(Settings { feedback: start().feedback.off(), trip: 5.0, ..start() }));
    let (outcomes, _) = carried_at(12.5, &[off], &[]);
    let EditOutcome::Asks(.., harms) = &outcomes[0] else { panic!("{outcomes:?}") };
    assert!(matches!(harms[..], [Harm::Unstable(_), Harm::Trips(_)]), "{harms:?}");
    // Down to what is above the orbit, and up from below it, nothing is asked; back down, by undo, it is.
    let sure = |trip| Edit::Sure(Box::new(set("trip", trip)), Box::new(Settings { trip, ..start() }));
    let (outcomes, settings) = carried_at(12.5, &[set("trip", 13.0), sure(5.0), set("trip", 50.0), Edit::Undo], &[]);
    let done = |outcome: &EditOutcome| matches!(outcome, EditOutcome::Done(_));
    assert!(outcomes[..3].iter().all(done) && matches!(outcomes[3], EditOutcome::Asks(Edit::Undo, ..)), "{outcomes:?}");
    assert_eq!(settings.trip, 50.0);
}

#[test]
fn impulses_and_restarts_are_answered_with_their_step() {
    let (outcomes, _) = carried(&[Edit::Impulse(0, C64::new(-2.5, 0.0)), Edit::Restart], &[]);
    assert_eq!(outcomes[0], EditOutcome::Done("impulse -2.5 on mass 1, from step 43".into()));
    assert_eq!(outcomes[1], EditOutcome::Done("restarted from rest, from step 43".into()));
}

#[test]
fn what_cannot_be_is_refused_without_asking() {
    let (outcomes, _) = carried(&[set("speed", -1.0), Edit::Redo], &[]);
    assert_eq!(outcomes[0], EditOutcome::Refused("speed = -1: expected a number from 0 to 1000".into()));
    assert_eq!(outcomes[1], EditOutcome::Refused("nothing to redo".into()));
}
