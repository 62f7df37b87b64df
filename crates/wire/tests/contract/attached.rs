//! A recorder, or a controller outside: one a bench.

use wire::{
    Carrier, ControlCommand, ControlHost, Controlling, Glance, Host, HostState, Keeping, Readings, RecorderSender,
    RecorderState, RecorderStatus, WireError,
};

use crate::support::{LAYOUT, bench, wait_for};

pub(crate) fn one_recorder_a_bench_and_its_latest_status_for_all(carrier: &impl Carrier) {
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

pub(crate) fn a_recorder_that_goes_without_a_word_has_died(carrier: &impl Carrier) {
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

pub(crate) fn one_controller_a_bench_and_the_last_readings_for_who_comes_later(carrier: &impl Carrier) {
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
