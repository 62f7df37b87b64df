//! Exact circular whirl against closed forms, the report's numbers, and the integrator.

use nalgebra::{DMatrix, DVector};
use rotor::circular::{Circular, CircularError, End, Orbit, cycles, synchronous, synchronous_orbits};
use rotor::{C64, ClosedLoop, Feedback, J, Mass, Rotor, Signal, builtin, stepper};

/// The rate of an orbit that can be judged.
fn growth(orbit: &Orbit) -> f64 {
    *orbit.growth.as_ref().expect("judged")
}

fn machine(rotor: &str, feedback: &str) -> (Rotor, Feedback) {
    let rotor = builtin::rotor(rotor).expect("built in");
    let feedback = builtin::feedback(&rotor, feedback).expect("built in");
    (rotor, feedback)
}

fn speeds(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect()
}

/// A five-mass chain with deadband in three bearings and unbalance everywhere.
fn five() -> (Rotor, Feedback, Vec<f64>) {
    let mass = |mass, damping, bearing, unbalance| Mass {
        mass,
        damping,
        cross_damping: 0.02,
        bearing_stiffness: bearing,
        seal_stiffness: 0.05,
        unbalance,
        deadband: 0.0,
    };
    let masses = vec![
        mass(0.10, 0.30, 0.3, 0.3),
        mass(0.30, 0.10, 0.0, 0.1),
        mass(0.20, 0.20, 0.2, 0.4),
        mass(0.25, 0.15, 0.0, -0.2),
        mass(0.15, 0.25, 0.4, 0.2),
    ];
    let rotor = Rotor::new("five", masses, vec![0.4, 0.6, 0.5, 0.3]).expect("valid");
    let signal = Signal::composite(&[0.2, 1.0, 0.3, 0.0, 0.1], [0.1, 0.3, -0.1, 0.0]);
    (rotor, Feedback::new(1, vec![signal]), vec![0.05, 0.0, 0.04, 0.0, 0.06])
}

/// Largest residual of the equations of motion, taken from the state matrix and the orbit alone.
fn residual(rotor: &Rotor, feedback: &Feedback, deadband: &[f64], orbit: &Orbit, forced: bool) -> f64 {
    let factors: Vec<f64> =
        orbit.radii().iter().zip(deadband).map(|(r, g)| if r > g { 1.0 - g / r } else { 0.0 }).collect();
    let a = ClosedLoop::new(rotor, feedback, orbit.speed, &[]).state_matrix_with(&factors);
    let lambda = J * orbit.frequency;
    let n = rotor.len();
    (0..n)
        .map(|i| {
            let acceleration: C64 =
                (0..n).map(|k| (a[(n + i, k)] + a[(n + i, n + k)] * lambda) * orbit.amplitude[k]).sum();
            let unbalance = if forced { rotor.masses()[i].unbalance * orbit.speed * orbit.speed } else { 0.0 };
            (acceleration + unbalance - lambda * lambda * orbit.amplitude[i]).norm()
        })
        .fold(0.0, f64::max)
}

fn all(found: &Circular) -> impl Iterator<Item = &Orbit> {
    found.orbits.iter().flatten().chain(found.curves.iter().flat_map(|c| &c.orbits))
}

/// Starts on the orbit and steps for `turns` of the whirl, `steps` a turn; the largest distance from the orbit at the end.
fn drift(rotor: &Rotor, feedback: &Feedback, deadband: &[f64], orbit: &Orbit, turns: u32, steps: u32) -> f64 {
    let closed_loop = ClosedLoop::new(rotor, feedback, orbit.speed, deadband);
    let mut motion = stepper(&closed_loop);
    let velocity: Vec<C64> = orbit.amplitude.iter().map(|c| c * J * orbit.frequency).collect();
    motion.place(&orbit.amplitude, &velocity);
    let dtau = std::f64::consts::TAU / orbit.frequency.abs() / f64::from(steps);
    (0..turns * steps).for_each(|_| motion.step(dtau));
    let now = motion.motion();
    orbit
        .amplitude
        .iter()
        .zip(now.displacement)
        .map(|(c, p)| (c * C64::cis(orbit.frequency * now.tau) - p).norm())
        .fold(0.0, f64::max)
}

