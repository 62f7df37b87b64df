//! Any process joins: what it is told of a bench, controllers outside in other languages, and clients that are killed.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]
#![allow(clippy::print_stderr, reason = "what was not tested is to be seen")]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use machine::{Machine, Pace, Program};
use promises::{PATIENCE, Root};
use rotor::{Settings, builtin};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use wire::message::Flags;
use wire::{BenchName, Carrier, Glance, Listener, SharedMemory, State, Step};

#[test]
fn wire_says_how_a_bench_is_found_and_what_it_sends() {
    let root = Root::new();
    let told = root.run(&["wire", "--bench", "a", "--json"]).json();
    assert_eq!((&told["bench"]["running"], &told["bench"]["width"]), (&false.into(), &Value::Null));
    let simulation = root.simulate(&["three-mass", "--bench", "a"]);
    let told = root.run(&["wire", "--bench", "a", "--json"]).json();
    assert_eq!((&told["schema"], &told["bench"]["rotor"]), (&wire::SCHEMA.into(), &"three-mass".into()));
    assert_eq!((&told["bench"]["masses"], &told["bench"]["width"]), (&3.into(), &31.into()));
    assert_eq!(
        told["bench"]["columns"][13],
        serde_json::json!({
            "place": 13, "name": "y1", "type": "f64", "unit": "e_t", "meaning": "displacement, y, of mass 1"
        })
    );
    assert!(told["iceoryx2"]["root"].as_str().unwrap().ends_with("/iceoryx2"));
    let services = told["services"].as_array().unwrap();
    assert_eq!(services.len(), 10);
    for service in services {
        assert!(service["name"].as_str().unwrap().starts_with("whirl/a/"), "{service}");
        // Its hashed name is that of the file which iceoryx2 has made; a recorder, which there is none of, makes its own.
        let file = Path::new(service["file"].as_str().unwrap());
        assert!(file.exists() || service["from"] == "recorder", "{service}");
    }
    let status = told["messages"].as_array().unwrap().iter().find(|m| m["type"] == "whirl.BenchStatus").unwrap();
    let field = status["fields"].as_array().unwrap().iter().find(|field| field["name"] == "scales").unwrap();
    assert_eq!((&field["type"], &field["shape"]), (&"f64".into(), &serde_json::json!([4])));
    let people = root.run(&["wire", "--bench", "a"]).stdout;
    assert!(people.starts_with("schema ") && people.contains("a runs three-mass: a step has 31 words"), "{people}");
    drop(simulation);
}

/// The controller in C, compiled; `None` where there is no compiler.
fn compiled(folder: &Path) -> Option<PathBuf> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let made = folder.join("controller");
    let compiler = Command::new("cc")
        .args(["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off", "-I"])
        .arg(top.join("crates/wire"))
        .arg("-o")
        .args([&made, &top.join("crates/wire/c/controller.c")])
        .output();
    let Ok(compiler) = compiler else {
        eprintln!("NOT TESTED: there is no compiler 'cc' here, so no controller in C was tried");
        return None;
    };
    assert!(compiler.status.success(), "{}", String::from_utf8_lossy(&compiler.stderr));
    Some(made)
}

/// A process that is ended with the test.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn patiently<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < PATIENCE, "{what} did not come");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A listener in this process.
fn listen(root: &Root, bench: &str) -> <SharedMemory as Carrier>::Listener {
    let carrier = SharedMemory::new(&wire::Root::at(root.path()).unwrap(), "test").unwrap();
    let name: BenchName = bench.parse().unwrap();
    patiently("the bench", || carrier.listen(&name).ok())
}

