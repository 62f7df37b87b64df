//! What may be searched: which signals there are, and how each of their gains depends on speed.
//!
//! A *variable* is the value of one gain at one knot; between knots a gain is linear in speed. So every gain at every
//! speed is linear in the variables, and a bound on the variables bounds the gains over the whole range. Behind the gains come
//! corners of filters, where any are searched: see [`crate::Corner`].

use control::LinearLoop;
use rotor::{C64, ControlBearing, ControlRow, Feedback, FeedbackError, Gain, GainKind, Rotor, Signal};

use crate::corners::Searched;

/// Of a rotor of shaft elements: how many times the template's own gains are searched by default.
const OWN_GAINS: f64 = 4.0;
/// Of a chain: the largest gain by default.
const LARGEST_GAIN: f64 = 20.0;

/// How gains depend on speed.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// The same at every speed.
    Fixed,
    /// Linear in speed, given by its values at the two ends of a range.
    Linear {
        /// Lower end.
        from: f64,
        /// Upper end, above the lower.
        to: f64,
    },
    /// Piecewise linear through values at these speeds, strictly rising, at least two; constant beyond them.
    Table(Vec<f64>),
}

impl Schedule {
    /// A table with `points` knots, at least two, spread evenly over a range.
    #[must_use]
    pub fn table(from: f64, to: f64, points: usize) -> Self {
        let last = points.max(2) - 1;
        Self::Table((0..=last).map(|i| from + (to - from) * i as f64 / last as f64).collect())
    }

    /// How many variables a gain has.
    #[must_use]
    pub fn knots(&self) -> usize {
        match self {
            Self::Fixed => 1,
            Self::Linear { .. } => 2,
            Self::Table(speeds) => speeds.len(),
        }
    }

    /// The speeds of a gain's variables; none where it is the same at every speed.
    #[must_use]
    pub fn speeds(&self) -> Vec<f64> {
        match self {
            Self::Fixed => vec![],
            Self::Linear { from, to } => vec![*from, *to],
            Self::Table(speeds) => speeds.clone(),
        }
    }

    /// Speeds at which the dependence on speed is not smooth: between them it is linear.
    pub(crate) fn corners(&self) -> &[f64] {
        if let Self::Table(speeds) = self { speeds } else { &[] }
    }

    /// The two knots that matter at `speed`, each with its weight.
    pub(crate) fn weights(&self, speed: f64) -> [(usize, f64); 2] {
        match self {
            Self::Fixed => [(0, 1.0), (0, 0.0)],
            Self::Linear { from, to } => {
                let part = (speed - from) / (to - from);
                [(0, 1.0 - part), (1, part)]
            }
            Self::Table(speeds) => {
                let after = speeds.partition_point(|&s| s <= speed);
                if after == 0 || after == speeds.len() {
                    return [(after.saturating_sub(1), 1.0), (0, 0.0)];
                }
                let part = (speed - speeds[after - 1]) / (speeds[after] - speeds[after - 1]);
                [(after - 1, 1.0 - part), (after, part)]
            }
        }
    }
}

/// The feedback that is searched: everything about it but the values of its gains.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// The control bearings and their signals, every gain 0.
    pub(crate) template: Feedback,
    schedule: Schedule,
    masses: usize,
    is_chain: bool,
    /// What a variable of 1 is, for every gain.
    scales: Vec<f64>,
    /// The template's own gains at rest, in those units.
    own: Vec<f64>,
    pub(crate) searched: Searched,
}

impl Structure {
    /// The structure of `template` for `rotor`: its bearings and the weights of their signals.
    ///
    /// For a chain of masses a variable is a gain. For a rotor of shaft elements, whose laws have gains of any size before their
    /// filters, it is a gain in parts of the largest that the template's signal has; where it has none, of what is a stiffness of 1
    /// behind the filters at the frequency 1.
    ///
    /// # Errors
    /// A template that does not fit the rotor, or amplifiers that differ along the axes.
    pub fn new(rotor: &Rotor, template: &Feedback, schedule: Schedule) -> Result<Self, FeedbackError> {
        template.check(rotor.len())?;
        let (masses, is_chain) = (rotor.len(), rotor.is_chain());
        let (mut scales, mut own) = (Vec::new(), Vec::new());
        for bearing in &template.bearings {
            // What has no complex form has no poles to search for.
            LinearLoop::new(bearing, masses, 0.0)?;
            for signal in &bearing.signals {
                let scale = if is_chain { 1.0 } else { scale_of(bearing, signal, masses)? };
                scales.extend([scale; 4]);
                own.extend(signal.gains.iter().map(|gain| gain.at(0.0) / scale));
            }
        }
        Ok(Self { template: template.off(), schedule, masses, is_chain, scales, own, searched: Searched::default() })
    }

