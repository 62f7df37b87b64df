//! When which steps are due. Arithmetic only: the clock is the caller's.
//!
//! Step `k` is due at `k / rate` on an absolute time line. Above 1000 steps a second several steps share a wake-up, one
//! a millisecond or so, due when the last of them is: this keeps high rates cheap.

use std::time::Duration;

/// Stalls up to this long are caught up; of longer ones the deadlines are given up.
pub const CATCH_UP_LIMIT: Duration = Duration::from_millis(250);

/// The most wake-ups a second.
const WAKE_UPS: f64 = 1000.0;

/// Keeps the schedule.
#[derive(Clone, Debug)]
pub struct Pacer {
    period_ns: f64,
    batch: u32,
    /// The first step of the next wake-up, counted from the start of the schedule.
    next: u64,
    /// By how much the schedule has been moved back.
    shift_ns: u64,
}

/// One wake-up: what is due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wake {
    /// How many steps are due.
    pub steps: u32,
    /// Deadlines given up before this wake-up.
    pub missed: u64,
    /// How long after its deadline it came, before anything was given up.
    pub lateness_ns: u64,
    /// Whether it came more than one wake-up period after its deadline.
    pub is_late: bool,
    first_due_ns: f64,
    period_ns: f64,
}

impl Wake {
    /// One step, just when it is due: where nobody keeps a schedule.
    #[must_use]
    pub(crate) fn single() -> Self {
        Self { steps: 1, missed: 0, lateness_ns: 0, is_late: false, first_due_ns: 0.0, period_ns: 0.0 }
    }

    /// When step `step` of this wake-up was due, on the schedule as it now stands.
    #[must_use]
    pub fn due_ns(&self, step: u32) -> u64 {
        (self.first_due_ns + f64::from(step) * self.period_ns) as u64
    }
}

impl Pacer {
    /// A schedule of `rate_hz` steps a second that starts now.
    #[must_use]
    pub fn new(rate_hz: f64) -> Self {
        Self { period_ns: 1e9 / rate_hz, batch: Self::steps_a_wake_up(rate_hz), next: 0, shift_ns: 0 }
    }

    /// How many steps share a wake-up at `rate_hz` steps a second.
    #[must_use]
    pub fn steps_a_wake_up(rate_hz: f64) -> u32 {
        (rate_hz / WAKE_UPS).ceil() as u32
    }

    /// When the next wake-up is due: when the last of its steps is.
    #[must_use]
    pub fn deadline_ns(&self) -> u64 {
        self.due_ns(self.next + u64::from(self.batch) - 1)
    }

    fn due_ns(&self, step: u64) -> u64 {
        // 2^53 ns are 104 days: until then a double keeps every nanosecond.
        (step as f64 * self.period_ns) as u64 + self.shift_ns
    }

    /// Takes the wake-up that is due at `now_ns`, which is not before [`Pacer::deadline_ns`].
    pub fn wake(&mut self, now_ns: u64) -> Wake {
        let lateness_ns = now_ns.saturating_sub(self.deadline_ns());
        let mut missed = 0;
        if lateness_ns > CATCH_UP_LIMIT.as_nanos() as u64 {
            missed = (lateness_ns as f64 / self.period_ns) as u64;
            self.shift_ns += lateness_ns;
        }
        let wake = Wake {
            steps: self.batch,
            missed,
            lateness_ns,
            is_late: lateness_ns as f64 > self.period_ns * f64::from(self.batch),
            first_due_ns: self.due_ns(self.next) as f64,
            period_ns: self.period_ns,
        };
        self.next += u64::from(self.batch);
        wake
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const MS: u64 = 1_000_000;

    #[test]
    fn on_time_every_step_has_its_own_deadline() {
        let mut pacer = Pacer::new(1000.0);
        for k in 0..5 {
            assert_eq!(pacer.deadline_ns(), k * MS);
            let wake = pacer.wake(k * MS + 100);
            assert_eq!((wake.steps, wake.missed, wake.lateness_ns, wake.is_late), (1, 0, 100, false));
            assert_eq!(wake.due_ns(0), k * MS);
        }
    }

    #[test]
    fn high_rates_share_wake_ups() {
        let mut pacer = Pacer::new(20_000.0);
        assert_eq!(pacer.deadline_ns(), 19 * 50_000);
        let wake = pacer.wake(19 * 50_000);
        assert_eq!((wake.steps, wake.due_ns(0), wake.due_ns(19)), (20, 0, 950_000));
        assert_eq!(pacer.deadline_ns(), 39 * 50_000);
    }

    #[test]
    fn a_short_stall_is_caught_up_and_counted_late() {
        let mut pacer = Pacer::new(1000.0);
        pacer.wake(0);
        let now = 101 * MS;
        let mut late = 0;
        while pacer.deadline_ns() <= now {
            let wake = pacer.wake(now);
            assert_eq!(wake.missed, 0);
            late += u32::from(wake.is_late);
        }
        // 101 deadlines had passed; the last two of them by no more than a period.
        assert_eq!((pacer.deadline_ns(), late), (102 * MS, 99));
    }

    #[test]
    fn a_long_stall_is_given_up_and_counted_missed() {
        let mut pacer = Pacer::new(1000.0);
        pacer.wake(0);
        let wake = pacer.wake(5001 * MS);
        assert_eq!((wake.missed, wake.is_late), (5000, true));
        assert_eq!(pacer.deadline_ns(), 5002 * MS);
        assert!(!pacer.wake(5002 * MS).is_late);
    }

    proptest! {
        /// Whatever the stalls, steps taken and deadlines missed add up to the time that has passed.
        #[test]
        fn steps_and_misses_account_for_all_time(rate in 10.0..50_000.0_f64, stalls in prop::collection::vec(0u64..2_000_000_000, 1..40)) {
            let mut pacer = Pacer::new(rate);
            let (mut now, mut steps, mut missed) = (0, 0, 0);
            for stall in stalls {
                now = now.max(pacer.deadline_ns()) + stall;
                while pacer.deadline_ns() <= now {
                    let wake = pacer.wake(now);
                    steps += u64::from(wake.steps);
                    missed += wake.missed;
                }
            }
            let elapsed = (now as f64 * rate / 1e9) as u64;
            let accounted = steps + missed;
            // Up to one wake-up of steps is not yet due; each give-up rounds down by less than one step.
            prop_assert!(accounted <= elapsed + 2, "{accounted} of {elapsed}");
            prop_assert!(accounted + 60 + u64::from(pacer.batch) * 2 >= elapsed, "{accounted} of {elapsed}");
        }
    }
}
