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
        // All of them, whatever the first says: that is a few instructions, where as many branches cost a tenth of a step.
        let finite = |all: &[C64]| all.iter().fold(true, |so_far, z| so_far & z.re.is_finite() & z.im.is_finite());
        self.tau.is_finite() & self.angle.is_finite() & finite(self.displacement) & finite(self.velocity)
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
    /// Advances by `dtau` in `substeps` equal steps: with one of them, to the last bit what [`Stepper::step`] does.
    fn advance(&mut self, dtau: f64, substeps: u32) {
        let substep = dtau / f64::from(substeps.max(1));
        (0..substeps.max(1)).for_each(|_| self.step(substep));
    }
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
    /// Sets time and angle as if `steps` steps of `dtau` had been made since they were `tau` and `angle`, at the speed that
    /// is loaded. With the line on which a run was, and [`Stepper::place`], the run goes on from there to the last bit.
    fn set_clock(&mut self, tau: f64, angle: f64, steps: u64, dtau: f64);
    /// Puts every mass where `displacement` and `velocity` say; missing ones are at rest in the centre.
    fn place(&mut self, displacement: &[C64], velocity: &[C64]);
    /// The same rotor in the same motion once more: both go on alike, to the last bit.
    fn twin(&self) -> Box<dyn Stepper>;
}

/// A stepper for `closed_loop`, at rest.
#[must_use]
pub fn stepper(closed_loop: &ClosedLoop) -> Box<dyn Stepper> {
    macro_rules! of_size {
        ($($n:literal)+) => {
            match closed_loop.masses {
                $($n => Box::new(Chain::<$n, { lanes($n) }>::new(closed_loop)),)+
                n => unreachable!("a rotor has 1 to 16 masses, not {n}"),
            }
        };
    }
    of_size!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16)
}

