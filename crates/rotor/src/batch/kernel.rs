//! The steps of a batch: those of the stepper of one trajectory, in the same order, with a register where that has a number.
//!
//! What is zero in every trajectory is left out. That changes no number: it would add a zero.

// Iterators and closures are functions of their own, which are not sure to be compiled for the registers that are there.
#![allow(clippy::needless_range_loop)]

use pulp::{Simd, WithSimd};

use super::extremes::raise;
use super::rows::{self, KEPT, Rows};
use super::vector::V;
use crate::MAX_MASSES;

/// Which terms a mass has in any trajectory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Terms {
    /// Damping or cross-coupled stiffness.
    pub(super) seal: bool,
    pub(super) clearance: bool,
    pub(super) unbalance: bool,
    pub(super) gain: bool,
    pub(super) controlled: bool,
}

/// `samples` samples with a step after each; of `N` masses, or of as many as the rows have where `N` is [`MAX_MASSES`].
pub(super) struct Block<'a, const N: usize> {
    pub(super) rows: &'a mut Rows,
    pub(super) terms: &'a [Terms],
    /// The number of the next sample.
    pub(super) sample: usize,
    pub(super) samples: usize,
}

#[derive(Clone, Copy)]
struct Coefficients<S: Simd> {
    damping: [V<S>; 2],
    stiffness: [V<S>; 2],
    left: V<S>,
    right: V<S>,
    inside: V<S>,
    deadband_force: V<S>,
    edge_squared: V<S>,
    unbalance: V<S>,
    controlled: V<S>,
    gain_p: [V<S>; 2],
    gain_v: [V<S>; 2],
}

type Complex<S> = [V<S>; 2];

/// As complex numbers are multiplied.
#[inline(always)]
fn times<S: Simd>(a: Complex<S>, b: Complex<S>) -> Complex<S> {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

#[inline(always)]
fn norm_squared<S: Simd>(a: Complex<S>) -> V<S> {
    a[0] * a[0] + a[1] * a[1]
}

/// `from + h slope` of every mass.
#[inline(always)]
fn along<S: Simd, const N: usize>(
    n: usize,
    from: &[Complex<S>; N],
    h: V<S>,
    slope: &[Complex<S>; N],
) -> [Complex<S>; N] {
    let mut to = *from;
    for i in 0..n {
        to[i] = [to[i][0] + slope[i][0] * h, to[i][1] + slope[i][1] * h];
    }
    to
}

/// `from + sixth (k0 + 2 k1 + 2 k2 + k3)` of every mass.
#[inline(always)]
fn combined<S: Simd, const N: usize>(
    n: usize,
    from: &[Complex<S>; N],
    [sixth, two]: [V<S>; 2],
    k: [&[Complex<S>; N]; 4],
) -> [Complex<S>; N] {
    let mut to = *from;
    for i in 0..n {
        for part in 0..2 {
            let slopes = k[0][i][part] + (k[1][i][part] + k[2][i][part]) * two + k[3][i][part];
            to[i][part] = to[i][part] + slopes * sixth;
        }
    }
    to
}

struct Equations<'a, S: Simd, const N: usize> {
    simd: S,
    n: usize,
    masses: [Coefficients<S>; N],
    terms: &'a [Terms],
}

