//! A machine as matrices, at one speed: plant, sensors, law and actuator joined, with the delay kept apart because no matrix
//! has it.
//!
//! ```text
//! x' = a x + b w(t - delay),   r = readings x,   w = law of r
//! ```
//!
//! `x` holds displacements and velocities, then of every control bearing the states of its sensors and of its actuator; `w` has a
//! command for each. Laws are continuous, or act at samples and hold. Noise, resolution and limits are left out, clearances count as
//! the factors of the operating point.

use control::{Feedback, FeedbackError, Law, LinearLoop};
use nalgebra::DMatrix;

use crate::plant::Contact;
use crate::{C64, OperatingPoint, Plant};

/// A machine at one operating point as matrices.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearForm {
    /// How many coordinates the plant has: `x` begins with them and their rates.
    pub coordinates: usize,
    /// States on states, the loop open.
    pub a: DMatrix<C64>,
    /// The commands on states, a column a control bearing.
    pub b: DMatrix<C64>,
    /// States on what the sensors read: bearing by bearing, displacement of each, then velocity.
    pub readings: DMatrix<C64>,
    /// The laws of all bearings as one, a row of command each.
    pub law: Law,
    /// Delay of the commands.
    pub delay: f64,
    /// Sampling period; 0 is a continuous law.
    pub sample: f64,
    /// Displacements, of the coordinates, that the plant is known not to resist: poles at exactly 0 unless the loop does.
    pub free: Vec<Vec<C64>>,
}

/// The step from one sample to the next, `x <- a x`, and the same with the loop open at the command, `x <- open x + b w`,
/// `w = c x`.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledStep {
    /// The step.
    pub a: DMatrix<C64>,
    /// The step without the command at this sample.
    pub open: DMatrix<C64>,
    /// What the commands at this sample do, a column each.
    pub b: DMatrix<C64>,
    /// The commands, a row each.
    pub c: DMatrix<C64>,
    /// Sampling period.
    pub period: f64,
}

impl LinearForm {
    /// Joins a plant and the loops of its feedback.
    ///
    /// # Errors
    /// Feedback that does not fit the plant.
    pub fn of(plant: &Plant, feedback: &Feedback, at: &OperatingPoint) -> Result<Self, FeedbackError> {
        let stations = plant.stations().len();
        feedback.check(stations)?;
        let loops: Result<Vec<(usize, LinearLoop)>, FeedbackError> = (feedback.bearings.iter())
            .map(|bearing| Ok((bearing.station, LinearLoop::new(bearing, stations, at.speed)?)))
            .collect();
        let missing = FeedbackError::Bearing { found: feedback.first().station + 1, masses: stations };
        Self::joined(plant, &loops?, at).ok_or(missing)
    }

