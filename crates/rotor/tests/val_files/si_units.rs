//! SI units agree with the report, and with what the formulas say.

use rotor::file::{read_feedback_for, read_rotor};
use rotor::{C64, ClosedLoop, Modes, Scales, builtin, stepper};

use crate::table_4_2::{SI, distance, report_rotor};

#[test]
fn val_an_si_rotor_equivalent_to_table_4_2_moves_like_it() {
    let (si, report) = (read_rotor(SI, "x").expect("valid"), report_rotor());
    assert!(distance(&si, &report) < 1e-12);
    let scales = *si.scales().expect("si");
    assert_eq!((scales.w0, scales.m_t, scales.k_t, scales.e_t), (300.0, 40.0, 3.6e6, 20e-6));

    let feedback = builtin::feedback(&report, "composite").expect("built in");
    for speed in [0.0, 1.775, 4.0, 6.0] {
        let [ours, theirs] = [&si, &report].map(|rotor| ClosedLoop::new(rotor, &feedback, speed, &rotor.deadbands()));
        let [a, b] = [&ours, &theirs].map(|closed_loop| Modes::of(closed_loop).expect("converges"));
        for (a, b) in a.modes.iter().zip(&b.modes) {
            assert!((a.pole - b.pole).norm() < 1e-12, "{} and {} at R = {speed}", a.pole, b.pole);
        }
        let run = |closed_loop: &ClosedLoop| {
            let mut motion = stepper(closed_loop);
            motion.place(&[C64::new(1.5, 0.0), C64::new(0.0, 2.0)], &[]);
            (0..400).for_each(|_| motion.step(0.02));
            motion.motion().displacement.to_vec()
        };
        for (a, b) in run(&ours).iter().zip(run(&theirs)) {
            assert!((a - b).norm() < 1e-12 * b.norm().max(1.0), "{a} and {b} at R = {speed}");
        }
    }
}

#[test]
fn val_scales_convert_to_si_and_back() {
    let scales = Scales { w0: 300.0, k_t: 3.6e6, m_t: 40.0, e_t: 20e-6 };
    // 300 rad/s are 300 / (2 pi) turns a second.
    assert!((scales.rpm(1.0) - 2_864.788_975_654_116).abs() < 1e-9);
    assert!((scales.metres(1.5) - 30e-6).abs() < 1e-18);
    assert!((scales.seconds(600.0) - 2.0).abs() < 1e-15);
    // u = 1 on 10 kg is an acceleration of w0^2 e_t = 1.8 m/s^2.
    assert!((scales.newtons(1.0, 0.25) - 18.0).abs() < 1e-12);
    for number in [0.0, 0.3, 7.0, 1e4] {
        for back in [
            scales.speed(scales.rpm(number)),
            scales.length(scales.metres(number)),
            scales.tau(scales.seconds(number)),
            scales.acceleration(scales.newtons(number, 0.25), 0.25),
        ] {
            assert!((back - number).abs() <= 4.0 * f64::EPSILON * number, "{back} from {number}");
        }
    }
}

#[test]
fn without_unbalance_a_reference_length_stands_for_e_t() {
    let still = SI.replace("unbalance = 20e-6", "");
    let refused = read_rotor(&still, "x").expect_err("no e_t").to_string();
    assert_eq!(
        refused,
        "3:9: the sum of unbalance = 0: expected a finite number of m greater than 0, or a reference_length in m to \
         measure displacements by"
    );
    let rotor = read_rotor(&format!("reference_length = 1e-5\n{still}"), "x").expect("valid");
    assert_eq!(rotor.scales().expect("si").e_t, 1e-5);
    assert!((rotor.masses()[0].deadband - 2.0).abs() < 1e-15);
    // Opposite unbalances are a couple without a sum: what is left of it is rounding.
    let couple = still.replace("cross_damping = 300", "unbalance = 0.1").replacen("0.1", "-0.3", 1);
    let couple = couple.replace("mass = 20", "mass = 20\nunbalance = 0.2");
    assert!(read_rotor(&couple, "x").expect_err("no e_t").to_string().contains("the sum of unbalance = 0: "));
}

