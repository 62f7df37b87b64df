mod mouse;
mod scenarios;
mod search;

use std::sync::Mutex;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use rotor::{C64, Key};

use super::bursts::{LINES, TOO_FAST};
use super::*;
use KeyCode::{Char, Down, Enter, Esc, Left, Right, Tab, Up};
use telemetry::feed::Feed;
use telemetry::test_support as tests;

/// A dashboard with a feed of the three-mass rotor, and where its edits go.
pub(super) fn dashboard(options: &Options) -> (App<'static>, Receiver<Edit>) {
    let mut feed = Feed::new("");
    feed.push_bench_status(tests::bench_status("three-mass", "composite"));
    (0..3000).for_each(|seq| feed.push_step(&tests::state(3, seq), Instant::now()));
    let (edits, taken) = channel::bounded(64);
    let feed = Arc::new(Mutex::new(feed));
    let mut app =
        App::new("default".into(), feed, edits, None, telemetry::jobs::Jobs::inline(), Arc::default(), options);
    frame(&mut app);
    (app, taken)
}

/// The frame, as text.
pub(super) fn frame(app: &mut App<'_>) -> String {
    let area = Rect::new(0, 0, 120, 40);
    let mut buffer = ratatui::buffer::Buffer::empty(area);
    app.render(area, &mut buffer);
    crate::screenshot::image::text(&buffer)
}

fn press(app: &mut App<'_>, keys: &[KeyCode]) {
    keys.iter().for_each(|code| app.press(KeyEvent::new(*code, KeyModifiers::NONE)));
}

fn type_in(app: &mut App<'_>, text: &str) {
    text.chars().for_each(|letter| press(app, &[Char(letter)]));
}

/// Presses keys, and returns what is then wanted.
fn pressed(keys: &[KeyCode]) -> (Vec<Edit>, App<'static>) {
    let (mut app, taken) = dashboard(&Options::default());
    press(&mut app, keys);
    (taken.try_iter().collect(), app)
}

fn key(name: &str) -> Key {
    name.parse().unwrap()
}

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

/// The edit thread asks whether all gains shall be zero.
fn asks_about_off(app: &mut App<'_>) -> Settings {
    let settings = tests::bench_status("three-mass", "off").settings.get().clone();
    app.take_outcome(EditOutcome::Asks(
        Edit::Off,
        Box::new(settings.clone()),
        vec![telemetry::edits::Harm::Unstable(-0.0306)],
    ));
    settings
}

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
fn gains_are_kept_and_taken_back() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { presets: Some(folder.path().join("presets")), ..Options::default() };
    let (mut app, taken) = dashboard(&options);
    type_in(&mut app, "sgood");
    press(&mut app, &[Enter]);
    assert!(matches!(&app.message.0, Message::Good(told) if told.contains("good.toml")), "{:?}", app.message.0);
    type_in(&mut app, "o");
    assert!(frame(&mut app).contains("good  min damping 0.0535 at R 2.5, in force"), "{}", frame(&mut app));
    type_in(&mut app, "good");
    press(&mut app, &[Enter]);
    assert!(matches!(&taken.try_iter().collect::<Vec<_>>()[..], [Edit::Become(..)]));
    for (command, complaint) in
        [("load bad", "no gains are kept as 'bad': there are good"), ("save ../x", "expected a name of")]
    {
        type_in(&mut app, &format!(":{command}"));
        press(&mut app, &[Enter]);
        assert!(matches!(&app.message.0, Message::Bad(why) if why.contains(complaint)), "{:?}", app.message.0);
    }
}

