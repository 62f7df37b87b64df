//! Which steps follow a rotor: one place that the live bench, its settings, what-if and every offline run ask.
//!
//! Classical Runge-Kutta with the step `h` puts a pole `lambda` off by about `x^4 / 120` of its size, `x = |lambda| h`.
//! What of that shows depends on the mode's damping ratio `zeta`: a resonance answers to it `1 / (2 zeta)` times over, and
//! a transient is off by about `1 / (e zeta)` times as much before it has died. So every mode may turn by
//!
//! ```text
//! x = (120 T zeta)^(1/4)   held within 0.05 and 0.148,   T = 4e-6
//! ```
//!
//! a step, and the spin, which carries the unbalance, by 0.148. The modes are those with every support bearing at its
//! full stiffness and with none of them: the deadband moves between the two. Those that an unstable rotor has, or gets
//! between the two, come under 0.05, where a pole is off by 5e-8 of its size.
//!
//! Measured against the exact response (`tests/val_step.rs`: 60 000 random rotors of one to six masses with damping ratios of
//! 1e-3 and more, bearing stiffness anywhere between none and all): with the longest step allowed, radii and force are off by
//! less than [`PROMISE`] of their size in all of them; where large terms cancel, in a force or beside a node of the motion,
//! their size is a twentieth of the largest orbit. `T` is a 25th of the promise for what is between the two stiffnesses and for
//! modes that add up. On a resonance damped less than 2e-4 it can be a third more. What no step can promise is the phase of a free motion
//! that hardly dies, after many turns of it.

use std::fmt;

use crate::{C64, ClosedLoop, PoleError, eigenvalues};

/// No shown number is off by more than this of its size for want of steps.
pub const PROMISE: f64 = 1e-4;
/// `T`: what a mode by itself may be off by.
const TOLERANCE: f64 = PROMISE / 25.0;
/// The least that is asked of `|lambda| h`: how far a mode without damping may turn a step.
const SLOWEST: f64 = 0.05;
/// The most that is allowed: `(120 T)^(1/4)`.
const FASTEST: f64 = 0.148;
/// Angle a step of the default step: 126 steps a turn, a relative error of 5e-8 a radian.
const DEFAULT_ANGLE: f64 = 0.05;
/// The default step is never longer.
const LONGEST_DEFAULT: f64 = 0.05;

/// What a Runge-Kutta step costs at most, nanoseconds: this, and [`MASS_NS`] a mass.
///
/// A stated bound instead of one measured at the start: what is refused must not depend on what else a machine does.
/// Some three times what it takes on a virtual machine of today.
const STEP_NS: f64 = 100.0;
const MASS_NS: f64 = 50.0;
/// How much of the time between two published steps may go into making one.
const SHARE: f64 = 0.5;
/// More substeps than this are never made: the machine must hear of changes between two published steps.
pub const MOST_SUBSTEPS: u32 = 100_000;

/// How many substeps a step there is time for where `rate_hz` steps of a rotor of `masses` are published a second;
/// [`MOST_SUBSTEPS`] where nothing is paced (`rate_hz` 0). At least 1.
#[must_use]
pub fn most_substeps(masses: usize, rate_hz: f64) -> u32 {
    let cost = STEP_NS + MASS_NS * masses as f64;
    (SHARE * 1e9 / rate_hz / cost).clamp(1.0, f64::from(MOST_SUBSTEPS)) as u32
}

/// How many equal substeps make a published step of `dtau` accurate, where `rate_hz` of them are published a second (0:
/// as many as it takes).
///
/// # Errors
/// Not a step, more substeps than there is time for, or eigenvalues that do not converge.
pub fn substeps(closed_loop: &ClosedLoop, dtau: f64, rate_hz: f64) -> Result<u32, StepError> {
    Fastest::of(closed_loop)?.substeps(dtau, rate_hz)
}

/// The fastest that happens in a rotor at one operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fastest {
    masses: usize,
    /// Spin speed `R`.
    speed: f64,
    /// The largest `|Im lambda|`.
    turning: f64,
    /// The mode that asks for the shortest step, and how far it may turn in one, in `|lambda| h`.
    mode: C64,
    limit: f64,
}

impl Fastest {
    /// Looks at the modes of `closed_loop` with every support bearing in and out of action, and at its spin.
    ///
    /// # Errors
    /// As for [`eigenvalues`].
    pub fn of(closed_loop: &ClosedLoop) -> Result<Self, PoleError> {
        let masses = closed_loop.masses();
        let mut poles = Vec::with_capacity(4 * masses);
        for factor in [1.0, 0.0] {
            poles.extend(eigenvalues(closed_loop.state_matrix_with(&vec![factor; masses]))?);
        }
        Ok(Self::of_poles(masses, closed_loop.speed(), poles))
    }

