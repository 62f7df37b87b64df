//! Laws of the alarms, whatever comes in.

use proptest::prelude::*;
use rotor::{ControlBearing, Feedback, Settings, builtin};
use wire::{BenchStatus, Channel, SettingsDocument, State, StepLayout};

use super::*;

/// Alarms on damping alone: a warning at 0.1, an alarm at 0, a margin of 0.02.
fn alarms() -> Alarms {
    Alarms::new(Limits::none().having(Watch::Damping, Limit::below(0.1, 0.0, 0.02)))
}

/// A reading of damping, a second after the one before.
fn damping(second: u64, value: f64) -> Reading {
    second_of(second).with(Watch::Damping, value)
}

/// A reading of nothing.
fn second_of(second: u64) -> Reading {
    Reading::new(Moment { seq: 1000 * second, tau: 10.0 * second as f64, wall_ns: second * 1_000_000_000 })
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
        prop_assert_eq!((alarms.shown(), alarms.entries().count(), alarms.has_risen()), (Level::Fine, 0, false));
    }

    /// Trembling within the margin about a limit is one alarm; so is trembling about both, a warning that grows.
    #[test]
    fn a_value_that_trembles_is_one_alarm(limit in prop::sample::select(vec![0.0, 0.1]), noise in prop::collection::vec(-0.019..0.019, 1..80)) {
        let mut alarms = alarms();
        alarms.read(&damping(0, limit));
        let mut changes = 0;
        for (second, noise) in (1..).zip(noise) {
            changes += alarms.read(&damping(second, limit + noise)).len();
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
        prop_assert!(entries.windows(2).all(|pair| pair[0].rose.seq > pair[1].rose.seq));
        for entry in entries {
            prop_assert!(entry.fell.is_none_or(|fell| fell.seq > entry.rose.seq));
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
    assert_eq!((entry.worst, entry.limit, entry.rose.wall_ns), (-0.01, 0.0, 1_000_000_000));
}

#[test]
fn a_trip_is_an_alarm_with_its_cause_until_it_is_acknowledged() {
    let mut alarms = alarms();
    let trip = |cause: &str| second_of(5).tripped(cause);
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
    alarms.read(&second_of(9).with(Watch::Orbit, 1e9).with(Watch::Force, f64::NAN));
    assert_eq!((alarms.shown(), alarms.entries().count()), (Level::Warning, 1));
    let orbit = alarms.standings().find(|(watch, ..)| *watch == Watch::Orbit).unwrap();
    assert_eq!((orbit.1.value, orbit.1.at, orbit.2), (Some(1e9), Level::Fine, None));
}

/// Unbalance beside a limit cycle: every few seconds the force is past its limit, and within again.
#[test]
fn regress_a_motion_that_beats_across_its_limit_is_one_alarm() {
    for watch in [Watch::Force, Watch::Orbit] {
        let mut alarms = Alarms::new(Limits::none().having(watch, Limit::above(2.0, 4.0)));
        let beat = |second: u64| 3.0 + 2.9 * (second as f64 * 1.3).sin();
        let turns: Vec<LevelChange> =
            (0..100).flat_map(|second| alarms.read(&second_of(second).with(watch, beat(second)))).collect();
        assert_eq!((alarms.entries().count(), alarms.entries().next().unwrap().fell), (1, None));
        assert!(turns.len() <= 2 && turns.iter().all(LevelChange::rises), "{turns:?}");
        // When it has calmed down it is within, and that is told: of an alarm it may be by way of a warning.
        let calm: Vec<LevelChange> =
            (100..115).flat_map(|second| alarms.read(&second_of(second).with(watch, 0.5))).collect();
        assert!(calm.len() <= 2 && calm.last().is_some_and(|last| last.level == Level::Fine), "{calm:?}");
    }
}

/// A clock that is set back while something is better keeps nothing waiting longer than it would.
#[test]
fn a_clock_that_is_set_back_holds_no_level_for_hours() {
    let mut alarms = Alarms::new(Limits::none().having(Watch::Force, Limit::above(2.0, 4.0)));
    for (second, value) in [(10_000, 3.0), (10_001, 1.0), (5, 1.0), (9, 1.0)] {
        assert!(alarms.read(&second_of(second).with(Watch::Force, value)).len() == usize::from(second == 10_000));
    }
    assert_eq!(alarms.read(&second_of(10).with(Watch::Force, 1.0))[0].level, Level::Fine);
}

#[test]
fn a_rise_is_told_once() {
    let mut alarms = alarms();
    read(&mut alarms, [-1.0, -1.0]);
    assert_eq!((alarms.has_risen(), alarms.has_risen()), (true, false));
}

#[test]
fn every_crossing_is_a_turn_with_its_value_its_limit_and_its_step() {
    let mut alarms = alarms();
    let mut turns = Vec::new();
    for (second, value) in (1..).zip([0.5, 0.05, -0.1, -0.3, 0.05, 0.11, 0.2]) {
        turns.extend(alarms.read(&damping(second, value)));
    }
    use Level::{Alarm, Fine, Warning};
    let told: Vec<_> = turns.iter().map(|t| (t.at.seq, t.before, t.level, t.value, t.limit, t.worst)).collect();
    let expected = [
        (2000, Fine, Warning, 0.05, 0.1, 0.05),
        (3000, Warning, Alarm, -0.1, 0.0, -0.1),
        (5000, Alarm, Warning, 0.05, 0.0, -0.3),
        (7000, Warning, Fine, 0.2, 0.1, -0.3),
    ];
    assert_eq!(told, expected);
}

proptest! {
    /// Whoever has the turns alone sees what the judge saw, but for what nobody asked them to acknowledge.
    #[test]
    fn turns_tell_it_all(values in prop::collection::vec(-0.3..0.5, 1..60)) {
        let mut alarms = alarms();
        let mut turns = Vec::new();
        for (second, value) in (1..).zip(values) {
            turns.extend(alarms.read(&damping(second, value)));
        }
        alarms.acknowledge();
        let recalled = Alarms::recalled(alarms.limits().clone(), &turns);
        let at = |alarms: &Alarms| alarms.standings().map(|(_, standing, _)| standing.at).collect::<Vec<_>>();
        prop_assert_eq!(at(&recalled), at(&alarms));
        // Only a turn tells of a worst value: what has grown worse since the last one is told when it ends.
        let stories = |alarms: &Alarms| alarms.entries().map(|e| (e.level, e.limit, e.rose, e.fell)).collect::<Vec<_>>();
        prop_assert_eq!(stories(&recalled), stories(&alarms));
        let worst = |alarms: &Alarms| alarms.entries().filter(|e| e.fell.is_some()).map(|e| e.worst).collect::<Vec<_>>();
        prop_assert_eq!(worst(&recalled), worst(&alarms));
    }
}

/// Half the mass of the rotor on the second bearing, a quarter on the first: a control of 1 there is one of 2 here.
#[test]
fn every_control_bearing_is_held_against_its_own_limit_as_if_the_first_had_to() {
    let rotor = builtin::rotor("three-mass").unwrap();
    let bearing = |station, limit| {
        let mut bearing = ControlBearing::new(station, vec![]);
        bearing.parts.limit = limit;
        bearing
    };
    let bearings = vec![bearing(0, 100.0), bearing(1, 5.0)];
    let settings = Settings::new(&rotor, 0.0, Feedback { bearings });
    let mut status = BenchStatus::from(wire::message::BenchStatusMessage { run_id: 7, ..Default::default() });
    status.set_rotor(&rotor);
    status.settings = SettingsDocument::of(&settings);
    let mut alarms = Alarms::new(Limits::default());
    let mut sampler = crate::Sampler::default();
    alarms.learn(&status);
    sampler.learn(&status, 0);
    let mut turns = |seq: u64, sizes: [f64; 2]| {
        let mut state = State::new(StepLayout::new(3).with_bearings(2)).with_word(Channel::RunId, 7);
        state = state.with_word(Channel::Seq, seq).with_word(Channel::WallNs, 3_000_000_000 * seq);
        state = state.with(Channel::ForceY, 0, sizes[0]);
        sampler.hear(&state.with(Channel::FurtherForceZ, 0, sizes[1]));
        let turns = alarms.read(&sampler.take());
        turns.into_iter().map(|turn| (turn.level, turn.value, turn.limit)).collect::<Vec<_>>()
    };
    assert_eq!(turns(1, [50.0, 3.9]), [], "half of what the first can, less than 0.8 of the second");
    assert_eq!(turns(2, [50.0, 4.9]), [(Level::Alarm, 9.8, 9.5)]);
    assert_eq!(turns(3, [90.0, 1.0]), [], "it may beat, and come back");
    assert_eq!(turns(4, [90.0, 1.0]), [(Level::Warning, 90.0, 95.0)], "now it is the first");
    assert_eq!(turns(5, [1.0, 1.0]), []);
    assert_eq!(turns(6, [1.0, 1.0]), [(Level::Fine, 2.0, 8.0)]);
    // A limit that somebody has set is for the force of any of them.
    let mut limits = Limits::default();
    limits.set(Watch::Force, Some([6.0, 12.0])).unwrap();
    alarms.limit(limits);
    sampler.hear(&State::new(StepLayout::new(3).with_bearings(2)).with_word(Channel::RunId, 7).with(
        Channel::FurtherForceY,
        0,
        3.5,
    ));
    assert_eq!(alarms.read(&sampler.take())[0].value, 7.0);
}
