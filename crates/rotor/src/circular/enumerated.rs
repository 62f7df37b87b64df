//! Every orbit that presses on few bearings, as roots of polynomials: none can be missed but for rounding.

use nalgebra::{DMatrix, DVector};

use super::whirl_equation::Equation;
use crate::{C64, PoleError, eigenvalues};

/// How far from the unit circle a computed root may be and still stand for a direction: double roots are known to the
/// square root of rounding. Newton's method tells those that are none.
const OFF_CIRCLE: f64 = 1e-3;
/// How far from the imaginary axis a computed zero may be, relative to its size.
const OFF_AXIS: f64 = 1e-3;

/// The direction `u = e_l` of the second of two masses in contact, for every synchronous orbit:
///
/// ```text
/// Im conj(z) (a_k + h_kk z + h_kl u) = 0,  Im conj(u) (a_l + h_lk z + h_ll u) = 0,   |z| = |u| = 1
/// ```
///
/// Each is a quadratic in `z` with coefficients in `u`; their resultant is a polynomial of degree six. `None` if it
/// vanishes: the directions are not isolated.
pub(super) fn directions(a: [C64; 2], h: [[C64; 2]; 2]) -> Option<Vec<C64>> {
    let j2 = |x: f64| C64::new(0.0, 2.0 * x);
    let [[h_kk, h_kl], [h_lk, h_ll]] = h;
    // In ascending powers of u; the coefficients of z^2, z and 1.
    let first = [vec![-h_kl.conj(), -a[0].conj()], vec![C64::ZERO, j2(h_kk.im)], vec![C64::ZERO, a[0], h_kl]];
    let second = [vec![h_lk], vec![a[1], j2(h_ll.im), -a[1].conj()], vec![C64::ZERO, C64::ZERO, -h_lk.conj()]];
    let cross = |i: usize, k: usize| minus(&times(&second[i], &first[k]), &times(&first[i], &second[k]));
    let outer = cross(0, 2);
    let resultant = minus(&times(&outer, &outer), &times(&cross(0, 1), &cross(1, 2)));
    roots(&resultant).map(|all| {
        all.into_iter().filter(|u| (u.norm() - 1.0).abs() < OFF_CIRCLE).map(|u| u / C64::from(u.norm())).collect()
    })
}

fn times(a: &[C64], b: &[C64]) -> Vec<C64> {
    let mut product = vec![C64::ZERO; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (k, y) in b.iter().enumerate() {
            product[i + k] += x * y;
        }
    }
    product
}

fn minus(a: &[C64], b: &[C64]) -> Vec<C64> {
    let at = |v: &[C64], i: usize| v.get(i).copied().unwrap_or(C64::ZERO);
    (0..a.len().max(b.len())).map(|i| at(a, i) - at(b, i)).collect()
}

/// Roots of a polynomial in ascending powers but for those at zero and infinity, as eigenvalues of its companion matrix.
fn roots(polynomial: &[C64]) -> Option<Vec<C64>> {
    let largest = polynomial.iter().map(|c| c.norm()).fold(0.0, f64::max);
    let counts = |c: &C64| c.norm() > 1e-14 * largest;
    let (low, high) = (polynomial.iter().position(counts)?, polynomial.iter().rposition(counts)?);
    let degree = high - low;
    let mut companion = DMatrix::<C64>::zeros(degree, degree);
    for i in 0..degree {
        if i > 0 {
            companion[(i, i - 1)] = C64::ONE;
        }
        companion[(i, degree - 1)] = -polynomial[low + i] / polynomial[high];
    }
    if degree == 0 { Some(Vec::new()) } else { eigenvalues(companion).ok() }
}

/// Frequencies of every cycle that presses on bearing `k` alone, among others: the zeros of `Im h_kk(w)` as those of the
/// linear system `h(s) - conj(h(-conj(s)))`, eigenvalues of a pencil. With a delay there is no such system: none are given.
///
/// # Errors
/// Eigenvalues that do not converge.
pub(super) fn frequencies(equation: &Equation, k: usize) -> Result<Vec<f64>, PoleError> {
    let Some(a) = equation.state_matrix(|i| if i == k { 1.0 } else { 0.0 }) else { return Ok(Vec::new()) };
    let size = a.nrows();
    let (n, coordinate) = (equation.order(), equation.coordinate(k));
    let all = 2 * size + 1;
    let mut pencil = DMatrix::<C64>::zeros(all, all);
    pencil.view_mut((0, 0), (size, size)).copy_from(&a);
    pencil.view_mut((size, size), (size, size)).copy_from(&-a.conjugate());
    for half in [0, size] {
        pencil.view_mut((half + n, all - 1), (n, 1)).copy_from(&equation.push(coordinate));
        pencil[(all - 1, half + coordinate)] = C64::ONE;
    }
    // Off the axis, where no zero sought can be.
    let shift = 1.0 + 0.1 * a.norm();
    for i in 0..2 * size {
        pencil[(i, i)] -= shift;
    }
    let mut finite = DMatrix::<C64>::identity(all, all);
    finite[(all - 1, all - 1)] = C64::ZERO;
    let Some(inverse) = pencil.lu().solve(&finite) else { return Ok(Vec::new()) };
    let zeros = eigenvalues(inverse)?.into_iter().filter(|z| z.norm() > 1e-9).map(|z| z.inv() + shift);
    Ok(zeros.filter(|s| s.re.abs() < OFF_AXIS * (1.0 + s.norm())).map(|s| s.im).collect())
}