#[test]
fn val_jeffcott_steady_force_at_five() {
    let (rotor, feedback) = machine("jeffcott", "cancel");
    for (deadband, force) in [(0.0, 2.655_371), (1.0, 2.572_277), (10.0, 2.569_950)] {
        let found = synchronous(&rotor, &feedback, &[deadband], &speeds(0.0, 5.0, 11)).expect("solved");
        let [orbit] = &found.orbits[10][..] else { panic!("one orbit at R = 5: {:?}", found.orbits[10]) };
        assert!((orbit.force - force).abs() < 5e-7, "{} for {force}", orbit.force);
        assert!(orbit.is_stable());
        assert_eq!(found.orbits[0][0].largest_radius(), 0.0);
    }
}

#[test]
fn val_one_mass_has_the_orbits_of_its_quadratic() {
    // |(Z + b) r - b g| = f for r > g, |Z| r = f inside: every orbit of one mass in closed form.
    let mut several = 0;
    for (kd, damping, deadband) in [(0.0, 0.05, 1.0), (0.0, 0.02, 0.4), (-0.1, 0.1, 2.0), (0.3, 0.01, 5.0)] {
        let mass =
            Mass { mass: 1.0, damping, bearing_stiffness: 0.8, seal_stiffness: 0.2, unbalance: 1.0, ..Mass::default() };
        let rotor = Rotor::new("one", vec![mass], vec![]).expect("valid");
        let feedback = Feedback::new(0, vec![Signal::at_mass(0, 1, [kd, 0.0, 0.0, 0.0])]);
        let speeds = speeds(0.02, 3.0, 150);
        let found = synchronous(&rotor, &feedback, &[deadband], &speeds).expect("solved");
        for (speed, orbits) in speeds.iter().zip(&found.orbits) {
            let z = C64::new(0.2 + kd - speed * speed, 2.0 * damping * speed - damping * speed);
            let (b, f) = (0.8, speed * speed);
            let mut radii = vec![f / z.norm()];
            radii.retain(|r| *r <= deadband);
            let (qa, qb, qc) = ((z + b).norm_sqr(), -2.0 * (z + b).re * b * deadband, (b * deadband).powi(2) - f * f);
            let discriminant = qb * qb - 4.0 * qa * qc;
            if discriminant > 0.0 {
                let roots = [-1.0, 1.0].map(|sign| (-qb + sign * discriminant.sqrt()) / (2.0 * qa));
                radii.extend(roots.into_iter().filter(|r| *r > deadband));
            }
            radii.sort_by(f64::total_cmp);
            let ours: Vec<f64> = orbits.iter().map(Orbit::largest_radius).collect();
            assert_eq!(ours.len(), radii.len(), "R = {speed}, g = {deadband}: {ours:?}, expected {radii:?}");
            for (a, b) in ours.iter().zip(&radii) {
                assert!((a - b).abs() < 1e-9 * b, "R = {speed}: {a} for {b}");
            }
            several += usize::from(ours.len() > 1);
        }
        assert!(found.curves.iter().all(|c| !c.ends.contains(&End::Lost)), "{:?}", found.curves);
    }
    assert!(several > 30, "coexisting orbits are what this is about: {several}");
}

