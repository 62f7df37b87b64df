//! How much cross-coupled stiffness a machine bears: added at one mass, swept up until a mode has no decrement left, as the level II
//! analysis of API 617 draws it. `Q` pushes `j Q p` on the mass: forward whirl is driven.

use linear::DelayError;
use machine::CountedModes;
use nalgebra::DVector;
use plot::{Axis, Chart, Color, Look, Series};
use rotor::{C64, Characteristic, LinearForm, OperatingPoint, Plant};

use super::decrement::decrement;
use super::{Asked, AssessError, AssessmentCase, Finding, Quantity, Where};

/// Points of the curve.
const POINTS: usize = 61;
/// How far past the end the curve goes.
const PAST: f64 = 1.2;
/// The first stiffness that is tried, in `K_t`.
const FIRST: f64 = 1.0 / 64.0;
/// Doublings of it before a machine is said to bear any.
const DOUBLINGS: usize = 40;
/// Halvings of the stretch that holds the end: to the last place.
const HALVINGS: usize = 60;

/// How a machine bears cross-coupled stiffness at one speed.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossCoupling {
    /// The speed.
    pub speed: f64,
    /// The mass at which it is added, counted from 0.
    pub station: usize,
    /// The stiffness `Q_0` in `K_t` at which the machine stops being stable; nothing if it is not without any, or bears any.
    pub borne: Option<f64>,
    /// Smallest logarithmic decrement over added stiffness, `(Q, decrement)`; where no mode whirls there is no point.
    pub curve: Vec<(f64, f64)>,
}

/// A machine at one speed, before stiffness is added.
struct Machine {
    form: LinearForm,
    /// What a force at the mass does to the accelerations, per `K_t e_t`.
    pushed: DVector<C64>,
    /// What reads its displacement.
    read: DVector<C64>,
    modes: CountedModes,
}

impl Machine {
    /// Its poles with the stiffness `q`.
    fn poles(&self, q: f64) -> Result<Vec<C64>, DelayError> {
        let mut form = self.form.clone();
        let n = form.coordinates;
        // Rows of the velocities hold accelerations.
        let mut accelerations = form.a.view_mut((n, 0), (n, n));
        accelerations += &self.pushed * self.read.transpose() * C64::new(0.0, q);
        Ok(Characteristic::of(&form)?.roots()?.into_iter().map(|root| root.pole).collect())
    }

    fn is_stable(&self, q: f64) -> Result<bool, DelayError> {
        Ok(self.poles(q)?.iter().all(|pole| pole.re < 0.0))
    }

    fn decrement(&self, q: f64) -> Result<f64, DelayError> {
        let poles = self.poles(q)?;
        Ok(self.modes.among(poles).filter_map(decrement).fold(f64::INFINITY, f64::min))
    }

    /// The smallest stiffness at which it is not stable.
    fn borne(&self) -> Result<Option<f64>, DelayError> {
        if !self.is_stable(0.0)? {
            return Ok(None);
        }
        let (mut low, mut high) = (0.0, FIRST);
        for _ in 0..DOUBLINGS {
            if !self.is_stable(high)? {
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if self.is_stable(middle)? { low = middle } else { high = middle }
                }
                return Ok(Some(0.5 * (low + high)));
            }
            (low, high) = (high, 2.0 * high);
        }
        Ok(None)
    }
}

pub(super) fn lines(question: &AssessmentCase<'_>) -> Result<(Vec<Finding>, CrossCoupling, Vec<Chart>), AssessError> {
    let (rotor, limits, station) = (question.rotor, question.limits, question.cross_at);
    let speed = question.operating[1];
    let plant = Plant::of(rotor);
    let form = LinearForm::of(&plant, &question.settings.feedback, &OperatingPoint::at(speed))?;
    let missing = control::FeedbackError::Bearing { found: station + 1, masses: rotor.len() };
    let column = plant.column(station).ok_or(missing)?;
    let machine = Machine {
        form,
        // Control is an acceleration on a chain, and a force on shaft elements.
        pushed: column.dense(plant.order()) / C64::from(rotor.control_mass(station)),
        read: plant.stations()[station].row.dense(plant.order()),
        modes: question.modes,
    };
    let borne = machine.borne()?;
    let place = Where::speed(speed).of(station);
    let stable = machine.is_stable(0.0)?;
    let why = if stable {
        "no cross-coupled stiffness there makes the machine unstable"
    } else {
        "not stable without any: it bears none"
    };
    let what = "cross-coupled stiffness borne";
    let source = "API 617, level II plot";
    let mut lines = vec![match borne {
        Some(q) => Finding::told(what, Quantity::Stiffness, q, source),
        None => Finding::without(what, Quantity::Stiffness, why, source),
    }];
    if let Some(expected) = question.cross_stiffness {
        let ratio = "cross-coupled stiffness borne / expected";
        let asked = Asked::AtLeast(limits.cross_coupling_ratio);
        let source = limits.source("cross_coupling_ratio");
        lines.push(match borne {
            Some(q) => Finding::judged(ratio, Quantity::Number, q / expected, asked, &source),
            None => Finding {
                passed: Some(stable),
                asked: Some(asked),
                ..Finding::without(ratio, Quantity::Number, why, &source)
            },
        });
        let found = machine.decrement(expected)?;
        let asked = Asked::AtLeast(limits.log_decrement);
        lines.push(Finding::judged(
            "log decrement with what is expected",
            Quantity::Number,
            found,
            asked,
            &limits.source("log_decrement"),
        ));
    }
    lines.iter_mut().for_each(|line| line.place = place);
    let end = PAST * borne.or(question.cross_stiffness).unwrap_or(1.0).max(question.cross_stiffness.unwrap_or(0.0));
    let mut curve = Vec::with_capacity(POINTS);
    for k in 0..POINTS {
        let q = end * k as f64 / (POINTS - 1) as f64;
        let found = machine.decrement(q)?;
        if found.is_finite() {
            curve.push((q, found));
        }
    }
    let chart = chart(question, end, &curve);
    Ok((lines, CrossCoupling { speed, station, borne, curve }, chart))
}

fn chart(question: &AssessmentCase<'_>, end: f64, curve: &[(f64, f64)]) -> Vec<Chart> {
    let [low, high] = (curve.iter())
        .fold([0.0_f64, question.limits.log_decrement], |[low, high], (_, y)| [low.min(*y), high.max(*y)]);
    let asked = question.limits.log_decrement;
    let mut series = vec![
        Series::new("smallest decrement", Look::Solid, Color::BLUE, curve.to_vec()),
        Series::new("asked", Look::Dotted, Color::GREY, vec![(0.0, asked), (end, asked)]),
    ];
    if let Some(q) = question.cross_stiffness {
        series.push(Series::new("expected", Look::Dashed, Color::VERMILLION, vec![(q, low), (q, high)]));
    }
    vec![Chart {
        title: "Logarithmic decrement over added cross-coupled stiffness".into(),
        x: Axis::new("added cross-coupled stiffness Q / K_t", 0.0, end),
        y: Axis::new("logarithmic decrement", low, 1.05 * high),
        equal: false,
        series,
        notes: vec![],
    }]
}
