//! What every carrier promises, checked on shared memory and on the carrier for tests alike.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::path::Path;
use std::sync::Barrier;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rotor::{C64, Settings, builtin};
use wire::{
    Answer, BenchName, BenchStatus, Carrier, Change, Channel, Commander, ControlCommand, ControlHost, Controlling,
    EVENTS_KEPT, Glance, Happening, Host, HostState, Inbox, Keeping, Listener, MAX_BURST, MAX_READERS, MAX_SNAPSHOT,
    NewsSender, Readings, RecorderSender, RecorderState, RecorderStatus, RowMut, SettingsDocument, SnapshotHead,
    StateSender, Step, StepLayout, StepRow, Topic, WireError,
};

/// A rotor of three masses.
const LAYOUT: StepLayout = StepLayout::new(3);

const PATIENCE: Duration = Duration::from_secs(5);

fn bench(name: &str) -> BenchName {
    name.parse().unwrap()
}

/// States numbered from `first` on.
fn number(first: u64) -> impl FnMut(usize, &mut RowMut<'_>) {
    move |place, row| {
        let seq = first + place as u64;
        row.set_word(Channel::Seq, seq);
        row.set(Channel::Tau, 0, seq as f64 * 0.5);
    }
}

/// All states that have arrived, by sequence number.
fn drained(listener: &mut impl Listener) -> Vec<u64> {
    let mut seen = Vec::new();
    listener
        .drain(|state| {
            assert_eq!(state.tau(), state.seq() as f64 * 0.5);
            seen.push(state.seq());
        })
        .unwrap();
    seen
}

/// Waits for something that must come.
fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < PATIENCE, "{what} did not come");
        thread::sleep(Duration::from_millis(1));
    }
}

/// All events that have arrived, by number.
fn events(listener: &mut impl Listener) -> Vec<u64> {
    let mut seen = Vec::new();
    listener
        .events(|event| {
            assert_eq!(event.happening(), Some(Happening::Note(format!("number {}", event.number))));
            assert_eq!((event.settings.get().speed, event.who.as_str()), (event.number as f64, "somebody"));
            seen.push(event.number);
        })
        .unwrap();
    seen
}

/// Event `number`, after which the speed is just that.
fn tell(sender: &mut impl NewsSender, number: u64) {
    let mut event = Happening::Note(format!("number {number}")).event();
    event.number = number;
    event.who = wire::Text::new("somebody");
    event.settings = settings(number as f64);
    sender.event(&event).unwrap();
}

fn settings(speed: f64) -> SettingsDocument {
    let rotor = builtin::rotor("jeffcott").unwrap();
    SettingsDocument::of(&Settings::new(&rotor, speed, builtin::feedback(&rotor, "cancel").unwrap()))
}

/// A bench status of the three-mass rotor.
fn bench_status(revision: u64) -> BenchStatus {
    let mut bench_status = BenchStatus::default();
    bench_status.set_rotor(&builtin::rotor("three-mass").unwrap());
    bench_status.settings = settings(revision as f64);
    bench_status.revision = revision;
    bench_status
}

fn nobody_home(carrier: &impl Carrier) {
    let missing = bench("missing");
    assert_eq!(carrier.recorder(&missing).err(), Some(WireError::NoBench(missing.clone())));
    assert_eq!(carrier.listen(&missing).err(), Some(WireError::NoBench(missing.clone())));
    assert_eq!(carrier.command(&missing).err(), Some(WireError::NoBench(missing)));
}

fn one_simulation_a_name(carrier: &impl Carrier) {
    let name = bench("mine");
    let first = carrier.host(&name).unwrap();
    let states = first.states(LAYOUT).unwrap();
    assert_eq!(carrier.host(&name).err(), Some(WireError::Taken(name.clone())));
    // Another name is another bench.
    drop(carrier.host(&bench("other")).unwrap());
    drop((states, first));
    carrier.host(&name).unwrap();
}

