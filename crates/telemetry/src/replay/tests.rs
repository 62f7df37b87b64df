//! What was simulated by the simulation itself is played, from memory.

use std::time::{Duration, Instant};

use rotor::Key;
use wire::message::Flags;
use wire::{Channel, Step};

use super::*;
use crate::edits::Edit;
use crate::feed::Feed;
use crate::replay::player::{LoopRange, SPEEDS};
use crate::test_support::{Long, Session, Stage, session, whole};
use crate::view_time::ViewTime;

fn key(name: &str) -> Key {
    name.parse().unwrap()
}

#[test]
fn playing_takes_the_time_it_took_and_ends_at_the_end() {
    let session = session();
    let mut stage = Stage::of(&session);
    let now = Instant::now();
    stage.player.toggle(&mut stage.feed, &mut stage.time, now).unwrap();
    let tick = |stage: &mut Stage, ms| {
        let shows = stage.player.tick(&mut stage.feed, &mut stage.time, now + Duration::from_millis(ms)).unwrap();
        (shows, stage.player.seq())
    };
    assert_eq!(tick(&mut stage, 100), (true, 200));
    (0..20).for_each(|_| stage.player.change_speed(1));
    assert_eq!(stage.player.speed(), SPEEDS[SPEEDS.len() - 1]);
    (0..99).for_each(|_| stage.player.change_speed(-1));
    assert_eq!((stage.player.speed(), tick(&mut stage, 200)), (0.1, (true, 220)));
    (0..99).for_each(|_| stage.player.change_speed(1));
    let last = session.states[session.states.len() - 1].seq();
    assert_eq!((tick(&mut stage, 2000), stage.player.is_playing()), ((true, last), false));
    assert_eq!(tick(&mut stage, 9000), (false, last));
    // From there it begins again.
    stage.player.toggle(&mut stage.feed, &mut stage.time, now).unwrap();
    assert_eq!((stage.player.seq(), stage.player.is_playing()), (0, true));
}

#[test]
fn a_loop_is_not_left() {
    let session = session();
    let mut stage = Stage::of(&session);
    stage.go(400);
    stage.player.mark_loop();
    stage.go(300);
    stage.player.mark_loop();
    assert_eq!(stage.player.repeat, LoopRange::Over(300, 400));
    let mut seen = Vec::new();
    for at in 0..500 {
        stage.play(0.5 + f64::from(at % 37) * 1.7);
        seen.push(stage.player.seq());
    }
    assert!(seen.iter().all(|seq| (300..=400).contains(seq)), "{seen:?}");
    assert!(seen.windows(2).filter(|pair| pair[1] < pair[0]).count() > 10);
    assert_eq!(stage.player.mark_loop(), "no loop");
    // A loop that ends with the recording turns there.
    let last = session.states[session.states.len() - 1].seq();
    stage.go(last - 50);
    stage.player.mark_loop();
    stage.go(last);
    stage.player.mark_loop();
    (0..50).for_each(|_| stage.play(7.3));
    assert!((last - 50..=last).contains(&stage.player.seq()));
}

#[test]
fn what_if_nothing_had_been_changed_is_what_happened_to_the_last_bit() {
    repeats(&session());
}

#[test]
fn what_if_is_exact_too_where_steps_were_made_of_substeps() {
    let session = whole(0.2);
    let made: Vec<u32> = session.events.iter().filter(|event| event.kind <= 2).map(|event| event.substeps).collect();
    assert!(made.iter().all(|substeps| *substeps > 1) && made.iter().any(|n| *n != made[0]), "{made:?}");
    repeats(&session);
}

#[test]
fn what_if_refuses_what_the_bench_would() {
    let mut stage = Stage::of(&session());
    stage.go(300);
    let refused = stage.edit(&Edit::Nudge(key("cd"), 999_000.0)).unwrap_err().to_string();
    assert!(refused.contains("is too long for the mode at"), "{refused}");
    stage.edit(&Edit::Nudge(key("kd"), 0.25)).unwrap();
    let refused = stage.edit(&Edit::Nudge(key("cd"), 999_000.0)).unwrap_err().to_string();
    assert!(refused.contains("at 2000 steps a second there is time for"), "{refused}");
}

fn repeats(session: &Session) {
    let last = session.states[session.states.len() - 1].seq();
    let tripped = session.states.iter().find(|state| state.flags().has(Flags::TRIPPED)).expect("a trip").seq();
    for from in [0, 1, 149, 150, 151, 200, 333, 480, 700, 703, 810, tripped - 1, tripped, tripped + 5, last - 100] {
        let mut stage = Stage::of(session);
        stage.go(from);
        stage.edit(&Edit::Nudge(key("kd"), 0.25)).unwrap();
        stage.edit(&Edit::Undo).unwrap();
        stage.go(last);
        let branch = stage.player.branch.as_ref().unwrap();
        for state in session.states.iter().filter(|state| state.seq() >= from) {
            for (mass, point) in state.points().enumerate() {
                let beside = branch.displacement(state.seq(), mass).map(|place| place.map(f64::to_bits));
                let happened = Some([point.y.to_bits(), point.z.to_bits()]);
                assert_eq!(beside, happened, "mass {mass} at step {} from {from} on", state.seq());
            }
            let force = branch.force(state.seq(), 0).map(|force| force.map(f64::to_bits));
            assert_eq!(force, Some(state.force_delivered().map(f64::to_bits)), "step {} from {from} on", state.seq());
        }
    }
}

