//! The loop around a rotor in circular whirl, where it is more than gains: what it answers to a whirl, and what small
//! disturbances of an orbit become with everything that it holds.
//!
//! On an orbit the sensors see `c exp(j w tau)`, so the whole loop, delay and filters and all, is one complex row `H(j w)`:
//! no approximation. Only a sampled loop is none of this: its hold leaves a ripple, and the orbit is no circle.

use std::cell::Cell;
use std::rc::Rc;

use control::LinearLoop;
use linear::{DelayError, DelaySystem};
use nalgebra::{DMatrix, DVector};

use super::stability::PHASE_ZERO;
use crate::{C64, ControlBearing, Feedback, FeedbackError, J, LinearForm, OperatingPoint, Plant};

/// Right of this a pole is looked for first; then four times as far left, until there is one or only echoes are left.
const FIRST_LINE: f64 = -1.0;
/// Last places a state that rounding may cost.
const LAST_PLACES: f64 = 64.0;

/// The loops of all control bearings at one spin speed.
#[derive(Clone)]
pub(super) struct Around {
    plant: Rc<Plant>,
    speed: f64,
    /// Each with the mass that carries its bearing.
    loops: Rc<Vec<(usize, LinearLoop)>>,
    delay: f64,
    /// Whether roots could not be counted once: then they are not counted again for starts of a search.
    uncounted: Rc<Cell<bool>>,
}

/// What one control bearing answers to the whirl of one sensor.
pub(super) struct Answer {
    /// Which control bearing, counted from 0.
    pub place: usize,
    /// The mass that carries it.
    pub bearing: usize,
    /// The mass that carries the sensor.
    pub sensor: usize,
    /// What it does to the bearing's mass per displacement of the sensor.
    pub gain: C64,
    /// The derivative of that by `s`.
    pub slope: C64,
}

impl Around {
    /// The loop of `feedback`; `uncounted` is shared by all speeds of one question.
    ///
    /// # Errors
    /// Feedback that does not fit.
    pub(super) fn new(
        plant: &Rc<Plant>,
        feedback: &Feedback,
        speed: f64,
        uncounted: &Rc<Cell<bool>>,
    ) -> Result<Self, FeedbackError> {
        let stations = plant.stations().len();
        let linear = |bearing: &ControlBearing| Ok((bearing.station, LinearLoop::new(bearing, stations, speed)?));
        let loops: Result<Vec<_>, FeedbackError> = feedback.bearings.iter().map(linear).collect();
        Ok(Self {
            plant: plant.clone(),
            speed,
            loops: Rc::new(loops?),
            delay: feedback.delay(),
            uncounted: uncounted.clone(),
        })
    }

    /// How many control bearings there are.
    pub(super) fn count(&self) -> usize {
        self.loops.len()
    }

