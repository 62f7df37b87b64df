//! Every synchronous orbit at one speed, set of bearings in contact by set.
//!
//! With the set `S` in contact the equation is linear but for the directions `e_k = c_k / |c_k|` of the masses in it:
//! `(Z + diag(b_S)) c = f + sum_S b_k g_k e_k`, so `c = A + sum_S h_k e_k` with known columns. The directions follow from
//! `Im(conj(e_k) c_k) = 0`: one angle each.

use nalgebra::{DMatrix, DVector};

use super::newton::Closing;
use super::whirl_equation::{Contact, Equation, Problem};
use crate::C64;

/// Samples of one direction when two bearings are in contact: far finer than any pair of roots that are told apart.
const ANGLES: usize = 720;
/// Above this many bearings with clearance not every set can be tried.
const MOST_SETS: usize = 5;

/// Synchronous orbits at `speed`, with the set in contact that each belongs to; some may be found more than once.
pub(super) fn at_speed(problem: &Problem<'_>, speed: f64) -> Vec<(DVector<f64>, Contact)> {
    let equation = problem.at(speed);
    let centre = vec![C64::ZERO; problem.masses];
    if equation.forcing().iter().all(|f| *f == C64::ZERO) {
        return vec![(problem.pack(&centre, speed, speed), 0)];
    }
    let mut found = Vec::new();
    for contact in sets(problem) {
        for start in starts(problem, &equation, speed, contact) {
            let x = problem.pack(start.as_slice(), speed, speed);
            if let Some(x) = problem.solve(x, contact, Closing::Speed(speed))
                && problem.is_consistent(problem.unpack(&x).0.as_slice(), contact, 1e-12)
            {
                found.push((x, contact));
            }
        }
    }
    found
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

/// Amplitudes from which Newton's method reaches every orbit of this set.
fn starts(problem: &Problem<'_>, equation: &Equation, speed: f64, contact: Contact) -> Vec<DVector<C64>> {
    let in_contact: Vec<usize> = problem.contacts(contact).collect();
    let within = |k: usize| if contact >> k & 1 == 1 { 1.0 } else { 0.0 };
    let lu = equation.stiffened(speed, within).lu();
    let Some(base) = lu.solve(equation.forcing()).filter(is_finite) else { return Vec::new() };
    let columns: Option<Vec<DVector<C64>>> = in_contact
        .iter()
        .map(|&k| {
            let mut unit = DVector::zeros(problem.masses);
            unit[k] = C64::from(equation.slack_force(k));
            lu.solve(&unit).filter(is_finite)
        })
        .collect();
    let Some(columns) = columns else { return Vec::new() };
    match in_contact[..] {
        [] => vec![base],
        [k] => directions(base[k], columns[0][k]).into_iter().map(|e| &base + &columns[0] * e).collect(),
        [k, l] => two_in_contact(&base, &columns, k, l),
        _ => by_factors(problem, equation, speed, &in_contact),
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

/// Scans the direction of `l`, for which that of `k` follows in closed form, for zeros of what is left.
fn two_in_contact(base: &DVector<C64>, columns: &[DVector<C64>], k: usize, l: usize) -> Vec<DVector<C64>> {
    // Per branch of e_k: (mismatch at l, e_k, e_l) along the scan, broken where e_k does not exist.
    let mut starts = Vec::new();
    for branch in 0..2 {
        let scan: Vec<Option<(f64, DVector<C64>)>> = (0..=ANGLES + 1)
            .map(|i| {
                let e_l = C64::cis(std::f64::consts::TAU * i as f64 / ANGLES as f64);
                let with_l = base + &columns[1] * e_l;
                let e_k = *directions(with_l[k], columns[0][k]).get(branch)?;
                let c = with_l + &columns[0] * e_k;
                Some(((e_l.conj() * c[l]).im, c))
            })
            .collect();
        starts.extend(crossings(&scan));
    }
    starts
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
            matrix.lu().solve(equation.forcing()).filter(is_finite)
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
