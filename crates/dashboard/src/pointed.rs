//! What a person points at beside a moment of time. All panels show the same.

use rotor::C64;

/// What is pointed at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pointed {
    /// The plot whose scale keys change, by its row in the table of panels.
    pub(crate) plot: Option<usize>,
    /// The pole of a mode.
    pub(crate) mode: Option<C64>,
    /// A frequency of whirl, in units of `w0`; backward is negative.
    pub(crate) frequency: Option<f64>,
    /// A spin speed, in units of `w0`.
    pub(crate) speed: Option<f64>,
}

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Point {
    Mode(C64),
    Frequency(f64),
    Speed(f64),
}

impl Pointed {
    /// Points at something; at the same again, at nothing of that kind.
    pub(crate) fn at(&mut self, point: Point) {
        let is_there = match point {
            Point::Mode(pole) => self.mode == Some(pole),
            Point::Frequency(frequency) => self.frequency == Some(frequency),
            Point::Speed(speed) => self.speed == Some(speed),
        };
        self.put(point, !is_there);
    }

    /// Points at something, or at nothing of that kind.
    pub(crate) fn put(&mut self, point: Point, at_it: bool) {
        match point {
            Point::Mode(pole) => self.mode = at_it.then_some(pole),
            Point::Frequency(frequency) => self.frequency = at_it.then_some(frequency),
            Point::Speed(speed) => self.speed = at_it.then_some(speed),
        }
    }

    /// Follows a mode to where its pole is now: to the nearest of `poles`.
    pub(crate) fn follow(&mut self, poles: &[C64]) {
        let Some(before) = self.mode else { return };
        let far = |pole: &&C64| (*pole - before).norm();
        if let Some(nearest) = poles.iter().min_by(|a, b| far(a).total_cmp(&far(b))) {
            self.mode = Some(*nearest);
        }
    }

    /// Points at nothing. Returns whether that is news.
    pub(crate) fn clear(&mut self) -> bool {
        std::mem::take(self) != Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_followed_and_the_same_again_is_nothing() {
        let mut pointed = Pointed::default();
        pointed.at(Point::Mode(C64::new(-0.1, 2.0)));
        pointed.follow(&[C64::new(-0.2, -2.0), C64::new(-0.15, 2.1)]);
        assert_eq!(pointed.mode, Some(C64::new(-0.15, 2.1)));
        pointed.follow(&[]);
        pointed.at(Point::Mode(C64::new(-0.15, 2.1)));
        assert_eq!(pointed.mode, None);
        pointed.at(Point::Speed(2.0));
        pointed.at(Point::Frequency(-1.0));
        assert_eq!((pointed.speed, pointed.frequency), (Some(2.0), Some(-1.0)));
        assert!(pointed.clear() && !pointed.clear());
    }
}
