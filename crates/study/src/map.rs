//! A quantity over a plane of two parameters, on all cores, with the boundary of stability traced.
//!
//! Linear quantities are of [`variation::Model`]; those of motion are of a run from rest, or from a start that an axis may be, to where it has
//! settled, and where an axis is an impulse to where it has settled once more after that. Starts or impulses along both axes make a map of
//! basins: which of them lead to the small orbit and which to the large. What they can lead to is exact: see [`Reference`].

mod axis;
mod reference;

use std::ops::Range;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use machine::{MarginsError, Program, ProgramError, default_step};
use rayon::prelude::*;
use rotor::C64;
use rotor::circular;
use variation::{Model, Parameter, VariationError};

use crate::contour::{halve, trace};
use crate::many::{Ended, many};
use crate::run::{Extent, Impulse, Plan, RunError, Settle, Settled, extent, settled_at};

pub use axis::{IMPULSE_PARTS, MapAxis, MapKey, START_PARTS};
pub use reference::{Reference, ReferenceKind};

/// More cells than this are refused: their values would take gigabytes, and their pictures more.
pub const MOST_CELLS: u64 = 1 << 24;
/// Halvings of an edge that the boundary crosses.
const HALVINGS: usize = 40;

/// What is mapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapQuantity {
    /// The smallest damping ratio.
    Damping,
    /// 1 where every mode decays, 0 where not.
    Stability,
    /// The delay margin, in `tau`.
    Delay,
    /// The peak of the sensitivity.
    Sensitivity,
    /// The largest radius of any mass once transients have died, in `e_t`.
    Orbit,
    /// The largest control force once transients have died, in `w0^2 e_t`.
    Force,
    /// The largest radius of the largest stable self-excited limit cycle, in `e_t`; 0 where there is none.
    Cycle,
    /// The frequency of that cycle, in radians per `tau`, negative backward.
    CycleFrequency,
}

/// A row of [`QUANTITIES`].
#[derive(Clone, Copy, Debug)]
pub struct QuantityRow {
    /// The quantity.
    pub quantity: MapQuantity,
    /// Its name, as typed and in columns.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Whether it takes a simulation a cell.
    pub is_simulated: bool,
}

const fn row(quantity: MapQuantity, name: &'static str, meaning: &'static str, is_simulated: bool) -> QuantityRow {
    QuantityRow { quantity, name, meaning, is_simulated }
}

/// Every quantity there is.
pub const QUANTITIES: [QuantityRow; 8] = [
    row(MapQuantity::Damping, "damping", "smallest damping ratio", false),
    row(MapQuantity::Stability, "stability", "1 where every mode decays", false),
    row(MapQuantity::Delay, "delay", "delay margin, in tau", false),
    row(MapQuantity::Sensitivity, "sensitivity", "peak of the sensitivity", false),
    row(MapQuantity::Orbit, "orbit", "largest orbit, in e_t", true),
    row(MapQuantity::Force, "force", "largest control force, in w0^2 e_t", true),
    row(MapQuantity::Cycle, "cycle", "radius of the limit cycle, in e_t", false),
    row(MapQuantity::CycleFrequency, "cycle-frequency", "frequency of the limit cycle, per tau", false),
];

impl MapQuantity {
    /// Its row.
    #[must_use]
    pub fn row(self) -> &'static QuantityRow {
        QUANTITIES.iter().find(|row| row.quantity == self).unwrap_or(&QUANTITIES[0])
    }

    /// Whether clearances count.
    #[must_use]
    pub fn has_clearance(self) -> bool {
        matches!(self, Self::Orbit | Self::Force | Self::Cycle | Self::CycleFrequency)
    }
}

/// What to map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPlan {
    /// The machine everywhere else.
    pub model: Model,
    /// Across.
    pub x: MapAxis,
    /// Up.
    pub y: MapAxis,
    /// What.
    pub quantity: MapQuantity,
    /// A run that has not settled by then, in `tau`, is told as it is then.
    pub longest: f64,
}

