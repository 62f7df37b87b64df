//! What a run-up shows while it goes on: the first order of one mass over speed, turn by turn, upward and downward apart.
//!
//! All steps that are kept are read anew for every answer, some milliseconds for ten minutes of them: so it is the same for a bench, a pause
//! and a recording.

use rotor::C64;
use spectrum::{OrderSample, OrderTracker, PER_TURN};

use crate::history::Track;

/// Steps between two looks, as parts of a turn: the tracker reads between them on a cubic.
const LOOKS_PER_TURN: f64 = 24.0;
/// The most steps from one look to the next.
const STRIDE: usize = 256;
/// How far the time over some steps may be from so many times that of one, as a share of it: beyond, steps are missing.
const EVEN: f64 = 0.01;
/// A speed that changes by so much between two looks was set at once: no run.
const JUMP: f64 = 0.25;
/// A speed that changes by less over a turn, as a share of it, rests.
const RESTS: f64 = 1e-6;

/// What is asked: everything that the answer depends on.
#[derive(Clone, Debug)]
pub struct RunUpRequest {
    kept: Track,
    mass: usize,
    /// Place in the history after the last step.
    end: u64,
}

impl PartialEq for RunUpRequest {
    /// Places are never used twice: the same places hold the same steps.
    fn eq(&self, other: &Self) -> bool {
        let key = |request: &Self| (request.mass, request.end, request.kept.masses());
        key(self) == key(other)
    }
}

impl RunUpRequest {
    /// The runs of `mass` among the steps `kept`, which are `seconds` apart. The end moves on in strides, four a second, so that it
    /// is not asked anew for every frame.
    pub fn of(kept: &Track, mass: usize, seconds: f64) -> Self {
        let stride = if seconds > 0.0 { (0.25 / seconds).clamp(1.0, 1e6) as u64 } else { 1 };
        let after = kept.index_of(0) + kept.len() as u64;
        let end = after / stride * stride;
        Self { kept: kept.clone(), mass, end: if end <= kept.index_of(0) { after } else { end } }
    }
}

/// One turn of the spin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedTurn {
    /// Place in the history of the step that ends it.
    pub place: u64,
    /// Its mean speed, in units of `w0`.
    pub speed: f64,
    /// First order: amplitude in `e_t`, and phase against the angle of the spin.
    pub first_order: C64,
}

/// Turns over which the speed changes one way.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedLeg {
    /// Whether the speed rises.
    pub is_upward: bool,
    /// The turns, in order of time.
    pub turns: Vec<TrackedTurn>,
}

/// What the steps since the last start from rest show.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpeedLegs {
    /// The legs, in order of time.
    pub legs: Vec<SpeedLeg>,
}

impl SpeedLegs {
    /// Computes the answer.
    pub fn of(request: &RunUpRequest) -> Self {
        let RunUpRequest { kept, mass, end } = request;
        let len = usize::try_from(end.saturating_sub(kept.index_of(0))).unwrap_or(usize::MAX).min(kept.len());
        let mut book = Book::default();
        if len < 2 || *mass >= kept.masses() {
            return Self::default();
        }
        let mut tracker = OrderTracker::new(1);
        let (mut at, mut before) = (0, None::<usize>);
        while at < len {
            let (tau, speed) = (kept.tau(at), kept.speed(at));
            if let Some(before) = before {
                let last = kept.tau(before);
                let each = kept.tau(before + 1) - last;
                let is_whole = ((tau - last) - each * (at - before) as f64).abs() <= EVEN * each;
                let jumps = (speed - kept.speed(before)).abs() > JUMP;
                if tau < last {
                    book = Book::default();
                }
                if !is_whole || jumps {
                    tracker = OrderTracker::new(1);
                    book.breaks = true;
                }
            }
            let [[y, z], [vy, vz]] = [kept.displacement(at, *mass), kept.velocity(at, *mass)];
            let place = kept.index_of(at);
            let sample = OrderSample {
                tau,
                angle: kept.angle(at),
                speed,
                displacement: &[C64::new(y, z)],
                velocity: &[C64::new(vy, vz)],
                // Nobody asks for it here.
                force: 0.0,
            };
            tracker.see(&sample, |tracker| {
                book.readings += 1;
                if book.readings.is_multiple_of(PER_TURN)
                    && let Some(turn) = tracker.turn()
                {
                    book.push(TrackedTurn { place, speed: turn.speed, first_order: turn.first_order[0] });
                }
            });
            before = Some(at);
            // Both ends of a stretch of time tell whether steps are missing in it, the next step how long one is.
            let each = if at + 1 < len { kept.tau(at + 1) - tau } else { 0.0 };
            let turned = speed.abs() * each;
            let stride = if turned > 0.0 { std::f64::consts::TAU / LOOKS_PER_TURN / turned } else { STRIDE as f64 };
            at += (stride as usize).clamp(1, STRIDE);
        }
        Self { legs: book.legs }
    }

