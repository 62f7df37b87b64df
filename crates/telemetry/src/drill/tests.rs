use rotor::{Rotor, Settings, builtin};

use super::*;
use crate::units::ScreenUnits;

fn three_mass() -> (Rotor, Settings) {
    let rotor = builtin::rotor("three-mass").unwrap();
    let feedback = builtin::feedback(&rotor, "individual").unwrap();
    let settings = Settings::new(&rotor, 2.5, feedback);
    (rotor, settings)
}

/// A rotor that is not one in SI units.
const IN_ITS_OWN: (&ScreenUnits, CountedAlone) = (&ScreenUnits::DIMENSIONLESS, ScreenUnits::setting);

fn order(words: &str) -> FaultOrder {
    FaultOrder::read(words).unwrap()
}

fn changed(words: &str) -> Vec<(String, f64)> {
    let (rotor, settings) = three_mass();
    let changes = order(words).changes(&rotor, &settings, IN_ITS_OWN, None).unwrap();
    changes.into_iter().map(|(key, value)| (key.to_string(), value)).collect()
}

fn refused(words: &str) -> String {
    let (rotor, settings) = three_mass();
    let order = FaultOrder::read(words);
    order.and_then(|order| order.changes(&rotor, &settings, IN_ITS_OWN, None)).unwrap_err().to_string()
}

#[test]
fn every_fault_changes_the_settings_that_it_is_made_of() {
    let of = |pairs: &[(&str, f64)]| pairs.iter().map(|(key, value)| ((*key).to_owned(), *value)).collect::<Vec<_>>();
    assert_eq!(changed("sensor-gain"), of(&[("sensor_gain.1", 0.5), ("sensor_at.1", 0.0)]));
    assert_eq!(changed("sensor-lost at=2"), of(&[("sensor_gain.1", 0.0), ("sensor_at.1", 2.0)]));
    assert_eq!(changed("amplifier-gain size=0.25"), of(&[("amplifier_y.1", 0.25), ("amplifier_z.1", 0.25)]));
    assert_eq!(changed("amplifier-slew at=1 size=3"), of(&[("slew.1", 3.0)]));
    assert_eq!(changed("axis-lost"), of(&[("amplifier_y.1", 0.0)]));
    assert_eq!(changed("axis-lost size=z"), of(&[("amplifier_z.1", 0.0)]));
    assert_eq!(changed("stiffness-lost"), of(&[("deadband.1", 1e6)]));
    assert_eq!(changed("delay-jump"), of(&[("delay", 0.1)]));
    assert_eq!(changed("unbalance-added at=3 size=-2"), of(&[("unbalance_added.3", -2.0)]));
}

#[test]
fn what_cannot_be_says_what_can() {
    assert!(refused("sensor-gian").ends_with("did you mean 'sensor-gain'?"), "{}", refused("sensor-gian"));
    assert_eq!(refused("sensor-lost at=3"), "sensor-lost at '3': expected a place with a sensor: 1, 2");
    assert_eq!(refused("sensor-lost size=1"), "sensor-lost of size '1': expected none: it has no size");
    assert_eq!(refused("axis-lost size=x"), "axis-lost of size 'x': expected y or z, else y");
    assert_eq!(refused("axis-lost at=2"), "axis-lost at '2': expected a control bearing: 1");
    assert_eq!(
        refused("amplifier-gain size=1"),
        "amplifier-gain would change nothing: the machine is like that already"
    );
    assert_eq!(refused("delay-jump soon"), "'soon': expected NAME, and perhaps at=PLACE and size=SIZE");
    assert!(refused("delay-jump size=0").starts_with("delay-jump of size '0': expected by how much"));
}

#[test]
fn one_fault_goes_for_the_next_and_the_log_knows_what_was_there_before() {
    let (rotor, start) = three_mass();
    let (mut log, mut settings, mut revision) = (DrillLog::default(), start.clone(), 1);
    log.note((7, 1), "", &start);
    let mut inject = |words: &str, log: &mut DrillLog, settings: &mut Settings| {
        let order = order(words);
        let changes = order.changes(&rotor, settings, IN_ITS_OWN, log.active()).unwrap();
        changes.iter().try_for_each(|(key, value)| settings.set(*key, *value)).unwrap();
        revision += 1;
        log.note((7, revision), &order.cause(), settings);
    };
    inject("delay-jump size=0.2", &mut log, &mut settings);
    inject("delay-jump size=0.3", &mut log, &mut settings);
    assert_eq!(settings.feedback.delay(), 0.3, "of the machine as it was, not of the fault before");
    inject("sensor-lost", &mut log, &mut settings);
    assert_eq!(settings.feedback.delay(), 0.0);
    assert_eq!(log.active().map(|active| &*active.told), Some("sensor-lost"));
    // Whoever runs it has helped meanwhile: that stays.
    settings.assign("kd.2", "-1").unwrap();
    log.note((7, 5), "typed", &settings);
    let back = log.active().unwrap().back.clone();
    back.iter().try_for_each(|(key, value)| settings.set(*key, *value)).unwrap();
    log.note((7, 6), OVER, &settings);
    assert_eq!(log.active(), None);
    let mut expected = start;
    expected.assign("kd.2", "-1").unwrap();
    assert_eq!(settings, expected);
}

