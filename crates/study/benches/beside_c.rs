//! Steps a second on one core beside plain C on the same equations: three masses, clearances that the motion crosses, unbalance and gains.
//!
//! `cargo bench -p study --bench beside_c` (or `just check-steps`): compiles `steps.c` with `cc -O3 -march=native -ffast-math`, takes turns with it,
//! and prints nanoseconds of processor time a step, the least of several turns, and the ratios. It needs a C compiler.

// What it prints is what it is for.
#![allow(clippy::print_stdout)]

use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;

use rotor::batch::Batch;
use rotor::{C64, Feedback, Rotor, Settings, builtin, stepper};
use study::run::{Plan, Settle, run};

const DTAU: f64 = 0.01;
const STEPS: usize = 400_000;
const TURNS: usize = 7;
const SPEED: f64 = 2.5;
const CLEARANCE: f64 = 1.0;

fn main() {
    // What `cargo test --benches` asks of a benchmark is that it builds.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, "composite").expect("built in");
    let mut settings = Settings::new(&rotor, SPEED, feedback.clone());
    settings.deadband.fill(CLEARANCE);
    let closed_loop = settings.closed_loop(&rotor);
    let plain = compiled("plain", &[]);
    let turned = compiled("turned", &["-DTURNED"]);
    let input = numbers(&rotor, &feedback);

    let mut least = [f64::INFINITY; 8];
    let mut ends = [C64::ZERO; 4];
    for _ in 0..TURNS {
        for (k, program) in [&plain, &turned].into_iter().enumerate() {
            let (nanoseconds, end) = c(program, &input);
            least[k] = least[k].min(nanoseconds);
            ends[k] = end;
        }
        let mut one = stepper(&closed_loop);
        least[2] = least[2].min(timed(STEPS, || (0..STEPS).for_each(|_| one.step(DTAU))));
        ends[2] = one.motion().displacement[0];
        let plan = Plan {
            program: machine::Program::in_substeps(&rotor, &settings, DTAU, 1).expect("can be stepped"),
            start: None,
            impulses: vec![],
            dtau: DTAU,
            duration: STEPS as f64 * DTAU,
            settle: Settle::Detect,
        };
        least[3] = least[3].min(timed(STEPS, || {
            run(&plan, &mut [], &AtomicBool::new(false)).expect("a run");
        }));
        for (k, most) in [1, 4, 8].into_iter().enumerate() {
            let mut batch = Batch::narrow(rotor.len(), most);
            if batch.lanes() != most {
                continue;
            }
            for lane in 0..most {
                batch.start(lane, &closed_loop, [&[], &[]], DTAU, 1e6);
            }
            least[4 + k] = least[4 + k].min(timed(STEPS * most, || {
                assert_eq!(batch.run(STEPS), STEPS, "it is bounded");
            }));
            batch.run(1);
            ends[3] = batch.last(0)[0][0];
        }
    }
    let [plain, turned, ..] = least;
    for end in ends {
        assert!((end - ends[2]).norm() < 1e-6, "one motion: {ends:?}");
    }
    println!(
        "ns a step, three masses, the least of {TURNS} turns of {STEPS} steps    | steps/s beside C | beside C that turns the unbalance as we do"
    );
    for (name, nanoseconds) in [
        ("C", plain),
        ("C, unbalance turned", turned),
        ("one trajectory, its steps alone", least[2]),
        ("one trajectory, with all that `whirl run` keeps of it", least[3]),
        ("batch with maxima, 1 lane", least[4]),
        ("batch with maxima, 4 lanes (AVX2)", least[5]),
        ("batch with maxima, 8 lanes (AVX-512)", least[6]),
    ] {
        if nanoseconds.is_finite() {
            println!("{name:54} {nanoseconds:7.1} | {:6.2} | {:6.2}", plain / nanoseconds, turned / nanoseconds);
        }
    }
}

/// Nanoseconds of processor time a step.
fn timed(steps: usize, work: impl FnOnce()) -> f64 {
    let from = processor_time();
    work();
    (processor_time() - from) * 1e9 / steps as f64
}

/// Of this process, in seconds; the wall clock where the system does not tell it.
fn processor_time() -> f64 {
    let told = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(
        || std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64()),
        |nanoseconds| nanoseconds * 1e-9,
    )
}

fn compiled(name: &str, options: &[&str]) -> std::path::PathBuf {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    std::fs::create_dir_all(folder).expect("a folder");
    let program = folder.join(format!("steps-{name}"));
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/steps.c");
    let made = Command::new("cc")
        .args(["-O3", "-march=native", "-ffast-math"])
        .args(options)
        .arg(source)
        .arg("-o")
        .arg(&program)
        .arg("-lm")
        .status();
    assert!(made.expect("a C compiler").success(), "{source} does not compile");
    program
}

/// Nanoseconds a step, and where the first mass ends.
fn c(program: &std::path::Path, input: &str) -> (f64, C64) {
    let mut child =
        Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("the compiled program");
    child.stdin.take().expect("piped").write_all(input.as_bytes()).expect("read");
    let output = child.wait_with_output().expect("an end");
    assert!(output.status.success(), "it did not understand its input");
    let text = String::from_utf8(output.stdout).expect("text");
    let told: Vec<f64> = text.split_whitespace().map(|number| number.parse().expect("a number")).collect();
    (told[0], C64::new(told[1], told[2]))
}

/// What the C program reads.
fn numbers(rotor: &Rotor, feedback: &Feedback) -> String {
    let row = feedback.first().at(SPEED);
    let mut text = format!("{STEPS} {DTAU:?} {SPEED:?} {}\n", row.bearing);
    for (i, m) in rotor.masses().iter().enumerate() {
        let (p, v) = (row.displacement[i], row.velocity[i]);
        text += &format!(
            "{:?} {:?} {:?} {:?} {:?} {:?} {CLEARANCE:?} {:?} {:?} {:?} {:?}\n",
            m.mass,
            m.damping,
            m.cross_damping,
            m.bearing_stiffness,
            m.seal_stiffness,
            m.unbalance,
            p.re,
            p.im,
            v.re,
            v.im
        );
    }
    text + &format!("{:?} {:?}\n", rotor.shafts()[0], rotor.shafts()[1])
}
