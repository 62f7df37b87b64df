//! Time integration of the nonlinear rotor: classical fourth-order Runge-Kutta at a fixed step.
//!
//! A stepper allocates nothing after it is made and is monomorphic in the number of masses, so that the inner loops of
//! the report's rotors (n = 1 and n = 3) are unrolled. The spin angle is a state of its own: a change of speed leaves
//! it continuous. At a steady speed a stepper turns by itself; through a changing one it is told the spin, stage by stage, and
//! its coefficients follow.

mod clock;
mod lanes;

use clock::Clock;
pub(crate) use clock::TURNS_BETWEEN;
use lanes::Lanes;

use control::LawPiece;

use crate::{C64, ClosedLoop, LoopOverSpeed, MAX_MASSES, SpeedStage};

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
    /// Advances by `dtau` through a changing speed: `stages` are the spin at the beginning, in the middle and at the end, `over` what of the
    /// loaded coefficients hangs on the speed. Time and angle of [`Stepper::motion`] stay what they are: who knows the spin knows them.
    fn step_through(&mut self, dtau: f64, stages: &[SpeedStage; 3], over: &LoopOverSpeed);
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
    gains: Gains<L>,
}

/// What of the equations hangs on the speed, in a stage of a step.
struct Coefficients<'a, const L: usize> {
    /// What unbalance is a multiple of: `exp(j angle)` beside amplitudes at one speed, `(R^2 - j R') exp(j angle)` beside eccentricities.
    direction: C64,
    unbalance: &'a [f64; L],
    /// Cross-coupled stiffness.
    cross: &'a [f64; L],
    gain_p: &'a Lanes<L>,
    gain_v: &'a Lanes<L>,
}

/// The gains over a stretch of speeds: a straight line.
#[derive(Clone, Copy, Debug)]
struct Gains<const L: usize> {
    from: f64,
    until: f64,
    base: f64,
    /// The speed of those in force; not a number for those that are loaded.
    are_at: f64,
    /// Of displacement and velocity: at `base`, and per unit of speed.
    p: [Lanes<L>; 2],
    v: [Lanes<L>; 2],
}

impl<const L: usize> Gains<L> {
    /// Those of no speed.
    const NONE: Self =
        Self { from: f64::NAN, until: f64::NAN, base: 0.0, are_at: f64::NAN, p: [Lanes::ZERO; 2], v: [Lanes::ZERO; 2] };

    /// Goes to the piece of the law that holds at a speed. Returns how far the speed is from the base of it.
    #[inline(always)]
    fn reach(&mut self, speed: f64, over: &LoopOverSpeed, masses: usize) -> f64 {
        if !(self.from <= speed && speed < self.until) {
            self.take(over.law.piece(speed), masses);
        }
        speed - self.base
    }