fn of_six_that_start_together_one_has_the_name_and_the_others_are_told_so(carrier: &impl Carrier) {
    for round in 0..5 {
        let name = bench(&format!("six-{round}"));
        let (start, end) = (Barrier::new(6), Barrier::new(6));
        let taken = WireError::Taken(name.clone());
        let told = thread::scope(|scope| {
            let ask = || {
                start.wait();
                let got = carrier.host(&name).and_then(|host| Ok((host.states(LAYOUT)?, host.inbox()?, host)));
                // Who has it keeps it until all have asked.
                end.wait();
                got.err()
            };
            let asked: Vec<_> = (0..6).map(|_| scope.spawn(ask)).collect();
            asked.into_iter().map(|one| one.join().unwrap()).collect::<Vec<_>>()
        });
        let (had, refused): (Vec<_>, Vec<_>) = told.into_iter().partition(Option::is_none);
        assert_eq!((had.len(), refused), (1, vec![Some(taken); 5]));
    }
}

fn in_a_full_house_who_looks_or_asks_still_gets_in(carrier: &impl Carrier) {
    let name = bench("full");
    let host = carrier.host(&name).unwrap();
    let (_states, mut bench_statuses) = (host.states(LAYOUT).unwrap(), host.news().unwrap());
    let mut readers: Vec<_> = (0..MAX_READERS).map(|_| carrier.listen(&name).unwrap()).collect();
    // Each of them a dashboard, which asks too.
    let _asking: Vec<_> = readers.iter().map(|_| carrier.command(&name).unwrap()).collect();
    let refused = carrier.listen(&name).err().unwrap();
    assert_eq!(refused, WireError::Full { bench: name.clone(), what: "readers", most: MAX_READERS });
    assert!(refused.to_string().starts_with("bench 'full' is full: it has the 16 readers that it can take"));
    assert_eq!(host.listeners(), MAX_READERS);

    let mut glance = carrier.glance(&name).unwrap();
    bench_statuses.bench_status(&bench_status(7)).unwrap();
    assert_eq!(wait_for("a bench status", || glance.bench_status().unwrap()).revision, 7);
    assert_eq!(glance.recorder().unwrap(), None);
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut inbox = host.inbox().unwrap();
            let start = Instant::now();
            while inbox.serve(Duration::from_millis(20), |_| Answer::accepted(8, 9, 0.5)).unwrap() == 0 {
                assert!(start.elapsed() < PATIENCE, "the request did not come");
            }
        });
        let mut commander = carrier.command(&name).unwrap();
        let answer = commander.ask(&Change::Restart.request("me", "").unwrap(), PATIENCE).unwrap();
        assert_eq!(answer.revision, 8);
    });
    readers.pop();
    carrier.listen(&name).unwrap();
}

fn every_state_in_order(carrier: &impl Carrier) {
    let name = bench("order");
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    let mut early = carrier.listen(&name).unwrap();
    assert_eq!(host.listeners(), 1);
    (0..600).for_each(|seq| states.send(1, number(seq)).unwrap());
    assert_eq!(drained(&mut early), (0..600).collect::<Vec<_>>());
    let mut late = carrier.listen(&name).unwrap();
    (600..700).for_each(|seq| states.send(1, number(seq)).unwrap());
    assert_eq!(drained(&mut late), (600..700).collect::<Vec<_>>());
    drop(late);
    (700..800).for_each(|seq| states.send(1, number(seq)).unwrap());
    assert_eq!(drained(&mut early), (600..800).collect::<Vec<_>>());
}

fn states_that_are_sent_together_arrive_one_by_one(carrier: &impl Carrier) {
    let name = bench("bursts");
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    let mut listener = carrier.listen(&name).unwrap();
    let mut sent = 0;
    for count in [1, 20, 1, MAX_BURST, 3] {
        states.send(count, number(sent)).unwrap();
        sent += count as u64;
    }
    assert_eq!(drained(&mut listener), (0..sent).collect::<Vec<_>>());
    for count in [0, MAX_BURST + 1] {
        let refusal = states.send(count, number(sent)).err();
        assert_eq!(
            refusal.map(|error| error.to_string()).as_deref(),
            Some(&*format!("{count} states at once: expected 1 to 32"))
        );
    }
    // A burst is lost whole or not at all, and never out of order.
    (0..5000).for_each(|burst| states.send(7, number(burst * 7)).unwrap());
    let seen = drained(&mut listener);
    let first = 35_000 - seen.len() as u64;
    assert!(seen.len() >= 1000, "only {} kept", seen.len());
    assert_eq!(seen, (first..35_000).collect::<Vec<_>>());
}

