//! The slow picture, documents, snapshots and events: for those who are there, and for who comes later.

use rotor::builtin;
use wire::{Carrier, EVENTS_KEPT, Glance, Happening, Host, Listener, MAX_SNAPSHOT, NewsSender, SnapshotHead};

use crate::support::{LAYOUT, bench, bench_status, events, settings, tell, wait_for};

pub(crate) fn the_last_bench_status_reaches_who_comes_later(carrier: &impl Carrier) {
    let name = bench("news");
    let host = carrier.host(&name).unwrap();
    let mut bench_statuses = host.news().unwrap();
    (1..=3).for_each(|revision| bench_statuses.bench_status(&bench_status(revision)).unwrap());
    let mut listener = carrier.listen(&name).unwrap();
    // Shared memory delivers history with the next send.
    bench_statuses.welcome().unwrap();
    bench_statuses.bench_status(&bench_status(4)).unwrap();
    let heard = wait_for("a bench status", || listener.bench_status().unwrap());
    assert_eq!((heard.revision, heard.rotor().unwrap()), (4, builtin::rotor("three-mass").unwrap()));
    assert_eq!(heard.settings, settings(4.0));
    assert!(listener.bench_status().unwrap().is_none());
}

/// However settings are changed and changed back, whoever comes late, or slept, can put back all that the last events tell of.
pub(crate) fn documents_that_are_named_reach_who_comes_late_or_sleeps(carrier: &impl Carrier) {
    let name = bench("documents");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut sender = host.news().unwrap();
    sender.bench_status(&bench_status(1)).unwrap();
    let mut sleeper = carrier.listen(&name).unwrap();
    let speed = |number: u64| if number.is_multiple_of(3) { 1.0 } else { number as f64 };
    for number in 1..=400 {
        let mut event = Happening::Settings.event();
        event.number = number;
        event.settings = settings(speed(number));
        sender.event(&event).unwrap();
    }
    let mut late = carrier.listen(&name).unwrap();
    let mut glance = carrier.glance(&name).unwrap();
    sender.welcome().unwrap();
    sender.bench_status(&bench_status(1)).unwrap();
    for listener in [&mut sleeper, &mut late] {
        let mut told = Vec::new();
        listener.events(|event| told.push((event.number, event.settings.get().speed))).unwrap();
        let last: Vec<_> = (401 - EVENTS_KEPT as u64..=400).map(|number| (number, speed(number))).collect();
        assert_eq!(told, last);
        assert_eq!(listener.bench_status().unwrap().unwrap().settings, settings(1.0));
    }
    assert_eq!(glance.bench_status().unwrap().unwrap().rotor().unwrap().len(), 3);
}

pub(crate) fn snapshots_arrive_whole_and_the_last_one_for_who_comes_later(carrier: &impl Carrier) {
    let name = bench("snapshots");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut sender = host.news().unwrap();
    let mut early = carrier.listen(&name).unwrap();
    let words = |seq: u64| (0..40 * seq).map(|word| word ^ seq).collect::<Vec<u64>>();
    for seq in 1..=5 {
        sender.snapshot(&SnapshotHead { run_id: 7, seq, revision: 2, tau: 0.5 }, &words(seq)).unwrap();
    }
    let heard = |listener: &mut _| {
        let mut heard = Vec::new();
        Listener::snapshots(listener, |head, read| {
            assert_eq!(read, words(head.seq));
            heard.push(head.seq);
        })
        .unwrap();
        heard
    };
    assert_eq!(heard(&mut early), [1, 2, 3, 4, 5]);
    let mut late = carrier.listen(&name).unwrap();
    sender.welcome().unwrap();
    assert_eq!(heard(&mut late), [5]);
    let refused = sender.snapshot(&SnapshotHead::default(), &vec![0; MAX_SNAPSHOT + 1]).unwrap_err();
    assert_eq!(refused.to_string(), "a snapshot of 32769 words: expected at most 32768");
}

pub(crate) fn every_event_in_order_and_the_last_ones_for_who_comes_later(carrier: &impl Carrier) {
    let name = bench("events");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut sender = host.news().unwrap();
    let mut early = carrier.listen(&name).unwrap();
    let kept = EVENTS_KEPT as u64;
    (1..=kept).for_each(|number| tell(&mut sender, number));
    assert_eq!(events(&mut early), (1..=kept).collect::<Vec<_>>());
    (kept + 1..=kept + 10).for_each(|number| tell(&mut sender, number));
    let mut late = carrier.listen(&name).unwrap();
    // Without anything happening, what has happened comes.
    sender.welcome().unwrap();
    assert_eq!(events(&mut late), (11..=kept + 10).collect::<Vec<_>>());
    tell(&mut sender, kept + 11);
    assert_eq!(events(&mut late), [kept + 11]);
    assert_eq!(events(&mut early), (kept + 1..=kept + 11).collect::<Vec<_>>());
    // A sleeper loses the oldest, which the numbers show.
    (1000..2000).for_each(|number| tell(&mut sender, number));
    assert_eq!(events(&mut early), (2000 - kept..2000).collect::<Vec<_>>());
}

pub(crate) fn the_events_of_the_last_run_are_not_told_in_the_next(carrier: &impl Carrier) {
    let name = bench("runs");
    let host = carrier.host(&name).unwrap();
    let states = host.states(LAYOUT).unwrap();
    let mut sender = host.news().unwrap();
    let mut listener = carrier.listen(&name).unwrap();
    tell(&mut sender, 1);
    drop((sender, states, host));
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut sender = host.news().unwrap();
    tell(&mut sender, 7);
    let mut late = carrier.listen(&name).unwrap();
    sender.welcome().unwrap();
    assert_eq!(events(&mut late), [7]);
    assert_eq!(events(&mut listener), [1, 7], "who was there hears both");
}
