//! What single keys do: select, nudge, type a value, strike, look back, quit; and what they do not, on a machine that may not be changed.

use super::*;

#[test]
fn arrows_select_and_nudge() {
    let (edits, app) = pressed(&[Down, Down, Right, Up, Left]);
    assert_eq!(app.row, 1);
    assert_eq!(
        edits,
        [Edit::Nudge(key("deadband"), 0.1), Edit::Nudge(key("trip"), -10.0)],
        "rows are speed, trip, deadband, ..."
    );
    assert_eq!(pressed(&[Up]).1.row, 0);
    assert_eq!(pressed(&[Down; 40]).1.row, 20);
}

#[test]
fn a_value_is_typed_after_enter() {
    let (edits, app) = pressed(&[Enter, Char('3'), Char('.'), Char('5'), Enter]);
    assert_eq!((edits, app.layers), (vec![Edit::Set(vec![(key("speed"), 3.5)])], vec![]));
    let (edits, app) = pressed(&[Enter, Char('3'), Char('u'), Char('i'), Esc]);
    assert_eq!((edits, app.layers), (vec![], vec![]), "other keys do not act by accident");
    let (edits, app) = pressed(&[Enter, Char('3'), Char('-'), Enter]);
    assert_eq!((edits.len(), app.message.0), (0, Message::Bad("speed = '3-': expected a number".into())));
    let (_, app) = pressed(&[Enter, Char('3'), Down]);
    assert_eq!((app.layers.len(), app.row), (0, 1));
}

#[test]
fn quitting_works_from_everywhere_and_ctrl_c_from_texts_too() {
    for before in [&[][..], &[Char('?')], &[Enter, Char('3')], &[Char(' ')], &[Enter], &[Char('0')], &[Char('7')]] {
        assert!(pressed(&[before, &[Char('q')]].concat()).1.quit.is_some(), "{before:?}");
    }
    for text in [Char(':'), Char('/'), Char('w'), Char('s')] {
        let (_, mut app) = pressed(&[text, Char('q')]);
        assert_eq!(app.quit, None, "q is a letter of a text");
        app.press(KeyEvent::new(Char('c'), KeyModifiers::CONTROL));
        assert_eq!(app.quit, Some(Ended::Quit));
    }
}

#[test]
fn an_impulse_strikes_the_mass_with_the_bearing() {
    assert_eq!(pressed(&[Char('i')]).0, [Edit::Impulse(0, C64::new(-2.5, 0.0))]);
    assert_eq!(pressed(&[Char('R')]).0, [Edit::Restart]);
}

#[test]
fn looking_back_moves_the_cursor_and_space_returns() {
    let (_, mut app) = pressed(&[Char('['), Char('<'), Char('+')]);
    let data = lock(&app.feed).frame_data(&app.time, Instant::now());
    assert_eq!((data.now, data.behind), (Some(1998), 1001));
    assert!(frame(&mut app).contains("PAUSED"));
    press(&mut app, &[Char(' ')]);
    assert!(app.time.is_live());
}

#[test]
fn two_settings_are_compared_with_one_key() {
    let (mut app, taken) = dashboard(&Options::default());
    press(&mut app, &[Char('b')]);
    assert!(matches!(&app.message.0, Message::Bad(why) if why.contains("hold the settings first")));
    press(&mut app, &[Char('B')]);
    let held = app.held.clone().unwrap();
    press(&mut app, &[Char('b')]);
    assert_eq!(taken.try_iter().collect::<Vec<_>>(), [Edit::Swap(Box::new(held.clone()))]);
    assert_eq!(app.held.as_ref(), Some(&held), "nothing has changed places until it is in force");
    let before = Settings { speed: 2.6, ..held };
    app.take_outcome(EditOutcome::Swapped("swapped, from step 42".into(), Box::new(before.clone())));
    assert_eq!(app.held, Some(before));
}

#[test]
fn the_setting_that_a_filter_leaves_is_nudged() {
    let (mut app, taken) = dashboard(&Options::default());
    type_in(&mut app, "/kc");
    press(&mut app, &[Enter, Down, Right]);
    assert_eq!(taken.try_iter().collect::<Vec<_>>(), [Edit::Nudge(key("kc"), 0.01)]);
}

#[test]
fn a_read_only_dashboard_changes_nothing() {
    let (mut app, taken) = dashboard(&Options { read_only: true, ..Options::default() });
    press(&mut app, &[Right, Char('0'), Char('u'), Char('i'), Char('R'), Enter, Char('1'), Enter]);
    type_in(&mut app, ":note x");
    press(&mut app, &[Enter]);
    assert_eq!(taken.try_iter().count(), 0);
    assert!(frame(&mut app).contains("read-only"));
}

#[test]
fn a_locked_machine_is_left_alone_until_it_is_unlocked() {
    let (mut app, taken) = dashboard(&Options { locked: true, ..Options::default() });
    assert!(frame(&mut app).lines().next().unwrap().contains("LOCKED"));
    press(&mut app, &[Char('0'), Char('i'), Char('R'), Right, Char('q')]);
    command(&mut app, "kd=0.25");
    command(&mut app, "q");
    command(&mut app, "quit");
    assert!(taken.is_empty() && app.quit.is_none());
    assert!(matches!(&app.message.0, Message::Bad(why) if why.contains("ctrl-l unlocks")), "{:?}", app.message.0);
    app.press(KeyEvent::new(Char('l'), KeyModifiers::CONTROL));
    assert!(!frame(&mut app).lines().next().unwrap().contains("LOCKED"));
    press(&mut app, &[Char('i')]);
    assert_eq!(taken.try_iter().count(), 1);
    app.press(KeyEvent::new(Char('l'), KeyModifiers::CONTROL));
    press(&mut app, &[Char('q')]);
    assert!(app.quit.is_none());
    app.press(KeyEvent::new(Char('c'), KeyModifiers::CONTROL));
    assert_eq!(app.quit, Some(Ended::Quit), "a person who means it can leave");
}
