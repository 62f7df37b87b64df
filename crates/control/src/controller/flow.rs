//! The continuous side of a loop: from sensors through filters and delay to the actuator, as rates of its states.

use super::law_row::Chain;
use super::{Controller, Stage};
use crate::block::Sampled;
use crate::delay_line::Stretch;
use crate::{C64, Parts};

impl Controller {
    /// The rates of its continuous states `x` into `dx`, and the force on the plant.
    #[inline]
    pub fn flow(&mut self, stage: &Stage<'_>, x: &[C64], dx: &mut [C64]) -> C64 {
        self.follow(stage.speed);
        let command = if self.parts.sample > 0.0 {
            self.flow_of_sensors(stage, x, dx);
            self.acting
        } else {
            self.read(stage, x);
            self.flow_of_sensors(stage, x, dx);
            let (from, to) = (self.sensor_states, self.sensor_states + self.filter_states);
            let command = self.command(&x[from..to], Some(&mut dx[from..to]));
            let command = self.excited(command, stage.tau);
            self.output.commanded = command;
            self.late(stage, command)
        };
        let first = self.sensor_states + self.filter_states;
        let drive = self.actuate(command, &x[first..], &mut dx[first..]);
        self.limited(drive, stage.since).0
    }

    /// Keeps the command over the stretch from `from` to `to`, whose values and rates at both ends are known now.
    ///
    /// `start` and `end` are `(command, rate of command)`. Returns whether the stretch must be integrated again, because it
    /// used what is known only now.
    pub fn remember(&mut self, from: f64, to: f64, start: (C64, C64), end: (C64, C64)) -> bool {
        let Some(line) = &mut self.line else { return false };
        let mut stretch = Stretch { from, to, value: [start.0, end.0], slope: [start.1, end.1] };
        if self.parts.quantum > 0.0 {
            // Stairs have no slope of their own.
            stretch.slope = [(end.0 - start.0) / (to - from).max(f64::MIN_POSITIVE); 2];
        }
        self.passes += 1;
        self.current = stretch;
        // The first pass errs by the fourth power of the step, each more by a power less.
        if self.parts.delay < to - from && self.passes < 3 {
            return true;
        }
        line.push(stretch);
        false
    }

    /// The command in this state and its rate, for [`Controller::remember`]; `rates` has velocities and accelerations.
    pub fn command_and_rate(&mut self, stage: &Stage<'_>, x: &[C64], rates: &Stage<'_>, x_rate: &[C64]) -> (C64, C64) {
        self.read(stage, x);
        let (from, to) = (self.sensor_states, self.sensor_states + self.filter_states);
        let (command, rate) = (self.command(&x[from..to], None), self.command_rate(rates, x_rate));
        (self.excited(command, stage.tau), self.excited_rate(rate, stage.tau))
    }

    /// What was asked for a delay ago.
    #[inline]
    pub(super) fn late(&self, stage: &Stage<'_>, command: C64) -> C64 {
        let Some(line) = &self.line else { return command };
        let then = stage.tau - self.parts.delay;
        let began = stage.tau - stage.since;
        // Within the stretch that is being integrated, what is known of it.
        if then > began { self.current.at(then) } else { line.at(then) }
    }

    fn flow_of_sensors(&self, stage: &Stage<'_>, x: &[C64], dx: &mut [C64]) {
        if self.sensor_states == 0 {
            return;
        }
        let rate = 1.0 / self.parts.sensor_lag;
        let count = self.sensors.len();
        for (k, station) in self.sensors.iter().enumerate() {
            dx[k] = (stage.displacement[*station] - x[k]) * rate;
            dx[count + k] = (stage.velocity[*station] - x[count + k]) * rate;
        }
    }

    /// What the sensors read.
    #[inline]
    pub(super) fn read(&mut self, stage: &Stage<'_>, x: &[C64]) {
        let count = self.sensors.len();
        for (k, station) in self.sensors.iter().enumerate() {
            let [p, v] = if self.sensor_states > 0 {
                [x[k], x[count + k]]
            } else {
                [stage.displacement[*station], stage.velocity[*station]]
            };
            (self.reading[0][k], self.reading[1][k]) = (p, v);
        }
        if let Some(noise) = &self.noise {
            self.reading[0].iter_mut().zip(&noise.displacement).for_each(|(reading, n)| *reading += n);
            self.reading[1].iter_mut().zip(&noise.velocity).for_each(|(reading, n)| *reading += n);
        }
        if self.parts.sensor_gain != 1.0 {
            let [displacement, velocity] = &mut self.reading;
            for ((p, v), station) in displacement.iter_mut().zip(velocity).zip(&self.sensors) {
                let gain = self.parts.gain_of_sensor(*station);
                (*p, *v) = (*p * gain, *v * gain);
            }
        }
        let quantum = self.parts.quantum;
        if quantum > 0.0 {
            for reading in self.reading.iter_mut().flatten() {
                *reading = C64::new((reading.re / quantum).round() * quantum, (reading.im / quantum).round() * quantum);
            }
        }
    }

