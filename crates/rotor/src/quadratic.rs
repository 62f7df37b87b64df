//! The linear equations of motion as a quadratic eigenvalue problem, `(s^2 I - s D - K) p = 0`.
//!
//! It is the state matrix `A = [0 I; K D]` seen through its structure: an eigenvector of `A` is `[p; s p]`, and a left one
//! follows from a row `q` with `q (s^2 I - s D - K) = 0` as `[q (s I - D), q]`. So vectors cost a factorisation of `n` rows
//! instead of `2n`.

use linear::{EigenvalueError, eigenvalues_in_place};

use crate::{C64, ClosedLoop, ControlRow, MAX_MASSES};

/// `K` and `D` of `p'' = K p + D p'`, row by row: the linear rotor for those who need more than its poles, such as what
/// a pole does when a gain changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Quadratic {
    masses: usize,
    stiffness: Vec<C64>,
    damping: Vec<C64>,
}

impl Quadratic {
    /// The equations of `closed_loop`, every support bearing at its full stiffness.
    #[must_use]
    pub fn of(closed_loop: &ClosedLoop) -> Self {
        let n = closed_loop.masses;
        let mut made = Self { masses: n, stiffness: vec![C64::ZERO; n * n], damping: vec![C64::ZERO; n * n] };
        for i in 0..n {
            made.stiffness[i * n + i] = closed_loop.stiffness[i] - closed_loop.bearing[i];
            made.damping[i * n + i] = closed_loop.damping[i];
            if i > 0 {
                made.stiffness[i * n + i - 1] = closed_loop.left[i].into();
            }
            if i + 1 < n {
                made.stiffness[i * n + i + 1] = closed_loop.right[i].into();
            }
        }
        made.control(&closed_loop.control);
        made
    }

    /// Any equations of that form: `K` and `D` row by row, `n x n` each.
    pub(crate) fn of_rows(masses: usize, stiffness: Vec<C64>, damping: Vec<C64>) -> Self {
        Self { masses, stiffness, damping }
    }

    /// Closes a loop more: adds the force of `control` to the row of the mass that carries its bearing.
    ///
    /// # Panics
    /// If that mass does not exist.
    pub fn control(&mut self, control: &ControlRow) {
        let row = control.bearing * self.masses..(control.bearing + 1) * self.masses;
        for (k, gain) in self.stiffness[row.clone()].iter_mut().zip(&control.displacement) {
            *k -= gain;
        }
        for (d, gain) in self.damping[row].iter_mut().zip(&control.velocity) {
            *d -= gain;
        }
    }

    /// `K`, row by row, `n x n`.
    #[must_use]
    pub fn stiffness(&self) -> &[C64] {
        &self.stiffness
    }

    /// `D`, row by row, `n x n`.
    #[must_use]
    pub fn damping(&self) -> &[C64] {
        &self.damping
    }

    /// `self + factor * other`, entry by entry.
    pub(crate) fn plus(&self, factor: f64, other: &Self) -> Self {
        let sum = |a: &[C64], b: &[C64]| a.iter().zip(b).map(|(a, b)| a + b * factor).collect();
        Self {
            masses: self.masses,
            stiffness: sum(&self.stiffness, &other.stiffness),
            damping: sum(&self.damping, &other.damping),
        }
    }

    /// `factor * self`, entry by entry.
    pub(crate) fn times(mut self, factor: f64) -> Self {
        self.stiffness.iter_mut().chain(&mut self.damping).for_each(|z| *z *= factor);
        self
    }

    /// How many masses there are; there are twice as many poles.
    #[must_use]
    pub fn masses(&self) -> usize {
        self.masses
    }

    /// `A = [0 I; K D]`, row by row, into the `2n x 2n` of `rows`.
    ///
    /// # Panics
    /// If `rows` is shorter.
    pub fn state_rows(&self, rows: &mut [C64]) {
        let (n, size) = (self.masses, 2 * self.masses);
        rows.fill(C64::ZERO);
        for i in 0..n {
            rows[i * size + n + i] = C64::ONE;
            let row = &mut rows[(n + i) * size..(n + i + 1) * size];
            row[..n].copy_from_slice(&self.stiffness[i * n..(i + 1) * n]);
            row[n..].copy_from_slice(&self.damping[i * n..(i + 1) * n]);
        }
    }

    /// The eigenvalues of `A`, `2n` of them, in no particular order.
    ///
    /// # Errors
    /// Coefficients that are not finite, or an iteration that does not converge.
    pub fn poles(&self) -> Result<Vec<C64>, EigenvalueError> {
        let size = 2 * self.masses;
        let mut values = vec![C64::ZERO; size];
        // Small rotors are swept over by the thousand: their matrix stays on the stack.
        if size <= 8 {
            let mut rows = [C64::ZERO; 64];
            let rows = &mut rows[..size * size];
            self.state_rows(rows);
            eigenvalues_in_place(rows, &mut values)?;
        } else {
            let mut rows = vec![C64::ZERO; size * size];
            self.state_rows(&mut rows);
            eigenvalues_in_place(&mut rows, &mut values)?;
        }
        Ok(values)
    }