/// Why there is no map.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// An axis without a range.
    #[error("{key}: expected at least 2 values, found {count}")]
    Axis {
        /// The axis.
        key: String,
        /// How many values it has.
        count: usize,
    },
    /// A start or an impulse that there is none of.
    #[error("'{key}': expected {expected}")]
    Motion {
        /// What was typed.
        key: String,
        /// What there is.
        expected: String,
    },
    /// Both axes are one.
    #[error("{0} is given twice: expected two parameters")]
    Twice(String),
    /// More than can be kept.
    #[error("{0} cells: expected at most {MOST_CELLS}")]
    Cells(u64),
    /// An axis that does nothing to the quantity.
    #[error("{key} does nothing to {quantity}: {why}")]
    Nothing {
        /// The axis.
        key: String,
        /// The quantity.
        quantity: &'static str,
        /// Why.
        why: &'static str,
    },
    /// A machine of some cell cannot be.
    #[error(transparent)]
    Machine(#[from] VariationError),
    /// It cannot be stepped.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Cycles that cannot be had.
    #[error(transparent)]
    Cycles(#[from] circular::CircularError),
    /// Asked to stop.
    #[error("interrupted")]
    Interrupted,
}

/// A cell of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The quantity; not a number where there is none.
    pub value: f64,
    /// Whether it is that of a motion that had settled, or of none.
    pub is_settled: bool,
}

/// A map.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The quantity, `[x][y]`; not a number where there is none: no margins of what is not stable, no orbit of what diverged.
    pub values: Vec<Vec<f64>>,
    /// Of simulated quantities whether the motion had settled, `[x][y]`: otherwise the value is that of a motion on its way. Empty of others.
    pub settled: Vec<Vec<bool>>,
    /// Where the smallest damping is 0, as curves of `[x, y]`; of linear quantities alone.
    pub boundary: Vec<Vec<[f64; 2]>>,
}

