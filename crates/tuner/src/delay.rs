//! Poles of a loop with delay `T`, all of those that count.
//!
//! There are infinitely many. Those right of [`DelaySystem::echo_line`], `-2 / T`, count: what fades to less than a seventh
//! within one delay is an echo of the delay and no motion of the machine, while far to the left the damping *ratio* of the
//! chain of roots that every delay has creeps towards 0 however fast they decay. Every pole right of the line is found, and
//! they are counted; where they cannot be, there is no answer. If nothing at all is right of the line, it moves left.

use linear::{DelayError, DelaySystem, Roots};
use nalgebra::DMatrix;
use rotor::{C64, ControlRow, Quadratic};

/// How often the line moves left, to twice as far, until there is a pole right of it.
const MOVES: usize = 4;

/// The rotor `open` with its control off, closed through `row` after `delay`.
///
/// # Errors
/// Coefficients that are not finite.
pub(crate) fn late(open: &Quadratic, row: &ControlRow, delay: f64) -> Result<DelaySystem, DelayError> {
    let n = open.masses();
    let mut rows = vec![C64::ZERO; 4 * n * n];
    open.state_rows(&mut rows);
    let a = DMatrix::from_row_slice(2 * n, 2 * n, &rows);
    let mut b = DMatrix::zeros(2 * n, 1);
    b[n + row.bearing] = C64::ONE;
    let gain = |k: usize| if k < n { -row.displacement[k] } else { -row.velocity[k - n] };
    DelaySystem::new(a, b, DMatrix::from_fn(1, 2 * n, |_, k| gain(k)), delay)
}

/// All poles of `system` that count, at least one; `near` are poles of a loop that was a little different, or none.
///
/// # Errors
/// Where they cannot all be found.
pub(crate) fn poles(system: &DelaySystem, near: &[C64]) -> Result<Roots, DelayError> {
    let mut line = system.echo_line();
    let mut found = system.roots_from(line, near)?;
    for _ in 0..MOVES {
        if !found.roots.is_empty() {
            break;
        }
        line *= 2.0;
        found = system.roots_from(line, near)?;
    }
    Ok(found)
}
