//! The gain of one loop over frequency: `L(j w) = - C (j w - A)^-1 B exp(-j w T)` of a loop opened where its delay acts, or
//! `- C (z - A)^-1 B` at `z = exp(j w h)` of a sampled one.
//!
//! Of several loops that are closed together `L` is a matrix, and the gain of loop `k`, opened alone with the others closed, is
//! `1 / S_kk - 1` with `S = (I + L)^-1`.
//!
//! `A` is brought to Hessenberg form once, so that a frequency costs a few hundred operations and nothing is approximated.

use nalgebra::{DMatrix, Hessenberg};

use crate::balance::balance_matrix;
use crate::{C64, DelayError, DelaySystem, eigenvalues};

/// Poles smaller than this part of the largest are at 0.
const INTEGRATES: f64 = 1e-11;
/// Poles whose real part is less than this part of their size are on the axis.
const ON_THE_AXIS: f64 = 1e-9;
/// So near a pole of `A` on the axis, relative to its size, several loops are looked at beside it: `L` has no bound there, and what the
/// others leave of loop `k` is the difference of what has none. This far from it that keeps half its digits.
const BESIDE: f64 = 1e-8;

/// What frequency means.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plane {
    /// `s = j w`, late by a delay.
    Continuous { delay: f64 },
    /// `z = exp(j w h)`.
    Sampled { period: f64 },
}

/// The gain of one loop; of several, of one of them with the others closed.
#[derive(Clone, Debug)]
pub struct LoopGain {
    /// Upper Hessenberg, row by row.
    a: Vec<C64>,
    /// A column a loop.
    b: Vec<Vec<C64>>,
    /// A row a loop.
    c: Vec<Vec<C64>>,
    /// The loop that is opened.
    opened: usize,
    plane: Plane,
    /// Of all that stays closed, but for what is late.
    poles: Vec<C64>,
    /// `|A|` with what stays closed, and `|b| |c|` of the loop.
    sizes: [f64; 2],
    /// Frequencies of the poles of `A` on the axis, of several loops.
    undamped: Vec<f64>,
}

/// The gains of all loops at one frequency, and what becomes of them when they are closed.
#[derive(Clone, Debug, PartialEq)]
pub struct GainMatrix {
    /// `L`: from the command of loop `k` (column) to that of loop `i` (row), signs turned.
    pub gain: DMatrix<C64>,
    /// `dL / dw`.
    pub slope: DMatrix<C64>,
}

impl GainMatrix {
    /// `S = (I + L)^-1`; `None` where a pole is on the axis.
    #[must_use]
    pub fn sensitivity(&self) -> Option<DMatrix<C64>> {
        let m = self.gain.nrows();
        (DMatrix::identity(m, m) + &self.gain).try_inverse().filter(|s| s.iter().all(|z| z.is_finite()))
    }

    /// The largest singular value of `S`: what the worst mixture of disturbances at all commands is amplified by.
    #[must_use]
    pub fn largest_sensitivity(&self) -> f64 {
        // That of S is one over the least of I + L; the squares are eigenvalues of a small Hermitian matrix.
        self.sensitivity().map_or(f64::INFINITY, |s| {
            let squares = (s.adjoint() * &s).symmetric_eigenvalues();
            squares.iter().copied().fold(0.0, f64::max).sqrt()
        })
    }
}

/// A loop's gain at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyGain {
    /// Frequency in radians per unit of time; negative for backward whirl.
    pub frequency: f64,
    /// `L`.
    pub value: C64,
    /// `dL / dw`.
    pub slope: C64,
}

impl FrequencyGain {
    /// The sensitivity `S = 1 / (1 + L)`.
    #[must_use]
    pub fn sensitivity(&self) -> C64 {
        (self.value + 1.0).inv()
    }

    /// The complementary sensitivity `L / (1 + L)`.
    #[must_use]
    pub fn complementary(&self) -> C64 {
        self.value / (self.value + 1.0)
    }
}

impl LoopGain {
    /// The loop of `x' = A x + B C x(t - T)`, opened between `C` and `B`.
    ///
    /// # Errors
    /// None or several loops, or eigenvalues that cannot be had.
    pub fn of(system: &DelaySystem) -> Result<Self, DelayError> {
        one(Self::each(system)?)
    }