impl<S: Simd, const N: usize> Equations<'_, S, N> {
    /// `-u`.
    #[inline(always)]
    fn feedback(&self, p: &[Complex<S>; N], v: &[Complex<S>; N]) -> Complex<S> {
        let zero = V::all(self.simd, 0.0);
        // Even and odd masses apart, as the stepper of one trajectory has them.
        let (mut y, mut z) = ([zero; 2], [zero; 2]);
        for k in 0..self.n {
            if self.terms[k].gain {
                let (gp, gv) = (self.masses[k].gain_p, self.masses[k].gain_v);
                y[k % 2] = y[k % 2] + (gp[0] * p[k][0] - gp[1] * p[k][1] + (gv[0] * v[k][0] - gv[1] * v[k][1]));
                z[k % 2] = z[k % 2] + (gp[0] * p[k][1] + gp[1] * p[k][0] + (gv[0] * v[k][1] + gv[1] * v[k][0]));
            }
        }
        [y[0] + y[1], z[0] + z[1]]
    }

    /// `p''` of every mass.
    #[inline(always)]
    fn acceleration(
        &self,
        p: &[Complex<S>; N],
        v: &[Complex<S>; N],
        feedback: Complex<S>,
        direction: Complex<S>,
    ) -> [Complex<S>; N] {
        let mut a = [[V::all(self.simd, 0.0); 2]; N];
        for i in 0..self.n {
            let (of, terms) = (&self.masses[i], &self.terms[i]);
            let mut stiffness = of.stiffness[0];
            if terms.clearance {
                let radius_squared = norm_squared(p[i]);
                let outside = of.deadband_force / radius_squared.sqrt();
                stiffness = stiffness + of.inside.replaced(radius_squared.above(of.edge_squared), outside);
            }
            let mut sum = [stiffness * p[i][0], stiffness * p[i][1]];
            if terms.seal {
                let (c, cross) = (of.damping, of.stiffness[1]);
                sum = [
                    c[0] * v[i][0] - c[1] * v[i][1] + (sum[0] - cross * p[i][1]),
                    c[0] * v[i][1] + c[1] * v[i][0] + (sum[1] + cross * p[i][0]),
                ];
            }
            if terms.unbalance {
                sum = [sum[0] + direction[0] * of.unbalance, sum[1] + direction[1] * of.unbalance];
            }
            if i > 0 {
                sum = [sum[0] + of.left * p[i - 1][0], sum[1] + of.left * p[i - 1][1]];
            }
            if i + 1 < self.n {
                sum = [sum[0] + of.right * p[i + 1][0], sum[1] + of.right * p[i + 1][1]];
            }
            if terms.controlled {
                sum = [sum[0] - of.controlled * feedback[0], sum[1] - of.controlled * feedback[1]];
            }
            a[i] = sum;
        }
        a
    }
}