    /// Joins a plant and loops, each with the station of the control bearing that it drives; `None` if there is no such bearing, or
    /// if the loops have not one clock: the same sampling period and delay.
    #[must_use]
    pub fn joined(plant: &Plant, loops: &[(usize, LinearLoop)], at: &OperatingPoint) -> Option<Self> {
        let (_, LinearLoop { sample, delay, .. }) = loops.first()?;
        let (sample, delay) = (*sample, *delay);
        if loops.iter().any(|(_, around)| (around.sample, around.delay) != (sample, delay)) {
            return None;
        }
        let [damping, stiffness] = plant.linear(at);
        let n = plant.order();
        let states = |around: &LinearLoop| {
            let lagging = if around.sensor_lag > 0.0 { 2 * around.sensors.len() } else { 0 };
            [lagging, around.actuator[0].nrows()]
        };
        let width = 2 * n + loops.iter().flat_map(|(_, around)| states(around)).sum::<usize>();
        let read: usize = loops.iter().map(|(_, around)| 2 * around.sensors.len()).sum();
        let law_states: usize = loops.iter().map(|(_, around)| around.law.a.nrows()).sum();
        let count = loops.len();

        let mut a = DMatrix::zeros(width, width);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, n)).copy_from(&stiffness);
        a.view_mut((n, n), (n, n)).copy_from(&damping);
        let mut b = DMatrix::zeros(width, count);
        let mut readings = DMatrix::zeros(read, width);
        let mut law = Law {
            a: DMatrix::zeros(law_states, law_states),
            b: DMatrix::zeros(law_states, read),
            c: DMatrix::zeros(count, law_states),
            d: DMatrix::zeros(count, read),
        };
        let (mut first, mut first_reading, mut first_law) = (2 * n, 0, 0);
        for (k, (bearing, around)) in loops.iter().enumerate() {
            let LinearLoop { sensors, sensor_lag, law: own, actuator: [fa, fb, fc, fd], .. } = around;
            let [lagging, order] = states(around);
            let m = sensors.len();
            for (i, station) in sensors.iter().enumerate() {
                let row = plant.stations()[*station].row.dense(n).transpose();
                for (reading, from) in [(i, 0), (m + i, n)] {
                    if lagging > 0 {
                        let state = first + reading;
                        a.view_mut((state, from), (1, n)).copy_from(&(&row / C64::from(*sensor_lag)));
                        a[(state, state)] = C64::from(-1.0 / sensor_lag);
                        readings[(first_reading + reading, state)] = C64::ONE;
                    } else {
                        readings.view_mut((first_reading + reading, from), (1, n)).copy_from(&row);
                    }
                }
            }
            let column = DMatrix::from_column_slice(n, 1, plant.column(*bearing)?.dense(n).as_slice());
            let actuator = first + lagging;
            a.view_mut((actuator, actuator), (order, order)).copy_from(fa);
            a.view_mut((n, actuator), (n, order)).copy_from(&(&column * fc));
            b.view_mut((n, k), (n, 1)).copy_from(&(&column * fd));
            b.view_mut((actuator, k), (order, 1)).copy_from(fb);
            let s = own.a.nrows();
            law.a.view_mut((first_law, first_law), (s, s)).copy_from(&own.a);
            law.b.view_mut((first_law, first_reading), (s, 2 * m)).copy_from(&own.b);
            law.c.view_mut((k, first_law), (1, s)).copy_from(&own.c);
            law.d.view_mut((k, first_reading), (1, 2 * m)).copy_from(&own.d);
            (first, first_reading, first_law) = (actuator + order, first_reading + 2 * m, first_law + s);
        }
        // Motions that nothing holds while touchdown bearings are open are held where these are closed.
        let is_touched = |(k, contact): (usize, &Contact)| {
            contact.is_touchdown && contact.stiffness != 0.0 && at.contact_factors.get(k).is_some_and(|f| *f != 0.0)
        };
        let free = if plant.contacts().iter().enumerate().any(is_touched) { vec![] } else { plant.free().to_vec() };
        Some(Self { coordinates: n, a, b, readings, law, delay, sample, free })
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
        let count = self.b.ncols();
        let mut b = DMatrix::zeros(n + m, count);
        b.view_mut((0, 0), (n, count)).copy_from(&self.b);
        Some([a, b, self.command()])
    }

    /// The commands of states and law's states, a row each.
    fn command(&self) -> DMatrix<C64> {
        let (n, m, count) = (self.a.nrows(), self.law.a.nrows(), self.b.ncols());
        let mut c = DMatrix::zeros(count, n + m);
        c.view_mut((0, 0), (count, n)).copy_from(&(&self.law.d * &self.readings));
        c.view_mut((0, n), (count, m)).copy_from(&self.law.c);
        c
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
        let count = self.b.ncols();
        let ages = whole + usize::from(rest > 0.0);
        let width = n + m + ages * count;
        let (free, newer) = held(&self.a, &self.b, period - rest);
        let (before, older) = held(&self.a, &self.b, rest);

        let mut step = DMatrix::zeros(width, width);
        // The commands at this sample, from the state at it.
        let mut command = DMatrix::zeros(count, width);
        command.view_mut((0, 0), (count, n + m)).copy_from(&self.command());
        let mut b = DMatrix::zeros(width, count);
        let mut add = |age: usize, effect: &DMatrix<C64>| {
            if age == 0 {
                let mut rows = b.view_mut((0, 0), (n, count));
                rows += effect;
            } else {
                let mut rows = step.view_mut((0, n + m + (age - 1) * count), (n, count));
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
        if ages > 0 {
            b.view_mut((n + m, 0), (count, count)).fill_with_identity();
            for later in count..ages * count {
                step[(n + m + later, n + m + later - count)] = C64::ONE;
            }
        }
        Some(SampledStep { a: &step + &b * &command, open: step, b, c: command, period })
    }
}

/// `exp(a t)` and what commands held over `t` add, by one exponential of both.
fn held(a: &DMatrix<C64>, b: &DMatrix<C64>, t: f64) -> (DMatrix<C64>, DMatrix<C64>) {
    let (n, m) = b.shape();
    let mut joined = DMatrix::zeros(n + m, n + m);
    joined.view_mut((0, 0), (n, n)).copy_from(&(a * C64::from(t)));
    joined.view_mut((0, n), (n, m)).copy_from(&(b * C64::from(t)));
    let grown = joined.exp();
    (grown.view((0, 0), (n, n)).into_owned(), grown.view((0, n), (n, m)).into_owned())
}