    /// The law on the present readings, in a continuous loop; the rates of the filters' states `x` into `dx`.
    #[inline]
    pub(super) fn command(&self, x: &[C64], mut dx: Option<&mut [C64]>) -> C64 {
        let mut sum = C64::ZERO;
        for row in &self.rows {
            sum -= self.shaped(&row.filters, row.of(&self.reading), x, dx.as_deref_mut());
        }
        self.shaped(&self.bearing, sum, x, dx)
    }

    #[inline]
    fn shaped(&self, chain: &Chain, mut w: C64, x: &[C64], mut dx: Option<&mut [C64]>) -> C64 {
        let mut first = chain.first;
        for Sampled { block, .. } in &chain.blocks {
            let states = first..first + block.order;
            let x = &x[states.clone()];
            if let Some(dx) = &mut dx {
                let dx = &mut dx[states.clone()];
                if block.winds_up && self.winds_up(x[0] * w.conj()) {
                    dx.fill(C64::ZERO);
                } else {
                    block.derivative(x, w, self.speed, dx);
                }
            }
            w = block.output(x, w);
            first = states.end;
        }
        w
    }

    /// Whether an integrator is held: the actuator is at its limit, and integrating would lead further.
    fn winds_up(&self, further: C64) -> bool {
        self.output.saturated && further.re > 0.0
    }

    /// The rate of the command, from the rates of readings and filters' states: its jumps count for nothing.
    pub(super) fn command_rate(&self, rates: &Stage<'_>, x_rate: &[C64]) -> C64 {
        let count = self.sensors.len();
        let rate = |k: usize, velocity: bool| {
            let rate = match (self.sensor_states > 0, velocity) {
                (true, false) => x_rate[k],
                (true, true) => x_rate[count + k],
                (false, false) => rates.displacement[self.sensors[k]],
                (false, true) => rates.velocity[self.sensors[k]],
            };
            rate * self.parts.gain_of_sensor(self.sensors[k])
        };
        let mut sum = C64::ZERO;
        let states = &x_rate[self.sensor_states..self.sensor_states + self.filter_states];
        for row in &self.rows {
            let on = |weights: &[f64], velocity| -> C64 {
                weights.iter().enumerate().map(|(k, weight)| rate(k, velocity) * *weight).sum()
            };
            let w = row.now[0] * on(&row.displacement, false) + row.now[1] * on(&row.velocity, true);
            sum -= self.shaped(&row.filters, w, states, None);
        }
        self.shaped(&self.bearing, sum, states, None)
    }

    /// The actuator's output for a command, and the rates of its states.
    #[inline]
    fn actuate(&self, command: C64, x: &[C64], dx: &mut [C64]) -> C64 {
        let Parts { lag, lag_damping, .. } = self.parts;
        match self.actuator_states {
            0 => command,
            1 => {
                dx[0] = (command - x[0]) / lag;
                x[0]
            }
            _ => {
                // The second state is lag times the rate of the first.
                dx[0] = x[1] / lag;
                dx[1] = (command - x[0] - x[1] * (2.0 * lag_damping)) / lag;
                x[0]
            }
        }
    }

    /// The force that the actuator can deliver, and whether that is less than it would.
    #[inline]
    pub(super) fn limited(&self, drive: C64, since: f64) -> (C64, bool) {
        let Parts { limit, slew, amplifier_y, amplifier_z, .. } = self.parts;
        let drive = C64::new(drive.re * amplifier_y, drive.im * amplifier_z);
        let (mut force, mut saturated) = (drive, false);
        if slew.is_finite() {
            let change = drive - self.output.delivered;
            let (size, most) = (change.norm(), slew * since);
            if size > most {
                force = self.output.delivered + change * (most / size);
                saturated = true;
            }
        }
        if limit.is_finite() {
            let size = force.norm();
            if size > limit {
                force *= limit / size;
                saturated = true;
            }
        }
        (force, saturated)
    }
}
