//! A Rerun viewer that is shown a recording: one that is not there, one that takes nothing, one that closes at once.

use std::net::TcpListener;
use std::time::Duration;

use promises::Root;

use super::recorder::{Recorder, info, wait};

/// A port of this machine on which nobody listens.
fn nobody() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    address.to_string()
}

/// A recording of a bench beside what stands for a viewer at `address`: every step is in the file, whatever that does.
fn recorded(address: &str) -> promises::Ran {
    let root = Root::new();
    let path = root.path().join("s.rrd");
    let simulation = root.simulate(&["three-mass", "--rate", "2000"]);
    let recorder = Recorder::start(&root, &path, &["--connect", address]);
    // Far more messages than can wait for a viewer.
    let rows = || root.run(&["status", "--json"]).json()["benches"][0]["recording"]["steps"].as_u64().unwrap_or(0);
    wait("steps on file", || rows() > 20_000);
    let ran = recorder.end();
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.stdout.contains(" 0 lost; asked to stop"), "{ran:?}");
    let told = info(&path);
    assert!(told["steps"].as_u64().unwrap() > 20_000, "{told}");
    assert_eq!(told["damage"], serde_json::json!([]), "{told}");
    drop(simulation);
    ran
}

#[test]
fn a_viewer_that_is_not_there_costs_nothing_and_is_told() {
    let ran = recorded(&nobody());
    assert!(ran.stdout.contains("no viewer answered at 127.0.0.1:"), "{ran:?}");
    assert!(ran.stderr.contains("does not answer"), "{ran:?}");
}

#[test]
fn a_viewer_that_takes_nothing_costs_nothing_and_is_told() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    // Accepted and kept, and never read.
    let frozen = std::thread::spawn(move || listener.accept().map(|(stream, _)| stream));
    let ran = recorded(&address);
    assert!(ran.stdout.contains(&format!(" at {address}")), "{ran:?}");
    drop(frozen.join());
}

#[test]
fn a_viewer_that_closes_costs_nothing_and_is_told() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            drop(stream);
        }
    });
    let ran = recorded(&address);
    assert!(ran.stdout.contains(&format!(" at {address}")), "{ran:?}");
}

#[test]
fn without_a_file_it_is_only_shown_and_an_address_that_is_none_is_refused() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass"]);
    let mut alone = root.whirl();
    alone.args(["record", "--connect", &nobody()]).stdout(std::process::Stdio::piped());
    let child = alone.spawn().unwrap();
    wait("a recorder", || {
        root.run(&["status", "--json"]).json()["benches"][0]["recording"]["steps"].as_u64() > Some(100)
    });
    std::thread::sleep(Duration::from_millis(50));
    rustix::process::kill_process(rustix::process::Pid::from_child(&child), rustix::process::Signal::INT).unwrap();
    let ended = child.wait_with_output().unwrap();
    let told = String::from_utf8(ended.stdout).unwrap();
    assert!(ended.status.success() && told.contains("no viewer answered at"), "{told}");
    let refused = root.run(&["record", "--connect", "not an address"]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.stderr.contains("expected HOST:PORT"), "{refused:?}");
    let refused = root.run(&["record", "--connect=127.0.0.1:1", "--keep", "10s"]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    drop(simulation);
}
