//! The program that controls: given readings on its standard input, asked for commands on its standard output.

use std::io::{Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use wire::{ControlCommand, Readings};

use crate::failure::Failure;

/// How long the program may take to end once its standard input has.
const FAREWELL: Duration = Duration::from_millis(500);

/// A program at work.
pub(super) struct Program {
    name: String,
    child: Child,
    to: Option<ChildStdin>,
    /// Commands as they come. A thread reads them, so that a program that sends none holds nobody up.
    answers: Receiver<[u8; ControlCommand::SIZE]>,
}

/// What comes of waiting for a command.
pub(super) enum Answer {
    Command(ControlCommand),
    NotYet,
    /// The program has closed its standard output.
    Ended,
}

impl Program {
    /// Starts a program with its arguments.
    ///
    /// # Errors
    /// It cannot be started.
    pub(super) fn start(command: &[String]) -> Result<Self, Failure> {
        let (program, arguments) = command.split_first().ok_or_else(|| Failure::Usage("no program".into()))?;
        let child = Command::new(program).args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = child.map_err(|error| Failure::Usage(format!("{program}: cannot be started: {error}")))?;
        let (Some(to), Some(from)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(Failure::Work("no pipes to the program".into()));
        };
        Ok(Self { name: program.clone(), child, to: Some(to), answers: commands(from) })
    }

    /// Gives it readings. Whether it takes them: one that has ended does not.
    pub(super) fn give(&mut self, readings: &Readings) -> bool {
        self.to.as_mut().is_some_and(|to| to.write_all(&readings.to_bytes()).and_then(|()| to.flush()).is_ok())
    }

    /// Waits so long for its command.
    pub(super) fn answer(&self, patience: Duration) -> Answer {
        match self.answers.recv_timeout(patience) {
            Ok(bytes) => Answer::Command(ControlCommand::from_bytes(&bytes)),
            Err(RecvTimeoutError::Timeout) => Answer::NotYet,
            Err(RecvTimeoutError::Disconnected) => Answer::Ended,
        }
    }

    /// Whether it has ended.
    pub(super) fn has_ended(&mut self) -> bool {
        self.child.try_wait().is_ok_and(|status| status.is_some())
    }

    /// Ends its standard input, and, if it does not heed that, it. How it ended, if by itself.
    pub(super) fn end(mut self) -> Option<ExitStatus> {
        self.to = None;
        let began = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) if began.elapsed() < FAREWELL => std::thread::sleep(Duration::from_millis(5)),
                _ => {
                    let _ = self.child.kill();
                    let _ = self.child.wait();
                    return None;
                }
            }
        }
    }

    /// What it is called.
    pub(super) fn name(&self) -> &str {
        &self.name
    }
}

/// Every command that is written, until the end of what is.
fn commands(mut from: ChildStdout) -> Receiver<[u8; ControlCommand::SIZE]> {
    // A program that writes without being asked is held up by its own pipe.
    let (send, answers) = sync_channel(1);
    std::thread::spawn(move || {
        let mut bytes = [0; ControlCommand::SIZE];
        while from.read_exact(&mut bytes).is_ok() && send.send(bytes).is_ok() {}
    });
    answers
}

/// Why what a program wrote is no command for the readings that it was given; nothing if it is.
pub(super) fn mistaken(command: &ControlCommand, readings: &Readings) -> Option<String> {
    let own = (command.run_id, command.number) == (readings.run_id, readings.number);
    (!own).then(|| {
        format!(
            "its answer is to readings {} of run {}: expected run_id and number as they were given, {} and {}; \
             whatever else is written to standard output is taken for a command",
            command.number, command.run_id, readings.run_id, readings.number
        )
    })
}
