//! Laws of the alarms, whatever comes in.

use proptest::prelude::*;

use super::*;

/// Alarms on damping alone: a warning at 0.1, an alarm at 0, a margin of 0.02.
fn alarms() -> Alarms {
    let none = Limits { saturation: None, lateness: None, losses: None, ..Limits::default() };
    Alarms::new(Limits { damping: Some(Limit::below(0.1, 0.0, 0.02)), ..none })
}

/// A reading of damping, a second after the one before.
pub(crate) fn damping(second: u64, value: f64) -> Reading {
    Reading { wall_ns: second * 1_000_000_000, damping: Some(value), ..Reading::default() }
}

fn read(alarms: &mut Alarms, values: impl IntoIterator<Item = f64>) {
    (1..).zip(values).for_each(|(second, value)| {
        alarms.read(&damping(second, value));
    });
}

fn level(value: f64) -> Level {
    if value <= 0.0 {
        Level::Alarm
    } else if value <= 0.1 {
        Level::Warning
    } else {
        Level::Fine
    }
}

proptest! {
    #[test]
    fn what_was_past_its_limit_is_shown_until_it_is_acknowledged(values in prop::collection::vec(-0.3..0.5, 1..60)) {
        let mut alarms = alarms();
        let mut worst = Level::Fine;
        for (second, value) in (1..).zip(values) {
            alarms.read(&damping(second, value));
            worst = worst.max(level(value));
            prop_assert_eq!(alarms.shown(), worst);
            prop_assert_eq!(alarms.unseen() > 0, worst > Level::Fine);
        }
    }

    #[test]
    fn nothing_is_told_without_a_crossing(values in prop::collection::vec(0.1001..1.0, 0..60)) {
        let mut alarms = alarms();
        read(&mut alarms, values);
        prop_assert_eq!((alarms.shown(), alarms.entries().count(), alarms.rings()), (Level::Fine, 0, false));
    }

    /// Trembling within the margin about a limit is one alarm; so is trembling about both, a warning that grows.
    #[test]
    fn a_value_that_trembles_is_one_alarm(limit in prop::sample::select(vec![0.0, 0.1]), noise in prop::collection::vec(-0.019..0.019, 1..80)) {
        let mut alarms = alarms();
        alarms.read(&damping(0, limit));
        let mut changes = 0;
        for (second, noise) in (1..).zip(noise) {
            changes += usize::from(alarms.read(&damping(second, limit + noise)));
        }
        prop_assert_eq!((alarms.entries().count(), changes), (1, 0));
    }

    #[test]
    fn acknowledged_and_well_is_quiet_and_acknowledged_and_ill_still_shows(values in prop::collection::vec(-0.3..0.5, 1..40), last in -0.3..0.5) {
        let mut alarms = alarms();
        read(&mut alarms, values);
        let there_were = alarms.unseen();
        prop_assert_eq!(alarms.acknowledge(), there_were);
        prop_assert_eq!((alarms.unseen(), alarms.acknowledge()), (0, 0));
        let before = alarms.shown();
        alarms.read(&damping(99, last));
        if last > 0.12 {
            prop_assert_eq!(alarms.shown(), Level::Fine);
        } else {
            prop_assert!(alarms.shown() >= level(last));
            // What has been seen and not grown worse need not be seen again.
            prop_assert_eq!(alarms.unseen() > 0, level(last) > before);
        }
    }

    /// Every entry tells a story in order, the list is bounded, and its worst value is one that came in.
    #[test]
    fn entries_are_in_order(values in prop::collection::vec(prop::num::f64::ANY, 0..600)) {
        let mut alarms = alarms();
        read(&mut alarms, values.iter().copied());
        let entries: Vec<&Entry> = alarms.entries().collect();
        prop_assert!(entries.len() <= KEPT);
        prop_assert!(entries.windows(2).all(|pair| pair[0].rose_ns > pair[1].rose_ns));
        for entry in entries {
            prop_assert!(entry.fell_ns.is_none_or(|fell| fell > entry.rose_ns));
            prop_assert!(values.contains(&entry.worst) && level(entry.worst) == entry.level);
        }
    }
}

#[test]
fn a_warning_that_grows_is_one_story_that_must_be_seen_anew() {
    let mut alarms = alarms();
    read(&mut alarms, [0.05]);
    alarms.acknowledge();
    alarms.read(&damping(2, -0.01));
    assert_eq!((alarms.entries().count(), alarms.unseen(), alarms.shown()), (1, 1, Level::Alarm));
    let entry = alarms.entries().next().unwrap();
    assert_eq!((entry.worst, entry.limit, entry.rose_ns), (-0.01, 0.0, 1_000_000_000));
}

#[test]
fn a_trip_is_an_alarm_with_its_cause_until_it_is_acknowledged() {
    let mut alarms = alarms();
    let trip = |cause: &str| Reading { wall_ns: 5, trip: Some(cause.into()), ..Reading::default() };
    alarms.read(&trip(""));
    assert_eq!(alarms.shown(), Level::Fine);
    alarms.read(&trip("orbit of mass 2 reached 1000.5 e_t"));
    alarms.read(&trip(""));
    assert_eq!(alarms.shown(), Level::Alarm);
    assert_eq!(alarms.entries().next().unwrap().cause, "orbit of mass 2 reached 1000.5 e_t");
    alarms.acknowledge();
    assert_eq!(alarms.shown(), Level::Fine);
}

#[test]
fn what_is_unknown_changes_nothing_and_what_has_no_limit_never_alarms() {
    let mut alarms = alarms();
    read(&mut alarms, [0.05]);
    alarms.read(&Reading { wall_ns: 9, orbit: Some(1e9), force: Some(f64::NAN), ..Reading::default() });
    assert_eq!((alarms.shown(), alarms.entries().count()), (Level::Warning, 1));
    let orbit = alarms.standings().find(|(watch, ..)| *watch == Watch::Orbit).unwrap();
    assert_eq!((orbit.1.value, orbit.1.at, orbit.2), (Some(1e9), Level::Fine, None));
}

#[test]
fn the_bell_rings_once_for_each_rise_and_only_where_it_is_wanted() {
    let mut silent = alarms();
    read(&mut silent, [-1.0]);
    assert!(!silent.rings());
    let mut loud = alarms();
    loud.limits.bell = true;
    read(&mut loud, [-1.0, -1.0]);
    assert_eq!((loud.rings(), loud.rings()), (true, false));
}
