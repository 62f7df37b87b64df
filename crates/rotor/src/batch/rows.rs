//! What a batch holds: rows of one number a trajectory.

/// Rows of one mass.
pub(super) const DAMPING: [usize; 2] = [0, 1];
/// What is linear in the mass's own displacement, the support bearing without clearance; and cross-coupled.
pub(super) const STIFFNESS: [usize; 2] = [2, 3];
pub(super) const LEFT: usize = 4;
pub(super) const RIGHT: usize = 5;
/// By what the clearance lessens the stiffness inside of it: all of the support bearing's, or nothing where there is none.
pub(super) const INSIDE: usize = 6;
/// The same outside, times the radius.
pub(super) const DEADBAND_FORCE: usize = 7;
pub(super) const EDGE_SQUARED: usize = 8;
pub(super) const UNBALANCE: usize = 9;
pub(super) const CONTROLLED: usize = 10;
pub(super) const GAIN_P: [usize; 2] = [11, 12];
pub(super) const GAIN_V: [usize; 2] = [13, 14];
pub(super) const P: [usize; 2] = [15, 16];
pub(super) const V: [usize; 2] = [17, 18];
/// Displacement and velocity at the last sample, before the step that followed it.
pub(super) const BEFORE: [usize; 4] = [19, 20, 21, 22];
pub(super) const RADIUS_SUM: usize = 23;
pub(super) const OF_A_MASS: usize = 24;

/// Rows of all, after those of the masses.
pub(super) const DTAU: usize = 0;
pub(super) const PHASOR: [usize; 2] = [1, 2];
pub(super) const HALF_TURN: [usize; 2] = [3, 4];
pub(super) const LIMIT_SQUARED: usize = 5;
pub(super) const OF_ALL: usize = 6;

/// Samples of a signal that are kept, four of them at least: a power of two.
pub(super) const KEPT: usize = 8;

/// Rows of numbers, one a trajectory each.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    pub(super) masses: usize,
    pub(super) width: usize,
    numbers: Vec<f64>,
    /// From where in `numbers` on the rows are, so that they begin where lines of the cache do.
    from: usize,
}

impl Rows {
    pub(super) fn new(masses: usize, width: usize) -> Self {
        let rows = masses * OF_A_MASS + OF_ALL + (masses + 1) * (KEPT + 1);
        let numbers = vec![0.0; rows * width + 8];
        let from = numbers.as_ptr().align_offset(64).min(8);
        Self { masses, width, numbers, from }
    }

    /// A row of mass `mass`.
    #[inline(always)]
    pub(super) fn mass(mass: usize, row: usize) -> usize {
        mass * OF_A_MASS + row
    }

    /// A row of all.
    #[inline(always)]
    pub(super) fn common(&self, row: usize) -> usize {
        self.masses * OF_A_MASS + row
    }

    /// The largest of signal `signal`: 0 is `|u|^2`, then `|p|^2` of every mass.
    #[inline(always)]
    pub(super) fn maximum(&self, signal: usize) -> usize {
        self.common(OF_ALL) + signal
    }

    /// The signals of a sample, by its number.
    #[inline(always)]
    pub(super) fn sample(&self, number: usize) -> usize {
        self.maximum(self.masses + 1) + (number & (KEPT - 1)) * (self.masses + 1)
    }

    #[inline(always)]
    pub(super) fn all(&self) -> &[f64] {
        &self.numbers[self.from..]
    }

    #[inline(always)]
    pub(super) fn all_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[self.from..]
    }

    pub(super) fn get(&self, row: usize, lane: usize) -> f64 {
        self.all()[row * self.width + lane]
    }

    pub(super) fn set(&mut self, row: usize, lane: usize, number: f64) {
        let at = row * self.width + lane;
        self.all_mut()[at] = number;
    }

    /// Whether a row of a mass is anything but zero.
    pub(super) fn is_used(&self, mass: usize, row: usize) -> bool {
        let at = Self::mass(mass, row) * self.width;
        self.all()[at..at + self.width].iter().any(|number| *number != 0.0)
    }
}
