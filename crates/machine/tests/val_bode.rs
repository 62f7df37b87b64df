//! Frequency responses against the machine's matrices, its orbits and its margins.

use control::{Filter, Parts};
use machine::{MachineLoop, TransferFunction, UnbalanceResponse, margins, unbalance_response};
use rotor::circular::synchronous;
use rotor::{C64, Rotor, Settings, builtin};

fn machine(feedback: &str, speed: f64) -> (Rotor, Settings) {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, feedback).expect("built in");
    let mut settings = Settings::new(&rotor, speed, feedback);
    settings.feedback.bearings[0].parts = Parts { delay: 0.03, lag: 0.01, ..Parts::default() };
    settings.feedback.bearings[0].filters = vec![Filter::Lowpass { corner: 60.0, order: 2 }];
    (rotor, settings)
}

#[test]
fn val_every_response_is_that_of_the_matrices() {
    let (rotor, settings) = machine("individual", 2.5);
    let looped = MachineLoop::at(&rotor, &settings, 2.5).expect("fits");
    let form = looped.form().clone();
    let [a, b, c] = form.continuous().expect("continuous");
    let solve = |w: f64, closed: bool, drive: &nalgebra::DMatrix<C64>| {
        let s = C64::new(0.0, w);
        let through = if closed { &b * &c * (-s * form.delay).exp() } else { &b * &c * C64::ZERO };
        let mut m = -(&a + through);
        (0..m.nrows()).for_each(|i| m[(i, i)] += s);
        m.lu().solve(drive).expect("no pole there")
    };
    let mut force = nalgebra::DMatrix::zeros(a.nrows(), 1);
    force[3] = C64::ONE;
    for of in
        [TransferFunction::Loop, TransferFunction::Sensitivity, TransferFunction::Closed, TransferFunction::Station(1)]
    {
        let points = looped.response(of, [-20.0, 20.0]).expect("converges").expect("there is one");
        assert!(points.len() > 50 && points.windows(2).all(|p| p[0].frequency < p[1].frequency));
        for point in &points {
            let w = point.frequency;
            let late = C64::cis(-w * form.delay);
            let gain = -(&c * solve(w, false, &b))[0] * late;
            let expected = match of {
                TransferFunction::Loop => gain,
                TransferFunction::Sensitivity => (gain + 1.0).inv(),
                TransferFunction::Closed => gain / (gain + 1.0),
                TransferFunction::Station(k) => solve(w, true, &force)[k],
            };
            let apart = (point.value - expected).norm();
            assert!(apart < 1e-9 * (1.0 + expected.norm()), "{of:?} at {w}: {} {expected}", point.value);
        }
        // The straight line between two neighbours is the curve.
        for pair in points.windows(2) {
            let w = 0.3 * pair[0].frequency + 0.7 * pair[1].frequency;
            let line = pair[0].value * 0.3 + pair[1].value * 0.7;
            let gain = -(&c * solve(w, false, &b))[0] * C64::cis(-w * form.delay);
            if of == TransferFunction::Loop {
                assert!((line - gain).norm() < 0.02 * gain.norm() + 1e-9, "at {w}: {line} {gain}");
            }
        }
    }
}

#[test]
fn val_the_largest_sensitivity_of_a_curve_is_the_peak_of_the_margins() {
    for (feedback, speed) in [("composite", 6.0), ("composite", 2.5), ("individual", 6.0)] {
        let (rotor, settings) = machine(feedback, speed);
        let peak = margins(&rotor, &settings, speed).expect("stable").margins.sensitivity();
        let looped = MachineLoop::at(&rotor, &settings, speed).expect("fits");
        let points =
            looped.response(TransferFunction::Sensitivity, looped.band()).expect("converges").expect("there is one");
        let most = points.iter().map(|p| p.value.norm()).fold(0.0, f64::max);
        assert!((most / peak.amplitude - 1.0).abs() < 1e-9, "{feedback} at {speed}: {most} {peak:?}");
    }
}

#[test]
fn val_the_response_to_unbalance_is_the_synchronous_orbit_and_its_peaks_are_tops() {
    let (rotor, settings) = machine("composite", 0.0);
    let UnbalanceResponse { points, peaks } =
        unbalance_response(&rotor, &settings, [0.0, 6.0]).expect("fits").expect("not sampled");
    let some: Vec<_> = points.iter().filter(|p| p.speed > 0.0).step_by(40).collect();
    let orbit_at = |speed: f64| {
        let found = synchronous(&rotor, &settings.feedback, &[0.0; 3], &[speed]).expect("converges");
        let [orbit] = &found.orbits[0][..] else { panic!("one orbit of a linear machine") };
        orbit.clone()
    };
    for point in some {
        let orbit = orbit_at(point.speed);
        let apart = point.stations.iter().zip(&orbit.amplitude).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 1e-9 * (1.0 + orbit.largest_radius()), "at {}: {apart}", point.speed);
    }
    assert!(!peaks.is_empty());
    for peak in &peaks {
        let [a, b, c] = [-1e-4, 0.0, 1e-4].map(|by| orbit_at(peak.speed + by).amplitude[peak.station].norm());
        assert!((b - peak.amplitude).abs() < 1e-9 && a < b && c < b, "{peak:?}: {a} {b} {c}");
    }
}
