//! The keyboard thread: keys, the mouse and resizes as messages. Signals are the module `signals`'.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam::channel::Sender;
use crossterm::event::{self, Event, KeyEvent, KeyEventKind, MouseEvent};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// How soon the keyboard thread notices that it shall end; nobody waits for that. Crossterm spins through the last
/// millisecond of every wait, so a short one costs processor time while nothing happens.
const PATIENCE: Duration = Duration::from_secs(2);

/// Something from outside.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Input {
    /// A key was pressed, or repeats.
    Key(KeyEvent),
    /// The mouse did something.
    Mouse(MouseEvent),
    /// Text was pasted into the terminal.
    Paste(String),
    /// The screen has another size.
    Resized,
    /// A signal asks us to end.
    Signal,
    /// A signal asks us to stop until we are continued.
    Stop,
    /// We were stopped, and are continued.
    Continued,
    /// The terminal is gone.
    Closed,
}

/// What the mouse does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mouse {
    /// The left button goes down.
    Click,
    /// The mouse moves so many cells to the right with the left button down.
    Drag(i32),
    /// The wheel turns so many notches towards us.
    Wheel(i32),
}

/// Reads the terminal until `stop` becomes true.
pub(crate) fn keyboard(inputs: Sender<Input>, stop: Arc<AtomicBool>) -> std::io::Result<()> {
    std::thread::Builder::new().name("keyboard".into()).spawn(move || {
        while !stop.load(Ordering::Relaxed) {
            let input = match event::poll(PATIENCE) {
                // Crossterm takes a terminal that is gone for one on which nothing is pressed, and spins.
                Ok(false) if is_hung_up() => Input::Closed,
                Ok(false) => continue,
                Ok(true) => match event::read() {
                    Ok(Event::Key(key)) if key.kind != KeyEventKind::Release => Input::Key(key),
                    Ok(Event::Mouse(mouse)) => Input::Mouse(mouse),
                    Ok(Event::Paste(text)) => Input::Paste(text),
                    Ok(Event::Resize(..)) => Input::Resized,
                    Ok(_) => continue,
                    Err(_) => Input::Closed,
                },
                Err(_) => Input::Closed,
            };
            let is_last = input == Input::Closed;
            if inputs.send(input).is_err() || is_last {
                return;
            }
        }
    })?;
    Ok(())
}

/// Whether the other side of the terminal is closed.
fn is_hung_up() -> bool {
    let stdin = std::io::stdin();
    let mut asked = [PollFd::new(&stdin, PollFlags::empty())];
    let at_once = Timespec { tv_sec: 0, tv_nsec: 0 };
    let answered = poll(&mut asked, Some(&at_once)).is_ok_and(|count| count > 0);
    answered && asked[0].revents().intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL)
}
