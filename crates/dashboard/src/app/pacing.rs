//! When a frame is drawn: at most 30 times a second (or as often as is asked for) for what comes in by itself, and at most 60 times a
//! second for what a person does. Neither a fast simulation nor a mouse that is dragged draws more than can be seen.
//!
//! A line that is slow is told by the time for which the terminal takes nothing more. Where a frame was waited for, the next one that
//! nobody asked for comes no sooner than three times that later: the line is free for most of the time, what waits in it is soon gone, and a key
//! is answered after one frame and not after all that were sent before. A frame that went at once makes the next one come a little sooner.

use std::time::{Duration, Instant};

/// So many times as long as a frame was waited for, the line is free after it.
const FREE: u32 = 3;
/// What is left of a wait in mind after every frame that went at once: it is forgotten within some hundred frames.
const FORGOTTEN: f64 = 0.98;
/// A longer wait than this was no slow line but one that had stopped: it says nothing of the next frame.
const LONGEST: Duration = Duration::from_millis(250);
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
#[derive(Debug)]
pub(super) struct Pacing {
    /// Time between two frames while everything moves.
    frame: Duration,
    /// How long the line takes for a frame, as far as it was noticed.
    line: Duration,
    /// When, and what had been taken in by then.
    drawn: Option<(Instant, u64)>,
    /// Something other than the feed has changed since.
    asked: bool,
}

impl Pacing {
    /// At most so many frames a second for what comes in by itself.
    pub(super) fn new(fps: u32) -> Self {
        let frame = Duration::from_secs(1) / fps.max(1);
        Self { frame, line: Duration::ZERO, drawn: None, asked: false }
    }

    /// Time between two frames that nobody asks for.
    fn interval(&self) -> Duration {
        self.frame.max(self.line * (FREE + 1))
    }

    /// The same after a key.
    fn shortest(&self) -> Duration {
        SHORTEST.max(self.line)
    }

    /// Something other than the feed has changed: a frame shall be drawn.
    pub(super) fn ask(&mut self) {
        self.asked = true;
    }

    /// A frame of the feed's `changes` has been drawn; the terminal took so long to take it.
    pub(super) fn drawn(&mut self, changes: u64, now: Instant, taken: Duration) {
        let line = taken.min(LONGEST).max(self.line.mul_f64(FORGOTTEN));
        *self = Self { drawn: Some((now, changes)), asked: false, line, ..*self };
    }

    /// Whether a frame is to be drawn now: it would show something new, and the last one has been seen.
    pub(super) fn is_due(&self, feed: FeedState, now: Instant) -> bool {
        let Some((at, changes)) = self.drawn else { return true };
        let age = now.saturating_duration_since(at);
        if self.asked && age >= self.shortest() {
            return true;
        }
        // The clock of a frame may be a little early.
        feed.is_live
            && ((feed.changes != changes && age >= self.interval().mul_f64(0.9))
                || (feed.has_steps && age >= SILENT_FRAME.max(self.interval())))
    }

    /// How long to wait at most for something to happen, before time alone is looked at again.
    pub(super) fn patience(&self, is_moving: bool, now: Instant) -> Duration {
        match self.drawn {
            Some((at, _)) if self.asked => self.shortest().saturating_sub(now.saturating_duration_since(at)),
            _ if is_moving => self.frame,
            _ => PAUSED_FRAME,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many frames are drawn in a second in which something happens every `every`: the feed changes, or a key is pressed.
    fn frames_in_a_second(every: Duration, is_key: bool) -> usize {
        frames(Pacing::new(30), every, is_key, Duration::ZERO)
    }

    /// The same of a pacing, where the terminal takes so long for every frame.
    fn frames(mut pacing: Pacing, every: Duration, is_key: bool, taken: Duration) -> usize {
        let start = Instant::now();
        let mut feed = FeedState { changes: 0, has_steps: true, is_live: true };
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
                now += taken;
                pacing.drawn(feed.changes, now, taken);
            }
            now = now.max(next.min(now + pacing.patience(true, now).max(Duration::from_micros(1))));
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
    fn as_many_frames_as_are_asked_for() {
        let every = Duration::from_millis(1);
        for (fps, frames_seen) in [(1, 1..=2), (5, 5..=6), (10, 10..=12), (60, 52..=67)] {
            let seen = frames(Pacing::new(fps), every, false, Duration::ZERO);
            assert!(frames_seen.contains(&seen), "{fps}: {seen}");
        }
    }

    #[test]
    fn a_slow_line_is_free_for_most_of_the_time_and_a_key_waits_for_one_frame() {
        let (every, taken) = (Duration::from_millis(1), Duration::from_millis(50));
        let (steps, keys) = (frames(Pacing::new(30), every, false, taken), frames(Pacing::new(30), every, true, taken));
        assert!((4..=6).contains(&steps) && (9..=21).contains(&keys), "{steps}, {keys}");
        // One that had stopped altogether is not waited for again.
        let mut stopped = Pacing::new(30);
        stopped.drawn(0, Instant::now(), Duration::from_secs(20));
        assert!(stopped.interval() <= Duration::from_secs(1) && stopped.shortest() <= LONGEST, "{stopped:?}");
        // And when it is fast again, as many as before.
        let (mut pacing, now) = (Pacing::new(30), Instant::now());
        pacing.drawn(0, now, taken);
        (0..300).for_each(|_| pacing.drawn(0, now, Duration::ZERO));
        assert_eq!(pacing.interval(), Pacing::new(30).interval());
    }

    #[test]
    fn a_key_is_answered_at_once_and_the_last_of_many_is_not_forgotten() {
        let now = Instant::now();
        let feed = FeedState { changes: 0, has_steps: false, is_live: false };
        let mut pacing = Pacing::new(30);
        assert!(pacing.is_due(feed, now));
        pacing.drawn(0, now, Duration::ZERO);
        assert!(!pacing.is_due(feed, now + Duration::from_secs(9)), "nothing has changed");
        pacing.ask();
        let soon = now + Duration::from_millis(5);
        assert!(!pacing.is_due(feed, soon));
        assert!(pacing.is_due(feed, soon + pacing.patience(false, soon)), "nothing else needs to happen");
    }
}