#[test]
fn a_recording_that_begins_late_is_run_on_from_up_to_rounding() {
    let mut session = session();
    session.states.retain(|state| state.seq() >= 60);
    let mut stage = Stage::of(&session);
    stage.go(100);
    stage.edit(&Edit::Set(vec![(key("speed"), 2.5)])).unwrap();
    stage.go(300);
    let branch = stage.player.branch.as_ref().unwrap();
    let there = session.states.iter().find(|state| state.seq() == 300).unwrap();
    let [y, z] = branch.displacement(300, 1).unwrap();
    assert!((y - there.point(1).y).abs() < 1e-12 && (z - there.point(1).z).abs() < 1e-12);
}

#[test]
fn other_gains_are_run_on_beside_what_happened_until_they_are_dropped() {
    let session = session();
    let mut stage = Stage::of(&session);
    stage.go(100);
    assert!(stage.edit(&Edit::Undo).is_err() && stage.player.branch.is_none());
    assert!(stage.edit(&Edit::Set(vec![(key("speed"), -1.0)])).is_err() && stage.player.branch.is_none());
    stage.edit(&Edit::Off).unwrap();
    stage.edit(&Edit::Set(vec![(key("trip"), 1.5)])).unwrap();
    stage.go(330);
    let branch = stage.player.branch.as_ref().unwrap();
    let there = &session.states[330];
    assert_ne!(branch.displacement(330, 0), Some([there.point(0).y, there.point(0).z]));
    assert_eq!(branch.displacement(99, 0), None);
    // What is edited is what is run on with; what was changed later in the recording is changed here too.
    assert_eq!(stage.feed.settings().unwrap().trip, 1.5);
    stage.go(500);
    assert_eq!(stage.feed.settings().unwrap().speed, 3.0);
    // An edit at what was before it moves it there.
    stage.go(50);
    stage.edit(&Edit::Nudge(key("trip"), 1.0)).unwrap();
    assert_eq!(stage.player.branch.as_ref().unwrap().from(), 50);
    assert_eq!(stage.feed.settings().unwrap().trip, 2.5);
    stage.edit(&Edit::Nudge(key("kd"), 0.5)).unwrap();
    assert_eq!(stage.feed.settings().unwrap().get(key("kd")).unwrap(), 0.5, "0 is where control was off");
    assert!(stage.player.drop_branch(&mut stage.feed, &mut stage.time).unwrap());
    assert_eq!(stage.feed.settings().unwrap().trip, 1000.0);
}

/// However far it is, the machine beside arrives, says how far it has come, and remembers no more than it must. Where it has
/// been and is gone to again, it is what it was.
#[test]
fn a_long_way_is_gone_in_stages_and_what_is_forgotten_is_run_anew() {
    let (mut feed, mut time) = (Feed::with_bound("", 60_000_000), ViewTime::LIVE);
    let player = Player::new(Box::new(Long::new(session())), &mut feed, &mut time).unwrap();
    let mut stage = Stage { player, feed, time };
    assert!(!stage.player.judged, "it was recorded without alarms");
    stage.edit(&Edit::Nudge(key("kd"), 0.25)).unwrap();
    let arrive = |stage: &mut Stage, seq: u64| {
        stage.go(seq);
        let mut stages = 0;
        while stage.player.tick(&mut stage.feed, &mut stage.time, Instant::now()).unwrap() {
            stages += 1;
        }
        let branch = stage.player.branch.as_ref().unwrap();
        let bits = |back: u64| branch.displacement(seq - back, 2).map(|place| place.map(f64::to_bits));
        let known: Vec<_> = [0, 1, 999, 9999].map(bits).into_iter().collect();
        assert!(known.iter().all(Option::is_some), "{seq}: {known:?}");
        (known, stages)
    };
    let near = arrive(&mut stage, 150_000).0;
    stage.go(1_900_000);
    let branch = stage.player.branch.as_ref().unwrap();
    let gone = 1.0 - branch.lag(1_900_000) as f64 / 1_900_000.0;
    assert!((0.18..0.19).contains(&gone), "{gone}");
    let (far, stages) = arrive(&mut stage, 1_900_000);
    assert!(stages > 5, "{stages}");
    assert_eq!(stage.player.branch.as_ref().unwrap().displacement(150_000, 2), None, "forgotten");
    let (again, stages) = arrive(&mut stage, 150_000);
    assert_eq!((again, stages), (near, 0), "run anew from not far before");
    let (again, stages) = arrive(&mut stage, 1_900_000);
    assert!(again == far && stages < 4, "{stages}");
}

