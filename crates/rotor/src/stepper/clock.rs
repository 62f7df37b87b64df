//! Time and angle of a steady spin, and the unbalance's direction at every half step.

use crate::C64;

/// Steps between two evaluations of the sine and cosine of the spin angle; in between the unbalance is turned by a
/// constant factor, which costs a fifth and is off by less than 1e-14 at the end.
pub(crate) const TURNS_BETWEEN: u64 = 32;

/// Point on a line in time: value `at` at step count zero, and a rate per unit of `tau`.
///
/// Time and angle are computed from the number of steps since the last change of step or speed rather than summed, so
/// that a day's run ends on the same grid as a minute's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    tau: f64,
    angle: f64,
    pub(super) speed: f64,
    pub(super) dtau: f64,
    steps: u64,
    /// `exp(j angle)` now, but for rounding; evaluated anew where `steps` is a multiple of [`TURNS_BETWEEN`].
    phasor: C64,
    /// `exp(j speed dtau / 2)`.
    half_turn: C64,
}

impl Clock {
    pub(super) fn tau(&self) -> f64 {
        self.tau + self.steps as f64 * self.dtau
    }

    pub(super) fn angle(&self) -> f64 {
        self.angle + self.speed * (self.steps as f64 * self.dtau)
    }

    pub(super) fn at_rest(speed: f64) -> Self {
        Self { tau: 0.0, angle: 0.0, speed, dtau: 0.0, steps: 0, phasor: C64::ONE, half_turn: C64::ONE }
    }

    /// The same at `tau = 0` and angle 0.
    pub(super) fn restarted(self) -> Self {
        Self { tau: 0.0, angle: 0.0, steps: 0, ..self }
    }

    pub(super) fn rebase(&mut self, speed: f64, dtau: f64) {
        if speed != self.speed || dtau != self.dtau {
            let half_turn = C64::cis(speed * (0.5 * dtau));
            *self =
                Self { tau: self.tau(), angle: self.angle(), speed, dtau, steps: 0, half_turn, phasor: self.phasor };
        }
    }

    /// The clock that this one is after `steps` steps of `dtau` from `tau` and `angle`.
    pub(super) fn after(self, tau: f64, angle: f64, steps: u64, dtau: f64) -> Self {
        let half_turn = C64::cis(self.speed * (0.5 * dtau));
        // From the last step at which the unbalance was put on its angle, and then turned as often as it was.
        let since = steps % TURNS_BETWEEN;
        let mut clock = Self { tau, angle, dtau, steps: steps - since, half_turn, ..self };
        (0..since).for_each(|_| {
            clock.advance();
        });
        clock
    }

    /// `exp(j angle)` at the beginning, the middle and the end of the next step, which is then taken.
    #[inline]
    pub(super) fn advance(&mut self) -> [C64; 3] {
        if self.steps.is_multiple_of(TURNS_BETWEEN) {
            self.phasor = C64::cis(self.angle());
        }
        let middle = self.phasor * self.half_turn;
        let end = middle * self.half_turn;
        let start = std::mem::replace(&mut self.phasor, end);
        self.steps += 1;
        [start, middle, end]
    }
}