    /// The gain of each loop of `x' = A x + B C x(t - T)` with the others closed.
    ///
    /// # Errors
    /// No loop, or eigenvalues that cannot be had.
    pub fn each(system: &DelaySystem) -> Result<Vec<Self>, DelayError> {
        let plane = Plane::Continuous { delay: system.delay() };
        Self::new(system.a().clone(), system.b(), system.c(), plane)
    }

    /// The loop of `x <- A x + B w`, `w = C x`, sampled every `period`.
    ///
    /// # Errors
    /// None or several loops, or eigenvalues that cannot be had.
    pub fn sampled(a: DMatrix<C64>, b: &DMatrix<C64>, c: &DMatrix<C64>, period: f64) -> Result<Self, DelayError> {
        one(Self::each_sampled(a, b, c, period)?)
    }

    /// The gain of each loop of `x <- A x + B w`, `w = C x` with the others closed.
    ///
    /// # Errors
    /// No loop, or eigenvalues that cannot be had.
    pub fn each_sampled(
        a: DMatrix<C64>,
        b: &DMatrix<C64>,
        c: &DMatrix<C64>,
        period: f64,
    ) -> Result<Vec<Self>, DelayError> {
        Self::new(a, b, c, Plane::Sampled { period })
    }

    fn new(mut a: DMatrix<C64>, b: &DMatrix<C64>, c: &DMatrix<C64>, plane: Plane) -> Result<Vec<Self>, DelayError> {
        let loops = b.ncols();
        if loops == 0 || c.nrows() != loops {
            return Err(DelayError::Several(loops));
        }
        if !a.iter().chain(b).chain(c).all(|z| z.is_finite()) {
            return Err(DelayError::NotFinite);
        }
        let scales = balance_matrix(&mut a);
        let b = DMatrix::from_fn(a.nrows(), loops, |i, k| b[(i, k)] / scales[i]);
        let c = DMatrix::from_fn(loops, a.nrows(), |k, i| c[(k, i)] * scales[i]);
        let closed = |k: usize| {
            let others = (0..loops).filter(|other| *other != k);
            others.fold(a.clone(), |a, other| a + b.column(other) * c.row(other))
        };
        let own = if loops > 1 { eigenvalues(a.clone())? } else { Vec::new() };
        let mut opened = Vec::with_capacity(loops);
        for k in 0..loops {
            let rest = closed(k);
            let size = rest.norm();
            let mut poles = eigenvalues(rest)?;
            // Where the others are late, their resonances are near these or those without them.
            poles.extend(&own);
            opened.push((poles, [size, b.column(k).norm() * c.row(k).norm()]));
        }
        let (q, h) = if a.nrows() > 1 { Hessenberg::new(a).unpack() } else { (DMatrix::identity(1, 1), a) };
        let (b, c) = (q.adjoint() * b, c * q);
        let made = Self {
            a: h.transpose().as_slice().to_vec(),
            b: b.column_iter().map(|column| column.iter().copied().collect()).collect(),
            c: c.row_iter().map(|row| row.iter().copied().collect()).collect(),
            opened: 0,
            plane,
            poles: Vec::new(),
            sizes: [0.0; 2],
            undamped: undamped(&own, plane),
        };
        let each = opened.into_iter().enumerate();
        Ok(each.map(|(opened, (poles, sizes))| Self { opened, poles, sizes, ..made.clone() }).collect())
    }

    /// How many loops are closed together.
    #[must_use]
    pub fn loops(&self) -> usize {
        self.b.len()
    }

    /// Poles of the open loop: of `A`, in `s`, or in `z`. Of several loops, with the others closed at once and not at all.
    #[must_use]
    pub fn poles(&self) -> &[C64] {
        &self.poles
    }

    /// The delay that is in it.
    #[must_use]
    pub fn delay(&self) -> f64 {
        if let Plane::Continuous { delay } = self.plane { delay } else { 0.0 }
    }

    /// The sampling period; 0 of a continuous loop.
    #[must_use]
    pub fn period(&self) -> f64 {
        if let Plane::Sampled { period } = self.plane { period } else { 0.0 }
    }