#[test]
fn undoing_a_fault_ends_it_too() {
    let (rotor, start) = three_mass();
    let mut log = DrillLog::default();
    log.note((7, 1), "", &start);
    let order = order("stiffness-lost");
    let mut settings = start.clone();
    for (key, value) in order.changes(&rotor, &start, IN_ITS_OWN, None).unwrap() {
        settings.set(key, value).unwrap();
    }
    log.note((7, 2), &order.cause(), &settings);
    assert!(log.active().is_some());
    log.note((7, 3), "undo", &start);
    assert_eq!(log.active(), None);
    log.note((8, 1), "", &settings);
    assert_eq!(log.active(), None, "another run knows nothing of it");
}

/// The changes of one fault after the other, with undo and redo between them, as a bench makes them.
#[test]
fn regress_undo_and_redo_bring_a_fault_back_that_can_be_put_back() {
    let (rotor, start) = three_mass();
    let (mut log, mut revision) = (DrillLog::default(), 1);
    log.note((7, 1), "", &start);
    let mut to = |log: &mut DrillLog, why: &str, settings: &Settings| {
        revision += 1;
        log.note((7, revision), why, settings);
    };
    let inject = |words: &str, log: &DrillLog, settings: &Settings| {
        let mut then = settings.clone();
        let changes = order(words).changes(&rotor, settings, IN_ITS_OWN, log.active()).unwrap();
        changes.iter().for_each(|(key, value)| then.set(*key, *value).unwrap());
        then
    };
    let late = inject("delay-jump", &log, &start);
    to(&mut log, &order("delay-jump").cause(), &late);
    let lost = inject("sensor-lost", &log, &late);
    to(&mut log, &order("sensor-lost").cause(), &lost);
    to(&mut log, "undo", &late);
    assert_eq!(log.active().map(|active| &*active.told), Some("delay-jump"));
    to(&mut log, "redo", &lost);
    assert_eq!(log.active().map(|active| &*active.told), Some("sensor-lost"));
    to(&mut log, "undo", &late);
    to(&mut log, "undo", &start);
    assert_eq!(log.active(), None);
    to(&mut log, "redo", &late);
    let mut sound = late.clone();
    log.active().unwrap().back.iter().for_each(|(key, value)| sound.set(*key, *value).unwrap());
    assert_eq!(sound, start);
}

/// A length alone is in what the one who typed it counts in; with its unit it is the same everywhere.
#[test]
fn sizes_are_in_what_they_say_or_in_what_is_counted_in_there() {
    let rotor = builtin::rotor("rig").unwrap();
    let settings = Settings::new(&rotor, 1.0, builtin::feedback(&rotor, "own").unwrap());
    let units = ScreenUnits::of_machine(&rotor, &settings.feedback);
    let added = |words: &str, alone: CountedAlone| {
        let order = order(words);
        order.changes(&rotor, &settings, (&units, alone), None).unwrap().first().unwrap().1
    };
    let by_unit = added("unbalance-added size=5um", ScreenUnits::setting);
    assert_eq!(by_unit, added("unbalance-added size=5um", ScreenUnits::setting_in_files));
    assert!((added("unbalance-added size=5e-6", ScreenUnits::setting_in_files) / by_unit - 1.0).abs() < 1e-12);
    let shown = units.length;
    assert!(
        (added(&format!("unbalance-added size={}", by_unit * shown.factor), ScreenUnits::setting) / by_unit - 1.0)
            .abs()
            < 1e-12
    );
    assert!(refused("unbalance-added size=5um").contains("not one in SI units"));
    assert!(refused("sensor-gain size=1 at=2").ends_with("the machine is like that already"));
}

#[test]
fn built_in_drills_are_in_order() {
    for (name, _) in BUILTIN {
        let drill = builtin(name).unwrap().unwrap();
        assert_eq!(drill.name, name);
        assert!(!drill.about.is_empty() && drill.steps.len() > 1 && drill.end > drill.steps[0].at);
        let (rotor, settings) = three_mass();
        for order in drill.steps.iter().filter_map(|step| step.fault.as_ref()) {
            order.changes(&rotor, &settings, IN_ITS_OWN, None).unwrap();
        }
    }
}

#[test]
fn a_wrong_file_is_told_line_by_line() {
    let text = "[[step]]\nat = 3\nfault = \"sensor-lost\"\nsize = 2\n\n[[step]]\nat = 1\nfault = \"spark\"\n\n[[step]]\nat = 4\n";
    let told = read_drill(text).unwrap_err().in_file("a.toml");
    assert!(told.contains("a.toml:4:8: size = 2: expected none: it has no size"), "{told}");
    assert!(told.contains("a.toml:7:6: at = 1: expected more than 3, when the step before it is"), "{told}");
    assert!(told.contains("no fault 'spark': expected one of sensor-gain, sensor-lost"), "{told}");
    assert!(told.contains("[[step]] 3 without fault: expected fault = NAME, or sound = true"), "{told}");
    assert!(read_drill("name = \"x\"\n").is_err(), "no step");
}
