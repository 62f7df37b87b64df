//! Whether orbits would stay, told of each that can be judged: a count of roots that has no end is no end of the search.

use std::cell::{Cell, RefCell};

use linear::DelayError;
use nalgebra::DVector;

use super::orbit::Orbit;
use super::problem::{Contact, Problem};
use super::whirl_equation::Equation;
use super::{CircularError, stability};
use crate::C64;

/// A count that has no end takes a second or so to be given up. So many more of them than of others, and no more are tried.
const MOST_LOST: i32 = 6;

/// Judges the orbits of one question.
pub(super) struct Judge<'a> {
    problem: &'a Problem<'a>,
    /// How many more could not be judged than could.
    lost: Cell<i32>,
    why: RefCell<Option<DelayError>>,
}

impl<'a> Judge<'a> {
    pub(super) fn of(problem: &'a Problem<'a>) -> Self {
        Self { problem, lost: Cell::new(0), why: RefCell::default() }
    }

    /// The orbit that a solution stands for, with its stability, or why nothing is known of that.
    pub(super) fn orbit(&self, x: &DVector<f64>, contact: Contact) -> Orbit {
        let equation = self.problem.at(self.problem.unpack(x).2);
        let orbit = self.unjudged(&equation, x, contact);
        Orbit { growth: self.growth(&equation, x, contact), ..orbit }
    }

    fn growth(&self, equation: &Equation, x: &DVector<f64>, contact: Contact) -> Result<f64, CircularError> {
        if self.lost.get() >= MOST_LOST
            && let Some(why) = &*self.why.borrow()
        {
            return Err(CircularError::NotTried(why.clone()));
        }
        let (c, frequency, _) = self.problem.unpack(x);
        let found = stability::growth(equation, c.as_slice(), frequency, contact, !self.problem.forced);
        let lost = match &found {
            Err(CircularError::Roots(why)) => {
                self.why.replace(Some(why.clone()));
                self.lost.get() + 1
            }
            _ => (self.lost.get() - 1).max(0),
        };
        self.lost.set(lost);
        found
    }

    /// The same without its stability, whose growth is not a number.
    pub(super) fn unjudged(&self, equation: &Equation, x: &DVector<f64>, contact: Contact) -> Orbit {
        let problem = self.problem;
        let (c, frequency, speed) = problem.unpack(x);
        let whole = equation.expanded(&c, frequency, contact);
        let forces = equation.forces(whole.as_slice(), frequency);
        let force = problem.control_masses().largest(forces.iter().copied());
        let contact = problem.places_in(contact);
        let mut amplitude = whole.as_slice().to_vec();
        if !problem.forced {
            // Of equal amplitudes the first decides, so that rounding does not.
            let largest =
                amplitude.iter().fold(C64::ZERO, |a, b| if b.norm() > a.norm() * (1.0 + 1e-6) { *b } else { a });
            amplitude.iter_mut().for_each(|c| *c *= largest.conj() / largest.norm());
        }
        Orbit { speed, frequency, amplitude, contact, force, forces, growth: Ok(f64::NAN) }
    }
}