#[test]
fn gains_of_a_name_that_is_taken_are_replaced_and_deleted_only_after_a_yes() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { presets: Some(folder.path().to_owned()), ..Options::default() };
    let (mut app, _taken) = dashboard(&options);
    let file = folder.path().join("good.toml");
    let commanded = |app: &mut App<'_>, line: &str, answer| {
        type_in(app, line);
        press(app, &[Enter, answer]);
    };
    commanded(&mut app, ":save good", Esc);
    let first = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, first.replace("-0.5879", "0.25")).unwrap();
    type_in(&mut app, ":save good");
    press(&mut app, &[Enter]);
    let shown = frame(&mut app);
    assert!(shown.contains("'good' is kept already (min damping ") && shown.contains(" y does it"), "{shown}");
    press(&mut app, &[Char('n')]);
    assert!(std::fs::read_to_string(&file).unwrap().contains("0.25"));
    commanded(&mut app, ":save good", Char('y'));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), first);
    commanded(&mut app, ":delete good", Char('n'));
    assert!(file.exists());
    commanded(&mut app, "Dgood", Char('y'));
    assert!(!file.exists() && matches!(&app.message.0, Message::Good(told) if told.contains("'good' deleted")));
    type_in(&mut app, ":delete good");
    press(&mut app, &[Enter]);
    assert_eq!(app.message.0, Message::Bad("no gains are kept as 'good': there are none yet".into()));
}

#[test]
fn gains_that_are_kept_are_shown_while_their_name_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { presets: Some(folder.path().to_owned()), ..Options::default() };
    let (mut app, taken) = dashboard(&options);
    command(&mut app, "save mine");
    type_in(&mut app, ":load mine");
    assert!(frame(&mut app).contains("then 0.0535"));
    assert!(taken.is_empty());
}