/// Masses are worked on in pairs, so an odd number above one has an idle lane.
const fn lanes(masses: usize) -> usize {
    if masses == 1 { 1 } else { masses.next_multiple_of(2) }
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
    phasor: C64,
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
        Self { tau: 0.0, angle: 0.0, speed, dtau: 0.0, steps: 0, phasor: C64::ONE, half_turn: C64::ONE }
    }

    fn rebase(&mut self, speed: f64, dtau: f64) {
        if speed != self.speed || dtau != self.dtau {
            let half_turn = C64::cis(speed * (0.5 * dtau));
            *self =
                Self { tau: self.tau(), angle: self.angle(), speed, dtau, steps: 0, half_turn, phasor: self.phasor };
        }
    }

    /// The clock that this one is after `steps` steps of `dtau` from `tau` and `angle`.
    fn after(self, tau: f64, angle: f64, steps: u64, dtau: f64) -> Self {
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
    fn advance(&mut self) -> [C64; 3] {
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

/// The parts `y` and `z` of one complex number a mass, apart, so that the compiler works on several masses at once.
#[derive(Clone, Copy, Debug)]
struct Lanes<const L: usize> {
    y: [f64; L],
    z: [f64; L],
}

impl<const L: usize> Lanes<L> {
    const ZERO: Self = Self { y: [0.0; L], z: [0.0; L] };

    fn of(numbers: &[C64]) -> Self {
        let at = |k: usize| numbers.get(k).copied().unwrap_or_default();
        Self { y: std::array::from_fn(|k| at(k).re), z: std::array::from_fn(|k| at(k).im) }
    }

    /// `self + h * slope`, mass by mass.
    #[inline]
    fn along(&self, h: f64, slope: &Self) -> Self {
        let mut sum = *self;
        for k in 0..L {
            sum.y[k] += slope.y[k] * h;
            sum.z[k] += slope.z[k] * h;
        }
        sum
    }

    /// `self + dtau / 6 (k0 + 2 k1 + 2 k2 + k3)`.
    #[inline]
    fn combined(&self, sixth: f64, k: [&Self; 4]) -> Self {
        let mut sum = *self;
        for i in 0..L {
            sum.y[i] += (k[0].y[i] + (k[1].y[i] + k[2].y[i]) * 2.0 + k[3].y[i]) * sixth;
            sum.z[i] += (k[0].z[i] + (k[1].z[i] + k[2].z[i]) * 2.0 + k[3].z[i]) * sixth;
        }
        sum
    }
}

/// A chain of `N` masses in `L` lanes, those beyond `N` idle: their coefficients are zero.
#[derive(Clone, Debug)]
struct Chain<const N: usize, const L: usize> {
    p: [C64; N],
    v: [C64; N],
    clock: Clock,
    /// 1 for the mass that carries the control bearing, 0 for the others.
    controlled: [f64; L],
    damping: Lanes<L>,
    /// What is linear in a mass's own displacement, the support bearing without clearance: `stiffness - b` of the
    /// closed loop.
    full_stiffness: Lanes<L>,
    left: [f64; L],
    right: [f64; L],
    bearing: [f64; L],
    /// `b g`, `bearing` times `deadband`: by how much the clearance lessens the support bearing's force in contact, `b (r - g)`.
    deadband_force: [f64; L],
    /// `deadband^2`.
    edge_squared: [f64; L],
    unbalance: [f64; L],
    gain_p: Lanes<L>,
    gain_v: Lanes<L>,
}

impl<const N: usize, const L: usize> Chain<N, L> {
    fn new(closed_loop: &ClosedLoop) -> Self {
        let mut made = Self {
            p: [C64::ZERO; N],
            v: [C64::ZERO; N],
            clock: Clock::at_rest(closed_loop.speed),
            controlled: [0.0; L],
            damping: Lanes::ZERO,
            full_stiffness: Lanes::ZERO,
            left: [0.0; L],
            right: [0.0; L],
            bearing: [0.0; L],
            deadband_force: [0.0; L],
            edge_squared: [0.0; L],
            unbalance: [0.0; L],
            gain_p: Lanes::ZERO,
            gain_v: Lanes::ZERO,
        };
        made.load(closed_loop);
        made
    }

    /// `-u`: the sum of all gains on what they act on.
    #[inline(always)]
    fn feedback_of(&self, p: &Lanes<L>, v: &Lanes<L>) -> [f64; 2] {
        // Two partial sums, for even and odd masses, keep pairs together.
        let (mut y, mut z) = ([0.0; 2], [0.0; 2]);
        let (gp, gv) = (&self.gain_p, &self.gain_v);
        for k in 0..L {
            y[k % 2] += gp.y[k] * p.y[k] - gp.z[k] * p.z[k] + (gv.y[k] * v.y[k] - gv.z[k] * v.z[k]);
            z[k % 2] += gp.y[k] * p.z[k] + gp.z[k] * p.y[k] + (gv.y[k] * v.z[k] + gv.z[k] * v.y[k]);
        }
        [y[0] + y[1], z[0] + z[1]]
    }

    /// `p''` of every mass; `phasor` is `exp(j angle)`.
    #[inline(always)]
    fn acceleration(&self, p: &Lanes<L>, v: &Lanes<L>, phasor: C64) -> Lanes<L> {
        let mut a = Lanes::ZERO;
        let (c, k) = (&self.damping, &self.full_stiffness);
        // s(r) p of (3.3) as p less what the clearance takes away: b (1 - s) is b g / r in contact and b inside. Roots
        // and quotients are dear, so they are formed only where there is a clearance that is overcome.
        let softening: [f64; L] = std::array::from_fn(|i| {
            if self.deadband_force[i] > 0.0 {
                let radius_squared = p.y[i] * p.y[i] + p.z[i] * p.z[i];
                let in_contact = radius_squared > self.edge_squared[i];
                if in_contact { self.deadband_force[i] / radius_squared.sqrt() } else { self.bearing[i] }
            } else {
                0.0
            }
        });
        for (i, softening) in softening.iter().enumerate() {
            let stiffness = k.y[i] + softening;
            a.y[i] = c.y[i] * v.y[i] - c.z[i] * v.z[i]
                + (stiffness * p.y[i] - k.z[i] * p.z[i])
                + phasor.re * self.unbalance[i];
            a.z[i] = c.y[i] * v.z[i]
                + c.z[i] * v.y[i]
                + (stiffness * p.z[i] + k.z[i] * p.y[i])
                + phasor.im * self.unbalance[i];
        }
        for i in 1..N {
            a.y[i] += self.left[i] * p.y[i - 1];
            a.z[i] += self.left[i] * p.z[i - 1];
        }
        for i in 1..N {
            a.y[i - 1] += self.right[i - 1] * p.y[i];
            a.z[i - 1] += self.right[i - 1] * p.z[i];
        }
        let [y, z] = self.feedback_of(p, v);
        // A sum over all masses with a weight of 0 or 1: an index that is not known beforehand keeps `a` out of registers.
        for i in 0..L {
            a.y[i] -= self.controlled[i] * y;
            a.z[i] -= self.controlled[i] * z;
        }
        a
    }
}

impl<const N: usize, const L: usize> Stepper for Chain<N, L> {
    fn load(&mut self, closed_loop: &ClosedLoop) {
        /// The first `N` of them, and zero in idle lanes.
        fn head<const N: usize, const L: usize>(of: impl Fn(usize) -> f64) -> [f64; L] {
            std::array::from_fn(|i| if i < N { of(i) } else { 0.0 })
        }
        let of = closed_loop;
        self.clock.rebase(of.speed, self.clock.dtau);
        let at = of.control.bearing.min(N - 1);
        self.controlled = std::array::from_fn(|i| if i == at { 1.0 } else { 0.0 });
        self.damping = Lanes::of(&of.damping[..N]);
        self.full_stiffness =
            Lanes { y: head::<N, L>(|i| of.stiffness[i].re - of.bearing[i]), z: head::<N, L>(|i| of.stiffness[i].im) };
        self.left = head::<N, L>(|i| of.left[i]);
        self.right = head::<N, L>(|i| of.right[i]);
        self.bearing = head::<N, L>(|i| of.bearing[i]);
        self.deadband_force = head::<N, L>(|i| of.bearing[i] * of.deadband[i]);
        self.edge_squared = head::<N, L>(|i| of.deadband[i] * of.deadband[i]);
        self.unbalance = head::<N, L>(|i| of.unbalance[i]);
        self.gain_p = Lanes::of(&of.control.displacement[..N]);
        self.gain_v = Lanes::of(&of.control.velocity[..N]);
    }

    fn step(&mut self, dtau: f64) {
        self.clock.rebase(self.clock.speed, dtau);
        let half = 0.5 * dtau;
        let [key0, key1, key2] = self.clock.advance();

        let (p0, v0) = (Lanes::of(&self.p), Lanes::of(&self.v));
        let a0 = self.acceleration(&p0, &v0, key0);
        let (p1, v1) = (p0.along(half, &v0), v0.along(half, &a0));
        let a1 = self.acceleration(&p1, &v1, key1);
        let (p2, v2) = (p0.along(half, &v1), v0.along(half, &a1));
        let a2 = self.acceleration(&p2, &v2, key1);
        let (p3, v3) = (p0.along(dtau, &v2), v0.along(dtau, &a2));
        let a3 = self.acceleration(&p3, &v3, key2);
        let sixth = dtau / 6.0;
        let p = p0.combined(sixth, [&v0, &v1, &v2, &v3]);
        let v = v0.combined(sixth, [&a0, &a1, &a2, &a3]);
        self.p = std::array::from_fn(|k| C64::new(p.y[k], p.z[k]));
        self.v = std::array::from_fn(|k| C64::new(v.y[k], v.z[k]));
    }

    fn motion(&self) -> Motion<'_> {
        Motion { tau: self.clock.tau(), angle: self.clock.angle(), displacement: &self.p, velocity: &self.v }
    }

    fn control(&self) -> C64 {
        let [y, z] = self.feedback_of(&Lanes::of(&self.p), &Lanes::of(&self.v));
        C64::new(-y, -z)
    }

    fn contact(&self) -> u32 {
        let mut mask = 0;
        for i in 0..N {
            if self.bearing[i] > 0.0 && self.p[i].norm_sqr() > self.edge_squared[i] {
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

    fn set_clock(&mut self, tau: f64, angle: f64, steps: u64, dtau: f64) {
        self.clock = self.clock.after(tau, angle, steps, dtau);
    }

    fn place(&mut self, displacement: &[C64], velocity: &[C64]) {
        self.p = std::array::from_fn(|i| displacement.get(i).copied().unwrap_or_default());
        self.v = std::array::from_fn(|i| velocity.get(i).copied().unwrap_or_default());
    }

    fn twin(&self) -> Box<dyn Stepper> {
        Box::new(self.clone())
    }
}
