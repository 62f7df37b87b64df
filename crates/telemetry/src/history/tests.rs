use wire::State;

use super::*;
use crate::test_support::{bench_status, state};

fn with_revision(revision: u64, state: State) -> State {
    state.with_word(wire::Channel::Revision, revision)
}

/// The largest control of the only bearing.
fn peak_force(history: &History, place: u64) -> f64 {
    history.peak_forces(place)[0]
}

fn filled(steps: u64) -> History {
    let mut history = History::new(BOUND);
    (0..steps).for_each(|seq| history.push(&state(3, seq)));
    history
}

#[test]
fn ten_minutes_at_1000_steps_a_second_of_three_masses_fit_under_150_mb_with_all_their_numbers() {
    let history = filled(1);
    assert!(history.room() >= 600_000, "{}", history.room());
    let a_step = Block::bytes(StepLayout::new(3)) as f64 / STEPS as f64;
    assert!(a_step < 250.0 && BOUND < 150_000_000, "{a_step}");
}

#[test]
fn history_is_bounded_and_keeps_the_latest() {
    let mut history = History::new(20 * Block::bytes(StepLayout::new(3)));
    let steps = 100_000;
    (0..steps).for_each(|seq| history.push(&state(3, seq)));
    let places = history.kept();
    let kept = places.end - places.start;
    assert!((18 * STEPS as u64..=20 * STEPS as u64).contains(&kept), "{kept}");
    assert_eq!(places.end, steps);
    let track = history.track(&places);
    let last = state(3, steps - 1);
    assert_eq!(track.angle(track.len() - 1), last.angle());
    assert_eq!(track.displacement(track.len() - 1, 2), [last.point(2).y, last.point(2).z]);
    assert_eq!(track.tau(0), state(3, places.start).tau());
}

#[test]
fn every_number_of_a_step_is_kept() {
    let mut history = History::new(BOUND);
    let mut one = state(3, 0).with_flags(Flags::contact(0b101) | Flags::LATE);
    let mut row = one.row_mut();
    row.set_pair([wire::Channel::CommandY, wire::Channel::CommandZ], 0, [3.0, -4.0]);
    row.set_word(wire::Channel::WallNs, 1_700_000_000_123_456_789);
    row.set_pair([wire::Channel::Vy, wire::Channel::Vz], 1, [7.5, -8.5]);
    history.push(&one);
    let track = history.track(&history.kept());
    assert_eq!((track.tau(0), track.speed(0), track.wall_ns(0)), (one.tau(), one.speed(), one.wall_ns()));
    assert_eq!((track.flags(0), track.velocity(0, 1), track.commanded(0)), (one.flags(), [7.5, -8.5], [3.0, -4.0]));
    assert_eq!(track.value(StepQuantity::size(wire::Channel::CommandY, 0), 0), 5.0);
    assert_eq!(track.value(StepQuantity::radius(2), 0), one.point(2).radius());
    for column in one.layout().number_columns() {
        let kept = track.value(StepQuantity::Of(column.channel, column.index), 0);
        assert_eq!(kept, one.number(column.channel, column.index), "{}", column.name());
    }
}

#[test]
fn ranges_are_those_of_the_steps_they_cover() {
    let mut history = History::new(BOUND);
    for seq in 0..5000 {
        // Not periodic, and with a spike that no other step hides.
        let y = ((seq * seq) % 977) as f64 - 400.0 + if seq == 3210 { 9000.0 } else { 0.0 };
        history.push(&state(2, seq).with(wire::Channel::Y, 1, y));
    }
    let track = history.track(&(100..4900));
    for (from, to) in [(0, 4800), (0, 1), (3, 64), (60, 70), (924, 1948), (17, 4700), (3109, 3112), (4799, 4800)] {
        for channel in [
            StepQuantity::y(1),
            StepQuantity::FORCE,
            StepQuantity::radius(1),
            StepQuantity::TAU,
            StepQuantity::Of(wire::Channel::Vz, 0),
        ] {
            let values = (from..to).map(|step| track.value(channel, step));
            let expected = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
            assert_eq!(track.range(channel, from..to), Some(expected), "{channel:?} {from}..{to}");
        }
    }
    assert_eq!(track.range(StepQuantity::TAU, 7..7), None);
}