#[test]
fn val_one_mass_has_the_cycles_of_its_balance() {
    // Control off: the seal balances at w = R / 2, the stiffness at s = (w^2 - 2 zeta_q w - Rs) / Rb.
    let (rotor, feedback) = machine("jeffcott", "off");
    let found = cycles(&rotor, &feedback, &[1.0], &speeds(0.0, 4.0, 41)).expect("solved");
    for (speed, orbits) in found.speeds.iter().zip(&found.orbits) {
        let w = speed / 2.0;
        let s = (w * w - 0.2 * w - 0.2) / 0.8;
        if s > 0.0 && s < 1.0 {
            let [orbit] = &orbits[..] else { panic!("one cycle at R = {speed}: {orbits:?}") };
            assert!((orbit.frequency - w).abs() < 1e-12 && (orbit.largest_radius() * (1.0 - s) - 1.0).abs() < 1e-9);
            assert!(orbit.is_stable(), "it grows inside and decays outside: {orbit:?}");
        } else {
            assert!(orbits.is_empty(), "R = {speed}: {orbits:?}");
        }
    }
    // Born where the rotor floating in its seal loses stability, gone to infinity where the supported one does.
    let [curve] = &found.curves[..] else { panic!("one branch: {:?}", found.curves) };
    assert_eq!(curve.ends, [End::ContactLost, End::Unbounded]);
    let (first, last) = (&curve.orbits[0], &curve.orbits[curve.orbits.len() - 1]);
    let born = 0.2 + 0.84_f64.sqrt();
    assert!((first.speed - born).abs() < 1e-8 && (first.largest_radius() - 1.0).abs() < 1e-8, "{first:?}");
    assert!((last.speed - 2.209_975).abs() < 1e-3, "{last:?}");
}

#[test]
fn val_every_orbit_solves_the_equations_of_motion() {
    let (rotor, feedback) = machine("three-mass", "composite");
    let mut count = 0;
    for deadband in [0.3, 1.0, 10.0] {
        let deadband = [deadband; 3];
        let forced = synchronous(&rotor, &feedback, &deadband, &speeds(0.0, 7.0, 29)).expect("solved");
        let free = cycles(&rotor, &feedback, &deadband, &speeds(0.0, 7.0, 29)).expect("solved");
        for (found, forced) in [(&forced, true), (&free, false)] {
            for orbit in all(found) {
                let size = residual(&rotor, &feedback, &deadband, orbit, forced);
                assert!(size < 1e-9 * (1.0 + orbit.largest_radius()), "{size:e} at {orbit:?}");
                count += 1;
            }
        }
    }
    let (rotor, feedback, deadband) = five();
    let found = synchronous(&rotor, &feedback, &deadband, &speeds(0.1, 3.0, 13)).expect("solved");
    for orbit in all(&found) {
        assert!(residual(&rotor, &feedback, &deadband, orbit, true) < 1e-9);
        count += 1;
    }
    assert!(count > 300, "{count} orbits");
}

#[test]
fn val_stable_orbits_are_held_by_the_integrator() {
    let (rotor, feedback, deadband) = five();
    let found = synchronous(&rotor, &feedback, &deadband, &speeds(0.3, 2.7, 7)).expect("solved");
    let mut held = 0;
    for orbit in found.orbits.iter().flatten().filter(|o| o.is_stable()) {
        let error = drift(&rotor, &feedback, &deadband, orbit, 6, 1600);
        assert!(error < 1e-8, "{error:e} at {orbit:?}");
        held += 1;
    }
    let (rotor, feedback) = machine("three-mass", "composite");
    let found = cycles(&rotor, &feedback, &[1.0; 3], &speeds(1.0, 7.0, 13)).expect("solved");
    let balanced = Rotor::new(
        "balanced",
        rotor.masses().iter().map(|m| Mass { unbalance: 0.0, ..*m }).collect(),
        rotor.shafts().to_vec(),
    )
    .expect("valid");
    for orbit in found.orbits.iter().flatten().filter(|o| o.is_stable()) {
        let error = drift(&balanced, &feedback, &[1.0; 3], orbit, 6, 3200);
        assert!(error < 1e-8 * (1.0 + orbit.largest_radius()), "{error:e} at {orbit:?}");
        held += 1;
    }
    assert!(held >= 8, "{held} orbits held");
}

