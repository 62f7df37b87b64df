//! Every synchronous orbit at one speed, set of bearings in contact by set.
//!
//! With the set `S` in contact the equation is linear but for the directions `e_k = c_k / |c_k|` of the masses in it:
//! `(Z + diag(b_S)) c = f + sum_S b_k g_k e_k`, so `c = A + sum_S h_k e_k` with known columns. The directions follow from
//! `Im(conj(e_k) c_k) = 0`: one angle each.

use nalgebra::{DMatrix, DVector};

use super::newton::Closing;
use super::problem::{Contact, Problem};
use super::whirl_equation::Equation;
use super::{enumerated, homotopy};
use crate::C64;

/// Above this many bearings with clearance not every set can be tried.
const MOST_SETS: usize = 5;
/// Patterns of the factors `s_k` from which Newton's method starts where nothing is proven.
const STARTS: usize = 48;

/// What was found at one speed.
pub(super) struct AtSpeed {
    /// Solutions with the set in contact that each belongs to; some may be found more than once.
    pub found: Vec<(DVector<f64>, Contact)>,
    /// There are no others, but for rounding.
    pub complete: bool,
}

/// Synchronous orbits at `speed`.
pub(super) fn at_speed(problem: &Problem<'_>, speed: f64) -> AtSpeed {
    let equation = problem.at(speed);
    let centre = vec![C64::ZERO; problem.masses];
    let gapped: Vec<usize> = problem.contacts(problem.gapped).collect();
    let unique = !gapped.is_empty() && enumerated::is_unique(&equation, speed, &gapped);
    if equation.is_balanced() {
        // At rest there may be more, but they are equilibria off centre.
        let complete = gapped.is_empty() || unique;
        return AtSpeed { found: vec![(problem.pack(&centre, speed, speed), 0)], complete };
    }
    let forcing = equation.forcing(speed);
    let mut found = Vec::new();
    let mut enumerable = true;
    for contact in sets(problem) {
        let (starts, all) = starts(problem, &equation, speed, contact);
        enumerable &= all;
        for start in starts {
            let x = problem.pack(start.as_slice(), speed, speed);
            if let Some(x) = problem.solve(x, contact, Closing::Speed(speed))
                && problem.is_consistent(problem.unpack(&x).0.as_slice(), contact, 1e-12)
            {
                found.push((x, contact));
            }
        }
    }
    let complete = (enumerable && gapped.len() <= super::ENUMERATED_FORCED) || unique;
    if !complete || found.is_empty() {
        found.extend(homotopy::by_load(problem, speed));
    }
    if !complete {
        for factors in spread(&gapped, STARTS) {
            let matrix: DMatrix<C64> = equation.stiffened(speed, |k| factors[k]);
            let Some(c) = matrix.lu().solve(&forcing).filter(is_finite) else { continue };
            found.extend(problem.solve_any(problem.pack(c.as_slice(), speed, speed), Closing::Speed(speed)));
        }
    }
    AtSpeed { found, complete }
}

/// The sets of bearings in contact that are tried: all of them, or, of very many bearings, those with few in contact or few out.
pub(super) fn sets(problem: &Problem<'_>) -> Vec<Contact> {
    let gapped: Vec<usize> = problem.contacts(problem.gapped).collect();
    if gapped.len() <= MOST_SETS {
        return (0..1_u32 << gapped.len())
            .map(|pick| gapped.iter().enumerate().fold(0, |set, (i, k)| set | (pick >> i & 1) << k))
            .collect();
    }
    let mut sets = vec![0, problem.gapped];
    for (i, &a) in gapped.iter().enumerate() {
        sets.extend([1 << a, problem.gapped & !(1 << a)]);
        sets.extend(gapped[i + 1..].iter().map(|&b| 1 << a | 1 << b));
    }
    sets
}

/// Amplitudes from which Newton's method reaches every orbit of this set; and whether it is sure to reach all.
fn starts(problem: &Problem<'_>, equation: &Equation, speed: f64, contact: Contact) -> (Vec<DVector<C64>>, bool) {
    let in_contact: Vec<usize> = problem.contacts(contact).collect();
    let within = |k: usize| if contact >> k & 1 == 1 { 1.0 } else { 0.0 };
    let lu = equation.stiffened(speed, within).lu();
    let Some(base) = lu.solve(&equation.forcing(speed)).filter(is_finite) else { return (Vec::new(), false) };
    let columns: Option<Vec<DVector<C64>>> = in_contact
        .iter()
        .map(|&k| {
            let mut unit = DVector::zeros(problem.masses);
            unit[k] = C64::from(equation.deadband_force(k));
            lu.solve(&unit).filter(is_finite)
        })
        .collect();
    let Some(columns) = columns else { return (Vec::new(), false) };
    match in_contact[..] {
        [] => (vec![base], true),
        [k] => {
            let all = directions(base[k], columns[0][k]).into_iter().map(|e| &base + &columns[0] * e).collect();
            // With nothing that drives it the phase of an orbit would be free.
            (all, base[k] != C64::ZERO)
        }
        [k, l] => two_in_contact(&base, &columns, k, l),
        _ => (by_factors(problem, equation, speed, &in_contact), false),
    }
}