#[test]
fn columns_cover_every_step_once_and_keep_their_borders_while_the_window_moves() {
    let history = filled(9000);
    let borders = |first: u64| -> Vec<u64> {
        let track = history.track(&(first..first + 4000));
        let columns: Vec<_> = track.columns(0..track.len(), 120).collect();
        assert!(columns.len() <= 120, "{}", columns.len());
        assert_eq!((columns[0].start, columns.last().map(|column| column.end)), (0, Some(4000)));
        assert!(columns.windows(2).all(|pair| pair[0].end == pair[1].start));
        columns[1..].iter().map(|column| column.start as u64 + first).collect()
    };
    let (here, there) = (borders(1000), borders(1013));
    assert!(here.iter().filter(|border| there.contains(border)).count() >= here.len() - 2);
    assert_eq!(history.track(&(0..0)).columns(0..0, 10).len(), 0);
    assert_eq!(history.track(&(0..5)).columns(0..5, 1).map(|column| column.len()).sum::<usize>(), 5);
}

#[test]
fn gaps_restarts_runs_and_trips_are_marked_where_they_are() {
    let mut history = History::new(BOUND);
    [0, 1, 5, 6].into_iter().for_each(|seq| history.push(&state(1, seq)));
    assert_eq!(history.lost(), 3);
    history.push(&state(1, 0).with_word(wire::Channel::Seq, 7));
    history.push(&state(1, 1).with_word(wire::Channel::Seq, 8).with_flags(Flags::TRIPPED));
    history.push(&state(1, 0).with_word(wire::Channel::RunId, 8));
    let marks: Vec<_> = history.marks(&history.kept()).cloned().collect();
    assert_eq!(marks, [(2, Mark::Lost(3)), (4, Mark::Restart), (5, Mark::Trip), (6, Mark::NewRun)]);
    assert_eq!((history.lost(), history.kept()), (0, 0..7), "losses are those of this run");
}

#[test]
fn notes_are_marked_at_their_steps_in_order() {
    let mut history = filled(100);
    history.push(&with_revision(2, state(3, 100)));
    history.note(7, 101);
    history.note(7, 40);
    history.note(8, 50);
    let marks: Vec<_> = history.marks(&(0..200)).cloned().collect();
    assert_eq!(marks, [(40, Mark::Note), (100, Mark::Settings(2)), (101, Mark::Note)]);
}

#[test]
fn another_number_of_masses_resets_peaks_at_a_place_of_its_own() {
    let mut history = filled(100);
    history.push(&state(1, 0).with_word(wire::Channel::RunId, 8));
    assert_eq!((history.kept(), history.layout.masses()), (100..101, 1));
    assert_eq!(history.marks(&history.kept()).count(), 0);
}

#[test]
fn a_machine_that_coasts_down_is_kept_step_by_step() {
    let mut history = History::new(BOUND);
    (0..10).for_each(|seq| history.push(&state(1, seq)));
    (10..500).for_each(|seq| history.push(&state(1, seq).with_flags(Flags::TRIPPED | Flags::COASTING)));
    assert_eq!((history.kept(), history.is_tripped()), (0..500, true));
    // Held after all.
    (500..600).for_each(|seq| history.push(&state(1, seq).with_flags(Flags::TRIPPED)));
    let marks: Vec<_> = history.marks(&(0..700)).cloned().collect();
    assert_eq!((history.kept(), marks), (0..501, vec![(10, Mark::Trip), (500, Mark::Trip)]));
}

#[test]
fn a_held_machine_keeps_what_tripped_it() {
    let mut history = History::new(BOUND);
    (0..10).for_each(|seq| history.push(&state(1, seq)));
    let held = |seq| state(1, seq).with_flags(Flags::TRIPPED);
    (10..500).for_each(|seq| history.push(&held(seq)));
    assert_eq!((history.kept(), history.is_tripped(), history.lost()), (0..11, true, 0));
    history.push(&state(1, 0).with_word(wire::Channel::Seq, 500));
    assert_eq!((history.kept(), history.is_tripped()), (0..12, false));
}

