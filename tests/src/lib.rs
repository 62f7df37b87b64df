//! What every end-to-end test needs: the program, and what it printed.

use std::path::PathBuf;
use std::process::{Command, Output};

/// The program under test, ready for arguments.
#[must_use]
pub fn whirl() -> Command {
    Command::new(program())
}

/// Where the program under test is: cargo builds it beside this package's tests.
///
/// # Panics
/// If this process does not run from a cargo target directory.
#[must_use]
pub fn program() -> PathBuf {
    let test = std::env::current_exe().expect("a running test has a path");
    let target = test.parent().and_then(std::path::Path::parent).expect("tests run from target/*/deps");
    target.join(format!("whirl-under-test{}", std::env::consts::EXE_SUFFIX))
}

/// Runs `whirl` with these arguments to its end.
///
/// # Panics
/// If it cannot be started.
#[must_use]
pub fn run(arguments: &[&str]) -> Ran {
    let Output { status, stdout, stderr } = whirl().args(arguments).output().expect("whirl starts");
    let text = |bytes| String::from_utf8(bytes).expect("whirl prints UTF-8");
    Ran { code: status.code(), stdout: text(stdout), stderr: text(stderr) }
}

/// How a run of `whirl` ended.
#[derive(Debug)]
pub struct Ran {
    /// Exit code; `None` if a signal ended it.
    pub code: Option<i32>,
    /// What it printed.
    pub stdout: String,
    /// What it complained about.
    pub stderr: String,
}

impl Ran {
    /// The one JSON document it printed, after a success.
    ///
    /// # Panics
    /// If it failed, or printed anything but one JSON document.
    #[must_use]
    pub fn json(&self) -> serde_json::Value {
        assert_eq!(self.code, Some(0), "{self:?}");
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}
