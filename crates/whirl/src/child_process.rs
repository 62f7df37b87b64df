//! A process of this program that serves another one of it: the simulation and the recorder behind a dashboard.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

use crate::commands::sim::READY;
use crate::failure::Failure;

/// A process that we started. It ends with us, however we end: its standard input is a pipe from us.
pub(crate) struct ChildProcess {
    /// What it is, for messages.
    what: &'static str,
    /// How long it may take to end before it is killed.
    farewell: Duration,
    arguments: Vec<String>,
    child: Child,
    /// What it prints first, and what it prints it on.
    greeting: Option<Receiver<Greeting>>,
    stdout: Option<BufReader<ChildStdout>>,
    /// What it had to say beyond that it is ready.
    greeted: String,
    /// What it says goes to a file, because the screen is not its to write on.
    said: File,
    ended: Option<ExitStatus>,
}

type Greeting = (String, BufReader<ChildStdout>);

impl ChildProcess {
    /// Starts `whirl` with these arguments and waits until it says that it has what it needs, or ends for lack of that:
    /// another's bench of the same name must not be taken for it.
    ///
    /// # Errors
    /// It cannot be started, or ends at once: in its own words, with its own exit code.
    pub(crate) fn start(what: &'static str, farewell: Duration, arguments: Vec<String>) -> Result<Self, Failure> {
        let mut child = Self::launch(what, farewell, arguments)?;
        child.wait().map(|()| child)
    }

    /// The same without waiting: [`ChildProcess::is_ready`] tells.
    ///
    /// # Errors
    /// It cannot be started.
    pub(crate) fn launch(what: &'static str, farewell: Duration, arguments: Vec<String>) -> Result<Self, Failure> {
        let (mut child, said) = spawn(what, &arguments)?;
        let (send, greeting) = channel();
        if let Some(stdout) = child.stdout.take() {
            let listen = move || {
                let mut stdout = BufReader::new(stdout);
                let mut word = String::new();
                // Reads to the end of the line, or of the process.
                let _ = stdout.read_line(&mut word);
                // Nobody may wait for it any more.
                let _ = send.send((word, stdout));
            };
            let listener = std::thread::Builder::new().name("greeting".into()).spawn(listen);
            if let Err(error) = listener {
                let _ = child.kill().and_then(|()| child.wait());
                return Err(Failure::Work(format!("no thread to listen to the {what}: {error}")));
            }
        }
        Ok(Self {
            what,
            farewell,
            arguments,
            child,
            greeting: Some(greeting),
            stdout: None,
            greeted: String::new(),
            said,
            ended: None,
        })
    }

    /// Waits until it has said that it has what it needs.
    ///
    /// # Errors
    /// As [`ChildProcess::is_ready`].
    pub(crate) fn wait(&mut self) -> Result<(), Failure> {
        match self.greeting.take() {
            None => Ok(()),
            Some(greeting) => self.greeted(greeting.recv().ok()),
        }
    }

    /// Whether it has said that it has what it needs. Does not wait.
    ///
    /// # Errors
    /// It has ended for lack of that: in its own words, with its own exit code.
    pub(crate) fn is_ready(&mut self) -> Result<bool, Failure> {
        match self.greeting.as_ref().map(Receiver::try_recv) {
            None => Ok(true),
            Some(Err(TryRecvError::Empty)) => Ok(false),
            Some(greeting) => {
                self.greeting = None;
                self.greeted(greeting.ok()).map(|()| true)
            }
        }
    }

    fn greeted(&mut self, greeting: Option<Greeting>) -> Result<(), Failure> {
        let (word, stdout) = greeting.map_or_else(Default::default, |(word, stdout)| (word, Some(stdout)));
        self.stdout = stdout;
        if let Some(more) = word.strip_suffix('\n').and_then(|word| word.strip_prefix(READY)) {
            more.trim_start().clone_into(&mut self.greeted);
            return Ok(());
        }
        self.ended = self.child.wait().ok();
        Err(self.failure())
    }

