//! What a place where margins may fall short has in hand, with its slope in each variable.

use linear::{borne, loci};
use nalgebra::DMatrix;
use rotor::C64;

use super::{Ask, Opened, Place};
use crate::Problem;
use crate::corners::Weights;
use crate::loci::{adjugate, nearest};

impl Opened {
    /// What the loop of a place changes by with the weight of each gain's answer, and what it is.
    fn moved(&self, problem: &Problem, law: &Weights<'_>, place: &Place) -> (C64, Vec<C64>) {
        let (answer, m) = (self.answer(problem, place.frequency), self.open.count());
        let whole = self.sum(&answer, law, place.frequency);
        if m == 1 {
            return (whole[0], answer);
        }
        let each = answer.chunks_exact(m).zip(&self.open.bearing_of);
        match place.ask {
            Ask::Distance => {
                let b = place.bearing;
                let Some(s) = (&whole + DMatrix::<C64>::identity(m, m)).try_inverse() else {
                    return (-C64::ONE, vec![C64::ZERO; law.gains.len()]);
                };
                let square = s[(b, b)] * s[(b, b)];
                let of = |(own, at): (&[C64], &usize)| {
                    let through: C64 = (0..m).map(|j| own[j] * s[(j, b)]).sum();
                    s[(b, *at)] * through / square
                };
                (s[(b, b)].inv() - C64::ONE, each.map(of).collect())
            }
            Ask::Delay | Ask::Gain => {
                let locus = nearest(&loci(&whole), place.gain);
                // A column of the right vector times a row of the left one.
                let adjugate = adjugate(&(DMatrix::<C64>::identity(m, m) * locus - &whole));
                let give = adjugate.trace();
                let give = if give.norm() < 1e-12 { C64::from(1e-12) } else { give };
                let of = |(own, at): (&[C64], &usize)| (0..m).map(|j| own[j] * adjugate[(j, *at)]).sum::<C64>() / give;
                (locus, each.map(of).collect())
            }
        }
    }

    /// The slope of what a place has in hand in each variable, into `slope`.
    pub(crate) fn slope(&self, problem: &Problem, variables: &[f64], place: &Place, slope: &mut [f64]) {
        let law = Weights::of(&problem.structure, variables, self.speed);
        let w = place.frequency;
        let (l, by_weight) = self.moved(problem, &law, place);
        let moved = law.chain(C64::new(0.0, w), &by_weight);
        let by: Vec<f64> = match place.ask {
            Ask::Distance => {
                let by =
                    problem.max_sensitivity.unwrap_or(1.0) * (C64::ONE + l).conj() / (C64::ONE + l).norm().max(1e-12);
                moved.iter().map(|own| (by * own).re).collect()
            }
            Ask::Gain => moved.iter().map(|own| -(l.conj() * own).re / l.norm().powi(3).max(1e-12)).collect(),
            Ask::Delay => {
                let h = 1e-6 * (1e-3 + w.abs());
                let along = (self.locus(problem, &law, w + h, l) - self.locus(problem, &law, w - h, l)) / (2.0 * h);
                let size = l.norm_sqr().max(1e-12);
                // How fast |L| and its angle change along the crossing.
                let [grows, turns] = [(l.conj() * along).re / size, (l.conj() * along).im / size];
                let steep = if grows.abs() < 1e-6 { 1e-6_f64.copysign(grows) } else { grows };
                let delay = borne(l, w);
                let least = problem.min_delay.unwrap_or(1.0);
                let of = |own: &C64| {
                    let moved = -(l.conj() * own).re / size / steep;
                    let angle = (l.conj() * own).im / size + turns * moved;
                    (angle - delay * moved) / w / least
                };
                moved.iter().map(of).collect()
            }
        };
        problem.structure.spread(self.speed, &by, 0.0, slope);
    }
}