    #[cold]
    fn take(&mut self, piece: &LawPiece, masses: usize) {
        let LawPiece { from, until, base, row, slope } = piece;
        let of = |of: &[C64; MAX_MASSES]| Lanes::of(&of[..masses]);
        (self.from, self.until, self.base) = (*from, *until, *base);
        self.p = [of(&row.displacement), of(&slope.displacement)];
        self.v = [of(&row.velocity), of(&slope.velocity)];
    }
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
            gains: Gains::NONE,
        };
        made.load(closed_loop);
        made
    }

    /// `-u`: the sum of all gains on what they act on.
    #[inline(always)]
    fn feedback_of([gp, gv]: [&Lanes<L>; 2], p: &Lanes<L>, v: &Lanes<L>) -> [f64; 2] {
        // Two partial sums, for even and odd masses, keep pairs together.
        let (mut y, mut z) = ([0.0; 2], [0.0; 2]);
        for k in 0..L {
            y[k % 2] += gp.y[k] * p.y[k] - gp.z[k] * p.z[k] + (gv.y[k] * v.y[k] - gv.z[k] * v.z[k]);
            z[k % 2] += gp.y[k] * p.z[k] + gp.z[k] * p.y[k] + (gv.y[k] * v.z[k] + gv.z[k] * v.y[k]);
        }
        [y[0] + y[1], z[0] + z[1]]
    }

    /// `p''` of every mass.
    #[inline(always)]
    fn acceleration(&self, p: &Lanes<L>, v: &Lanes<L>, at: &Coefficients<'_, L>) -> Lanes<L> {
        let mut a = Lanes::ZERO;
        let (c, k) = (&self.damping, Lanes { y: self.full_stiffness.y, z: *at.cross });
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
                + at.direction.re * at.unbalance[i];
            a.z[i] = c.y[i] * v.z[i]
                + c.z[i] * v.y[i]
                + (stiffness * p.z[i] + k.z[i] * p.y[i])
                + at.direction.im * at.unbalance[i];
        }
        for i in 1..N {
            a.y[i] += self.left[i] * p.y[i - 1];
            a.z[i] += self.left[i] * p.z[i - 1];
        }
        for i in 1..N {
            a.y[i - 1] += self.right[i - 1] * p.y[i];
            a.z[i - 1] += self.right[i - 1] * p.z[i];
        }
        let [y, z] = Self::feedback_of([at.gain_p, at.gain_v], p, v);
        // A sum over all masses with a weight of 0 or 1: an index that is not known beforehand keeps `a` out of registers.
        for i in 0..L {
            a.y[i] -= self.controlled[i] * y;
            a.z[i] -= self.controlled[i] * z;
        }
        a
    }

    /// Displacements and velocities after a step, with the coefficients at its beginning, in its middle and at its end.
    #[inline(always)]
    fn stepped(&self, dtau: f64, at: &[Coefficients<'_, L>; 3]) -> ([C64; N], [C64; N]) {
        let half = 0.5 * dtau;
        let (p0, v0) = (Lanes::of(&self.p), Lanes::of(&self.v));
        let a0 = self.acceleration(&p0, &v0, &at[0]);
        let (p1, v1) = (p0.along(half, &v0), v0.along(half, &a0));
        let a1 = self.acceleration(&p1, &v1, &at[1]);
        let (p2, v2) = (p0.along(half, &v1), v0.along(half, &a1));
        let a2 = self.acceleration(&p2, &v2, &at[1]);
        let (p3, v3) = (p0.along(dtau, &v2), v0.along(dtau, &a2));
        let a3 = self.acceleration(&p3, &v3, &at[2]);
        let sixth = dtau / 6.0;
        let p = p0.combined(sixth, [&v0, &v1, &v2, &v3]);
        let v = v0.combined(sixth, [&a0, &a1, &a2, &a3]);
        (std::array::from_fn(|k| C64::new(p.y[k], p.z[k])), std::array::from_fn(|k| C64::new(v.y[k], v.z[k])))
    }

    /// The same through a changing speed, with the gains at those three moments.
    #[inline(always)]
    fn stepped_through(
        &self,
        dtau: f64,
        stages: &[SpeedStage; 3],
        over: &LoopOverSpeed,
        gains: [[&Lanes<L>; 2]; 3],
    ) -> ([C64; N], [C64; N]) {
        let eccentricity: [f64; L] = std::array::from_fn(|i| over.eccentricity[i]);
        let cross: [[f64; L]; 3] = stages.map(|stage| std::array::from_fn(|i| over.seal[i] * stage.speed));
        let at = [0, 1, 2].map(|k| Coefficients {
            direction: stages[k].unbalance,
            unbalance: &eccentricity,
            cross: &cross[k],
            gain_p: gains[k][0],
            gain_v: gains[k][1],
        });
        self.stepped(dtau, &at)
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
        self.gains = Gains::NONE;
    }

    fn step(&mut self, dtau: f64) {
        self.clock.rebase(self.clock.speed, dtau);
        let keys = self.clock.advance();
        let at = keys.map(|direction| Coefficients {
            direction,
            unbalance: &self.unbalance,
            cross: &self.full_stiffness.z,
            gain_p: &self.gain_p,
            gain_v: &self.gain_v,
        });
        (self.p, self.v) = self.stepped(dtau, &at);
    }

    fn step_through(&mut self, dtau: f64, stages: &[SpeedStage; 3], over: &LoopOverSpeed) {
        if !over.law.is_constant() {
            if stages[0].speed != self.gains.are_at {
                let off = self.gains.reach(stages[0].speed, over, N);
                self.gain_p = self.gains.p[0].along(off, &self.gains.p[1]);
                self.gain_v = self.gains.v[0].along(off, &self.gains.v[1]);
            }
            let off = self.gains.reach(stages[1].speed, over, N);
            let middle_p = self.gains.p[0].along(off, &self.gains.p[1]);
            let middle_v = self.gains.v[0].along(off, &self.gains.v[1]);
            let off = self.gains.reach(stages[2].speed, over, N);
            let end_p = self.gains.p[0].along(off, &self.gains.p[1]);
            let end_v = self.gains.v[0].along(off, &self.gains.v[1]);
            let gains = [[&self.gain_p, &self.gain_v], [&middle_p, &middle_v], [&end_p, &end_v]];
            (self.p, self.v) = self.stepped_through(dtau, stages, over, gains);
            (self.gain_p, self.gain_v, self.gains.are_at) = (end_p, end_v, stages[2].speed);
        } else {
            let gains = [&self.gain_p, &self.gain_v];
            (self.p, self.v) = self.stepped_through(dtau, stages, over, [gains; 3]);
        }
    }

    fn motion(&self) -> Motion<'_> {
        Motion { tau: self.clock.tau(), angle: self.clock.angle(), displacement: &self.p, velocity: &self.v }
    }

    fn control(&self) -> C64 {
        let [y, z] = Self::feedback_of([&self.gain_p, &self.gain_v], &Lanes::of(&self.p), &Lanes::of(&self.v));
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
        self.clock = self.clock.restarted();
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
