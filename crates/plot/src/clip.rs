//! Lines cut at the edges of a frame.
//!
//! Not left to a clip path of SVG: what is far outside would be written down all the same, in numbers that renderers, which
//! calculate in 32 bits, do not hold.

/// A frame: left, top, right and bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Frame {
    pub(super) fn has(&self, (x, y): (f64, f64)) -> bool {
        (self.left - 0.5..=self.right + 0.5).contains(&x) && (self.top - 0.5..=self.bottom + 0.5).contains(&y)
    }

    /// The parts of a line that are in the frame; points that are not finite break it.
    pub(super) fn cut(&self, line: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let mut parts: Vec<Vec<(f64, f64)>> = Vec::new();
        let mut joined = false;
        for pair in line.windows(2) {
            match self.segment(pair[0], pair[1]) {
                Some((from, to)) => {
                    match parts.last_mut().filter(|_| joined) {
                        Some(part) => part.push(to),
                        None => parts.push(vec![from, to]),
                    }
                    joined = to == pair[1];
                }
                None => joined = false,
            }
        }
        parts
    }

    /// The part of a segment in the frame, by Liang and Barsky.
    fn segment(&self, from: (f64, f64), to: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        if !(dx.is_finite() && dy.is_finite()) {
            return None;
        }
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (step, room) in
            [(-dx, from.0 - self.left), (dx, self.right - from.0), (-dy, from.1 - self.top), (dy, self.bottom - from.1)]
        {
            if step == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                enter = enter.max(room / step);
            } else {
                leave = leave.min(room / step);
            }
        }
        let at = |t: f64| (from.0 + t * dx, from.1 + t * dy);
        let end = if leave == 1.0 { to } else { at(leave) };
        (enter <= leave).then(|| (at(enter), end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_edges_and_broken_at_gaps() {
        let frame = Frame { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        let cut = frame.cut(&[(-5.0, 5.0), (5.0, 5.0), (5.0, 8.0), (5.0, 20.0), (8.0, 20.0), (8.0, 5.0)]);
        assert_eq!(cut, [vec![(0.0, 5.0), (5.0, 5.0), (5.0, 8.0), (5.0, 10.0)], vec![(8.0, 10.0), (8.0, 5.0)]]);
        assert_eq!(frame.cut(&[(1.0, 1.0), (f64::NAN, 2.0), (3.0, 3.0), (4.0, 3.0)]).len(), 1);
        assert!(frame.cut(&[(-1.0, -1.0), (-1.0, 20.0)]).is_empty());
    }
}
