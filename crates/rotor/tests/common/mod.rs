//! Random machines, for the laws that hold for any.

use proptest::prelude::*;
use rotor::{Feedback, Gain, Mass, Rotor, Signal};

fn mass() -> impl Strategy<Value = Mass> {
    (0.05..2.0, 0.0..0.6, 0.0..0.2, 0.0..1.0, 0.0..1.0).prop_map(
        |(mass, damping, cross_damping, bearing_stiffness, seal_stiffness)| Mass {
            mass,
            damping,
            cross_damping,
            bearing_stiffness,
            seal_stiffness,
            ..Mass::default()
        },
    )
}

/// A gain of each kind.
fn gain() -> impl Strategy<Value = Gain> {
    prop_oneof![
        (-1.0..1.0).prop_map(Gain::Constant),
        (-1.0..1.0, -0.3..0.3).prop_map(|(at_zero, slope)| Gain::Linear { at_zero, slope }),
        (prop::collection::vec((0.3..2.0, -1.0..1.0), 1..4)).prop_map(|steps| {
            let mut speed = 0.0;
            Gain::Table(
                steps
                    .into_iter()
                    .map(|(step, value): (f64, f64)| {
                        speed += step;
                        (speed, value)
                    })
                    .collect(),
            )
        }),
    ]
}

/// A rotor of at most `most` masses with one or two signals of any gains.
pub(crate) fn machine(most: usize) -> impl Strategy<Value = (Rotor, Feedback)> {
    (1..=most).prop_flat_map(|n| {
        let signal = (prop::collection::vec(-1.0..1.0, n), prop::array::uniform4(gain()))
            .prop_map(|(weights, gains)| Signal { gains, ..Signal::composite(&weights, [0.0; 4]) });
        (
            prop::collection::vec(mass(), n),
            prop::collection::vec(0.05..1.0, n - 1),
            prop::collection::vec(signal, 1..=2),
            0..n,
        )
            .prop_map(|(masses, shafts, signals, bearing)| {
                (Rotor::new("random", masses, shafts).expect("in range"), Feedback::new(bearing, signals))
            })
    })
}