    /// Frequency and half width of each resonance of the open loop.
    pub(crate) fn resonances(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.poles.iter().filter(|p| **p != C64::ZERO).map(|pole| match self.plane {
            Plane::Continuous { .. } => [pole.im, pole.re.abs()],
            Plane::Sampled { period } => [pole.arg() / period, pole.norm().ln().abs() / period],
        })
    }

    /// Below this size a frequency is 0 to the loop: where something in it integrates, a millionth of the slowest pole that does not;
    /// 0 where nothing does.
    #[must_use]
    pub fn quiet(&self) -> f64 {
        let sizes = || self.resonances().map(|[frequency, width]| frequency.hypot(width));
        let largest = sizes().fold(0.0, f64::max);
        let integrates = self.poles.iter().any(|pole| match self.plane {
            Plane::Continuous { .. } => pole.norm() <= INTEGRATES * largest,
            Plane::Sampled { .. } => (pole - 1.0).norm() <= INTEGRATES,
        });
        let slowest = sizes().filter(|size| *size > INTEGRATES * largest).fold(f64::INFINITY, f64::min);
        if integrates && slowest.is_finite() { 1e-6 * slowest } else { 0.0 }
    }

    /// A frequency beyond which `|L|` is less than `least`; of a sampled loop, half the sampling rate.
    #[must_use]
    pub fn beyond(&self, least: f64) -> f64 {
        match self.plane {
            Plane::Continuous { delay } => {
                let by_norms = self.sizes[0] + self.sizes[1] / least;
                if delay > 0.0 { self.nearer(by_norms, least) } else { by_norms }
            }
            Plane::Sampled { period } => std::f64::consts::PI / period,
        }
    }

    /// As near as the size of `L` itself allows: norms of matrices with fast filters in them say little, and a late loop turns without end.
    /// Beyond all poles, of which there are more than zeros, the size falls.
    fn nearer(&self, mut end: f64, least: f64) -> f64 {
        let largest = self.resonances().map(|[frequency, width]| frequency.hypot(width)).fold(0.0, f64::max);
        let is_faint = |w: f64| [w, -w].into_iter().all(|w| self.at(w).value.norm() < 0.25 * least);
        while 0.5 * end > 2.0 * largest && is_faint(0.5 * end) {
            end *= 0.5;
        }
        end
    }

    /// `L` at a frequency; not finite at a pole on the axis.
    #[must_use]
    pub fn at(&self, frequency: f64) -> FrequencyGain {
        if self.loops() == 1 {
            let [value, slope] = self.at_frequency(frequency, |s| self.eliminate(s).answer(&self.b[0], &self.c)[0]);
            return FrequencyGain { frequency, value, slope };
        }
        let GainMatrix { gain, slope } = self.matrix(frequency);
        let k = self.opened;
        let nowhere = FrequencyGain { frequency, value: C64::from(f64::NAN), slope: C64::from(f64::NAN) };
        let Some(s) = (GainMatrix { gain, slope: DMatrix::zeros(0, 0) }).sensitivity() else { return nowhere };
        let by_w = -(s.row(k) * slope * s.column(k))[0];
        let own = s[(k, k)];
        FrequencyGain { frequency, value: own.inv() - 1.0, slope: -by_w / (own * own) }
    }

    /// A frequency, or one beside it where it is that of a pole of `A` on the axis.
    fn beside(&self, frequency: f64) -> f64 {
        let near = |pole: &&f64| (frequency - **pole).abs() < BESIDE * pole.abs();
        self.undamped.iter().find(near).map_or(frequency, |pole| {
            let away = if frequency < *pole { -BESIDE } else { BESIDE };
            pole + away * pole.abs()
        })
    }

    /// The gains of all loops at a frequency.
    #[must_use]
    pub fn matrix(&self, frequency: f64) -> GainMatrix {
        let frequency = self.beside(frequency);
        let loops = self.loops();
        let (mut gain, mut slope) = (DMatrix::zeros(loops, loops), DMatrix::zeros(loops, loops));
        let plane = match self.plane {
            Plane::Continuous { .. } => C64::new(0.0, frequency),
            Plane::Sampled { period } => C64::cis(frequency * period),
        };
        let eliminated = self.eliminate(plane);
        for (k, b) in self.b.iter().enumerate() {
            for (i, answer) in eliminated.answer(b, &self.c).into_iter().enumerate() {
                let [value, by_w] = self.at_frequency(frequency, |_| answer);
                (gain[(i, k)], slope[(i, k)]) = (value, by_w);
            }
        }
        GainMatrix { gain, slope }
    }

