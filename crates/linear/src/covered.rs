//! A bound of the sensitivity over all frequencies, and over parameters that the loop's matrix is affine in: cells of both, each
//! with a bound of the second order, halved until all of them are below the largest value that was found.
//!
//! About the middle of a cell, with `M = s I - A - B C exp(-s T)`, `R = M^-1` and `E` what `M` changes by,
//!
//! ```text
//! S = I + C R B exp(-s T),   R = R0 - R0 E R0 + R0 E R0 E R,   |R B| <= |R0 B| / (1 - |E| |R0|)
//! ```
//!
//! The first two terms are affine in the place within the cell, so that their size is largest at a corner; the rest is bounded by
//! norms. Seen through the loop as it is closed, no pole of the open one is in the way. Nothing is assumed but rounding.

use nalgebra::DMatrix;

use crate::certified_peak::largest_singular;
use crate::inverse::invert;
use crate::system::Balanced;
use crate::{C64, DelayError, DelaySystem, eigenvalues, least};

/// Cells over which the loop changes by more than this, relative to what makes it singular, have no bound.
const MOST_CHANGE: f64 = 0.7;
/// A cell is not halved to less than this part of where it is.
const NARROW: f64 = 1e-11;

/// A way in which the loop's matrix moves: `A + t a` for `|t| <= reach`.
#[derive(Clone, Debug, PartialEq)]
pub struct AffineTerm {
    /// What `A` moves by, N x N.
    pub a: DMatrix<C64>,
    /// How far either way, not negative.
    pub reach: f64,
}

/// A largest value, the frequency and the parameters where it is (nothing where it is only approached far out), and what no
/// frequency and no parameters exceed.
pub type CoveredPeak = (f64, Option<Vec<f64>>, f64);

/// A frequency and parameters, each with half its width.
#[derive(Clone, Debug)]
struct Cell {
    middle: Vec<f64>,
    half: Vec<f64>,
}

/// What is known of a cell.
struct Seen {
    /// The value in its middle.
    value: f64,
    /// None of it is larger; infinite where nothing can be said.
    bound: f64,
    /// Along which coordinate the loop changes most.
    widest: usize,
}

struct Cover<'a> {
    system: &'a Balanced,
    along: Vec<DMatrix<C64>>,
    /// How fast the loop changes along each coordinate, at most.
    rates: Vec<f64>,
    through: f64,
}

impl DelaySystem {
    /// The peak of the sensitivity over all frequencies and all parameters within reach, with a bound that is `tolerance` above the
    /// largest value found, relative to it; at least `known`, which is 1 or a value that is reached elsewhere. `None` if that takes more than `budget` cells, if a root is on the axis, or once `stop`
    /// says so.
    ///
    /// # Errors
    /// Eigenvalues that cannot be had, or directions that do not fit.
    pub fn covered_peak(
        &self,
        along: &[AffineTerm],
        known: f64,
        tolerance: f64,
        budget: u64,
        stop: &dyn Fn() -> bool,
    ) -> Result<Option<CoveredPeak>, DelayError> {
        let system = &self.balanced;
        let n = system.size();
        if let Some(wrong) = along.iter().find(|d| d.a.shape() != (n, n)) {
            let [rows, columns] = [wrong.a.nrows(), wrong.a.ncols()];
            return Err(DelayError::Direction { rows, columns, expected: n });
        }
        let along_balanced: Vec<DMatrix<C64>> = along.iter().map(|d| system.scaled(&d.a)).collect();
        let through = (&system.b * &system.c).norm();
        let mut rates = vec![1.0 + system.delay * through];
        rates.extend(along_balanced.iter().map(DMatrix::norm));
        let cover = Cover { system, along: along_balanced, rates, through };
        let reach: Vec<f64> = along.iter().map(|d| d.reach).collect();

        // What is known before: at the frequencies of the loop with its delay left out.
        let zero = vec![0.0; along.len()];
        let mut best: (f64, Option<Vec<f64>>) = (known.max(1.0), None);
        let roots = eigenvalues(&system.a + &system.b * &system.c)?;
        for w in roots.iter().map(|s| s.im).chain([0.0]) {
            let point = [&[w][..], &zero].concat();
            cover.raise(&mut best, &point);
        }
        let level = |best: f64| best * (1.0 + tolerance);
        // Farther out than this |S - I| <= |C| |B| / (w - |A| - |B C|) is not enough.
        let size =
            system.a.norm() + through + (1..cover.rates.len()).map(|k| cover.rates[k] * reach[k - 1]).sum::<f64>();
        let end = size + system.b.norm() * system.c.norm() / (level(best.0) - 1.0);
        let mut cells = Vec::new();
        let mut from = 0.0;
        let mut to = end.min(1e-3 * size.max(f64::MIN_POSITIVE));
        while from < end {
            for sign in [1.0, -1.0] {
                let middle = [&[sign * 0.5 * (from + to)][..], &zero].concat();
                cells.push(Cell { middle, half: [&[0.5 * (to - from)][..], &reach].concat() });
            }
            (from, to) = (to, (2.0 * to).min(end));
        }
        let mut looked = 0;
        while let Some(cell) = cells.pop() {
            looked += 1;
            if looked > budget || stop() {
                return Ok(None);
            }
            let seen = cover.look(&cell);
            if seen.value > best.0 {
                cover.climb(&mut best, &cell);
            }
            if seen.bound <= level(best.0) {
                continue;
            }
            let k = seen.widest;
            if cell.half[k] <= NARROW * (size + cell.middle[k].abs()) {
                return Ok(None);
            }
            for sign in [-1.0, 1.0] {
                let mut half = cell.clone();
                half.half[k] *= 0.5;
                half.middle[k] += sign * half.half[k];
                cells.push(half);
            }
        }
        Ok(Some((best.0, best.1, level(best.0))))
    }
}

