//! What every end-to-end test needs: the program, a root of its own, and what it printed.

pub mod manual;
pub mod paper;
pub mod reference;
mod screen;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

pub use screen::{PATIENCE, Screen};

/// How long a process that was asked to end may take.
pub(crate) const FAREWELL: Duration = Duration::from_secs(3);

/// Where the program under test is: cargo builds it beside this package's tests, but not beside its examples.
///
/// # Panics
/// If this process does not run from a cargo target directory, or the program has not been built; that is said in words that help.
#[must_use]
pub fn program() -> PathBuf {
    let test = std::env::current_exe().expect("a running test has a path");
    let target = test.parent().and_then(Path::parent).expect("tests run from target/*/deps");
    let program = target.join(format!("whirl-under-test{}", std::env::consts::EXE_SUFFIX));
    assert!(
        program.exists(),
        "{} is not there: `cargo build -p promises` makes it (with --release for target/release); building examples alone does not",
        program.display()
    );
    program
}

/// The program under test, ready for arguments.
#[must_use]
pub fn whirl() -> Command {
    let mut command = Command::new(program());
    command.stdin(Stdio::null());
    command
}

/// Runs `whirl` with these arguments to its end.
///
/// # Panics
/// If it cannot be started.
#[must_use]
pub fn run(arguments: &[&str]) -> Ran {
    ran(whirl().args(arguments).output().expect("whirl starts"))
}

fn ran(Output { status, stdout, stderr }: Output) -> Ran {
    let text = |bytes| String::from_utf8(bytes).expect("whirl prints UTF-8");
    Ran { code: status.code(), stdout: text(stdout), stderr: text(stderr) }
}

/// Starts `whirl` with these arguments, interrupts it once it listens to signals, and says how it ended.
///
/// # Panics
/// If it cannot be started, or does not come to listen.
#[must_use]
pub fn interrupted(arguments: &[&str]) -> Ran {
    let child = whirl().args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("whirl starts");
    let status = format!("/proc/{}/status", child.id());
    // The signals it catches, in hexadecimal: SIGINT is the second lowest bit.
    let catches = |status: &str| {
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"))?;
        Some(u64::from_str_radix(mask.trim(), 16).ok()? & 2 != 0)
    };
    let start = Instant::now();
    while std::fs::read_to_string(&status).ok().and_then(|status| catches(&status)) != Some(true) {
        assert!(start.elapsed() < PATIENCE, "it does not listen to signals");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let pid = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).expect("it is there");
    ran(child.wait_with_output().expect("it ends"))
}

