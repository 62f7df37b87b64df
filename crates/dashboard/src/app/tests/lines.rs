//! Lines that are typed, pasted, copied, completed and taken back.

use super::*;
use crate::app::bursts::{LINES, TOO_FAST};

#[test]
fn commands_are_typed_completed_and_done() {
    let (mut app, taken) = dashboard(&Options::default());
    type_in(&mut app, ":lay");
    press(&mut app, &[Tab]);
    type_in(&mut app, "op");
    press(&mut app, &[Tab]);
    assert_eq!(app.layers, [Layer::Command("layout operator".into())]);
    assert!(frame(&mut app).contains(":layout operator"));
    press(&mut app, &[Enter]);
    assert_eq!(app.layout, 1);
    type_in(&mut app, ":set kd=0.5 speed=3");
    press(&mut app, &[Enter]);
    type_in(&mut app, ":note hello q");
    press(&mut app, &[Enter]);
    let wanted = [Edit::Set(vec![(key("kd"), 0.5), (key("speed"), 3.0)]), Edit::Note("hello q".into())];
    assert_eq!(taken.try_iter().collect::<Vec<_>>(), wanted);
    type_in(&mut app, ":fly");
    press(&mut app, &[Enter]);
    assert!(frame(&mut app).contains("no command 'fly'"));
}

#[test]
fn earlier_commands_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { commands: Some(folder.path().join("commands")), ..Options::default() };
    let (mut app, taken) = dashboard(&options);
    type_in(&mut app, ":note one");
    press(&mut app, &[Enter]);
    let (mut next, taken_next) = dashboard(&options);
    type_in(&mut next, ":no");
    press(&mut next, &[Up]);
    assert_eq!(next.layers, [Layer::Command("note one".into())]);
    press(&mut next, &[Down]);
    assert_eq!(next.layers, [Layer::Command("no".into())]);
    press(&mut next, &[Up, Left, Left, Left, Char('x'), Enter]);
    assert_eq!(taken_next.try_iter().chain(taken.try_iter()).count(), 2);
    let kept = std::fs::read_to_string(folder.path().join("commands")).unwrap();
    assert_eq!(kept, "note one\nnote xone\n");
}

#[test]
fn settings_of_which_nothing_is_left_on_this_rotor_are_refused() {
    let (mut app, taken) = dashboard(&Options::default());
    command(&mut app, "set deadband=1 deadband.1=2 deadband.2=2 deadband.3=2");
    assert!(matches!(&app.message.0, Message::Bad(words) if words.contains("deadband")), "{:?}", app.message.0);
    assert!(taken.is_empty());
    command(&mut app, "set deadband=1 deadband.1=2");
    assert_eq!(taken.try_iter().count(), 1);
}

#[test]
fn a_burst_of_letters_that_no_hand_types_drives_no_machine() {
    let of = |text: &str| {
        let (mut app, taken) = dashboard(&Options::default());
        let keys = text.chars().map(|letter| match letter {
            '\n' => Input::Key(KeyEvent::new(Enter, KeyModifiers::NONE)),
            letter => Input::Key(KeyEvent::new(Char(letter), KeyModifiers::NONE)),
        });
        app.take_all(keys.collect());
        (taken.try_iter().count(), app)
    };
    let (edits, app) = of("lullabies 0iR\nand more");
    assert_eq!((edits, &app.message.0, app.quit), (0, &Message::Bad(TOO_FAST.into()), None));
    assert_eq!(of("llllllllllllllll").0, 16, "a key that is held down");
    assert_eq!(of("llu").0, 3, "a quick hand");
    assert_eq!(of(":kd=0.25\n").0, 1, "a line that begins as a command");
    // More behind its end was pasted: it waits, and says so.
    let (edits, mut app) = of(":kd=0.25\n0iR\n:cd=0.5\n");
    assert_eq!((edits, &app.message.0), (0, &Message::Bad(LINES.into())));
    let shown = frame(&mut app);
    assert!(shown.contains(":kd=0.25_") && shown.contains("the first waits for enter"), "{shown}");
    press(&mut app, &[Enter]);
    assert!(app.layers.is_empty());
    // And no question is answered by what begins with a y.
    let (mut app, taken) = dashboard(&Options::default());
    asks_about_off(&mut app);
    let keys = "yesterday 0".chars().map(|letter| Input::Key(KeyEvent::new(Char(letter), KeyModifiers::NONE)));
    app.take_all(keys.collect());
    assert!(taken.is_empty() && app.layers.len() == 1, "{:?}", app.layers);
}