    /// `q (K + s D) x` for a row `q` (not conjugated) and a column `x`.
    #[must_use]
    pub fn form(&self, row: &[C64], x: &[C64], s: C64) -> C64 {
        let n = self.masses;
        let line = |i: usize| -> C64 {
            let (k, d) = (&self.stiffness[i * n..(i + 1) * n], &self.damping[i * n..(i + 1) * n]);
            k.iter().zip(d).zip(x).map(|((k, d), x)| (k + s * d) * x).sum()
        };
        (0..n).map(|i| row[i] * line(i)).sum()
    }

    /// `row D`, into `out`.
    pub fn row_times_damping(&self, row: &[C64], out: &mut [C64]) {
        out.fill(C64::ZERO);
        for (line, r) in self.damping.chunks_exact(self.masses).zip(row) {
            for (o, d) in out.iter_mut().zip(line) {
                *o += r * d;
            }
        }
    }

    /// The displacements under harmonic accelerations, `x` of `(s^2 I - s D - K) x = b`, in place of `b`.
    ///
    /// At a pole there are none: then they come out as large as rounding lets them.
    ///
    /// # Panics
    /// If `b` has not one place a mass.
    pub fn respond(&self, s: C64, b: &mut [C64]) {
        let n = self.masses;
        let mut rows: Vec<C64> = self.stiffness.iter().zip(&self.damping).map(|(k, d)| -(k + d * s)).collect();
        for i in 0..n {
            rows[i * n + i] += s * s;
        }
        Factors::of(&mut rows, n).solve(&mut b[..n]);
    }

    /// The shape `p` of the mode of `pole`, `Q(pole) p = 0`, in Euclidean norm 1, into `right`; and unless `left` is empty
    /// the row `q` with `q Q(pole) = 0` into `left` (not conjugated), in norm 1 too.
    ///
    /// A pole moves with a parameter `x` of `K` and `D` by
    /// `d lambda / dx = q (dK/dx + lambda dD/dx) p / (q (2 lambda I - D) p)`.
    ///
    /// # Panics
    /// If a vector has not one place a mass.
    pub fn vectors(&self, pole: C64, right: &mut [C64], left: &mut [C64]) {
        let n = self.masses;
        if n == 1 {
            right.fill(C64::ONE);
            left.fill(C64::ONE);
            return;
        }
        let mut small = [C64::ZERO; 16];
        let mut wide = Vec::new();
        let rows: &mut [C64] = if n <= 4 {
            &mut small[..n * n]
        } else {
            wide.resize(n * n, C64::ZERO);
            &mut wide
        };
        for (q, (k, d)) in rows.iter_mut().zip(self.stiffness.iter().zip(&self.damping)) {
            *q = -(k + d * pole);
        }
        for i in 0..n {
            rows[i * n + i] += pole * pole;
        }
        if !(n == 3 && null_of_three(rows, right, left)) {
            Factors::of(rows, n).null_vectors(right, left);
        }
    }
}

/// The null vectors of a singular 3 x 3 matrix, which is what the report's rotor has six of at every speed: its adjugate is
/// a column times a row, the right and the left one. Gives up if that is lost in rounding, as where two modes coincide.
fn null_of_three(q: &[C64], right: &mut [C64], left: &mut [C64]) -> bool {
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        q[3 * a + c] * q[3 * b + d] - q[3 * a + d] * q[3 * b + c]
    };
    // Entry (i, j) of the cofactors is entry (j, i) of the adjugate: rows here are right null vectors.
    let cofactors: [[C64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| minor(i, j)));
    let row = |i: usize| cofactors[i].map(|z| z.norm_sqr()).iter().sum::<f64>();
    let column = |j: usize| cofactors.iter().map(|line| line[j].norm_sqr()).sum::<f64>();
    let best = |size: &dyn Fn(usize) -> f64| (1..3).fold(0, |best, i| if size(i) > size(best) { i } else { best });
    let i = best(&row);
    let norm_of_q: f64 = q.iter().map(C64::norm_sqr).sum();
    // A ratio of norms of 1e-8: half the digits are left there, and inverse iteration does better.
    if !(row(i) > 1e-16 * norm_of_q * norm_of_q && row(i).is_finite()) {
        return false;
    }
    right.copy_from_slice(&cofactors[i]);
    normalise(right);
    if !left.is_empty() {
        let j = best(&column);
        (0..3).for_each(|k| left[k] = cofactors[k][j]);
        normalise(left);
    }
    true
}

