//! Requests and their answers, and a simulation that does not answer.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rotor::{C64, Settings, builtin};
use wire::{Answer, Carrier, Change, Commander, Host, HostState, Inbox, Listener, StateSender, WireError};

use crate::support::{LAYOUT, PATIENCE, bench, drained, number, wait_for};

pub(crate) fn requests_are_answered(carrier: &impl Carrier) {
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

pub(crate) fn a_silent_simulation_does_not_hang_its_readers(carrier: &impl Carrier) {
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

pub(crate) fn a_listener_hears_the_next_simulation_of_the_name(carrier: &impl Carrier) {
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