/// The same loop written in seconds, newtons and hertz is the same loop.
#[test]
fn val_a_loop_in_si_units_is_the_dimensionless_one() {
    let rotor = read_rotor(SI, "x").expect("valid");
    let scales = *rotor.scales().expect("in SI units");
    let text = "units = \"si\"\nbearing = 1\n[[signal]]\nmass = 1\n\
                filter = [{ kind = \"lowpass\", corner = 100.0, order = 2 }, { kind = \"transfer\", numerator = [2.0, 3.0], denominator = [5.0, 7.0] }, \
                { kind = \"state-space\", a = [[0.0, 1.0], [-9e4, -120.0]], b = [0.0, 9e4], c = [1.0, 2e-3], d = 0.25 }]\n\
                [loop]\ndelay = 1e-4\nlimit = 20.0\nslew = 3000.0\nquantum = 1e-7\n";
    let feedback = read_feedback_for(text, &rotor).expect("valid");
    let (parts, mass) = (feedback.bearings[0].parts, rotor.masses()[0].mass);
    let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    close(parts.delay, 1e-4 * scales.w0);
    close(scales.newtons(parts.limit, mass), 20.0);
    close(scales.newtons(parts.slew, mass) * scales.w0, 3000.0);
    close(parts.quantum, 1e-7 / scales.e_t);
    // At 40 Hz both say what the formulas say.
    let s = rotor::C64::new(0.0, std::f64::consts::TAU * 40.0);
    let through = |k: usize| feedback.bearings[0].signals[0].filters[k].at(s / scales.w0, 0.0);
    close(through(0).norm(), (1.0 + 0.4f64.powi(4)).powf(-0.5));
    close(((s * 2.0 + 3.0) / (s * 5.0 + 7.0) / through(1)).norm(), 1.0);
    // x1'' = -9e4 x1 - 120 x1' + 9e4 y, u = x1 + 2e-3 x1' + y / 4.
    let exact = (s * 2e-3 + 1.0) * 9e4 / (s * s + s * 120.0 + 9e4) + 0.25;
    assert!((through(2) - exact).norm() < 1e-12 * exact.norm(), "{} for {exact}", through(2));
}

/// ISO 21940-11: a grade is eccentricity times speed, of all of the rotor; without a speed of its own, the rotor's own `w0`.
#[test]
fn val_a_grade_without_a_speed_is_for_the_rotors_own_scale() {
    let with = |unbalance: &str| {
        let text = format!(
            "units = 'si'\nreference_length = 1e-6\n[plant]\nstations = [1, 2]\nmass = [[5.0, 0.0], [0.0, 3.0]]\nstiffness = [[4e5, -4e5], [-4e5, 4e5]]\n\
             [[bearing]]\nstation = 1\nstiffness = 7e5\n[[bearing]]\nstation = 2\nstiffness = 1e5\n{unbalance}"
        );
        read_rotor(&text, "graded").expect("a rotor")
    };
    let graded = |speed: &str| {
        format!(
            "[[unbalance]]\nstation = 1\ngrade = 'G6.3'\n{speed}[[unbalance]]\nstation = 2\ngrade = 'G6.3'\n{speed}"
        )
    };
    let w0 = (8e5_f64 / 8.0).sqrt();
    // g mm: half of G / w0 times 8 kg at each of the two.
    let gmm = 0.5 * 6.3e-3 / w0 * 8.0 * 1e6;
    let plain = format!("[[unbalance]]\nstation = 1\ngmm = {gmm:?}\n[[unbalance]]\nstation = 2\ngmm = {gmm:?}\n");
    let rpm = w0 * 30.0 / std::f64::consts::PI;
    let moments = |text: &str| {
        let rotor = with(text);
        let unbalance = rotor::Plant::of(&rotor).unbalance().to_vec();
        assert!(unbalance.iter().all(|u| u.norm() > 0.0), "{text}");
        unbalance
    };
    let expected = moments(&plain);
    for text in [graded(""), graded(&format!("speed = {rpm:?}\n"))] {
        for (ours, exact) in moments(&text).iter().zip(&expected) {
            assert!((ours - exact).norm() < 1e-12 * exact.norm(), "{ours} and {exact}");
        }
    }
}