fn a_sleeping_reader_loses_the_oldest_and_holds_nobody_up(carrier: &impl Carrier) {
    let name = bench("sleeper");
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    let mut sleeper = carrier.listen(&name).unwrap();
    let sent = 20_000;
    (0..sent).for_each(|seq| states.send(1, number(seq)).unwrap());
    let seen = drained(&mut sleeper);
    assert!(seen.len() >= 1000, "only {} kept", seen.len());
    assert_eq!(seen, (sent - seen.len() as u64..sent).collect::<Vec<_>>());
}

fn the_last_bench_status_reaches_who_comes_later(carrier: &impl Carrier) {
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
fn documents_that_are_named_reach_who_comes_late_or_sleeps(carrier: &impl Carrier) {
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

fn snapshots_arrive_whole_and_the_last_one_for_who_comes_later(carrier: &impl Carrier) {
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

fn every_event_in_order_and_the_last_ones_for_who_comes_later(carrier: &impl Carrier) {
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

fn the_events_of_the_last_run_are_not_told_in_the_next(carrier: &impl Carrier) {
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

fn one_recorder_a_bench_and_its_latest_status_for_all(carrier: &impl Carrier) {
    let name = bench("recorded");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut early = carrier.listen(&name).unwrap();
    assert_eq!(early.recorder().unwrap(), None);
    let mut recorder = carrier.recorder(&name).unwrap();
    assert_eq!(carrier.recorder(&name).err(), Some(WireError::Recorded(name.clone())));
    let mut status = RecorderStatus { rows: 1, path: wire::Text::new("/tmp/a.rrd"), ..RecorderStatus::default() };
    status.set_state(RecorderState::Recording);
    status.set_keeping(Keeping::Last(600.0));
    for rows in 1..=10 {
        status.rows = rows;
        recorder.send(&mut status).unwrap();
    }
    assert_eq!(early.recorder().unwrap().as_deref(), Some(&status));
    assert_eq!(early.recorder().unwrap().as_deref(), Some(&status), "it stays known");
    let mut late = carrier.listen(&name).unwrap();
    recorder.send(&mut status).unwrap();
    assert_eq!(late.recorder().unwrap().as_deref(), Some(&status));
    assert!(status.wall_ns > 0);
    // It fails, says so, and is remembered by who has heard it; the place is free.
    status.set_state(RecorderState::Failed);
    status.error = wire::Text::new("disk full");
    recorder.send(&mut status).unwrap();
    drop(recorder);
    let failed = early.recorder().unwrap().unwrap();
    assert_eq!((failed.state(), failed.error.as_str()), (RecorderState::Failed, "disk full"));
    assert_eq!(carrier.listen(&name).unwrap().recorder().unwrap(), None, "who comes later hears of no recorder");
    carrier.recorder(&name).unwrap();
}

fn a_recorder_that_goes_without_a_word_has_died(carrier: &impl Carrier) {
    let name = bench("lost");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut listener = carrier.listen(&name).unwrap();
    let mut recorder = carrier.recorder(&name).unwrap();
    let mut status = RecorderStatus::default();
    status.set_state(RecorderState::Recording);
    recorder.send(&mut status).unwrap();
    assert!(listener.recorder().unwrap().unwrap().is_recording());
    drop(recorder);
    wait_for("its death", || {
        let told = listener.recorder().unwrap().unwrap();
        (told.state() == RecorderState::Died).then_some(())
    });
    // A next one is heard by the same listener.
    let mut recorder = carrier.recorder(&name).unwrap();
    recorder.send(&mut status).unwrap();
    assert!(listener.recorder().unwrap().unwrap().is_recording());
}

fn one_controller_a_bench_and_the_last_readings_for_who_comes_later(carrier: &impl Carrier) {
    let name = bench("steered");
    assert_eq!(carrier.controller(&name).err(), Some(WireError::NoBench(name.clone())));
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut control = host.control().unwrap();
    control.send(&Readings { run_id: 7, number: 1, ..Readings::default() }).unwrap();

    let mut first = carrier.controller(&name).unwrap();
    assert_eq!(carrier.controller(&name).err(), Some(WireError::Controlled(name.clone())));
    let readings = wait_for("the last readings", || {
        control.welcome().unwrap();
        first.readings().unwrap()
    });
    assert_eq!((readings.run_id, readings.number, first.host()), (7, 1, HostState::Alive));
    first.command(&readings.answer([0.5, -0.25])).unwrap();
    let mut told = Vec::new();
    wait_for("a command", || (control.commands(|command| told.push(*command)).unwrap() > 0).then_some(()));
    assert_eq!((told[0].number, told[0].command[0], told[0].is_finite(1)), (1, [0.5, -0.25], true));

    // Faster than anybody reads, it loses the oldest, and holds nobody up.
    for number in 2..100 {
        control.send(&Readings { run_id: 7, number, ..Readings::default() }).unwrap();
        first.command(&ControlCommand { run_id: 7, number, ..ControlCommand::default() }).unwrap();
    }
    let mut last = 0;
    wait_for("the last command", || {
        control.commands(|command| last = command.number).unwrap();
        (last == 99).then_some(())
    });
    let newest = std::iter::from_fn(|| first.readings().unwrap()).last().unwrap();
    assert_eq!(newest.number, 99);
    // Its place is free when it goes.
    drop(first);
    carrier.controller(&name).unwrap();
    let bad = ControlCommand { command: [[f64::NAN; 2]; 8], ..ControlCommand::default() };
    assert!(!bad.is_finite(1) && bad.is_finite(0));
}

fn requests_are_answered(carrier: &impl Carrier) {
    let name = bench("answers");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let settings = Settings::new(
        &builtin::rotor("three-mass").unwrap(),
        2.5,
        builtin::feedback(&builtin::rotor("three-mass").unwrap(), "composite").unwrap(),
    );
    let changes = [
        Change::Settings { base_revision: 7, settings },
        Change::Impulse { mass: 2, velocity: C64::new(0.5, -0.25) },
        Change::Restart,
        Change::Note { text: "here it begins".into() },
        Change::Excite(
            "seed=1 period=50.0 lines=1..40 tones=20 away_from=2.5 amplitude=0.125 duration=250.0".parse().unwrap(),
        ),
        Change::EndExcitation,
    ];
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut inbox = host.inbox().unwrap();
            let mut asked = Vec::new();
            let start = Instant::now();
            while !done.load(Ordering::Relaxed) && start.elapsed() < PATIENCE {
                inbox
                    .serve(Duration::from_millis(20), |request| {
                        let said = |text: &str| text.to_owned();
                        asked.push((
                            said(request.who.as_str()),
                            said(request.why.as_str()),
                            Change::of(request).unwrap(),
                        ));
                        if asked.len() == 2 {
                            Answer::refused(9, "no")
                        } else {
                            Answer::accepted(8, 1000 + asked.len() as u64, 2.5)
                        }
                    })
                    .unwrap();
            }
            assert_eq!(asked, changes.clone().map(|change| ("me".to_owned(), "why not".to_owned(), change)));
        });
        let mut commander = carrier.command(&name).unwrap();
        let answers =
            changes.clone().map(|change| commander.ask(&change.request("me", "why not").unwrap(), PATIENCE).unwrap());
        assert_eq!(answers[0], Answer::accepted(8, 1001, 2.5));
        assert_eq!((answers[1].is_accepted(), answers[1].reason.as_str()), (false, "no"));
        assert_eq!(answers[2].applied_at_step, 1003);
        done.store(true, Ordering::Relaxed);
    });
}

fn a_silent_simulation_does_not_hang_its_readers(carrier: &impl Carrier) {
    let name = bench("silent");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let _inbox = host.inbox().unwrap();
    let mut commander = carrier.command(&name).unwrap();
    let request = Change::Restart.request("me", "why not").unwrap();
    for _ in 0..4 {
        let start = Instant::now();
        assert_eq!(commander.ask(&request, Duration::from_millis(20)), Err(WireError::NoAnswer(name.clone())));
        assert!(start.elapsed() >= Duration::from_millis(20));
    }
}

fn a_listener_hears_the_next_simulation_of_the_name(carrier: &impl Carrier) {
    let name = bench("again");
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    let mut listener = carrier.listen(&name).unwrap();
    let mut commander = carrier.command(&name).unwrap();
    states.send(1, number(5)).unwrap();
    assert_eq!(listener.host(), HostState::Alive);
    drop((states, host));
    wait_for("the end", || (listener.host() == HostState::Gone).then_some(()));
    assert!(commander.ask(&Change::Restart.request("me", "why not").unwrap(), Duration::from_millis(20)).is_err());
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    assert_eq!(listener.host(), HostState::Alive);
    states.send(1, number(0)).unwrap();
    assert_eq!(drained(&mut listener), [5, 0]);
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut inbox = host.inbox().unwrap();
            let start = Instant::now();
            while inbox.serve(Duration::from_millis(20), |_| Answer::accepted(1, 2, 0.5)).unwrap() == 0 {
                assert!(start.elapsed() < PATIENCE, "the request did not come");
            }
        });
        let answer = commander.ask(&Change::Restart.request("me", "why not").unwrap(), PATIENCE).unwrap();
        assert_eq!(answer.applied_at_step, 2);
    });
}