    /// A value over `s` or `z` with its derivative, as one over frequency, late.
    fn at_frequency(&self, frequency: f64, of: impl Fn(C64) -> [C64; 2]) -> [C64; 2] {
        let s = C64::new(0.0, frequency);
        match self.plane {
            Plane::Continuous { delay } => {
                let [value, by_s] = of(s);
                let late = (-s * delay).exp();
                [value * late, (by_s - value * delay) * late * C64::I]
            }
            Plane::Sampled { period } => {
                let z = (s * period).exp();
                let [value, by_z] = of(z);
                [value, by_z * z * C64::I * period]
            }
        }
    }

    /// `s - A` brought to a triangle by elimination with rows exchanged.
    fn eliminate(&self, s: C64) -> Eliminated {
        let n = self.b[0].len();
        let mut m: Vec<C64> = self.a.iter().map(|a| -a).collect();
        (0..n).for_each(|i| m[i * n + i] += s);
        // Row operations are kept to be done to right sides too.
        let mut steps: Vec<(bool, C64)> = Vec::with_capacity(n);
        for i in 0..n.saturating_sub(1) {
            let swap = m[(i + 1) * n + i].l1_norm() > m[i * n + i].l1_norm();
            if swap {
                let (above, below) = m.split_at_mut((i + 1) * n);
                above[i * n + i..].swap_with_slice(&mut below[i..n]);
            }
            let factor = m[(i + 1) * n + i] / m[i * n + i];
            if factor != C64::ZERO {
                let (above, below) = m.split_at_mut((i + 1) * n);
                for (to, from) in below[i..n].iter_mut().zip(&above[i * n + i..]) {
                    *to -= factor * from;
                }
            }
            steps.push((swap, factor));
        }
        Eliminated { triangle: m, steps }
    }
}

/// Frequencies of the poles that are on the axis, but for those at 0.
fn undamped(poles: &[C64], plane: Plane) -> Vec<f64> {
    let on_the_axis = |pole: &C64| match plane {
        Plane::Continuous { .. } => (pole.re.abs() < ON_THE_AXIS * pole.im.abs()).then_some(pole.im),
        Plane::Sampled { period } => {
            let turned = pole.arg();
            ((pole.norm() - 1.0).abs() < ON_THE_AXIS * turned.abs()).then_some(turned / period)
        }
    };
    poles.iter().filter_map(on_the_axis).collect()
}

/// `s - A` as a triangle, row by row, and what was done to its rows.
struct Eliminated {
    triangle: Vec<C64>,
    steps: Vec<(bool, C64)>,
}

impl Eliminated {
    /// `- c (s - A)^-1 b` and its derivative by `s`, for every row of `c`.
    fn answer(&self, b: &[C64], c: &[Vec<C64>]) -> Vec<[C64; 2]> {
        let (n, m) = (b.len(), &self.triangle);
        let forward = |x: &mut [C64]| {
            for (i, (swap, factor)) in self.steps.iter().enumerate() {
                if *swap {
                    x.swap(i, i + 1);
                }
                let from = x[i];
                x[i + 1] -= factor * from;
            }
        };
        let back = |x: &mut [C64]| {
            for i in (0..n).rev() {
                let row = &m[i * n..(i + 1) * n];
                let known: C64 = row[i + 1..].iter().zip(&x[i + 1..]).map(|(m, x)| m * x).sum();
                x[i] = (x[i] - known) / row[i];
            }
        };
        // (s - A) x = b; then (s - A) y = x.
        let mut x = b.to_vec();
        forward(&mut x);
        back(&mut x);
        let mut y = x.clone();
        forward(&mut y);
        back(&mut y);
        let read = |c: &[C64], x: &[C64]| c.iter().zip(x).map(|(c, x)| c * x).sum::<C64>();
        c.iter().map(|c| [-read(c, &x), read(c, &y)]).collect()
    }
}