/// Runs `whirl`, asks it to terminate once it has worked for a while (half a second of processor time, which is longer than
/// any start takes), and gives how it ended and how long after the signal.
///
/// # Panics
/// If it cannot be started, or ends before.
#[must_use]
pub fn terminated_at_work(arguments: &[&str]) -> (Ran, Duration) {
    let child = whirl().args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("whirl starts");
    let stat = format!("/proc/{}/stat", child.id());
    // Fields 14 and 15, counted from the end of the name: user and system time in ticks of 10 ms.
    let worked = || {
        let stat = std::fs::read_to_string(&stat).ok()?;
        let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
        Some(fields[11].parse::<u64>().ok()? + fields[12].parse::<u64>().ok()?)
    };
    let start = Instant::now();
    while worked().expect("it is there") < 50 {
        assert!(start.elapsed() < PATIENCE, "it does not work");
        std::thread::sleep(Duration::from_millis(5));
    }
    let pid = rustix::process::Pid::from_child(&child);
    let asked = Instant::now();
    rustix::process::kill_process(pid, rustix::process::Signal::TERM).expect("it is there");
    let ran = ran(child.wait_with_output().expect("it ends"));
    (ran, asked.elapsed())
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

/// A root of shared memory of this test's own, so that tests neither meet each other nor the bench of whoever runs them.
pub struct Root {
    folder: tempfile::TempDir,
}

impl Root {
    /// A new, empty root.
    ///
    /// # Panics
    /// If there is no room for it.
    #[must_use]
    #[allow(clippy::new_without_default, reason = "it makes a folder")]
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// `whirl` under this root, ready for arguments.
    #[must_use]
    pub fn whirl(&self) -> Command {
        self.command(program())
    }

    /// Any program under this root, ready for arguments.
    #[must_use]
    pub fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.stdin(Stdio::null()).env("WHIRL_ROOT", self.path());
        // Not the configuration of whoever runs the tests.
        command.env("XDG_CONFIG_HOME", self.path().join("config")).env("XDG_DATA_HOME", self.path().join("data"));
        command.env("XDG_STATE_HOME", self.path().join("state"));
        command
    }

    /// Runs `whirl` under this root to its end.
    ///
    /// # Panics
    /// If it cannot be started.
    #[must_use]
    pub fn run(&self, arguments: &[&str]) -> Ran {
        ran(self.whirl().args(arguments).output().expect("whirl starts"))
    }

    /// Starts a simulation under this root and waits until it answers.
    ///
    /// # Panics
    /// If it does not start.
    #[must_use]
    pub fn simulate(&self, arguments: &[&str]) -> Simulation {
        let bench = arguments.iter().position(|a| *a == "--bench").map_or("default", |at| arguments[at + 1]);
        let mut command = self.whirl();
        let child = command.arg("sim").args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        let simulation = Simulation { child: Some(child.spawn().expect("whirl starts")) };
        let start = Instant::now();
        while self.run(&["tail", "--bench", bench, "--count", "1"]).code != Some(0) {
            assert!(start.elapsed() < PATIENCE, "the simulation does not answer");
        }
        simulation
    }

    /// What is left of this root in shared memory and in its folder.
    ///
    /// # Panics
    /// If the folder cannot be read.
    #[must_use]
    pub fn leftovers(&self) -> Vec<String> {
        let names = |folder: &Path| -> Vec<String> {
            let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
        };
        // Looked at before the root is opened to ask for its prefix, because whoever leaves it last sweeps it.
        let (in_memory, in_folder) = (names(Path::new("/dev/shm")), names(self.path()));
        let prefix = wire::Root::at(self.path()).expect("a root").prefix().to_owned();
        let ours = in_memory.into_iter().filter(|name| name.starts_with(&prefix));
        ours.chain(in_folder.into_iter().filter(|name| name != "lease")).collect()
    }
}

impl Drop for Root {
    /// Sweeps what processes that a test killed have left in shared memory, which outlives the folder.
    fn drop(&mut self) {
        let start = Instant::now();
        // A simulation whose dashboard was killed takes a moment to end.
        while !self.leftovers().is_empty() && start.elapsed() < FAREWELL {
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

/// A running `whirl sim`, ended with the test.
pub struct Simulation {
    child: Option<Child>,
}

impl Simulation {
    /// Its process id.
    ///
    /// # Panics
    /// If it has been ended.
    #[must_use]
    pub fn pid(&self) -> u32 {
        self.child.as_ref().expect("running").id()
    }

    /// Sends it a signal.
    ///
    /// # Panics
    /// If it is no longer there.
    pub fn signal(&self, signal: rustix::process::Signal) {
        let pid = rustix::process::Pid::from_raw(self.pid() as i32).expect("a process id");
        rustix::process::kill_process(pid, signal).expect("the simulation is there");
    }

    /// Asks it to end, and returns how it did.
    ///
    /// # Panics
    /// If it cannot be waited for.
    #[must_use]
    pub fn end(mut self) -> Ran {
        self.signal(rustix::process::Signal::TERM);
        ran(self.child.take().expect("running").wait_with_output().expect("it ends"))
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        let Some(child) = &mut self.child else { return };
        let pid = rustix::process::Pid::from_raw(child.id() as i32);
        // Asked to end it tidies up; a test may have stopped it, or it may not listen.
        for signal in [rustix::process::Signal::TERM, rustix::process::Signal::CONT] {
            let _ = pid.map(|pid| rustix::process::kill_process(pid, signal));
        }
        let start = Instant::now();
        while child.try_wait().is_ok_and(|ended| ended.is_none()) && start.elapsed() < FAREWELL {
            std::thread::sleep(Duration::from_millis(2));
        }
        let _ = child.kill();
        let _ = child.wait();
    }
}
