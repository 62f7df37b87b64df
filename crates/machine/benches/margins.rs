//! All margins of three masses at one speed and over two hundred, the peak of the sensitivity proven, and a curve of a thousand
//! points or so.

use divan::{Bencher, black_box};
use machine::{MachineLoop, TransferFunction, margins, worst_margins};
use rotor::{Settings, builtin};

fn main() {
    divan::main();
}

fn machine(feedback: &str, delay: f64) -> (rotor::Rotor, Settings) {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, feedback).expect("built in");
    let mut settings = Settings::new(&rotor, 6.0, feedback);
    settings.feedback.bearings[0].parts.delay = delay;
    (rotor, settings)
}

#[divan::bench(args = ["composite", "individual"])]
fn all_margins(bencher: Bencher, feedback: &str) {
    let (rotor, settings) = machine(feedback, 0.0);
    bencher.bench_local(|| black_box(margins(&rotor, &settings, 6.0)));
}

#[divan::bench(args = ["composite", "individual"])]
fn all_margins_late(bencher: Bencher, feedback: &str) {
    let (rotor, settings) = machine(feedback, 0.02);
    bencher.bench_local(|| black_box(margins(&rotor, &settings, 6.0)));
}

#[divan::bench]
fn bode(bencher: Bencher) {
    let (rotor, settings) = machine("individual", 0.05);
    bencher.bench_local(|| {
        let looped = MachineLoop::at(&rotor, &settings, 6.0).expect("fits");
        black_box(looped.response(TransferFunction::Sensitivity, looped.band()))
    });
}

/// The ideal loop by its Hamiltonian matrix, and with a delay by covering the axis.
#[divan::bench(args = [0.0, 0.02])]
fn certified_peak(bencher: Bencher, delay: f64) {
    let (rotor, settings) = machine("individual", delay);
    let looped = MachineLoop::at(&rotor, &settings, 6.0).expect("fits");
    bencher.bench_local(|| black_box(looped.certified_peak()));
}

#[divan::bench(args = ["composite", "individual"])]
fn worst_over_200_speeds(bencher: Bencher, feedback: &str) {
    let (rotor, settings) = machine(feedback, 0.0);
    let speeds: Vec<f64> = (0..200).map(|k| 1.0 + 5.0 * f64::from(k) / 199.0).collect();
    bencher.bench_local(|| black_box(worst_margins(&rotor, &settings, &speeds)));
}
