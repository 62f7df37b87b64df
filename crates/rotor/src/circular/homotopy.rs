//! Orbits at one speed by homotopy from the free and from the tight rotor, where the bearings are linear.
//!
//! * Response: the unbalance is scaled from so little that no clearance is used up (the free rotor) to so much that the
//!   clearances no longer matter (the tight one). There the orbit is unique, so the way from one to the other passes the
//!   true unbalance an odd number of times, and every passage is an orbit.
//! * Cycles: whirl may grow or decay at a rate of its own, whatever its size. Such *nonlinear modes* begin as the modes of
//!   the free rotor, where whirl of growing size first touches a bearing, and end as those of the tight one; where the rate
//!   passes zero is a cycle.
//!
//! What hangs on neither end (an island) is not found this way.

use nalgebra::DVector;

use super::CircularError;
use super::newton::Closing;
use super::problem::{Along, Contact, Problem};
use super::tracer::{Node, Tracer};
use super::whirl_equation::Equation;
use crate::C64;

/// An orbit this many clearances wide is one of the tight rotor.
const TIGHT: f64 = 300.0;
/// The longest way to there, as a logarithm of the unbalance.
const LONGEST_WAY: f64 = 14.0;

/// Where an orbit is, as unknowns of the problem over speed, and its set in contact.
type Found = Vec<(DVector<f64>, Contact)>;

/// Synchronous orbits on the way from the free rotor to the tight one.
pub(super) fn by_load(problem: &Problem<'_>, speed: f64) -> Found {
    let equation = problem.at(speed);
    let way = problem.along(Along::Load { speed });
    let linear = |factor: f64| equation.stiffened(speed, |_| factor).lu().solve(&equation.forcing(speed));
    let relative = |c: &DVector<C64>| -> Vec<f64> {
        problem.contacts(problem.gapped).map(|k| c[k].norm() / problem.clearance(k)).collect()
    };
    let (Some(free), Some(tight)) = (linear(0.0), linear(1.0)) else { return Vec::new() };
    let widest = relative(&free).into_iter().fold(0.0, f64::max);
    let ratios = relative(&tight);
    let most = ratios.iter().copied().fold(0.0, f64::max);
    // A mass at a node never leaves its clearance.
    let least = ratios.into_iter().filter(|r| *r > 1e-6 * most).fold(f64::INFINITY, f64::min);
    if !(widest.is_finite() && widest > 0.0 && least.is_finite() && most > 0.0) {
        return Vec::new();
    }
    let from = (0.5 / widest).ln().min(-1.0);
    let to = (TIGHT / least).ln().clamp(1.0, LONGEST_WAY);
    let tracer = Tracer::new(&way, (from - 0.1, to));
    let start = |c: DVector<C64>, contact, at: f64| {
        let x = way.pack((c * C64::from(at.exp())).as_slice(), speed, at);
        way.solve(x, contact, Closing::Speed(at)).map(|x| Node { x, contact, fold: false })
    };
    let mut found = Vec::new();
    for (start, sign) in [(start(free, 0, from), 1.0), (start(tight, problem.gapped, to), -1.0)] {
        let Some(start) = start else { continue };
        let (nodes, _) = tracer.follow(&start, sign);
        found.extend(passages(problem, &way, &nodes, speed));
        // One way is the other, unless it was lost.
        let reached = nodes
            .last()
            .is_some_and(|node| (node.x[node.x.len() - 1] - start.x[start.x.len() - 1]).abs() > 0.99 * (to - from));
        if reached {
            break;
        }
    }
    found
}

