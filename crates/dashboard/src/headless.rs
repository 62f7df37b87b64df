//! The dashboard without a terminal, for whoever measures what its frames cost: the same as on one, without its threads.

use std::io::{self, Write};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use crossbeam::channel;
use ratatui::backend::CrosstermBackend;
use ratatui::layout::Rect;
use ratatui::{Terminal, TerminalOptions, Viewport};
use wire::{BenchStatus, Step};

use crate::app::App;
use crate::appearance::Look;
use crate::options::Options;
use crate::screenshot::image::Screenshot;
use crate::terminal;
use telemetry::feed::Feed;
use telemetry::jobs::Jobs;
use telemetry::reader::{SharedFeed, lock};

/// A dashboard without a terminal, without threads and without keys.
pub struct Headless {
    feed: SharedFeed,
    app: App<'static>,
    look: Look,
}

impl Headless {
    /// A dashboard that has heard nothing yet. A screenshot can have all colours.
    #[must_use]
    pub fn new(bench: &str, options: &Options) -> Self {
        let feed: SharedFeed = Arc::new(Mutex::new(Feed::with_bound("waiting", options.history)));
        // Without keys nothing is wanted.
        let (edits, _) = channel::bounded(0);
        let app = App::new(bench.to_owned(), feed.clone(), edits, None, Jobs::inline(), Arc::default(), options);
        Self { feed, app, look: Look::of_screenshot(options.appearance) }
    }

    /// Takes in one step.
    pub fn push_step(&mut self, state: &impl Step) {
        lock(&self.feed).push_step(state, Instant::now());
    }

    /// Takes in a bench status.
    pub fn push_bench_status(&mut self, bench_status: Box<BenchStatus>) {
        lock(&self.feed).push_bench_status(bench_status);
    }

    /// A screenshot of what it shows now.
    #[must_use]
    pub fn screenshot(&mut self, width: u16, height: u16) -> Screenshot {
        self.app.screenshot(Rect::new(0, 0, width, height))
    }

    /// Sends frames to `out` as to a terminal of `width` by `height` cells; what it is shown already is not sent again.
    ///
    /// # Errors
    /// `out` fails.
    pub fn frames<W: Write>(self, out: W, width: u16, height: u16) -> io::Result<Frames<W>> {
        let viewport = Viewport::Fixed(Rect::new(0, 0, width, height));
        let terminal = Terminal::with_options(CrosstermBackend::new(out), TerminalOptions { viewport })?;
        Ok(Frames { headless: self, terminal })
    }
}

/// Frames of a [`Headless`] dashboard on their way to a terminal.
pub struct Frames<W: Write> {
    headless: Headless,
    terminal: Terminal<CrosstermBackend<W>>,
}

impl<W: Write> Frames<W> {
    /// The dashboard, to be fed.
    pub fn headless(&mut self) -> &mut Headless {
        &mut self.headless
    }

    /// Draws and sends one frame.
    ///
    /// # Errors
    /// The terminal fails.
    pub fn draw(&mut self) -> io::Result<()> {
        let Self { headless, terminal } = self;
        let look = headless.look;
        headless.app.watch_alarms();
        terminal::draw_whole(terminal, look, |frame| headless.app.render(frame.area(), frame.buffer_mut()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::AppearanceOptions;
    use crate::layout::built_in;
    use telemetry::test_support as tests;

    fn headless(layout: usize, appearance: AppearanceOptions) -> Headless {
        let mut headless = Headless::new("default", &Options { layout, appearance, ..Options::default() });
        headless.push_bench_status(tests::bench_status("three-mass", "composite"));
        for seq in 0..9000 {
            headless.push_step(&tests::state(3, seq));
        }
        headless
    }

    #[test]
    fn every_glyph_of_every_layout_has_an_ascii_twin() {
        for layout in 0..built_in().len() {
            let Screenshot { text, svg } =
                headless(layout, AppearanceOptions { ascii: true, ..AppearanceOptions::default() }).screenshot(200, 60);
            assert!(text.is_ascii() && text.contains("RUNNING"), "{text}");
            // The only question mark is the key of the help.
            assert_eq!(text.matches('?').count(), 1, "{text}");
            assert!(svg.is_ascii() && svg.contains("RUNNING"));
        }
    }

    #[test]
    fn a_picture_is_what_the_screen_shows() {
        let Screenshot { text, svg } = headless(1, AppearanceOptions::default()).screenshot(120, 40);
        assert!(text.contains("minimum damping") && text.contains("orbits"), "{text}");
        assert_eq!(text.lines().count(), 40);
        assert!(svg.contains("minimum damping") && svg.contains("width=\"976\""), "120 cells of 8, and the edges");
    }

    #[test]
    fn what_is_shown_already_is_not_sent_again() {
        let mut sent = Vec::new();
        let mut frames = headless(0, AppearanceOptions::default()).frames(&mut sent, 200, 60).unwrap();
        frames.draw().unwrap();
        frames.headless().push_step(&tests::state(3, 9000));
        for _ in 0..3 {
            frames.draw().unwrap();
        }
        drop(frames);
        let text = String::from_utf8(sent).unwrap();
        assert_eq!(text.matches("\x1b[?2026h").count(), 4, "each frame is sent as a whole");
        assert_eq!(text.matches("minimum damping").count(), 1);
    }
}