/// Runs every promise on one carrier, each as its own test.
macro_rules! contract {
    ($carrier:ident: $make:expr; $($promise:ident)+) => {
        mod $carrier {
            $(#[test]
            fn $promise() {
                let (_keep, carrier) = $make;
                super::$promise(&carrier);
            })+
        }
    };
}

macro_rules! on {
    ($carrier:ident: $make:expr) => {
        contract! { $carrier: $make;
            nobody_home
            one_simulation_a_name
            of_six_that_start_together_one_has_the_name_and_the_others_are_told_so
            in_a_full_house_who_looks_or_asks_still_gets_in
            every_state_in_order
            states_that_are_sent_together_arrive_one_by_one
            a_sleeping_reader_loses_the_oldest_and_holds_nobody_up
            the_last_bench_status_reaches_who_comes_later
            documents_that_are_named_reach_who_comes_late_or_sleeps
            snapshots_arrive_whole_and_the_last_one_for_who_comes_later
            every_event_in_order_and_the_last_ones_for_who_comes_later
            the_events_of_the_last_run_are_not_told_in_the_next
            one_recorder_a_bench_and_its_latest_status_for_all
            a_recorder_that_goes_without_a_word_has_died
            one_controller_a_bench_and_the_last_readings_for_who_comes_later
            requests_are_answered
            a_silent_simulation_does_not_hang_its_readers
            a_listener_hears_the_next_simulation_of_the_name
        }
    };
}

