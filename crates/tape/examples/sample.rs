//! Makes the small recording in `recordings/`: a run-up that goes unstable, trips, and is saved by better gains.
//!
//! `cargo run -p tape --features rerun --example sample -- FILE.rrd`. A simulation, a recorder and a script of
//! changes in one process, over the carrier for tests; half a minute.

use std::error::Error;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use alarms::{Limits, Watch};
use rotor::{Settings, builtin};
use tape::Keep;
use tape::recorder::{self, Order};
use wire::{Answer, BenchName, BenchStatus, Carrier, Change, Commander, Listener, Memory};

/// Steps a second; with [`DTAU`], 20 units of `tau` a second.
const RATE_HZ: f64 = 200.0;
/// Advance of `tau` a step.
const DTAU: f64 = 0.1;
/// How long anything may take.
const PATIENCE: Duration = Duration::from_secs(5);

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).map(PathBuf::from).ok_or("expected the file to make")?;
    let bench: BenchName = "sample".parse()?;
    let carrier = Memory::default();
    let rotor = builtin::rotor("three-mass").ok_or("built in")?;
    let mut settings = Settings::new(&rotor, 1.0, builtin::feedback(&rotor, "off").ok_or("built in")?);
    settings.deadband.fill(1.0);
    settings.trip = 20.0;
    let options = sim::Options { bench: bench.clone(), rate_hz: RATE_HZ, dtau: DTAU, ..sim::Options::default() };
    let keep = Keep { min_free: 0, ..Keep::default() };
    // Of the rotor, and not of the machine that it is made on.
    let mut limits = Limits::default();
    limits.set(Watch::Orbit, Some([5.0, 15.0]))?;
    limits.set(Watch::Lateness, None)?;
    let order = Order { bench: bench.clone(), path: Some(path), viewer: None, keep, follow: false, limits };
    let (stop_sim, stop_tape) = (AtomicBool::new(false), AtomicBool::new(false));
    let (ready, is_ready) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        scope.spawn(|| sim::run(&carrier, &rotor, settings, &options, &stop_sim, || ready.send(()).unwrap_or(())));
        is_ready.recv()?;
        let tape = scope.spawn(|| {
            let listener = carrier.listen(&bench)?;
            recorder::record(&carrier, listener, &order, &stop_tape, |_| ())
        });
        let played = play(&carrier, &bench, &rotor);
        // Whatever came of it, both must end.
        stop_sim.store(true, Ordering::Relaxed);
        std::thread::sleep(Duration::from_millis(500));
        stop_tape.store(true, Ordering::Relaxed);
        let summary = tape.join().map_err(|_| "the recorder failed")??;
        played?;
        let told =
            format!("{:?}: {} steps, {} bytes, {} lost\n", summary.files, summary.rows, summary.bytes, summary.lost);
        std::io::Write::write_all(&mut std::io::stdout(), told.as_bytes())?;
        Ok(())
    })
}

/// The script.
fn play(carrier: &Memory, bench: &BenchName, rotor: &rotor::Rotor) -> Result<(), Box<dyn Error>> {
    let mut listener = carrier.listen(bench)?;
    let mut commander = carrier.command(bench)?;
    std::thread::sleep(Duration::from_millis(700));
    let mut ask = |change: &Change, why: &str| -> Result<Answer, Box<dyn Error>> {
        let answer = commander.ask(&*change.request("operator", why)?, PATIENCE)?;
        if answer.is_accepted() { Ok(answer) } else { Err(answer.reason.as_str().into()) }
    };
    let mut edit = |listener: &mut <Memory as Carrier>::Listener, why: &str, change: &dyn Fn(&mut Settings)| {
        let bench_status = newest(listener)?;
        let mut settings = bench_status.settings.get().clone();
        change(&mut settings);
        ask(&Change::Settings { base_revision: bench_status.revision, settings }, why)
    };
    for speed in [1.2, 1.4, 1.6, 1.8, 2.0, 2.2] {
        edit(&mut listener, "run-up", &|settings| settings.speed = speed)?;
        std::thread::sleep(Duration::from_millis(600));
    }
    // Above its threshold of 1.776 the rotor whirls ever wider, until it trips.
    while !newest(&mut listener)?.trip.is_tripped() {
        std::thread::sleep(Duration::from_millis(50));
    }
    std::thread::sleep(Duration::from_millis(500));
    let better = builtin::feedback(rotor, "composite").ok_or("built in")?;
    edit(&mut listener, "better gains", &|settings| settings.feedback = better.clone())?;
    let mut commander = carrier.command(bench)?;
    let mut ask = |change: &Change| commander.ask(&*change.request("operator", "")?, PATIENCE);
    ask(&Change::Restart)?;
    ask(&Change::Note { text: "again from rest, with the composite gains".into() })?;
    for speed in [2.4, 2.8, 3.2] {
        std::thread::sleep(Duration::from_millis(900));
        let bench_status = newest(&mut listener)?;
        let mut settings = bench_status.settings.get().clone();
        settings.speed = speed;
        ask(&Change::Settings { base_revision: bench_status.revision, settings })?;
    }
    ask(&Change::Impulse { mass: 1, velocity: rotor::C64::new(1.0, 0.0) })?;
    std::thread::sleep(Duration::from_millis(1200));
    Ok(())
}

/// The next bench status.
fn newest(listener: &mut impl Listener) -> Result<Box<BenchStatus>, Box<dyn Error>> {
    let start = std::time::Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(bench_status) = listener.bench_status()? {
            return Ok(bench_status);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Err("the simulation does not speak up".into())
}