/// The one loop that there is.
fn one(mut each: Vec<LoopGain>) -> Result<LoopGain, DelayError> {
    match each.len() {
        1 => Ok(each.remove(0)),
        several => Err(DelayError::Several(several)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(delay: f64) -> DelaySystem {
        let n = 5;
        let a = DMatrix::from_fn(n, n, |i, k| C64::new((1.0 + i as f64 * 1.7 + k as f64).sin(), (i * k) as f64 * 0.1));
        let b = DMatrix::from_fn(n, 1, |i, _| C64::new(0.3 * i as f64, 1.0));
        let c = DMatrix::from_fn(1, n, |_, k| C64::new(1.0, -0.2 * k as f64));
        DelaySystem::new(a, b, c, delay).unwrap()
    }

    #[test]
    fn the_gain_is_that_of_the_matrices_and_its_slope_that_of_differences() {
        for delay in [0.0, 0.7] {
            let system = system(delay);
            let gain = LoopGain::of(&system).unwrap();
            for w in [-30.0, -2.0, 0.1, 0.3, 5.0] {
                let s = C64::new(0.0, w);
                let mut m = -system.a().clone();
                (0..5).for_each(|i| m[(i, i)] += s);
                let expected = -(system.c() * m.lu().solve(system.b()).unwrap())[0] * (-s * delay).exp();
                let here = gain.at(w);
                assert!((here.value - expected).norm() < 1e-12 * (1.0 + expected.norm()), "{w}");
                let h = 1e-6;
                let difference = (gain.at(w + h).value - gain.at(w - h).value) / (2.0 * h);
                assert!(
                    (here.slope - difference).norm() < 1e-7 * (1.0 + difference.norm()),
                    "{w}: {} {difference}",
                    here.slope
                );
            }
        }
    }

    /// Random loops with states of very different speed: nothing is left beyond where a late loop is looked at.
    #[test]
    fn beyond_where_a_late_loop_is_looked_at_it_stays_faint() {
        let mut random = fastrand::Rng::with_seed(11);
        let mut spared = 0;
        for _ in 0..300 {
            let n = random.usize(1..7);
            let mut number = |size: f64| C64::new(random.f64() - 0.5, random.f64() - 0.5) * size;
            let a = DMatrix::from_fn(n, n, |i, k| {
                number(10f64.powi(i as i32)) - if i == k { C64::from(10f64.powi(i as i32)) } else { C64::ZERO }
            });
            // In at one end, out at the other: far out it falls with a power of the frequency.
            let b = DMatrix::from_fn(n, 1, |i, _| if i == 0 { number(300.0) } else { C64::ZERO });
            let c = DMatrix::from_fn(1, n, |_, k| if k + 1 == n { number(300.0) } else { C64::ZERO });
            let gain = LoopGain::of(&DelaySystem::new(a, b, c, 0.3).unwrap()).unwrap();
            for least in [1e-1, 1e-2] {
                let end = gain.beyond(least);
                spared += usize::from(end < 0.5 * (gain.sizes[0] + gain.sizes[1] / least));
                let outside = (0..400).map(|k| end * 1.05f64.powi(k));
                for w in outside.flat_map(|w| [w, -w]) {
                    assert!(gain.at(w).value.norm() < least, "{w}: {} of {least}", gain.at(w).value.norm());
                }
            }
        }
        assert!(spared > 100, "{spared}");
    }

    #[test]
    fn a_sampled_gain_is_that_of_its_step() {
        let system = system(0.0);
        let gain = LoopGain::sampled(system.a().clone(), system.b(), system.c(), 0.1).unwrap();
        let z = C64::cis(0.2);
        let mut m = -system.a().clone();
        (0..5).for_each(|i| m[(i, i)] += z);
        let expected = -(system.c() * m.lu().solve(system.b()).unwrap())[0];
        assert!((gain.at(2.0).value - expected).norm() < 1e-12 * expected.norm());
        let difference = (gain.at(2.0 + 1e-6).value - gain.at(2.0 - 1e-6).value) / 2e-6;
        assert!((gain.at(2.0).slope - difference).norm() < 1e-7 * (1.0 + difference.norm()));
    }
}