/// Cycles on the nonlinear modes that begin at the free rotor and that end at the tight one.
///
/// # Errors
/// Eigenvalues that do not converge.
pub(super) fn by_growth(problem: &Problem<'_>, speed: f64) -> Result<Found, CircularError> {
    let equation = problem.at(speed);
    let way = problem.along(Along::Growth { speed });
    let ends = [equation.poles(|_| 0.0)?, equation.poles(|_| 1.0)?];
    let reach = ends.iter().flatten().map(|p| p.re.abs()).fold(0.0, f64::max);
    let tracer = Tracer::new(&way, (-3.0 * reach - 1.0, 3.0 * reach + 1.0));
    let [free, tight] = &ends;
    let mut found = Vec::new();
    let mut reached: Vec<C64> = Vec::new();
    for &pole in free {
        let Some(shape) = shape(&equation, pole, 0.0) else { continue };
        let touching = problem
            .contacts(problem.gapped)
            .map(|k| (problem.clearance(k) / shape[k].norm(), k))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((size, first)) = touching.filter(|(size, _)| *size < 1e9) else { continue };
        let x = way.pack((shape * C64::from(size)).as_slice(), pole.im, pole.re);
        let start = Node { x, contact: 1 << first, fold: false };
        for sign in [1.0, -1.0] {
            let (nodes, _) = tracer.follow(&start, sign);
            found.extend(passages(problem, &way, &nodes, speed));
            if let Some(node) = nodes.last() {
                let (_, frequency, growth) = way.unpack(&node.x);
                reached.push(C64::new(growth, frequency));
            }
        }
    }
    for &pole in tight {
        if reached.iter().any(|end| (end - pole).norm() < 1e-2 * (0.1 + pole.norm())) {
            continue;
        }
        let Some(shape) = shape(&equation, pole, 1.0) else { continue };
        let widest = shape.iter().map(|c| c.norm()).fold(0.0, f64::max);
        let sizes = problem.contacts(problem.gapped).map(|k| (problem.clearance(k) / shape[k].norm(), k));
        let sizes: Vec<_> = sizes.filter(|(_, k)| shape[*k].norm() > 1e-6 * widest).collect();
        let size = TIGHT * sizes.iter().map(|s| s.0).fold(0.0, f64::max);
        let contact = sizes.iter().fold(0, |set: Contact, (_, k)| set | 1 << k);
        if contact == 0 || !size.is_finite() {
            continue;
        }
        let x = way.pack((shape * C64::from(size)).as_slice(), pole.im, pole.re);
        // The size is held: the part of the amplitudes along themselves.
        let mut row = x.clone();
        row.rows_mut(2 * problem.masses, 2).fill(0.0);
        row.unscale_mut(row.norm_squared().max(f64::MIN_POSITIVE));
        let Some(x) = way.solve(x.clone(), contact, Closing::Plane { at: &x, row: &row }) else { continue };
        let start = Node { x, contact, fold: false };
        for sign in [1.0, -1.0] {
            found.extend(passages(problem, &way, &tracer.follow(&start, sign).0, speed));
        }
    }
    Ok(found)
}

/// The shape of a mode of the rotor whose bearings with clearance have `factor` of their stiffness.
fn shape(equation: &Equation, pole: C64, factor: f64) -> Option<DVector<C64>> {
    // Inverse iteration on the quadratic form, a little off the pole.
    let growing = equation.growing(pole.re + 1e-9 * (1.0 + pole.norm()));
    let lu = growing.stiffened(pole.im, |_| factor).lu();
    let uneven = DVector::from_fn(growing.unknowns(), |k, _| C64::cis(k as f64 * 1.618_033_988_75));
    let once = lu.solve(&uneven)?;
    let twice = lu.solve(&(&once / C64::from(once.norm())))?;
    let size = twice.norm();
    (size.is_finite() && size > 0.0).then(|| twice / C64::from(size))
}

