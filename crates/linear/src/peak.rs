//! Where a function of one number is least or largest, between two places around one minimum: golden section, and parabolas where they fit
//! (Brent, *Algorithms for Minimization Without Derivatives*, 1973, ch. 5). One piece for all that seek a peak or a worst margin.

use std::convert::Infallible;

/// The smaller part of a stretch cut in golden section.
const GOLDEN: f64 = 0.381_966_011_250_105_1;
/// Finer than this part of where it is a minimum is flat to the last place.
const FLAT: f64 = 1e-10;

/// Where `look` is least between `low` and `high`, within `near`, and what it is there. For a largest, look at its negative.
///
/// The ends are not looked at. With more than one minimum between them it is one of these; what is not a number counts as large.
///
/// # Errors
/// The first of `look`.
///
/// ```
/// use std::convert::Infallible;
///
/// let Ok((at, value)) = linear::least([0.0, 3.0], 1e-9, |x| Ok::<_, Infallible>((x - 1.0).powi(2) - 4.0));
/// assert!((at - 1.0).abs() < 1e-8 && (value + 4.0).abs() < 1e-12);
/// ```
pub fn least<E>(
    [mut low, mut high]: [f64; 2],
    near: f64,
    mut look: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(f64, f64), E> {
    let mut at = |x: f64| look(x).map(|value| (x, if value.is_nan() { f64::INFINITY } else { value }));
    let mut best = at(low + GOLDEN * (high - low))?;
    // The second best, and what was that before it.
    let (mut second, mut third) = (best, best);
    // The last step, and the one before.
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    loop {
        let near = near + FLAT * best.0.abs();
        let middle = 0.5 * (low + high);
        if (best.0 - middle).abs() <= 2.0 * near - 0.5 * (high - low) {
            return Ok(best);
        }
        let parabola = (before.abs() > near).then(|| summit(best, second, third)).flatten();
        // One that stays inside, and whose steps are halved at least every other time.
        let fits = |to: &f64| *to > low && *to < high && (to - best.0).abs() < 0.5 * before.abs();
        (step, before) = match parabola.filter(fits) {
            Some(to) if to - low < 2.0 * near || high - to < 2.0 * near => (near.copysign(middle - best.0), step),
            Some(to) => (to - best.0, step),
            None => {
                let rest = if best.0 >= middle { low - best.0 } else { high - best.0 };
                (GOLDEN * rest, rest)
            }
        };
        let there = at(best.0 + if step.abs() >= near { step } else { near.copysign(step) })?;
        if there.1 <= best.1 {
            if there.0 >= best.0 {
                low = best.0;
            } else {
                high = best.0;
            }
            (best, second, third) = (there, best, second);
        } else {
            if there.0 < best.0 {
                low = there.0;
            } else {
                high = there.0;
            }
            if there.1 <= second.1 || second.0 == best.0 {
                (second, third) = (there, second);
            } else if there.1 <= third.1 || third.0 == best.0 || third.0 == second.0 {
                third = there;
            }
        }
    }
}

/// Where `of` is largest between two places with one maximum, to nine digits: finer than that a maximum is flat to the last place.
pub fn top(from: f64, to: f64, of: impl Fn(f64) -> f64) -> f64 {
    let Ok((at, _)) = least([from, to], 1e-9 * (1.0 + to.abs()), |x| Ok::<_, Infallible>(-of(x)));
    at
}

/// Where the parabola through three points has its end.
fn summit(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<f64> {
    let (left, right) = ((a.0 - b.0) * (a.1 - c.1), (a.0 - c.0) * (a.1 - b.1));
    let to = a.0 - 0.5 * ((a.0 - b.0) * left - (a.0 - c.0) * right) / (left - right);
    to.is_finite().then_some(to)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(ends: [f64; 2], near: f64, of: impl Fn(f64) -> f64) -> (f64, f64, usize) {
        let mut looks = 0;
        let Ok((at, value)) = least(ends, near, |x| {
            looks += 1;
            assert!(x > ends[0] && x < ends[1], "{x}");
            Ok::<_, Infallible>(of(x))
        });
        (at, value, looks)
    }

    #[test]
    fn smooth_minima_take_few_looks_and_kinks_no_more_than_golden_section() {
        // -sin has its minimum at pi / 2; a resonance, sharp; a kink; one at an end.
        let (at, value, looks) = counted([0.0, 3.0], 1e-9, |x| -x.sin());
        assert!((at - std::f64::consts::FRAC_PI_2).abs() < 1e-7 && value == -1.0 && looks < 24, "{at} {looks}");
        let (at, _, looks) = counted([0.0, 10.0], 1e-9, |x| -1.0 / ((x - 4.2).powi(2) + 1e-4));
        assert!((at - 4.2).abs() < 1e-8 && looks < 60, "{at} {looks}");
        let (at, _, looks) = counted([-1.0, 2.0], 1e-9, |x| (x - 0.3).abs().max(2.0 * (0.3 - x)));
        assert!((at - 0.3).abs() < 4e-9 && looks < 60, "{at} {looks}");
        let (at, _, looks) = counted([1.0, 2.0], 1e-9, |x| x);
        assert!((at - 1.0).abs() < 4e-9 && looks < 60, "{at} {looks}");
    }

    #[test]
    fn what_is_no_number_is_avoided_and_an_error_ends_it() {
        let (at, _, _) = counted([0.0, 4.0], 1e-9, |x| if x > 2.0 { f64::NAN } else { (x - 1.0).powi(2) });
        assert!((at - 1.0).abs() < 1e-7, "{at}");
        assert_eq!(least([0.0, 1.0], 1e-9, |x| if x < 0.5 { Err("no") } else { Ok(x) }), Err("no"));
    }
}
