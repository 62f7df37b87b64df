//! Snapshots in recordings: whoever goes on from one gets what happened, to the last bit, whatever the loop holds.

use std::path::Path;

use machine::{Machine, Program, StateWords};
use promises::{Root, run};
use rotor::C64;
use tape::{Recording, Snapshot};
use wire::{Happening, State, Step};

use super::recorder::{Recorder, info, steps, text, wait};

/// A machine at a snapshot, under the settings that the next step was made with.
fn at(recording: &Recording, snapshot: &Snapshot) -> Machine {
    let revision = recording.settings_at(snapshot.next).unwrap();
    let (rotor, dtau) = (recording.rotor(), recording.session().dtau);
    let mut machine = Machine::new(Program::in_substeps(rotor, &revision.settings, dtau, revision.substeps).unwrap());
    assert!(machine.restore(&mut StateWords::from_saved(snapshot.words.clone())), "before step {}", snapshot.next);
    machine
}

fn is_there(machine: &Machine, state: &State) -> bool {
    let (sample, pair) = (machine.sample(), |z: C64| [z.re, z.im]);
    let mut points = sample.displacement.iter().zip(sample.velocity).zip(state.points());
    (sample.tau, sample.angle) == (state.tau(), state.angle())
        && pair(sample.outputs[0].delivered) == state.force_delivered()
        && pair(sample.outputs[0].commanded) == state.force_commanded()
        && points.all(|((p, v), point)| pair(*p) == [point.y, point.z] && pair(*v) == [point.vy, point.vz])
        && (0..state.masses()).all(|mass| pair(machine.reading(mass)) == state.reading(mass))
}

/// Does to a machine what was done to the recorded one before step `seq`. Whether no time passes over it: in a run without a
/// bench an impulse has a row of its own.
fn done_to(machine: &mut Machine, recording: &Recording, seq: u64) -> bool {
    let (rotor, session) = (recording.rotor(), recording.session());
    for revision in recording.revisions().iter().filter(|revision| revision.from == seq) {
        let program = Program::in_substeps(rotor, &revision.settings, session.dtau, revision.substeps).unwrap();
        machine.load(&mut Box::new(program));
    }
    let mut is_struck = false;
    for event in recording.events().iter().filter(|event| event.at.seq == seq) {
        match event.happening {
            Happening::Impulse { mass, velocity } => {
                machine.kick(mass, velocity);
                is_struck = true;
            }
            Happening::Restarted => machine.restart(),
            _ => {}
        }
    }
    if let Some((_, dtau)) = recording.paces().iter().find(|(at, _)| *at == seq) {
        machine.pace(*dtau);
    }
    is_struck && session.rate_hz == 0.0
}

/// Goes on from snapshots all over a recording to its end.
fn goes_on(path: &Path) {
    let recorded = steps(path);
    let mut recording = Recording::open(path).unwrap();
    assert!(recording.damage().is_empty(), "{:?}", recording.notices());
    let (first, last) = (*recorded.keys().next().unwrap(), *recorded.keys().last().unwrap());
    let begun = recording.paces()[0].0.max(first + 1);
    for from in [begun, begun + 400, first + (last - first) / 3, first + (last - first) / 2, last - 10] {
        let snapshot = recording.snapshot_before(from).unwrap().expect("one at the beginning");
        let mut machine = at(&recording, &snapshot);
        for seq in snapshot.next..=last {
            // What came before its own step has been done.
            let is_still = seq > snapshot.next && done_to(&mut machine, &recording, seq);
            if !is_still {
                machine.step();
            }
            if let Some(state) = recorded.get(&seq) {
                assert!(is_there(&machine, state), "step {seq} from that before {} on", snapshot.next);
            }
        }
    }
}

#[test]
fn a_run_on_file_is_gone_on_with_to_the_last_bit_whatever_its_loop_holds() {
    let root = Root::new();
    let feedback = root.path().join("filtered.toml");
    let filters = r#"filter = [{ kind = "lowpass", corner = 60.0, order = 2 }]"#;
    let text_of = |filter: &str| {
        format!(
            "bearing = 1\n\n[[signal]]\ndisplacement = [1, 1, 0]\nvelocity = [1, 1, 0]\nkd = -0.39\ncd = 0.49\nkc = -0.56\n\
             cc = 0.56\n{filter}\n"
        )
    };
    std::fs::write(&feedback, text_of(filters)).unwrap();
    let everything =
        ["delay=0.02", "noise=0.001", "lag=0.01", "sensor_lag=0.01", "limit=5", "slew=60", "quantum=0.0005"];
    let sampled = [&everything[..], &["sample=0.025"]].concat();
    let cases: [&[&str]; 8] = [
        &[],
        &["delay=0.033"],
        &["noise=0.01", "seed=5"],
        &["lag=0.03"],
        &["sample=0.04"],
        &["slew=0.8"],
        &everything,
        &sampled,
    ];
    for (number, parts) in cases.iter().enumerate() {
        let path = root.path().join(format!("{number}.rrd"));
        let mut arguments =
            vec!["run", "three-mass", "--feedback", text(&feedback), "--speed", "2.5", "--deadband", "1"];
        arguments.extend([
            "--duration",
            "60",
            "--impulse",
            "mass=2,vy=0.5,at=21.3",
            "--impulse",
            "mass=1,vz=0.7,at=40",
        ]);
        parts.iter().for_each(|part| arguments.extend(["--set", part]));
        arguments.extend(["--out", text(&path)]);
        let ran = run(&arguments);
        assert_eq!(ran.code, Some(0), "{parts:?}: {ran:?}");
        assert!(info(&path)["snapshots"].as_u64().unwrap() >= 3, "{parts:?}");
        goes_on(&path);
    }
}

