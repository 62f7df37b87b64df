//! A loop as matrices, at one spin speed: what poles and margins are made of.

use nalgebra::DMatrix;

use crate::block::Sampled;
use crate::{C64, Controller, Feedback, FeedbackError, Parts};

/// The law of a loop: `z' = a z + b r` (or `z <- a z + b r` at every sample), `w = c z + d r`, with `r` the readings of
/// displacement at every sensor and then those of velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// States on states.
    pub a: DMatrix<C64>,
    /// Readings on states.
    pub b: DMatrix<C64>,
    /// States on the command.
    pub c: DMatrix<C64>,
    /// Readings on the command.
    pub d: DMatrix<C64>,
}

/// A loop without noise, resolution and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearLoop {
    /// The stations it senses, counted from 0.
    pub sensors: Vec<usize>,
    /// Time constant of every sensor; 0 is none.
    pub sensor_lag: f64,
    /// Sampling period; 0 is a continuous law.
    pub sample: f64,
    /// The law.
    pub law: Law,
    /// Delay of the command.
    pub delay: f64,
    /// The actuator, `y' = a y + b w`, `u = c y + d w`: `[a, b, c, d]`.
    pub actuator: [DMatrix<C64>; 4],
}

impl LinearLoop {
    /// The loop of `feedback` on a plant of so many stations, at a spin speed.
    ///
    /// # Errors
    /// Feedback that does not fit.
    pub fn new(feedback: &Feedback, stations: usize, speed: f64) -> Result<Self, FeedbackError> {
        feedback.check(stations)?;
        Ok(Controller::with_room(feedback, stations, speed, 1, 0.0).linear(speed))
    }

    pub(crate) fn of<'a>(
        parts: &Parts,
        sensors: &[usize],
        rows: impl Iterator<Item = (&'a [f64], &'a [f64], [C64; 2], &'a [Sampled])>,
        bearing: &[Sampled],
        speed: f64,
    ) -> Self {
        let inputs = 2 * sensors.len();
        let is_sampled = parts.sample > 0.0;
        let through = |law: Law, blocks: &[Sampled]| {
            blocks.iter().fold(law, |law, block| {
                let (a, b, c, d) = if is_sampled { block.matrices() } else { block.block.matrices(speed) };
                law.then(&a, &b, &c, d)
            })
        };
        let mut sum = Law::direct(DMatrix::zeros(1, inputs));
        for (displacement, velocity, gains, blocks) in rows {
            let weights = displacement.iter().map(|w| -gains[0] * *w).chain(velocity.iter().map(|w| -gains[1] * *w));
            sum = sum.beside(through(Law::direct(DMatrix::from_row_iterator(1, inputs, weights)), blocks));
        }
        Self {
            sensors: sensors.to_vec(),
            sensor_lag: parts.sensor_lag,
            sample: parts.sample,
            law: through(sum, bearing),
            delay: parts.delay,
            actuator: actuator(parts),
        }
    }
}

fn actuator(parts: &Parts) -> [DMatrix<C64>; 4] {
    let of = |rows: usize, columns: usize, numbers: &[f64]| {
        DMatrix::from_row_iterator(rows, columns, numbers.iter().map(|x| C64::from(*x)))
    };
    let Parts { lag, lag_damping, .. } = *parts;
    let rate = 1.0 / lag;
    match (lag > 0.0, lag_damping > 0.0) {
        (false, _) => [of(0, 0, &[]), of(0, 1, &[]), of(1, 0, &[]), of(1, 1, &[1.0])],
        (true, false) => [of(1, 1, &[-rate]), of(1, 1, &[rate]), of(1, 1, &[1.0]), of(1, 1, &[0.0])],
        (true, true) => [
            of(2, 2, &[0.0, rate, -rate, -2.0 * lag_damping * rate]),
            of(2, 1, &[0.0, rate]),
            of(1, 2, &[1.0, 0.0]),
            of(1, 1, &[0.0]),
        ],
    }
}

impl Law {
    /// Gains alone.
    fn direct(d: DMatrix<C64>) -> Self {
        let inputs = d.ncols();
        Self { a: DMatrix::zeros(0, 0), b: DMatrix::zeros(0, inputs), c: DMatrix::zeros(1, 0), d }
    }

    /// Its command through a filter.
    fn then(self, a: &DMatrix<C64>, b: &DMatrix<C64>, c: &DMatrix<C64>, d: C64) -> Self {
        let (n, m) = (self.a.nrows(), a.nrows());
        let mut joined = DMatrix::zeros(n + m, n + m);
        joined.view_mut((0, 0), (n, n)).copy_from(&self.a);
        joined.view_mut((n, 0), (m, n)).copy_from(&(b * &self.c));
        joined.view_mut((n, n), (m, m)).copy_from(a);
        let mut input = DMatrix::zeros(n + m, self.b.ncols());
        input.view_mut((0, 0), (n, self.b.ncols())).copy_from(&self.b);
        input.view_mut((n, 0), (m, self.b.ncols())).copy_from(&(b * &self.d));
        let mut output = DMatrix::zeros(1, n + m);
        output.view_mut((0, 0), (1, n)).copy_from(&(&self.c * d));
        output.view_mut((0, n), (1, m)).copy_from(c);
        Self { a: joined, b: input, c: output, d: self.d * d }
    }

    /// The sum of two laws on the same readings.
    fn beside(self, other: Self) -> Self {
        let (n, m) = (self.a.nrows(), other.a.nrows());
        let mut a = DMatrix::zeros(n + m, n + m);
        a.view_mut((0, 0), (n, n)).copy_from(&self.a);
        a.view_mut((n, n), (m, m)).copy_from(&other.a);
        let mut b = DMatrix::zeros(n + m, self.b.ncols());
        b.view_mut((0, 0), (n, self.b.ncols())).copy_from(&self.b);
        b.view_mut((n, 0), (m, self.b.ncols())).copy_from(&other.b);
        let mut c = DMatrix::zeros(1, n + m);
        c.view_mut((0, 0), (1, n)).copy_from(&self.c);
        c.view_mut((0, n), (1, m)).copy_from(&other.c);
        Self { a, b, c, d: self.d + other.d }
    }
}
