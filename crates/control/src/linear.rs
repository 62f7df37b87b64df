//! A loop as matrices, at one spin speed: what poles and margins are made of.

use nalgebra::DMatrix;

use crate::block::Sampled;
use crate::{C64, ControlBearing, Controller, FeedbackError, Parts};

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
    /// The loop of `bearing` on a plant of so many stations, at a spin speed.
    ///
    /// # Errors
    /// Feedback that does not fit, or whose amplifier is not the same along both axes: such a loop answers a forward whirl with a
    /// backward one too, and has no form in complex numbers.
    pub fn new(bearing: &ControlBearing, stations: usize, speed: f64) -> Result<Self, FeedbackError> {
        bearing.check(stations)?;
        let Parts { amplifier_y: y, amplifier_z: z, .. } = bearing.parts;
        if y != z {
            return Err(FeedbackError::Anisotropic { y, z });
        }
        Ok(Controller::with_room(bearing, stations, speed, 1, 0.0).linear(speed))
    }

    /// What the loop answers to the whirl `exp(s tau)` of its sensors: the force that a displacement 1 at each of them makes,
    /// and the derivative of that by `s`. `None` of a sampled loop, whose force is no pure whirl, and at a pole.
    ///
    /// The velocity is `s` times the displacement, the delay the factor `exp(-s delay)`.
    #[must_use]
    pub fn response(&self, s: C64) -> Option<[Vec<C64>; 2]> {
        if self.sample > 0.0 {
            return None;
        }
        let of_block = |a: &DMatrix<C64>, b: &DMatrix<C64>, c: &DMatrix<C64>, d: &DMatrix<C64>| {
            if a.is_empty() {
                return Some((d.clone(), DMatrix::zeros(d.nrows(), d.ncols())));
            }
            let solve = (DMatrix::identity(a.nrows(), a.nrows()) * s - a).lu();
            let once = solve.solve(b)?;
            let twice = solve.solve(&once)?;
            Some((c * once + d, -(c * twice)))
        };
        let Law { a, b, c, d } = &self.law;
        let (law, law_slope) = of_block(a, b, c, d)?;
        let [a, b, c, d] = &self.actuator;
        let (actuator, actuator_slope) = of_block(a, b, c, d)?;
        // Everything after the law, and its derivative.
        let late = (-s * self.delay).exp();
        let lag = (s * self.sensor_lag + 1.0).inv();
        let behind = actuator[0] * late * lag;
        let behind_slope = (actuator_slope[0] - actuator[0] * (self.delay + self.sensor_lag * lag)) * late * lag;
        let count = self.sensors.len();
        let (mut value, mut slope) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for k in 0..count {
            let own = law[k] + law[count + k] * s;
            let own_slope = law_slope[k] + law_slope[count + k] * s + law[count + k];
            value.push(own * behind);
            slope.push(own_slope * behind + own * behind_slope);
        }
        Some([value, slope])
    }

    /// The same, of displacement readings alone: velocities are read as 0.
    #[must_use]
    pub fn of_displacement(&self, frequency: f64) -> Option<Vec<C64>> {
        let count = self.sensors.len();
        let mut still = self.clone();
        still.law.b.columns_mut(count, count).fill(C64::ZERO);
        still.law.d.columns_mut(count, count).fill(C64::ZERO);
        still.fundamental(frequency)
    }

    /// What the loop answers to the whirl `exp(j frequency tau)` of its sensors at that same frequency, per displacement of
    /// each. Of a sampled loop it is the fundamental of the held force, `(1 - exp(-s h)) / (s h)` times what the law makes of
    /// the samples; the ripple beside it falls on other frequencies, and what of it the samples see again is left out.
    #[must_use]
    pub fn fundamental(&self, frequency: f64) -> Option<Vec<C64>> {
        let s = C64::new(0.0, frequency);
        if self.sample <= 0.0 {
            return self.response(s).map(|[value, _]| value);
        }
        let Law { a, b, c, d } = &self.law;
        let turn = s * self.sample;
        let solve = (DMatrix::identity(a.nrows(), a.nrows()) * turn.exp() - a).lu();
        let law = if a.is_empty() { d.clone() } else { c * solve.solve(b)? + d };
        let hold = if turn.norm() < 1e-8 { C64::ONE } else { (C64::ONE - (-turn).exp()) / turn };
        let ideal = Self {
            sample: 0.0,
            law: Law {
                a: DMatrix::zeros(0, 0),
                b: DMatrix::zeros(0, law.ncols()),
                c: DMatrix::zeros(1, 0),
                d: law * hold,
            },
            ..self.clone()
        };
        ideal.response(s).map(|[value, _]| value)
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
            let read = |weights: &'a [f64], gain: C64| {
                let read = weights.iter().zip(sensors);
                read.map(move |(w, station)| -gain * (*w * parts.gain_of_sensor(*station)))
            };
            let weights = read(displacement, gains[0]).chain(read(velocity, gains[1]));
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