#[test]
fn val_cycles_of_the_uncontrolled_rotor_run_off_at_its_three_thresholds() {
    let (rotor, feedback) = machine("three-mass", "off");
    let found = cycles(&rotor, &feedback, &[1.0; 3], &speeds(0.0, 7.0, 29)).expect("solved");
    let mut reached: Vec<f64> = found.curves.iter().map(|c| c.orbits[c.orbits.len() - 1].speed).collect();
    reached.sort_by(f64::total_cmp);
    assert!(found.curves.iter().all(|c| c.ends == [End::ContactLost, End::Unbounded]), "{:?}", found.curves);
    // At ten thousand clearances the factor s is within 1e-4 of 1.
    for (speed, threshold) in reached.iter().zip([1.775_522, 4.101_250, 4.650_456]) {
        assert!((speed - threshold).abs() < 3e-4, "{speed} for {threshold}");
    }
    assert_eq!(reached.len(), 3);
}

#[test]
fn val_gains_that_hold_any_common_stiffness_leave_no_symmetric_cycle() {
    let (rotor, feedback) = machine("three-mass", "individual");
    let found = cycles(&rotor, &feedback, &[1.0; 3], &speeds(0.0, 7.0, 15)).expect("solved");
    assert!(found.orbits.iter().all(Vec::is_empty) && found.curves.is_empty(), "{:?}", found.orbits);
}

/// The largest change of any radius, `until` after the orbit was disturbed by a part of 1e-6.
fn disturbed(rotor: &Rotor, feedback: &Feedback, deadband: &[f64], orbit: &Orbit, until: f64) -> f64 {
    let mut motion = stepper(&ClosedLoop::new(rotor, feedback, orbit.speed, deadband));
    let askew = |k: usize| C64::new(1.0 + 1e-6, 1e-6 * (k as f64 - 0.7));
    let place: Vec<C64> = orbit.amplitude.iter().enumerate().map(|(k, c)| c * askew(k)).collect();
    let velocity: Vec<C64> = orbit.amplitude.iter().map(|c| c * J * orbit.frequency).collect();
    motion.place(&place, &velocity);
    let steps = (until / 0.005).round();
    (0..steps as u64).for_each(|_| motion.step(until / steps));
    let now = motion.motion();
    orbit.radii().iter().zip(now.displacement).map(|(r, p)| (r - p.norm()).abs()).fold(0.0, f64::max)
}

#[test]
fn val_disturbances_die_and_grow_at_the_rate_of_the_linearised_motion() {
    let balanced = |rotor: &Rotor| {
        let masses = rotor.masses().iter().map(|m| Mass { unbalance: 0.0, ..*m }).collect();
        Rotor::new("balanced", masses, rotor.shafts().to_vec()).expect("valid")
    };
    // One mass: the slowest disturbance is one of the radius alone, so its rate can be measured.
    let (rotor, feedback) = machine("jeffcott", "off");
    let rotor = balanced(&rotor);
    let found = cycles(&rotor, &feedback, &[1.0], &[1.3, 2.0]).expect("solved");
    for orbit in found.orbits.iter().flatten() {
        let [early, late] = [10.0, 30.0].map(|tau| disturbed(&rotor, &feedback, &[1.0], orbit, tau));
        let rate = (late / early).ln() / 20.0;
        assert!((rate - growth(orbit)).abs() < 0.02 * growth(orbit).abs(), "{rate} for {}", growth(orbit));
    }
    assert_eq!(found.orbits.iter().flatten().count(), 2);
    // Three masses: of the three cycles at R = 6 one is stable.
    let (rotor, feedback) = machine("three-mass", "composite");
    let rotor = balanced(&rotor);
    let found = cycles(&rotor, &feedback, &[1.0; 3], &[6.0]).expect("solved");
    for orbit in &found.orbits[0] {
        let [early, late] = [20.0, 120.0].map(|tau| disturbed(&rotor, &feedback, &[1.0; 3], orbit, tau));
        assert_eq!(late < early, orbit.is_stable(), "{early:e} became {late:e} on {orbit:?}");
    }
    assert_eq!(found.orbits[0].iter().map(Orbit::is_stable).collect::<Vec<_>>(), [false, false, true]);
}

