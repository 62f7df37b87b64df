//! The terminal: taken over, drawn on, and given back however we end.

use std::io::{self, IsTerminal, Stdout, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use crossterm::cursor::{Hide, Show};
use crossterm::event::{DisableMouseCapture, EnableMouseCapture};
use crossterm::style::Print;
use crossterm::terminal::{
    BeginSynchronizedUpdate, Clear, ClearType, EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen,
    disable_raw_mode, enable_raw_mode,
};
use crossterm::{execute, queue};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;

use crate::looks::Look;

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
        io::stdin().is_terminal() && io::stdout().is_terminal()
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

    /// Gives the terminal back, stops this process as the shell's ctrl-z would, and takes the terminal over again when
    /// it is continued. Where no shell waits for it, the system does not stop it.
    pub(crate) fn suspend(&mut self) -> io::Result<()> {
        give_back();
        signal_hook::low_level::raise(signal_hook::consts::SIGTSTP)?;
        self.terminal = take_over()?;
        Ok(())
    }

    /// Draws one frame as a whole: terminals that can, show nothing until it is complete.
    pub(crate) fn draw(&mut self, frame: impl FnOnce(&mut ratatui::Frame<'_>)) -> io::Result<()> {
        let _drawing = DRAWING.lock().unwrap_or_else(PoisonError::into_inner);
        if Self::is_broken() {
            return Ok(());
        }
        match &mut self.terminal.0 {
            Some(terminal) => draw_whole(terminal, self.look, frame),
            None => Ok(()),
        }
    }

    /// Rings the terminal's bell.
    pub(crate) fn ring() {
        let _drawing = DRAWING.lock().unwrap_or_else(PoisonError::into_inner);
        if TAKEN.load(Ordering::SeqCst) {
            // A bell that cannot be rung is no reason to end.
            let _ = execute!(io::stdout(), Print('\x07'));
        }
    }

    /// Whether some thread has panicked: its message is on the terminal, and drawing on would hide it.
    pub(crate) fn is_broken() -> bool {
        PANICKED.load(Ordering::SeqCst)
    }
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
    execute!(io::stdout(), EnterAlternateScreen, EnableMouseCapture, Clear(ClearType::All), Hide)?;
    Terminal::new(CrosstermBackend::new(io::stdout())).map(|terminal| Canvas(Some(terminal)))
}

/// Gives the terminal back, once. Nothing can be done here if that fails.
fn give_back() {
    if TAKEN.swap(false, Ordering::SeqCst) {
        let _ = execute!(io::stdout(), EndSynchronizedUpdate, DisableMouseCapture, LeaveAlternateScreen, Show);
        let _ = disable_raw_mode();
        let _ = io::stdout().flush();
    }
}

/// A panic in any thread first gives the terminal back, so that its message can be read.
fn restore_on_panic() {
    static SET: Once = Once::new();
    SET.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if TAKEN.load(Ordering::SeqCst) {
                PANICKED.store(true, Ordering::SeqCst);
                let start = Instant::now();
                while matches!(DRAWING.try_lock(), Err(TryLockError::WouldBlock)) && start.elapsed() < LAST_FRAME {
                    std::thread::sleep(Duration::from_millis(1));
                }
                give_back();
            }
            report(panic);
        }));
    });
}
