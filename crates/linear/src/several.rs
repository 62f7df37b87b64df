//! Several loops closed together: what no one of them tells alone.
//!
//! * The **delay margin of all**: the least delay, added to every command at once, that puts a root on the axis. There
//!   `det(I + L(j w) exp(-j w T)) = 0`, so an eigenvalue of `L(j w)` has size 1 and `T = (pi + arg) / w`.
//! * The **largest singular value of `S`** over frequency: what the worst mixture of disturbances at all commands is amplified by.

use crate::loci::{borne, loci, unit_loci};
use crate::{AmplitudePeak, C64, DelayError, DelayMargin, LoopGain};

/// What several loops have together.
#[derive(Clone, Debug, PartialEq)]
pub struct SeveralLoops {
    /// The least delay of all commands at once; `None` if no delay does.
    pub delay: Option<DelayMargin>,
    /// The largest singular value of the sensitivity over frequencies of both signs.
    pub largest_sensitivity: AmplitudePeak,
}

impl SeveralLoops {
    /// Of loops that are closed together and stable, each opened in turn. The frequencies looked at are those of the curves of all.
    ///
    /// # Errors
    /// Eigenvalues that cannot be had.
    pub fn of(each: &[LoopGain]) -> Result<Self, DelayError> {
        let Some(any) = each.first() else { return Err(DelayError::Several(0)) };
        let mut at: Vec<f64> = Vec::new();
        for gain in each {
            let end = gain.beyond(1e-2);
            at.extend(gain.curve(-end, end, &[0.0]).iter().map(|p| p.frequency));
        }
        at.sort_by(f64::total_cmp);
        at.dedup();
        Ok(Self { delay: delay(any, &at), largest_sensitivity: largest(any, &at) })
    }
}

/// Of points on either side of a sharp top both are lower than it: such a part of the highest point of all may belong to a higher top.
const NEARLY: f64 = 0.7;

fn delay(gain: &LoopGain, at: &[f64]) -> Option<DelayMargin> {
    let of = |w: f64| loci(&gain.matrix(w).gain);
    let curve: Vec<(f64, Vec<C64>)> = at.iter().map(|w| (*w, of(*w))).collect();
    let crossings = unit_loci(&curve, &of, 1.0).into_iter().filter(|locus| locus.crosses);
    let each = crossings.map(|l| DelayMargin { delay: borne(l.gain, l.frequency), frequency: l.frequency });
    each.filter(|margin| margin.delay.is_finite()).min_by(|a, b| a.delay.total_cmp(&b.delay))
}

fn largest(gain: &LoopGain, at: &[f64]) -> AmplitudePeak {
    let of = |w: f64| gain.matrix(w).largest_sensitivity();
    let values: Vec<f64> = at.iter().map(|w| of(*w)).collect();
    let highest = values.iter().copied().fold(1.0, f64::max);
    let mut best = AmplitudePeak { amplitude: 1.0, frequency: None };
    for k in 0..values.len() {
        let beside = [k.saturating_sub(1), (k + 1).min(values.len() - 1)];
        if values[k] <= NEARLY * highest || beside.iter().any(|b| values[*b] > values[k]) {
            continue;
        }
        let w = crate::peak::top(at[beside[0]], at[beside[1]], of);
        let top = of(w);
        let (top, w) = if top > values[k] { (top, w) } else { (values[k], at[k]) };
        if top > best.amplitude {
            best = AmplitudePeak { amplitude: top, frequency: Some(w) };
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::{DelaySystem, eigenvalues};

    fn of(number: impl Fn(usize, usize) -> f64, rows: usize, columns: usize) -> DMatrix<C64> {
        DMatrix::from_fn(rows, columns, |i, k| C64::from(number(i, k)))
    }

    /// Two first-order loops that do not touch each other are each what they are alone.
    #[test]
    fn loops_that_do_not_touch_are_each_alone() {
        let alone = |k: f64, p: f64| {
            DelaySystem::new(of(|_, _| -p, 1, 1), of(|_, _| -k, 1, 1), of(|_, _| 1.0, 1, 1), 0.1).unwrap()
        };
        let both = DelaySystem::new(
            of(|i, k| if i == k { -[1.0, 2.0][i] } else { 0.0 }, 2, 2),
            of(|i, k| if i == k { -[5.0, 9.0][i] } else { 0.0 }, 2, 2),
            of(|i, k| if i == k { 1.0 } else { 0.0 }, 2, 2),
            0.1,
        )
        .unwrap();
        let each = LoopGain::each(&both).unwrap();
        for (k, single) in [alone(5.0, 1.0), alone(9.0, 2.0)].iter().enumerate() {
            let (ours, theirs) = (each[k].margins(), LoopGain::of(single).unwrap().margins());
            assert!((ours.delay.unwrap().delay - theirs.delay.unwrap().delay).abs() < 1e-12);
            assert!((ours.forward.amplitude - theirs.forward.amplitude).abs() < 1e-10);
        }
        let together = SeveralLoops::of(&each).unwrap();
        let least = each.iter().map(|gain| gain.margins().delay.unwrap().delay).fold(f64::INFINITY, f64::min);
        assert!((together.delay.unwrap().delay - least).abs() < 1e-10, "{together:?} {least}");
        let most = each.iter().map(|gain| gain.margins().sensitivity().amplitude).fold(0.0, f64::max);
        assert!((together.largest_sensitivity.amplitude - most).abs() < 1e-9);
    }

    /// Loops that are coupled: closing the others is what the matrix says, the margin puts a root on the axis.
    #[test]
    fn val_a_root_is_on_the_axis_at_the_delay_margin_of_coupled_loops() {
        let number = |i: usize, k: usize| (1.0 + 1.7 * i as f64 + k as f64).sin();
        let n = 5;
        let a = of(|i, k| 0.4 * number(i, k) - if i == k { 2.0 } else { 0.0 }, n, n);
        // Forces where it is sensed, not quite: it holds, and the loops touch.
        let b = of(|i, k| 2.0 * number(i, k + 3), n, 2);
        let c = of(|k, i| -number(i, k + 3) - 0.1 * number(k, i), 2, n);
        let system = DelaySystem::new(a.clone(), b.clone(), c.clone(), 0.0).unwrap();
        assert!(eigenvalues(&a + &b * &c).unwrap().iter().all(|s| s.re < 0.0), "the example is stable");
        let each = LoopGain::each(&system).unwrap();
        for (k, gain) in each.iter().enumerate() {
            let other = 1 - k;
            let closed = &a + b.column(other) * c.row(other);
            let single = DelaySystem::new(
                closed,
                DMatrix::from_column_slice(n, 1, b.column(k).as_slice()),
                c.row(k).into_owned().reshape_generic(nalgebra::Dyn(1), nalgebra::Dyn(n)),
                0.0,
            )
            .unwrap();
            let single = LoopGain::of(&single).unwrap();
            for w in [-3.0, -0.2, 0.7, 5.0] {
                let (ours, theirs) = (gain.at(w), single.at(w));
                assert!((ours.value - theirs.value).norm() < 1e-10 * (1.0 + theirs.value.norm()), "{w}");
                assert!((ours.slope - theirs.slope).norm() < 1e-9 * (1.0 + theirs.slope.norm()), "{w}");
            }
        }
        let margin = SeveralLoops::of(&each).unwrap().delay.expect("there is one");
        let late = |share: f64| DelaySystem::new(a.clone(), b.clone(), c.clone(), share * margin.delay).unwrap();
        assert_eq!(late(0.999).count_right_of(0.0).unwrap(), 0);
        assert!(late(1.001).count_right_of(0.0).unwrap() > 0);
    }
}