/// Residual of the forced equations at any amplitudes, in real parts and imaginary parts.
fn forced_residual(rotor: &Rotor, feedback: &Feedback, deadband: &[f64], speed: f64, x: &DVector<f64>) -> DVector<f64> {
    let n = rotor.len();
    let c: Vec<C64> = (0..n).map(|k| C64::new(x[k], x[n + k])).collect();
    let factors: Vec<f64> = c.iter().zip(deadband).map(|(c, g)| (1.0 - g / c.norm().max(1e-300)).max(0.0)).collect();
    let a = ClosedLoop::new(rotor, feedback, speed, &[]).state_matrix_with(&factors);
    let lambda = J * speed;
    let f: Vec<C64> = (0..n)
        .map(|i| {
            let sum: C64 = (0..n).map(|k| (a[(n + i, k)] + a[(n + i, n + k)] * lambda) * c[k]).sum();
            sum + rotor.masses()[i].unbalance * speed * speed - lambda * lambda * c[i]
        })
        .collect();
    DVector::from_iterator(2 * n, f.iter().map(|f| f.re).chain(f.iter().map(|f| f.im)))
}

#[test]
fn val_random_starts_find_no_orbit_that_is_not_listed() {
    // A plain Newton iteration with differences for derivatives, from many starts, knows nothing of regimes or branches.
    let mut random = fastrand::Rng::with_seed(1);
    let mut found_at = [0, 0];
    for (name, deadband) in [("off", [1.0, 0.0, 1.0]), ("composite", [1.0, 0.0, 0.4])] {
        let (rotor, feedback) = machine("three-mass", name);
        let speeds = [0.35, 0.6, 0.8, 1.5, 2.25];
        let listed = synchronous(&rotor, &feedback, &deadband, &speeds).expect("solved");
        for (&speed, orbits) in speeds.iter().zip(&listed.orbits) {
            for _ in 0..120 {
                let size = 10_f64.powf(2.0 * random.f64() - 1.0);
                let mut x = DVector::from_fn(6, |_, _| size * (2.0 * random.f64() - 1.0));
                let mut f = forced_residual(&rotor, &feedback, &deadband, speed, &x);
                for _ in 0..60 {
                    let slope = DMatrix::from_fn(6, 6, |_, _| 0.0);
                    let slope = (0..6).fold(slope, |mut slope, k| {
                        let h = 1e-7 * x.norm();
                        let mut moved = x.clone();
                        moved[k] += h;
                        slope.set_column(k, &((forced_residual(&rotor, &feedback, &deadband, speed, &moved) - &f) / h));
                        slope
                    });
                    let Some(step) = slope.lu().solve(&f) else { break };
                    x -= step;
                    f = forced_residual(&rotor, &feedback, &deadband, speed, &x);
                }
                if f.iter().all(|f| f.abs() < 1e-10) {
                    let nearest = orbits
                        .iter()
                        .map(|o| (0..3).map(|k| (o.amplitude[k] - C64::new(x[k], x[3 + k])).norm()).fold(0.0, f64::max))
                        .fold(f64::INFINITY, f64::min);
                    assert!(nearest < 1e-6, "{name}, R = {speed}: {x} is not among {orbits:?}");
                    found_at[usize::from(orbits.len() > 1)] += 1;
                }
            }
        }
    }
    assert!(found_at.iter().all(|&count| count > 50), "{found_at:?}");
}