on!(memory: ((), wire::Memory::default()));
on!(shared_memory: {
    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    (dir, carrier)
});

/// Names in POSIX shared memory that belong to this root.
fn in_shared_memory(root: &wire::Root) -> usize {
    std::fs::read_dir("/dev/shm").map_or(0, |entries| {
        entries.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with(root.prefix())).count()
    })
}

/// Where the recorder that shall be killed finds its root.
const RECORDER_ROOT: &str = "WHIRL_TEST_RECORDER_ROOT";

/// Not a test but the recorder that the next one kills: this binary, started again.
#[test]
fn recorder_to_be_killed() {
    let Some(root) = std::env::var_os(RECORDER_ROOT) else { return };
    let root = wire::Root::at(std::path::Path::new(&root)).unwrap();
    let carrier = wire::SharedMemory::new(&root, "record").unwrap();
    let mut recorder = carrier.recorder(&bench("killed")).unwrap();
    let mut status = RecorderStatus { pid: std::process::id(), ..RecorderStatus::default() };
    status.set_state(RecorderState::Recording);
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(60) {
        recorder.send(&mut status).unwrap();
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_killed_recorder_has_died_and_the_next_one_takes_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let name = bench("killed");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut listener = carrier.listen(&name).unwrap();
    let mut child = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "recorder_to_be_killed"])
        .env(RECORDER_ROOT, dir.path())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let recording = wait_for("the recorder", || listener.recorder().unwrap());
    assert_eq!((recording.state(), recording.pid), (RecorderState::Recording, child.id()));
    assert_eq!(carrier.recorder(&name).err(), Some(WireError::Recorded(name.clone())));
    child.kill().unwrap();
    child.wait().unwrap();
    let told = listener.recorder().unwrap().unwrap();
    assert_eq!((told.state(), told.pid), (RecorderState::Died, recording.pid));
    let mut late = carrier.listen(&name).unwrap();
    assert_eq!(late.recorder().unwrap(), None);
    carrier.recorder(&name).unwrap();
}

