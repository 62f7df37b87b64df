//! Time integration of the nonlinear rotor: classical fourth-order Runge-Kutta at a fixed step.
//!
//! A stepper allocates nothing after it is made and is monomorphic in the number of masses, so that the inner loops of
//! the report's rotors (n = 1 and n = 3) are unrolled. The spin angle is a state of its own: a change of speed leaves
//! it continuous.

use crate::{C64, ClosedLoop};

/// Where the rotor is. Borrowed from a [`Stepper`].
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Dimensionless time since rest, `tau = w0 t`.
    pub tau: f64,
    /// Spin angle in radians, unwrapped: the unbalance points along `exp(j angle)`.
    pub angle: f64,
    /// `p_i` per mass, in `e_t`.
    pub displacement: &'a [C64],
    /// `p_i'` per mass, in `e_t` per unit of `tau`.
    pub velocity: &'a [C64],
}

impl Motion<'_> {
    /// Whether every number in it is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let finite = |z: &C64| z.re.is_finite() && z.im.is_finite();
        self.tau.is_finite()
            && self.angle.is_finite()
            && self.displacement.iter().all(finite)
            && self.velocity.iter().all(finite)
    }

    /// The largest distance of any mass from its centre, in `e_t`.
    #[must_use]
    pub fn largest_radius(&self) -> f64 {
        self.displacement.iter().map(|p| p.norm_sqr()).fold(0.0, f64::max).sqrt()
    }
}

/// A rotor in motion. Made by [`stepper`].
pub trait Stepper: Send {
    /// Takes new coefficients from here on; position, velocity, time and angle go on unbroken.
    fn load(&mut self, closed_loop: &ClosedLoop);
    /// Advances by `dtau`.
    fn step(&mut self, dtau: f64);
    /// Where it is.
    fn motion(&self) -> Motion<'_>;
    /// The control acceleration at the present state, in `w0^2 e_t`.
    fn control(&self) -> C64;
    /// Bit `i` is set while mass `i` presses on its support bearing.
    fn contact(&self) -> u32;
    /// Adds `change` to the velocity of mass `mass` (counted from 0): an impulse. Nothing if there is no such mass.
    fn kick(&mut self, mass: usize, change: C64);
    /// Back to rest at `tau = 0`, angle 0.
    fn rest(&mut self);
    /// Puts every mass where `displacement` and `velocity` say; missing ones are at rest in the centre.
    fn place(&mut self, displacement: &[C64], velocity: &[C64]);
}

/// A stepper for `closed_loop`, at rest.
#[must_use]
pub fn stepper(closed_loop: &ClosedLoop) -> Box<dyn Stepper> {
    macro_rules! of_size {
        ($($n:literal)+) => {
            match closed_loop.masses {
                $($n => Box::new(Chain::<$n>::new(closed_loop)),)+
                n => unreachable!("a rotor has 1 to 16 masses, not {n}"),
            }
        };
    }
    of_size!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16)
}

/// Steps between two evaluations of the sine and cosine of the spin angle; in between the unbalance is turned by a
/// constant factor, which costs a fifth and is off by less than 1e-14 at the end.
const TURNS_BETWEEN: u64 = 32;

/// Point on a line in time: value `at` at step count zero, and a rate per unit of `tau`.
///
/// Time and angle are computed from the number of steps since the last change of step or speed rather than summed, so
/// that a day's run ends on the same grid as a minute's.
#[derive(Clone, Copy, Debug)]
struct Clock {
    tau: f64,
    angle: f64,
    speed: f64,
    dtau: f64,
    steps: u64,
    /// `exp(j angle)` now, but for rounding; evaluated anew where `steps` is a multiple of [`TURNS_BETWEEN`].
    key: C64,
    /// `exp(j speed dtau / 2)`.
    half_turn: C64,
}

impl Clock {
    fn tau(&self) -> f64 {
        self.tau + self.steps as f64 * self.dtau
    }

