//! What the stepping thread of a bench does to a machine allocates nothing and frees nothing, whatever the loop.

use control::{Excitation, Filter, Multisine, Parts, StateWords};
use machine::{Machine, Program};
use rotor::{C64, Feedback, Gain, Settings, builtin};

fn program(change: impl Fn(&mut Feedback), speed: f64, ramp: f64) -> Program {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let mut feedback = builtin::feedback(&rotor, "individual").expect("built in");
    change(&mut feedback);
    let mut settings = Settings::new(&rotor, speed, feedback);
    settings.deadband.fill(1.0);
    settings.ramp = ramp;
    Program::in_substeps(&rotor, &settings, 0.01, 2).expect("can be stepped")
}

fn everything(feedback: &mut Feedback) {
    feedback.bearings[0].parts = Parts {
        sensor_lag: 0.01,
        noise: 1e-3,
        quantum: 1e-3,
        sample: 0.03,
        delay: 0.1,
        lag: 0.02,
        limit: 30.0,
        slew: 900.0,
        ..Parts::default()
    };
    feedback.bearings[0].signals[0].filters =
        vec![Filter::Lowpass { corner: 60.0, order: 3 }, Filter::Integrator { rate: 0.01 }];
    feedback.bearings[0].filters = vec![Filter::SynchronousNotch { width: 0.1 }];
}

const MULTISINE: Multisine =
    Multisine { seed: 1, period: 20.0, lines: [1, 40], tones: 32, away_from: 3.0, amplitude: 0.01, duration: 100.0 };

/// A loop by its name, and what makes it.
type Loop = (&'static str, fn(&mut Feedback));

fn step(machine: &mut Machine, times: usize) {
    for _ in 0..times {
        machine.step();
    }
}

#[test]
fn steps_orders_and_new_programs_allocate_nothing() {
    let late: fn(&mut Feedback) = |f| (f.bearings[0].parts.delay, f.bearings[0].parts.lag) = (0.033, 0.01);
    let scheduled: fn(&mut Feedback) = |f| {
        f.bearings[0].signals[0].gains[1] = Gain::Table(vec![(3.2, 1.9), (3.7, 2.1), (9.0, 1.0)]);
    };
    let loops: [Loop; 4] = [("ideal", |_| ()), ("scheduled", scheduled), ("everything", everything), ("late", late)];
    for (from, first) in loops {
        for (to, second) in loops {
            for ramp in [f64::INFINITY, 0.5] {
                let mut machine = Machine::new(program(first, 3.0, f64::INFINITY));
                let mut next = Box::new(program(second, 4.0, ramp));
                let most = machine.words_at_most().max(next.words_at_most());
                let mut words = StateWords::with_room(most);
                let mut excitation = Some(Box::new(Excitation::of(&MULTISINE).expect("in order")));
                let mut save = |machine: &Machine| {
                    words.clear();
                    machine.save(&mut words);
                };
                let mut taken_out = None;
                let used = allocation_counter::measure(|| {
                    step(&mut machine, 500);
                    save(&machine);
                    machine.kick(1, C64::new(0.1, 0.0));
                    machine.excite(0, &mut excitation);
                    step(&mut machine, 200);
                    save(&machine);
                    machine.excite(0, &mut taken_out);
                    machine.load(&mut next);
                    save(&machine);
                    step(&mut machine, 500);
                    save(&machine);
                    machine.restart();
                    step(&mut machine, 10);
                    machine.coast_down(0.5);
                    save(&machine);
                    step(&mut machine, 10);
                    machine.hold();
                    save(&machine);
                });
                assert_eq!((used.count_total, used.bytes_current), (0, 0), "{from} to {to}, ramp {ramp}");
            }
        }
    }
}