/// The number of the first step of a message.
fn first_seq(words: &[u64]) -> u64 {
    StepRow::all(words).next().unwrap().seq()
}

/// iceoryx2 as a program in another language would set it up: it knows the folder and the prefix, and has no lease.
fn foreign(root: &wire::Root) -> iceoryx2::config::Config {
    use iceoryx2::prelude::*;

    let mut config = Config::default();
    let path = root.iceoryx2();
    config.global.set_root_path(&iceoryx2::prelude::Path::new(path.as_os_str().as_encoded_bytes()).unwrap());
    config.global.prefix = FileName::new(root.prefix().as_bytes()).unwrap();
    config
}

/// A bench as another version of whirl would make it: the same services, another schema.
#[test]
fn a_bench_of_another_version_is_told_so_in_words() {
    use iceoryx2::prelude::*;

    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let config = foreign(&root);
    let node = NodeBuilder::new().name(&"sim".try_into().unwrap()).config(&config).create::<ipc::Service>().unwrap();
    let _other = node
        .service_builder(&"whirl/other/state".try_into().unwrap())
        .publish_subscribe::<[u64]>()
        .create_with_attributes(
            &AttributeSpecifier::new().define(&"whirl.schema".try_into().unwrap(), &"0".try_into().unwrap()).unwrap(),
        )
        .unwrap();
    for refusal in [carrier.listen(&bench("other")).err(), carrier.host(&bench("other")).err()] {
        let words = refusal.unwrap().to_string();
        assert!(words.starts_with("bench 'other' was started by another version of whirl"), "{words}");
    }
}

/// Every service that a bench makes is one of the list, and every one of the list is made.
#[test]
fn the_services_of_a_bench_are_those_of_the_list() {
    use iceoryx2::prelude::*;

    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let host = carrier.host(&bench("all")).unwrap();
    let _ports = (host.states(LAYOUT).unwrap(), host.news().unwrap(), host.inbox().unwrap());
    let _recorder = carrier.recorder(&bench("all")).unwrap();
    let mut found = Vec::new();
    ipc::Service::list(&foreign(&root), |service| {
        found.push(service.static_details.name().as_str().to_owned());
        CallbackProgression::Continue
    })
    .unwrap();
    found.sort();
    let mut listed = Topic::ALL.map(|topic| format!("whirl/all/{topic}"));
    listed.sort();
    assert_eq!(found, listed);
}

#[test]
fn nothing_is_left_when_the_last_one_goes() {
    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let witness = root.prefix().to_owned();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let host = carrier.host(&bench("brief")).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    states.send(1, number(1)).unwrap();
    assert!(in_shared_memory(&root) > 0);
    drop((states, host, carrier, root));
    let left: Vec<_> = std::fs::read_dir("/dev/shm").unwrap().flatten().map(|e| e.file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().starts_with(&witness)), "{left:?}");
    let files: Vec<_> = std::fs::read_dir(dir.path()).unwrap().flatten().map(|e| e.file_name()).collect();
    assert_eq!(files, ["lease"]);
}

#[test]
fn benches_are_listed_with_who_is_attached() {
    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    assert_eq!(carrier.benches().unwrap(), []);
    let host = carrier.host(&bench("b")).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let other = carrier.host(&bench("a")).unwrap();
    let _listener = carrier.listen(&bench("b"));
    let benches = carrier.benches().unwrap();
    let summary: Vec<_> = benches
        .iter()
        .map(|b| (b.name.as_str(), b.is_running(), b.processes.iter().map(|p| p.role.as_str()).collect::<Vec<_>>()))
        .collect();
    assert_eq!(summary, [("a", true, vec!["sim"]), ("b", true, vec!["sim", "test"])]);
    assert!(benches[0].processes.iter().all(|process| process.pid == std::process::id()));
    drop(other);
}

