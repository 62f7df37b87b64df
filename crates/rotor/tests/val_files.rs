//! Rotors and feedback as files: what is written reads back, SI agrees with the report, and no text makes a panic.

use proptest::prelude::*;
use rotor::file::{kind_of, read_feedback, read_feedback_for, read_rotor, write_feedback, write_rotor};
use rotor::{
    C64, ClosedLoop, ControlBearing, Feedback, Filter, Gain, GainKind, Mass, Modes, Parts, PhysicalMass, Rotor, Scales,
    Signal, builtin, stepper,
};
use text::{MAX_BYTES, utf8};

/// Table 4.2 as a machine of 40 kg with w0 = 300 rad/s and an unbalance of 20 um.
const SI: &str = r#"
name = "three-mass"
units = "si"
[[mass]]
mass = 10
damping = 1500
cross_damping = 300
bearing_stiffness = 1.8e6
deadband = 2e-5
[[mass]]
mass = 20
unbalance = 20e-6
[[mass]]
mass = 10
damping = 1500
cross_damping = 300
bearing_stiffness = 1.8e6
deadband = 20e-6
[[shaft]]
stiffness = 1.8e6
[[shaft]]
stiffness = 1.8e6
"#;

/// The report's rotor with a deadband of 1 at both ends.
fn report_rotor() -> Rotor {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let ends = |(i, m): (usize, &Mass)| Mass { deadband: if i == 1 { 0.0 } else { 1.0 }, ..*m };
    Rotor::new("three-mass", rotor.masses().iter().enumerate().map(ends).collect(), rotor.shafts().to_vec())
        .expect("valid")
}

/// Largest distance between the values of two rotors, relative to the larger of the value and 1.
fn distance(a: &Rotor, b: &Rotor) -> f64 {
    let values = |r: &Rotor| r.masses().iter().flat_map(Mass::values).chain(r.shafts().to_vec()).collect::<Vec<_>>();
    let (a, b) = (values(a), values(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.abs().max(1.0)).fold(0.0, f64::max)
}

#[test]
fn val_an_si_rotor_equivalent_to_table_4_2_moves_like_it() {
    let (si, report) = (read_rotor(SI, "x").expect("valid"), report_rotor());
    assert!(distance(&si, &report) < 1e-12);
    let scales = *si.scales().expect("si");
    assert_eq!((scales.w0, scales.m_t, scales.k_t, scales.e_t), (300.0, 40.0, 3.6e6, 20e-6));

    let feedback = builtin::feedback(&report, "composite").expect("built in");
    for speed in [0.0, 1.775, 4.0, 6.0] {
        let [ours, theirs] = [&si, &report].map(|rotor| ClosedLoop::new(rotor, &feedback, speed, &rotor.deadbands()));
        let [a, b] = [&ours, &theirs].map(|closed_loop| Modes::of(closed_loop).expect("converges"));
        for (a, b) in a.modes.iter().zip(&b.modes) {
            assert!((a.pole - b.pole).norm() < 1e-12, "{} and {} at R = {speed}", a.pole, b.pole);
        }
        let run = |closed_loop: &ClosedLoop| {
            let mut motion = stepper(closed_loop);
            motion.place(&[C64::new(1.5, 0.0), C64::new(0.0, 2.0)], &[]);
            (0..400).for_each(|_| motion.step(0.02));
            motion.motion().displacement.to_vec()
        };
        for (a, b) in run(&ours).iter().zip(run(&theirs)) {
            assert!((a - b).norm() < 1e-12 * b.norm().max(1.0), "{a} and {b} at R = {speed}");
        }
    }
}

#[test]
fn val_scales_convert_to_si_and_back() {
    let scales = Scales { w0: 300.0, k_t: 3.6e6, m_t: 40.0, e_t: 20e-6 };
    // 300 rad/s are 300 / (2 pi) turns a second.
    assert!((scales.rpm(1.0) - 2_864.788_975_654_116).abs() < 1e-9);
    assert!((scales.metres(1.5) - 30e-6).abs() < 1e-18);
    assert!((scales.seconds(600.0) - 2.0).abs() < 1e-15);
    // u = 1 on 10 kg is an acceleration of w0^2 e_t = 1.8 m/s^2.
    assert!((scales.newtons(1.0, 0.25) - 18.0).abs() < 1e-12);
    for number in [0.0, 0.3, 7.0, 1e4] {
        for back in [
            scales.speed(scales.rpm(number)),
            scales.length(scales.metres(number)),
            scales.tau(scales.seconds(number)),
            scales.acceleration(scales.newtons(number, 0.25), 0.25),
        ] {
            assert!((back - number).abs() <= 4.0 * f64::EPSILON * number, "{back} from {number}");
        }
    }
}

#[test]
fn without_unbalance_a_reference_length_stands_for_e_t() {
    let still = SI.replace("unbalance = 20e-6", "");
    let refused = read_rotor(&still, "x").expect_err("no e_t").to_string();
    assert_eq!(
        refused,
        "3:9: the sum of unbalance = 0: expected a finite number of m greater than 0, or a reference_length in m to \
         measure displacements by"
    );
    let rotor = read_rotor(&format!("reference_length = 1e-5\n{still}"), "x").expect("valid");
    assert_eq!(rotor.scales().expect("si").e_t, 1e-5);
    assert!((rotor.masses()[0].deadband - 2.0).abs() < 1e-15);
    // Opposite unbalances are a couple without a sum: what is left of it is rounding.
    let couple = still.replace("cross_damping = 300", "unbalance = 0.1").replacen("0.1", "-0.3", 1);
    let couple = couple.replace("mass = 20", "mass = 20\nunbalance = 0.2");
    assert!(read_rotor(&couple, "x").expect_err("no e_t").to_string().contains("the sum of unbalance = 0: "));
}

/// Any finite number but with the magnitudes of machines common, and both zeros.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1e3..1e3,
        1 => prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, 0.1, 1e16, 1e-7, f64::MAX, f64::MIN_POSITIVE]),
    ]
}

