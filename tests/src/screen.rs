//! A real terminal: `whirl` in a pseudo-terminal, keys in, screen out.

use std::io::{Read, Write};
use std::num::NonZeroU16;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use portable_pty::{Child, CommandBuilder, ExitStatus, MasterPty, PtySize, native_pty_system};
use rustix::termios::LocalModes;

/// How long anything on the screen may take to appear: generous, because test machines are slow.
pub const PATIENCE: Duration = Duration::from_secs(30);

fn cells(count: u16) -> NonZeroU16 {
    NonZeroU16::new(count).expect("a screen has cells")
}

/// A program on a screen of its own.
pub struct Screen {
    child: Box<dyn Child + Send + Sync>,
    /// Both until the terminal is closed.
    terminal: Option<(Box<dyn MasterPty + Send>, Box<dyn Write + Send>)>,
    /// Tells the thread that reads to let go of the terminal.
    closing: Arc<AtomicBool>,
    parser: Arc<Mutex<vt100::Parser>>,
    bells: Arc<AtomicUsize>,
    /// Reads what the program writes, to the end.
    reader: std::thread::JoinHandle<()>,
    /// How often a program has taken the terminal for a screen of its own.
    taken: Arc<AtomicUsize>,
}

impl Screen {
    /// Starts `whirl` with these arguments on a screen of `columns` by `rows`, under the root of shared memory `root`.
    ///
    /// # Panics
    /// If there is no pseudo-terminal, or the program cannot be started.
    #[must_use]
    pub fn start(root: &Path, arguments: &[&str], size: (u16, u16)) -> Self {
        let here = std::env::current_dir().expect("a folder to be in");
        Self::start_in(&here, root, arguments, size)
    }

    /// The same, with the program in `folder`: files that it makes without being told where land there.
    ///
    /// # Panics
    /// As [`Screen::start`].
    #[must_use]
    pub fn start_in(folder: &Path, root: &Path, arguments: &[&str], size: (u16, u16)) -> Self {
        Self::of_program(&crate::program(), folder, root, arguments, size)
    }

    /// The same with any program.
    ///
    /// # Panics
    /// As [`Screen::start`].
    #[must_use]
    pub fn of_program(program: &Path, folder: &Path, root: &Path, arguments: &[&str], size: (u16, u16)) -> Self {
        let mut command = CommandBuilder::new(program);
        command.args(arguments);
        Self::of(command, folder, root, size)
    }

    /// Starts a shell that controls jobs, in which the program is called `whirl`.
    ///
    /// # Panics
    /// As [`Screen::start`].
    #[must_use]
    pub fn shell(root: &Path, size: (u16, u16)) -> Self {
        let mut command = CommandBuilder::new("sh");
        command.arg("-i");
        command.env("ENV", "");
        command.env("PS1", "shell> ");
        let here = std::env::current_dir().expect("a folder to be in");
        let mut screen = Self::of(command, &here, root, size);
        screen.wait_words("shell>");
        screen.press(&format!("alias whirl={}\r", crate::program().display()));
        screen.wait("the shell to be ready", |text| (text.matches("shell>").count() == 2).then_some(()));
        screen
    }

