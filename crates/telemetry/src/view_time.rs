//! Which moment is looked at: the newest, or one of the past under a cursor, and how much around it.
//!
//! ```text
//!            span
//!       ┌──────────────┐
//!  ─────┼───────┃──────┼─────────────▶  places of steps
//!     start   cursor  end        newest      while live, cursor and end are the newest
//! ```
//!
//! Pure: it knows places and seconds, not data.

use std::ops::Range;

/// Seconds in view when nobody has said otherwise.
const SPAN: f64 = 4.0;
/// The shortest and the longest span, in seconds.
pub const SPANS: [f64; 2] = [0.02, 3600.0];
/// Seconds a step where nothing is known: the default rate.
const NOMINAL: f64 = 1e-3;

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewTime {
    span: f64,
    past: Option<Past>,
}

/// A moment of the past, by places of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Past {
    cursor: u64,
    /// The place after the last in view.
    end: u64,
}

/// What that means for the steps that are kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Resolved {
    /// The steps in view.
    pub window: Range<u64>,
    /// The step under the cursor, if there is any.
    pub now: Option<u64>,
}

impl Default for ViewTime {
    fn default() -> Self {
        Self::LIVE
    }
}

impl ViewTime {
    /// The newest step, and what led to it.
    pub const LIVE: Self = Self { span: SPAN, past: None };

    /// Whether the newest step is looked at.
    pub fn is_live(&self) -> bool {
        self.past.is_none()
    }

    /// How many steps are in view, `seconds` apart.
    pub fn steps(&self, seconds: f64) -> u64 {
        Self::steps_of(self.span, seconds)
    }

    /// How many steps, `seconds` apart, `span` seconds are; at least two.
    pub fn steps_of(span: f64, seconds: f64) -> u64 {
        let seconds = if seconds > 0.0 { seconds } else { NOMINAL };
        (span / seconds).ceil().clamp(2.0, 1e9) as u64
    }

    /// Lets the view stand where it is while data go on.
    pub fn pause(&mut self, kept: &Range<u64>) {
        if self.is_live() && kept.start < kept.end {
            self.past = Some(Past { cursor: kept.end - 1, end: kept.end });
        }
    }

    /// Back to the newest step.
    pub fn resume(&mut self) {
        self.past = None;
    }

    /// Moves the cursor by so many steps; the window follows where it would leave it. The view then stands.
    pub fn step(&mut self, by: i64, kept: &Range<u64>, seconds: f64) {
        self.pause(kept);
        if let Some(past) = self.past {
            self.look_at(past.cursor.saturating_add_signed(by), kept, seconds);
        }
    }

    /// Moves the cursor by so many seconds of steps.
    pub fn seek(&mut self, by: f64, kept: &Range<u64>, seconds: f64) {
        let seconds = if seconds > 0.0 { seconds } else { NOMINAL };
        self.step((by / seconds).round().clamp(-1e15, 1e15) as i64, kept, seconds);
    }

    /// Puts the cursor on a step; the window follows where it would leave it. The view then stands.
    pub fn look_at(&mut self, place: u64, kept: &Range<u64>, seconds: f64) {
        self.pause(kept);
        let Some(past) = &mut self.past else { return };
        past.cursor = place.clamp(kept.start, kept.end.saturating_sub(1).max(kept.start));
        let shown = Self::steps_of(self.span, seconds);
        if past.cursor >= past.end {
            past.end = past.cursor + 1;
        } else if past.cursor + shown < past.end {
            past.end = past.cursor + shown;
        }
    }

    /// Puts the cursor on a step that is kept, at the end of the window.
    pub fn jump_to(&mut self, place: u64) {
        self.past = Some(Past { cursor: place, end: place + 1 });
    }

    /// Shows `factor` times as much; in the past the cursor stays where it is on the screen.
    pub fn zoom(&mut self, factor: f64, seconds: f64) {
        let before = self.steps(seconds) as f64;
        self.span = (self.span * factor).clamp(SPANS[0], SPANS[1]);
        let after = self.steps(seconds) as f64;
        if let Some(past) = &mut self.past {
            let right = past.end.saturating_sub(past.cursor) as f64;
            past.end = past.cursor + ((right * after / before).round() as u64).max(1);
        }
    }