    /// One signal that sums `sensors` (masses counted from 0) with weight 1: the report's composite output (4.26).
    #[must_use]
    pub fn composite(masses: usize, bearing: usize, sensors: &[usize]) -> Feedback {
        let weights: Vec<f64> = (0..masses).map(|i| f64::from(u8::from(sensors.contains(&i)))).collect();
        Feedback::new(bearing, vec![Signal::composite(&weights, [0.0; 4])])
    }

    /// A signal for every one of `sensors` (masses counted from 0).
    #[must_use]
    pub fn individual(masses: usize, bearing: usize, sensors: &[usize]) -> Feedback {
        Feedback::new(bearing, sensors.iter().map(|&mass| Signal::at_mass(mass, masses, [0.0; 4])).collect())
    }

    /// How its gains depend on speed.
    #[must_use]
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// The place that carries the first control bearing, counted from 0.
    #[must_use]
    pub fn bearing(&self) -> usize {
        self.template.first().station
    }

    /// The places that carry the control bearings, counted from 0.
    pub fn bearings(&self) -> impl Iterator<Item = usize> + '_ {
        self.template.bearings.iter().map(|bearing| bearing.station)
    }

    /// What bearing `k` is called.
    #[must_use]
    pub fn label(&self, bearing: usize) -> String {
        self.template.label(bearing)
    }

    /// The bound on variables that is taken where none is asked for.
    #[must_use]
    pub fn default_bound(&self) -> f64 {
        if self.is_chain { LARGEST_GAIN } else { OWN_GAINS }
    }

    /// Whether it is for a chain of masses.
    #[must_use]
    pub fn is_chain(&self) -> bool {
        self.is_chain
    }

    /// The variables of the template itself, its gains at rest.
    #[must_use]
    pub fn own(&self) -> Vec<f64> {
        let knots = self.schedule.knots();
        self.own.iter().flat_map(|gain| vec![*gain; knots]).chain(self.own_corners()).collect()
    }

    /// How many masses the rotor has that it is for.
    #[must_use]
    pub fn masses(&self) -> usize {
        self.masses
    }

    /// How many variables there are: signals of all bearings x 4 gains x knots, in this order, the knot running fastest, and the
    /// corners that are searched.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.gain_variables() + self.corners().len()
    }

    /// How many of them are of gains.
    #[must_use]
    pub fn gain_variables(&self) -> usize {
        self.gains() * self.schedule.knots()
    }

    /// The feedback with the gains and corners `variables`.
    ///
    /// # Panics
    /// If there are too few.
    #[must_use]
    pub fn feedback(&self, variables: &[f64]) -> Feedback {
        let mut made = self.template.clone();
        self.put_filters(variables, &mut made);
        let mut values = variables.chunks_exact(self.schedule.knots());
        let gains = made.bearings.iter_mut().flat_map(|b| &mut b.signals).flat_map(|signal| &mut signal.gains);
        for (gain, scale) in gains.zip(&self.scales) {
            let values = values.next().expect("a value for every knot of every gain");
            let values: Vec<f64> = values.iter().map(|value| value * scale).collect();
            *gain = match &self.schedule {
                Schedule::Fixed => Gain::Constant(values[0]),
                Schedule::Linear { from, to } => {
                    let slope = (values[1] - values[0]) / (to - from);
                    Gain::Linear { at_zero: values[0] - slope * from, slope }
                }
                Schedule::Table(speeds) => Gain::Table(speeds.iter().copied().zip(values.iter().copied()).collect()),
            };
        }
        made
    }

    /// What the gains are at the knots: `variables` times what a variable of 1 is, in their order and without corners.
    #[must_use]
    pub fn gain_values(&self, variables: &[f64]) -> Vec<f64> {
        let knots = self.schedule.knots();
        let each = variables.chunks_exact(knots).zip(&self.scales);
        each.flat_map(|(values, scale)| values.iter().map(move |value| value * scale)).collect()
    }

    /// The variables that come nearest to `feedback`, which has the same signals and filters: its gains at the knots, its corners.
    #[must_use]
    pub fn variables_of(&self, feedback: &Feedback) -> Vec<f64> {
        let mut speeds = self.schedule.speeds();
        if speeds.is_empty() {
            speeds.push(0.0);
        }
        let gains = feedback.signals().flat_map(|signal| &signal.gains).zip(&self.scales);
        let gains = gains.flat_map(|(gain, scale)| speeds.iter().map(move |&speed| gain.at(speed) / scale));
        gains.chain(self.corners_in(feedback)).collect()
    }

    /// Whether the loop is more than gains and a delay: filters, lags, samples, faults of sensors and amplifiers.
    pub(crate) fn has_loop(&self) -> bool {
        self.template.bearings.iter().any(|bearing| {
            let parts = &bearing.parts;
            let has_filter = !bearing.filters.is_empty() || bearing.signals.iter().any(|s| !s.filters.is_empty());
            has_filter || parts.sensor_lag > 0.0 || parts.lag > 0.0 || parts.sample > 0.0 || *parts != parts.sound()
        })
    }

    /// Whether it is gains and a delay at one bearing of a chain, which has a way of its own.
    pub(crate) fn is_plain(&self) -> bool {
        self.is_chain && self.template.bearings.len() == 1 && !self.has_loop()
    }

    /// Whether the loop acts at samples.
    pub(crate) fn is_sampled(&self) -> bool {
        self.period() > 0.0
    }

    /// How far apart they are; 0 of a continuous loop.
    pub(crate) fn period(&self) -> f64 {
        self.template.sample()
    }

    /// The delay of the loop, where the family has none of its own.
    pub(crate) fn delay(&self) -> f64 {
        self.template.delay()
    }

    /// How many gains there are at one speed.
    pub(crate) fn gains(&self) -> usize {
        self.scales.len()
    }

    /// The same bearings and signals, what a variable of 1 is too, with another dependence on speed.
    #[must_use]
    pub(crate) fn with_schedule(&self, schedule: Schedule) -> Self {
        Self { schedule, ..self.clone() }
    }

    /// The gains at one speed, signal by signal.
    #[must_use]
    pub fn gains_at(&self, variables: &[f64], speed: f64) -> Vec<f64> {
        let (knots, near) = (self.schedule.knots(), self.schedule.weights(speed));
        let gain = |values: &[f64]| near.iter().map(|(k, weight)| values[*k] * weight).sum::<f64>();
        variables.chunks_exact(knots).zip(&self.scales).map(|(values, scale)| gain(values) * scale).collect()
    }

    /// Slopes in each variable from those in each gain at one speed and, behind them, in each corner.
    pub(crate) fn spread<T: Copy + std::ops::Mul<f64, Output = T> + std::ops::AddAssign>(
        &self,
        speed: f64,
        by: &[T],
        zero: T,
        out: &mut [T],
    ) {
        let (knots, near) = (self.schedule.knots(), self.schedule.weights(speed));
        out.fill(zero);
        let (by_gain, by_corner) = by.split_at(self.gains());
        let (out, corners) = out.split_at_mut(self.gain_variables());
        corners.copy_from_slice(by_corner);
        for ((out, slope), scale) in out.chunks_exact_mut(knots).zip(by_gain).zip(&self.scales) {
            near.iter().for_each(|(k, weight)| out[*k] += *slope * (*weight * scale));
        }
    }

    /// The feedback with the corners of `variables` and every gain 0, but for gain `only`, which is 1; with this delay.
    pub(crate) fn unit(&self, variables: &[f64], only: Option<usize>, delay: f64) -> Feedback {
        let mut made = self.template.clone();
        self.put_filters(variables, &mut made);
        made.set_delay(delay);
        let gains = made.bearings.iter_mut().flat_map(|b| &mut b.signals).flat_map(|signal| &mut signal.gains);
        gains.enumerate().for_each(|(k, gain)| *gain = Gain::Constant(f64::from(u8::from(Some(k) == only))));
        made
    }

    /// Every signal alone, with `kd` of 1 and with `cd` of 1: two bearings each, of that signal and no other, without the filters
    /// that move; with this delay.
    pub(crate) fn unit_signals(&self, delay: f64) -> Vec<[ControlBearing; 2]> {
        let of = |bearing: &ControlBearing, signal: &Signal| {
            [GainKind::Kd, GainKind::Cd].map(|kind| {
                let mut alone = ControlBearing { signals: vec![signal.clone()], ..bearing.clone() };
                alone.parts.delay = delay;
                *alone.signals[0].gain_mut(kind) = Gain::Constant(1.0);
                alone
            })
        };
        let mut bare = self.template.clone();
        self.take_filters(&mut bare);
        bare.bearings.iter().flat_map(|b| b.signals.iter().map(move |signal| of(b, signal))).collect()
    }

    /// Which bearing each gain drives.
    pub(crate) fn bearing_of_gains(&self) -> Vec<usize> {
        let each = self.template.bearings.iter().enumerate();
        each.flat_map(|(k, bearing)| vec![k; 4 * bearing.signals.len()]).collect()
    }

    /// The control law of a chain's only bearing at one speed, with the gains `variables`.
    pub(crate) fn row(&self, variables: &[f64], speed: f64) -> ControlRow {
        let mut row = ControlRow { bearing: self.bearing(), ..ControlRow::default() };
        let (knots, [(i, at_i), (j, at_j)]) = (self.schedule.knots(), self.schedule.weights(speed));
        for (signal, values) in self.template.first().signals.iter().zip(variables.chunks_exact(4 * knots)) {
            let gain = |kind: GainKind| {
                let own = &values[kind as usize * knots..];
                own[i] * at_i + own[j] * at_j
            };
            let on_displacement = C64::new(gain(GainKind::Kd), -gain(GainKind::Kc));
            let on_velocity = C64::new(gain(GainKind::Cd), -gain(GainKind::Cc));
            for (place, weight) in row.displacement.iter_mut().zip(&signal.displacement) {
                *place += on_displacement * weight;
            }
            for (place, weight) in row.velocity.iter_mut().zip(&signal.velocity) {
                *place += on_velocity * weight;
            }
        }
        row
    }

    /// What `u` of a chain's only bearing changes by with each variable at one speed, for whirl `p exp(lambda tau)`: `- d u / d variable`, into `out`.
    pub(crate) fn sensitivities(&self, speed: f64, shape: &[C64], lambda: C64, out: &mut [C64]) {
        let (knots, near) = (self.schedule.knots(), self.schedule.weights(speed));
        out.fill(C64::ZERO);
        for (signal, out) in self.template.first().signals.iter().zip(out.chunks_exact_mut(4 * knots)) {
            for (own, value) in out.chunks_exact_mut(knots).zip(by_gain(signal, shape, lambda)) {
                near.iter().for_each(|(knot, weight)| own[*knot] += value * weight);
            }
        }
    }

    /// The same with each gain there.
    pub(crate) fn gain_sensitivities(&self, shape: &[C64], lambda: C64) -> Vec<C64> {
        self.template.signals().flat_map(|signal| by_gain(signal, shape, lambda)).collect()
    }
}

