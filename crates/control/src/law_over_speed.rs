//! A law over spin speed: between two corners of its gains' tables it is a straight line, so that it can be followed through a
//! changing speed without looking anything up.

use crate::{ControlBearing, ControlRow, Gain};

/// A stretch of speeds over which a law is a straight line: `row + slope (R - base)` for `R` in `from..until`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawPiece {
    /// The least speed of it.
    pub from: f64,
    /// The speed from which on it no longer holds; infinite for the last.
    pub until: f64,
    /// The speed of `row`.
    pub base: f64,
    /// The law there.
    pub row: ControlRow,
    /// How it changes per unit of speed.
    pub slope: ControlRow,
}

/// The law of a control bearing at every speed, without filters.
#[derive(Clone, Debug, PartialEq)]
pub struct LawOverSpeed {
    /// All speeds, without gaps, rising; at least one piece.
    pieces: Vec<LawPiece>,
    is_constant: bool,
}

impl LawOverSpeed {
    /// That of a bearing whose gains are in order.
    #[must_use]
    pub fn of(bearing: &ControlBearing) -> Self {
        let corners = bearing.corner_speeds();
        let from = std::iter::once(f64::NEG_INFINITY).chain(corners.iter().copied());
        let until = corners.iter().copied().chain([f64::INFINITY]);
        let piece = |(from, until): (f64, f64)| {
            // Before the first corner any speed there would do.
            let (base, within) = if from.is_finite() { (from, from) } else { (until.min(0.0), until.min(0.0) - 1.0) };
            LawPiece { from, until, base, row: bearing.at(base), slope: bearing.row(|gain| gain.slope_at(within)) }
        };
        Self {
            pieces: from.zip(until).map(piece).collect(),
            is_constant: bearing
                .signals
                .iter()
                .flat_map(|signal| &signal.gains)
                .all(|gain| matches!(gain, Gain::Constant(_))),
        }
    }

    /// Whether it is the same at every speed.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.is_constant
    }

    /// The piece that holds at a speed.
    #[must_use]
    pub fn piece(&self, speed: f64) -> &LawPiece {
        let after = self.pieces.partition_point(|piece| piece.until <= speed);
        &self.pieces[after.min(self.pieces.len() - 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{C64, GainKind, Signal};

    #[test]
    fn pieces_are_the_law_at_every_speed() {
        let mut bearing = ControlBearing::new(
            1,
            vec![Signal::composite(&[1.0, 2.0], [0.3, 0.5, -0.5, 0.6]), Signal::at_mass(1, 2, [0.1; 4])],
        );
        assert!(LawOverSpeed::of(&bearing).is_constant());
        *bearing.signals[0].gain_mut(GainKind::Kc) = Gain::Linear { at_zero: 0.2, slope: -0.5 };
        *bearing.signals[0].gain_mut(GainKind::Kd) = Gain::Table(vec![(1.0, 0.1), (2.0, 0.3), (7.0, 0.2)]);
        *bearing.signals[1].gain_mut(GainKind::Cc) = Gain::Table(vec![(-3.0, 0.7), (2.0, -0.3), (4.0, 9.0)]);
        let law = LawOverSpeed::of(&bearing);
        assert!(!law.is_constant());
        for k in -50..100 {
            let speed = f64::from(k) * 0.1;
            let LawPiece { from, until, base, row, slope } = *law.piece(speed);
            assert!(from <= speed && speed < until, "{from} {speed} {until}");
            let expected = bearing.at(speed);
            let near = |a: &[C64], b: &[C64], c: &[C64]| {
                let off = |((a, b), c): ((&C64, &C64), &C64)| (a + b * (speed - base) - c).norm();
                a.iter().zip(b).zip(c).map(off).fold(0.0, f64::max)
            };
            let off = near(&row.displacement, &slope.displacement, &expected.displacement).max(near(
                &row.velocity,
                &slope.velocity,
                &expected.velocity,
            ));
            assert!(off < 1e-14, "{speed}: {off:e}");
            assert_eq!(row.bearing, 1);
        }
    }
}
