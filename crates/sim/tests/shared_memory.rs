//! What a bench takes of the machine's shared memory.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rotor::{Settings, builtin};
use sim::Options;
use wire::{BenchName, Carrier, Change, Commander, Glance, Listener, Root, SharedMemory, Step};

/// Bytes of memory behind the files in a folder whose names begin with `prefix`, and in the folders below it.
fn resident(folder: &Path, prefix: &str) -> u64 {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let ours = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(prefix));
    let bytes = |entry: std::fs::DirEntry| match entry.metadata() {
        Ok(found) if found.is_dir() => resident(&entry.path(), ""),
        Ok(found) => 512 * found.blocks(),
        Err(_) => 0,
    };
    ours.map(bytes).sum()
}

#[test]
fn a_bench_with_a_dashboard_takes_less_than_4_mb_of_shared_memory() {
    const STEPS: u64 = 6000;
    let folder = tempfile::tempdir().unwrap();
    let root = Root::at(folder.path()).unwrap();
    let carrier = SharedMemory::new(&root, "test").unwrap();
    let rotor = builtin::rotor("three-mass").unwrap();
    let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
    let options = Options { bench: BenchName::default(), rate_hz: 1000.0, dtau: 0.01, ..Options::default() };
    let (stop, ready) = (AtomicBool::new(false), AtomicBool::new(false));
    let mut taken = 0;
    thread::scope(|scope| {
        let simulation = scope.spawn(|| {
            sim::run(&carrier, &rotor, settings.clone(), &options, &stop, || ready.store(true, Ordering::Relaxed))
        });
        let looked = std::panic::catch_unwind(|| {
            let start = Instant::now();
            let patient = |start: Instant| assert!(start.elapsed() < Duration::from_secs(120), "too slow");
            let mut listener = loop {
                match carrier.listen(&options.bench) {
                    Ok(listener) => break listener,
                    Err(_) => patient(start),
                }
                thread::sleep(Duration::from_millis(1));
            };
            let mut commander = carrier.command(&options.bench).unwrap();
            let (mut last, mut asked, mut speed) = (0, 0, 2.5);
            while last < STEPS {
                patient(start);
                // As often as a dashboard looks; and its operator turns a knob now and then.
                thread::sleep(Duration::from_millis(16));
                listener.drain(|step| last = step.seq()).unwrap();
                listener.events(|_| ()).unwrap();
                listener.snapshots(|_, _| ()).unwrap();
                let Some(bench_status) = listener.bench_status().unwrap() else { continue };
                if last / 100 > asked {
                    asked = last / 100;
                    speed += 0.01;
                    let settings = Settings { speed, ..bench_status.settings.get().clone() };
                    let change = Change::Settings { base_revision: bench_status.revision, settings };
                    commander.ask(&change.request("test", "").unwrap(), Duration::from_secs(60)).unwrap();
                }
            }
            resident(Path::new("/dev/shm"), root.prefix()) + resident(&root.path().join("iceoryx2"), "")
        });
        stop.store(true, Ordering::Relaxed);
        simulation.join().unwrap().unwrap();
        taken = looked.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    });
    assert!(ready.load(Ordering::Relaxed));
    // Where shared memory is no folder there is nothing to see.
    assert!(taken < 4_000_000, "{taken} bytes");
}