/// Orbits of the true rotor on a way: where its last unknown passes zero.
fn passages(problem: &Problem<'_>, way: &Problem<'_>, nodes: &[Node], speed: f64) -> Found {
    let passed = nodes.windows(2).filter_map(|pair| way.between(&pair[0], &pair[1], 0.0).map(|x| (x, pair[1].contact)));
    passed
        .map(|(x, contact)| {
            let (c, frequency, _) = way.unpack(&x);
            (problem.pack(c.as_slice(), frequency, speed), contact)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mass, Rotor, builtin};

    fn radii(problem: &Problem<'_>, found: &Found) -> Vec<f64> {
        let mut all: Vec<f64> = found.iter().map(|(x, _)| problem.unpack(x).0[0].norm()).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| (*a - *b).abs() < 1e-8 * *b);
        all
    }

    /// One mass meets its three orbits one after the other as the unbalance grows: the roots of its quadratic.
    #[test]
    fn the_way_over_the_unbalance_passes_every_orbit_of_one_mass() {
        let (damping, b, g) = (0.01, 0.8, 5.0);
        let mass =
            Mass { mass: 1.0, damping, bearing_stiffness: b, seal_stiffness: 0.5, unbalance: 1.0, ..Mass::default() };
        let rotor = Rotor::new("one", vec![mass], vec![]).unwrap();
        let feedback = builtin::feedback(&rotor, "off").unwrap();
        let problem = Problem::new(&rotor, &feedback, &[g], true).unwrap();
        let mut several = 0;
        for speed in (1..60).map(|i| f64::from(i) * 0.05 + 0.003) {
            let (z, f) = (C64::new(0.5 - speed * speed, damping * speed), speed * speed);
            let mut expected: Vec<f64> = Some(f / z.norm()).into_iter().filter(|r| *r <= g).collect();
            let (qa, qb, qc) = ((z + b).norm_sqr(), -2.0 * (z + b).re * b * g, (b * g).powi(2) - f * f);
            let discriminant = qb * qb - 4.0 * qa * qc;
            if discriminant > 0.0 {
                let both = [-1.0, 1.0].map(|sign| (-qb + sign * discriminant.sqrt()) / (2.0 * qa));
                expected.extend(both.into_iter().filter(|r| *r > g));
            }
            expected.sort_by(f64::total_cmp);
            let found = radii(&problem, &by_load(&problem, speed));
            assert_eq!(found.len(), expected.len(), "R = {speed}: {found:?} for {expected:?}");
            assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-8 * b), "{found:?} for {expected:?}");
            assert_eq!(found.len() % 2, 1, "from the free to the tight rotor it passes an odd number of times");
            several += usize::from(found.len() > 1);
        }
        assert!(several > 3, "{several}");
    }

    #[test]
    fn the_nonlinear_mode_of_one_mass_passes_its_cycle() {
        let rotor = builtin::rotor("jeffcott").unwrap();
        let feedback = builtin::feedback(&rotor, "off").unwrap();
        let problem = Problem::new(&rotor, &feedback, &[1.0], false).unwrap();
        let mut cycles = 0;
        for speed in [0.5, 1.0, 1.3, 1.7, 2.0, 2.5, 3.0] {
            let w = speed / 2.0;
            let s = (w * w - 0.2 * w - 0.2) / 0.8;
            let found = by_growth(&problem, speed).unwrap();
            if s > 0.0 && s < 1.0 {
                let [radius] = radii(&problem, &found)[..] else { panic!("one cycle at R = {speed}: {found:?}") };
                assert!((radius * (1.0 - s) - 1.0).abs() < 1e-9, "R = {speed}: {radius}");
                assert!((problem.unpack(&found[0].0).1 - w).abs() < 1e-10);
                cycles += 1;
            } else {
                assert!(found.is_empty(), "R = {speed}: {found:?}");
            }
        }
        assert!(cycles >= 2, "{cycles}");
    }

    #[test]
    fn the_shape_of_a_mode_is_a_vector_of_its_pole() {
        let rotor = builtin::rotor("three-mass").unwrap();
        let feedback = builtin::feedback(&rotor, "off").unwrap();
        let equation = Problem::new(&rotor, &feedback, &[1.0; 3], false).unwrap().at(3.0);
        for factor in [0.0, 1.0] {
            for pole in equation.poles(|_| factor).unwrap() {
                let shape = shape(&equation, pole, factor).unwrap();
                let left = (equation.growing(pole.re).stiffened(pole.im, |_| factor) * shape).norm();
                assert!(left < 1e-8, "{left:e} at {pole}");
            }
        }
    }
}
