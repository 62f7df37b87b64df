//! Where the control bearing and the sensors should be: a search for every choice, and their order.

use crate::{
    Corner, Family, Measure, Options, Problem, ProblemError, Progress, Schedule, Stop, Structure, Tuned, tune,
};

/// One choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// The mass that carries the control bearing, counted from 0.
    pub bearing: usize,
    /// The masses with a sensor, counted from 0, rising.
    pub sensors: Vec<usize>,
    /// The best gains there.
    pub tuned: Tuned,
}

/// What is the same for every choice.
#[derive(Clone, Debug)]
pub struct PlacementProblem<'a> {
    /// The operating conditions.
    pub family: &'a Family,
    /// What stands around the gains.
    pub parts: rotor::Parts,
    /// Feedback whose bearings, signals, filters and loops are taken as they are, whatever place is asked for.
    pub template: Option<rotor::Feedback>,
    /// Which corners of the template's filters are searched too.
    pub corners: Vec<Corner>,
    /// Whether the sensors are summed to one signal, as in the report.
    pub composite: bool,
    /// How gains depend on speed.
    pub schedule: Schedule,
    /// What a mode is worth.
    pub measure: Measure,
    /// The largest gain.
    pub bound: f64,
    /// The largest steady control force.
    pub force_limit: Option<f64>,
    /// The largest peak of the sensitivity.
    pub max_sensitivity: Option<f64>,
    /// The smallest delay margin.
    pub min_delay: Option<f64>,
    /// Up to where modes count, see [`Problem::below`].
    pub below: Option<f64>,
}

impl PlacementProblem<'_> {
    /// The problem for one choice.
    ///
    /// # Panics
    /// If the rotor has no such mass.
    #[must_use]
    pub fn at(&self, bearing: usize, sensors: &[usize]) -> Problem {
        let rotor = self.family.rotor();
        let make = if self.composite { Structure::composite } else { Structure::individual };
        let make = || make(rotor.len(), bearing, sensors).with_parts(self.parts);
        let template = self.template.clone().unwrap_or_else(make);
        let structure = Structure::new(rotor, &template, self.schedule.clone()).expect("masses that exist");
        let structure = structure.with_corners(self.corners.clone());
        Problem {
            family: self.family.clone(),
            structure,
            measure: self.measure,
            bound: self.bound,
            force_limit: self.force_limit,
            max_sensitivity: self.max_sensitivity,
            min_delay: self.min_delay,
            below: self.below,
        }
    }
}

/// Every choice of `count` out of `masses` masses, in rising order.
#[must_use]
pub fn choices(masses: usize, count: usize) -> Vec<Vec<usize>> {
    let mut made: Vec<Vec<usize>> = vec![vec![]];
    for _ in 0..count {
        made = made
            .iter()
            .flat_map(|chosen| {
                let next = chosen.last().map_or(0, |last| last + 1);
                (next..masses).map(move |mass| [&chosen[..], &[mass]].concat())
            })
            .collect();
    }
    made
}

/// Searches for every one of `places`, a bearing and its sensors each; best first, equal ones in the order given. Once
/// stopped, those that were searched.
///
/// # Errors
/// A problem that makes no sense.
pub fn rank(
    question: &PlacementProblem<'_>,
    places: &[(usize, Vec<usize>)],
    options: &dyn Fn(&Problem) -> Options,
    progress: &(dyn Fn(&Progress) + Sync),
    stop: Stop,
) -> Result<Vec<Placement>, ProblemError> {
    let mut ranked: Vec<Placement> = Vec::new();
    for (bearing, sensors) in places {
        if stop.is_set() && !ranked.is_empty() {
            break;
        }
        let problem = question.at(*bearing, sensors);
        let tuned = tune(&problem, &options(&problem), progress, stop)?;
        ranked.push(Placement { bearing: *bearing, sensors: sensors.clone(), tuned });
    }
    ranked.sort_by(|a, b| b.tuned.worst.value.total_cmp(&a.tuned.worst.value));
    Ok(ranked)
}