/// No larger than a gain or a weight may be.
fn moderate() -> impl Strategy<Value = f64> {
    any_number().prop_map(|number| if number.abs() > 1e6 { number % 1e6 } else { number })
}

fn mass_values(size: std::ops::Range<f64>) -> impl Strategy<Value = [f64; 7]> {
    let least = size.start.max(1e-3);
    (prop::array::uniform7(size.clone()), least..size.end).prop_map(|(mut values, mass)| {
        values[0] = mass;
        values
    })
}

fn name() -> impl Strategy<Value = String> {
    r#"[a-zA-Z0-9 _."'\\äß≤-]{1,20}"#
}

fn any_rotor() -> impl Strategy<Value = Rotor> {
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

fn any_gain() -> impl Strategy<Value = Gain> {
    let rising = prop::collection::btree_map(0u32..1000, -1e6..1e6, 1..6);
    prop_oneof![
        (-1e6..1e6).prop_map(Gain::Constant),
        prop::sample::select(vec![0.0, -0.0, 5e-324]).prop_map(Gain::Constant),
        (moderate(), moderate()).prop_map(|(at_zero, slope)| Gain::Linear { at_zero, slope }),
        rising.prop_map(|points| Gain::Table(points.into_iter().map(|(s, v)| (f64::from(s) / 7.0, v)).collect())),
    ]
}

fn any_filter() -> impl Strategy<Value = Filter> {
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
fn any_parts() -> impl Strategy<Value = Parts> {
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

fn any_feedback() -> impl Strategy<Value = (usize, Feedback)> {
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
type Made = (Option<String>, Vec<Signal>, Vec<Filter>, Parts);

/// Bearings at the first masses, with one clock and names of their own.
fn joined(bearings: Vec<Made>) -> Feedback {
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

proptest! {
    /// Writing and reading a rotor is the identity, down to the sign of a zero.
    #[test]
    fn a_rotor_reads_back_bit_for_bit(rotor in any_rotor()) {
        let written = write_rotor(&rotor);
        let read = read_rotor(&written, "x").expect("what we write is valid");
        prop_assert_eq!(format!("{read:?}"), format!("{rotor:?}"));
        prop_assert_eq!(write_rotor(&read), written);
    }

    /// Writing and reading feedback is the identity.
    #[test]
    fn feedback_reads_back_bit_for_bit((masses, feedback) in any_feedback()) {
        let written = write_feedback(&feedback);
        let read = read_feedback(&written, Some(masses)).expect("what we write is valid");
        prop_assert_eq!(format!("{read:?}"), format!("{feedback:?}"));
    }

    /// Grams or kilograms, minutes or seconds: the units cancel.
    #[test]
    fn other_units_give_the_same_dimensionless_rotor(
        masses in prop::collection::vec(mass_values(0.0..10.0), 3),
        shafts in prop::collection::vec(0.0..10.0, 2),
        kilogram in 1e-3..1e3, metre in 1e-3..1e3, second in 1e-3..1e3,
    ) {
        let stiffness = kilogram / (second * second);
        let damping = kilogram / second;
        let units = [kilogram, damping, damping, stiffness, stiffness, metre, metre];
        let of = |units: [f64; 7], shaft: f64| {
            let scaled = |m: &[f64; 7]| PhysicalMass::from_values(std::array::from_fn(|i| m[i] * units[i]));
            let shafts = shafts.iter().map(|k| k * shaft).collect();
            Rotor::from_si("x", masses.iter().map(scaled).collect(), shafts, None).expect("valid")
        };
        prop_assert!(distance(&of(units, stiffness), &of([1.0; 7], 1.0)) < 1e-12);
    }

    /// Random bytes never panic, whatever they are taken for.
    #[test]
    fn no_bytes_make_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        if let Ok(text) = utf8(&bytes, "a file") {
            read_anything(text);
        }
    }

    /// Nor does text made of the words of TOML files.
    #[test]
    fn no_words_make_a_panic(words in prop::collection::vec(prop::sample::select(vec![
        "[[mass]]\n", "[mass]\n", "[[signal]]\n", "[[shaft]]\n", "[loop]\n", "mass", "signal", "shaft", "kd", "bearing",
        "displacement", " = ", "1", "-1", "1.5", "nan", "inf", "1e999", "0x10", "99999999999999999999", "\"si\"", "units",
        "\n", "[", "]", "{", "}", ",", "speed", "value", "at_zero", "slope", ".", "'", "\"", "#", "\u{feff}", "\u{1b}",
    ]), 0..60)) {
        read_anything(&words.concat());
    }

    /// Nor does a valid file with some bytes overwritten, left out or doubled.
    #[test]
    fn no_damage_makes_a_panic(
        (masses, feedback) in any_feedback(),
        rotor in any_rotor(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), 0..3, any::<u8>()), 1..8),
    ) {
        for written in [write_rotor(&rotor), write_feedback(&feedback), SI.to_owned()] {
            let mut bytes = written.into_bytes();
            for (at, how, byte) in &damage {
                let at = at.index(bytes.len());
                match how {
                    0 => bytes[at] = *byte,
                    1 => drop(bytes.remove(at)),
                    _ => bytes.insert(at, bytes[at]),
                }
            }
            if let Ok(text) = utf8(&bytes, "a file") {
                read_anything(text);
                let _ = read_feedback(text, Some(masses));
            }
        }
    }
}

/// Reads `text` as everything it could be; what is accepted must be sound.
fn read_anything(text: &str) {
    let _ = kind_of(text);
    if let Ok(rotor) = read_rotor(text, "x") {
        assert_eq!(read_rotor(&write_rotor(&rotor), "y").expect("reads back"), rotor);
    }
    for masses in [None, Some(1), Some(3)] {
        if let Ok(feedback) = read_feedback(text, masses) {
            let masses = masses.unwrap_or(feedback.bearings[0].signals[0].displacement.len());
            feedback.check(masses).expect("sound");
        }
    }
}

#[test]
fn deep_and_long_files_end_soon() {
    for unit in ["[", "{a=", "[[mass]]\n", "a.", "x = 1\n", "\"", "[a."] {
        let text = unit.repeat(MAX_BYTES / unit.len());
        assert!(read_rotor(&text, "x").is_err(), "{unit:?}");
        assert!(read_feedback(&text, None).is_err(), "{unit:?}");
    }
}

#[test]
fn what_is_left_out_has_its_default() {
    let rotor = read_rotor("[[mass]]\nmass = 2\n", "left out").expect("valid");
    assert_eq!(rotor, Rotor::new("left out", vec![Mass { mass: 2.0, ..Mass::default() }], vec![]).expect("valid"));
    let feedback = read_feedback("bearing = 1\n[[signal]]\nmass = 2\nkc = { at_zero = 1, slope = -0.5 }\n", None);
    let mut signal = Signal::at_mass(1, 2, [0.0; 4]);
    *signal.gain_mut(GainKind::Kc) = Gain::Linear { at_zero: 1.0, slope: -0.5 };
    assert_eq!(feedback.expect("valid"), Feedback::new(0, vec![signal]));
    // A byte order mark, Windows line ends, inline tables: all TOML.
    let windows = "\u{feff}name = 'x'\r\nmass = [{ mass = 1_0.5, unbalance = -0x10 }]\r\n".replace("-0x10", "0x10");
    assert_eq!(read_rotor(&windows, "y").expect("valid").masses()[0].unbalance, 16.0);
    assert_eq!(read_rotor(&windows, "y").expect("valid").masses()[0].mass, 10.5);
}

#[test]
fn what_is_wrong_with_a_loop_is_named_with_its_line() {
    let told = |lines: &str| {
        let text = format!("bearing = 1\n{lines}\n[[signal]]\nmass = 1\n");
        read_feedback(&text, None).expect_err(lines).to_string()
    };
    for (lines, expected) in [
        ("filter = [{ kind = \"lowpass\", corner = 0, order = 2 }]", "corner = 0"),
        ("filter = [{ kind = \"lowpass\", corner = 1, order = 9 }]", "an order, 1 to 8"),
        (
            "filter = [{ kind = \"notsch\" }]",
            "one of lowpass, lead, notch, synchronous-notch, integrator, derivative, transfer, state-space",
        ),
        ("filter = [{ corner = 1 }]", "a filter without kind"),
        ("filter = [{ kind = \"notch\", frequency = 1, width = 1, depth = 3 }]", "unknown key 'depth'"),
        (
            "filter = [{ kind = \"transfer\", numerator = [1, 0], denominator = [1] }]",
            "no more of them above than below",
        ),
        ("filter = [{ kind = \"state-space\", b = [1], c = [1] }]", "state-space without a"),
        ("filter = [{ kind = \"state-space\", a = [[1, 2], [3]], b = [1, 2], c = [1, 2] }]", "a, row 2, of 1 numbers"),
        (
            "filter = [{ kind = \"state-space\", a = [[1, 2], [3, 4]], b = [1], c = [1, 2] }]",
            "b of 1 and c of 2: expected a square a",
        ),
        ("filter = [{ kind = \"state-space\", a = [[inf]], b = [1], c = [1] }]", "a: inf: expected a finite number"),
        ("filter = [{ kind = \"state-space\", a = 1, b = [1], c = [1] }]", "rows of finite numbers"),
        ("units = \"si\"", "needs a rotor in SI units"),
    ] {
        let found = told(lines);
        assert!(found.contains(expected), "{lines}\n{found}");
    }
    for (key, value) in [
        ("delay", "-0.1"),
        ("delay", "inf"),
        ("limit", "0"),
        ("sample", "nan"),
        ("slew", "0.0"),
        ("lag_damping", "0.7"),
    ] {
        let text = format!("bearing = 1\n[[signal]]\nmass = 1\n[loop]\n{key} = {value}\n");
        let found = read_feedback(&text, None).expect_err(key).to_string();
        assert!(found.contains(&format!("{key} = {value}")) && found.contains('5'), "{found}");
    }
}

/// The same loop written in seconds, newtons and hertz is the same loop.
#[test]
fn val_a_loop_in_si_units_is_the_dimensionless_one() {
    let rotor = read_rotor(SI, "x").expect("valid");
    let scales = *rotor.scales().expect("in SI units");
    let text = "units = \"si\"\nbearing = 1\n[[signal]]\nmass = 1\n\
                filter = [{ kind = \"lowpass\", corner = 100.0, order = 2 }, { kind = \"transfer\", numerator = [2.0, 3.0], denominator = [5.0, 7.0] }, \
                { kind = \"state-space\", a = [[0.0, 1.0], [-9e4, -120.0]], b = [0.0, 9e4], c = [1.0, 2e-3], d = 0.25 }]\n\
                [loop]\ndelay = 1e-4\nlimit = 20.0\nslew = 3000.0\nquantum = 1e-7\n";
    let feedback = read_feedback_for(text, &rotor).expect("valid");
    let (parts, mass) = (feedback.bearings[0].parts, rotor.masses()[0].mass);
    let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    close(parts.delay, 1e-4 * scales.w0);
    close(scales.newtons(parts.limit, mass), 20.0);
    close(scales.newtons(parts.slew, mass) * scales.w0, 3000.0);
    close(parts.quantum, 1e-7 / scales.e_t);
    // At 40 Hz both say what the formulas say.
    let s = rotor::C64::new(0.0, std::f64::consts::TAU * 40.0);
    let through = |k: usize| feedback.bearings[0].signals[0].filters[k].at(s / scales.w0, 0.0);
    close(through(0).norm(), (1.0 + 0.4f64.powi(4)).powf(-0.5));
    close(((s * 2.0 + 3.0) / (s * 5.0 + 7.0) / through(1)).norm(), 1.0);
    // x1'' = -9e4 x1 - 120 x1' + 9e4 y, u = x1 + 2e-3 x1' + y / 4.
    let exact = (s * 2e-3 + 1.0) * 9e4 / (s * s + s * 120.0 + 9e4) + 0.25;
    assert!((through(2) - exact).norm() < 1e-12 * exact.norm(), "{} for {exact}", through(2));
}

#[test]
fn a_magnetic_bearing_is_not_called_as_a_setting_is() {
    let rig = builtin::rotor("rig").expect("built in");
    let text = write_rotor(&rig);
    let line = text.lines().position(|line| line.starts_with("name = \"left\"")).expect("a bearing") + 1;
    for name in ["deadband", "speed", "feedback", "kd", "limit"] {
        let named = text.replacen("name = \"left\"", &format!("name = {name:?}"), 1);
        let told = read_rotor(&named, "rig").expect_err("refused").in_file("rig.toml");
        let expected = "expected a name that is no setting: it stands in front of keys, as in left.kd";
        assert_eq!(told, format!("rig.toml:{line}:8: name = {name:?}: {expected}"));
        // A program is told too.
        let mut sketch = rig.beam().expect("shaft elements").drawing().clone().into_sketch();
        sketch.magnetics[0].name = name.into();
        let refused = Rotor::from_drawing(beam::Drawing::new(sketch).expect("a drawing")).expect_err("refused");
        assert_eq!(refused.to_string(), format!("magnetic bearing {name:?}: {expected}"));
    }
    let named = text.replacen("name = \"left\"", "name = \"speedy\"", 1);
    read_rotor(&named, "rig").expect("a name like others");
}

/// ISO 21940-11: a grade is eccentricity times speed, of all of the rotor; without a speed of its own, the rotor's own `w0`.
#[test]
fn val_a_grade_without_a_speed_is_for_the_rotors_own_scale() {
    let with = |unbalance: &str| {
        let text = format!(
            "units = 'si'\nreference_length = 1e-6\n[plant]\nstations = [1, 2]\nmass = [[5.0, 0.0], [0.0, 3.0]]\nstiffness = [[4e5, -4e5], [-4e5, 4e5]]\n\
             [[bearing]]\nstation = 1\nstiffness = 7e5\n[[bearing]]\nstation = 2\nstiffness = 1e5\n{unbalance}"
        );
        read_rotor(&text, "graded").expect("a rotor")
    };
    let graded = |speed: &str| {
        format!(
            "[[unbalance]]\nstation = 1\ngrade = 'G6.3'\n{speed}[[unbalance]]\nstation = 2\ngrade = 'G6.3'\n{speed}"
        )
    };
    let w0 = (8e5_f64 / 8.0).sqrt();
    // g mm: half of G / w0 times 8 kg at each of the two.
    let gmm = 0.5 * 6.3e-3 / w0 * 8.0 * 1e6;
    let plain = format!("[[unbalance]]\nstation = 1\ngmm = {gmm:?}\n[[unbalance]]\nstation = 2\ngmm = {gmm:?}\n");
    let rpm = w0 * 30.0 / std::f64::consts::PI;
    let moments = |text: &str| {
        let rotor = with(text);
        let unbalance = rotor::Plant::of(&rotor).unbalance().to_vec();
        assert!(unbalance.iter().all(|u| u.norm() > 0.0), "{text}");
        unbalance
    };
    let expected = moments(&plain);
    for text in [graded(""), graded(&format!("speed = {rpm:?}\n"))] {
        for (ours, exact) in moments(&text).iter().zip(&expected) {
            assert!((ours - exact).norm() < 1e-12 * exact.norm(), "{ours} and {exact}");
        }
    }
}

/// Sum and difference of the two ends, as laws that hold translation and tilt apart have them.
#[test]
fn weights_may_be_called_by_their_places_and_a_bearing_senses_where_its_sensor_is() {
    let text = include_str!("../src/rig.toml")
        .replace("name = \"left\"\nstation = 10", "name = \"left\"\nstation = 10\nsensor = 8");
    let rig = read_rotor(&text, "rig").expect("a rotor");
    let beam = rig.beam().expect("a shaft");
    let [sensor, right] = [7, 25].map(|station| beam.coordinate(station).expect("simulated"));
    let law = "[[bearing]]\nname = 'left'\n[[bearing.signal]]\ndisplacement = { left = 0.5, right = 0.5 }\nvelocity = { left = 0.5, 26 = 0.5 }\nkd = 2.0\n\
               [[bearing.signal]]\nstation = 'left'\nkd = 1.0\n";
    let feedback = read_feedback_for(law, &rig).expect("valid");
    let [sum, own] = &feedback.bearings[0].signals[..] else { panic!("two signals") };
    for weights in [&sum.displacement, &sum.velocity] {
        let expected: Vec<f64> =
            (0..rig.len()).map(|place| if place == sensor || place == right { 0.5 } else { 0.0 }).collect();
        assert_eq!(*weights, expected);
    }
    assert_eq!(own.displacement[sensor], 1.0);
    assert_eq!(Some(feedback.bearings[0].station), beam.coordinate(9), "it pulls where it stands");
    for (wrong, told) in [
        ("displacement = { middle = 1.0 }\nvelocity = { left = 1.0 }", "displacement of middle"),
        ("displacement = { left = 'all' }\nvelocity = { left = 1.0 }", "left = 'all'"),
    ] {
        let law = format!("[[bearing]]\nname = 'left'\n[[bearing.signal]]\n{wrong}\nkd = 2.0\n");
        let found = read_feedback_for(&law, &rig).expect_err(wrong).to_string();
        assert!(found.contains(told), "{wrong}\n{found}");
    }
}
