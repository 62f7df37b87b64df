//! Every self-excited circular limit cycle at one speed, set of bearings in contact by set.
//!
//! With the set `S` in contact, `c = sum_S h_k(w) e_k` with `h_k(w)` column `k` of `(Z(w) + diag(b_S))^-1` times
//! `b_k g_k`, and `Im(conj(e_k) c_k) = 0` for each mass in contact. One phase is free, so the frequency takes its place
//! among the unknowns: with one bearing in contact all that is left is `Im h_kk(w) = 0`.

use nalgebra::DVector;

use super::newton::Closing;
use super::problem::{Contact, Problem};
use super::response::{AtSpeed, crossings, patterns, sets, spread};
use super::whirl_equation::Equation;
use super::{CircularError, enumerated, homotopy};
use crate::C64;

/// Even samples of the frequency, beside those that crowd around the poles.
const EVEN: usize = 400;
/// Samples on either side of a pole, spread so that a resonance of any width is resolved.
const CROWD: usize = 40;
/// A cycle that whirls slower than this is an equilibrium off centre.
const SLOWEST: f64 = 1e-7;

/// Patterns of the factors `s_k` whose modes Newton's method starts from where nothing is proven.
const STARTS: usize = 12;

/// Limit cycles at `speed`; those that need the longest search only if it is to be `thorough`.
///
/// # Errors
/// Eigenvalues that do not converge.
pub(super) fn at_speed(problem: &Problem<'_>, speed: f64, thorough: bool) -> Result<AtSpeed, CircularError> {
    let equation = problem.at(speed);
    let gapped: Vec<usize> = problem.contacts(problem.gapped).collect();
    let mut found = Vec::new();
    for contact in sets(problem).into_iter().filter(|set| *set != 0) {
        for (c, frequency) in starts(problem, &equation, contact)? {
            let x = problem.pack(c.as_slice(), frequency, speed);
            found.extend(problem.solve(x, contact, Closing::Speed(speed)).map(|x| (x, contact)));
        }
    }
    if gapped.len() > super::ENUMERATED_FREE + 1 {
        for factors in spread(&gapped, STARTS) {
            for (c, frequency) in of_modes(problem, &equation, &gapped, &factors)? {
                let x = problem.pack(c.as_slice(), frequency, speed);
                found.extend(problem.solve_any(x, Closing::Speed(speed)));
            }
        }
        if thorough {
            found.extend(homotopy::by_growth(problem, speed)?);
        }
    }
    found.retain(|(x, contact)| {
        let (c, frequency, _) = problem.unpack(x);
        frequency.abs() > SLOWEST && *contact != 0 && problem.is_consistent(c.as_slice(), *contact, 1e-12)
    });
    Ok(AtSpeed { found, complete: gapped.len() <= super::ENUMERATED_FREE && problem.is_rational() })
}

fn starts(
    problem: &Problem<'_>,
    equation: &Equation,
    contact: Contact,
) -> Result<Vec<(DVector<C64>, f64)>, CircularError> {
    let in_contact: Vec<usize> = problem.contacts(contact).collect();
    if in_contact.len() > 2 {
        return by_modes(problem, equation, &in_contact);
    }
    let within = |k: usize| if contact >> k & 1 == 1 { 1.0 } else { 0.0 };
    let mut frequencies = grid(&equation.poles(within)?);
    if let [k] = in_contact[..] {
        frequencies.extend(enumerated::frequencies(equation, k)?);
        frequencies.sort_by(f64::total_cmp);
    }
    let columns = |w: f64| -> Option<Vec<DVector<C64>>> {
        let lu = equation.stiffened(w, within).lu();
        in_contact
            .iter()
            .map(|&k| {
                let mut unit = DVector::zeros(problem.masses);
                unit[k] = C64::from(equation.deadband_force(k));
                lu.solve(&unit).filter(|c| c.iter().all(|c| c.re.is_finite() && c.im.is_finite()))
            })
            .collect()
    };
    let all: Vec<_> = frequencies.iter().map(|&w| columns(w)).collect();
    let mut starts = Vec::new();
    for branch in 0..in_contact.len() {
        let scan: Vec<_> = frequencies
            .iter()
            .zip(&all)
            .map(|(&w, columns)| {
                let columns = columns.as_ref()?;
                let k = in_contact[0];
                let mut c = columns[0].clone();
                let mismatch = if let Some(&l) = in_contact.get(1) {
                    // Im h_kk + Im(h_kl e_l) = 0 gives two directions of l.
                    let sine = -columns[0][k].im / columns[1][k].norm();
                    if sine.is_nan() || sine.abs() > 1.0 {
                        return None;
                    }
                    let angle = if branch == 0 { sine.asin() } else { std::f64::consts::PI - sine.asin() };
                    let e_l = C64::cis(angle - columns[1][k].arg());
                    c += &columns[1] * e_l;
                    (e_l.conj() * c[l]).im
                } else {
                    c[k].im
                };
                Some((mismatch, (c, w)))
            })
            .collect();
        starts.extend(crossings(&scan));
    }
    Ok(starts)
}

/// Frequencies at which to look, ascending: even over all that the poles reach, and crowded around each of them.
fn grid(poles: &[C64]) -> Vec<f64> {
    let reach = 1.25 * poles.iter().map(|p| p.norm()).fold(0.0, f64::max) + 0.1;
    let even = (0..=EVEN).map(|i| reach * (2.0 * i as f64 / EVEN as f64 - 1.0));
    let crowded = poles.iter().flat_map(|pole| {
        (0..CROWD).map(move |i| {
            let angle = std::f64::consts::PI * ((i as f64 + 0.5) / CROWD as f64 - 0.5);
            pole.im + pole.re.abs().max(1e-9) * angle.tan()
        })
    });
    let mut all: Vec<f64> = even.chain(crowded).filter(|w| w.abs() <= reach).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Starts from modes of the rotor with many patterns of the factors `s_k`, scaled so that a typical factor is met.
fn by_modes(
    problem: &Problem<'_>,
    equation: &Equation,
    in_contact: &[usize],
) -> Result<Vec<(DVector<C64>, f64)>, CircularError> {
    let mut starts = Vec::new();
    for factors in patterns(in_contact) {
        starts.extend(of_modes(problem, equation, in_contact, &factors)?);
    }
    Ok(starts)
}

/// Whirl in the modes of the rotor with these factors, scaled so that a typical one of them is met.
fn of_modes(
    problem: &Problem<'_>,
    equation: &Equation,
    in_contact: &[usize],
    factors: &[f64],
) -> Result<Vec<(DVector<C64>, f64)>, CircularError> {
    let mut starts = Vec::new();
    for pole in equation.poles(|k| factors[k])? {
        if pole.re.abs() > 0.2 * pole.norm() {
            continue;
        }
        // One step of inverse iteration on the quadratic form gives the shape.
        let lu = equation.stiffened(pole.im + 1e-9, |k| factors[k]).lu();
        let uneven = DVector::from_fn(problem.masses, |k, _| C64::cis(k as f64 * 1.618_033_988_75));
        let Some(shape) = lu.solve(&uneven).and_then(|c| lu.solve(&(&c / C64::from(c.norm())))) else { continue };
        let touching = in_contact.iter().filter(|&&k| factors[k] > 0.0);
        let sizes = touching.map(|&k| problem.clearance(k) / (1.0 - factors[k]) / shape[k].norm());
        let amplitude = sizes.fold(f64::INFINITY, f64::min);
        if amplitude.is_finite() {
            starts.push((shape * C64::from(amplitude), pole.im));
        }
    }
    Ok(starts)
}
