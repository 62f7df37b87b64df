//! Margins against printed values, and against the roots: a margin taken from a loop is where a root meets the axis.

use control::{Filter, Parts};
use linear::DelayMargin;
use machine::{MachineMargins, MarginsError, margins, min_damping};
use rotor::{Feedback, Rotor, Settings, builtin};

/// Gains of the source: `kd cd kc cc`.
const COMPOSITE: [f64; 4] = [-0.5879, 0.4948, -0.4847, 0.6483];
const INDIVIDUAL: [[f64; 4]; 2] = [[4.0, 3.1168, 3.1241, 0.9175], [-2.3419, 4.0, -3.7635, 4.0]];

fn three_mass() -> Rotor {
    builtin::rotor("three-mass").expect("built in")
}

fn composite() -> Settings {
    let signal = rotor::Signal::composite(&[1.0, 1.0, 0.0], COMPOSITE);
    Settings::new(&three_mass(), 0.0, Feedback::new(0, vec![signal]))
}

fn individual() -> Settings {
    let signals = (0..2).map(|k| rotor::Signal::at_mass(k, 3, INDIVIDUAL[k])).collect();
    Settings::new(&three_mass(), 0.0, Feedback::new(0, signals))
}

fn at(settings: &Settings, speed: f64) -> MachineMargins {
    margins(&three_mass(), settings, speed).expect("stable")
}

/// As many digits as are printed.
fn is(found: f64, printed: f64, digits: i32, what: &str) {
    let place = 10.0_f64.powi(printed.abs().log10().floor() as i32 + 1 - digits);
    assert!((found - printed).abs() <= 0.500_001 * place, "{what}: {found} for {printed}");
}

#[test]
fn val_margins_are_those_of_the_source_to_every_digit_printed() {
    struct Row {
        settings: Settings,
        speed: f64,
        delay: [f64; 2],
        up: Option<[f64; 2]>,
        down: [f64; 2],
        phase: [f64; 2],
        peak: [f64; 2],
    }
    let none = f64::NAN;
    let rows = [
        Row {
            settings: composite(),
            speed: 2.5,
            delay: [0.615245, 2.4595],
            up: Some([1.75127, none]),
            down: [0.147612, none],
            phase: [32.5755, -0.66070],
            peak: [2.90308, -0.50386],
        },
        Row {
            settings: composite(),
            speed: 6.0,
            delay: [0.112792, 2.2158],
            up: Some([1.11923, 2.26286]),
            down: [0.815940, 0.90457],
            phase: [7.46265, 2.28254],
            peak: [10.3495, 2.27041],
        },
        Row {
            settings: individual(),
            speed: 2.5,
            delay: [0.257659, 3.7114],
            up: None,
            down: [0.0292362, none],
            phase: [54.7910, 3.71143],
            peak: [1.11933, 4.87317],
        },
        Row {
            settings: individual(),
            speed: 6.0,
            delay: [0.232233, 3.7309],
            up: None,
            down: [0.380408, none],
            phase: [49.6434, 3.73091],
            peak: [1.19172, 3.62675],
        },
    ];
    for Row { settings, speed, delay, up, down, phase, peak } in rows {
        let found = at(&settings, speed).margins;
        let told = found.delay.expect("there is one");
        is(told.delay, delay[0], 6, "delay");
        is(told.frequency, delay[1], 5, "frequency of the delay margin");
        assert_eq!(found.gain_up.is_some(), up.is_some(), "{:?}", found.gain_up);
        let check = |found: [f64; 2], printed: [f64; 2], digits: i32, what: &str| {
            is(found[0], printed[0], digits, what);
            if printed[1].is_finite() {
                is(found[1], printed[1], if printed[1].abs() < 1.0 { 5 } else { 6 }, what);
            }
        };
        if let (Some(found), Some(printed)) = (found.gain_up, up) {
            check([found.factor, found.frequency], printed, 6, "gain up");
        }
        let told = found.gain_down.expect("there is one");
        check([told.factor, told.frequency], down, 6, "gain down");
        let told = found.phase.expect("there is one");
        check([told.angle.to_degrees(), told.frequency], phase, 6, "phase");
        let told = found.sensitivity();
        check([told.amplitude, told.frequency.expect("somewhere")], peak, 6, "sensitivity");
    }
}