#[test]
fn events_are_gone_to_in_order_and_back() {
    let session = session();
    let mut stage = Stage::of(&session);
    let mut words = Vec::new();
    while let Ok(told) = stage.player.go_to_event(1, &mut stage.feed, &mut stage.time) {
        words.push((stage.player.seq(), told));
    }
    let at = |text: &str| words.iter().position(|(_, told)| told.contains(text)).unwrap_or_else(|| panic!("{words:?}"));
    assert!(at("note: now it is faster by test (to see)") < at("restarted from rest"));
    let trip = session.events.iter().find(|event| event.kind == 6).unwrap();
    assert!(words.iter().any(|(seq, told)| *seq == trip.seq && told.contains("tripped: orbit of mass")));
    let mut back = Vec::new();
    while stage.player.go_to_event(-1, &mut stage.feed, &mut stage.time).is_ok() {
        back.push(stage.player.seq());
    }
    assert!(back.windows(2).all(|pair| pair[1] < pair[0]) && back.len() + 1 >= words.len());
    stage.player.go_to_tau(1.0, &mut stage.feed, &mut stage.time).unwrap();
    let tau = session.states[stage.player.seq() as usize].tau();
    assert!(tau <= 1.0 && tau > 0.98, "{tau}");
}

#[test]
fn what_is_missing_is_passed_over_and_told() {
    let mut session = session();
    session.states.retain(|state| !(200..600).contains(&state.seq()) && state.seq() != 700);
    let mut stage = Stage::of(&session);
    stage.go(190);
    (0..15).for_each(|_| stage.play(1.0));
    assert_eq!(stage.player.seq(), 605);
    assert_eq!(stage.player.notices(), ["401 steps are missing"]);
    stage.go(300);
    assert_eq!(stage.feed.frame_data(&stage.time, Instant::now()).now.map(|_| ()), Some(()));
    for seq in [199, 200, 599, 600, 699, 700, 701] {
        let place = stage.go(seq).player.loaded.index_of(seq).unwrap();
        let there = stage.player.loaded.seq_of(place);
        let before = session.states.iter().rev().find(|state| state.seq() <= seq).unwrap();
        assert_eq!(there, before.seq());
    }
}

#[test]
fn an_empty_recording_is_refused_and_one_step_is_played() {
    let session = session();
    let empty = Session { states: Vec::new(), ..session.clone() };
    let refused = Player::new(Box::new(empty), &mut Feed::new(""), &mut ViewTime::LIVE.clone()).err();
    assert_eq!(refused.map(|why| why.to_string()).as_deref(), Some("there are no steps in it"));
    // One step is a recording too.
    let one = Session { states: session.states[7..8].to_vec(), ..session };
    let mut stage = Stage::of(&one);
    stage.play(5.0);
    assert_eq!(stage.player.seq(), 7);
}

/// Everything that a long recording is made of, in little memory: jumps forget, and going on adds.
#[test]
fn a_recording_longer_than_what_is_kept_is_played_all_the_same() {
    let session = session();
    let mut long = session.clone();
    long.events.truncate(1);
    long.states = (0..60_000_u64)
        .map(|seq| {
            let tau = (seq + 1) as f64 * 0.01;
            let state = session.states[0].with_word(Channel::Seq, seq).with_word(Channel::Revision, 1);
            let state =
                state.with(Channel::Tau, 0, tau).with(Channel::Angle, 0, 2.5 * tau).with(Channel::Speed, 0, 2.5);
            state.with(Channel::Y, 0, seq as f64)
        })
        .collect();
    let (mut feed, mut time) = (Feed::with_bound("", 6_000_000), ViewTime::LIVE);
    let mut player = Player::new(Box::new(long), &mut feed, &mut time).unwrap();
    for seq in [0, 59_999, 30_000, 29_000, 31_000, 12, 45_678] {
        player.go(seq, &mut feed, &mut time).unwrap();
        let data = feed.frame_data(&time, Instant::now());
        assert_eq!(data.now.map(|now| data.track.displacement(now, 0)[0]), Some(seq as f64));
    }
    for _ in 0..100 {
        player.play(143.0, &mut feed, &mut time).unwrap();
        let data = feed.frame_data(&time, Instant::now());
        assert_eq!(data.now.map(|now| data.track.displacement(now, 0)[0]), Some(player.seq() as f64));
    }
    let kept = feed.history().kept();
    assert!(kept.end - kept.start <= feed.history().capacity_for(3) + 2048, "{kept:?}");
}
