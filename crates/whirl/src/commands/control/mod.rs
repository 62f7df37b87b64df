//! `whirl control`: a program of any kind as the controller outside of a running bench, by way of its standard input and output.

mod notices;
mod program;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use wire::{Controlling, HostState, Readings};

use self::notices::Notices;
use self::program::{Answer, Program, mistaken};
use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::{interrupt, output};

/// How long to look for readings without giving the processor away.
const SPIN: Duration = Duration::from_micros(100);
/// Then, how long to sleep between two looks.
const NAP: Duration = Duration::from_micros(50);
/// How often to see whether the bench and the program are still there.
const LOOK: Duration = Duration::from_millis(200);

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
/// No such bench, one that is controlled already, or a program that cannot be started, ends, or writes what is no command.
pub(crate) fn run(args: &ControlArgs) -> Result<(), Failure> {
    let bench = args.bench.name()?;
    let stop = interrupt::flag()?;
    let carrier = attach::carrier("control")?;
    let mut controller = attach::controller(&carrier, &bench)?;
    let mut program = Program::start(&args.program)?;
    let mut notices = Notices::new(&carrier, &bench);
    let ran = serve(&mut controller, &mut program, &mut notices, &stop);
    let name = program.name().to_owned();
    let ended = program.end();
    match ran? {
        End::Bench(count) => output::print_text(&format!("the bench has ended after {count} commands\n")),
        End::Stopped => Err(Failure::Interrupted),
        End::Program(count) => {
            let how = ended.map_or_else(|| "did not end".to_owned(), |status| status.to_string());
            Err(Failure::Work(format!("{name} sent no further command after {count} ({how})")))
        }
        End::Mistaken(count, what) => Err(Failure::Work(format!("{name}, after {count} commands: {what}"))),
    }
}

/// Why it is over, after how many commands.
enum End {
    Bench(u64),
    Program(u64),
    /// The program wrote what is no command.
    Mistaken(u64, String),
    Stopped,
}

fn serve(
    controller: &mut impl Controlling,
    program: &mut Program,
    notices: &mut Notices<'_>,
    stop: &AtomicBool,
) -> Result<End, Failure> {
    let (mut count, mut idle, mut looked) = (0, Instant::now(), Instant::now());
    while !stop.load(Ordering::Relaxed) {
        let Some(readings) = newest(controller)? else {
            if looked.elapsed() > LOOK {
                looked = Instant::now();
                if controller.host() == HostState::Gone {
                    return Ok(End::Bench(count));
                }
                if program.has_ended() {
                    return Ok(End::Program(count));
                }
                notices.bench_is_silent();
            } else if idle.elapsed() > SPIN {
                std::thread::sleep(NAP);
            }
            continue;
        };
        notices.heard(&readings);
        if !program.give(&readings) {
            return Ok(End::Program(count));
        }
        let given = Instant::now();
        let mut command = loop {
            match program.answer(LOOK) {
                Answer::Command(command) => break command,
                Answer::Ended if stop.load(Ordering::Relaxed) => return Ok(End::Stopped),
                Answer::Ended => return Ok(End::Program(count)),
                Answer::NotYet if stop.load(Ordering::Relaxed) => return Ok(End::Stopped),
                Answer::NotYet if controller.host() == HostState::Gone => return Ok(End::Bench(count)),
                Answer::NotYet => notices.program_is_silent(program.name(), given, &readings),
            }
        };
        if let Some(what) = mistaken(&command, &readings) {
            return Ok(End::Mistaken(count, what));
        }
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
