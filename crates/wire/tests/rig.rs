//! The example of a rig: what is in a file comes out as a bench, and what only a model knows does not.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rotor::{C64, builtin};
use wire::{
    BenchName, Carrier, Change, Commander, Glance, Happening, Listener, Memory, Point, State, Step, StepLayout,
};

#[path = "../examples/rig.rs"]
#[allow(dead_code, reason = "its command line is not tried here")]
mod rig;

const PATIENCE: Duration = Duration::from_secs(60);

fn file(text: &str) -> tempfile::NamedTempFile {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    file
}

#[test]
fn a_file_is_played_as_a_bench() {
    let rows: String =
        (0..50).map(|k| format!("{},{},2.5,0.25,{}\n", f64::from(k) * 0.02, f64::from(k) * 0.01, -k)).collect();
    let file = file(&format!("tau,y1,speed,uy,z1\n{rows}"));
    let rotor = builtin::rotor("jeffcott").unwrap();
    let measured = rig::Measured::read(file.path(), StepLayout::new(1)).unwrap();
    let carrier = Memory::with_room(1_000_000);
    let name = BenchName::default();
    let host = carrier.host(&name).unwrap();
    let mut listener = carrier.listen(&name).unwrap();
    let asked = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let playing = scope.spawn(|| {
            // Its ports are made in the thread that uses them.
            rig::Rig::new(&rotor, 500.0, &measured)
                .unwrap()
                .play(&host, &measured, |turn| turn < 2 || !asked.load(Ordering::Relaxed))
                .unwrap();
        });
        let mut commander = carrier.command(&name).unwrap();
        let mut ask = |change: Change| commander.ask(&change.request("test", "").unwrap(), PATIENCE).unwrap();
        assert!(ask(Change::Note { text: "it hums".into() }).is_accepted());
        let kick = ask(Change::Impulse { mass: 0, velocity: C64::new(1.0, 0.0) });
        assert!(!kick.is_accepted() && kick.reason.as_str().contains("a rig that plays a file"));
        asked.store(true, Ordering::Relaxed);
        playing.join().unwrap();
    });
    let mut states: Vec<State> = Vec::new();
    listener.drain(|state| states.push(State::of(&state))).unwrap();
    assert!(states.len() >= 100 && states.len().is_multiple_of(50), "{}", states.len());
    for (k, state) in states.iter().enumerate() {
        let row = (k % 50) as f64;
        assert_eq!((state.seq(), state.speed(), state.force_delivered()), (k as u64, 2.5, [0.25, 0.0]));
        // Time goes on where the file begins anew.
        assert!((state.tau() - k as f64 * 0.02).abs() < 1e-9);
        let Point { y, z, vy, vz } = state.point(0);
        assert_eq!((y, z, state.reading(0)), (row * 0.01, -row, [row * 0.01, -row]));
        // val: the slope of a straight line.
        assert!((vy - 0.5).abs() < 1e-9 && (vz + 50.0).abs() < 1e-9);
    }
    let start = Instant::now();
    let status = loop {
        if let Some(status) = listener.bench_status().unwrap() {
            break status;
        }
        assert!(start.elapsed() < PATIENCE);
    };
    assert_eq!((status.analysis.count, status.rotor_name.as_str(), status.dtau), (0, "jeffcott", 0.02));
    let mut told = Vec::new();
    listener.events(|event| told.push(event.happening().unwrap())).unwrap();
    assert!(told.contains(&Happening::Note("it hums".into())) && told.contains(&Happening::Ended), "{told:?}");
}

#[test]
fn what_is_no_such_file_is_told() {
    let told = |text: &str| rig::Measured::read(file(text).path(), StepLayout::new(2)).unwrap_err().to_string();
    assert_eq!(told(""), "an empty file");
    assert!(told("y1,z1,w\n").starts_with("column 'w': expected names among tau, angle, speed"));
    assert_eq!(told("y1,z1\n0,0\n"), "no column 'y2': expected y and z of each of 2 masses");
    assert_eq!(told("y1,z1,y2,z2\n0,0,0\n"), "line 2: expected 4 finite numbers");
    assert_eq!(told("y1,z1,y2,z2\n0,0,0,nan\n"), "line 2: expected 4 finite numbers");
    assert!(told("y1,z1,y2,z2\n0,0,0,x\n").starts_with("line 2: invalid float"));
    assert_eq!(told("y1,z1,y2,z2\n0,0,0,0\n"), "expected two steps and more");
}