/// `L U` of a row-permuted matrix that is singular but for rounding, in place.
struct Factors<'a> {
    rows: &'a mut [C64],
    size: usize,
    /// Original row at each place.
    order: [usize; MAX_MASSES],
    /// `1 / U_ii`: divisions are what costs here.
    inverse: [C64; MAX_MASSES],
}

impl<'a> Factors<'a> {
    /// Elimination with partial pivoting. A pivot below rounding is raised to rounding: it is what inverse iteration needs.
    fn of(rows: &'a mut [C64], size: usize) -> Self {
        let largest = rows.iter().map(|z| z.re.abs() + z.im.abs()).fold(0.0, f64::max);
        let least = if largest > 0.0 { largest * f64::EPSILON } else { 1.0 };
        let mut order = std::array::from_fn(|i| i);
        let mut inverse = [C64::ZERO; MAX_MASSES];
        for column in 0..size {
            let weight = |row: usize| rows[row * size + column].norm_sqr();
            let pivot =
                (column + 1..size).fold(column, |best, row| if weight(row) > weight(best) { row } else { best });
            if pivot != column {
                order.swap(pivot, column);
                for j in 0..size {
                    rows.swap(pivot * size + j, column * size + j);
                }
            }
            if rows[column * size + column].norm_sqr() < least * least {
                rows[column * size + column] = C64::from(least);
            }
            inverse[column] = rows[column * size + column].inv();
            let (upper, lower) = rows.split_at_mut((column + 1) * size);
            let upper = &upper[column * size..];
            for row in lower.chunks_exact_mut(size) {
                let factor = row[column] * inverse[column];
                row[column] = factor;
                for (r, u) in row[column + 1..].iter_mut().zip(&upper[column + 1..]) {
                    *r -= factor * u;
                }
            }
        }
        Self { rows, size, order, inverse }
    }

    /// Inverse iteration from a start that no symmetry of a rotor makes orthogonal to a mode.
    fn null_vectors(&self, right: &mut [C64], left: &mut [C64]) {
        let start = |vector: &mut [C64]| {
            for (i, v) in vector.iter_mut().enumerate() {
                *v = C64::new(1.0 + 0.37 * i as f64, 0.61 - 0.23 * i as f64);
            }
        };
        start(right);
        self.back_substitute(right);
        normalise(right);
        self.solve(right);
        normalise(right);
        if left.is_empty() {
            return;
        }
        start(left);
        for _ in 0..2 {
            self.solve_row(left);
            normalise(left);
        }
    }

    fn back_substitute(&self, x: &mut [C64]) {
        for i in (0..self.size).rev() {
            let row = &self.rows[i * self.size..(i + 1) * self.size];
            let known: C64 = row[i + 1..].iter().zip(&x[i + 1..]).map(|(u, x)| u * x).sum();
            x[i] = (x[i] - known) * self.inverse[i];
        }
    }

    /// `x` of `Q x = b`, in place.
    fn solve(&self, x: &mut [C64]) {
        let mut permuted = [C64::ZERO; MAX_MASSES];
        for (p, &from) in permuted.iter_mut().zip(&self.order[..self.size]) {
            *p = x[from];
        }
        for i in 0..self.size {
            let row = &self.rows[i * self.size..i * self.size + i];
            let known: C64 = row.iter().zip(&permuted).map(|(l, x)| l * x).sum();
            permuted[i] -= known;
        }
        x.copy_from_slice(&permuted[..self.size]);
        self.back_substitute(x);
    }

    /// The row `y` of `y Q = b`, in place: forward through `U`, back through `L`, and the permutation undone.
    fn solve_row(&self, y: &mut [C64]) {
        for i in 0..self.size {
            y[i] *= self.inverse[i];
            let known = y[i];
            for (y, u) in y[i + 1..].iter_mut().zip(&self.rows[i * self.size + i + 1..(i + 1) * self.size]) {
                *y -= known * u;
            }
        }
        for i in (0..self.size).rev() {
            let known = y[i];
            for (y, l) in y[..i].iter_mut().zip(&self.rows[i * self.size..i * self.size + i]) {
                *y -= known * l;
            }
        }
        let mut placed = [C64::ZERO; MAX_MASSES];
        for (y, &to) in y.iter().zip(&self.order[..self.size]) {
            placed[to] = *y;
        }
        y.copy_from_slice(&placed[..self.size]);
    }
}

/// Euclidean norm 1. Inverse iteration may end on numbers whose squares overflow, so they are brought near 1 first.
fn normalise(vector: &mut [C64]) {
    let largest = vector.iter().map(|z| z.re.abs().max(z.im.abs())).fold(0.0, f64::max);
    if !(largest.is_finite() && largest > 0.0) {
        return;
    }
    let first = 1.0 / largest;
    let norm = vector.iter().map(|z| (z * first).norm_sqr()).sum::<f64>().sqrt();
    vector.iter_mut().for_each(|z| *z *= first / norm);
}