    fn of(mut command: CommandBuilder, folder: &Path, root: &Path, (columns, rows): (u16, u16)) -> Self {
        let size = PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 };
        let pair = native_pty_system().openpty(size).expect("a pseudo-terminal");
        command.cwd(folder);
        command.env("WHIRL_ROOT", root);
        // Not the configuration and the gains of whoever runs the tests; neither is there until something is kept.
        command.env("XDG_CONFIG_HOME", root.join("config"));
        command.env("XDG_DATA_HOME", root.join("data"));
        command.env("XDG_STATE_HOME", root.join("state"));
        command.env("TERM", "xterm-256color");
        let child = pair.slave.spawn_command(command).expect("whirl starts");
        let mut output = pair.master.try_clone_reader().expect("a readable terminal");
        let keys = pair.master.take_writer().expect("a writable terminal");
        let parser = Arc::new(Mutex::new(vt100::Parser::new(cells(rows), cells(columns), 0)));
        let written = parser.clone();
        let bells = Arc::new(AtomicUsize::new(0));
        let rung = bells.clone();
        let closing = Arc::new(AtomicBool::new(false));
        let closes = closing.clone();
        let taken = Arc::new(AtomicUsize::new(0));
        let takes = taken.clone();
        let reader = std::thread::spawn(move || {
            let mut bytes = [0; 65_536];
            while let Ok(count @ 1..) = output.read(&mut bytes) {
                rung.fetch_add(bytes[..count].iter().filter(|byte| **byte == 7).count(), Ordering::SeqCst);
                let mut parser = written.lock().unwrap_or_else(PoisonError::into_inner);
                // What comes and goes within one read is counted too: the sequences that switch end in one of these letters.
                for piece in bytes[..count].split_inclusive(|byte| matches!(byte, b'h' | b'l')) {
                    let was_taken = parser.screen().alternate_screen();
                    parser.process(piece);
                    if !was_taken && parser.screen().alternate_screen() {
                        takes.fetch_add(1, Ordering::SeqCst);
                    }
                }
                drop(parser);
                if closes.load(Ordering::SeqCst) {
                    return;
                }
            }
        });
        Self { child, terminal: Some((pair.master, keys)), closing, parser, bells, taken, reader }
    }

    fn look<T>(&self, at: impl FnOnce(&vt100::Screen) -> T) -> T {
        at(self.parser.lock().unwrap_or_else(PoisonError::into_inner).screen())
    }

    /// What is on the screen.
    #[must_use]
    pub fn text(&self) -> String {
        self.look(|screen| screen.contents())
    }

    /// Whether the program still draws on a screen of its own, or hides the cursor.
    #[must_use]
    pub fn is_taken(&self) -> bool {
        self.look(|screen| screen.alternate_screen() || screen.hide_cursor())
    }

    /// How often the bell has rung.
    #[must_use]
    pub fn bells(&self) -> usize {
        self.bells.load(Ordering::SeqCst)
    }

    /// Whether the program is told of the mouse.
    #[must_use]
    pub fn has_mouse(&self) -> bool {
        self.look(|screen| screen.mouse_protocol_mode() != vt100::MouseProtocolMode::None)
    }

    /// Whether what is typed is shown by the terminal itself: it is not while a program has taken it over.
    ///
    /// # Panics
    /// If the terminal is closed.
    #[must_use]
    pub fn is_cooked(&self) -> bool {
        let (master, _) = self.terminal.as_ref().expect("the terminal is open");
        let modes = master.get_termios().expect("a terminal has modes");
        modes.local_flags.bits() & (LocalModes::ECHO | LocalModes::ICANON).bits() != 0
    }

    /// The colour of the first cell of `word`.
    #[must_use]
    pub fn color_of(&self, word: &str) -> Option<(vt100::Color, bool)> {
        self.look(|screen| {
            let (rows, columns) = screen.size();
            let (rows, columns) = (rows.get(), columns.get());
            (0..rows).find_map(|row| {
                let cells: Vec<_> = (0..columns).filter_map(|column| screen.cell(row, column)).collect();
                let line: Vec<&str> = cells.iter().map(|cell| cell.contents()).collect();
                let at = (0..line.len()).find(|from| line[*from..].concat().starts_with(word))?;
                Some((cells[at].fgcolor(), cells[at].inverse()))
            })
        })
    }

    /// Types `keys` as they are.
    ///
    /// # Panics
    /// If the terminal is gone.
    pub fn press(&mut self, keys: &str) {
        let (_, to) = self.terminal.as_mut().expect("the terminal is open");
        to.write_all(keys.as_bytes()).and_then(|()| to.flush()).expect("the terminal takes keys");
    }

    /// Types `keys` and waits for the `words` that they bring.
    ///
    /// # Panics
    /// See [`Screen::press_until`].
    pub fn press_for(&mut self, keys: &str, words: &str) {
        self.press_until(keys, words, |text| text.contains(words).then_some(()));
    }

    /// Types `keys` and waits until the screen shows what `found` looks for: something new. What stood there before the
    /// keys is no answer to them, and a test that takes it for one presses its next keys too early.
    ///
    /// # Panics
    /// If it is there already, or does not come in time; the message shows the screen.
    pub fn press_until<T>(&mut self, keys: &str, what: &str, mut found: impl FnMut(&str) -> Option<T>) -> T {
        let before = self.text();
        assert!(found(&before).is_none(), "{what} is there before {keys:?}: wait for what is new\n{before}");
        self.press(keys);
        self.wait(what, found)
    }

    /// Types `keys` that make the program give the terminal back, and waits until it, or another one, has taken it again:
    /// it is raw by then.
    ///
    /// # Panics
    /// If nobody does in time; the message shows the screen.
    pub fn press_until_taken_again(&mut self, keys: &str) {
        let before = self.taken.load(Ordering::SeqCst);
        self.press(keys);
        self.wait("the terminal to be taken again", |_| {
            (self.taken.load(Ordering::SeqCst) > before && self.is_taken()).then_some(())
        });
    }

    /// Gives the screen another size.
    ///
    /// # Panics
    /// If the terminal is gone.
    pub fn resize(&self, columns: u16, rows: u16) {
        let size = PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 };
        self.parser.lock().unwrap_or_else(PoisonError::into_inner).screen_mut().set_size(cells(rows), cells(columns));
        let (master, _) = self.terminal.as_ref().expect("the terminal is open");
        master.resize(size).expect("the terminal can be resized");
    }

    /// Closes the terminal, as if its window were: what the program writes next goes nowhere.
    pub fn close(&mut self) {
        // The thread that reads holds it too, until it has read once more.
        self.closing.store(true, Ordering::SeqCst);
        self.terminal = None;
    }

    /// Waits until the screen shows what `found` looks for.
    ///
    /// # Panics
    /// If it does not in time; the message shows the screen.
    pub fn wait<T>(&self, what: &str, found: impl FnMut(&str) -> Option<T>) -> T {
        self.wait_for(what, PATIENCE, found)
    }

    /// The same, with a patience of its own.
    ///
    /// # Panics
    /// If it does not in time; the message shows the screen.
    pub fn wait_for<T>(&self, what: &str, patience: Duration, mut found: impl FnMut(&str) -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            let text = self.text();
            if let Some(found) = found(&text) {
                return found;
            }
            assert!(start.elapsed() < patience, "{what} did not come:\n{text}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits until `words` are on the screen.
    ///
    /// # Panics
    /// See [`Screen::wait`].
    pub fn wait_words(&self, words: &str) {
        self.wait(words, |text| text.contains(words).then_some(()));
    }

    /// The process id of the program.
    ///
    /// # Panics
    /// If it has already been waited for.
    #[must_use]
    pub fn pid(&self) -> u32 {
        self.child.process_id().expect("a running program")
    }

    /// Waits for the program to end.
    ///
    /// # Panics
    /// If it does not in time.
    pub fn ended(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("a child can be waited for") {
                self.drained();
                return status;
            }
            assert!(start.elapsed() < PATIENCE, "it does not end:\n{}", self.text());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits for what the program wrote last to reach the parser: to the end of the output, which comes when nobody holds
    /// the other side of the terminal any more.
    fn drained(&self) {
        let start = Instant::now();
        while !self.reader.is_finished() && start.elapsed() < crate::FAREWELL {
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // A failed test leaves nothing running. Asked to end, the dashboard takes its simulation with it.
        if let Some(pid) = self.child.process_id().and_then(|pid| rustix::process::Pid::from_raw(pid as i32)) {
            let _ = rustix::process::kill_process(pid, rustix::process::Signal::TERM);
        }
        let start = Instant::now();
        while self.child.try_wait().is_ok_and(|ended| ended.is_none()) && start.elapsed() < crate::FAREWELL {
            std::thread::sleep(Duration::from_millis(2));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