#[test]
fn val_a_controller_in_c_is_the_built_in_law_to_the_last_bit() {
    let (root, folder) = (Root::new(), tempfile::tempdir().unwrap());
    let Some(controller) = compiled(folder.path()) else { return };
    let mut sim = root.whirl();
    sim.args(["sim", "three-mass", "--bench", "c", "--feedback", "individual", "--speed", "2.5", "--deadband", "1"]);
    sim.args(["--set", "sample=0.01", "--set", "external=20", "--lockstep"]);
    let _sim = Ended(sim.stdout(Stdio::null()).spawn().unwrap());
    let mut listener = listen(&root, "c");
    let mut control = root.whirl();
    control.args(["control", "--bench", "c", "--"]).arg(&controller).stdout(Stdio::null());
    let _control = Ended(control.spawn().unwrap());
    let mut states: Vec<State> = Vec::new();
    patiently("steps", || {
        listener.drain(|state| states.push(State::of(&state))).unwrap();
        (states.len() >= 2000).then_some(())
    });

    let rotor = builtin::rotor("three-mass").unwrap();
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "individual").unwrap());
    settings.deadband.fill(1.0);
    settings.assign("sample", "0.01").unwrap();
    let pace = Pace { dtau: 0.01, rate_hz: 1000.0 };
    let mut machine = Machine::new(Program::compile(&rotor, &settings, [2.5; 2], pace).unwrap());
    for (k, state) in states.iter().enumerate() {
        machine.step();
        let sample = machine.sample();
        assert_eq!((state.seq(), state.flags().has(Flags::EXTERNAL)), (k as u64, true));
        for (point, (p, v)) in state.points().zip(sample.displacement.iter().zip(sample.velocity)) {
            let bits = |numbers: [f64; 4]| numbers.map(f64::to_bits);
            assert_eq!(bits([point.y, point.z, point.vy, point.vz]), bits([p.re, p.im, v.re, v.im]), "step {k}");
        }
    }
    // One controller a bench.
    let second = root.run(&["control", "--bench", "c", "--", "true"]);
    assert_eq!(second.code, Some(3));
    assert!(second.stderr.contains("is controlled from outside already"), "{second:?}");
}

#[test]
fn what_control_cannot_do_is_told() {
    let root = Root::new();
    let none = root.run(&["control", "--bench", "none", "--", "true"]);
    assert_eq!((none.code, none.stderr.contains("no bench 'none' is running")), (Some(3), true), "{none:?}");
    let arguments = ["three-mass", "--bench", "a", "--feedback", "individual", "--set=sample=0.01", "--set=delay=0.05"];
    let simulation = root.simulate(&[&arguments[..], &["--set=external=20"]].concat());
    let missing = root.run(&["control", "--bench", "a", "--", "./no-such-program"]);
    assert_eq!(
        (missing.code, missing.stderr.contains("./no-such-program: cannot be started")),
        (Some(2), true),
        "{missing:?}"
    );
    let ended = root.run(&["control", "--bench", "a", "--", "true"]);
    assert_eq!(
        (ended.code, ended.stderr.contains("true sent no further command after 0")),
        (Some(1), true),
        "{ended:?}"
    );
    let told = |arguments: &[&str]| root.run(arguments);
    let at_once = told(&["set", "--bench", "a", "delay=off"]);
    assert!(at_once.stderr.contains("external: delay = 0: expected at least 0.01"), "{at_once:?}");
    let lockstep = told(&["sim", "three-mass", "--bench", "b", "--lockstep"]);
    assert_eq!((lockstep.code, lockstep.stderr.contains("expected external = N")), (Some(2), true), "{lockstep:?}");
    let paced = told(&["sim", "three-mass", "--bench", "b", "--lockstep", "--rate", "10"]);
    assert_eq!(paced.code, Some(2), "{paced:?}");
    assert_eq!(simulation.end().code, Some(0));
}

/// `whirl control` at work, and what it says on stderr.
struct Controlled {
    process: Ended,
    told: PathBuf,
}

impl Controlled {
    fn start(root: &Root, folder: &Path, bench: &str, program: &[&str]) -> Self {
        let told = folder.join("told");
        let mut control = root.whirl();
        control.args(["control", "--bench", bench, "--"]).args(program).stdout(Stdio::null());
        Self { process: Ended(control.stderr(std::fs::File::create(&told).unwrap()).spawn().unwrap()), told }
    }

    fn says(&self, what: &str) {
        patiently(what, || std::fs::read_to_string(&self.told).unwrap().contains(what).then_some(()));
    }

    /// Ends it as an operator would, who waits for a second at most.
    fn end(mut self) -> Option<i32> {
        let (asked, process) = (Instant::now(), &mut self.process.0);
        kill_process(Pid::from_child(process), Signal::TERM).unwrap();
        let code = process.wait().unwrap().code();
        assert!(asked.elapsed() < PATIENCE, "{:?}", asked.elapsed());
        code
    }
}