/// Whether there is exactly one synchronous orbit, whatever it presses on: the bearings, each a projection and so no
/// steeper than `b_k`, make the equation a contraction in a weighted norm.
///
/// With `b s(|c|) c = b/2 (c + D(c))`, `D` a reflection that lengthens nothing, the orbit is a fixed point of
/// `c = (Z + B/2)^-1 (f - B/2 D(c))`.
pub(super) fn is_unique(equation: &Equation, speed: f64, gapped: &[usize]) -> bool {
    let m = gapped.len();
    let lu = equation.stiffened(speed, |_| 0.5).lu();
    let mut gain = DMatrix::<C64>::zeros(m, m);
    for (column, &k) in gapped.iter().enumerate() {
        let mut unit = DVector::zeros(equation.unknowns());
        unit[k] = C64::from(0.5 * equation.bearing_stiffness(k));
        let Some(c) = lu.solve(&unit) else { return false };
        for (row, &i) in gapped.iter().enumerate() {
            gain[(row, column)] = c[i];
        }
    }
    // Weights from the positive eigenvectors of the moduli: a good guess; any weights prove.
    let moduli = gain.map(|x| x.norm());
    let (mut right, mut left) = (DVector::from_element(m, 1.0), DVector::from_element(m, 1.0));
    for _ in 0..30 {
        right = &moduli * &right + &right * 1e-6;
        left = moduli.tr_mul(&left) + &left * 1e-6;
        right.unscale_mut(right.max().max(f64::MIN_POSITIVE));
        left.unscale_mut(left.max().max(f64::MIN_POSITIVE));
    }
    let weight = |k: usize| (left[k] / right[k]).sqrt();
    let weighted = DMatrix::from_fn(m, m, |i, k| gain[(i, k)] * (weight(i) / weight(k)));
    let squares = weighted.adjoint() * &weighted;
    eigenvalues(squares).is_ok_and(|all| all.iter().all(|s| s.norm() < 1.0 - 1e-9))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circular::newton::Closing;
    use crate::circular::problem::Problem;
    use crate::{Feedback, Mass, Rotor, builtin};

    fn complex(random: &mut fastrand::Rng) -> C64 {
        C64::new(2.0 * random.f64() - 1.0, 2.0 * random.f64() - 1.0)
    }

    #[test]
    fn roots_are_those_of_the_factors_but_for_zero() {
        let factors = [C64::from(2.0), C64::new(0.0, 3.0), C64::new(-0.5, 0.5)];
        let product = factors.iter().fold(vec![C64::ZERO, C64::ZERO, C64::ONE], |p, r| times(&p, &[-r, C64::ONE]));
        let found = roots(&product).unwrap();
        assert_eq!(found.len(), 3);
        for factor in factors {
            assert!(found.iter().any(|r| (r - factor).norm() < 1e-12), "{factor} in {found:?}");
        }
        assert_eq!(roots(&[C64::ZERO; 3]), None, "nothing is everywhere zero in isolation");
        assert_eq!(roots(&[C64::ZERO, C64::ONE]), Some(vec![]));
    }

    #[test]
    fn every_direction_that_a_scan_of_the_circle_meets_is_a_root() {
        const SAMPLES: usize = 2000;
        let (mut random, mut met) = (fastrand::Rng::with_seed(1), 0);
        for _ in 0..60 {
            let a = [complex(&mut random), complex(&mut random)];
            let h = [[complex(&mut random), complex(&mut random)], [complex(&mut random), complex(&mut random)]];
            let all = directions(a, h).unwrap();
            assert!(all.len() <= 6, "{all:?}");
            // Im conj(z) (a_k + h_kl u) = -Im h_kk leaves two z for each u; the second equation tells which u.
            let mismatch = |at: usize, branch: usize| {
                let u = C64::cis(std::f64::consts::TAU * at as f64 / SAMPLES as f64);
                let drive = a[0] + h[0][1] * u;
                let sine = h[0][0].im / drive.norm();
                let lag = if branch == 0 { sine.asin() } else { std::f64::consts::PI - sine.asin() };
                let z = C64::cis(drive.arg() + lag);
                (sine.abs() < 1.0).then(|| (u, (u.conj() * (a[1] + h[1][0] * z + h[1][1] * u)).im))
            };
            for branch in [0, 1] {
                for at in 0..SAMPLES {
                    let (Some((u, f)), Some((_, next))) = (mismatch(at, branch), mismatch(at + 1, branch)) else {
                        continue;
                    };
                    if f * next < 0.0 {
                        let nearest = all.iter().map(|r| (r - u).norm()).fold(f64::INFINITY, f64::min);
                        assert!(nearest < 2.0 * std::f64::consts::TAU / SAMPLES as f64, "{u} is not in {all:?}");
                        met += 1;
                    }
                }
            }
        }
        assert!(met > 100, "{met}");
    }

    #[test]
    fn frequencies_hold_every_zero_that_a_scan_meets() {
        // One mass: Im Z = 2 zeta w - zeta R, zero at half the spin.
        let (rotor, feedback) = machine("jeffcott");
        let problem = Problem::new(&rotor, &feedback, &[1.0], false).unwrap();
        let found = frequencies(&problem.at(3.0), 0).unwrap();
        assert!(found.iter().any(|w| (w - 1.5).abs() < 1e-12), "{found:?}");
        let (rotor, feedback) = machine("three-mass");
        let problem = Problem::new(&rotor, &feedback, &[1.0; 3], false).unwrap();
        let mut met = 0;
        for speed in [1.0, 3.0, 5.0] {
            let equation = problem.at(speed);
            for k in 0..3 {
                let found = frequencies(&equation, k).unwrap();
                let influence = |w: f64| {
                    let mut unit = DVector::zeros(3);
                    unit[k] = C64::ONE;
                    equation.stiffened(w, |i| if i == k { 1.0 } else { 0.0 }).lu().solve(&unit).unwrap()[k].im
                };
                for at in -5000..5000 {
                    let (w, next) = (f64::from(at) * 1e-3 + 1e-5, f64::from(at + 1) * 1e-3 + 1e-5);
                    if influence(w) * influence(next) < 0.0 {
                        assert!(
                            found.iter().any(|f| (w..=next).contains(f)),
                            "R = {speed}, mass {k}: {w} in {found:?}"
                        );
                        met += 1;
                    }
                }
            }
        }
        assert!(met >= 9, "{met}");
    }

    fn machine(name: &str) -> (Rotor, Feedback) {
        let rotor = builtin::rotor(name).unwrap();
        let feedback = builtin::feedback(&rotor, "off").unwrap();
        (rotor, feedback)
    }

    /// Five masses that all have clearance.
    fn five(damping: f64) -> (Rotor, Feedback) {
        let mass = |unbalance| Mass {
            mass: 0.2,
            damping,
            bearing_stiffness: 0.2,
            seal_stiffness: 0.1,
            unbalance,
            ..Mass::default()
        };
        let rotor = Rotor::new("five", [0.2, -0.1, 0.3, 0.1, 0.2].map(mass).to_vec(), vec![0.5; 4]).unwrap();
        let feedback = builtin::feedback(&rotor, "off").unwrap();
        (rotor, feedback)
    }

    #[test]
    fn what_is_said_to_be_unique_no_start_finds_a_second_of() {
        let gapped = [0, 1, 2, 3, 4];
        let (mut random, mut proven) = (fastrand::Rng::with_seed(1), 0);
        for damping in [0.05, 0.3, 0.8] {
            let (rotor, feedback) = five(damping);
            let problem = Problem::new(&rotor, &feedback, &[0.1; 5], true).unwrap();
            for speed in [0.4, 1.0, 2.0, 3.0] {
                if !is_unique(&problem.at(speed), speed, &gapped) {
                    continue;
                }
                proven += 1;
                let mut first: Option<DVector<f64>> = None;
                for _ in 0..60 {
                    let c: Vec<C64> = (0..5).map(|_| complex(&mut random)).collect();
                    let Some((x, _)) = problem.solve_any(problem.pack(&c, speed, speed), Closing::Speed(speed)) else {
                        continue;
                    };
                    let first = first.get_or_insert_with(|| x.clone());
                    assert!((&*first - &x).norm() < 1e-8 * x.norm(), "two orbits at R = {speed}: {first} {x}");
                }
                assert!(first.is_some());
            }
        }
        assert!(proven >= 3, "{proven}");
    }

    #[test]
    fn where_there_are_three_orbits_uniqueness_is_not_claimed() {
        let mass = Mass {
            mass: 1.0,
            damping: 0.01,
            bearing_stiffness: 0.8,
            seal_stiffness: 0.5,
            unbalance: 1.0,
            ..Mass::default()
        };
        let rotor = Rotor::new("one", vec![mass], vec![]).unwrap();
        let feedback = builtin::feedback(&rotor, "off").unwrap();
        let speeds: Vec<f64> = (1..100).map(|i| f64::from(i) * 0.03).collect();
        let found = crate::circular::synchronous(&rotor, &feedback, &[5.0], &speeds).unwrap();
        let problem = Problem::new(&rotor, &feedback, &[5.0], true).unwrap();
        let several: Vec<_> = speeds.iter().zip(&found.orbits).filter(|(_, orbits)| orbits.len() > 1).collect();
        assert!(several.len() > 3);
        for (speed, _) in several {
            assert!(!is_unique(&problem.at(*speed), *speed, &[0]), "R = {speed}");
        }
    }
}