    /// All turns.
    pub fn turns(&self) -> impl Iterator<Item = &TrackedTurn> {
        self.legs.iter().flat_map(|leg| &leg.turns)
    }

    /// The turn that was under way at a place in the history: the nearest.
    #[must_use]
    pub fn at(&self, place: u64) -> Option<&TrackedTurn> {
        self.turns().min_by_key(|turn| turn.place.abs_diff(place))
    }

    /// The turn with the largest first order.
    #[must_use]
    pub fn highest(&self) -> Option<&TrackedTurn> {
        self.turns().max_by(|a, b| a.first_order.norm_sqr().total_cmp(&b.first_order.norm_sqr()))
    }
}

/// Keeps legs apart.
#[derive(Debug, Default)]
struct Book {
    legs: Vec<SpeedLeg>,
    last: Option<TrackedTurn>,
    readings: usize,
    /// The next turn does not go on where the last one was.
    breaks: bool,
}

impl Book {
    fn push(&mut self, turn: TrackedTurn) {
        if std::mem::take(&mut self.breaks) {
            self.last = None;
            self.legs.push(SpeedLeg { is_upward: true, turns: Vec::new() });
        }
        let Some(last) = self.last else {
            self.last = Some(turn);
            return;
        };
        let change = turn.speed - last.speed;
        if change.abs() <= RESTS * last.speed.abs() {
            return;
        }
        self.last = Some(turn);
        let is_upward = change > 0.0;
        match self.legs.last_mut() {
            Some(leg) if leg.is_upward == is_upward && !leg.turns.is_empty() => leg.turns.push(turn),
            Some(leg) if leg.turns.is_empty() => *leg = SpeedLeg { is_upward, turns: vec![last, turn] },
            _ => self.legs.push(SpeedLeg { is_upward, turns: vec![last, turn] }),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use wire::{Channel, Point};

    use super::*;
    use crate::feed::Feed;
    use crate::test_support as tests;
    use crate::view_time::ViewTime;

    /// A one-mass circle of 0.5 e_t, 40 degrees behind the spin, up from R = 1 to 3 and down again, with a whirl at 0.4 of the speed that is no part
    /// of it.
    fn kept(lost: Option<u64>) -> Track {
        let now = Instant::now();
        let mut feed = Feed::new("");
        let mut angle = 0.0;
        for seq in 0..40_000_u64 {
            let tau = seq as f64 * 0.01;
            let speed = if tau < 200.0 { 1.0 + tau / 100.0 } else { 5.0 - tau / 100.0 };
            let q = C64::from_polar(0.5, angle - 40_f64.to_radians());
            let v = q * C64::new(0.0, speed);
            let state = tests::state(1, seq).with(Channel::Speed, 0, speed).with(Channel::Angle, 0, angle);
            angle += (speed + 0.5 * 0.01 / 100.0 * if tau < 200.0 { 1.0 } else { -1.0 }) * 0.01;
            if lost.is_some_and(|lost| (lost..lost + 500).contains(&seq)) {
                continue;
            }
            feed.push_step(&state.with_point(0, Point { y: q.re, z: q.im, vy: v.re, vz: v.im }), now);
        }
        feed.frame_data(&ViewTime::LIVE, now).kept
    }

    #[test]
    fn val_a_circle_in_step_is_read_over_speed_up_and_down() {
        for lost in [None, Some(7000)] {
            let kept = kept(lost);
            assert!(kept.tau(kept.len() - 1) > 399.0);
            let found = SpeedLegs::of(&RunUpRequest::of(&kept, 0, 1e-3));
            let upward: Vec<bool> = found.legs.iter().map(|leg| leg.is_upward).collect();
            assert_eq!(upward.first(), Some(&true), "{lost:?}");
            assert_eq!((upward.last(), upward.len()), (Some(&false), if lost.is_some() { 3 } else { 2 }), "{lost:?}");
            for turn in found.turns() {
                let expected = C64::from_polar(0.5, -40_f64.to_radians());
                assert!((turn.first_order - expected).norm() < 1e-4, "{turn:?}");
            }
            let [low, high] =
                found.turns().fold([9.0_f64, 0.0_f64], |[low, high], t| [low.min(t.speed), high.max(t.speed)]);
            assert!(low < 1.1 && high > 2.95, "{low} {high}");
            let there = found.at(kept.index_of(10_000)).unwrap();
            assert!((there.speed - kept.speed(10_000)).abs() < 0.05, "{there:?}");
        }
    }

    #[test]
    fn a_steady_speed_is_no_run() {
        let data = tests::frame_data();
        assert_eq!(SpeedLegs::of(&RunUpRequest::of(&data.kept, 0, 1e-3)), SpeedLegs::default());
        let none = Feed::new("").frame_data(&ViewTime::LIVE, Instant::now());
        assert!(SpeedLegs::of(&RunUpRequest::of(&none.kept, 0, 1e-3)).highest().is_none());
    }
}