    fn angle(&self) -> f64 {
        self.angle + self.speed * (self.steps as f64 * self.dtau)
    }

    fn at_rest(speed: f64) -> Self {
        Self { tau: 0.0, angle: 0.0, speed, dtau: 0.0, steps: 0, key: C64::ONE, half_turn: C64::ONE }
    }

    fn rebase(&mut self, speed: f64, dtau: f64) {
        if speed != self.speed || dtau != self.dtau {
            let half_turn = C64::cis(speed * (0.5 * dtau));
            *self = Self { tau: self.tau(), angle: self.angle(), speed, dtau, steps: 0, half_turn, key: self.key };
        }
    }

    /// `exp(j angle)` at the beginning, the middle and the end of the next step, which is then taken.
    #[inline]
    fn advance(&mut self) -> [C64; 3] {
        if self.steps.is_multiple_of(TURNS_BETWEEN) {
            self.key = C64::cis(self.angle());
        }
        let middle = self.key * self.half_turn;
        let end = middle * self.half_turn;
        let start = std::mem::replace(&mut self.key, end);
        self.steps += 1;
        [start, middle, end]
    }
}

#[derive(Clone, Debug)]
struct Chain<const N: usize> {
    p: [C64; N],
    v: [C64; N],
    clock: Clock,
    bearing_at: usize,
    damping: [C64; N],
    stiffness: [C64; N],
    left: [f64; N],
    right: [f64; N],
    bearing: [f64; N],
    deadband: [f64; N],
    unbalance: [f64; N],
    /// `stiffness - bearing`: everything that is linear, as if the support bearing had no clearance.
    tight: [C64; N],
    /// `bearing * deadband`: what the clearance takes away from the bearing's force in contact.
    slack: [f64; N],
    /// `deadband^2`.
    edge_squared: [f64; N],
    gain_p: [C64; N],
    gain_v: [C64; N],
}

impl<const N: usize> Chain<N> {
    fn new(closed_loop: &ClosedLoop) -> Self {
        let zero = [C64::ZERO; N];
        let mut made = Self {
            p: zero,
            v: zero,
            clock: Clock::at_rest(closed_loop.speed),
            bearing_at: 0,
            damping: zero,
            stiffness: zero,
            left: [0.0; N],
            right: [0.0; N],
            bearing: [0.0; N],
            deadband: [0.0; N],
            unbalance: [0.0; N],
            tight: zero,
            slack: [0.0; N],
            edge_squared: [0.0; N],
            gain_p: zero,
            gain_v: zero,
        };
        made.load(closed_loop);
        made
    }

    #[inline]
    fn control_of(&self, p: &[C64; N], v: &[C64; N]) -> C64 {
        let mut u = C64::ZERO;
        for k in 0..N {
            u -= self.gain_p[k] * p[k] + self.gain_v[k] * v[k];
        }
        u
    }

    /// `p''` of every mass; `key` is `exp(j angle)`.
    #[inline]
    fn acceleration(&self, p: &[C64; N], v: &[C64; N], key: C64) -> [C64; N] {
        let mut a = [C64::ZERO; N];
        for i in 0..N {
            // s(r) p of (3.3) as p less what the clearance takes away: b (1 - s) is b g / r in contact and b inside.
            // Without bearing or clearance it takes nothing: no root, no division.
            let mut sum = self.damping[i] * v[i] + self.tight[i] * p[i];
            if self.slack[i] > 0.0 {
                let radius_squared = p[i].norm_sqr();
                let relief = if radius_squared > self.edge_squared[i] {
                    self.slack[i] / radius_squared.sqrt()
                } else {
                    self.bearing[i]
                };
                sum += p[i] * relief;
            }
            sum += key * self.unbalance[i];
            if i > 0 {
                sum += p[i - 1] * self.left[i];
            }
            if i + 1 < N {
                sum += p[i + 1] * self.right[i];
            }
            a[i] = sum;
        }
        a[self.bearing_at] += self.control_of(p, v);
        a
    }
}

