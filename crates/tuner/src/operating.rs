//! One condition with its equations of motion at hand: its loop closed with gains, and what each pole moves by with them.

use linear::DelaySystem;
use rotor::{C64, MAX_MASSES, Quadratic};

use crate::around::{self, Around};
use crate::force::Synchronous;
use crate::opened::Opened;
use crate::{Problem, delay};

/// A condition with its equations of motion at hand.
#[derive(Clone, Debug)]
pub(crate) struct Operating {
    /// Where it is in the family.
    pub(crate) point: Vec<f64>,
    pub(crate) speed: f64,
    pub(crate) delay: f64,
    /// Control off, where the loop is gains and a delay at one bearing of a chain.
    pub(crate) open: Option<Quadratic>,
    /// Where it is more.
    pub(crate) around: Option<Box<Around>>,
    /// Where a force limit is to be kept.
    pub(crate) synchronous: Option<Synchronous>,
    /// Where margins are to be kept.
    pub(crate) opened: Option<Box<Opened>>,
}

impl Operating {
    /// The condition at `point` of the problem's family.
    pub(crate) fn at(problem: &Problem, point: &[f64]) -> Self {
        let open = problem.structure.is_plain().then(|| problem.family.open(point));
        let synchronous = problem.force_limit.map(|_| Synchronous::new(problem, point));
        let around = Around::at(problem, point).map(Box::new);
        let opened = Opened::at(problem, point).map(Box::new);
        Self { point: point.to_vec(), speed: point[0], delay: problem.delay(point), open, around, synchronous, opened }
    }

    /// The loop closed, with its poles; with a delay those of [`delay::poles`], of which `near` may be near.
    pub(crate) fn close(&self, problem: &Problem, gains: &[f64], near: &[C64]) -> Option<(Closed, Vec<C64>)> {
        if let Some(around) = &self.around {
            let closed = around.close(&problem.structure, gains)?;
            let (poles, line) = around::poles(&closed.characteristic, near)?;
            return Some((Closed::Around(Box::new(closed), line), poles));
        }
        let open = self.open.as_ref()?;
        let row = problem.structure.row(gains, self.speed);
        if self.delay > 0.0 {
            let system = delay::late(open, &row, self.delay).ok()?;
            let found = delay::poles(&system, near).ok().filter(|found| !found.roots.is_empty())?;
            return Some((Closed::Late(Box::new(system), found.right_of), found.roots));
        }
        let mut closed = open.clone();
        closed.control(&row);
        let poles = closed.poles().ok()?;
        Some((Closed::AtOnce(closed), poles))
    }

    /// What `pole` of this condition, `closed` with some gains, moves by with each variable, into `out`.
    pub(crate) fn pole_slope(&self, problem: &Problem, closed: Option<&Closed>, pole: C64, out: &mut [C64]) {
        let structure = &problem.structure;
        if let (Some(around), Some(Closed::Around(closed, _))) = (&self.around, closed) {
            structure.spread(self.speed, &around.slopes(structure, closed, pole), C64::ZERO, out);
            return;
        }
        let Some(open) = &self.open else {
            out.fill(C64::ZERO);
            return;
        };
        let (n, bearing) = (open.masses(), structure.bearing());
        let mut right = [C64::ZERO; MAX_MASSES];
        // What the pole moves by for a unit of force on the bearing's mass, in the scale of `right`.
        let per_force = match closed {
            Some(Closed::Late(system, _)) => match system.sensitivity(pole) {
                Some(at) => {
                    right[..n].copy_from_slice(&at.right.as_slice()[..n]);
                    // At a defective pole the slope is infinite: large and finite keeps a search going.
                    let give = if at.give.norm() < 1e-12 { C64::from(1e-12) } else { at.give };
                    -(-pole * self.delay).exp() * at.left[n + bearing] / give
                }
                None => C64::ZERO,
            },
            other => {
                let closed = if let Some(Closed::AtOnce(closed)) = other { closed } else { open };
                let (mut left, mut moved) = ([C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES]);
                closed.vectors(pole, &mut right[..n], &mut left[..n]);
                closed.row_times_damping(&left[..n], &mut moved[..n]);
                // q (2 lambda I - D) p: what the equation of motion gives way by as the pole moves.
                let give: C64 = (0..n).map(|i| (left[i] * (pole * 2.0) - moved[i]) * right[i]).sum();
                let floor = 1e-12 * pole.norm().max(1e-12);
                -left[bearing] / if give.norm() < floor { C64::from(floor) } else { give }
            }
        };
        structure.sensitivities(self.speed, &right[..n], pole, out);
        out.iter_mut().for_each(|s| *s *= per_force);
    }
}

/// A closed loop.
#[derive(Clone, Debug)]
pub(crate) enum Closed {
    AtOnce(Quadratic),
    /// With a delay, and the line right of which every pole was counted.
    Late(Box<DelaySystem>, f64),
    /// Through filters, lags or samples, and with a delay that line.
    Around(Box<around::Closed>, Option<f64>),
}
