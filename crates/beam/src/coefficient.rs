//! Coefficients of bearings and seals, constant or over spin speed.

use std::f64::consts::PI;

/// Radians per second in one revolution per minute.
pub(crate) const RAD_PER_S: f64 = PI / 30.0;

/// A coefficient of a bearing or seal.
#[derive(Clone, Debug, PartialEq)]
pub enum Coefficient {
    /// The same at every speed.
    Constant(f64),
    /// Spin speeds in **rpm**, rising, and the value at each: linear in between, held beyond both ends. The speeds stay in the
    /// unit of the file, because a number that is converted and back need not be the same to the last bit.
    Table(Vec<(f64, f64)>),
}

impl Coefficient {
    /// Nothing at any speed.
    pub const ZERO: Self = Self::Constant(0.0);

    /// The value at the spin speed `speed` in rad/s; which way it spins makes no difference.
    ///
    /// ```
    /// use beam::Coefficient;
    /// let table = Coefficient::Table(vec![(0.0, 1e6), (3000.0, 2e6)]);
    /// let rpm = std::f64::consts::PI / 30.0;
    /// assert_eq!([-3000.0, 0.0, 1500.0, 9000.0].map(|n| table.at(n * rpm)), [2e6, 1e6, 1.5e6, 2e6]);
    /// ```
    #[must_use]
    pub fn at(&self, speed: f64) -> f64 {
        let points = match self {
            Self::Constant(value) => return *value,
            Self::Table(points) => points,
        };
        let rpm = speed.abs() / RAD_PER_S;
        let after = points.partition_point(|&(at, _)| at <= rpm);
        match (points.get(after.wrapping_sub(1)), points.get(after)) {
            (Some(&(from, low)), Some(&(to, high))) => low + (high - low) * ((rpm - from) / (to - from)),
            (Some(&(_, value)), None) | (None, Some(&(_, value))) => value,
            (None, None) => 0.0,
        }
    }

    /// Whether it is 0 at every speed.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.values().all(|value| value == 0.0)
    }

    /// The spin speeds of the table, in rad/s; none of what is constant.
    pub fn speeds(&self) -> impl Iterator<Item = f64> + '_ {
        let table = if let Self::Table(points) = self { points.as_slice() } else { &[] };
        table.iter().map(|&(rpm, _)| rpm * RAD_PER_S)
    }

    /// The value, or all of the table.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let (one, table) = match self {
            Self::Constant(value) => (Some(*value), &[][..]),
            Self::Table(points) => (None, points.as_slice()),
        };
        one.into_iter().chain(table.iter().map(|&(_, value)| value))
    }
}

impl Default for Coefficient {
    fn default() -> Self {
        Self::ZERO
    }
}

impl From<f64> for Coefficient {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}
