//! The monotonic clock, slept on by absolute deadline.

use std::time::Instant;

use rustix::time::ClockId;

/// Longest single sleep: how soon an idle simulation notices that it shall stop.
const LONGEST_SLEEP_NS: u64 = 50_000_000;

/// Nanoseconds since it was started.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Monotonic {
    start: Instant,
    /// The start on the kernel's clock.
    #[cfg(target_os = "linux")]
    kernel_start_ns: u64,
}

impl Monotonic {
    pub(crate) fn start() -> Self {
        Self {
            start: Instant::now(),
            #[cfg(target_os = "linux")]
            kernel_start_ns: {
                let now = rustix::time::clock_gettime(ClockId::Monotonic);
                now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
            },
        }
    }

    pub(crate) fn now_ns(&self) -> u64 {
        self.start.elapsed().as_nanos() as u64
    }

    /// Sleeps until `deadline_ns`, or a little while if that is far off. Returns whether the deadline has come.
    pub(crate) fn sleep_until(&self, deadline_ns: u64) -> bool {
        let now = self.now_ns();
        if now >= deadline_ns {
            return true;
        }
        let until = deadline_ns.min(now + LONGEST_SLEEP_NS);
        self.sleep(until);
        self.now_ns() >= deadline_ns
    }

    #[cfg(target_os = "linux")]
    fn sleep(&self, until_ns: u64) {
        let at = self.kernel_start_ns + until_ns;
        let request =
            rustix::time::Timespec { tv_sec: (at / 1_000_000_000) as i64, tv_nsec: (at % 1_000_000_000) as i64 };
        // A signal ends the sleep early: the caller looks again.
        let _ = rustix::thread::clock_nanosleep_absolute(ClockId::Monotonic, &request);
    }

    #[cfg(not(target_os = "linux"))]
    fn sleep(&self, until_ns: u64) {
        std::thread::sleep(std::time::Duration::from_nanos(until_ns.saturating_sub(self.now_ns())));
    }
}

/// Asks the kernel not to gather this thread's wake-ups with others': 50 us of slack is the default on Linux.
pub(crate) fn precise_sleep() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::thread::set_current_timer_slack(std::num::NonZeroU64::new(1)) {
        tracing::debug!(%error, "timer slack stays at its default");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn never_claims_a_deadline_before_it_has_come() {
        let clock = Monotonic::start();
        let deadline = clock.now_ns() + 3_000_000;
        while !clock.sleep_until(deadline) {}
        assert!(clock.now_ns() >= deadline);
        assert!(!clock.sleep_until(clock.now_ns() + 3_600_000_000_000), "an hour is not slept in one piece");
    }
}
