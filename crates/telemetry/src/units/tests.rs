use rotor::Settings;
use units::Typed;

use super::*;
use crate::test_support::SI;

#[test]
fn val_a_rotor_in_si_units_is_told_in_micrometres_newtons_hertz_and_rpm() {
    let units = ScreenUnits::of(Some(SI), ControlMasses::default());
    assert_eq!(units.length.told(2.0, 4), "10.00 μm");
    // m_b w0^2 e_t = 2 kg (1000/s)^2 5e-6 m.
    assert_eq!(units.force.told(1.0, 4), "10.00 N");
    assert_eq!(units.velocity.told(1.0, 4), "5000 μm/s");
    // 1000 rad/s are 159.15 Hz and 9549.3 rpm.
    assert_eq!(units.frequency.told(1.0, 5), "159.15 Hz");
    assert_eq!((units.speed(1.0), units.speed_told(1.0)), ("9549".into(), "9549 rpm".into()));
    assert_eq!(units.rate.told(-0.5, 4), "-500.0 1/s");
    let large = Scales { e_t: 2e-3, ..SI };
    assert_eq!(ScreenUnits::of(Some(large), ControlMasses::default()).length.told(2.0, 4), "4.000 mm");
}

#[test]
fn val_seconds_stand_beside_tau() {
    let units = ScreenUnits::of(Some(SI), ControlMasses::default());
    // w0 = 1000 rad/s.
    assert_eq!(
        (units.time_told(30.0, 3), units.moment_told(-2.5, 4)),
        ("30.0 tau = 30.0 ms".into(), "tau -2.500 = -2.500 ms".into())
    );
    assert_eq!(ScreenUnits::DIMENSIONLESS.time_told(30.0, 3), "30.0 tau");
}

#[test]
fn changes_are_told_in_what_they_were_typed_in() {
    let units = ScreenUnits::of(Some(SI), ControlMasses::default());
    let rotor = rotor::builtin::rotor("three-mass").unwrap();
    let mut before = Settings::new(&rotor, 0.0, rotor::builtin::feedback(&rotor, "composite").unwrap());
    let speed: Key = "speed".parse().unwrap();
    let [typed] = units.settings_of_typed(None, &before, &[(speed, 30_000.0.into())]).unwrap()[..] else {
        panic!("one")
    };
    let after = Settings { speed: typed.1, ..before.clone() };
    assert_eq!(units.value(speed, typed.1), "30000 rpm");
    assert_eq!(units.difference(&before, &after), "speed 0 rpm -> 30000 rpm");
    assert_eq!(ScreenUnits::DIMENSIONLESS.value(speed, 2.5), "2.5");
    before.speed = 1.0;
    let kd: Key = "kd".parse().unwrap();
    let nudged = crate::edits::Edit::Nudge(kd, 0.01).applied(&before).unwrap();
    // m_b w0^2 = 2 kg (1000/s)^2.
    assert_eq!(units.difference(&before, &nudged), "kd.1 -1175800 N/m -> -1155800 N/m");
}

#[test]
fn gains_before_a_filter_are_nudged_by_a_part_of_what_they_are() {
    let rotor = rotor::builtin::rotor("rig").unwrap();
    let settings = Settings::new(&rotor, 2.5, rotor::builtin::feedback(&rotor, "own").unwrap());
    let units = ScreenUnits::of_machine(&rotor, &settings.feedback);
    for name in ["left.kd", "right.kd"] {
        let key = settings.key(name).unwrap();
        let value = settings.get(key).unwrap().abs() * units.setting(key).factor;
        let part = units.step_among(key, &settings) / value;
        assert!((0.004..0.02).contains(&part), "{name}: {part} of {value}");
    }
    // A gain that is nothing yet, by that of its signal; small gains and what is no gain as ever.
    let cd = settings.key("left.cd").unwrap();
    assert!(units.step_among(cd, &settings) > 100.0 * units.step(cd));
    let three_mass = rotor::builtin::rotor("three-mass").unwrap();
    let own = Settings::new(&three_mass, 2.5, rotor::builtin::feedback(&three_mass, "composite").unwrap());
    for key in own.keys() {
        assert_eq!(ScreenUnits::DIMENSIONLESS.step_among(key, &own), ScreenUnits::DIMENSIONLESS.step(key), "{key}");
    }
}

#[test]
fn undo_messages_have_no_sixteen_digits_but_tell_small_changes() {
    let rotor = rotor::builtin::rotor("three-mass").unwrap();
    let before = Settings::new(&rotor, 0.0, rotor::builtin::feedback(&rotor, "composite").unwrap());
    let kd: Key = "kd".parse().unwrap();
    let told = |was: f64, is: f64| {
        let [mut was_in, mut is_in] = [before.clone(), before.clone()];
        was_in.set(kd, was).unwrap();
        is_in.set(kd, is).unwrap();
        ScreenUnits::DIMENSIONLESS.difference(&was_in, &is_in)
    };
    assert_eq!(told(-0.391_234_567_891_234_5, 0.25), "kd.1 -0.3912346 -> 0.25");
    assert_eq!(told(0.3, 0.1 + 0.2), "kd.1 0.3 -> 0.30000000000000004");
    assert_eq!(told(0.123_456_789, 0.123_456_788), "kd.1 0.123456789 -> 0.123456788");
}