#[test]
fn settings_are_known_for_every_step() {
    let mut history = History::new(BOUND);
    let told = |revision, feedback| {
        let mut bench_status = bench_status("three-mass", feedback);
        bench_status.revision = revision;
        bench_status
    };
    history.note_bench_status(&told(1, "composite"));
    history.note_bench_status(&told(1, "composite"));
    (0..10).for_each(|seq| history.push(&state(3, seq)));
    // The steps come before the news of them; revision 2 is never told of.
    (10..20).for_each(|seq| history.push(&with_revision(2, state(3, seq))));
    (20..30).for_each(|seq| history.push(&with_revision(3, state(3, seq))));
    history.note_bench_status(&told(3, "off"));
    let revision = |place| history.era_at(place).map(|era| era.revision);
    assert_eq!([0, 9, 10, 19, 20, 29].map(revision), [1, 1, 1, 1, 3, 3].map(Some));
    let eras: Vec<_> = history.eras(&(5..25)).into_iter().map(|(at, era)| (at, era.revision)).collect();
    assert_eq!(eras, [(5, 1), (10, 1), (20, 3)]);
    let marks: Vec<_> = history.marks(&history.kept()).cloned().collect();
    assert_eq!(marks, [(10, Mark::Settings(2)), (20, Mark::Settings(3))]);
}

#[test]
fn eras_and_marks_are_let_go_of_with_their_steps() {
    let mut history = History::new(0);
    for seq in 0..40_000 {
        if seq % 100 == 0 {
            let mut news = bench_status("three-mass", "composite");
            news.revision = seq / 100;
            history.note_bench_status(&news);
        }
        history.push(&with_revision(seq / 100, state(3, seq)));
    }
    let kept = history.kept().end - history.kept().start;
    assert!(kept <= 10 * STEPS as u64 && kept >= 8 * STEPS as u64, "{kept}");
    assert!(history.eras.len() as u64 <= kept / 100 + 2, "{}", history.eras.len());
    assert!(history.marks.len() as u64 <= kept / 100 + 12, "{}", history.marks.len());
    assert_eq!(history.era_at(history.kept().start).map(|era| era.revision), Some(history.kept().start / 100));
}

#[test]
fn the_peak_force_resets_peaks_with_every_change_and_is_known_for_the_past() {
    let mut history = History::new(BOUND);
    let with = |seq, force, revision| {
        with_revision(revision, state(1, seq)).with(wire::Channel::ForceY, 0, force).with(wire::Channel::ForceZ, 0, 0.0)
    };
    history.push(&with(0, 5.0, 1));
    history.push(&with(1, 1.0, 1));
    assert_eq!(peak_force(&history, 1), 5.0);
    history.push(&with(2, 2.0, 2));
    history.push(&with(3, 1.5, 2));
    assert_eq!((peak_force(&history, 3), peak_force(&history, 2), peak_force(&history, 1)), (2.0, 2.0, 5.0));
}

#[test]
fn the_largest_force_is_found_and_counts_anew_when_told_to() {
    let mut history = History::new(BOUND);
    let push = |history: &mut History, range: std::ops::Range<u64>| {
        for seq in range {
            let u = if seq == 700 || seq == 1500 { 3.0 + seq as f64 / 1000.0 } else { 0.5 };
            history.push(&state(3, seq).with(wire::Channel::ForceY, 0, u).with(wire::Channel::ForceZ, 0, 0.0));
        }
    };
    push(&mut history, 0..1000);
    assert_eq!((peak_force(&history, 999), history.peak_place(999)), (3.7, Some(700)));
    history.reset_peak();
    push(&mut history, 1000..1400);
    assert_eq!((peak_force(&history, 1399), history.peak_place(1399)), (0.5, Some(1000)));
    assert_eq!(history.peak_place(800), Some(700), "what was looked at before keeps its own");
    push(&mut history, 1400..1600);
    assert_eq!((peak_force(&history, 1599), history.peak_place(1599)), (4.5, Some(1500)));
}
