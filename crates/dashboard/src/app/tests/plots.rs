//! What is pointed at in a plot, and which strips there are.

use super::*;

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
fn strips_are_what_the_layout_says() {
    let (mut app, _) = dashboard(&Options::default());
    let text = "[[screen]]\nstrips = \"force\"\npicture = \"strips\"";
    app.layouts.push(crate::layout::Layout::read("mine", text).unwrap());
    command(&mut app, "layout mine");
    assert!(frame(&mut app).contains("force "), "{}", frame(&mut app));
}