impl MapPlan {
    /// Checks that there is something to map, and that the machines at its corners can be.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), MapError> {
        let quantity = self.quantity.row();
        for axis in [&self.x, &self.y] {
            if axis.values.len() < 2 {
                return Err(MapError::Axis { key: axis.key.name(), count: axis.values.len() });
            }
            let nothing = |why| Err(MapError::Nothing { key: axis.key.name(), quantity: quantity.name, why });
            match &axis.key {
                MapKey::Start { .. } if !quantity.is_simulated => return nothing("it is of no start"),
                MapKey::Impulse { .. } if !quantity.is_simulated => return nothing("nothing is struck"),
                MapKey::Parameter(of) if !of.is_linear() && !self.quantity.has_clearance() => {
                    return nothing("the linear rotor has none");
                }
                _ => {}
            }
        }
        if self.x.key == self.y.key {
            return Err(MapError::Twice(self.x.key.name()));
        }
        if self.cells() > MOST_CELLS {
            return Err(MapError::Cells(self.cells()));
        }
        for x in [0, self.x.values.len() - 1] {
            for y in [0, self.y.values.len() - 1] {
                self.machine(self.x.values[x], self.y.values[y])?;
            }
        }
        Ok(())
    }

    /// The machine of a place.
    fn machine(&self, x: f64, y: f64) -> Result<Model, VariationError> {
        let mut changes: Vec<(&Parameter, f64)> = Vec::with_capacity(2);
        for (key, value) in [(&self.x.key, x), (&self.y.key, y)] {
            if let MapKey::Parameter(parameter) = key {
                changes.push((parameter, value));
            }
        }
        self.model.with(&changes)
    }

    /// The quantity at a place; not a number where there is none.
    ///
    /// # Errors
    /// A machine that cannot be, or `stop`.
    pub fn at(&self, x: f64, y: f64, stop: &AtomicBool) -> Result<f64, MapError> {
        let model = self.machine(x, y)?;
        let (rotor, settings) = (&model.rotor, &model.settings);
        let margins = || match machine::margins(rotor, settings, settings.speed) {
            Ok(margins) => Ok(Some(margins)),
            Err(MarginsError::Unstable { .. }) => Ok(None),
            Err(error) => Err(VariationError::from(error)),
        };
        Ok(match self.quantity {
            MapQuantity::Damping => model.min_damping()?,
            MapQuantity::Stability => f64::from(u8::from(model.min_damping()? > 0.0)),
            MapQuantity::Delay => margins()?.and_then(|found| found.margins.delay).map_or(f64::NAN, |d| d.delay),
            MapQuantity::Sensitivity => margins()?.map_or(f64::NAN, |found| found.margins.sensitivity().amplitude),
            MapQuantity::Orbit | MapQuantity::Force => {
                self.size(&extent(&self.run(&model, [x, y], None, stop)?, stop)?)
            }
            MapQuantity::Cycle | MapQuantity::CycleFrequency => {
                let found = circular::cycles(rotor, &settings.feedback, &settings.deadband, &[settings.speed])?;
                match (circular::Orbit::largest_stable(found.orbits.iter().flatten()), self.quantity) {
                    (Ok(Some(orbit)), MapQuantity::Cycle) => orbit.largest_radius(),
                    (Ok(Some(orbit)), _) => orbit.frequency,
                    (Ok(None), MapQuantity::Cycle) => 0.0,
                    // No cycle has no frequency; nor has one that may or may not last, nor a size.
                    (Ok(None) | Err(_), _) => f64::NAN,
                }
            }
        })
    }

    /// The run from its start until it has settled; with an impulse at `struck_at` until it has settled after that. Where that moment is not
    /// known it is looked for.
    fn run(&self, model: &Model, at: [f64; 2], struck_at: Option<f64>, stop: &AtomicBool) -> Result<Plan, MapError> {
        let (rotor, settings) = (&model.rotor, &model.settings);
        let dtau = default_step(rotor, settings)?;
        let program = Program::in_substeps(rotor, settings, dtau, 1)?;
        let mut start = [vec![C64::ZERO; rotor.len()], vec![C64::ZERO; rotor.len()]];
        let mut impulses: Vec<Impulse> = Vec::new();
        for (key, value) in [&self.x.key, &self.y.key].into_iter().zip(at) {
            let along = |part: usize| if part.is_multiple_of(2) { C64::new(value, 0.0) } else { C64::new(0.0, value) };
            match key {
                MapKey::Parameter(_) => {}
                MapKey::Start { mass, part } => start[part / 2][*mass] += along(*part),
                MapKey::Impulse { mass, part } => impulses.push(Impulse { mass: *mass, change: along(*part), at: 0.0 }),
            }
        }
        let settle = Settle::DetectAndStop;
        let mut plan = Plan { program, start: Some(start), impulses: vec![], dtau, duration: self.longest, settle };
        if !impulses.is_empty() {
            // What leaves all bounds by itself needs no impulse.
            let found = struck_at.map_or_else(|| self.struck_at(&plan, stop), |at| Ok(Some(at)))?;
            if let Some(at) = found {
                plan.impulses = impulses.into_iter().map(|impulse| Impulse { at, ..impulse }).collect();
                plan.duration = at + self.longest;
            }
        }
        Ok(plan)
    }

    /// When impulses strike: once the motion without them has settled, and the unbalance next points along y.
    fn struck_at(&self, plan: &Plan, stop: &AtomicBool) -> Result<Option<f64>, MapError> {
        let Some(settled) = settled_at(plan, stop)? else { return Ok(None) };
        let turn = std::f64::consts::TAU / plan.program.speed().abs();
        let whole = (settled / turn).ceil() * turn;
        Ok(Some(if whole.is_finite() { whole } else { settled }))
    }

    /// The same, where it is one for all cells.
    fn struck_everywhere_at(&self, stop: &AtomicBool) -> Result<Option<f64>, MapError> {
        let keys = [&self.x.key, &self.y.key];
        if !keys.iter().all(|key| matches!(key, MapKey::Impulse { .. })) {
            return Ok(None);
        }
        let [x, y] = self.place(0);
        Ok(self.run(&self.machine(x, y)?, [x, y], None, stop)?.impulses.first().map(|impulse| impulse.at))
    }

    /// How large a motion is, in what is mapped.
    fn size(&self, found: &Extent) -> f64 {
        match self.quantity {
            _ if found.diverged_at.is_some() => f64::NAN,
            MapQuantity::Force => found.max_force,
            _ => found.max_displacement,
        }
    }

    /// How many cells there are.
    #[must_use]
    pub fn cells(&self) -> u64 {
        self.x.values.len() as u64 * self.y.values.len() as u64
    }

    /// Where a cell is, numbered with x slowest.
    #[must_use]
    pub fn place(&self, cell: u64) -> [f64; 2] {
        let up = self.y.values.len() as u64;
        [self.x.values[(cell / up) as usize], self.y.values[(cell % up) as usize]]
    }

    /// The quantity in some cells, numbered with x slowest; each as [`MapPlan::at`] has it. `done` is told each as it is known, from any
    /// thread and in any order.
    ///
    /// # Errors
    /// A cell that cannot be had, or `stop`.
    pub fn values(
        &self,
        cells: Range<u64>,
        stop: &AtomicBool,
        done: &(dyn Fn(u64, f64) + Sync),
    ) -> Result<Vec<Cell>, MapError> {
        if !self.quantity.row().is_simulated {
            let value = |cell: u64| match stop.load(Ordering::Relaxed) {
                true => Err(MapError::Interrupted),
                false => {
                    let [x, y] = self.place(cell);
                    let value = self.at(x, y, stop).inspect(|value| done(cell, *value));
                    Ok(Cell { value: value?, is_settled: true })
                }
            };
            return cells.into_par_iter().map(value).collect();
        }
        let found: Vec<OnceLock<Cell>> = cells.clone().map(|_| OnceLock::new()).collect();
        let interrupted = |error| match error {
            MapError::Run(RunError::Interrupted) => MapError::Interrupted,
            error => error,
        };
        let struck_at = self.struck_everywhere_at(stop).map_err(interrupted)?;
        let plan = |k: usize| {
            let [x, y] = self.place(cells.start + k as u64);
            self.run(&self.machine(x, y)?, [x, y], struck_at, stop).map(Some)
        };
        let take = |k: usize, _: &Plan, ended: Ended| {
            let value = self.size(&ended.extent);
            let is_settled = ended.extent.settled != Settled::No;
            let _ = found[k].set(Cell { value, is_settled });
            done(cells.start + k as u64, value);
            Ok(())
        };
        many(found.len(), &plan, &take, stop).map_err(interrupted)?;
        let none = Cell { value: f64::NAN, is_settled: false };
        Ok(found.into_iter().map(|cell| cell.into_inner().unwrap_or(none)).collect())
    }
}

