//! What is asked before a change, and what is shown of it before it is made.

use super::*;

#[test]
fn what_went_wrong_is_forgotten_with_the_next_thing_that_is_done() {
    let (_, mut app) = pressed(&[]);
    type_in(&mut app, ":layout nowhere");
    press(&mut app, &[Enter]);
    assert!(matches!(&app.message.0, Message::Bad(told) if told.contains("no layout")));
    type_in(&mut app, ":layout operator");
    press(&mut app, &[Enter]);
    assert_eq!(app.message.0, Message::Hints);
}

#[test]
fn a_limit_below_the_orbit_is_asked_about_in_the_units_of_the_rotor() {
    let (_, mut app) = pressed(&[]);
    let trips = machine::TripAtOnce { orbit: 12.5, limit: 5.0 };
    let settings = tests::bench_status("three-mass", "composite").settings.get().clone();
    let asks = |harms: Vec<telemetry::edits::Harm>| EditOutcome::Asks(Edit::Undo, Box::new(settings.clone()), harms);
    app.take_outcome(asks(vec![telemetry::edits::Harm::Trips(trips)]));
    let shown = frame(&mut app);
    assert!(shown.contains("trips at once: its orbit is 12.50 e_t, past a limit of 5.000 e_t  y "), "{shown}");
}

#[test]
fn a_change_that_would_be_unstable_is_shown_first_and_asked_about() {
    let (edits, mut app) = pressed(&[Char('0')]);
    assert_eq!(edits, [Edit::Off]);
    let off = asks_about_off(&mut app);
    let shown = frame(&mut app);
    assert!(shown.contains("UNSTABLE with that: minimum damping -0.0306"), "{shown}");
    assert!(shown.contains("then -0."), "the damping panel shows the candidate:\n{shown}");
    let sure = Edit::Sure(Box::new(Edit::Off), Box::new(off));
    for (answer, wanted) in [(Char('y'), vec![sure]), (Char('n'), vec![]), (Esc, vec![]), (Enter, vec![])] {
        let (mut app, taken) = dashboard(&Options::default());
        asks_about_off(&mut app);
        press(&mut app, &[answer]);
        assert_eq!(taken.try_iter().collect::<Vec<_>>(), wanted, "{answer:?}");
        assert!(app.layers.is_empty());
    }
    asks_about_off(&mut app);
    press(&mut app, &[Char('q')]);
    assert!(app.quit.is_some());
}

#[test]
fn a_question_never_takes_a_key_that_was_meant_for_something_else() {
    let (mut app, taken) = dashboard(&Options::default());
    type_in(&mut app, ":note ");
    asks_about_off(&mut app);
    type_in(&mut app, "y");
    assert_eq!(app.layers, [Layer::Command("note y".into())]);
    assert!(taken.is_empty() && matches!(&app.message.0, Message::Bad(why) if why.ends_with(": not done")));
}

#[test]
fn what_is_being_typed_is_shown_beside_what_is() {
    let (_, mut app) = pressed(&[Enter, Char('2')]);
    let shown = frame(&mut app);
    assert!(shown.contains("then 0."), "{shown}");
    assert!(shown.contains('◇'), "{shown}");
    app.layout = 2;
    let tuning = frame(&mut app);
    assert!(tuning.contains("damping  stable 0 to 7.074"), "words go before the range:\n{tuning}");
    assert!(tuning.contains("│? 0.") && tuning.matches("0 to 7.074").count() == 2, "its curve is there too:\n{tuning}");
    app.layout = 0;
    press(&mut app, &[Esc]);
    assert!(!frame(&mut app).contains("then 0."));
}
