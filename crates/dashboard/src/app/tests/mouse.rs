//! The mouse: what it selects, nudges, zooms, scrolls and goes to.

use crossterm::event::{MouseButton, MouseEvent, MouseEventKind};

use super::*;

#[test]
fn lists_scroll_by_key_and_wheel() {
    let (mut app, _taken) = dashboard(&Options::default());
    let settings = tests::bench_status("three-mass", "composite").settings.get().clone();
    for number in 1..=90 {
        let note = wire::Happening::Note(format!("no. {number}."));
        lock(&app.feed).push_event(&telemetry::test_support::event(number, &note, &settings));
    }
    app.layout = 5;
    assert!(frame(&mut app).contains("no. 90."));
    press(&mut app, &[KeyCode::PageDown]);
    let shown = frame(&mut app);
    assert!(!shown.contains("no. 86.") && shown.contains("no. 85.") && shown.contains("5 more ▲"), "{shown}");
    press(&mut app, &[KeyCode::PageUp, KeyCode::PageUp]);
    assert!(frame(&mut app).contains("no. 90."));
    let shown = frame(&mut app);
    let row = shown.lines().position(|line| line.contains("no. 88.")).unwrap() as u16;
    app.mouse(MouseEvent { kind: MouseEventKind::ScrollDown, column: 5, row, modifiers: KeyModifiers::NONE });
    assert!(frame(&mut app).contains("3 more ▲"));
}

#[test]
fn the_mouse_selects_nudges_and_zooms() {
    let (mut app, taken) = dashboard(&Options::default());
    let shown = frame(&mut app);
    let (row, line) = shown.lines().enumerate().find(|(_, line)| line.contains("  kd ")).unwrap();
    let column = line.chars().collect::<Vec<_>>().windows(4).position(|four| four == [' ', 'k', 'd', ' ']).unwrap();
    let event = |kind, column: usize, row: usize| MouseEvent {
        kind,
        column: column as u16,
        row: row as u16,
        modifiers: KeyModifiers::NONE,
    };
    app.mouse(event(MouseEventKind::Down(MouseButton::Left), column, row));
    assert_eq!(app.row, 3);
    app.mouse(event(MouseEventKind::Drag(MouseButton::Left), column + 2, row));
    assert_eq!(taken.try_iter().collect::<Vec<_>>(), [Edit::Nudge(key("kd"), 0.02)]);
    app.mouse(event(MouseEventKind::Up(MouseButton::Left), column + 2, row));
    app.mouse(event(MouseEventKind::ScrollUp, column, row));
    assert_eq!(app.row, 2);
    let (row, line) = shown.lines().enumerate().find(|(_, line)| line.contains("│z")).unwrap();
    let column = line.chars().position(|c| c == 'z').unwrap() + 10;
    let before = app.time;
    app.mouse(event(MouseEventKind::ScrollUp, column, row));
    assert_ne!(app.time, before);
    app.mouse(event(MouseEventKind::Down(MouseButton::Left), column, row));
    assert!(!app.time.is_live());
}

/// Clicks on the first place of the frame where `text` stands, or so many cells further right and down.
fn click(app: &mut App<'_>, text: &str, (right, down): (u16, u16)) {
    let shown = frame(app);
    let (row, line) = shown.lines().enumerate().find(|(_, line)| line.contains(text)).expect(text);
    let column = line[..line.find(text).unwrap()].chars().count() as u16;
    let kind = MouseEventKind::Down(MouseButton::Left);
    app.mouse(MouseEvent { kind, column: column + right, row: row as u16 + down, modifiers: KeyModifiers::NONE });
}

#[test]
fn plots_are_chosen_by_a_click_and_around_the_screen_and_back() {
    let (mut app, _) = dashboard(&Options::default());
    click(&mut app, " orbits ", (0, 2));
    assert!(frame(&mut app).contains("┏ orbits  ±4.0 e_t  ◉"), "{}", frame(&mut app));
    let mut seen = Vec::new();
    for _ in 0..6 {
        press(&mut app, &[Tab]);
        seen.push(app.selection.plot.unwrap());
    }
    let around = seen[1..].iter().position(|plot| *plot == seen[0]).unwrap() + 1;
    assert!(around >= 5, "{seen:?}");
    app.press(KeyEvent::new(KeyCode::BackTab, KeyModifiers::SHIFT));
    assert_eq!(app.selection.plot, Some(seen[4]));
}

#[test]
fn a_click_on_an_event_or_an_alarm_goes_to_its_time_and_acknowledges() {
    let (mut app, _) = dashboard(&Options::default());
    {
        let mut feed = lock(&app.feed);
        let settings = feed.settings().unwrap();
        (3000..6000).for_each(|seq| {
            // The event below is at 50 602 s.
            let wall_ns = 50_600_000_000_000 + (seq - 3000) * 1_000_000;
            feed.push_step(&tests::state(3, seq).with_word(wire::Channel::WallNs, wall_ns), Instant::now());
        });
        let note = wire::Happening::Note("here it hums".into());
        feed.push_event(&telemetry::test_support::event(2, &note, &settings));
    }
    app.layouts
        .push(crate::layout::Layout::read("mine", "[[screen]]\npicture = \"\"\"\nevents\nalarms\n\"\"\"").unwrap());
    command(&mut app, "layout mine");
    click(&mut app, "here it hums", (0, 0));
    assert!(!app.time.is_live());
    let at = app.with_view(|view, _, _| view.data.now.map(|now| view.data.track.wall_ns(now)));
    assert_eq!(at, Some(50_602_000_000_000));
    press(&mut app, &[Char(' ')]);
    app.alarms.read(&crate::panels::alarms::tests::damping(50_601, -0.03));
    click(&mut app, "!! ALARM  damping", (0, 0));
    assert_eq!(app.alarms.unseen(), 0);
    click(&mut app, "!! ALARM  damping", (0, 0));
    let at = app.with_view(|view, _, _| view.data.now.map(|now| view.data.track.wall_ns(now)));
    assert_eq!(at, Some(50_601_000_000_000));
}

#[test]
fn what_the_mouse_is_over_is_told_at_the_foot_until_a_key_is_pressed() {
    let (mut app, taken) = dashboard(&Options::default());
    app.layout = 2;
    let shown = frame(&mut app);
    let over = |words: &str| {
        let (row, line) = shown.lines().enumerate().find(|(_, line)| line.contains(words)).unwrap();
        let column = line.chars().collect::<String>().find(words).map(|byte| line[..byte].chars().count()).unwrap();
        MouseEvent {
            kind: MouseEventKind::Moved,
            column: column as u16 + 6,
            row: row as u16 + 3,
            modifiers: KeyModifiers::NONE,
        }
    };
    app.mouse(over("damping  stable"));
    let foot = |app: &mut App<'_>| frame(app).lines().last().unwrap().to_owned();
    assert!(foot(&mut app).contains("minimum damping 0."), "{}", foot(&mut app));
    app.mouse(over("poles ▲forward"));
    assert!(foot(&mut app).contains("ζ "), "{}", foot(&mut app));
    press(&mut app, &[KeyCode::Down]);
    assert!(foot(&mut app).contains("help"), "{}", foot(&mut app));
    assert!(taken.is_empty(), "looking changes nothing");
}