#[test]
fn a_key_keeps_a_picture_of_the_screen_and_says_where() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { pictures: Some(folder.path().to_owned()), ..Options::default() };
    let (mut app, _taken) = dashboard(&options);
    app.watch_alarms();
    let before = frame(&mut app);
    for _ in 0..2 {
        type_in(&mut app, ":picture now.txt");
        press(&mut app, &[Enter]);
    }
    assert!(frame(&mut app).contains("now.txt is there already: nothing is overwritten"));
    let kept = std::fs::read_to_string(folder.path().join("now.txt")).unwrap();
    let lines = |text: &str| text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(lines(&kept), lines(&before), "but for the age of the data it is what the screen showed");
    press(&mut app, &[Char('P')]);
    assert!(matches!(&app.message.0, Message::Good(told) if told.contains(".svg and .txt")), "{:?}", app.message.0);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn the_setting_that_a_filter_leaves_is_nudged() {
    let (mut app, taken) = dashboard(&Options::default());
    type_in(&mut app, "/kc");
    press(&mut app, &[Enter, Down, Right]);
    assert_eq!(taken.try_iter().collect::<Vec<_>>(), [Edit::Nudge(key("kc"), 0.01)]);
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
fn a_read_only_dashboard_changes_nothing() {
    let (mut app, taken) = dashboard(&Options { read_only: true, ..Options::default() });
    press(&mut app, &[Right, Char('0'), Char('u'), Char('i'), Char('R'), Enter, Char('1'), Enter]);
    type_in(&mut app, ":note x");
    press(&mut app, &[Enter]);
    assert_eq!(taken.try_iter().count(), 0);
    assert!(frame(&mut app).contains("read-only"));
}

#[test]
fn the_speed_is_sent_on_its_way() {
    let (mut app, taken) = dashboard(&Options::default());
    let set =
        |pairs: &[(&str, f64)]| Edit::Set(pairs.iter().map(|(key, value)| (key.parse().unwrap(), *value)).collect());
    // It spins at 2.5.
    for (line, speed, ramp) in [("run-up 2.5..6 0.01", 6.0, 0.01), ("run-up 0 0.02", 0.0, 0.02)] {
        command(&mut app, line);
        assert_eq!(taken.try_iter().collect::<Vec<_>>(), [set(&[("speed", speed), ("ramp", ramp)])]);
    }
    command(&mut app, "run-up 0..6 0.01");
    assert!(taken.is_empty());
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
fn an_alarm_stops_a_run_up_as_configured() {
    use alarms::{Limits, Watch};
    use wire::Channel;
    let mut limits = Limits::none();
    limits.set(Watch::Orbit, Some([1e3, 2e3])).unwrap();
    let alarmed = |on_alarm, rate: f64, read_only| {
        let options = Options { on_alarm, limits: limits.clone(), read_only, ..Options::default() };
        let (mut app, taken) = dashboard(&options);
        let mut step = tests::state(3, 3000).with(Channel::Speed, 0, 2.75).with(Channel::SpeedRate, 0, rate);
        step = step.with(Channel::Y, 1, 1.5e3);
        lock(&app.feed).push_step(&step, Instant::now());
        app.watch_alarms();
        assert!(taken.is_empty(), "a warning stops nothing");
        let step = step.with_word(Channel::Seq, 3001).with(Channel::Y, 1, 3e3);
        lock(&app.feed).push_step(&step, Instant::now());
        app.watch_alarms();
        app.watch_alarms();
        let edits: Vec<Edit> = taken.try_iter().collect();
        let settings = app.settings().unwrap();
        edits
            .into_iter()
            .map(|edit| match edit {
                Edit::Become(change, why) => {
                    assert_eq!(change.0, settings);
                    ([change.1.speed, change.1.ramp], why)
                }
                other => panic!("{other:?}"),
            })
            .collect::<Vec<_>>()
    };
    let before = f64::INFINITY;
    assert_eq!(alarmed(OnAlarm::Hold, 0.01, false), [([2.75, before], "the speed is held: alarm of orbit".to_owned())]);
    let down = "the speed coasts down: alarm of orbit".to_owned();
    assert_eq!(alarmed(OnAlarm::CoastDown, 0.01, false), [([0.0, 0.01], down)]);
    // Nothing to stop, nobody to stop it, or not asked to.
    for (on_alarm, rate, read_only) in [
        (OnAlarm::Hold, 0.0, false),
        (OnAlarm::Hold, -0.01, false),
        (OnAlarm::Hold, 0.01, true),
        (OnAlarm::GoOn, 0.01, false),
    ] {
        assert_eq!(alarmed(on_alarm, rate, read_only), []);
    }
}

#[test]
fn a_key_sends_the_speed_to_rest_as_fast_as_it_rose() {
    use wire::Channel;
    for (rate, ramp) in [(0.01, 0.01), (-0.02, 0.02)] {
        let (mut app, taken) = dashboard(&Options::default());
        let step = tests::state(3, 3000).with(Channel::Speed, 0, 2.75).with(Channel::SpeedRate, 0, rate);
        lock(&app.feed).push_step(&step, Instant::now());
        press(&mut app, &[Char('V')]);
        let edits: Vec<Edit> = taken.try_iter().collect();
        let [Edit::Become(change, why)] = &edits[..] else { panic!("{edits:?}") };
        assert_eq!((change.1.speed, change.1.ramp, &**why), (0.0, ramp, "the speed goes to rest"));
    }
}

fn command(app: &mut App<'_>, line: &str) {
    press(app, &[Char(':')]);
    type_in(app, line);
    press(app, &[Enter]);
}

#[test]
fn the_mode_that_is_pointed_at_is_told_of_beside_its_pole() {
    let (mut app, _) = dashboard(&Options::default());
    command(&mut app, "layout tuning");
    command(&mut app, "choose poles");
    press(&mut app, &[Char('.'), Char('.')]);
    let shown = frame(&mut app);
    let (_, poles) = app.with_view(|view, _, _| view.data.poles().map(|(d, poles)| (d, poles.to_vec()))).unwrap();
    assert_eq!(app.selection.mode, Some(poles[1]));
    assert!(shown.contains(&format!("ζ {:.4}", rotor::damping_ratio(poles[1]))), "{shown}");
    assert!(shown.matches('◈').count() >= 2, "the pole and its label:\n{shown}");
    command(&mut app, "choose damping-over-speed");
    command(&mut app, "read 4");
    let before = app.time;
    press(&mut app, &[Char('+')]);
    assert_eq!(app.time, before, "speeds are zoomed, not time");
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
fn strips_are_what_the_layout_says() {
    let (mut app, _) = dashboard(&Options::default());
    let text = "[[screen]]\nstrips = \"force\"\npicture = \"strips\"";
    app.layouts.push(crate::layout::Layout::read("mine", text).unwrap());
    command(&mut app, "layout mine");
    assert!(frame(&mut app).contains("force "), "{}", frame(&mut app));
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