impl Cover<'_> {
    /// `A` with the parameters of a point, whose first coordinate is the frequency.
    fn moved(&self, point: &[f64]) -> Balanced {
        let mut system = self.system.clone();
        for (a, t) in self.along.iter().zip(&point[1..]) {
            system.a += a * C64::from(*t);
        }
        system
    }

    fn raise(&self, best: &mut (f64, Option<Vec<f64>>), point: &[f64]) {
        if let Some(here) = self.moved(point).sensitivity_at(point[0]).filter(|here| *here > best.0) {
            *best = (here, Some(point.to_vec()));
        }
    }

    /// The largest over frequency in a cell, at its parameters' middle: so that little is left to halve for.
    fn climb(&self, best: &mut (f64, Option<Vec<f64>>), cell: &Cell) {
        self.raise(best, &cell.middle);
        let system = self.moved(&cell.middle);
        let ends = [-1.0, 1.0].map(|sign| cell.middle[0] + sign * cell.half[0]);
        let look = |w: f64| Ok::<_, std::convert::Infallible>(-system.sensitivity_at(w).unwrap_or(0.0));
        let Ok((w, _)) = least(ends, 1e-3 * cell.half[0], look);
        let mut point = cell.middle.clone();
        point[0] = w;
        self.raise(best, &point);
    }

    fn look(&self, cell: &Cell) -> Seen {
        let system = self.moved(&cell.middle);
        let (w, h, delay) = (cell.middle[0], cell.half[0], system.delay);
        let changes: Vec<f64> = self.rates.iter().zip(&cell.half).map(|(rate, half)| rate * half).collect();
        let widest = (0..changes.len()).max_by(|a, b| changes[*a].total_cmp(&changes[*b])).unwrap_or(0);
        let nothing = |value| Seen { value, bound: f64::INFINITY, widest };
        let s = C64::new(0.0, w);
        let late = (-s * delay).exp();
        let Some(inverse) = invert(system.at(s)).map(|found| found.inverse) else { return nothing(0.0) };
        let (x, y) = (&inverse * &system.b, &system.c * &inverse);
        let read = &system.c * &x;
        let mut middle = &read * late;
        (0..middle.nrows()).for_each(|k| middle[(k, k)] += C64::ONE);
        let value = largest_singular(&middle);
        let change: f64 = changes.iter().sum();
        let share = change * inverse.norm();
        if share >= MOST_CHANGE {
            return nothing(value);
        }
        // What S changes by to first order, along the frequency and along each parameter.
        let along_w = (&y * &x + (&y * &system.b) * &read * (late * delay)) * C64::I;
        let mut slopes = vec![(&along_w + &read * (C64::I * delay)) * -late];
        let along: Vec<DMatrix<C64>> = self.along.iter().map(|a| &y * a * &x).collect();
        slopes.extend(along.iter().map(|by| by * late));
        let corner = |bits: usize| {
            let mut there = middle.clone();
            for (k, (slope, half)) in slopes.iter().zip(&cell.half).enumerate() {
                there += slope * C64::from(if bits >> k & 1 == 1 { *half } else { -half });
            }
            largest_singular(&there)
        };
        let first = (0..1 << slopes.len()).map(corner).fold(0.0, f64::max);
        let (nx, ny) = (x.norm(), y.norm());
        let bend = 0.5 * (delay * h).powi(2);
        let moved =
            along_w.norm() * h + along.iter().zip(&cell.half[1..]).map(|(by, half)| by.norm() * half).sum::<f64>();
        let rest = ny * change * change * inverse.norm() * nx / (1.0 - share)
            + ny * nx * bend * self.through
            + (read.norm() + moved) * bend
            + h * delay * moved;
        Seen { value, bound: first + rest, widest }
    }
}