#[test]
fn silly_machines_give_no_orbit_and_no_nan() {
    let free = Mass { mass: 1.0, bearing_stiffness: 1.0, unbalance: 1.0, ..Mass::default() };
    let rotor = Rotor::new("free", vec![free, Mass { unbalance: 0.0, ..free }], vec![0.0]).expect("valid");
    let feedback = builtin::feedback(&rotor, "off").expect("fits any");
    for deadband in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1e6, 1e-9]] {
        // R = 1 is an undamped resonance of the supported rotor.
        for found in [
            synchronous(&rotor, &feedback, &deadband, &[0.0, 0.5, 1.0, 1000.0]).expect("solved"),
            cycles(&rotor, &feedback, &deadband, &[0.0, 0.5, 1.0, 1000.0]).expect("solved"),
        ] {
            for orbit in all(&found) {
                assert!(orbit.amplitude.iter().all(|c| c.re.is_finite() && c.im.is_finite()), "{orbit:?}");
                assert!(orbit.force.is_finite() && growth(orbit).is_finite() && orbit.frequency.is_finite());
            }
        }
    }
}

/// Without their branches, which may lead to orbits that a search at one speed has missed; of shaft elements on magnetic bearings, a chain with
/// few clearances, and one with so many that branches are followed all the same.
#[test]
fn orbits_alone_are_those_that_the_branches_go_through_and_are_left_when_asked() {
    let (rig, own) = machine("rig", "own");
    let (three, individual) = machine("three-mass", "individual");
    let (many, feedback, deadband) = five();
    let touchdown: Vec<f64> = vec![0.4; rig.len()];
    for (rotor, feedback, deadband, over) in [
        (&rig, &own, &touchdown, speeds(1.0, 4.0, 5)),
        (&three, &individual, &vec![1.0; 3], speeds(0.5, 6.0, 12)),
        (&many, &feedback, &deadband, speeds(0.5, 3.0, 6)),
    ] {
        let never = || false;
        let whole = synchronous(rotor, feedback, deadband, &over).expect("found");
        let alone = synchronous_orbits(rotor, feedback, deadband, &over, &never).expect("found");
        assert_eq!((alone.speeds, &alone.complete), (whole.speeds, &whole.complete));
        for (alone, whole) in alone.orbits.iter().zip(&whole.orbits) {
            assert_eq!(alone.len(), whole.len(), "{}: {alone:?} {whole:?}", rotor.name());
            for (a, b) in alone.iter().zip(whole) {
                assert!((a.largest_radius() - b.largest_radius()).abs() <= 1e-9 * b.largest_radius(), "{a:?} {b:?}");
                assert_eq!(a.is_stable(), b.is_stable());
            }
        }
        let stopped = synchronous_orbits(rotor, feedback, deadband, &over, &|| true);
        assert_eq!(stopped.expect_err("asked to stop"), CircularError::Stopped);
    }
}

/// With nothing in contact a disturbance is that of the linear machine, in coordinates that turn: as far from the axis as its poles.
#[test]
fn val_an_orbit_that_touches_nothing_decays_as_the_slowest_pole_does() {
    let (rig, own) = machine("rig", "own");
    for speed in [1.0, 3.0] {
        let found = synchronous(&rig, &own, &vec![1e3; rig.len()], &[speed]).expect("found");
        let [orbit] = &found.orbits[0][..] else { panic!("{found:?}") };
        assert_eq!(orbit.contact, 0);
        let at = rotor::OperatingPoint::at(speed);
        let form = rotor::LinearForm::of(&rotor::Plant::of(&rig), &own, &at).expect("fits");
        let roots = rotor::Characteristic::of(&form).expect("finite").roots().expect("found");
        let slowest = roots.iter().map(|root| root.pole.re).fold(f64::NEG_INFINITY, f64::max);
        assert!((growth(orbit) - slowest).abs() < 1e-6 * slowest.abs(), "{} {slowest}", growth(orbit));
    }
}
