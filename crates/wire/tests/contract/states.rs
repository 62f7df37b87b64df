//! Every step, in order.

use wire::{Carrier, Host, MAX_BURST, StateSender};

use crate::support::{LAYOUT, bench, drained, number};

pub(crate) fn every_state_in_order(carrier: &impl Carrier) {
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

pub(crate) fn states_that_are_sent_together_arrive_one_by_one(carrier: &impl Carrier) {
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

pub(crate) fn a_sleeping_reader_loses_the_oldest_and_holds_nobody_up(carrier: &impl Carrier) {
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