/// Maps. `done` is told the value of every cell as it is known, numbered with x slowest, from any thread and in any order.
///
/// # Errors
/// What [`MapPlan::check`] refuses, a cell that cannot be had, or `stop`.
pub fn map(plan: &MapPlan, stop: &AtomicBool, done: &(dyn Fn(u64, f64) + Sync)) -> Result<Map, MapError> {
    plan.check()?;
    let all = plan.values(0..plan.cells(), stop, done)?;
    let columns = || all.chunks(plan.y.values.len());
    let values: Vec<Vec<f64>> = columns().map(|column| column.iter().map(|cell| cell.value).collect()).collect();
    let is_settled = |column: &[Cell]| column.iter().map(|cell| cell.is_settled).collect();
    let settled = if plan.quantity.row().is_simulated { columns().map(is_settled).collect() } else { vec![] };
    let boundary = if plan.quantity.has_clearance() { vec![] } else { boundary(plan, &values)? };
    Ok(Map { values, settled, boundary })
}

/// Where the smallest damping is 0.
fn boundary(plan: &MapPlan, values: &[Vec<f64>]) -> Result<Vec<Vec<[f64; 2]>>, MapError> {
    let damping = |x: f64, y: f64| -> Result<f64, MapError> { Ok(plan.machine(x, y)?.min_damping()?) };
    let of_all = || -> Result<Vec<Vec<f64>>, MapError> {
        let column = |x: &f64| plan.y.values.iter().map(|y| damping(*x, *y)).collect();
        plan.x.values.par_iter().map(column).collect()
    };
    let own;
    let damped = match plan.quantity {
        MapQuantity::Damping => values,
        _ => {
            own = of_all()?;
            &own
        }
    };
    // What cannot be had there counts as not stable.
    let stable = |[x, y]: [f64; 2]| damping(x, y).is_ok_and(|damping| damping > 0.0);
    Ok(trace([&plan.x.values, &plan.y.values], damped, 0.0, &|a, b| halve(a, b, HALVINGS, stable)))
}
