//! A machine as matrices, at one speed: plant, sensors, law and actuator joined, with the delay kept apart because no matrix
//! has it.
//!
//! ```text
//! x' = a x + b w(t - delay),   r = readings x,   w = law of r
//! ```
//!
//! `x` holds displacements, velocities, states of the sensors and of the actuator. The law is continuous, or acts at samples
//! and holds. Noise, resolution and limits are left out, clearances count as the factors of the operating point.

use control::{Feedback, FeedbackError, Law, LinearLoop};
use nalgebra::DMatrix;

use crate::{C64, OperatingPoint, Plant};

/// A machine at one operating point as matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearForm {
    /// How many coordinates the plant has: `x` begins with them and their rates.
    pub coordinates: usize,
    /// States on states, the loop open.
    pub a: DMatrix<C64>,
    /// The command on states, one column.
    pub b: DMatrix<C64>,
    /// States on what the sensors read: displacement of each, then velocity.
    pub readings: DMatrix<C64>,
    /// The law.
    pub law: Law,
    /// Delay of the command.
    pub delay: f64,
    /// Sampling period; 0 is a continuous law.
    pub sample: f64,
}

/// The step from one sample to the next, `x <- a x`, and the same with the loop open at the command, `x <- open x + b w`,
/// `w = c x`.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledStep {
    /// The step.
    pub a: DMatrix<C64>,
    /// The step without the command at this sample.
    pub open: DMatrix<C64>,
    /// What the command at this sample does, one column.
    pub b: DMatrix<C64>,
    /// The command, one row.
    pub c: DMatrix<C64>,
    /// Sampling period.
    pub period: f64,
}

impl LinearForm {
    /// Joins a plant and the loop of its feedback.
    ///
    /// # Errors
    /// Feedback that does not fit the plant.
    pub fn of(plant: &Plant, feedback: &Feedback, at: &OperatingPoint) -> Result<Self, FeedbackError> {
        let stations = plant.stations().len();
        let around = LinearLoop::new(feedback, stations, at.speed)?;
        let missing = FeedbackError::Bearing { found: feedback.bearing + 1, masses: stations };
        Self::joined(plant, feedback.bearing, &around, at).ok_or(missing)
    }

