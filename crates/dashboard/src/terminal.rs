//! The terminal: taken over, drawn on, and given back however we end.
//!
//! A frame is drawn while the [`Screen`] is borrowed, and whatever else acts on a terminal needs the screen too: so
//! drawing can have no side effects. What asks for one is carried out by the loop, between two frames.

use std::io::{self, IsTerminal, Stdout, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, Once, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use crossterm::cursor::{Hide, Show};
use crossterm::event::{DisableBracketedPaste, DisableMouseCapture, EnableBracketedPaste, EnableMouseCapture};
use crossterm::style::Print;
use crossterm::terminal::{
    BeginSynchronizedUpdate, Clear, ClearType, EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen,
    disable_raw_mode, enable_raw_mode,
};
use crossterm::{execute, queue};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;

use crate::appearance::Look;

/// Whether the screen is ours at the moment.
static TAKEN: AtomicBool = AtomicBool::new(false);
/// Held while a frame is drawn, so that a panic in another thread does not give the terminal back in the middle of one.
static DRAWING: Mutex<()> = Mutex::new(());
/// How long a panic waits for a frame; its own thread may be the one that draws.
const LAST_FRAME: Duration = Duration::from_millis(200);
/// Whether any thread has panicked while the screen was ours.
static PANICKED: AtomicBool = AtomicBool::new(false);

/// The screen, ours until this is dropped.
pub(crate) struct Screen {
    terminal: Canvas,
    look: Look,
}

impl Screen {
    /// Whether there is a terminal to take over.
    pub(crate) fn is_possible() -> bool {
        io::stdin().is_terminal() && io::stdout().is_terminal() && !is_dumb(std::env::var("TERM").ok().as_deref())
    }

    /// Takes the terminal over; frames are finished with `look`.
    pub(crate) fn take(look: Look) -> io::Result<Self> {
        restore_on_panic();
        let taken = take_over().map(|terminal| Self { terminal, look });
        if taken.is_err() {
            give_back();
        }
        taken
    }

    /// Gives the terminal back, stops this process as the shell's ctrl-z would (with `stop`), and takes the terminal over again when
    /// it is continued. Where no shell waits for it, it is not stopped.
    ///
    /// # Errors
    /// The terminal fails, or is gone by then.
    pub(crate) fn suspend(&mut self, stop: impl FnOnce()) -> io::Result<()> {
        give_back();
        stop();
        self.terminal = take_over()?;
        Ok(())
    }

    /// Takes the terminal over anew after somebody else has had it: whoever stopped us with a signal that cannot be
    /// caught may have left it in any state.
    ///
    /// # Errors
    /// The terminal fails, or is gone by then.
    pub(crate) fn take_again(&mut self) -> io::Result<()> {
        // Else raw mode is held to be on still.
        let _ = disable_raw_mode();
        self.terminal = take_over()?;
        Ok(())
    }

    /// Draws one frame as a whole: terminals that can, show nothing until it is complete. Returns how long the terminal took to take it.
    pub(crate) fn draw(&mut self, frame: impl FnOnce(&mut ratatui::Frame<'_>)) -> io::Result<Duration> {
        let _drawing = DRAWING.lock().unwrap_or_else(PoisonError::into_inner);
        if Self::is_broken() {
            return Ok(Duration::ZERO);
        }
        let (begun, mut own) = (Instant::now(), Duration::ZERO);
        let timed = |canvas: &mut ratatui::Frame<'_>| {
            let begun = Instant::now();
            frame(canvas);
            own = begun.elapsed();
        };
        if let Some(terminal) = &mut self.terminal.0 {
            draw_whole(terminal, self.look, timed)?;
        }
        Ok(begun.elapsed().saturating_sub(own))
    }

    /// Rings the terminal's bell.
    pub(crate) fn ring(&mut self) {
        let _drawing = DRAWING.lock().unwrap_or_else(PoisonError::into_inner);
        if TAKEN.load(Ordering::SeqCst) {
            // A bell that cannot be rung is no reason to end.
            let _ = execute!(io::stdout(), Print('\x07'));
        }
    }

    /// Puts a text on the clipboard of whoever looks at the terminal, as far as that lets it (OSC 52).
    pub(crate) fn copy(&mut self, text: &str) {
        let _drawing = DRAWING.lock().unwrap_or_else(PoisonError::into_inner);
        if TAKEN.load(Ordering::SeqCst) {
            let _ = execute!(io::stdout(), Print(format!("\x1b]52;c;{}\x1b\\", base64(text.as_bytes()))));
        }
    }

    /// Whether some thread has panicked: its message is on the terminal, and drawing on would hide it.
    pub(crate) fn is_broken() -> bool {
        PANICKED.load(Ordering::SeqCst)
    }
}

/// Whether a terminal of this kind can do no more than print lines.
fn is_dumb(kind: Option<&str>) -> bool {
    kind == Some("dumb")
}

/// Bytes in the letters that a terminal takes a clipboard in (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let letters = |chunk: &[u8]| {
        let bits = [0, 1, 2].into_iter().fold(0_u32, |bits, at| bits << 8 | u32::from(*chunk.get(at).unwrap_or(&0)));
        let letter = |at: usize| char::from(LETTERS[(bits >> (18 - 6 * at)) as usize & 63]);
        [0, 1, 2, 3].map(|at| if at <= chunk.len() { letter(at) } else { '=' })
    };
    bytes.chunks(3).flat_map(letters).collect()
}

