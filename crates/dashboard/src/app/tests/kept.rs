//! What is kept in files: gains by name, and pictures of the screen.

use super::*;

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
