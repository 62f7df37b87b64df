//! What a plant is put together of, and where and how it is looked at.

use nalgebra::DVector;

use crate::C64;

/// Where a plant is looked at by linear analysis.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct OperatingPoint {
    /// Spin speed `R`.
    pub speed: f64,
    /// The share of its stiffness that each contact has, 0 to 1; those that are missing have all of it, but touchdown bearings none.
    pub contact_factors: Vec<f64>,
}

impl OperatingPoint {
    /// Every contact at its full stiffness.
    #[must_use]
    pub fn at(speed: f64) -> Self {
        Self { speed, contact_factors: vec![] }
    }
}

/// How the spin drives a plant in one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// Spin speed `R`.
    pub speed: f64,
    /// Its rate of change `R'`.
    pub acceleration: f64,
    /// `exp(j theta)`, with `theta` the angle of spin.
    pub direction: C64,
}

/// A row or a column over the coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Direction {
    /// One coordinate, with weight 1.
    Unit(usize),
    /// A weight for every coordinate.
    Dense(Vec<C64>),
}

impl Direction {
    /// What it reads of coordinates.
    #[inline]
    #[must_use]
    pub fn read(&self, q: &[C64]) -> C64 {
        match self {
            Self::Unit(i) => q[*i],
            Self::Dense(weights) => weights.iter().zip(q).map(|(w, q)| w * q).sum(),
        }
    }

    /// Adds `amount` along it.
    #[inline]
    pub fn add(&self, amount: C64, to: &mut [C64]) {
        match self {
            Self::Unit(i) => to[*i] += amount,
            Self::Dense(weights) => to.iter_mut().zip(weights).for_each(|(to, w)| *to += w * amount),
        }
    }

    /// Itself in full.
    #[must_use]
    pub fn dense(&self, order: usize) -> DVector<C64> {
        let mut whole = DVector::zeros(order);
        match self {
            Self::Unit(i) => whole[*i] = C64::ONE,
            Self::Dense(weights) => whole.iter_mut().zip(weights).for_each(|(to, w)| *to = *w),
        }
        whole
    }
}

/// A named place at which displacement is read.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Its name: `mass 1`, `left bearing`.
    pub name: String,
    /// What reads its displacement.
    pub row: Direction,
}

/// A support bearing with a clearance.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// The station whose displacement presses on it, counted from 0.
    pub station: usize,
    /// What it does to the coordinates, per unit of force; of the plant's inverse mass matrix too.
    pub column: Direction,
    /// Its stiffness.
    pub stiffness: f64,
    /// Whether it is there for the worst alone, and out of what linear analysis looks at.
    pub is_touchdown: bool,
}

/// What holds the rotor with coefficients that change with speed: `-(k r + d r')` along its column, where `r` is what its row reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// What reads the displacement.
    pub row: Direction,
    /// What its force does to the coordinates; of the plant's inverse mass matrix too.
    pub column: Direction,
    /// Rising speeds with `[k, d]` at each: between them linear, beyond them the same. At least one.
    pub table: Vec<(f64, [C64; 2])>,
}

impl Tabulated {
    /// `[k, d]` at a speed.
    #[must_use]
    pub fn at(&self, speed: f64) -> [C64; 2] {
        let after = self.table.partition_point(|(s, _)| *s <= speed);
        match (after.checked_sub(1).map(|k| self.table[k]), self.table.get(after).copied()) {
            (Some((s0, a)), Some((s1, b))) => {
                let part = (speed - s0) / (s1 - s0);
                [0, 1].map(|k| a[k] + (b[k] - a[k]) * part)
            }
            (Some((_, values)), None) | (None, Some((_, values))) => values,
            (None, None) => [C64::ZERO; 2],
        }
    }
}
