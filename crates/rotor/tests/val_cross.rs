//! Cross-coupled stiffness and damping of bearings against bodies whose poles are the roots of a quadratic equation.

use rotor::{C64, Characteristic, LinearForm, OperatingPoint, Plant, Rotor, file};

const STIFFNESS: f64 = 2.0e6;
const DAMPING: f64 = 900.0;
const CROSS: f64 = 3.0e5;
const CROSS_DAMPING: f64 = 120.0;

/// The poles in 1/s.
fn poles(rotor: &Rotor, rpm: f64) -> Vec<C64> {
    let scales = rotor.scales().expect("SI");
    let feedback = rotor.beam().expect("shaft elements").no_feedback();
    let form = LinearForm::of(&Plant::of(rotor), &feedback, &OperatingPoint::at(scales.speed(rpm))).expect("fits");
    let roots = Characteristic::of(&form).expect("finite").roots().expect("found");
    roots.iter().map(|root| root.pole * scales.w0).collect()
}

/// Both roots of `m s^2 + d s + k`.
fn roots(m: C64, d: C64, k: C64) -> [C64; 2] {
    let root = (d * d - m * k * 4.0).sqrt();
    [(-d + root) / (m * 2.0), (-d - root) / (m * 2.0)]
}

fn are_among(expected: [C64; 2], found: &[C64], within: f64) {
    for exact in expected {
        let off = found.iter().map(|pole| (pole - exact).norm()).fold(f64::INFINITY, f64::min);
        assert!(off < within * exact.norm(), "{exact} is off by {off}: {found:?}");
    }
}

fn bearing(station: usize, [stiffness, damping, cross, cross_damping]: [f64; 4]) -> String {
    format!(
        "[[bearing]]\nstation = {station}\nstiffness = {stiffness:e}\ndamping = {damping:e}\ncross_stiffness = {cross:e}\n\
         cross_damping = {cross_damping:e}\n"
    )
}

/// One mass, exactly: `m s^2 + (d - j dc) s + k - j kc = 0`.
#[test]
fn val_a_mass_on_a_cross_coupled_bearing_has_the_poles_of_its_quadratic() {
    for cross in [CROSS, -CROSS, 0.0] {
        let text = format!(
            "units = 'si'\n[plant]\nstations = [1]\nmass = [[7.0]]\nstiffness = [[0.0]]\n{}",
            bearing(1, [STIFFNESS, DAMPING, cross, CROSS_DAMPING])
        );
        let found = poles(&file::read_rotor(&text, "mass").expect("a rotor"), 3000.0);
        let exact = roots(C64::from(7.0), C64::new(DAMPING, -CROSS_DAMPING), C64::new(STIFFNESS, -cross));
        assert_eq!(found.len(), 2);
        are_among(exact, &found, 1e-12);
        // What drives forward whirl takes from its damping.
        let forward = exact.into_iter().find(|pole| pole.im > 0.0).expect("one");
        let plain = -0.5 * DAMPING / 7.0;
        assert_eq!(cross > 0.0, forward.re > plain + 10.0, "{forward} for {cross}");
    }
}

/// A shaft a hundred times as stiff as steel: a rigid body on two bearings, which shakes and rocks:
/// `M s^2 + 2 (d - j dc) s + 2 (k - j kc) = 0` and `It s^2 + ((d - j dc) L^2 / 2 - j w Ip) s + (k - j kc) L^2 / 2 = 0`.
#[test]
fn val_a_rigid_rotor_on_cross_coupled_bearings_shakes_and_rocks_as_its_quadratics_say() {
    let length = 0.6;
    let ends = [1, 3].map(|station| bearing(station, [STIFFNESS, DAMPING, CROSS, CROSS_DAMPING])).concat();
    let text = format!(
        "units = 'si'\n[material.rigid]\ndensity = 7810.0\nyoungs_modulus = 211e11\npoisson = 0.3\n{}{ends}",
        "[[section]]\nlength = 0.3\nouter = 0.1\n".repeat(2)
    );
    let rotor = file::read_rotor(&text, "rigid").expect("a rotor");
    // A cylinder, and its slices' rotary inertia as the elements have it.
    let mass = 7810.0 * std::f64::consts::PI * 0.05_f64.powi(2) * length;
    let (polar, across) = (0.5 * mass * 0.05_f64.powi(2), mass * (0.25 * 0.05_f64.powi(2) + length * length / 12.0));
    for rpm in [0.0, 9000.0] {
        let spin = rpm * std::f64::consts::PI / 30.0;
        for rotor in [rotor.clone(), rotor.in_full().expect("a plant")] {
            let found = poles(&rotor, rpm);
            let (damping, stiffness) = (C64::new(DAMPING, -CROSS_DAMPING), C64::new(STIFFNESS, -CROSS));
            are_among(roots(C64::from(mass), damping * 2.0, stiffness * 2.0), &found, 1e-3);
            let arm = 0.5 * length * length;
            let rocking = roots(C64::from(across), damping * arm - C64::new(0.0, spin * polar), stiffness * arm);
            are_among(rocking, &found, 1e-3);
        }
    }
}

/// Between two speeds of a table coefficients are linear, so that a table with the mean at a speed is the constant.
#[test]
fn val_a_table_over_speed_is_the_constant_of_its_mean() {
    let with = |cross: &str, damping: &str| {
        let text = format!(
            "units = 'si'\n[plant]\nstations = [1]\nmass = [[7.0]]\nstiffness = [[0.0]]\n[[bearing]]\nstation = 1\n\
             stiffness = 2e6\ncross_stiffness = {cross}\ndamping = {damping}\n"
        );
        file::read_rotor(&text, "table").expect("a rotor")
    };
    let table = |low: f64, high: f64| format!("{{ speed = [1000, 5000], value = [{low:e}, {high:e}] }}");
    let found = poles(&with(&table(1e5, 5e5), &table(500.0, 1300.0)), 3000.0);
    are_among(roots(C64::from(7.0), C64::from(900.0), C64::new(2e6, -3e5)), &found, 1e-12);
    // Beyond its ends the same.
    let above = poles(&with(&table(1e5, 5e5), &table(500.0, 1300.0)), 9000.0);
    are_among(roots(C64::from(7.0), C64::from(1300.0), C64::new(2e6, -5e5)), &above, 1e-12);
}