    /// Looks at poles of whatever is integrated, for a machine of so many states as `masses` have, spinning at `speed`.
    #[must_use]
    pub fn of_poles(masses: usize, speed: f64, poles: impl IntoIterator<Item = C64>) -> Self {
        Self::of_poles_near(masses, speed, poles, f64::INFINITY)
    }

    /// The same for a machine with modes that nothing at its speed comes near to, as shaft elements have: those faster than `far` answer as
    /// springs do, whatever their damping, and only have to be followed (`x` within 0.148, which damps them by 5e-7 beside their own).
    #[must_use]
    pub fn of_poles_near(masses: usize, speed: f64, poles: impl IntoIterator<Item = C64>, far: f64) -> Self {
        let mut made = Self { masses, speed, turning: 0.0, mode: C64::ZERO, limit: FASTEST };
        for pole in poles {
            let is_far = pole.norm() > far;
            if !is_far {
                made.turning = made.turning.max(pole.im.abs());
            }
            let asked = (-120.0 * TOLERANCE * pole.re / pole.norm()).max(0.0).powf(0.25).clamp(SLOWEST, FASTEST);
            let limit = if is_far { FASTEST } else { asked };
            if pole.norm() * made.limit > made.mode.norm() * limit {
                (made.mode, made.limit) = (pole, limit);
            }
        }
        made
    }

    /// The fastest rotation, in radians per unit of `tau`.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.turning.max(self.speed.abs())
    }

    /// The longest step that keeps the [`PROMISE`]; infinite where nothing moves.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        (self.limit / self.mode.norm()).min(FASTEST / self.speed.abs())
    }

    /// The step of offline runs: 126 to the fastest turn, at most 0.05, and never longer than [`Fastest::longest_step`].
    #[must_use]
    pub fn default_step(&self) -> f64 {
        (DEFAULT_ANGLE / self.frequency()).min(self.longest_step()).min(LONGEST_DEFAULT)
    }

    /// How many equal substeps make a step of `dtau` accurate, where `rate_hz` steps are published a second (0: as many as
    /// it takes).
    ///
    /// # Errors
    /// Not a step, or more substeps than there is time for.
    pub fn substeps(&self, dtau: f64, rate_hz: f64) -> Result<u32, StepError> {
        self.within(dtau, rate_hz, most_substeps(self.masses, rate_hz))
    }

    /// Refuses a step that is not accurate as it is.
    ///
    /// # Errors
    /// What it is too long for, and a step that is not.
    pub fn check(&self, dtau: f64) -> Result<(), StepError> {
        self.within(dtau, 0.0, 1).map(|_| ())
    }

    fn within(&self, dtau: f64, rate_hz: f64, most: u32) -> Result<u32, StepError> {
        if !(dtau.is_finite() && dtau > 0.0) {
            return Err(StepError::Value(dtau));
        }
        // The longest step itself needs one, whatever its last digit.
        let needed = (dtau / self.longest_step() - 1e-9).ceil().max(1.0);
        if needed <= f64::from(most) {
            return Ok(needed as u32);
        }
        let spins = FASTEST / self.speed.abs() < self.limit / self.mode.norm();
        Err(StepError::TooLong(TooLong {
            dtau,
            cause: if spins { Cause::Spin(self.speed) } else { Cause::Mode(self.mode) },
            needed,
            most,
            rate_hz,
            proposed: if most == 1 && rate_hz == 0.0 {
                self.default_step()
            } else {
                f64::from(most) * self.longest_step()
            },
        }))
    }
}

/// Why a step is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Not a finite number greater than 0.
    #[error("dtau = {0}: expected a finite number greater than 0")]
    Value(f64),
    /// It would not be accurate, and there is no time for substeps that are.
    #[error(transparent)]
    TooLong(#[from] TooLong),
    /// What the step must follow could not be found.
    #[error(transparent)]
    Poles(#[from] PoleError),
}

/// What a step is too long for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// A mode, by its pole.
    Mode(C64),
    /// The unbalance, which turns with this spin speed.
    Spin(f64),
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mode(pole) => write!(f, "the mode at {:.4} {:+.4}j", pole.re, pole.im),
            Self::Spin(speed) => write!(f, "the spin at R = {speed:.4}"),
        }
    }
}

/// A step that would not be accurate.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub struct TooLong {
    /// The step asked for.
    pub dtau: f64,
    /// What it is too long for.
    pub cause: Cause,
    /// How many substeps would do.
    pub needed: f64,
    /// How many there may be.
    pub most: u32,
    /// Steps a second; 0 where nothing is paced.
    pub rate_hz: f64,
    /// A step that would do.
    pub proposed: f64,
}

