//! Whoever follows a document: types its commands in one folder, looks at what they show, and leaves.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use promises::paper::top;
use promises::{PATIENCE, Root, Screen, Simulation, program};
use rustix::process::{Pid, Signal, kill_process};

/// The screen of those commands that want one.
const SIZE: (u16, u16) = (140, 42);

/// How a command is tried.
#[derive(Debug, PartialEq, Eq)]
enum Kind {
    /// It ends by itself, with exit code 0.
    Ends,
    /// It runs beside what follows, until the reader leaves.
    Background,
    /// It takes a terminal, until `q`.
    Terminal,
    /// It goes on until ctrl-c.
    Endless,
}

fn kind(command: &str) -> Kind {
    let words: Vec<&str> = command.split_whitespace().collect();
    let has = |option: &str| words.contains(&option);
    match *words.get(1).unwrap_or(&"up") {
        _ if has("&") => Kind::Background,
        "up" | "replay" => Kind::Terminal,
        "dash" if !has("--picture") => Kind::Terminal,
        "tail" if !has("--count") => Kind::Endless,
        "record" | "control" => Kind::Endless,
        _ => Kind::Ends,
    }
}

/// The command of a line, without its comment.
pub(super) fn command(line: &str) -> &str {
    // A comment begins with a # that no letter is before: there are none within quotes in the documents.
    let end = line.match_indices('#').map(|(at, _)| at).find(|at| *at == 0 || line[..*at].ends_with(' '));
    line[..end.unwrap_or(line.len())].trim()
}

pub(super) struct Reader {
    /// Dropped in this order: benches end before their root is swept.
    benches: Vec<Simulation>,
    root: Root,
    folder: tempfile::TempDir,
    /// What the last command has printed.
    printed: String,
}

