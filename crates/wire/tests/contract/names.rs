//! Who has a name, and who gets in.

use std::sync::Barrier;
use std::thread;
use std::time::{Duration, Instant};

use wire::{Answer, Carrier, Change, Commander, Glance, Host, Inbox, MAX_READERS, NewsSender, WireError};

use crate::support::{LAYOUT, PATIENCE, bench, bench_status, wait_for};

pub(crate) fn nobody_home(carrier: &impl Carrier) {
    let missing = bench("missing");
    assert_eq!(carrier.recorder(&missing).err(), Some(WireError::NoBench(missing.clone())));
    assert_eq!(carrier.listen(&missing).err(), Some(WireError::NoBench(missing.clone())));
    assert_eq!(carrier.command(&missing).err(), Some(WireError::NoBench(missing)));
}

pub(crate) fn one_simulation_a_name(carrier: &impl Carrier) {
    let name = bench("mine");
    let first = carrier.host(&name).unwrap();
    let states = first.states(LAYOUT).unwrap();
    assert_eq!(carrier.host(&name).err(), Some(WireError::Taken(name.clone())));
    // Another name is another bench.
    drop(carrier.host(&bench("other")).unwrap());
    drop((states, first));
    carrier.host(&name).unwrap();
}

pub(crate) fn of_six_that_start_together_one_has_the_name_and_the_others_are_told_so(carrier: &impl Carrier) {
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

pub(crate) fn in_a_full_house_who_looks_or_asks_still_gets_in(carrier: &impl Carrier) {
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
