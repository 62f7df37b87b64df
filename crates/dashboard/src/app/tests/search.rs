//! Gain searches, from the key to the answer.

use super::*;

/// Lets the dashboard live on until it asks something.
fn wait_for_a_question(app: &mut App<'_>) {
    let begun = Instant::now();
    while app.layers.is_empty() {
        assert!(begun.elapsed() < std::time::Duration::from_secs(600), "{:?}", app.message.0);
        app.tick();
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
}

#[test]
fn a_search_shows_what_it_found_and_applies_it_when_told_so() {
    let (mut app, taken) = dashboard(&Options::default());
    press(&mut app, &[Char(':')]);
    type_in(&mut app, "search 0..5 full");
    press(&mut app, &[Enter]);
    assert!(app.search.is_some(), "{:?}", app.message.0);
    type_in(&mut app, "S");
    assert!(matches!(&app.message.0, Message::Bad(words) if words.contains("`:search stop` ends it")));
    wait_for_a_question(&mut app);
    // Seen before it applies: the panels show the candidate beside the present gains.
    let screen = frame(&mut app);
    assert!(screen.contains("found over R 0..5: min damping 0.0388"), "{screen}");
    // What both sets of gains do stands above the question, gone with the answer.
    for words in [
        " in force, and found ",
        "min damping  ",
        "any deadband  ",
        "R 0 to 7.07",
        "self-excited whirl  ",
        "force ",
        "kd  ",
    ] {
        assert!(screen.contains(words), "{words}: {screen}");
    }
    assert!(taken.is_empty() && app.search.is_none());
    press(&mut app, &[Char('y')]);
    assert!(!frame(&mut app).contains(" in force, and found "));
    let edits: Vec<Edit> = taken.try_iter().collect();
    let [Edit::Become(change, why)] = &edits[..] else { panic!("{edits:?}") };
    assert_eq!(why, "gains searched over R 0..5");
    assert_eq!(change.0.speed, change.1.speed);
    assert_ne!(change.0.feedback, change.1.feedback);
}

#[test]
fn where_a_clearance_is_set_gains_are_searched_for_any_deadband_or_said_not_to_be_there() {
    // One weighted signal cannot hold the three masses in every deadband state from rest to R = 5.
    let (mut app, taken) = dashboard(&Options::default());
    press(&mut app, &[Char(':')]);
    type_in(&mut app, "search 0..5");
    press(&mut app, &[Enter]);
    wait_for_a_question(&mut app);
    let screen = frame(&mut app);
    assert!(screen.contains("no such gains hold for any deadband, see `:search full`"), "{screen}");
    let rows = app.compared.iter().map(|row| format!("{}: {}", row.word, row.detail));
    insta::assert_snapshot!(rows.collect::<Vec<_>>().join("\n"));
    press(&mut app, &[Esc]);
    assert!(taken.is_empty(), "nothing was changed");
}

#[test]
fn a_search_is_dropped_stopped_or_refused() {
    let (mut app, taken) = dashboard(&Options::default());
    let command = |app: &mut App<'_>, line: &str| {
        press(app, &[Char(':')]);
        type_in(app, line);
        press(app, &[Enter]);
    };
    command(&mut app, "search stop");
    assert_eq!(app.message.0, Message::Bad("no search is under way".into()));
    command(&mut app, "search 6..1");
    assert!(matches!(&app.message.0, Message::Bad(words) if words.contains("expected a range of speeds")));
    command(&mut app, "search 0..7 robust");
    command(&mut app, "search stop");
    while app.layers.is_empty() {
        app.tick();
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert!(frame(&mut app).contains("stopped early"));
    press(&mut app, &[Esc]);
    assert!(app.layers.is_empty() && taken.is_empty(), "nothing was changed");
}