#[test]
fn settings_are_typed_as_on_the_command_line_and_nudged_by_round_numbers() {
    let [speed, deadband, kd] = ["speed", "deadband", "kd"].map(|name| name.parse::<Key>().unwrap());
    let units = ScreenUnits::of(Some(SI), ControlMasses::default());
    let rotor = rotor::builtin::rotor("three-mass").unwrap();
    let settings = Settings::new(&rotor, 0.0, rotor::builtin::feedback(&rotor, "composite").unwrap());
    let typed = |typed: [f64; 3]| [speed, deadband, kd].into_iter().zip(typed.map(Typed::from)).collect::<Vec<_>>();
    let said = ["159.154943091895 Hz", "1e-5m", "0.2 N/um"];
    let said = [speed, deadband, kd].into_iter().zip(said).map(|(key, said)| (key, key.parameter.read(said).unwrap()));
    // 1000 rad/s; 10 of 5 um; 2 kg (1000/s)^2 = 2e6 N/m.
    for typed in [typed([9_549.296_585_513_72, 10.0, 2e5]), said.collect()] {
        let typed = units.settings_of_typed(Some(&rotor), &settings, &typed).unwrap();
        let near = |(at, value): (usize, f64)| (typed[at].1 / value - 1.0).abs() < 1e-12;
        assert!([1.0, 2.0, 0.1].into_iter().enumerate().all(near), "{typed:?}");
    }
    assert_eq!([speed, deadband, kd].map(|key| units.step(key)), [500.0, 0.5, 20_000.0]);
    assert_eq!([deadband, kd].map(|key| units.setting(key).name), ["μm", "N/m"]);
    let refused =
        ScreenUnits::DIMENSIONLESS.settings_of_typed(None, &settings, &[(kd, kd.parameter.read("2N/m").unwrap())]);
    assert!(refused.unwrap_err().to_string().starts_with("kd = '2 N/m': expected a number without a unit"));
    assert_eq!([speed, deadband].map(|key| ScreenUnits::DIMENSIONLESS.step(key)), [0.05, 0.1]);
}

/// 30 kg and 10 kg with a control bearing each, the second first: K_t e_t are 72 N, so that 1 is 18 N and 54 N.
#[test]
fn val_a_force_is_typed_and_told_by_the_mass_of_its_own_control_bearing() {
    let mass = |mass| rotor::PhysicalMass { mass, bearing_stiffness: 1.8e6, unbalance: 1e-5, ..Default::default() };
    let rotor = Rotor::from_si("rig", vec![mass(30.0), mass(10.0)], vec![1e6], None).unwrap();
    let bearings = [1, 0].map(|station| rotor::ControlBearing::new(station, vec![])).to_vec();
    let before = Settings::new(&rotor, 0.0, Feedback { bearings });
    let units = ScreenUnits::of_machine(&rotor, &before.feedback);
    let near = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found} and {expected}");
    let key = |typed: &str| before.key(typed).unwrap();
    let typed = [(key("limit"), Typed::from(54.0)), (key("slew.2"), 16_200.0.into())];
    let typed = units.settings_of_typed(Some(&rotor), &before, &typed).unwrap();
    let told: Vec<String> = typed.iter().map(|(key, _)| key.to_string()).collect();
    assert_eq!(told, ["limit.1", "limit.2", "slew.2"], "what is typed for all is that for each");
    [3.0, 1.0, 1.0].iter().zip(&typed).for_each(|(expected, (_, found))| near(*found, *expected));
    let mut after = before.clone();
    typed.iter().for_each(|(key, value)| after.set(*key, *value).unwrap());
    let words = "1.limit off -> 54 N, 2.limit off -> 54 N, 2.slew off -> 16200 N/s";
    assert_eq!(units.difference(&before, &after), words);
    near(units.force_of(0).factor, 18.0);
    near(units.force_of(1).factor, 54.0);
    near(units.factor_of(1), 3.0);
    // A limit of 1 is as large a force on the second as one of 3 on the first, and nudged by a round number of its own.
    assert_eq!([key("limit.1"), key("limit.2")].map(|key| units.step(key)), [20.0, 60.0]);
    // A rotor without scales is told as it is: in accelerations.
    let plain = ScreenUnits::of_machine(&rotor.dimensionless(), &before.feedback);
    assert_eq!((plain.factor_of(1), plain.setting(key("limit.2")).factor), (1.0, 1.0));
}

#[test]
fn any_other_rotor_is_told_in_its_own_scales() {
    let units = ScreenUnits::of(None, ControlMasses::default());
    assert_eq!(units, ScreenUnits::DIMENSIONLESS);
    assert_eq!((units.length.told(2.0, 4), units.speed_told(2.5)), ("2.000 e_t".into(), "R 2.5".into()));
}