fn is_finite(c: &DVector<C64>) -> bool {
    c.iter().all(|c| c.re.is_finite() && c.im.is_finite())
}

/// Unit vectors `e` with `Im(conj(e) (a + h e)) = Im(conj(e) a) + Im h = 0`: none or two.
fn directions(a: C64, h: C64) -> Vec<C64> {
    let sine = h.im / a.norm();
    // Just beyond a fold rounding may push a double root out of range.
    if !sine.is_finite() || sine.abs() > 1.0 + 1e-9 {
        return Vec::new();
    }
    // arg a - arg e = -asin(sine), or its supplement.
    let angle = sine.clamp(-1.0, 1.0).asin();
    [a.arg() + angle, a.arg() + std::f64::consts::PI - angle].map(C64::cis).to_vec()
}

/// The directions of `l` are roots of a polynomial; those of `k` follow in closed form.
fn two_in_contact(base: &DVector<C64>, columns: &[DVector<C64>], k: usize, l: usize) -> (Vec<DVector<C64>>, bool) {
    let influence = [[columns[0][k], columns[1][k]], [columns[0][l], columns[1][l]]];
    let Some(second) = enumerated::directions([base[k], base[l]], influence) else { return (Vec::new(), false) };
    let starts = second.into_iter().flat_map(|e_l| {
        let with_l = base + &columns[1] * e_l;
        directions(with_l[k], columns[0][k]).into_iter().map(move |e_k| &with_l + &columns[0] * e_k)
    });
    (starts.collect(), true)
}

/// Places in a scan where the first member changes sign, comes close to zero, or begins and ends.
pub(super) fn crossings<T: Clone>(scan: &[Option<(f64, T)>]) -> Vec<T> {
    let mut places = Vec::new();
    for (i, here) in scan.iter().enumerate() {
        let Some((value, place)) = here else { continue };
        let before = i.checked_sub(1).and_then(|i| scan[i].as_ref()).map(|(v, _)| *v);
        let after = scan.get(i + 1).and_then(|s| s.as_ref()).map(|(v, _)| *v);
        let is_place = match (before, after) {
            (Some(before), Some(after)) => {
                value * after <= 0.0 || (value.abs() <= before.abs() && value.abs() <= after.abs())
            }
            // Two roots can hide beyond the last sample before the end of a branch.
            _ => true,
        };
        if is_place {
            places.push(place.clone());
        }
    }
    places
}

/// Starts from linear solves with many patterns of the factors `s_k`.
fn by_factors(problem: &Problem<'_>, equation: &Equation, speed: f64, in_contact: &[usize]) -> Vec<DVector<C64>> {
    patterns(in_contact)
        .into_iter()
        .filter_map(|factors| {
            let matrix: DMatrix<C64> = equation.stiffened(speed, |k| factors[k.min(factors.len() - 1)]);
            matrix.lu().solve(&equation.forcing(speed)).filter(is_finite)
        })
        .filter(|c| in_contact.iter().all(|&k| c[k].norm() > 0.0))
        .inspect(|c| debug_assert_eq!(c.len(), problem.masses))
        .collect()
}

/// Factors by mass: common ones from loose to tight, and each bearing apart from the others.
pub(super) fn patterns(in_contact: &[usize]) -> Vec<Vec<f64>> {
    let size = in_contact.iter().max().map_or(1, |k| k + 1).max(crate::MAX_MASSES);
    let set = |common: f64, other: Option<(usize, f64)>| {
        let mut factors = vec![0.0; size];
        in_contact.iter().for_each(|&k| factors[k] = common);
        if let Some((k, factor)) = other {
            factors[k] = factor;
        }
        factors
    };
    let mut patterns: Vec<_> = [0.02, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 0.97].map(|s| set(s, None)).to_vec();
    for &k in in_contact {
        patterns.extend([(0.2, 0.8), (0.8, 0.2), (0.5, 0.05), (0.5, 0.95)].map(|(all, one)| set(all, Some((k, one)))));
    }
    patterns
}

/// Factors by mass, `count` patterns spread evenly over all that there are (a lattice of irrational steps), among them
/// many in which bearings are out of contact.
pub(super) fn spread(gapped: &[usize], count: usize) -> impl Iterator<Item = Vec<f64>> {
    // The positive root of x^(d+1) = x + 1: the golden ratio for more than one dimension.
    let dimension = gapped.len() as f64;
    let ratio = (0..50).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / (dimension + 1.0)));
    let gapped = gapped.to_vec();
    (1..=count).map(move |i| {
        let mut factors = vec![0.0; crate::MAX_MASSES];
        for (d, &k) in gapped.iter().enumerate() {
            let even = (0.5 + i as f64 * ratio.powi(-(d as i32) - 1)).fract();
            factors[k] = (1.35 * even - 0.3).clamp(0.0, 0.995);
        }
        factors
    })
}