/// Loops with every part on, sampled and not.
fn loops() -> Vec<(&'static str, Settings)> {
    let with = |mut settings: Settings, parts: Parts, filters: Vec<Filter>| {
        (settings.feedback.bearings[0].parts, settings.feedback.bearings[0].filters) = (parts, filters);
        settings
    };
    let parts = Parts::default();
    vec![
        ("late", with(individual(), Parts { delay: 0.05, ..parts }, vec![])),
        ("composite, late", with(composite(), Parts { delay: 0.02, ..parts }, vec![])),
        (
            "all",
            with(
                individual(),
                Parts { sensor_lag: 0.01, delay: 0.03, lag: 0.01, lag_damping: 0.7, ..parts },
                vec![Filter::Lowpass { corner: 60.0, order: 2 }, Filter::Notch { frequency: 20.0, width: 2.0 }],
            ),
        ),
        ("sampled", with(individual(), Parts { sample: 0.05, delay: 0.03, ..parts }, vec![])),
    ]
}

#[test]
fn val_at_each_margin_a_root_is_on_the_axis() {
    let rotor = three_mass();
    for (what, settings) in loops() {
        for speed in [2.5, 6.0] {
            let found = at(&settings, speed);
            let least = machine::CountedModes::ALL.min_damping(found.poles.iter().copied());
            assert!((least - min_damping(&rotor, &settings, speed).expect("converges")).abs() < 1e-12);
            let damping = |change: &dyn Fn(&mut Feedback)| {
                let mut changed = settings.clone();
                change(&mut changed.feedback);
                min_damping(&rotor, &changed, speed).expect("converges")
            };
            if let Some(DelayMargin { delay, .. }) = found.margins.delay {
                let late = |part: f64| damping(&|f| f.bearings[0].parts.delay += part * delay);
                assert!(
                    late(1.0).abs() < 1e-8 && late(0.999) > 0.0 && late(1.001) < 0.0,
                    "{what} at {speed}: delay {delay}"
                );
            }
            for gain in [found.margins.gain_up, found.margins.gain_down].into_iter().flatten() {
                let scaled = |factor: f64| {
                    damping(&|f| {
                        for gain in f.bearings[0].signals.iter_mut().flat_map(|signal| &mut signal.gains) {
                            *gain = rotor::Gain::Constant(gain.at(speed) * factor);
                        }
                    })
                };
                assert!(scaled(gain.factor).abs() < 1e-8, "{what} at {speed}: {gain:?}: {}", scaled(gain.factor));
                assert!(scaled(1.0 + 0.999 * (gain.factor - 1.0)) > 0.0, "{what} at {speed}: {gain:?}");
            }
        }
    }
}

#[test]
fn val_no_frequency_of_a_fine_scan_is_above_a_peak() {
    for (what, settings) in loops() {
        for speed in [2.5, 6.0] {
            let found = at(&settings, speed);
            let machine = machine::MachineLoop::at(&three_mass(), &settings, speed).expect("fits");
            let end = machine.gain.beyond(1e-2).min(80.0);
            let most = |of: &dyn Fn(f64) -> f64, from: f64, to: f64| {
                (0..=40_000).map(|i| of(from + (to - from) * f64::from(i) / 40_000.0)).fold(0.0, f64::max)
            };
            let s = |w: f64| machine.gain.at(w).sensitivity();
            let size = |w: f64| s(w).norm();
            let near = |scan: f64, peak: f64| scan <= peak * (1.0 + 1e-9) && scan > peak * (1.0 - 1e-2);
            assert!(near(most(&size, 0.0, end), found.margins.forward.amplitude), "{what} at {speed}: forward");
            assert!(near(most(&size, -end, 0.0), found.margins.backward.amplitude), "{what} at {speed}: backward");
            let axis = |w: f64| ((s(w) + s(-w).conj()) * 0.5).norm();
            assert!(near(most(&axis, 0.0, end), found.margins.axis.amplitude), "{what} at {speed}: axis");
            let complementary = |w: f64| machine.gain.at(w).complementary().norm();
            assert!(
                near(most(&complementary, -end, end), found.margins.complementary.amplitude),
                "{what} at {speed}: complementary"
            );
        }
    }
}

#[test]
fn an_unstable_loop_has_no_margins_and_its_pole_is_told() {
    let refused = margins(&three_mass(), &composite(), 7.5).expect_err("unstable");
    let MarginsError::Unstable { speed, pole } = refused.clone() else { panic!("{refused}") };
    assert!(speed == 7.5 && pole.re > 0.0 && refused.to_string().contains("it has a pole at"), "{refused}");
}

#[test]
fn a_loop_that_is_off_has_no_crossings_and_no_peak() {
    let rotor = three_mass();
    let off = Settings::new(&rotor, 1.0, builtin::feedback(&rotor, "off").expect("built in"));
    let found = margins(&rotor, &off, 1.0).expect("stable").margins;
    assert_eq!((found.delay, found.gain_up, found.gain_down, found.phase), (None, None, None, None));
    assert_eq!(found.sensitivity().amplitude, 1.0);
}