#[test]
fn settings_are_copied_as_they_are_typed() {
    let (_, mut app) = pressed(&[Down, Down, Down, Char('c')]);
    assert_eq!(app.copies.take().as_deref(), Some("kd=-0.5879"));
    command(&mut app, "copy settings");
    let all = app.copies.take().unwrap();
    assert!(all.starts_with("speed=2.5 trip=1000 deadband.1=1") && all.contains(" ramp=off"), "{all}");
    assert!(actions::parse(&format!("set {all}")).is_ok(), "{all}");
}

#[test]
fn settings_of_a_rotor_in_si_units_are_typed_and_nudged_in_them() {
    let (mut app, taken) = dashboard(&Options::default());
    {
        let mut bench_status = tests::bench_status("three-mass", "composite");
        let scales = telemetry::test_support::SI;
        bench_status.scales = [scales.w0, scales.k_t, scales.m_t, scales.e_t];
        lock(&app.feed).push_bench_status(bench_status);
    }
    let shown = frame(&mut app);
    assert!(shown.contains("23873 rpm") && !shown.contains("R 2.5") && shown.contains("23873.24"), "{shown}");
    press(&mut app, &[Right]);
    command(&mut app, "deadband 10");
    command(&mut app, "deadband=1e-5m kd = 2 N/um");
    press(&mut app, &[Enter]);
    type_in(&mut app, "9549.296585513721");
    press(&mut app, &[Enter]);
    let edits: Vec<Edit> = taken.try_iter().collect();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    let [Edit::Nudge(_, nudge), Edit::Set(shown), Edit::Set(said), Edit::Set(speed)] = &edits[..] else {
        panic!("{edits:?}")
    };
    // 500 rpm; 10 um are 2 e_t; 2e6 N/m on a quarter of 2 kg (1000/s)^2 are 4; 9549.3 rpm are 1000 rad/s.
    assert!(near(*nudge, 500.0 / 9_549.296_585_513_72) && near(speed[0].1, 1.0), "{edits:?}");
    assert!(near(shown[0].1, 2.0) && near(said[0].1, 2.0) && near(said[1].1, 4.0), "{edits:?}");
    // What is copied can be typed here and on the command line, whose lengths are in metres.
    command(&mut app, "copy settings");
    let copied = app.copies.take().unwrap();
    assert!(
        copied.contains("speed=23873.24") && copied.contains("rpm trip=5000μm") && copied.contains("N.s/m"),
        "{copied}"
    );
    assert!(actions::parse(&format!("set {copied}")).is_ok(), "{copied}");
}

#[test]
fn what_is_pasted_drives_no_machine_and_types_where_a_line_is_typed() {
    let (mut app, taken) = dashboard(&Options::default());
    // As keys: control off, restart, undo, an impulse, and quit.
    app.take(Input::Paste("0Rui\n:kd=5\nq".into()));
    assert!(matches!(&app.message.0, Message::Bad(why) if why.contains("pasted")), "{:?}", app.message.0);
    assert!(taken.is_empty() && app.layers.is_empty() && app.quit.is_none());
    press(&mut app, &[Char(':')]);
    app.take(Input::Paste("kd=0.25\rcd=0.5\r\n".into()));
    assert!(taken.is_empty(), "nobody has pressed enter yet");
    press(&mut app, &[Enter]);
    let both = Edit::Set(vec![(key("kd"), 0.25), (key("cd"), 0.5)]);
    assert_eq!(taken.try_iter().collect::<Vec<_>>(), [both], "the end of a line is a blank");
    press(&mut app, &[Enter]);
    app.take(Input::Paste("fast".into()));
    assert!(matches!(&app.message.0, Message::Bad(why) if why.contains("pasted")), "a value is a number");
    app.take(Input::Paste("3.5\n".into()));
    press(&mut app, &[Enter]);
    assert_eq!(taken.try_iter().collect::<Vec<_>>(), [Edit::Set(vec![(key("speed"), 3.5)])]);
}