impl Reader {
    /// With a folder in which there is nothing but the small recording of the repository, and `whirl` at hand.
    pub(super) fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let bin = folder.path().join(".bin");
        fs::create_dir(&bin).expect("a folder");
        std::os::unix::fs::symlink(program(), bin.join("whirl")).expect("a link to the program");
        fs::create_dir(folder.path().join("recordings")).expect("a folder");
        fs::copy(top().join("recordings/run-up.rrd"), folder.path().join("recordings/run-up.rrd")).expect("a copy");
        Self { benches: Vec::new(), root: Root::new(), folder, printed: String::new() }
    }

    /// Types the commands of a block, and says how many there were.
    pub(super) fn types(&mut self, place: &str, block: &str) -> usize {
        let commands: Vec<&str> = block.lines().map(command).filter(|command| !command.is_empty()).collect();
        for command in &commands {
            let is_known = ["whirl", "cc", "cat"].contains(&command.split(' ').next().unwrap_or_default());
            assert!(is_known, "{place}: '{command}' is no command that this test can follow");
            let place = format!("{place}: {command}");
            match kind(command) {
                Kind::Ends => self.runs(&place, command),
                Kind::Background => self.beside(&place, command),
                Kind::Terminal => self.on_a_screen(command),
                Kind::Endless => self.until_interrupted(&place, command),
            }
        }
        commands.len()
    }

    /// The document shows what the last command has printed.
    pub(super) fn has_seen(&self, place: &str, text: &str) {
        assert_eq!(self.printed.trim_end(), text.trim_end(), "{place} is not what the command before it prints");
    }

    pub(super) fn writes(&self, name: &str, text: &str) {
        fs::write(self.folder.path().join(name), text).expect("a file is written");
    }

    /// Ends the benches that the document has started: in good order, and nothing is left.
    pub(super) fn leaves(mut self) {
        for bench in self.benches.drain(..) {
            let ran = bench.end();
            assert_eq!(ran.code, Some(0), "{ran:?}");
        }
        assert_eq!(self.root.leftovers(), [""; 0], "left behind");
    }

    /// The search path of the reader's shell.
    fn path(&self) -> std::ffi::OsString {
        let mut path = self.folder.path().join(".bin").into_os_string();
        path.push(":");
        path.push(std::env::var_os("PATH").unwrap_or_default());
        path
    }

    /// A shell that runs `line` in the reader's folder.
    fn shell(&self, line: &str) -> Command {
        let mut command = self.root.command("sh");
        command.args(["-c", line]).current_dir(self.folder.path()).env("PATH", self.path()).stdin(Stdio::null());
        command
    }

    fn runs(&mut self, place: &str, line: &str) {
        let output = self.shell(line).output().expect("a shell starts");
        let errors = String::from_utf8_lossy(&output.stderr);
        self.printed = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(0), "{place}\n{}{errors}", self.printed);
        let words: Vec<&str> = line.split_whitespace().collect();
        let files = words.windows(2).filter(|pair| matches!(pair[0], "--out" | "-o" | "--plot" | "--picture" | ">"));
        let mut is_silent = self.printed.is_empty() && errors.is_empty();
        for pair in files {
            assert!(self.folder.path().join(pair[1]).exists(), "{place}: {} is not there", pair[1]);
            is_silent = false;
        }
        assert!(!is_silent || line == "whirl clean", "{place} neither prints anything nor writes a file");
    }

    fn beside(&mut self, place: &str, line: &str) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let ["whirl", "sim", options @ .., "&"] = &words[..] else { panic!("{place}: expected `whirl sim .. &`") };
        self.benches.push(self.root.simulate(options));
    }

    fn on_a_screen(&self, line: &str) {
        let shell = PathBuf::from("sh");
        let line = format!("PATH='{}'; exec {line}", self.path().to_string_lossy());
        let mut screen = Screen::of_program(&shell, self.folder.path(), self.root.path(), &["-c", &line], SIZE);
        screen.wait("a frame", |text| ["RUNNING", "TRIPPED", "REPLAY"].iter().any(|w| text.contains(w)).then_some(()));
        screen.press("q");
        assert!(screen.ended().success(), "{line}:\n{}", screen.text());
        assert!(!screen.is_taken(), "{line}");
    }

    fn until_interrupted(&mut self, place: &str, line: &str) {
        let mut command = self.shell(&format!("exec {line}"));
        let mut child = command.stdout(Stdio::piped()).spawn().expect("a shell starts");
        let mut said = BufReader::new(child.stdout.take().expect("it is piped"));
        self.printed.clear();
        let bench = line.split("--bench ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap_or("default");
        // Neither says anything until its end; but the bench knows of it.
        let is_there: Option<fn(&Self, &str, u32) -> bool> = match line.split(' ').nth(1) {
            Some("record") => Some(|reader, bench, pid| reader.recorder_of(bench) == Some(pid)),
            Some("control") => Some(Self::is_controlled_by),
            _ => None,
        };
        if let Some(is_there) = is_there {
            let start = Instant::now();
            while !is_there(self, bench, child.id()) {
                assert!(start.elapsed() < PATIENCE, "{place}: the bench does not know of it");
                std::thread::sleep(Duration::from_millis(20));
            }
        } else {
            said.read_line(&mut self.printed).expect("it prints text");
            assert!(!self.printed.is_empty(), "{place}: printed nothing");
        }
        kill_process(Pid::from_child(&child), Signal::INT).expect("it is there");
        said.read_to_string(&mut self.printed).expect("it prints text");
        let status = child.wait().expect("it ends");
        assert!(matches!(status.code(), Some(0 | 130)), "{place}: {status}");
    }

    /// Whether a process has joined a bench to control it.
    fn is_controlled_by(&self, bench: &str, pid: u32) -> bool {
        let status = self.root.run(&["status", "--json"]).json();
        let benches = status["benches"].as_array().cloned().unwrap_or_default();
        let attached =
            benches.iter().filter(|entry| entry["name"] == bench).filter_map(|entry| entry["attached"].as_array());
        attached.flatten().any(|process| process["role"] == "control" && process["pid"] == pid)
    }

    /// The process that records a bench.
    fn recorder_of(&self, bench: &str) -> Option<u32> {
        let status = self.root.run(&["status", "--json"]).json();
        let benches = status["benches"].as_array()?;
        let recording = &benches.iter().find(|entry| entry["name"] == bench)?["recording"];
        (recording["state"] == "recording").then(|| recording["pid"].as_u64())?.and_then(|pid| pid.try_into().ok())
    }
}

#[test]
fn a_command_is_tried_as_what_it_is() {
    assert_eq!(command("whirl set a=1 # what it does"), "whirl set a=1");
    assert_eq!(kind("whirl"), Kind::Terminal);
    assert_eq!(kind("whirl dash --bench a --picture x.svg"), Kind::Ends);
    assert_eq!(kind("whirl sim three-mass &"), Kind::Background);
    assert_eq!(kind("whirl tail --events"), Kind::Endless);
}