impl<const N: usize> WithSimd for Block<'_, N> {
    /// How many samples were taken: all, or those before one that is not bounded.
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        let Self { rows, terms, sample: first, samples } = self;
        let n = if N == MAX_MASSES { rows.masses } else { N };
        let terms = &terms[..n];
        let load = |rows: &Rows, row: usize| V::new(simd, S::as_simd_f64s(rows.all()).0[row]);
        let mass = |rows: &Rows, mass: usize, row: usize| load(rows, Rows::mass(mass, row));
        let zero = V::all(simd, 0.0);
        let mut masses = [Coefficients {
            damping: [zero; 2],
            stiffness: [zero; 2],
            left: zero,
            right: zero,
            inside: zero,
            deadband_force: zero,
            edge_squared: zero,
            unbalance: zero,
            controlled: zero,
            gain_p: [zero; 2],
            gain_v: [zero; 2],
        }; N];
        let (mut p, mut v) = ([[zero; 2]; N], [[zero; 2]; N]);
        let mut sums = [zero; N];
        for i in 0..n {
            masses[i] = Coefficients {
                damping: [mass(rows, i, rows::DAMPING[0]), mass(rows, i, rows::DAMPING[1])],
                stiffness: [mass(rows, i, rows::STIFFNESS[0]), mass(rows, i, rows::STIFFNESS[1])],
                left: mass(rows, i, rows::LEFT),
                right: mass(rows, i, rows::RIGHT),
                inside: mass(rows, i, rows::INSIDE),
                deadband_force: mass(rows, i, rows::DEADBAND_FORCE),
                edge_squared: mass(rows, i, rows::EDGE_SQUARED),
                unbalance: mass(rows, i, rows::UNBALANCE),
                controlled: mass(rows, i, rows::CONTROLLED),
                gain_p: [mass(rows, i, rows::GAIN_P[0]), mass(rows, i, rows::GAIN_P[1])],
                gain_v: [mass(rows, i, rows::GAIN_V[0]), mass(rows, i, rows::GAIN_V[1])],
            };
            p[i] = [mass(rows, i, rows::P[0]), mass(rows, i, rows::P[1])];
            v[i] = [mass(rows, i, rows::V[0]), mass(rows, i, rows::V[1])];
            sums[i] = mass(rows, i, rows::RADIUS_SUM);
        }
        let equations = Equations { simd, n, masses, terms };
        let (mut before_p, mut before_v) = (p, v);
        let common = |rows: &Rows, row: usize| load(rows, rows.common(row));
        let dtau = common(rows, rows::DTAU);
        let (half, sixth) = (dtau * V::all(simd, 0.5), dtau / V::all(simd, 6.0));
        let two = V::all(simd, 2.0);
        let mut phasor = [common(rows, rows::PHASOR[0]), common(rows, rows::PHASOR[1])];
        let half_turn = [common(rows, rows::HALF_TURN[0]), common(rows, rows::HALF_TURN[1])];
        let limit_squared = common(rows, rows::LIMIT_SQUARED);
        let (most, almost) = (V::all(simd, f64::MAX), V::all(simd, 0.98));
        let (thirty, sixteen) = (V::all(simd, 30.0), V::all(simd, 16.0));
        let (parts, flat) = (V::all(simd, 24.0), V::all(simd, -1e-13));
        let signals = n + 1;
        let maxima = rows.maximum(0);
        let ring = rows.sample(0);
        let width = rows.width;

        let mut taken = 0;
        while taken < samples {
            let feedback = equations.feedback(&p, &v);
            let mut of = [zero; N];
            let force = norm_squared(feedback);
            let mut bounded = force.at_most(most);
            for i in 0..n {
                of[i] = norm_squared(p[i]);
                bounded = bounded.and(of[i].at_most(limit_squared));
            }
            if bounded.not().any() {
                break;
            }
            let number = first + taken;
            let of_sample = |number: usize| ring + (number & (KEPT - 1)) * signals;
            let place = [0, 1, 2, 3, 4].map(|back| of_sample(number.wrapping_sub(back)));
            for signal in 0..signals {
                let new = if signal == 0 { force } else { of[signal - 1] };
                let (all, _) = S::as_mut_simd_f64s(rows.all_mut());
                all[place[0] + signal] = new.raw();
                let at = |back: usize| V::new(simd, all[place[back] + signal]);
                let (a, b, c, d) = (at(4), at(3), at(2), at(1));
                let mut largest = V::new(simd, all[maxima + signal]).max(new);
                let peak = c.at_least(b).and(c.above(d)).and(c.above(almost * largest));
                if peak.any() {
                    largest = largest.replaced(peak, largest.max(c));
                    all[maxima + signal] = largest.raw();
                    // Where samples agree to rounding, as on a circle, there is nothing to be found between them.
                    let curvature = (sixteen * b - a - thirty * c + sixteen * d - new) / parts;
                    if peak.and(curvature.at_least(flat * c).not()).any() {
                        let five = [4, 3, 2, 1, 0].map(|back| place[back] + signal);
                        raise(rows.all_mut(), width, five, maxima + signal);
                    }
                } else {
                    all[maxima + signal] = largest.raw();
                }
            }
            for i in 0..n {
                sums[i] = sums[i] + of[i].sqrt();
            }

            (before_p, before_v) = (p, v);
            let start = phasor;
            let middle = times(start, half_turn);
            phasor = times(middle, half_turn);
            let a0 = equations.acceleration(&p, &v, feedback, start);
            let (p1, v1) = (along(n, &p, half, &v), along(n, &v, half, &a0));
            let a1 = equations.acceleration(&p1, &v1, equations.feedback(&p1, &v1), middle);
            let (p2, v2) = (along(n, &p, half, &v1), along(n, &v, half, &a1));
            let a2 = equations.acceleration(&p2, &v2, equations.feedback(&p2, &v2), middle);
            let (p3, v3) = (along(n, &p, dtau, &v2), along(n, &v, dtau, &a2));
            let a3 = equations.acceleration(&p3, &v3, equations.feedback(&p3, &v3), phasor);
            let end = combined(n, &p, [sixth, two], [&v, &v1, &v2, &v3]);
            v = combined(n, &v, [sixth, two], [&a0, &a1, &a2, &a3]);
            p = end;
            taken += 1;
        }

        let store = |rows: &mut Rows, row: usize, of: V<S>| S::as_mut_simd_f64s(rows.all_mut()).0[row] = of.raw();
        for i in 0..n {
            for part in 0..2 {
                store(rows, Rows::mass(i, rows::P[part]), p[i][part]);
                store(rows, Rows::mass(i, rows::V[part]), v[i][part]);
                if taken > 0 {
                    store(rows, Rows::mass(i, rows::BEFORE[part]), before_p[i][part]);
                    store(rows, Rows::mass(i, rows::BEFORE[2 + part]), before_v[i][part]);
                }
            }
            store(rows, Rows::mass(i, rows::RADIUS_SUM), sums[i]);
        }
        for part in 0..2 {
            let row = rows.common(rows::PHASOR[part]);
            store(rows, row, phasor[part]);
        }
        taken
    }
}
