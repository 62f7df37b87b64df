//! What a search is for, as it is typed.

use rotor::typed::{RangeError, TypedRange};
use rotor::{Key, Settings};
use tuner::LoopMargins;
use units::{Dimension, Typed};

use crate::comparison;
use crate::units::ScreenUnits;

/// Clearances for which a robust search is a matter of seconds: each doubles its work.
const FEW: usize = 4;

/// A limit that is held to this part of it is kept: the search ends on it.
const SLACK: f64 = 1e-6;

/// What is wrong with a goal as it is typed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GoalError {
    /// A limit of the margins that is none, or stands there twice.
    #[error("'{0}': expected sensitivity=NUMBER above 1, or delay=NUMBER above 0, each once")]
    Limit(String),
    /// Nothing that can be searched for.
    #[error("'{0}': expected a range of speeds such as 0..6, robust, or full")]
    Word(String),
    /// A range that says it is counted in something else.
    #[error("'{0}': {1}")]
    Unit(String, RangeError),
    /// The same once more.
    #[error("'{0}': expected one range of speeds, and robust or full once")]
    Again(String),
}

/// What is searched for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SearchGoal {
    /// The lowest spin speed at which the gains are to hold.
    pub from: f64,
    /// The highest; the same for one speed.
    pub to: f64,
    /// Whether they are to hold for any stiffness that deadband leaves of each support bearing.
    pub robust: bool,
    /// The largest peak of the loop's sensitivity at any of the conditions.
    pub max_sensitivity: Option<f64>,
    /// The smallest delay margin at any of them, in `tau`.
    pub min_delay: Option<f64>,
}

impl SearchGoal {
    /// Reads what follows `:search`. `A..B` is a range in the machine's unit of speed; without one it is the speeds that
    /// matter, from rest to a tenth past the present one. `robust` asks for gains that hold for any stiffness that its clearance leaves
    /// each support bearing, `full` for the full stiffness of all; without either it is `robust` where a clearance is set
    /// (and there are at most [`FEW`]). `sensitivity=1.5` is the largest peak of the sensitivity that is allowed, `delay=0.1` the delay that
    /// must be borne, counted as the setting of that name.
    ///
    /// # Errors
    /// What is wrong with it, for the message line.
    pub fn read(words: &str, present: &Settings, units: &ScreenUnits) -> Result<Self, GoalError> {
        // To a tenth, so that it reads well; a rotor at rest is meant to spin up.
        let past = ((1.1 * present.speed * 10.0 - 1e-9).ceil() / 10.0).max(1.0);
        let robust = comparison::has_deadband(present) && present.deadband.len() <= FEW;
        let mut goal = Self { to: past, robust, ..Self::default() };
        let mut read: Vec<bool> = Vec::new();
        for word in words.split_whitespace() {
            if let Some((name, value)) = word.split_once('=') {
                goal.limit(name, value, units).ok_or_else(|| GoalError::Limit(word.to_owned()))?;
                continue;
            }
            let range = TypedRange::read(Dimension::Speed, word)
                .and_then(|range| range.value(&units.table(), Dimension::Speed, |alone| alone / units.speed.factor));
            let is_range = match range {
                _ if word == "robust" || word == "full" => {
                    goal.robust = word == "robust";
                    false
                }
                Ok([from, to]) if from >= 0.0 => {
                    (goal.from, goal.to) = (from, to);
                    true
                }
                Err(why @ (RangeError::End(_) | RangeError::UpperUnit)) => {
                    return Err(GoalError::Unit(word.to_owned(), why));
                }
                _ => return Err(GoalError::Word(word.to_owned())),
            };
            if read.contains(&is_range) {
                return Err(GoalError::Again(word.to_owned()));
            }
            read.push(is_range);
        }
        Ok(goal)
    }

    /// Takes a limit of the margins; nothing if it is none, or is there already.
    fn limit(&mut self, name: &str, value: &str, units: &ScreenUnits) -> Option<()> {
        let (place, value, least) = match name {
            "sensitivity" => (&mut self.max_sensitivity, value.parse().ok()?, 1.0),
            "delay" => {
                let key: Key = "delay".parse().ok()?;
                let typed = Typed::read(key.parameter.dimension, value).ok()?;
                let delay = units.value_of(key, typed, |alone| alone / units.setting(key).factor);
                (&mut self.min_delay, delay.ok()?, 0.0)
            }
            _ => return None,
        };
        (place.is_none() && value > least && value.is_finite()).then(|| *place = Some(value))
    }

    /// What of the limits of the margins gains that were found do not keep, in words: nothing if they keep them.
    pub(super) fn unmet(&self, margins: Option<&[(LoopMargins, Vec<f64>); 2]>) -> Vec<String> {
        let Some([(highest, _), (least, _)]) = margins else { return Vec::new() };
        let peak = self.max_sensitivity.filter(|most| highest.sensitivity.0 > most * (1.0 + SLACK));
        let delay = self.min_delay.zip(least.delay).filter(|(wanted, (found, _))| *found < wanted * (1.0 - SLACK));
        let peak = peak.map(|most| format!("a sensitivity of {:.4}, NOT {most}", highest.sensitivity.0));
        let delay = delay.map(|(wanted, (found, _))| format!("a delay margin of {found:.4} tau, NOT {wanted}"));
        peak.into_iter().chain(delay).collect()
    }

    /// In a few words: `at R 5`, `over R 0..6, any deadband`, `over 0..20000 rpm`.
    #[must_use]
    pub fn words(&self, units: &ScreenUnits) -> String {
        let any = if self.robust { ", any deadband" } else { "" };
        let peak = self.max_sensitivity.map_or_else(String::new, |most| format!(", |S| to {most}"));
        let delay = self.min_delay.map_or_else(String::new, |least| format!(", delay from {least} tau"));
        let any = format!("{any}{peak}{delay}");
        if self.from < self.to {
            let [from, to] = [self.from, self.to].map(|speed| units.speed(speed));
            let range = if units.scales.is_some() { format!("{from}..{to} rpm") } else { format!("R {from}..{to}") };
            format!("over {range}{any}")
        } else {
            format!("at {}{any}", units.speed_told(self.from))
        }
    }
}
