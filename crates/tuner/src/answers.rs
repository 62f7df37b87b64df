//! What every gain alone makes of a unit of command at one condition: the rotor without control, and behind it the law.
//!
//! A command 1 at bearing `b` whirls the stations by `H_b(s) = rows (s^2 - s D - S)^-1 column_b`; gain `k`, being 1, answers that with
//! a command of its own at its bearing. Everything is linear in the gains, so a loop is the sum of what each gain makes of it.

use control::LinearLoop;
use nalgebra::{DMatrix, DVector};
use rotor::{C64, Direction, Quadratic};

use crate::Problem;

/// The rotor without control.
#[derive(Clone, Debug)]
enum Open {
    Chain(Quadratic),
    Dense(Box<Dense>),
}

/// One of shaft elements.
#[derive(Clone, Debug)]
struct Dense {
    damping: DMatrix<C64>,
    stiffness: DMatrix<C64>,
    rows: Vec<Direction>,
    /// A column for every control bearing.
    columns: DMatrix<C64>,
}

impl Dense {
    /// The displacements of all stations under harmonic accelerations of the coordinates, a column each.
    fn respond(&self, s: C64, forces: &DMatrix<C64>) -> Vec<Vec<C64>> {
        let mut rows = -(&self.damping * s + &self.stiffness);
        (0..rows.nrows()).for_each(|i| rows[(i, i)] += s * s);
        // At a pole there is no answer, and none that is finite is made up.
        let Some(moved) = rows.lu().solve(forces) else {
            return vec![vec![C64::from(f64::NAN); self.rows.len()]; forces.ncols()];
        };
        moved.column_iter().map(|q| self.rows.iter().map(|row| row.read(q.as_slice())).collect()).collect()
    }
}

/// A machine at one condition, its gains apart.
#[derive(Clone, Debug)]
pub(crate) struct Answers {
    open: Open,
    /// Stations of the control bearings.
    bearings: Vec<usize>,
    stations: usize,
    /// Which bearing every gain drives.
    pub(crate) bearing_of: Vec<usize>,
    delay: f64,
    /// Every signal with `kd` of 1 and with `cd` of 1, where the loop is more than gains and a delay.
    signals: Vec<[LinearLoop; 2]>,
    has_loop: bool,
}

impl Answers {
    /// At a condition of `problem`; `None` if there is no such loop.
    pub(crate) fn at(problem: &Problem, point: &[f64]) -> Option<Self> {
        let (structure, family, delay) = (&problem.structure, &problem.family, problem.delay(point));
        let bearings: Vec<usize> = structure.bearings().collect();
        let open = if structure.is_chain() {
            Open::Chain(family.open(point))
        } else {
            let plant = family.plant(point);
            let [damping, stiffness] = plant.linear(&family.operating(point));
            let columns: Option<Vec<DVector<C64>>> =
                bearings.iter().map(|at| Some(plant.column(*at)?.dense(plant.order()))).collect();
            let rows = plant.stations().iter().map(|station| station.row.clone()).collect();
            Open::Dense(Box::new(Dense { damping, stiffness, rows, columns: DMatrix::from_columns(&columns?) }))
        };
        let (stations, has_loop) = (structure.masses(), structure.has_loop());
        let make = |alone: &rotor::ControlBearing| LinearLoop::new(alone, stations, point[0]).ok();
        let signals = match has_loop {
            true => structure
                .unit_signals(delay)
                .iter()
                .map(|[kd, cd]| Some([make(kd)?, make(cd)?]))
                .collect::<Option<_>>()?,
            false => Vec::new(),
        };
        Some(Self { open, bearings, stations, bearing_of: structure.bearing_of_gains(), delay, signals, has_loop })
    }

    /// How many control bearings there are.
    pub(crate) fn count(&self) -> usize {
        self.bearings.len()
    }

    /// The poles of the rotor without control.
    pub(crate) fn poles(&self) -> Vec<C64> {
        match &self.open {
            Open::Chain(open) => open.poles().unwrap_or_default(),
            Open::Dense(dense) => {
                let n = dense.damping.nrows();
                let mut whole = DMatrix::zeros(2 * n, 2 * n);
                whole.view_mut((0, n), (n, n)).fill_with_identity();
                whole.view_mut((n, 0), (n, n)).copy_from(&dense.stiffness);
                whole.view_mut((n, n), (n, n)).copy_from(&dense.damping);
                rotor::eigenvalues(whole).unwrap_or_default()
            }
        }
    }

    /// The displacements of all stations under the whirl of a unit of command at each bearing.
    pub(crate) fn whirls(&self, s: C64) -> Vec<Vec<C64>> {
        match &self.open {
            Open::Chain(open) => {
                let of = |bearing: &usize| {
                    let mut whirl = vec![C64::ZERO; self.stations];
                    whirl[*bearing] = C64::ONE;
                    open.respond(s, &mut whirl);
                    whirl
                };
                self.bearings.iter().map(of).collect()
            }
            Open::Dense(dense) => dense.respond(s, &dense.columns),
        }
    }

    /// The same under forces on the coordinates.
    pub(crate) fn whirl_under(&self, s: C64, forces: &[C64]) -> Vec<C64> {
        match &self.open {
            Open::Chain(open) => {
                let mut whirl = forces.to_vec();
                open.respond(s, &mut whirl);
                whirl
            }
            Open::Dense(dense) => dense.respond(s, &DMatrix::from_column_slice(forces.len(), 1, forces)).swap_remove(0),
        }
    }

    /// What every gain answers to a whirl of the stations, with the sign of a loop's gain: less the force.
    pub(crate) fn to(&self, problem: &Problem, frequency: f64, whirls: &[Vec<C64>]) -> Vec<Vec<C64>> {
        let s = C64::new(0.0, frequency);
        if !self.has_loop {
            let late = C64::cis(-frequency * self.delay);
            let of = |whirl: &Vec<C64>| {
                problem.structure.gain_sensitivities(whirl, s).into_iter().map(|gain| gain * late).collect()
            };
            return whirls.iter().map(of).collect();
        }
        let mut made = vec![Vec::with_capacity(self.bearing_of.len()); whirls.len()];
        for pair in &self.signals {
            let answers = pair.each_ref().map(|around| around.fundamental(frequency));
            for (made, whirl) in made.iter_mut().zip(whirls) {
                let [displacement, velocity] = [0, 1].map(|k| match &answers[k] {
                    Some(answer) => -pair[k].sensors.iter().zip(answer).map(|(at, h)| h * whirl[*at]).sum::<C64>(),
                    None => C64::from(f64::NAN),
                });
                // A cross-coupled gain is the direct one times -j.
                let turned = |z: C64| C64::new(z.im, -z.re);
                made.extend([displacement, velocity, turned(displacement), turned(velocity)]);
            }
        }
        made
    }

    /// What every gain sends back of a unit of command at each bearing, gain by gain.
    pub(crate) fn loops(&self, problem: &Problem, frequency: f64) -> Vec<C64> {
        let by_bearing = self.to(problem, frequency, &self.whirls(C64::new(0.0, frequency)));
        (0..self.bearing_of.len()).flat_map(|k| by_bearing.iter().map(move |of| of[k])).collect()
    }
}
