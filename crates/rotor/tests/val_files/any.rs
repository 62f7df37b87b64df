//! Any rotor, any feedback: what files are made of in the laws of reading them.

use proptest::prelude::*;
use rotor::{ControlBearing, Feedback, Filter, Gain, Mass, Parts, PhysicalMass, Rotor, Signal};

/// Any finite number but with the magnitudes of machines common, and both zeros.
pub(crate) fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1e3..1e3,
        1 => prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, 0.1, 1e16, 1e-7, f64::MAX, f64::MIN_POSITIVE]),
    ]
}

/// No larger than a gain or a weight may be.
pub(crate) fn moderate() -> impl Strategy<Value = f64> {
    any_number().prop_map(|number| if number.abs() > 1e6 { number % 1e6 } else { number })
}

pub(crate) fn mass_values(size: std::ops::Range<f64>) -> impl Strategy<Value = [f64; 7]> {
    let least = size.start.max(1e-3);
    (prop::array::uniform7(size.clone()), least..size.end).prop_map(|(mut values, mass)| {
        values[0] = mass;
        values
    })
}

pub(crate) fn name() -> impl Strategy<Value = String> {
    r#"[a-zA-Z0-9 _."'\\äß≤-]{1,20}"#
}

pub(crate) fn any_rotor() -> impl Strategy<Value = Rotor> {
    (1usize..=16, any::<bool>(), prop::option::of(1e-6..1e-3)).prop_flat_map(|(n, si, length)| {
        let size = if si { 0.0..1e6 } else { 0.0..50.0 };
        let masses = prop::collection::vec(mass_values(size.clone()), n);
        (name(), masses, prop::collection::vec(size, n - 1)).prop_map(move |(name, masses, shafts)| {
            if si {
                // A clearance of a kilometre is not what this is about.
                let mass = |values| PhysicalMass { deadband: 1e-4, ..PhysicalMass::from_values(values) };
                Rotor::from_si(name, masses.into_iter().map(mass).collect(), shafts, length).expect("valid")
            } else {
                Rotor::new(name, masses.into_iter().map(Mass::from_values).collect(), shafts).expect("valid")
            }
        })
    })
}

pub(crate) fn any_gain() -> impl Strategy<Value = Gain> {
    let rising = prop::collection::btree_map(0u32..1000, -1e6..1e6, 1..6);
    prop_oneof![
        (-1e6..1e6).prop_map(Gain::Constant),
        prop::sample::select(vec![0.0, -0.0, 5e-324]).prop_map(Gain::Constant),
        (moderate(), moderate()).prop_map(|(at_zero, slope)| Gain::Linear { at_zero, slope }),
        rising.prop_map(|points| Gain::Table(points.into_iter().map(|(s, v)| (f64::from(s) / 7.0, v)).collect())),
    ]
}

pub(crate) fn any_filter() -> impl Strategy<Value = Filter> {
    let positive = || 1e-6..1e6;
    prop_oneof![
        (positive(), 1usize..=8).prop_map(|(corner, order)| Filter::Lowpass { corner, order }),
        (positive(), positive()).prop_map(|(zero, pole)| Filter::Lead { zero, pole }),
        (positive(), positive()).prop_map(|(frequency, width)| Filter::Notch { frequency, width }),
        positive().prop_map(|width| Filter::SynchronousNotch { width }),
        positive().prop_map(|rate| Filter::Integrator { rate }),
        positive().prop_map(|corner| Filter::Derivative { corner }),
        prop::collection::vec(-9.0..9.0, 1..=9).prop_map(|mut numerator| {
            let denominator = numerator.iter().map(|c| c + 10.0).collect();
            numerator.rotate_left(1);
            Filter::Transfer { numerator, denominator }
        }),
    ]
}

/// Any part there or not there.
pub(crate) fn any_parts() -> impl Strategy<Value = Parts> {
    let values = prop::collection::vec(prop::option::of(0.02..50.0), control::PARTS.len());
    values.prop_map(|values| {
        let mut parts = Parts::default();
        for (part, value) in control::PARTS.iter().zip(values) {
            if let Some(value) = value {
                (part.set)(&mut parts, value);
            }
        }
        // Whole samples, and a controller outside is asked at samples.
        parts.external = if parts.sample > 0.0 { parts.external.ceil() } else { 0.0 };
        parts.external_trip = if parts.external > 0.0 { parts.external_trip.ceil() } else { 0.0 };
        // A sensor that is there, where it has a gain.
        parts.sensor_at = if parts.sensor_gain == 1.0 { 0.0 } else { parts.sensor_at.ceil().min(1.0) };
        // The damping is the lag's.
        if parts.lag == 0.0 {
            parts.lag_damping = 0.0;
        }
        parts
    })
}

pub(crate) fn any_feedback() -> impl Strategy<Value = (usize, Feedback)> {
    (1usize..=16).prop_flat_map(|n| {
        let gains = || prop::array::uniform4(any_gain());
        let weights = || prop::collection::vec(moderate(), n);
        let signal = prop_oneof![
            (0..n, gains()).prop_map(move |(mass, gains)| Signal { gains, ..Signal::at_mass(mass, n, [0.0; 4]) }),
            (weights(), weights(), gains()).prop_map(|(displacement, velocity, gains)| Signal {
                displacement,
                velocity,
                gains,
                filters: vec![]
            }),
        ];
        let signal = (signal, prop::collection::vec(any_filter(), 0..3))
            .prop_map(|(signal, filters)| Signal { filters, ..signal });
        let signals = prop::collection::vec(signal, 1..=4);
        let name = prop::option::of("[ab][a-z0-9_-]{5}");
        let bearing = (name, signals, prop::collection::vec(any_filter(), 0..2), any_parts());
        (Just(n), prop::collection::vec(bearing, 1..=n.min(3))).prop_map(|(n, bearings)| (n, joined(bearings)))
    })
}

/// What a bearing is made of: name, signals, filters, parts of its loop.
pub(crate) type Made = (Option<String>, Vec<Signal>, Vec<Filter>, Parts);

/// Bearings at the first masses, with one clock and names of their own.
pub(crate) fn joined(bearings: Vec<Made>) -> Feedback {
    let Parts { sample, delay, external, external_trip, .. } = bearings[0].3;
    let one = |(station, (name, signals, filters, parts)): (usize, Made)| ControlBearing {
        name: name.map(|name| format!("{name}{station}")),
        station,
        signals,
        filters,
        parts: Parts { sample, delay, external, external_trip, ..parts },
    };
    let mut feedback = Feedback { bearings: bearings.into_iter().enumerate().map(one).collect() };
    // A sensor that nobody reads has no gain of its own.
    let first_is_read = feedback.bearings.iter().any(|bearing| bearing.senses(0));
    for bearing in &mut feedback.bearings {
        bearing.parts.sensor_at *= f64::from(u8::from(first_is_read));
    }
    feedback
}