/// Draws one frame as a whole, finished with `look`.
pub(crate) fn draw_whole<W: Write>(
    terminal: &mut Terminal<CrosstermBackend<W>>,
    look: Look,
    frame: impl FnOnce(&mut ratatui::Frame<'_>),
) -> io::Result<()> {
    queue!(terminal.backend_mut(), BeginSynchronizedUpdate)?;
    let drawn = terminal.draw(|canvas| {
        frame(canvas);
        look.finish(canvas.buffer_mut());
    });
    let drawn = drawn.map(|_| ());
    execute!(terminal.backend_mut(), EndSynchronizedUpdate)?;
    drawn
}

impl Drop for Screen {
    fn drop(&mut self) {
        give_back();
    }
}

/// What frames are drawn on.
struct Canvas(Option<Terminal<CrosstermBackend<Stdout>>>);

impl Drop for Canvas {
    /// When ratatui drops a terminal that is gone it says so on stderr, and panics if that is gone too: then it is
    /// forgotten, a moment before the process ends.
    fn drop(&mut self) {
        if let Some(mut terminal) = self.0.take()
            && terminal.show_cursor().is_err()
        {
            std::mem::forget(terminal);
        }
    }
}

/// Whether the terminal behind an error is closed.
pub(crate) fn is_gone(error: &io::Error) -> bool {
    // What a pseudo-terminal answers whose other side is closed; the number is the same on every Unix.
    const EIO: i32 = 5;
    error.raw_os_error() == Some(EIO) || error.kind() == io::ErrorKind::BrokenPipe
}

/// Takes the terminal over; the first frame draws every cell.
fn take_over() -> io::Result<Canvas> {
    TAKEN.store(true, Ordering::SeqCst);
    enable_raw_mode()?;
    // Not `Terminal::clear`: that asks the terminal where the cursor is, and waits for an answer that some never give.
    // What is pasted comes marked as such: its letters are no keys.
    let out = &mut io::stdout();
    execute!(out, EnterAlternateScreen, EnableMouseCapture, EnableBracketedPaste, Clear(ClearType::All), Hide)?;
    Terminal::new(CrosstermBackend::new(io::stdout())).map(|terminal| Canvas(Some(terminal)))
}

/// Gives the terminal back, once. Nothing can be done here if that fails.
fn give_back() {
    if TAKEN.swap(false, Ordering::SeqCst) {
        // First what cannot wait for a terminal that takes nothing at the moment.
        let _ = disable_raw_mode();
        let out = &mut io::stdout();
        let _ = execute!(out, EndSynchronizedUpdate, DisableBracketedPaste, DisableMouseCapture);
        let _ = execute!(out, LeaveAlternateScreen, Show);
        let _ = out.flush();
    }
}

/// Whether the terminal is ours.
pub(crate) fn is_taken() -> bool {
    TAKEN.load(Ordering::SeqCst)
}

/// Gives the terminal back from any thread, for good: the frame that is being drawn ends first, and no other follows.
/// The process ends next, so nobody waits long for a terminal that takes nothing.
pub(crate) fn leave_for_good() {
    let leave = std::thread::Builder::new().name("farewell".into()).spawn(|| {
        let last_frame = wait_for_frame();
        give_back();
        // Never unlocked.
        std::mem::forget(last_frame);
    });
    if let Ok(leave) = leave {
        let start = Instant::now();
        while !leave.is_finished() && start.elapsed() < 3 * LAST_FRAME {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Waits for the frame that is being drawn, as long as that is worth it.
fn wait_for_frame() -> Option<MutexGuard<'static, ()>> {
    let start = Instant::now();
    loop {
        match DRAWING.try_lock() {
            Ok(guard) => return Some(guard),
            Err(TryLockError::Poisoned(guard)) => return Some(guard.into_inner()),
            Err(TryLockError::WouldBlock) if start.elapsed() > LAST_FRAME => return None,
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(1)),
        }
    }
}

/// A panic in any thread first gives the terminal back, so that its message can be read. A library that catches panics of
/// its own, and has a hook that keeps silent about them, sets it after this one.
pub fn restore_on_panic() {
    static SET: Once = Once::new();
    SET.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if TAKEN.load(Ordering::SeqCst) {
                PANICKED.store(true, Ordering::SeqCst);
                drop(wait_for_frame());
                give_back();
            }
            report(panic);
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clipboard_is_written_as_terminals_read_it() {
        // RFC 4648, section 10.
        let known = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ];
        known.into_iter().for_each(|(text, letters)| assert_eq!(base64(text.as_bytes()), letters));
        assert!(is_dumb(Some("dumb")) && !is_dumb(Some("xterm")) && !is_dumb(None));
    }
}
