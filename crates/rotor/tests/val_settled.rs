//! The settled simulation as a check on branches: where a motion comes to rest on a circular orbit, that orbit is listed.
//!
//! Five to eight clearances, more than can be enumerated, so that nothing but the search stands behind the list.

use rotor::circular::{Orbit, cycles, orbit_of, synchronous};
use rotor::{C64, ClosedLoop, Feedback, Mass, Rotor, builtin, step::Fastest, stepper};

/// Evenly spread numbers, the same each time.
struct Chance(fastrand::Rng);

impl Chance {
    fn even(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    fn log(&mut self, low: f64, high: f64) -> f64 {
        self.even(low.ln(), high.ln()).exp()
    }

    /// A rotor of so many masses, each with a clearance, and the clearances.
    fn rotor(&mut self, masses: usize, unbalance: f64) -> (Rotor, Feedback, Vec<f64>) {
        let all = (0..masses)
            .map(|_| Mass {
                mass: self.log(0.1, 0.5),
                damping: self.log(0.05, 0.3),
                cross_damping: self.even(0.0, 0.05),
                bearing_stiffness: self.log(0.1, 1.0),
                seal_stiffness: self.even(0.0, 0.1),
                unbalance: unbalance * self.even(-1.0, 1.0),
                deadband: 0.0,
            })
            .collect();
        let shafts = (1..masses).map(|_| self.even(0.2, 1.0)).collect();
        let rotor = Rotor::new("random", all, shafts).expect("valid");
        let feedback = builtin::feedback(&rotor, "off").expect("fits any");
        let deadband = (0..masses).map(|_| self.log(0.02, 1.0)).collect();
        (rotor, feedback, deadband)
    }
}

/// The circular orbit that the motion settles on, started at rest or kicked; `None` if it does not.
fn settled(closed_loop: &ClosedLoop, kick: f64, longest: f64) -> Option<Orbit> {
    const STRETCH: f64 = 100.0;
    let masses = closed_loop.masses();
    let steps = (STRETCH / Fastest::of(closed_loop).expect("finite").default_step()).ceil();
    let mut motion = stepper(closed_loop);
    let velocity: Vec<C64> = (0..masses).map(|k| C64::cis(k as f64) * kick).collect();
    motion.place(&vec![C64::ZERO; masses], &velocity);
    for _ in 0..(longest / STRETCH) as usize {
        (0..steps as u64).for_each(|_| motion.step(STRETCH / steps));
        let now = motion.motion();
        if now.largest_radius() > 1e4 || !now.is_finite() {
            return None;
        }
        if now.largest_radius() > 1e-3
            && let Some(orbit) = orbit_of(closed_loop, now.angle, now.displacement, now.velocity).expect("finite")
        {
            return Some(orbit);
        }
    }
    None
}

/// How far the nearest of `listed` is, against the size of the orbit: radii and frequency.
fn nearest(orbit: &Orbit, listed: &[Orbit]) -> f64 {
    let apart = |other: &Orbit| {
        let radii = orbit.radii().iter().zip(other.radii()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        radii / orbit.largest_radius() + (orbit.frequency - other.frequency).abs()
    };
    listed.iter().map(apart).fold(f64::INFINITY, f64::min)
}

#[test]
fn what_the_simulation_settles_on_under_unbalance_is_among_the_branches() {
    let (mut chance, mut met) = (Chance(fastrand::Rng::with_seed(1)), 0);
    for masses in [5, 6, 7, 8, 5, 8] {
        let (rotor, feedback, deadband) = chance.rotor(masses, 1.0);
        let speed = chance.even(0.5, 2.5);
        let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &deadband);
        let listed = synchronous(&rotor, &feedback, &deadband, &[speed]).expect("solved");
        for kick in [0.0, 0.5, 5.0] {
            let Some(orbit) = settled(&closed_loop, kick, 1500.0) else { continue };
            let off = nearest(&orbit, &listed.orbits[0]);
            assert!(off < 1e-3, "{masses} masses, R = {speed}, kick {kick}: {orbit:?} is {off} from all listed");
            met += 1;
        }
    }
    assert!(met >= 6, "{met} settled");
}

#[test]
fn what_the_simulation_settles_on_by_itself_is_among_the_cycles() {
    let (mut chance, mut met) = (Chance(fastrand::Rng::with_seed(7)), 0);
    for masses in [5, 6, 8, 5] {
        let (rotor, feedback, deadband) = chance.rotor(masses, 0.0);
        let speed = chance.even(1.5, 3.0);
        let closed_loop = ClosedLoop::new(&rotor, &feedback, speed, &deadband);
        let runs = [0.05, 0.5, 5.0].map(|kick| settled(&closed_loop, kick, 1500.0));
        if runs.iter().all(Option::is_none) {
            continue;
        }
        let listed = cycles(&rotor, &feedback, &deadband, &[speed]).expect("solved");
        for orbit in runs.into_iter().flatten().filter(|orbit| orbit.contact != 0) {
            let off = nearest(&orbit, &listed.orbits[0]);
            assert!(off < 1e-3, "{masses} masses, R = {speed}: {orbit:?} is {off} from all listed");
            met += 1;
        }
    }
    assert!(met >= 3, "{met} settled");
}

#[test]
fn a_rotor_that_floats_free_in_its_clearances_is_marginal_at_rest_not_unstable() {
    // A defective double zero: rounding makes a real part of 1e-8 of it, of either sign.
    for masses in 1..=6 {
        for shaft in [0.3, 0.5, 7.0] {
            let mass = |k: usize| Mass { mass: 0.3 + 0.1 * k as f64, bearing_stiffness: 1.0, ..Mass::default() };
            let rotor = Rotor::new("free", (0..masses).map(mass).collect(), vec![shaft; masses - 1]).expect("valid");
            let feedback = builtin::feedback(&rotor, "off").expect("fits any");
            let deadband = vec![1.0; masses];
            for speed in [0.0, 1.0, 3.0] {
                let orbit = rotor::circular::centre(&ClosedLoop::new(&rotor, &feedback, speed, &deadband));
                let orbit = orbit.expect("finite");
                assert_eq!(
                    (orbit.stability(), orbit.growth.clone()),
                    (Ok(rotor::Stability::Marginal), Ok(0.0)),
                    "{masses} {shaft} {orbit:?}"
                );
            }
        }
    }
}