    /// What the bearings answer to the whirl `exp(s tau)` of each of their sensors.
    pub(super) fn answers(&self, s: C64) -> impl Iterator<Item = Answer> + '_ {
        self.loops.iter().enumerate().flat_map(move |(place, (bearing, around))| {
            // At a pole of the loop there is no orbit: what is not a number is refused by whoever solves with it.
            let missing = || [const { C64::new(f64::NAN, f64::NAN) }; 2].map(|x| vec![x; around.sensors.len()]);
            let [value, slope] = around.response(s).unwrap_or_else(missing);
            let answers = around.sensors.iter().zip(value.into_iter().zip(slope));
            answers.map(move |(sensor, (gain, slope))| Answer {
                place,
                bearing: *bearing,
                sensor: *sensor,
                gain,
                slope,
            })
        })
    }

    /// `A`, `B` and `C` of the machine with shares of its bearings' stiffness, and the delay.
    fn matrices(&self, factors: Vec<f64>) -> Option<[DMatrix<C64>; 3]> {
        let at = OperatingPoint { speed: self.speed, contact_factors: factors };
        LinearForm::joined(&self.plant, &self.loops, &at)?.continuous()
    }

    /// The state matrix, displacements and then velocities first; `None` with a delay.
    pub(super) fn state_matrix(&self, factors: Vec<f64>) -> Option<DMatrix<C64>> {
        let [a, b, c] = self.matrices(factors).filter(|_| self.delay == 0.0)?;
        Some(a + b * c)
    }

    /// Poles with shares of the bearings' stiffness, from which cycles are sought; with a delay all that are more than its echoes, or, where
    /// those cannot be counted, the poles that there are without it.
    ///
    /// # Errors
    /// Poles that cannot be had.
    pub(super) fn poles(&self, factors: Vec<f64>) -> Result<Vec<C64>, DelayError> {
        let Some([a, b, c]) = self.matrices(factors) else { return Ok(Vec::new()) };
        let system = DelaySystem::new(a, b, c, self.delay)?;
        let counted = (!self.uncounted.get()).then(|| system.roots_right_of(system.echo_line()).ok()).flatten();
        match counted {
            Some(found) => Ok(found.roots),
            None => {
                self.uncounted.set(true);
                let prompt = DelaySystem::new(system.a().clone(), system.b().clone(), system.c().clone(), 0.0)?;
                Ok(prompt.roots_right_of(f64::NEG_INFINITY)?.roots)
            }
        }
    }

    /// The largest real part among the roots of the disturbance `x = (x0 + q) exp(j w tau)` of everything that moves: plant,
    /// sensors, filters, actuator, and what is under way in the delay,
    ///
    /// ```text
    /// q' = (A - j w) q + B C exp(-j w T) q(tau - T) - K conj(q)
    /// ```
    ///
    /// `factors` are the shares of stiffness that multiply `q` of each mass, `pushed` the accelerations that `conj(q)` of each makes. Zero where
    /// it is rounding. With a delay and no root right of its echoes the line of those is given: it decays at least as fast.
    ///
    /// # Errors
    /// Roots that cannot be had.
    pub(super) fn growth(
        &self,
        factors: Vec<f64>,
        pushed: &[DVector<C64>],
        frequency: f64,
        free_phase: bool,
    ) -> Result<f64, DelayError> {
        let Some([a, b, c]) = self.matrices(factors) else { return Ok(f64::NAN) };
        let (n, size) = (pushed.len(), a.nrows());
        let delay = self.delay;
        let late = (-J * frequency * delay).exp();
        // Where nothing presses `conj(q)` moves by itself, as the mirror image of `q`: one of the two tells all.
        let halves =
            if free_phase || pushed.iter().flat_map(|by| by.iter()).any(|by| *by != C64::ZERO) { 2 } else { 1 };
        let whole = halves * size;
        let mut joined = DMatrix::zeros(whole, whole);
        joined.view_mut((0, 0), (size, size)).copy_from(&a);
        if halves == 2 {
            joined.view_mut((size, size), (size, size)).copy_from(&a.conjugate());
            for (k, pushed) in pushed.iter().enumerate() {
                for (i, by) in pushed.iter().enumerate() {
                    joined[(n + i, size + k)] -= by;
                    joined[(size + n + i, k)] -= by.conj();
                }
            }
        }
        (0..whole).for_each(|i| joined[(i, i)] += if i < size { -J * frequency } else { J * frequency });
        let count = b.ncols();
        let (mut column, mut row) = (DMatrix::zeros(whole, halves * count), DMatrix::zeros(halves * count, whole));
        let b = b * late;
        column.view_mut((0, 0), (size, count)).copy_from(&b);
        row.view_mut((0, 0), (count, size)).copy_from(&c);
        if halves == 2 {
            column.view_mut((size, count), (size, count)).copy_from(&b.conjugate());
            row.view_mut((count, size), (count, size)).copy_from(&c.conjugate());
        }
        let closed = &joined + &column * &row;
        // As of both halves.
        let largest = closed.norm() * (2.0 / halves as f64).sqrt();
        let rounding = LAST_PLACES * f64::EPSILON * (2 * size) as f64 * largest;
        let system = DelaySystem::new(joined, column, row, delay)?;
        let end = if delay > 0.0 { system.echo_line() } else { f64::NEG_INFINITY };
        let mut line = if delay > 0.0 { FIRST_LINE.max(end) } else { end };
        loop {
            let mut roots = system.roots_right_of(line)?.roots;
            if free_phase
                && let Some(zero) = (0..roots.len()).min_by(|&i, &k| roots[i].norm().total_cmp(&roots[k].norm()))
                && roots[zero].norm() <= PHASE_ZERO * largest
            {
                roots.swap_remove(zero);
            }
            if let Some(growth) = roots.iter().map(|root| root.re).reduce(f64::max) {
                return Ok(if growth.abs() <= rounding { 0.0 } else { growth });
            }
            if line <= end {
                return Ok(end);
            }
            line = (4.0 * line).max(end);
        }
    }
}