/// Lag and amplifier.
fn actuator(parts: &Parts) -> [DMatrix<C64>; 4] {
    let [a, b, c, d] = lag(parts);
    let gain = C64::from(parts.amplifier_y);
    [a, b, c * gain, d * gain]
}

fn lag(parts: &Parts) -> [DMatrix<C64>; 4] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Filter, J, Signal};

    /// Every part of the loop, in one signal and behind the sum.
    fn whole() -> ControlBearing {
        let mut second = Signal::at_mass(2, 3, [0.7, 0.3, -0.2, 0.1]);
        second.filters = vec![Filter::Lowpass { corner: 8.0, order: 2 }];
        let mut feedback =
            ControlBearing::new(0, vec![Signal::composite(&[1.0, 0.5, 0.0], [-0.4, 0.5, -0.6, 0.3]), second]);
        feedback.filters = vec![Filter::Notch { frequency: 3.1, width: 0.2 }, Filter::SynchronousNotch { width: 0.3 }];
        feedback.parts = Parts { sensor_lag: 0.03, delay: 0.2, lag: 0.05, lag_damping: 0.7, ..Parts::default() };
        feedback
    }

    #[test]
    fn val_the_response_is_the_product_of_the_transfer_functions() {
        let (feedback, speed) = (whole(), 2.5);
        let around = LinearLoop::new(&feedback, 3, speed).expect("fits");
        for s in [J * 1.7, J * -4.0, C64::new(0.3, 2.0)] {
            let [value, slope] = around.response(s).expect("no pole there");
            let after = feedback.filters.iter().map(|f| f.at(s, speed)).product::<C64>() * (-s * 0.2).exp()
                / (s * 0.03 + 1.0)
                / (s * s * 0.0025 + s * (2.0 * 0.7 * 0.05) + 1.0);
            for (k, station) in around.sensors.iter().enumerate() {
                let sum: C64 = (feedback.signals.iter())
                    .map(|signal| {
                        let [kd, cd, kc, cc] = [0, 1, 2, 3].map(|i| signal.gains[i].at(speed));
                        let shaped: C64 = signal.filters.iter().map(|f| f.at(s, speed)).product();
                        let law = C64::new(kd, -kc) * signal.displacement[*station]
                            + C64::new(cd, -cc) * s * signal.velocity[*station];
                        -law * shaped
                    })
                    .sum();
                assert!((value[k] - sum * after).norm() < 1e-12, "sensor {station} at {s}");
                let h = C64::from(1e-6);
                let beside = |s: C64| around.response(s).expect("no pole there")[0][k];
                let difference = (beside(s + h) - beside(s - h)) / (h * 2.0);
                assert!((slope[k] - difference).norm() < 1e-7 * (1.0 + slope[k].norm()));
            }
        }
    }

    #[test]
    fn val_gains_of_sensors_and_of_the_amplifier_are_factors_of_the_response() {
        let (sound, s) = (whole(), C64::new(0.3, 2.0));
        let mut faulty = sound.clone();
        let parts = &mut faulty.parts;
        (parts.sensor_gain, parts.sensor_at, parts.amplifier_y, parts.amplifier_z) = (0.3, 2.0, 0.5, 0.5);
        let of = |bearing: &ControlBearing| LinearLoop::new(bearing, 3, 2.5).expect("fits");
        let (sound, faulty) = (of(&sound), of(&faulty));
        let [value, slope] = faulty.response(s).expect("no pole there");
        let [sound_value, sound_slope] = sound.response(s).expect("no pole there");
        for (k, station) in faulty.sensors.iter().enumerate() {
            let factor = if *station == 1 { 0.15 } else { 0.5 };
            assert!((value[k] - sound_value[k] * factor).norm() < 1e-13, "{station}");
            assert!((slope[k] - sound_slope[k] * factor).norm() < 1e-13, "{station}");
        }
    }

    #[test]
    fn a_loop_that_has_lost_an_axis_has_no_complex_form() {
        let mut lost = whole();
        lost.parts.amplifier_z = 0.0;
        let told = LinearLoop::new(&lost, 3, 2.5).unwrap_err();
        assert_eq!(told, FeedbackError::Anisotropic { y: 1.0, z: 0.0 });
    }

    #[test]
    fn a_sampled_loop_has_no_response_in_pure_whirl() {
        let mut feedback = whole();
        feedback.parts.sample = 0.05;
        assert_eq!(LinearLoop::new(&feedback, 3, 1.0).expect("fits").response(J), None);
    }
}
