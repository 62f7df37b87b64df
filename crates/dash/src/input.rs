//! The keyboard thread and the signals, as one stream of messages.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam::channel::Sender;
use crossterm::event::{self, Event, KeyEvent, KeyEventKind, MouseEvent, MouseEventKind};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::{Handle, Signals};

/// How soon the keyboard thread notices that it shall end; nobody waits for that. Crossterm spins through the last
/// millisecond of every wait, so a short one costs processor time while nothing happens.
const PATIENCE: Duration = Duration::from_secs(2);

/// Something from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Input {
    /// A key was pressed, or repeats.
    Key(KeyEvent),
    /// The mouse did something.
    Mouse(MouseEvent),
    /// The screen has another size.
    Resized,
    /// A signal asks us to end.
    Signal,
    /// The terminal is gone.
    Closed,
}

/// Reads the terminal until `stop` becomes true.
pub(crate) fn keyboard(inputs: Sender<Input>, stop: Arc<AtomicBool>) -> std::io::Result<()> {
    std::thread::Builder::new().name("keyboard".into()).spawn(move || {
        while !stop.load(Ordering::Relaxed) {
            let input = match event::poll(PATIENCE) {
                Ok(false) => continue,
                Ok(true) => match event::read() {
                    Ok(Event::Key(key)) if key.kind != KeyEventKind::Release => Input::Key(key),
                    // A mouse that only moves over the screen asks for nothing.
                    Ok(Event::Mouse(mouse)) if mouse.kind != MouseEventKind::Moved => Input::Mouse(mouse),
                    Ok(Event::Resize(..)) => Input::Resized,
                    Ok(_) => continue,
                    Err(_) => Input::Closed,
                },
                Err(_) => Input::Closed,
            };
            if inputs.send(input).is_err() || input == Input::Closed {
                return;
            }
        }
    })?;
    Ok(())
}

/// Turns SIGINT, SIGTERM and SIGHUP into messages until the handle is closed.
pub(crate) fn signals(inputs: Sender<Input>) -> std::io::Result<Handle> {
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let handle = signals.handle();
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        for _ in signals.forever() {
            if inputs.send(Input::Signal).is_err() {
                return;
            }
        }
    })?;
    Ok(handle)
}
