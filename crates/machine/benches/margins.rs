//! All margins of three masses at one speed, and a curve of a thousand points or so.

use divan::{Bencher, black_box};
use machine::{MachineLoop, TransferFunction, margins};
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
