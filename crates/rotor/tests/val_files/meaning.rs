//! What lines of a file mean, and what is said of lines that mean nothing.

use rotor::file::{read_feedback, read_feedback_for, read_rotor, write_rotor};
use rotor::{Feedback, Gain, GainKind, Mass, Rotor, Signal, builtin};

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

/// Sum and difference of the two ends, as laws that hold translation and tilt apart have them.
#[test]
fn weights_may_be_called_by_their_places_and_a_bearing_senses_where_its_sensor_is() {
    let text = include_str!("../../src/rig.toml")
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