/// What a variable of 1 is for the gains of `signal`: see [`Structure::new`].
fn scale_of(bearing: &ControlBearing, signal: &Signal, stations: usize) -> Result<f64, FeedbackError> {
    let largest = signal.gains.iter().map(|gain| gain.at(0.0).abs()).fold(0.0, f64::max);
    if largest > 0.0 {
        return Ok(largest);
    }
    let mut alone = ControlBearing { signals: vec![signal.clone()], ..bearing.clone() };
    *alone.signals[0].gain_mut(GainKind::Kd) = Gain::Constant(1.0);
    let around = LinearLoop::new(&alone, stations, 0.0)?;
    let answer = around.fundamental(1.0).unwrap_or_default();
    let size = answer.iter().map(|h| h.norm()).fold(0.0, f64::max);
    Ok(if size > 0.0 && size.is_finite() { 1.0 / size } else { 1.0 })
}

/// `- d u / d gain` of one signal for whirl `p exp(lambda tau)`, in the order of [`GainKind::ALL`].
fn by_gain(signal: &Signal, shape: &[C64], lambda: C64) -> [C64; 4] {
    let sum = |weights: &[f64]| weights.iter().zip(shape).map(|(w, p)| p * w).sum::<C64>();
    let displacement = sum(&signal.displacement);
    let velocity = sum(&signal.velocity) * lambda;
    let turned = |z: C64| C64::new(z.im, -z.re);
    [displacement, velocity, turned(displacement), turned(velocity)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_row_is_the_row_of_the_feedback() {
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        for schedule in [Schedule::Fixed, Schedule::Linear { from: 1.0, to: 5.0 }, Schedule::table(0.0, 6.0, 4)] {
            let template = Structure::individual(3, 1, &[0, 2]);
            let structure = Structure::new(&rotor, &template, schedule).unwrap();
            let variables: Vec<f64> = (0..structure.variables()).map(|i| (i as f64 * 1.7).sin()).collect();
            let feedback = structure.feedback(&variables);
            for (a, b) in structure.variables_of(&feedback).iter().zip(&variables) {
                assert!((a - b).abs() < 1e-14);
            }
            for speed in [0.0, 1.0, 2.0, 3.7, 6.0] {
                let (fast, slow) = (structure.row(&variables, speed), feedback.first().at(speed));
                for k in 0..3 {
                    assert!((fast.displacement[k] - slow.displacement[k]).norm() < 1e-14);
                    assert!((fast.velocity[k] - slow.velocity[k]).norm() < 1e-14);
                }
            }
        }
    }
}
