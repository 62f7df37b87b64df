//! What poles cost: a sweep over 64 speeds, so divide by 64. The matrices alone are measured beside their peers in `linear`;
//! `tests/reference/poles.py --time` prints LAPACK's `zgeev` through SciPy.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use rotor::{ClosedLoop, Modes, Rotor, builtin, poles};

fn main() {
    divan::main();
}

/// The rotors measured on, by number of masses: the report's two, and the longest chain there can be.
fn machine(masses: usize) -> Vec<ClosedLoop> {
    let (rotor, feedback) = match masses {
        1 => ("jeffcott", "cancel"),
        _ => ("three-mass", "composite"),
    };
    let mut rotor = builtin::rotor(rotor).expect("built in");
    let mut feedback = builtin::feedback(&rotor, feedback).expect("built in");
    if masses > 3 {
        let ends: Vec<_> = (0..masses).map(|i| rotor.masses()[usize::from(i % 2 == 1)]).collect();
        rotor = Rotor::new("long", ends, vec![0.5; masses - 1]).expect("valid");
        feedback = builtin::feedback(&rotor, "off").expect("fits any");
    }
    (0..64).map(|i| ClosedLoop::new(&rotor, &feedback, f64::from(i) * 0.1, &[])).collect()
}

/// Runs `work` on all 64 machines, as a sweep does: divide by 64.
fn sweep<T>(bencher: Bencher<'_, '_>, items: &[T], work: impl Fn(&T)) {
    bencher.counter(ItemsCount::new(items.len())).bench_local(|| items.iter().for_each(|item| work(black_box(item))));
}

#[divan::bench(args = [1, 3, 16])]
fn spectrum(bencher: Bencher<'_, '_>, masses: usize) {
    sweep(bencher, &machine(masses), |m| drop(black_box(Modes::of(m))));
}

#[divan::bench(args = [1, 3, 16])]
fn poles_only(bencher: Bencher<'_, '_>, masses: usize) {
    sweep(bencher, &machine(masses), |m| drop(black_box(poles(m))));
}

/// The report's Fig. 4.2 in 500 points, every pole followed.
#[divan::bench(args = ["off", "composite"])]
fn trace_of_500(bencher: Bencher<'_, '_>, feedback: &str) {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, feedback).expect("built in");
    let speeds: Vec<f64> = (0..500).map(|i| f64::from(i) * 6.0 / 499.0).collect();
    bencher.bench_local(|| rotor::trace(&rotor, black_box(&feedback), &speeds));
}

#[divan::bench(args = ["off", "composite"])]
fn thresholds(bencher: Bencher<'_, '_>, feedback: &str) {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, feedback).expect("built in");
    bencher.bench_local(|| rotor::thresholds(&rotor, black_box(&feedback), 0.0, 8.0));
}