#[test]
fn control_says_why_nothing_comes_and_what_is_no_command() {
    let (root, folder) = (Root::new(), tempfile::tempdir().unwrap());
    let alone = root.simulate(&["three-mass", "--bench", "alone"]);
    let unasked = Controlled::start(&root, folder.path(), "alone", &["cat"]);
    unasked.says("bench 'alone' asks for no commands: it does once 'external' is set");
    assert_eq!(unasked.end(), Some(130));
    assert_eq!(alone.end().code, Some(0));

    let arguments = ["three-mass", "--bench", "a", "--feedback", "individual", "--set=sample=0.01", "--set=delay=0.05"];
    let simulation = root.simulate(&[&arguments[..], &["--set=external=20"]].concat());
    // One that reads and never answers holds nobody up, a signal least of all.
    let silent = Controlled::start(&root, folder.path(), "a", &["sleep", "1000"]);
    silent.says("sleep has not answered readings");
    assert_eq!(silent.end(), Some(130));
    // Words are no commands, and neither are the readings themselves.
    for program in [&["yes"][..], &["cat"]] {
        let mistaken = root.run(&[&["control", "--bench", "a", "--"], program].concat());
        let what = "expected run_id and number as they were given";
        assert_eq!((mistaken.code, mistaken.stderr.contains(what)), (Some(1), true), "{mistaken:?}");
    }
    if let Some(controller) = compiled(folder.path()) {
        let working = Controlled::start(&root, folder.path(), "a", &[&controller.display().to_string()]);
        working.says("commands from outside act from tau");
        assert_eq!(working.end(), Some(130));
    }
    assert_eq!(simulation.end().code, Some(0));
}

/// Clients of every kind, killed at any moment: the bench goes on, others hear it in order, and nothing is left.
#[test]
fn clients_that_are_killed_leave_bench_other_clients_and_memory_whole() {
    let kills: u32 = std::env::var("WHIRL_KILLS").map_or(24, |kills| kills.parse().unwrap());
    let (root, folder) = (Root::new(), tempfile::tempdir().unwrap());
    let controller = compiled(folder.path());
    let arguments = ["three-mass", "--bench", "a", "--feedback", "individual", "--set=sample=0.01", "--set=delay=0.05"];
    let simulation = root.simulate(&[&arguments[..], &["--set=external=20"]].concat());
    let mut listener = listen(&root, "a");
    let (mut seen, mut steps): (Option<(u64, u64)>, u64) = (None, 0);
    let mut hear = |listener: &mut <SharedMemory as Carrier>::Listener| {
        listener
            .drain(|state| {
                // One run, in order. Whether this test itself slept through some is no matter.
                assert!(seen.is_none_or(|(run, before)| state.run_id() == run && state.seq() > before));
                seen = Some((state.run_id(), state.seq()));
                steps += 1;
            })
            .unwrap();
        steps
    };
    let controller = controller.map(|path| path.display().to_string());
    let mut random = 0x9e37_79b9_u32;
    for kill in 0..kills {
        let mut clients: Vec<Vec<&str>> = vec![
            vec!["tail", "--json"],
            vec!["tail", "--events"],
            vec!["set", "kd=4"],
            vec!["drill", "delay-jump", "--size=0.01"],
            vec!["status"],
            vec!["wire"],
        ];
        if let Some(controller) = &controller {
            clients.push(vec!["control", "--bench", "a", "--", controller]);
            clients.push(vec!["control", "--bench", "a", "--", controller]);
        }
        let client = &clients[kill as usize % clients.len()];
        let mut command = root.whirl();
        command.arg(client[0]);
        if client[0] != "control" && client[0] != "status" {
            command.args(["--bench", "a"]);
        }
        command.args(&client[1..]).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = command.spawn().unwrap();
        // At any moment of its life: while it starts, attaches, or is at work.
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let until = Instant::now() + Duration::from_micros(u64::from(random >> 16) * 5);
        while Instant::now() < until {
            hear(&mut listener);
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = kill_process(Pid::from_child(&child), Signal::KILL);
        child.wait().unwrap();
        hear(&mut listener);
    }
    // It goes on, takes changes, and can be controlled.
    let before = hear(&mut listener);
    patiently("further steps", || (hear(&mut listener) > before).then_some(()));
    let set = root.run(&["set", "--bench", "a", "kd=4.01", "--json"]).json();
    assert_eq!(set["accepted"], true);
    assert!(patiently("a status", || listener.bench_status().unwrap()).trip.cause == 0);
    if let Some(controller) = &controller {
        let mut control = root.whirl();
        control.args(["control", "--bench", "a", "--", controller]).stdout(Stdio::null());
        let _control = Ended(control.spawn().unwrap());
        let mut external = false;
        patiently("a controller", || {
            listener.drain(|state| external |= state.flags().has(Flags::EXTERNAL)).unwrap();
            external.then_some(())
        });
    }
    drop(listener);
    let ran = simulation.end();
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{ran:?}");
    // What the killed held is cleared away by the last process out, or by this one.
    assert_eq!(root.run(&["clean"]).code, Some(0));
    assert_eq!(root.leftovers(), Vec::<String>::new());
}
