//! A run-up of three masses over 10 000 units of `tau`: steps, order tracking and critical speeds, beside the steps alone.

use std::sync::atomic::AtomicBool;

use divan::{Bencher, black_box};
use machine::Machine;
use rotor::profile::Profile;
use rotor::{Settings, builtin};
use study::runup::RunUpPlan;

fn main() {
    divan::main();
}

fn plan() -> RunUpPlan {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let settings = Settings::new(&rotor, 0.0, builtin::feedback(&rotor, "individual").expect("built in"));
    RunUpPlan::new(rotor, settings, Profile::ramp(0.0, 6.0, 6e-4), 400).expect("can be stepped")
}

#[divan::bench(sample_count = 10)]
fn run_up_of_10_000_tau(bencher: Bencher) {
    let plan = plan();
    bencher.bench_local(|| black_box(plan.run(&mut |_| (), &AtomicBool::new(false))));
}

#[divan::bench(sample_count = 10)]
fn its_steps_alone(bencher: Bencher) {
    let plan = plan();
    bencher.bench_local(|| {
        let (program, steps) = plan.program().expect("can be stepped");
        let mut machine = Machine::new(program);
        (0..steps).for_each(|_| {
            machine.step();
        });
        black_box(machine.sample().displacement[0])
    });
}
