//! A recorder as a process, and what is in the files that it leaves.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use promises::{PATIENCE, Ran, Root, run};
use serde_json::Value;
use tape::Recording;
use wire::Step;

/// A recorder that was started as the dashboard starts it, and has said that it records.
pub(super) struct Recorder {
    pub(super) child: Child,
    said: BufReader<std::process::ChildStdout>,
}

impl Recorder {
    pub(super) fn start(root: &Root, path: &Path, options: &[&str]) -> Self {
        let mut command = root.whirl();
        command.args(["record", path.to_str().unwrap(), "--as-child"]).args(options);
        Self::of(&mut command)
    }

    pub(super) fn of(command: &mut Command) -> Self {
        let command = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut said = BufReader::new(child.stdout.take().unwrap());
        let mut word = String::new();
        said.read_line(&mut word).unwrap();
        // With the number of the first step, where one has come.
        if word.split_whitespace().next() != Some("ready") {
            child.kill().unwrap();
            let mut why = String::new();
            child.stderr.take().unwrap().read_to_string(&mut why).unwrap();
            panic!("it does not record: {word}{why}");
        }
        Self { child, said }
    }

    /// Closes its input, as a parent does, and returns how it ended.
    pub(super) fn end(mut self) -> Ran {
        drop(self.child.stdin.take());
        self.wait()
    }

    pub(super) fn wait(mut self) -> Ran {
        let mut stdout = String::new();
        self.said.read_to_string(&mut stdout).unwrap();
        let mut stderr = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        Ran { code: self.child.wait().unwrap().code(), stdout, stderr }
    }

    pub(super) fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

pub(super) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Writes the user's configuration file.
pub(super) fn configure(root: &Root, text: &str) -> PathBuf {
    let folder = root.path().join("config/whirl");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("config.toml");
    std::fs::write(&file, text).unwrap();
    file
}

/// Every step of a recording by its number.
pub(super) fn steps(path: &Path) -> BTreeMap<u64, wire::State> {
    let mut steps = BTreeMap::new();
    Recording::open(path)
        .unwrap()
        .visit(0..u64::MAX, 1, |state| {
            steps.insert(state.seq(), *state);
            ControlFlow::Continue(())
        })
        .unwrap();
    steps
}

pub(super) fn info(path: &Path) -> Value {
    run(&["info", text(path), "--json"]).json()
}

pub(super) fn wait(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(start.elapsed() < PATIENCE, "{what} does not come");
        std::thread::sleep(Duration::from_millis(10));
    }
}
