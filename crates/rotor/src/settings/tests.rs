use super::*;
use crate::GainKind;
use crate::builtin;

fn three_mass() -> (Rotor, Settings) {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, "individual").expect("built in");
    let settings = Settings::new(&rotor, 2.5, feedback);
    (rotor, settings)
}

#[test]
fn every_key_reads_back_what_was_set() {
    let (rotor, mut settings) = three_mass();
    let keys = settings.keys();
    assert_eq!(keys.len(), 4 + 16 + 3 + 3 + 4 * 2);
    for (i, &key) in keys.iter().enumerate() {
        // The sensor at a station is a whole number.
        let value = if key.parameter.name == "sensor_at" { 2.0 } else { 0.25 + i as f64 };
        assert_eq!(key.to_string().parse::<Key>().expect("its own name"), key);
        settings.set(key, value).expect("in range");
        assert_eq!(settings.get(key).expect("exists"), value, "{key}");
    }
    settings.check(&rotor).expect("all in range");
}

#[test]
fn a_key_without_index_means_all_masses_or_the_first_signal() {
    let (_, mut settings) = three_mass();
    settings.assign("deadband", "2").expect("fine");
    settings.assign("deadband.2", "0.5").expect("fine");
    assert_eq!(settings.deadband, [2.0, 0.5, 2.0]);
    settings.assign("kd", "0.75").expect("fine");
    assert_eq!(settings.feedback.first().signals[0].gains[0], Gain::Constant(0.75));
}

#[test]
fn refusals_change_nothing_and_say_why() {
    let (_, mut settings) = three_mass();
    let before = settings.clone();
    let none = |key: &str| {
        format!(
            "no setting '{key}': {}there are {}, with .N for mass, signal or control bearing N",
            crate::settings_error::meant(key),
            crate::settings_error::known_keys()
        )
    };
    assert!(none("sped").contains("did you mean 'speed'?"));
    assert!(none("").contains("speed, ramp, deadband, kd, cd, kc, cc, trip"), "{}", none(""));
    for (key, value, why) in [
        ("sped", "1", &*none("sped")),
        ("speed.1", "1", &*none("speed.1")),
        ("kd.0", "1", &*none("kd.0")),
        ("kd.3", "1", "no kd.3: there are 2 signals"),
        ("deadband.4", "1", "no deadband.4: there are 3 masses"),
        ("speed", "fast", "speed = 'fast': expected a number"),
        ("speed", "-1", "speed = -1: expected a number from 0 to 1000"),
        ("kd", "nan", "kd = NaN: expected a number from -1000000 to 1000000"),
        ("trip", "inf", "trip = inf: expected a number from 0.001 to 1000000000"),
        ("trip", "off", "trip = 'off': expected a number"),
        ("delay", "-0.1", "delay = -0.1: expected a number from 0.000000001 to 1000000, or off"),
        ("limit", "0", "limit = 0: expected a number from 0.000000001 to 1000000000000, or off"),
        ("sample", "soon", "sample = 'soon': expected a number, or off"),
    ] {
        assert_eq!(settings.assign(key, value).expect_err(key).to_string(), why);
    }
    assert_eq!(settings, before);
}

#[test]
fn whole_settings_are_checked_against_their_rotor() {
    let (rotor, settings) = three_mass();
    let refused = |change: &dyn Fn(&mut Settings)| {
        let mut changed = settings.clone();
        change(&mut changed);
        changed.check(&rotor).expect_err("refused").to_string()
    };
    assert_eq!(refused(&|s| s.deadband = vec![1.0]), "1 deadbands for 3 masses");
    assert_eq!(refused(&|s| s.speed = f64::NAN), "speed = NaN: expected a number from 0 to 1000");
    assert_eq!(refused(&|s| s.deadband[1] = -1.0), "deadband.2 = -1: expected a number from 0 to 1000000");
    assert_eq!(
        refused(&|s| s.feedback.first_mut().signals[1].gains[2] = Gain::Table(vec![(0.0, 0.0), (1.0, 2e6)])),
        "kc.2 = 2000000: expected a number from -1000000 to 1000000"
    );
}

#[test]
fn nudges_stay_on_round_numbers_and_in_range() {
    let (_, mut settings) = three_mass();
    let speed: Key = "speed".parse().expect("a key");
    settings.set(speed, 0.0).expect("in range");
    (0..10).for_each(|_| settings.nudge(speed, 0.1).expect("exists"));
    assert_eq!(settings.speed, 1.0);
    settings.nudge(speed, -7.0).expect("exists");
    assert_eq!(settings.speed, 0.0);
}

#[test]
fn what_is_off_can_be_turned_on_and_off_again() {
    let (rotor, mut settings) = three_mass();
    for (key, on) in [("delay", "0.02"), ("limit", "20"), ("ramp", "0.01"), ("coast_down", "0.02"), ("sample", "0.05")]
    {
        settings.assign(key, on).expect("on");
        settings.check(&rotor).expect("allowed");
        assert_eq!(settings.get(key.parse().expect("a key")).expect("there is"), on.parse::<f64>().expect("a number"));
        settings.assign(key, "off").expect("off");
    }
    assert!(settings.feedback.is_ideal() && settings.ramp.is_infinite() && settings.coast_down == 0.0);
    let delay: Key = "delay".parse().expect("a key");
    settings.nudge(delay, 0.01).expect("exists");
    assert_eq!(settings.feedback.delay(), 0.01);
    settings.nudge(delay, -0.01).expect("exists");
    assert_eq!(settings.feedback.delay(), 0.0);
}

#[test]
fn nudging_a_schedule_keeps_its_slope() {
    let rotor = builtin::rotor("jeffcott").expect("built in");
    let mut settings = Settings::new(&rotor, 2.0, builtin::feedback(&rotor, "cancel").expect("built in"));
    let kc: Key = "kc".parse().expect("a key");
    settings.nudge(kc, 0.25).expect("exists");
    assert_eq!(settings.feedback.first().signals[0].gain(GainKind::Kc), &Gain::Linear { at_zero: 0.25, slope: -0.5 });
}
