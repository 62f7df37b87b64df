//! Corners against the formulas of the filters, differences, and the difference equations of sampled loops.

use super::*;
use crate::{ControlBearing, GainKind, LinearLoop, Signal};

fn filters() -> Vec<Filter> {
    vec![
        Filter::Lowpass { corner: 8.0, order: 1 },
        Filter::Lowpass { corner: 8.0, order: 5 },
        Filter::Lead { zero: 2.0, pole: 9.0 },
        Filter::Notch { frequency: 3.1, width: 0.4 },
        Filter::SynchronousNotch { width: 0.3 },
        Filter::Integrator { rate: 0.4 },
        Filter::Derivative { corner: 20.0 },
        // A zero at 2 and a pair at 3.2, over an integrator, a pole at 0.5, and a pair at 5 of damping ratio 0.2.
        Filter::Transfer {
            numerator: vec![0.0, 0.3, 1.224, 4.2240, 6.144],
            denominator: vec![2.0, 5.0, 52.0, 25.0, 0.0],
        },
    ]
}

#[test]
fn what_a_filter_has_is_what_its_file_says_and_itself_again() {
    let told = |filter: Filter| {
        let corners = Corners::of(&filter);
        (corners.names().join(" "), corners.values())
    };
    assert_eq!(told(Filter::Lowpass { corner: 8.0, order: 3 }), ("corner".into(), vec![8.0]));
    assert_eq!(told(Filter::Lead { zero: 2.0, pole: 9.0 }), ("zero pole".into(), vec![2.0, 9.0]));
    assert_eq!(told(Filter::Notch { frequency: 3.0, width: 0.2 }), ("frequency width".into(), vec![3.0, 0.2]));
    assert_eq!(told(Filter::Integrator { rate: 0.2 }), ("rate".into(), vec![0.2]));
    for filter in filters() {
        let corners = Corners::of(&filter);
        assert_eq!(corners.names().len(), corners.values().len());
        let again = corners.filter(&corners.values());
        again.check().expect("allowed");
        if let (Filter::Transfer { denominator: a, .. }, Filter::Transfer { denominator: b, .. }) = (&filter, &again) {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-13 * a.abs().max(1.0)), "{a:?} {b:?}");
        } else {
            assert_eq!(again, filter);
        }
    }
}

#[test]
fn val_a_transfer_function_has_the_corners_of_its_factors() {
    // (1 + 2 pi 0.5 / s) (s / 2 pi 45 + 1) / (s / 2 pi 1200 + 1) / (s / 2 pi 2500 + 1), times 5600.
    let filter = Filter::Transfer {
        numerator: vec![2_345_722_514.680_379, 670_606_720_372.684_9, 2_083_621_792_916.147_7],
        denominator: vec![1.0, 23_247.785_636_564_47, 118_435_252.813_072_3, 0.0],
    };
    let corners = Corners::of(&filter);
    assert_eq!(corners.names(), ["zero.1", "zero.2", "pole.1", "pole.2"]);
    for (found, hertz) in corners.values().iter().zip([0.5, 45.0, 1200.0, 2500.0]) {
        assert!((found / (2.0 * PI) / hertz - 1.0).abs() < 1e-12, "{found} {hertz}");
    }
    // The zero at 45 Hz put at 90 Hz: that factor alone is another, and far below all corners it is what it was.
    let moved = corners.filter(&[0.5, 90.0, 1200.0, 2500.0].map(|hertz| 2.0 * PI * hertz));
    for w in [1.0, 300.0, 7e3] {
        let s = J * w;
        let part = |hertz: f64| s / (2.0 * PI * hertz) + 1.0;
        let expected = filter.at(s, 0.0) / part(45.0) * part(90.0);
        assert!((moved.at(s, 0.0) / expected - 1.0).norm() < 1e-12);
    }
    // A pair counts once, at its frequency, and keeps its damping ratio.
    let pair = Corners::of(&Filter::Transfer { numerator: vec![3.0], denominator: vec![1.0, 2.0, 25.0] });
    assert_eq!(pair.names(), ["pole.1"]);
    let Filter::Transfer { numerator, denominator } = pair.filter(&[10.0]) else { panic!("still one") };
    for (found, expected) in numerator.iter().chain(&denominator).zip([12.0, 1.0, 4.0, 100.0]) {
        assert!((found - expected).abs() < 1e-12 * expected, "{numerator:?} {denominator:?}");
    }
}

#[test]
fn slopes_are_those_of_differences_on_the_axis_off_it_and_between_samples() {
    for filter in filters() {
        let corners = Corners::of(&filter);
        let values = corners.values();
        for (s, speed) in [(C64::new(0.0, 1.7), 2.5), (C64::new(-0.4, -3.0), 0.0), (C64::new(0.3, 6.0), 6.0)] {
            for period in [0.0, 0.1] {
                let slopes = corners.slopes(&values, s, speed, period);
                for (k, slope) in slopes.iter().enumerate() {
                    let h: f64 = 1e-6;
                    let at = |by: f64| {
                        let mut there = values.clone();
                        there[k] *= by.exp();
                        corners.response(&there, s, speed, period)
                    };
                    let difference = (at(h) - at(-h)) / (2.0 * h);
                    assert!(
                        (difference - slope).norm() < 1e-8 * (1.0 + slope.norm()),
                        "{filter:?} {k} {s}: {difference} {slope}"
                    );
                }
            }
        }
    }
    // At a notch, where it is 0 and the logarithm of it is not.
    let notch = Corners::of(&Filter::Notch { frequency: 3.0, width: 0.5 });
    let slopes = notch.slopes(&[3.0, 0.5], J * 3.0, 0.0, 0.0);
    assert!((slopes[0] - C64::new(0.0, -12.0)).norm() < 1e-12 && slopes[1] == C64::ZERO, "{slopes:?}");
}

/// What a filter answers in a loop, as the loop's own matrices have it, continuous and sampled.
#[test]
fn val_responses_are_those_of_the_loop() {
    let (w, speed) = (1.9, 2.5);
    for filter in filters() {
        for period in [0.0, 0.07] {
            let mut bearing = ControlBearing::new(0, vec![Signal::at_mass(0, 1, [1.0, 0.0, 0.0, 0.0])]);
            bearing.parts.sample = period;
            let answer = |bearing: &ControlBearing| {
                LinearLoop::new(bearing, 1, speed).expect("fits").fundamental(w).expect("no pole there")[0]
            };
            let bare = answer(&bearing);
            bearing.signals[0].filters = vec![filter.clone()];
            assert_eq!(*bearing.signals[0].gain_mut(GainKind::Kd), crate::Gain::Constant(1.0));
            let corners = Corners::of(&filter);
            let expected = answer(&bearing) / bare;
            let found = corners.response(&corners.values(), J * w, speed, period);
            assert!(
                (found - expected).norm() < 1e-11 * (1.0 + expected.norm()),
                "{filter:?} {period}: {found} {expected}"
            );
        }
    }
}
