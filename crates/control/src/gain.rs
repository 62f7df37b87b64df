//! Gains of a signal: each a number, or a function of spin speed.

/// A gain over spin speed `R`.
#[derive(Clone, Debug, PartialEq)]
pub enum Gain {
    /// The same at every speed.
    Constant(f64),
    /// `at_zero + slope R`: the report's cancelling law (3.40) is `kc = zeta R0 - zeta R`.
    Linear {
        /// Value at `R = 0`.
        at_zero: f64,
        /// Change per unit of speed.
        slope: f64,
    },
    /// Piecewise linear through `(speed, value)` points, held constant beyond its ends: the report's Fig. 4.7.
    Table(Vec<(f64, f64)>),
}

impl Gain {
    /// The gain at spin speed `speed`.
    #[must_use]
    pub fn at(&self, speed: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Linear { at_zero, slope } => at_zero + slope * speed,
            Self::Table(points) => interpolate(points, speed),
        }
    }

    /// How fast it changes with speed at `speed`: of a table, over the piece that begins there or before.
    #[must_use]
    pub fn slope_at(&self, speed: f64) -> f64 {
        match self {
            Self::Constant(_) => 0.0,
            Self::Linear { slope, .. } => *slope,
            Self::Table(points) => {
                let after = points.partition_point(|&(s, _)| s <= speed);
                match (after.checked_sub(1).map(|i| points[i]), points.get(after)) {
                    (Some((s0, v0)), Some(&(s1, v1))) => (v1 - v0) / (s1 - s0),
                    _ => 0.0,
                }
            }
        }
    }

    /// The speeds of the points of a table, rising; none of another gain.
    pub fn corner_speeds(&self) -> impl Iterator<Item = f64> + '_ {
        let points = if let Self::Table(points) = self { points.as_slice() } else { &[] };
        points.iter().map(|&(speed, _)| speed)
    }

    /// The same gain raised by `delta` at every speed, so that a schedule keeps its shape when it is nudged.
    #[must_use]
    pub fn shifted(&self, delta: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value + delta),
            Self::Linear { at_zero, slope } => Self::Linear { at_zero: at_zero + delta, slope: *slope },
            Self::Table(points) => Self::Table(points.iter().map(|&(s, v)| (s, v + delta)).collect()),
        }
    }

    /// The same times `factor` at every speed.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value * factor),
            Self::Linear { at_zero, slope } => Self::Linear { at_zero: at_zero * factor, slope: slope * factor },
            Self::Table(points) => Self::Table(points.iter().map(|&(s, v)| (s, v * factor)).collect()),
        }
    }

    /// All numbers in it are finite, and a table has points of strictly rising speed.
    pub(crate) fn is_sound(&self) -> bool {
        match self {
            Self::Constant(value) => value.is_finite(),
            Self::Linear { at_zero, slope } => at_zero.is_finite() && slope.is_finite(),
            Self::Table(points) => {
                !points.is_empty()
                    && points.iter().all(|(s, v)| s.is_finite() && v.is_finite())
                    && points.windows(2).all(|w| w[0].0 < w[1].0)
            }
        }
    }
}

fn interpolate(points: &[(f64, f64)], speed: f64) -> f64 {
    let after = points.partition_point(|&(s, _)| s <= speed);
    match (after.checked_sub(1).map(|i| points[i]), points.get(after)) {
        (Some((s0, v0)), Some(&(s1, v1))) => v0 + (v1 - v0) * (speed - s0) / (s1 - s0),
        (Some((_, v)), None) | (None, Some(&(_, v))) => v,
        (None, None) => 0.0,
    }
}

/// Which of the four gains of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GainKind {
    /// Direct stiffness `kd` (the report's g11).
    Kd,
    /// Direct damping `cd` (g13 in chapter III, g12 in chapter IV).
    Cd,
    /// Cross-coupled stiffness `kc` (g12 in chapter III, g13 in chapter IV).
    Kc,
    /// Cross-coupled damping `cc` (g14).
    Cc,
}

impl GainKind {
    /// All four, in the order `kd cd kc cc`.
    pub const ALL: [Self; 4] = [Self::Kd, Self::Cd, Self::Kc, Self::Cc];

    /// Its name in files, commands and panels.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Kd => "kd",
            Self::Cd => "cd",
            Self::Kc => "kc",
            Self::Cc => "cc",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_interpolates_and_holds_its_ends() {
        let gain = Gain::Table(vec![(0.0, 1.0), (2.0, 3.0), (7.0, -2.0)]);
        for (speed, value) in [(-1.0, 1.0), (0.0, 1.0), (1.0, 2.0), (2.0, 3.0), (4.5, 0.5), (7.0, -2.0), (9.0, -2.0)] {
            assert_eq!(gain.at(speed), value, "at {speed}");
        }
        assert_eq!(gain.shifted(0.5).at(1.0), 2.5);
    }
}