    /// Shows so many seconds.
    pub fn set_span(&mut self, span: f64, seconds: f64) {
        self.zoom(span / self.span, seconds);
    }

    /// The span of the start.
    pub fn reset_span(&mut self, seconds: f64) {
        self.set_span(SPAN, seconds);
    }

    /// What is in view of the steps `kept`: a moment that has been let go of is the oldest that is left.
    pub fn resolve(&self, kept: &Range<u64>, seconds: f64) -> Resolved {
        let last = kept.end.checked_sub(1).filter(|last| *last >= kept.start);
        let Some(last) = last else { return Resolved { window: kept.clone(), now: None } };
        let (cursor, end) = match self.past {
            None => (last, kept.end),
            Some(past) => (past.cursor.clamp(kept.start, last), past.end),
        };
        // A window that begins before the first step shows what there is from there on.
        let shown = self.steps(seconds);
        let end = end.clamp(cursor + 1, kept.end).max((kept.start + shown).min(kept.end));
        Resolved { window: end.saturating_sub(shown).max(kept.start)..end, now: Some(cursor) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEPT: Range<u64> = 1000..11_000;
    const SECONDS: f64 = 1e-3;

    fn resolved(view: &ViewTime, kept: Range<u64>) -> (Range<u64>, Option<u64>) {
        let Resolved { window, now } = view.resolve(&kept, SECONDS);
        (window, now)
    }

    #[test]
    fn live_shows_the_newest_and_pause_stands_while_data_go_on() {
        let mut view = ViewTime::default();
        assert_eq!(resolved(&view, KEPT), (7000..11_000, Some(10_999)));
        assert_eq!(resolved(&view, 1000..12_000).1, Some(11_999));
        view.pause(&KEPT);
        assert!(!view.is_live());
        assert_eq!(resolved(&view, 1000..90_000), (7000..11_000, Some(10_999)));
        view.resume();
        assert_eq!(resolved(&view, 1000..90_000).1, Some(89_999));
    }

    #[test]
    fn the_window_follows_the_cursor_and_the_cursor_stays_within_what_is_kept() {
        let mut view = ViewTime::default();
        view.seek(-1.0, &KEPT, SECONDS);
        assert_eq!(resolved(&view, KEPT), (7000..11_000, Some(9999)), "still in the window");
        view.seek(-4.0, &KEPT, SECONDS);
        assert_eq!(resolved(&view, KEPT), (5999..9999, Some(5999)));
        view.seek(-1e9, &KEPT, SECONDS);
        assert_eq!(resolved(&view, KEPT), (1000..5000, Some(1000)));
        view.seek(1e300, &KEPT, SECONDS);
        assert_eq!(resolved(&view, KEPT), (7000..11_000, Some(10_999)));
        view.step(-3, &KEPT, SECONDS);
        assert_eq!(resolved(&view, KEPT).1, Some(10_996));
    }

    #[test]
    fn what_has_been_let_go_of_gives_way_to_the_oldest_that_is_left() {
        let mut view = ViewTime::default();
        view.look_at(2000, &KEPT, SECONDS);
        assert_eq!(resolved(&view, 50_000..60_000), (50_000..54_000, Some(50_000)));
        assert_eq!(resolved(&view, 0..0), (0..0, None));
        assert_eq!(resolved(&view, 7..8), (7..8, Some(7)));
    }

    #[test]
    fn zooming_keeps_the_cursor_where_it_is_on_the_screen() {
        let mut view = ViewTime::default();
        view.look_at(9000, &KEPT, SECONDS);
        view.zoom(0.5, SECONDS);
        // Half way in the window before and after.
        assert_eq!(resolved(&view, KEPT), (8000..10_000, Some(9000)));
        for _ in 0..100 {
            view.zoom(2.0, SECONDS);
        }
        assert_eq!(resolved(&view, KEPT), (KEPT, Some(9000)));
        view.reset_span(SECONDS);
        assert_eq!(view.span, SPAN);
    }

    #[test]
    fn nothing_kept_is_nothing_shown() {
        let mut view = ViewTime::default();
        view.pause(&(0..0));
        view.seek(-3.0, &(5..5), 0.0);
        view.zoom(0.1, 0.0);
        assert!(view.is_live());
        assert_eq!(view.resolve(&(5..5), 0.0), Resolved { window: 5..5, now: None });
    }
}