    /// Joins a plant and a loop that drives its control bearing `bearing`; `None` if there is no such bearing.
    #[must_use]
    pub fn joined(plant: &Plant, bearing: usize, around: &LinearLoop, at: &OperatingPoint) -> Option<Self> {
        let LinearLoop { sensors, sensor_lag, sample, law, delay, actuator: [fa, fb, fc, fd] } = around;
        let (sensor_lag, sample, delay) = (*sensor_lag, *sample, *delay);
        let column = plant.column(bearing)?;
        let [damping, stiffness] = plant.linear(at);
        let (n, m) = (plant.order(), sensors.len());
        let lagging = if sensor_lag > 0.0 { 2 * m } else { 0 };
        let (first_sensor, first_actuator) = (2 * n, 2 * n + lagging);
        let width = first_actuator + fa.nrows();

        let mut a = DMatrix::zeros(width, width);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, n)).copy_from(&stiffness);
        a.view_mut((n, n), (n, n)).copy_from(&damping);
        let mut readings = DMatrix::zeros(2 * m, width);
        for (k, station) in sensors.iter().enumerate() {
            let row = plant.stations()[*station].row.dense(n).transpose();
            for (reading, first) in [(k, 0), (m + k, n)] {
                if lagging > 0 {
                    let state = first_sensor + reading;
                    a.view_mut((state, first), (1, n)).copy_from(&(&row / C64::from(sensor_lag)));
                    a[(state, state)] = C64::from(-1.0 / sensor_lag);
                    readings[(reading, state)] = C64::ONE;
                } else {
                    readings.view_mut((reading, first), (1, n)).copy_from(&row);
                }
            }
        }
        let column = DMatrix::from_column_slice(n, 1, column.dense(n).as_slice());
        let order = fa.nrows();
        a.view_mut((first_actuator, first_actuator), (order, order)).copy_from(fa);
        a.view_mut((n, first_actuator), (n, order)).copy_from(&(&column * fc));
        let mut b = DMatrix::zeros(width, 1);
        b.view_mut((n, 0), (n, 1)).copy_from(&(&column * fd));
        b.view_mut((first_actuator, 0), (order, 1)).copy_from(fb);
        Some(Self { coordinates: n, a, b, readings, law: law.clone(), delay, sample })
    }

    /// `A`, `B` and `C` of `x' = A x + B C x(t - delay)`, the states of a continuous law among `x`; `None` if it is sampled.
    #[must_use]
    pub fn continuous(&self) -> Option<[DMatrix<C64>; 3]> {
        if self.sample > 0.0 {
            return None;
        }
        let (n, m) = (self.a.nrows(), self.law.a.nrows());
        let mut a = DMatrix::zeros(n + m, n + m);
        a.view_mut((0, 0), (n, n)).copy_from(&self.a);
        a.view_mut((n, 0), (m, n)).copy_from(&(&self.law.b * &self.readings));
        a.view_mut((n, n), (m, m)).copy_from(&self.law.a);
        let mut b = DMatrix::zeros(n + m, 1);
        b.view_mut((0, 0), (n, 1)).copy_from(&self.b);
        let mut c = DMatrix::zeros(1, n + m);
        c.view_mut((0, 0), (1, n)).copy_from(&(&self.law.d * &self.readings));
        c.view_mut((0, n), (1, m)).copy_from(&self.law.c);
        Some([a, b, c])
    }

    /// The state matrix of an immediate, continuous loop; `None` if it is sampled or late.
    #[must_use]
    pub fn immediate(&self) -> Option<DMatrix<C64>> {
        let [a, b, c] = self.continuous().filter(|_| self.delay == 0.0)?;
        Some(a + b * c)
    }

    /// From one sample to the next, with the delay split exactly: whole periods are remembered commands, and the rest is the
    /// share of a period over which the older of two commands still acts. `None` for a continuous law.
    ///
    /// The state is `x`, the law's, and the commands under way, the latest first.
    #[must_use]
    pub fn sampled(&self) -> Option<SampledStep> {
        let period = self.sample;
        if period <= 0.0 {
            return None;
        }
        let (n, m) = (self.a.nrows(), self.law.a.nrows());
        let mut whole = (self.delay / period).floor();
        let mut rest = self.delay - whole * period;
        // A delay of whole periods but for rounding.
        if period - rest <= 1e-9 * period {
            (whole, rest) = (whole + 1.0, 0.0);
        } else if rest <= 1e-9 * period {
            rest = 0.0;
        }
        let whole = whole as usize;
        let under_way = whole + usize::from(rest > 0.0);
        let width = n + m + under_way;
        let (free, newer) = held(&self.a, &self.b, period - rest);
        let (before, older) = held(&self.a, &self.b, rest);

        let mut step = DMatrix::zeros(width, width);
        // The command at this sample, from the state at it.
        let mut command = DMatrix::zeros(1, width);
        command.view_mut((0, 0), (1, n)).copy_from(&(&self.law.d * &self.readings));
        command.view_mut((0, n), (1, m)).copy_from(&self.law.c);
        let mut b = DMatrix::zeros(width, 1);
        let mut add = |age: usize, effect: &DMatrix<C64>| {
            if age == 0 {
                let mut rows = b.view_mut((0, 0), (n, 1));
                rows += effect;
            } else {
                let mut rows = step.view_mut((0, n + m + age - 1), (n, 1));
                rows += effect;
            }
        };
        add(whole, &newer);
        if rest > 0.0 {
            add(whole + 1, &(&free * older));
        }
        let mut states = step.view_mut((0, 0), (n, n));
        states += free * before;
        step.view_mut((n, 0), (m, n)).copy_from(&(&self.law.b * &self.readings));
        step.view_mut((n, n), (m, m)).copy_from(&self.law.a);
        if under_way > 0 {
            b[n + m] = C64::ONE;
            for age in 1..under_way {
                step[(n + m + age, n + m + age - 1)] = C64::ONE;
            }
        }
        Some(SampledStep { a: &step + &b * &command, open: step, b, c: command, period })
    }
}

/// `exp(a t)` and what a command held over `t` adds, by one exponential of both.
fn held(a: &DMatrix<C64>, b: &DMatrix<C64>, t: f64) -> (DMatrix<C64>, DMatrix<C64>) {
    let n = a.nrows();
    let mut joined = DMatrix::zeros(n + 1, n + 1);
    joined.view_mut((0, 0), (n, n)).copy_from(&(a * C64::from(t)));
    joined.view_mut((0, n), (n, 1)).copy_from(&(b * C64::from(t)));
    let grown = joined.exp();
    (grown.view((0, 0), (n, n)).into_owned(), grown.view((0, n), (n, 1)).into_owned())
}