    /// What it had to say beyond that it is ready, on the same line.
    pub(crate) fn greeted_with(&self) -> &str {
        &self.greeted
    }

    /// The same, anew.
    ///
    /// # Errors
    /// As [`ChildProcess::start`].
    pub(crate) fn start_again(&self) -> Result<Self, Failure> {
        Self::start(self.what, self.farewell, self.arguments.clone())
    }

    /// Whether it has ended.
    pub(crate) fn has_ended(&mut self) -> bool {
        if self.ended.is_none() {
            self.ended = self.child.try_wait().ok().flatten();
        }
        self.ended.is_some()
    }

    /// Why it ended, with its own exit code.
    pub(crate) fn failure(&mut self) -> Failure {
        let words = self.words();
        match self.ended.and_then(|status| status.code()) {
            Some(2) => Failure::Usage(words),
            Some(3) => Failure::Bench(words),
            _ => Failure::Work(words),
        }
    }

    /// What it said last, or how it ended.
    pub(crate) fn words(&mut self) -> String {
        let mut said = String::new();
        let _ = self.said.rewind().and_then(|()| self.said.read_to_string(&mut said));
        let last = said.lines().last().map(|line| line.trim_start_matches("whirl: ").to_owned());
        last.unwrap_or_else(|| self.ended.map_or_else(|| "it still runs".to_owned(), |status| status.to_string()))
    }

    /// Whether it ended in good order.
    pub(crate) fn did_well(&self) -> bool {
        self.ended.is_some_and(|status| status.success())
    }

    /// Tells it to go on.
    ///
    /// # Errors
    /// It does not listen any more.
    pub(crate) fn tell(&mut self) -> Result<(), Failure> {
        let told = self.child.stdin.as_mut().map_or(Ok(()), |stdin| stdin.write_all(b"\n"));
        told.map_err(|error| Failure::Work(format!("the {} cannot be told to go on: {error}", self.what)))
    }

    /// Asks it to end, and does not wait.
    pub(crate) fn dismiss(&mut self) {
        // Closing its input is the request.
        drop(self.child.stdin.take());
    }

    /// What it printed before it ended: how it went.
    pub(crate) fn last_words(&mut self) -> String {
        let mut printed = String::new();
        if let Some((_, stdout)) = self.greeting.take().and_then(|greeting| greeting.recv().ok()) {
            self.stdout = Some(stdout);
        }
        if let Some(mut stdout) = self.stdout.take() {
            let _ = stdout.read_to_string(&mut printed);
        }
        printed
    }

    /// Asks it to end, and kills it if it does not.
    ///
    /// # Errors
    /// It cannot be killed.
    pub(crate) fn end(&mut self) -> Result<(), Failure> {
        if self.has_ended() {
            return Ok(());
        }
        self.dismiss();
        let start = Instant::now();
        while !self.has_ended() && start.elapsed() < self.farewell {
            std::thread::sleep(Duration::from_millis(2));
        }
        if !self.has_ended() {
            self.child
                .kill()
                .and_then(|()| self.child.wait())
                .map_err(|error| Failure::Work(format!("the {} does not end: {error}", self.what)))?;
        }
        Ok(())
    }
}

impl Drop for ChildProcess {
    fn drop(&mut self) {
        // After a panic: nobody is left to tell.
        let _ = self.end();
    }
}

fn spawn(what: &str, arguments: &[String]) -> Result<(Child, File), Failure> {
    let failed = |error: std::io::Error| Failure::Work(format!("the {what} cannot be started: {error}"));
    let program = std::env::current_exe().map_err(failed)?;
    let said = tempfile::tempfile().map_err(failed)?;
    let child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(said.try_clone().map_err(failed)?)
        // Whoever stops the dashboard and its job does not stop the machine.
        .process_group(0)
        .spawn()
        .map_err(failed)?;
    Ok((child, said))
}