/// The whole of a bench, used once under `root`.
fn works_under(path: &Path) {
    let root = wire::Root::at(path).unwrap_or_else(|error| panic!("{error}"));
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let name = bench("here");
    let host = carrier.host(&name).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let (mut states, _inbox) = (host.states(LAYOUT).unwrap(), host.inbox().unwrap());
    let mut listener = carrier.listen(&name).unwrap();
    let _commander = carrier.command(&name).unwrap();
    states.send(1, number(3)).unwrap();
    assert_eq!(drained(&mut listener), [3]);
    // Another process would come by the same name, whatever it calls the folder.
    let again = wire::Root::at(&path.join(".")).unwrap();
    let seen = wire::SharedMemory::new(&again, "other").unwrap().benches().unwrap();
    assert_eq!(seen[0].name, name);
}

#[test]
fn a_root_may_be_as_long_as_the_system_lets_it_be_and_have_any_characters() {
    use std::os::unix::ffi::OsStrExt;

    let dir = tempfile::tempdir().unwrap();
    let mut links = Vec::new();
    let mut try_at = |path: &Path| {
        works_under(path);
        // All that stays is the empty root: its own files have gone, and so has its short name.
        let files: Vec<_> = std::fs::read_dir(path).unwrap().flatten().map(|e| e.file_name()).collect();
        assert_eq!(files, ["lease"], "{}", path.display());
        links.push(std::fs::canonicalize(path).unwrap());
    };
    // Around every limit that there is: sockets, the paths of iceoryx2, and far beyond.
    let here = dir.path().as_os_str().len() + 1;
    for length in (here + 1..=60).chain([80, 120, 160, 254, 256, 300]) {
        let mut path = dir.path().join("x".repeat((length - here).min(100)));
        while path.as_os_str().len() + 1 < length {
            path.push("y".repeat((length - path.as_os_str().len() - 1).min(100)));
        }
        try_at(&path);
    }
    for name in ["m\u{fc}hle", "\u{65e5}\u{672c}", "two words", "what? *<|>\"'"] {
        try_at(&dir.path().join(name));
    }
    try_at(&dir.path().join(std::ffi::OsStr::from_bytes(b"not \xff utf-8")));
    let user = rustix::process::geteuid().as_raw();
    for entry in std::fs::read_dir(format!("/tmp/whirl-{user}")).into_iter().flatten().flatten() {
        let leads = std::fs::read_link(entry.path()).unwrap_or_default();
        assert!(!links.contains(&leads), "{} was left", entry.path().display());
    }
    let beyond = dir.path().join("z".repeat(300));
    let told = wire::Root::at(&beyond).unwrap_err().to_string();
    assert!(told.contains("cannot be made: File name too long"), "{told}");
}

#[test]
fn a_reader_that_holds_no_lease_keeps_its_services_when_the_last_of_ours_goes() {
    use iceoryx2::prelude::*;

    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let config = foreign(&root);
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let name = bench("shared");
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    let node = NodeBuilder::new().config(&config).create::<ipc::Service>().unwrap();
    let service = node.service_builder(&"whirl/shared/state".try_into().unwrap());
    let subscriber = service.publish_subscribe::<[u64]>().open().unwrap().subscriber_builder().create().unwrap();
    states.send(1, number(1)).unwrap();
    drop((states, host, carrier, root));

    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    // Asked to clean up, we leave it alone too.
    assert_eq!(wire::clean(&carrier).unwrap(), 0);
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    assert_eq!(host.listeners(), 1);
    states.send(1, number(2)).unwrap();
    let heard: Vec<u64> =
        std::iter::from_fn(|| subscriber.receive().unwrap()).map(|s| first_seq(s.payload())).collect();
    assert_eq!(heard, [1, 2], "it hears the next simulation of the name");
    drop((states, host, carrier, subscriber, node));
    drop(root);
    let files: Vec<_> = std::fs::read_dir(dir.path()).unwrap().flatten().map(|e| e.file_name()).collect();
    assert_eq!(files, ["lease"]);
}
