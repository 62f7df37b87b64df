//! `whirl control`: a program of any kind as the controller outside of a running bench, by way of its standard input and output.

use std::io::{Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use wire::{ControlCommand, Controlling, HostState, Readings};

use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::{interrupt, output};

/// How long to look for readings without giving the processor away.
const SPIN: Duration = Duration::from_micros(100);
/// Then, how long to sleep between two looks.
const NAP: Duration = Duration::from_micros(50);
/// How often to see whether the bench and the program are still there.
const LOOK: Duration = Duration::from_millis(500);
/// How long the program may take to end once its standard input has.
const FAREWELL: Duration = Duration::from_secs(2);

/// Options of `whirl control`.
#[derive(Debug, clap::Args)]
pub(crate) struct ControlArgs {
    /// The program and its arguments, behind `--`
    #[arg(required = true, trailing_var_arg = true, value_name = "PROGRAM")]
    program: Vec<String>,
    #[command(flatten)]
    bench: BenchArgs,
}

/// Hands every sample's readings to the program, and its commands to the bench, until either ends.
///
/// # Errors
/// No such bench, one that is controlled already, or a program that cannot be started or ends.
pub(crate) fn run(args: &ControlArgs) -> Result<(), Failure> {
    let bench = args.bench.name()?;
    let stop = interrupt::flag()?;
    let carrier = attach::carrier("control")?;
    let mut controller = attach::controller(&carrier, &bench)?;
    let (program, arguments) = args.program.split_first().ok_or_else(|| Failure::Usage("no program".into()))?;
    let child = Command::new(program).args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| Failure::Usage(format!("{program}: cannot be started: {error}")))?;
    let ran = serve(&mut controller, &mut child, &stop);
    // Its input has ended with the pipes: whoever does not heed that is ended.
    let began = Instant::now();
    let ended = loop {
        match child.try_wait() {
            Ok(Some(status)) => break Some(status),
            Ok(None) if began.elapsed() < FAREWELL => std::thread::sleep(Duration::from_millis(5)),
            _ => {
                let _ = child.kill();
                let _ = child.wait();
                break None;
            }
        }
    };
    match ran? {
        End::Bench(count) => output::print_text(&format!("the bench has ended after {count} commands\n")),
        End::Stopped => Err(Failure::Interrupted),
        End::Program(count) => {
            let how = ended.map_or_else(|| "did not end".to_owned(), |status| status.to_string());
            Err(Failure::Work(format!("{program} sent no further command after {count} ({how})")))
        }
    }
}

/// Why it is over, after how many commands.
enum End {
    Bench(u64),
    Program(u64),
    Stopped,
}

fn serve(controller: &mut impl Controlling, child: &mut Child, stop: &AtomicBool) -> Result<End, Failure> {
    let (Some(mut to), Some(mut from)) = (child.stdin.take(), child.stdout.take()) else {
        return Err(Failure::Work("no pipes to the program".into()));
    };
    let mut answer = [0; ControlCommand::SIZE];
    let (mut count, mut idle, mut looked) = (0, Instant::now(), Instant::now());
    while !stop.load(Ordering::Relaxed) {
        let Some(readings) = newest(controller)? else {
            if looked.elapsed() > LOOK {
                looked = Instant::now();
                if controller.host() == HostState::Gone {
                    return Ok(End::Bench(count));
                }
                if child.try_wait().is_ok_and(|status| status.is_some()) {
                    return Ok(End::Program(count));
                }
            } else if idle.elapsed() > SPIN {
                std::thread::sleep(NAP);
            }
            continue;
        };
        // A pipe that is closed: the program has ended.
        if to.write_all(&readings.to_bytes()).and_then(|()| to.flush()).is_err()
            || from.read_exact(&mut answer).is_err()
        {
            return Ok(if stop.load(Ordering::Relaxed) { End::Stopped } else { End::Program(count) });
        }
        let mut command = ControlCommand::from_bytes(&answer);
        command.stamp();
        controller.command(&command)?;
        (count, idle) = (count + 1, Instant::now());
    }
    Ok(End::Stopped)
}

/// The newest readings: what came before them would be answered too late.
fn newest(controller: &mut impl Controlling) -> Result<Option<Readings>, Failure> {
    let mut found = None;
    while let Some(readings) = controller.readings()? {
        found = Some(readings);
    }
    Ok(found)
}
