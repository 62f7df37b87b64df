//! A quantity over a plane of two parameters, on all cores, with the boundary of stability traced.
//!
//! Linear quantities are of [`variation::Model`]; those of motion are of a run from rest, or from a start that an axis may be, to where it has
//! settled. A start in one place is a basin: which starts lead to the small orbit and which to the large. The cycles that separate them are
//! exact ([`rotor::circular`]).

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
use crate::run::{Extent, Plan, RunError, Settle, extent};

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

/// What an axis is.
#[derive(Clone, Debug, PartialEq)]
pub enum MapKey {
    /// A parameter of the machine.
    Parameter(Parameter),
    /// Where a run starts: a component of displacement or velocity of a mass, from 0.
    Start {
        /// The mass.
        mass: usize,
        /// Which of [`START_PARTS`].
        part: usize,
    },
}

/// Components of a start: `start.1.y` is the displacement of mass 1.
pub const START_PARTS: [&str; 4] = ["y", "z", "vy", "vz"];

impl MapKey {
    /// The key that is typed as `name`: a parameter of the machine, or `start.N.y|z|vy|vz`.
    ///
    /// # Errors
    /// There is none.
    pub fn of(model: &Model, name: &str) -> Result<Self, VariationError> {
        let start = || {
            let (number, part) = name.strip_prefix("start.")?.split_once('.')?;
            let mass = number.parse::<usize>().ok()?.checked_sub(1).filter(|mass| *mass < model.rotor.len())?;
            let part = START_PARTS.iter().position(|own| *own == part)?;
            Some(Self::Start { mass, part })
        };
        start().map_or_else(|| model.parameter(name).map(Self::Parameter), Ok)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Parameter(parameter) => parameter.name().to_owned(),
            Self::Start { mass, part } => format!("start.{}.{}", mass + 1, START_PARTS[*part]),
        }
    }
}

/// An axis: a key and its values, rising, at least two.
#[derive(Clone, Debug, PartialEq)]
pub struct MapAxis {
    /// What varies.
    pub key: MapKey,
    /// Its values.
    pub values: Vec<f64>,
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

/// A map.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The quantity, `[x][y]`; not a number where there is none: no margins of what is not stable, no orbit of what diverged.
    pub values: Vec<Vec<f64>>,
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
            MapQuantity::Orbit | MapQuantity::Force => self.size(&extent(&self.run(&model, x, y)?, stop)?),
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

    /// The run from its start until it has settled.
    fn run(&self, model: &Model, x: f64, y: f64) -> Result<Plan, MapError> {
        let (rotor, settings) = (&model.rotor, &model.settings);
        let dtau = default_step(rotor, settings)?;
        let program = Program::in_substeps(rotor, settings, dtau, 1)?;
        let mut start = [vec![C64::ZERO; rotor.len()], vec![C64::ZERO; rotor.len()]];
        for (key, value) in [(&self.x.key, x), (&self.y.key, y)] {
            if let MapKey::Start { mass, part } = key {
                let to = &mut start[part / 2][*mass];
                if part % 2 == 0 { to.re = value } else { to.im = value }
            }
        }
        Ok(Plan {
            program,
            start: Some(start),
            impulses: vec![],
            dtau,
            duration: self.longest,
            settle: Settle::DetectAndStop,
        })
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
    ) -> Result<Vec<f64>, MapError> {
        if !self.quantity.row().is_simulated {
            let value = |cell: u64| match stop.load(Ordering::Relaxed) {
                true => Err(MapError::Interrupted),
                false => {
                    let [x, y] = self.place(cell);
                    self.at(x, y, stop).inspect(|value| done(cell, *value))
                }
            };
            return cells.into_par_iter().map(value).collect();
        }
        let found: Vec<OnceLock<f64>> = cells.clone().map(|_| OnceLock::new()).collect();
        let plan = |k: usize| {
            let [x, y] = self.place(cells.start + k as u64);
            self.run(&self.machine(x, y)?, x, y).map(Some)
        };
        let take = |k: usize, _: &Plan, ended: Ended| {
            let value = self.size(&ended.extent);
            let _ = found[k].set(value);
            done(cells.start + k as u64, value);
            Ok(())
        };
        match many(found.len(), &plan, &take, stop) {
            Err(MapError::Run(RunError::Interrupted)) => Err(MapError::Interrupted),
            Err(error) => Err(error),
            Ok(()) => Ok(found.into_iter().map(|value| value.into_inner().unwrap_or(f64::NAN)).collect()),
        }
    }
}

/// Maps. `done` is told the value of every cell as it is known, numbered with x slowest, from any thread and in any order.
///
/// # Errors
/// What [`MapPlan::check`] refuses, a cell that cannot be had, or `stop`.
pub fn map(plan: &MapPlan, stop: &AtomicBool, done: &(dyn Fn(u64, f64) + Sync)) -> Result<Map, MapError> {
    plan.check()?;
    let all = plan.values(0..plan.cells(), stop, done)?;
    let values: Vec<Vec<f64>> = all.chunks(plan.y.values.len()).map(<[f64]>::to_vec).collect();
    let boundary = if plan.quantity.has_clearance() { vec![] } else { boundary(plan, &values)? };
    Ok(Map { values, boundary })
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
