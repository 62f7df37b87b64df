//! Dense matrices in motion. Those of a rotor are mostly real, or imaginary, or nothing: only the parts that are there are multiplied.

use nalgebra::DMatrix;

use crate::C64;

/// What a part is multiplied by.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    Displacement,
    Velocity,
}

/// The real or the imaginary part of one matrix, column by column.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    entries: Vec<f64>,
    by: By,
    /// Whether it grows with the speed.
    with_speed: bool,
    /// 1 or `j`.
    unit: C64,
}

/// `(D0 + R D1) v + (S0 + R S1) q`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dense {
    pub(super) damping: [DMatrix<C64>; 2],
    pub(super) stiffness: [DMatrix<C64>; 2],
    parts: Vec<Part>,
}

impl Dense {
    pub(super) fn new(damping: [DMatrix<C64>; 2], stiffness: [DMatrix<C64>; 2]) -> Self {
        let mut parts = Vec::new();
        for (matrices, by) in [(&damping, By::Velocity), (&stiffness, By::Displacement)] {
            for (matrix, with_speed) in matrices.iter().zip([false, true]) {
                for (unit, of) in [(C64::ONE, (|z: &C64| z.re) as fn(&C64) -> f64), (C64::I, |z: &C64| z.im)] {
                    let entries: Vec<f64> = matrix.iter().map(of).collect();
                    if entries.iter().any(|x| *x != 0.0) {
                        parts.push(Part { entries, by, with_speed, unit });
                    }
                }
            }
        }
        Self { damping, stiffness, parts }
    }

    /// The accelerations, into `out`.
    pub(super) fn acceleration(&self, speed: f64, q: &[C64], v: &[C64], out: &mut [C64]) {
        out.fill(C64::ZERO);
        let n = out.len();
        for part in &self.parts {
            let factor = part.unit * if part.with_speed { speed } else { 1.0 };
            let of = if part.by == By::Velocity { v } else { q };
            for (column, x) in part.entries.chunks_exact(n).zip(of) {
                let x = x * factor;
                for (out, a) in out.iter_mut().zip(column) {
                    *out += x * *a;
                }
            }
        }
    }
}