impl fmt::Display for TooLong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { dtau, cause, needed, most, rate_hz, proposed } = self;
        write!(f, "dtau = {dtau} is too long for {cause}: ")?;
        if *rate_hz > 0.0 {
            let slower = rate_hz * f64::from(*most) / needed;
            write!(
                f,
                "it takes {needed} substeps, and at {rate_hz} steps a second there is time for {most}; \
                 at most {proposed:.1e}, or at most {slower:.1} steps a second, would do"
            )
        } else if *most > 1 {
            write!(f, "it takes {needed} substeps, at most {most} are made; at most {proposed:.1e} would do")
        } else {
            write!(f, "only a step {needed} times as short keeps numbers within {PROMISE:e}; try {proposed:.3e}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mass, Rotor, Settings, builtin};

    fn jeffcott(speed: f64, change: &[(&str, &str)]) -> ClosedLoop {
        let rotor = builtin::rotor("jeffcott").unwrap();
        let mut settings = Settings::new(&rotor, speed, builtin::feedback(&rotor, "off").unwrap());
        change.iter().for_each(|(key, value)| settings.assign(key, value).unwrap());
        settings.closed_loop(&rotor)
    }

    #[test]
    fn the_reports_machines_need_no_substeps_at_the_default_step() {
        for (name, speeds) in [("jeffcott", [0.0, 2.5, 5.0]), ("three-mass", [0.0, 2.5, 5.0])] {
            let rotor = builtin::rotor(name).unwrap();
            for feedback in builtin::feedback_names(&rotor) {
                for speed in speeds {
                    let settings = Settings::new(&rotor, speed, builtin::feedback(&rotor, feedback).unwrap());
                    assert_eq!(
                        substeps(&settings.closed_loop(&rotor), 0.01, 1000.0),
                        Ok(1),
                        "{name} {feedback} {speed}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_faster_needs_more_and_what_is_too_fast_says_why_and_what_would_do() {
        let stiff = [("kd", "90000"), ("cd", "20")];
        assert!((20..60).contains(&substeps(&jeffcott(0.0, &stiff), 0.01, 1000.0).unwrap()));
        assert_eq!(substeps(&jeffcott(300.0, &[]), 0.01, 1000.0), Ok(21));
        assert_eq!(substeps(&jeffcott(628.3, &[]), 0.01, 1000.0), Ok(43));
        let heavy = jeffcott(2.0, &[("cd", "1000000")]);
        let refused = substeps(&heavy, 0.01, 1000.0).unwrap_err();
        let StepError::TooLong(why) = &refused else { panic!("{refused}") };
        assert_eq!((why.most, why.rate_hz), (3333, 1000.0));
        assert_eq!(substeps(&heavy, why.proposed, 1000.0), Ok(3333));
        assert!(substeps(&heavy, 0.01, why.rate_hz * f64::from(why.most) / why.needed).is_ok());
        let told = refused.to_string();
        assert!(told.contains("67568 substeps, and at 1000 steps a second there is time for 3333"), "{told}");
        assert!(told.len() <= 240, "it fits into an answer");
        let spin = substeps(&jeffcott(1000.0, &[]), 1.0, 10_000.0).unwrap_err().to_string();
        assert!(
            spin.starts_with("dtau = 1 is too long for the spin at R = 1000.0000: it takes 6757 substeps"),
            "{spin}"
        );
    }

    #[test]
    fn an_offline_step_is_taken_as_it_is_or_refused_with_one_that_works() {
        let fastest = Fastest::of(&jeffcott(50.0, &[])).unwrap();
        fastest.check(fastest.default_step()).unwrap();
        fastest.check(fastest.longest_step()).unwrap();
        assert!(matches!(fastest.check(0.02), Err(StepError::TooLong(TooLong { cause: Cause::Spin(_), .. }))));
        let stiff = Fastest::of(&jeffcott(0.0, &[("kd", "90000")])).unwrap();
        assert!(matches!(stiff.check(0.01), Err(StepError::TooLong(TooLong { cause: Cause::Mode(_), .. }))));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(fastest.check(bad), Err(StepError::Value(_))), "{bad}");
        }
        let told = fastest.check(0.4).unwrap_err().to_string();
        assert_eq!(
            told,
            "dtau = 0.4 is too long for the spin at R = 50.0000: only a step 136 times as short keeps numbers within 1e-4; \
             try 1.000e-3"
        );
    }

    #[test]
    fn a_rotor_that_nothing_holds_or_turns_may_take_any_step() {
        let free = Rotor::new("free", vec![Mass { mass: 1.0, ..Mass::default() }], vec![]).unwrap();
        let off = crate::Feedback::new(0, vec![crate::Signal::at_mass(0, 1, [0.0; 4])]);
        let settings = Settings::new(&free, 0.0, off);
        assert_eq!(substeps(&settings.closed_loop(&free), 1.0, 100_000.0), Ok(1));
    }
}
