//! Maxima of a batch between its samples, where a register has found that there may be one.

use crate::peak::{is_peak, summit};

/// Raises the maxima in row `maximum` to the peaks that five samples of a signal, oldest first, have in any trajectory.
#[cold]
#[inline(never)]
pub(super) fn raise(rows: &mut [f64], width: usize, samples: [usize; 5], maximum: usize) {
    for lane in 0..width {
        let five = samples.map(|row| rows[row * width + lane]);
        let largest = rows[maximum * width + lane];
        if is_peak([five[1], five[2], five[3]], largest) {
            rows[maximum * width + lane] = largest.max(summit(five));
        }
    }
}