#[test]
fn a_bench_on_file_is_gone_on_with_to_the_last_bit_whatever_its_loop_holds() {
    let root = Root::new();
    let loops: [&[&str]; 2] = [
        &["delay=0.02", "noise=0.001", "lag=0.01", "sensor_lag=0.01", "limit=5", "slew=60", "quantum=0.0005"],
        &["delay=0.02", "noise=0.001", "lag=0.01", "sample=0.04", "slew=60", "ramp=0.5"],
    ];
    for (number, parts) in loops.iter().enumerate() {
        let path = root.path().join(format!("{number}.rrd"));
        let mut arguments = vec!["three-mass", "--feedback", "composite", "--speed", "2.5", "--deadband", "1"];
        arguments.extend(["--rate", "2000"]);
        parts.iter().for_each(|part| arguments.extend(["--set", part]));
        let simulation = root.simulate(&arguments);
        let recorder = Recorder::start(&root, &path, &[]);
        let set = |change: &str| assert_eq!(root.run(&["set", "--force", change]).code, Some(0), "{change}");
        // As many steps in between as it takes to be worth while.
        let wait_on = |count: u64| {
            let seq = || root.run(&["tail", "--count", "1", "--json"]).json()["seq"].as_u64().unwrap();
            let until = seq() + count;
            wait("some steps", || seq() >= until);
        };
        wait_on(1500);
        ["kd=-0.5", "speed=3", "delay=0.03"].iter().for_each(|change| {
            set(change);
            wait_on(700);
        });
        wait_on(3000);
        assert_eq!(recorder.end().code, Some(0));
        drop(simulation);
        assert!(info(&path)["snapshots"].as_u64().unwrap() >= 3, "{}", info(&path));
        goes_on(&path);
    }
}

/// The head of a recording holds the rotor's own file, of which the very same rotor is made again, matrices and all.
#[test]
fn rotors_of_a_shaft_and_of_matrices_are_opened_again_and_gone_on_with_to_the_last_bit() {
    let root = Root::new();
    let given = "name = 'given'\nunits = 'si'\n[plant]\nstations = [1, 3]\npositions = [0.0, 0.5]\n\
        mass = [[3.0, 0.1, 0.0], [0.1, 0.05, 0.0], [0.0, 0.0, 2.0]]\n\
        gyroscopic = [[0.0, 0.0, 0.0], [0.0, 0.08, 0.0], [0.0, 0.0, 0.0]]\n\
        stiffness = [[9e4, 2e3, -4e4], [2e3, 4e3, 1e3], [-4e4, 1e3, 7e4]]\n\
        [[bearing]]\nstation = 1\nstiffness = 2e5\ndamping = 150.0\n\
        [[seal]]\nstation = 2\ndamping = 40.0\n[[unbalance]]\nstation = 2\ngmm = 50.0\n";
    let file = root.path().join("given.toml");
    std::fs::write(&file, given).unwrap();
    for (name, rotor) in [("shaft", "rig"), ("matrices", text(&file))] {
        let path = root.path().join(format!("{name}.rrd"));
        let ran = run(&["run", rotor, "--speed", "1500", "--duration", "30", "--out", text(&path)]);
        assert_eq!(ran.code, Some(0), "{name}: {ran:?}");
        let recording = Recording::open(&path).unwrap();
        let expected = match name {
            "shaft" => rotor::builtin::rotor("rig").unwrap(),
            _ => rotor::file::read_rotor(given, "given").unwrap(),
        };
        assert_eq!(recording.rotor(), &expected, "{name}");
        assert!(info(&path)["snapshots"].as_u64().unwrap() >= 1, "{name}");
        goes_on(&path);
        let told = run(&["export", text(&path), "--csv"]);
        assert_eq!(told.code, Some(0), "{name}: {}", told.stderr);
        let table = std::fs::read_to_string(path.with_extension("csv")).unwrap();
        assert_eq!(table.lines().count(), steps(&path).len() + 1, "{name}");
    }
}
