//! Runge-Kutta steps a second, beside the same integration with dense real matrices in the same process.
//!
//! `cargo bench -p rotor --bench steps`; one iteration is one step, so items a second are steps a second.

use divan::counter::ItemsCount;
use nalgebra::{DMatrix, DVector};
use rotor::{ClosedLoop, Feedback, MAX_MASSES, Mass, Rotor, Signal, builtin, report_form, stepper};

const STEPS: usize = 1000;
const DTAU: f64 = 0.01;

fn main() {
    divan::main();
}

/// jeffcott, three-mass, or a chain; with a deadband that the motion crosses.
fn machine(masses: usize) -> (Rotor, Feedback, Vec<f64>) {
    let (rotor, feedback) = match masses {
        1 | 3 => {
            let (name, feedback) = if masses == 1 { ("jeffcott", "cancel") } else { ("three-mass", "composite") };
            let rotor = builtin::rotor(name).expect("built in");
            let feedback = builtin::feedback(&rotor, feedback).expect("built in");
            (rotor, feedback)
        }
        _ => {
            let mass = Mass {
                mass: 1.0 / masses as f64,
                damping: 0.2,
                bearing_stiffness: 0.2,
                unbalance: 0.1,
                ..Mass::default()
            };
            let rotor = Rotor::new("chain", vec![mass; masses], vec![0.5; masses - 1]).expect("valid");
            let signal = Signal::composite(&vec![0.1; masses], [0.1, 0.3, -0.1, 0.0]);
            (rotor, Feedback::new(0, vec![signal]))
        }
    };
    (rotor, feedback, vec![0.5; masses])
}

#[divan::bench(args = [1, 3, MAX_MASSES])]
fn chain(bencher: divan::Bencher<'_, '_>, masses: usize) {
    let (rotor, feedback, deadband) = machine(masses);
    let mut motion = stepper(&ClosedLoop::new(&rotor, &feedback, 2.0, &deadband));
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        (0..STEPS).for_each(|_| motion.step(DTAU));
        motion.motion().displacement[0]
    });
}

/// The report's real `4n x 4n` matrix, with the bearings taken out of it, as one would first write it.
#[divan::bench(args = [1, 3, MAX_MASSES])]
fn dense_matrices(bencher: divan::Bencher<'_, '_>, masses: usize) {
    let (rotor, feedback, deadband) = machine(masses);
    let speed = 2.0;
    let free: Vec<Mass> = rotor.masses().iter().map(|m| Mass { bearing_stiffness: 0.0, ..*m }).collect();
    let free = Rotor::new("free", free, rotor.shafts().to_vec()).expect("valid");
    let matrix: DMatrix<f64> = report_form::closed_loop_matrix(&free, &feedback, speed);
    let n = masses;
    // [y z vy vz] for one mass, [y.. vy.. z.. vz..] for more.
    let (y, z, vy, vz) = if n == 1 { (0, 1, 2, 3) } else { (0, 2 * n, n, 3 * n) };
    let bearing: Vec<f64> = rotor.masses().iter().map(|m| m.bearing_stiffness / m.mass).collect();
    let unbalance: Vec<f64> = rotor.masses().iter().map(|m| m.unbalance * speed * speed).collect();
    let slope = |x: &DVector<f64>, tau: f64, out: &mut DVector<f64>| {
        out.gemv(1.0, &matrix, x, 0.0);
        let (sine, cosine) = (speed * tau).sin_cos();
        for k in 0..n {
            let radius = x[y + k].hypot(x[z + k]);
            let s = if radius > deadband[k] { 1.0 - deadband[k] / radius } else { 0.0 };
            out[vy + k] += unbalance[k] * cosine - bearing[k] * s * x[y + k];
            out[vz + k] += unbalance[k] * sine - bearing[k] * s * x[z + k];
        }
    };
    let size = 4 * n;
    let (mut x, mut tau) = (DVector::zeros(size), 0.0);
    let mut k: [DVector<f64>; 4] = std::array::from_fn(|_| DVector::zeros(size));
    let mut at = DVector::zeros(size);
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            slope(&x, tau, &mut k[0]);
            for (i, part) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
                at.copy_from(&x);
                at.axpy(part * DTAU, &k[i - 1], 1.0);
                slope(&at, tau + part * DTAU, &mut k[i]);
            }
            for (k, weight) in k.iter().zip([1.0, 2.0, 2.0, 1.0]) {
                x.axpy(weight * DTAU / 6.0, k, 1.0);
            }
            tau += DTAU;
        }
        x[0]
    });
}
