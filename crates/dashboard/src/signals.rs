//! What signals do to a dashboard: it ends in good order, ends at once, stops or goes on; the terminal is given back first,
//! whichever it is. Only what cannot be caught (`SIGKILL`, `SIGSTOP`, a fault of the processor) leaves it as it is.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam::channel::Sender;
use rustix::process::{Signal, getpgrp, getsid, kill_process_group};
use signal_hook::consts::{
    SIGABRT, SIGALRM, SIGCONT, SIGHUP, SIGINT, SIGPROF, SIGQUIT, SIGSYS, SIGTERM, SIGTRAP, SIGTSTP, SIGUSR1, SIGUSR2,
    SIGVTALRM, SIGXCPU, SIGXFSZ,
};
use signal_hook::iterator::{Handle, Signals};
use signal_hook::low_level::emulate_default_handler;

use crate::input::Input;
use crate::terminal;

/// They ask us to end in good order.
const ENDING: [i32; 3] = [SIGINT, SIGTERM, SIGHUP];
/// They end us at once, as by themselves they would: with a core file and their name as the reason where that is asked
/// for.
const DEADLY: [i32; 11] =
    [SIGQUIT, SIGABRT, SIGALRM, SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ, SIGSYS, SIGTRAP];
/// How long the loop may take to end in good order before we end without it: a terminal that takes nothing (ctrl-s, a
/// stopped pager) can hold it for ever.
const FAREWELL: Duration = Duration::from_secs(2);
/// How long a stop takes at most to come about.
const STOPPING: Duration = Duration::from_secs(1);

/// Whether we have been continued since the last stop began.
static CONTINUED: AtomicBool = AtomicBool::new(false);

/// Turns signals into messages, and deadly ones into a terminal given back and an end, until the handle is closed.
///
/// # Errors
/// A handler cannot be set, or the thread not be started.
pub(crate) fn listen(inputs: Sender<Input>) -> std::io::Result<Handle> {
    let all = ENDING.into_iter().chain(DEADLY).chain([SIGTSTP, SIGCONT]);
    let mut signals = Signals::new(all)?;
    let handle = signals.handle();
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        for signal in signals.forever() {
            let input = match signal {
                SIGTSTP => Input::Stop,
                SIGCONT => {
                    CONTINUED.store(true, Ordering::SeqCst);
                    Input::Continued
                }
                _ if ENDING.contains(&signal) => {
                    end_without_the_loop(signal);
                    Input::Signal
                }
                deadly => {
                    terminal::leave_for_good();
                    // It does not return.
                    let _ = emulate_default_handler(deadly);
                    return;
                }
            };
            if inputs.send(input).is_err() {
                return;
            }
        }
    })?;
    Ok(handle)
}

/// Ends us some time after `signal`, if the loop has not given the terminal back by then.
fn end_without_the_loop(signal: i32) {
    // Without a thread to spare the loop alone can end us.
    let _ = std::thread::Builder::new().name("last-resort".into()).spawn(move || {
        let start = Instant::now();
        while start.elapsed() < FAREWELL {
            std::thread::sleep(Duration::from_millis(20));
            if !terminal::is_taken() {
                return;
            }
        }
        terminal::leave_for_good();
        let _ = emulate_default_handler(signal);
    });
}

/// Stops the job that we are, as the shell's ctrl-z would, and returns when it is continued. Where we are the leader of our
/// session no shell waits, and nobody would continue us: then nothing is done.
pub(crate) fn stop() {
    let group = getpgrp();
    if getsid(None).is_ok_and(|session| session != group) {
        CONTINUED.store(false, Ordering::SeqCst);
        // SIGTSTP is caught, so it stops nothing any more.
        if kill_process_group(group, Signal::STOP).is_ok() {
            let start = Instant::now();
            while !CONTINUED.load(Ordering::SeqCst) && start.elapsed() < STOPPING {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
    }
}
