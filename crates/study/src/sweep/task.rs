//! What a sweep asks: a list of rows, each a pure function of its index.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use rotor::{GainKind, Key, PARAMETERS, Rotor, Settings};
use tuner::{Options, Problem, Stop};
use variation::{Distribution, Model};

use super::SweepError;
use crate::force::LONGEST;
use crate::map::{Cell, MapPlan};
use crate::scatter;

/// The column of a search with what a start ended with.
pub const OBJECTIVE: &str = "objective";

/// What is asked, row by row.
#[derive(Clone, Debug)]
pub enum Task {
    /// A map: a row a cell, x slowest.
    Map {
        /// The map.
        plan: MapPlan,
        /// What one of x, y and the quantity is in the unit that it is written in.
        units: [f64; 3],
    },
    /// Samples: a row each.
    Samples {
        /// The machine.
        model: Model,
        /// What is drawn.
        ranges: Vec<variation::Range>,
        /// How.
        distribution: Distribution,
        /// From which seed.
        seed: u64,
        /// How many.
        count: u64,
        /// What one of each parameter is in the unit that it is written in.
        units: Vec<f64>,
        /// Whether the motion of each is simulated too.
        simulated: Option<Simulated>,
    },
    /// Starts of a search: a row a climb.
    Starts {
        /// What is searched for.
        problem: Box<Problem>,
        /// How; its `starts` are the rows.
        options: Options,
    },
}

/// Samples whose motion is simulated: what one of each of its columns is in the unit that it is written in.
#[derive(Clone, Copy, Debug)]
pub struct Simulated {
    /// Of the largest orbit.
    pub orbit: f64,
    /// Of the largest force.
    pub force: f64,
}

impl Task {
    /// The rotor.
    #[must_use]
    pub fn rotor(&self) -> &Rotor {
        match self {
            Self::Map { plan, .. } => &plan.model.rotor,
            Self::Samples { model, .. } => &model.rotor,
            Self::Starts { problem, .. } => problem.family.rotor(),
        }
    }

    /// The settings of the machine; of a search with the gains and corners of the law that it begins from, at its lowest speed.
    #[must_use]
    pub fn settings(&self) -> Settings {
        match self {
            Self::Map { plan, .. } => plan.model.settings.clone(),
            Self::Samples { model, .. } => model.settings.clone(),
            Self::Starts { problem, .. } => {
                let feedback = problem.structure.feedback(&problem.structure.own());
                Settings::new(problem.family.rotor(), problem.family.speeds().0, feedback)
            }
        }
    }

    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> u64 {
        match self {
            Self::Map { plan, .. } => plan.cells(),
            Self::Samples { count, .. } => *count,
            Self::Starts { options, .. } => options.starts as u64,
        }
    }

    /// The columns of numbers; the index of a row follows them.
    #[must_use]
    pub fn columns(&self) -> Vec<String> {
        match self {
            Self::Map { plan, .. } => {
                let settled = plan.quantity.row().is_simulated.then(|| "settled".to_owned());
                let of = [plan.x.key.name(), plan.y.key.name(), plan.quantity.row().name.to_owned()];
                of.into_iter().chain(settled).collect()
            }
            Self::Samples { ranges, simulated, .. } => {
                let motion: &[&str] = if simulated.is_some() { &["orbit", "force", "bounded", "settled"] } else { &[] };
                let of = ranges.iter().map(|range| range.parameter.name());
                of.chain(["min_damping"]).chain(motion.iter().copied()).map(str::to_owned).collect()
            }
            Self::Starts { problem, .. } => {
                let corners = problem.structure.corners().iter().map(|corner| corner.name.clone());
                [OBJECTIVE.to_owned()].into_iter().chain(gain_names(problem, &self.settings())).chain(corners).collect()
            }
        }
    }

    /// Some rows.
    pub(super) fn some(&self, rows: Range<u64>, stop: &AtomicBool) -> Result<Vec<Vec<f64>>, SweepError> {
        match self {
            Self::Map { plan, units } => {
                let values = plan.values(rows.clone(), stop, &|_, _| ())?;
                let settled = |cell: &Cell| plan.quantity.row().is_simulated.then(|| flag(cell.is_settled));
                let row = |(number, cell): (u64, &Cell)| {
                    let [x, y] = plan.place(number);
                    let numbers = [x, y, cell.value].into_iter().zip(units).map(|(value, unit)| value * unit);
                    numbers.chain(settled(cell)).collect()
                };
                Ok(rows.zip(&values).map(row).collect())
            }
            Self::Samples { model, ranges, distribution, seed, units, simulated, .. } => {
                let row = |index: u64| {
                    if stop.load(Ordering::Relaxed) {
                        return Err(SweepError::Interrupted);
                    }
                    let damping = variation::samples(model, ranges, *distribution, *seed, [index, 1], &|_| ())?;
                    let values = variation::values(ranges, *distribution, *seed, index);
                    let values = values.iter().zip(units).map(|(value, unit)| value * unit);
                    Ok(values.chain(damping).collect())
                };
                let mut made: Vec<Vec<f64>> = rows.clone().into_par_iter().map(row).collect::<Result<_, _>>()?;
                if let Some(simulated) = simulated {
                    let found = scatter::motions(model, ranges, (*distribution, *seed), rows, LONGEST, stop, &|| ())?;
                    made.iter_mut().zip(&found).for_each(|(row, found)| row.extend(simulated.columns(found)));
                }
                Ok(made)
            }
            Self::Starts { problem, options } => {
                let structure = &problem.structure;
                let row = |start: u64| {
                    let climbed = tuner::climb_from(problem, options, start as usize, Stop::when(stop))?;
                    // A climb that was broken off is not what it would have come to.
                    if stop.load(Ordering::Relaxed) {
                        return Err(SweepError::Interrupted);
                    }
                    let gains = structure.gain_values(&climbed.gains);
                    let corners = structure.corner_values(&climbed.gains);
                    Ok([climbed.value].into_iter().chain(gains).chain(corners).collect())
                };
                rows.into_par_iter().map(row).collect()
            }
        }
    }
}

/// The gains of a search as `whirl set` has them, one that depends on speed once for each speed at which it is searched.
fn gain_names(problem: &Problem, settings: &Settings) -> Vec<String> {
    let speeds = problem.structure.schedule().speeds();
    let rows = GainKind::ALL.iter().filter_map(|kind| PARAMETERS.iter().find(|row| row.gain == Some(*kind)));
    let rows: Vec<_> = rows.collect();
    let signals = 0..settings.feedback.signal_count();
    let keys = signals.flat_map(|signal| rows.iter().map(move |row| Key { parameter: row, index: Some(signal) }));
    let named = |key: Key| {
        let name = settings.label(key);
        match &speeds[..] {
            [] => vec![name],
            speeds => speeds.iter().map(|speed| format!("{name} at {speed}")).collect(),
        }
    };
    keys.flat_map(named).collect()
}

/// Yes or no among numbers.
fn flag(is_so: bool) -> f64 {
    f64::from(u8::from(is_so))
}

impl Simulated {
    /// The columns of a motion; of one that left all bounds no size.
    fn columns(self, found: &crate::run::Extent) -> [f64; 4] {
        let bounded = found.diverged_at.is_none();
        let size = |of: f64, unit: f64| if bounded { of * unit } else { f64::NAN };
        let settled = bounded && found.settled != crate::run::Settled::No;
        [size(found.max_displacement, self.orbit), size(found.max_force, self.force), flag(bounded), flag(settled)]
    }
}
