//! The worst mode at one condition, for scans, proofs and answers: poles alone, and those within rounding of the axis told as on it.

use linear::DelaySystem;
use rotor::C64;

use crate::operating::{Closed, Operating};
use crate::{Measure, Problem, around};

/// The worst mode at one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Worst {
    /// What it is worth; `-inf` if the poles cannot all be had.
    pub(crate) value: f64,
    /// Its pole.
    pub(crate) pole: C64,
    /// With a delay: every pole right of this was counted.
    pub(crate) right_of: Option<f64>,
}

/// The worst mode at one condition, poles on the axis but for rounding told as on it: a marginal one is worth exactly 0.
pub(crate) fn worst_at(problem: &Problem, gains: &[f64], point: &[f64]) -> Worst {
    let nothing = Worst { value: f64::NEG_INFINITY, pole: C64::ZERO, right_of: None };
    if !problem.structure.is_plain() {
        // Put together once, not once per gain.
        let Some((poles, right_of)) = around::poles_of(problem, gains, point) else { return nothing };
        let (value, pole) = problem.worst(&poles);
        return Worst { value, pole, right_of };
    }
    let operating = Operating {
        point: Vec::new(),
        speed: point[0],
        delay: problem.delay(point),
        open: Some(problem.family.open(point)),
        around: None,
        synchronous: None,
        opened: None,
    };
    let Some((closed, mut poles)) = operating.close(problem, gains, &[]) else { return nothing };
    let row = problem.structure.row(gains, point[0]);
    let right_of = match closed {
        Closed::Around(_, line) => line,
        Closed::AtOnce(closed) => {
            closed.settle(&mut poles);
            None
        }
        Closed::Late(system, line) => {
            if let Some(mut at_once) = operating.open {
                at_once.control(&row);
                at_once.settle_by(&mut poles, &|pole| condition(&system, pole));
            }
            Some(line)
        }
    };
    let (value, pole) = match problem.measure {
        Measure::Cost(cost) if poles.iter().all(|pole| pole.re < 0.0) => {
            let Some(value) = cost.worth(problem, gains, point, &mut []) else { return nothing };
            (value, poles.iter().max_by(|a, b| a.re.total_cmp(&b.re)).copied().unwrap_or_default())
        }
        _ => problem.worst(&poles),
    };
    Worst { value, pole, right_of }
}

/// The size of `q Q'(pole) p` with the vectors in norm 1: the state is displacement over velocity, and `q` is what the row
/// has for the velocities. 0, which is the worst, if the vectors cannot be had.
fn condition(system: &DelaySystem, pole: C64) -> f64 {
    let Some(at) = system.sensitivity(pole) else { return 0.0 };
    let n = at.right.len() / 2;
    let sizes = at.right.rows(0, n).norm() * at.left.rows(n, n).norm();
    if sizes > 0.0 { at.give.norm() / sizes } else { 0.0 }
}
