//! When a frame is drawn: at most 30 times a second for what comes in by itself, and at most 60 times a second for what a
//! person does. Neither a fast simulation nor a mouse that is dragged draws more than can be seen.

use std::time::{Duration, Instant};

/// Time between two frames while everything moves: 30 a second.
const FRAME: Duration = Duration::from_millis(33);
/// Time between two frames at least, whatever asks for one: 60 a second.
const SHORTEST: Duration = Duration::from_millis(16);
/// Time between two looks while the view is paused.
const PAUSED_FRAME: Duration = Duration::from_millis(250);
/// How often the age of silent data is drawn anew.
const SILENT_FRAME: Duration = Duration::from_millis(200);

/// What a frame would be drawn from.
#[derive(Clone, Copy, Debug)]
pub(super) struct FeedState {
    /// The count of what has been taken in.
    pub(super) changes: u64,
    /// Whether any step has come.
    pub(super) has_steps: bool,
    /// Whether the newest step is looked at.
    pub(super) is_live: bool,
}

/// When the last frame was drawn, and whether another one is asked for.
#[derive(Debug, Default)]
pub(super) struct Pacing {
    /// When, and what had been taken in by then.
    drawn: Option<(Instant, u64)>,
    /// Something other than the feed has changed since.
    asked: bool,
}

impl Pacing {
    /// Something other than the feed has changed: a frame shall be drawn.
    pub(super) fn ask(&mut self) {
        self.asked = true;
    }

    /// A frame of the feed's `changes` has been drawn.
    pub(super) fn drawn(&mut self, changes: u64, now: Instant) {
        *self = Self { drawn: Some((now, changes)), asked: false };
    }

    /// Whether a frame is to be drawn now: it would show something new, and the last one has been seen.
    pub(super) fn is_due(&self, feed: FeedState, now: Instant) -> bool {
        let Some((at, changes)) = self.drawn else { return true };
        let age = now.saturating_duration_since(at);
        if self.asked && age >= SHORTEST {
            return true;
        }
        // The clock of a frame may be a little early.
        feed.is_live
            && ((feed.changes != changes && age >= FRAME.mul_f64(0.9)) || (feed.has_steps && age >= SILENT_FRAME))
    }

    /// How long to wait at most for something to happen, before time alone is looked at again.
    pub(super) fn patience(&self, is_moving: bool, now: Instant) -> Duration {
        match self.drawn {
            Some((at, _)) if self.asked => SHORTEST.saturating_sub(now.saturating_duration_since(at)),
            _ if is_moving => FRAME,
            _ => PAUSED_FRAME,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many frames are drawn in a second in which something happens every `every`: the feed changes, or a key is pressed.
    fn frames_in_a_second(every: Duration, is_key: bool) -> usize {
        let start = Instant::now();
        let (mut pacing, mut feed) = (Pacing::default(), FeedState { changes: 0, has_steps: true, is_live: true });
        let (mut now, mut next, mut frames) = (start, start, 0);
        while now < start + Duration::from_secs(1) {
            if now >= next {
                next += every;
                if is_key {
                    pacing.ask();
                } else {
                    feed.changes += 1;
                }
            }
            if pacing.is_due(feed, now) {
                frames += 1;
                pacing.drawn(feed.changes, now);
            }
            now = next.min(now + pacing.patience(true, now).max(Duration::from_micros(1)));
        }
        frames
    }

    #[test]
    fn neither_steps_nor_keys_nor_the_mouse_draw_more_than_can_be_seen() {
        for every in [50, 100, 1000, 5000].map(Duration::from_micros) {
            let (steps, keys) = (frames_in_a_second(every, false), frames_in_a_second(every, true));
            assert!((25..=34).contains(&steps) && (50..=63).contains(&keys), "{every:?}: {steps}, {keys}");
        }
    }

    #[test]
    fn a_key_is_answered_at_once_and_the_last_of_many_is_not_forgotten() {
        let now = Instant::now();
        let feed = FeedState { changes: 0, has_steps: false, is_live: false };
        let mut pacing = Pacing::default();
        assert!(pacing.is_due(feed, now));
        pacing.drawn(0, now);
        assert!(!pacing.is_due(feed, now + Duration::from_secs(9)), "nothing has changed");
        pacing.ask();
        let soon = now + Duration::from_millis(5);
        assert!(!pacing.is_due(feed, soon));
        assert!(pacing.is_due(feed, soon + pacing.patience(false, soon)), "nothing else needs to happen");
    }
}
