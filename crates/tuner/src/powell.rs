//! Powell's direction set method, as the report used it: for comparison.
//!
//! Line searches along a set of directions that starts with the axes; after each round the direction of the whole round may
//! replace the one that brought most (Powell 1964, with the rule of Brent 1973, ch. 7, against directions that become
//! dependent). It knows values alone, no slopes; the kinks of the objective, where the least damped mode changes, stop it.

use crate::evaluate::Evaluator;
use crate::stop::Stop;

const ROUNDS: usize = 200;
/// Relative change of the value in a round at which it ends: as in common implementations.
const TOLERANCE: f64 = 1e-8;
const GOLDEN: f64 = 0.381_966_011_250_105;

/// Raises the worst value from `gains`, in place, inside the bounds.
pub(crate) fn climb(evaluator: &mut Evaluator, gains: &mut [f64], stop: &Stop) {
    let n = gains.len();
    evaluator.clamp(gains);
    let mut directions: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let mut value = -evaluator.merit(gains);
    for _ in 0..ROUNDS {
        let (start, first) = (gains.to_vec(), value);
        let (mut most, mut best) = (0.0, 0);
        for (k, direction) in directions.iter().enumerate() {
            let before = value;
            value = line(evaluator, gains, direction, value);
            if before - value > most {
                (most, best) = (before - value, k);
            }
            if stop.is_set() {
                return;
            }
        }
        if 2.0 * (first - value) <= TOLERANCE * (first.abs() + value.abs()) + 1e-20 {
            return;
        }
        let round: Vec<f64> = gains.iter().zip(&start).map(|(a, b)| a - b).collect();
        let mut further: Vec<f64> = gains.iter().zip(&round).map(|(a, b)| a + b).collect();
        evaluator.clamp(&mut further);
        let beyond = -evaluator.merit(&further);
        if beyond < first {
            let bend = 2.0 * (first - 2.0 * value + beyond) * (first - value - most).powi(2);
            if bend < most * (first - beyond).powi(2) {
                value = line(evaluator, gains, &round, value);
                directions[best] = directions[n - 1].clone();
                directions[n - 1] = round;
            }
        }
    }
}

/// The least value along a direction: a bracket, then parabolas and golden sections (Brent 1973, ch. 5).
fn line(evaluator: &mut Evaluator, gains: &mut [f64], direction: &[f64], value: f64) -> f64 {
    // How far the bounds let it go either way.
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for ((x, d), most) in gains.iter().zip(direction).zip(&evaluator.reach).filter(|((_, d), _)| **d != 0.0) {
        let (a, b) = ((-most - x) / d, (most - x) / d);
        low = low.max(a.min(b));
        high = high.min(a.max(b));
    }
    if low > high || !low.is_finite() {
        return value;
    }
    let from = gains.to_vec();
    let mut at = |t: f64| {
        let mut there: Vec<f64> = from.iter().zip(direction).map(|(x, d)| x + t * d).collect();
        evaluator.clamp(&mut there);
        -evaluator.merit(&there)
    };
    let (mut a, mut c) = bracket(&mut at, value, low, high);
    let (mut x, mut fx) = (0.0_f64, value);
    let (mut w, mut fw, mut v, mut fv) = (x, fx, x, fx);
    let (mut step, mut last): (f64, f64) = (0.0, 0.0);
    for _ in 0..100 {
        let middle = 0.5 * (a + c);
        let close = 1e-8 * x.abs() + 1e-10;
        if (x - middle).abs() <= 2.0 * close - 0.5 * (c - a) {
            break;
        }
        let mut parabola = None;
        if last.abs() > close {
            let r = (x - w) * (fx - fv);
            let q = (x - v) * (fx - fw);
            let p = (x - v) * q - (x - w) * r;
            let q = 2.0 * (q - r);
            let (p, q) = if q > 0.0 { (-p, q) } else { (p, -q) };
            if p.abs() < (0.5 * q * last).abs() && p > q * (a - x) && p < q * (c - x) {
                parabola = Some(p / q);
            }
        }
        last = step;
        step = parabola.unwrap_or_else(|| {
            last = if x >= middle { a - x } else { c - x };
            GOLDEN * last
        });
        let u = x + if step.abs() >= close { step } else { close.copysign(step) };
        let fu = at(u);
        if fu <= fx {
            if u >= x {
                a = x;
            } else {
                c = x;
            }
            (v, fv, w, fw, x, fx) = (w, fw, x, fx, u, fu);
        } else {
            if u < x {
                a = u;
            } else {
                c = u;
            }
            if fu <= fw || w == x {
                (v, fv, w, fw) = (w, fw, u, fu);
            } else if fu <= fv || v == x || v == w {
                (v, fv) = (u, fu);
            }
        }
    }
    if fx < value {
        gains.iter_mut().zip(from.iter().zip(direction)).for_each(|(gain, (x0, d))| *gain = x0 + x * d);
        evaluator.clamp(gains);
        fx
    } else {
        value
    }
}

/// An interval around 0 with a value inside that is below those at its ends, as far as the limits allow.
fn bracket(at: &mut impl FnMut(f64) -> f64, value: f64, low: f64, high: f64) -> (f64, f64) {
    let first = 1.0_f64.min(high).max(low);
    let (sign, edge) = if first > 0.0 && at(first) < value { (1.0, high) } else { (-1.0, -low) };
    let (mut previous, mut here, mut best) = (0.0, 1.0_f64.min(edge), f64::INFINITY);
    for _ in 0..60 {
        let there = if here > 0.0 { at(sign * here) } else { value };
        if there >= value.min(best) || here >= edge {
            break;
        }
        (previous, best) = (here, there);
        here = (here * 2.618).min(edge);
    }
    // Behind the start lies what was not lower; ahead, the first that rose again.
    let behind = if previous > 0.0 { 0.0 } else { (1.0_f64).min(if sign > 0.0 { -low } else { high }) };
    let (near, far) = (-sign * behind, sign * here);
    (near.min(far), near.max(far))
}