/// `base + h * slope`, mass by mass.
#[inline]
fn along<const N: usize>(base: &[C64; N], h: f64, slope: &[C64; N]) -> [C64; N] {
    std::array::from_fn(|i| base[i] + slope[i] * h)
}

impl<const N: usize> Stepper for Chain<N> {
    fn load(&mut self, closed_loop: &ClosedLoop) {
        fn head<T: Copy, const N: usize>(of: &[T]) -> [T; N] {
            std::array::from_fn(|i| of[i])
        }
        self.clock.rebase(closed_loop.speed, self.clock.dtau);
        self.bearing_at = closed_loop.control.bearing.min(N - 1);
        self.damping = head(&closed_loop.damping);
        self.stiffness = head(&closed_loop.stiffness);
        self.left = head(&closed_loop.left);
        self.right = head(&closed_loop.right);
        self.bearing = head(&closed_loop.bearing);
        self.deadband = head(&closed_loop.deadband);
        self.unbalance = head(&closed_loop.unbalance);
        self.tight = std::array::from_fn(|i| self.stiffness[i] - self.bearing[i]);
        self.slack = std::array::from_fn(|i| self.bearing[i] * self.deadband[i]);
        self.edge_squared = std::array::from_fn(|i| self.deadband[i] * self.deadband[i]);
        self.gain_p = head(&closed_loop.control.displacement);
        self.gain_v = head(&closed_loop.control.velocity);
    }

    fn step(&mut self, dtau: f64) {
        self.clock.rebase(self.clock.speed, dtau);
        let half = 0.5 * dtau;
        let [key0, key1, key2] = self.clock.advance();

        let (p0, v0) = (self.p, self.v);
        let a0 = self.acceleration(&p0, &v0, key0);
        let (p1, v1) = (along(&p0, half, &v0), along(&v0, half, &a0));
        let a1 = self.acceleration(&p1, &v1, key1);
        let (p2, v2) = (along(&p0, half, &v1), along(&v0, half, &a1));
        let a2 = self.acceleration(&p2, &v2, key1);
        let (p3, v3) = (along(&p0, dtau, &v2), along(&v0, dtau, &a2));
        let a3 = self.acceleration(&p3, &v3, key2);
        let sixth = dtau / 6.0;
        for i in 0..N {
            self.p[i] = p0[i] + (v0[i] + (v1[i] + v2[i]) * 2.0 + v3[i]) * sixth;
            self.v[i] = v0[i] + (a0[i] + (a1[i] + a2[i]) * 2.0 + a3[i]) * sixth;
        }
    }

    fn motion(&self) -> Motion<'_> {
        Motion { tau: self.clock.tau(), angle: self.clock.angle(), displacement: &self.p, velocity: &self.v }
    }

    fn control(&self) -> C64 {
        self.control_of(&self.p, &self.v)
    }

    fn contact(&self) -> u32 {
        let mut mask = 0;
        for i in 0..N {
            if self.bearing[i] > 0.0 && self.p[i].norm_sqr() > self.deadband[i] * self.deadband[i] {
                mask |= 1 << i;
            }
        }
        mask
    }

    fn kick(&mut self, mass: usize, change: C64) {
        if let Some(v) = self.v.get_mut(mass) {
            *v += change;
        }
    }

    fn rest(&mut self) {
        self.place(&[], &[]);
        self.clock = Clock { tau: 0.0, angle: 0.0, steps: 0, ..self.clock };
    }

    fn place(&mut self, displacement: &[C64], velocity: &[C64]) {
        self.p = std::array::from_fn(|i| displacement.get(i).copied().unwrap_or_default());
        self.v = std::array::from_fn(|i| velocity.get(i).copied().unwrap_or_default());
    }
}
