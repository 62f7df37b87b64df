//! Of shared memory alone: who is there, who was killed, and what is left when the last one goes.

use std::thread;
use std::time::{Duration, Instant};

use wire::{Carrier, Glance, Host, RecorderSender, RecorderState, RecorderStatus, StateSender, WireError};

use crate::support::{LAYOUT, bench, number, wait_for};

/// Names in POSIX shared memory that belong to this root.
fn in_shared_memory(root: &wire::Root) -> usize {
    std::fs::read_dir("/dev/shm").map_or(0, |entries| {
        entries.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with(root.prefix())).count()
    })
}

/// Where the recorder that shall be killed finds its root.
const RECORDER_ROOT: &str = "WHIRL_TEST_RECORDER_ROOT";

/// Not a test but the recorder that the next one kills: this binary, started again.
#[test]
fn recorder_to_be_killed() {
    let Some(root) = std::env::var_os(RECORDER_ROOT) else { return };
    let root = wire::Root::at(std::path::Path::new(&root)).unwrap();
    let carrier = wire::SharedMemory::new(&root, "record").unwrap();
    let mut recorder = carrier.recorder(&bench("killed")).unwrap();
    let mut status = RecorderStatus { pid: std::process::id(), ..RecorderStatus::default() };
    status.set_state(RecorderState::Recording);
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(60) {
        recorder.send(&mut status).unwrap();
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_killed_recorder_has_died_and_the_next_one_takes_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let name = bench("killed");
    let host = carrier.host(&name).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let mut listener = carrier.listen(&name).unwrap();
    let mut child = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "processes::recorder_to_be_killed"])
        .env(RECORDER_ROOT, dir.path())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let recording = wait_for("the recorder", || listener.recorder().unwrap());
    assert_eq!((recording.state(), recording.pid), (RecorderState::Recording, child.id()));
    assert_eq!(carrier.recorder(&name).err(), Some(WireError::Recorded(name.clone())));
    child.kill().unwrap();
    child.wait().unwrap();
    let told = listener.recorder().unwrap().unwrap();
    assert_eq!((told.state(), told.pid), (RecorderState::Died, recording.pid));
    let mut late = carrier.listen(&name).unwrap();
    assert_eq!(late.recorder().unwrap(), None);
    carrier.recorder(&name).unwrap();
}

#[test]
fn nothing_is_left_when_the_last_one_goes() {
    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let witness = root.prefix().to_owned();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let host = carrier.host(&bench("brief")).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    states.send(1, number(1)).unwrap();
    assert!(in_shared_memory(&root) > 0);
    drop((states, host, carrier, root));
    let left: Vec<_> = std::fs::read_dir("/dev/shm").unwrap().flatten().map(|e| e.file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().starts_with(&witness)), "{left:?}");
    let files: Vec<_> = std::fs::read_dir(dir.path()).unwrap().flatten().map(|e| e.file_name()).collect();
    assert_eq!(files, ["lease"]);
}

#[test]
fn benches_are_listed_with_who_is_attached() {
    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    assert_eq!(carrier.benches().unwrap(), []);
    let host = carrier.host(&bench("b")).unwrap();
    let _states = host.states(LAYOUT).unwrap();
    let other = carrier.host(&bench("a")).unwrap();
    let _listener = carrier.listen(&bench("b"));
    let benches = carrier.benches().unwrap();
    let summary: Vec<_> = benches
        .iter()
        .map(|b| (b.name.as_str(), b.is_running(), b.processes.iter().map(|p| p.role.as_str()).collect::<Vec<_>>()))
        .collect();
    assert_eq!(summary, [("a", true, vec!["sim"]), ("b", true, vec!["sim", "test"])]);
    assert!(benches[0].processes.iter().all(|process| process.pid == std::process::id()));
    drop(other);
}
