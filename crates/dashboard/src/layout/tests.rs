use super::*;
use crate::layout::SMALLEST;

fn wrong(text: &str) -> String {
    Layout::read("x", text).unwrap_err().to_string()
}

#[test]
fn every_built_in_layout_is_whole_at_every_size() {
    for (name, text) in BUILT_IN {
        let layout = Layout::read(name, text).unwrap_or_else(|faults| panic!("{}", faults.in_file(name)));
        assert!(!layout.about().is_empty());
        for (width, height) in [SMALLEST, (80, 24), (100, 30), (140, 45), (200, 60), (400, 100), (61, 90), (300, 17)] {
            let area = Rect::new(0, 1, width, height - 2);
            let placed = layout.places(area);
            assert!(fits(&placed), "{name} at {width} x {height}: {placed:?}");
            let cells: u32 = placed.iter().map(|(_, area)| area.area()).sum();
            assert_eq!(cells, area.area(), "{name} at {width} x {height} leaves a hole");
            for (at, (_, a)) in placed.iter().enumerate() {
                assert!(placed[at + 1..].iter().all(|(_, b)| !a.intersects(*b)), "{name}: overlap");
            }
        }
        for size in [(0, 0), (1, 1), (7, 0)] {
            layout.places(Rect::new(0, 0, size.0, size.1));
        }
    }
}

/// Speed, trip, deadband and the four gains, in their frame.
const ROOM_FOR_GAINS: u16 = 9;

#[test]
fn the_gains_are_on_every_layout_at_every_usual_size() {
    for layout in built_in() {
        for (width, height) in [(200, 60), (120, 40), (80, 24), SMALLEST] {
            // A recording has a line of time more.
            let lines = if layout.name() == "replay" { 3 } else { 2 };
            let placed = layout.places(Rect::new(0, 1, width, height - lines));
            let settings = placed.iter().find(|(kind, _)| PANELS[*kind].name == "settings");
            let has_room = settings.is_some_and(|(_, area)| area.height >= ROOM_FOR_GAINS);
            assert!(has_room, "{} at {width} x {height}: {placed:?}", layout.name());
        }
    }
}

#[test]
fn small_terminals_get_a_later_screen() {
    let layout = Layout::read(BUILT_IN[1].0, BUILT_IN[1].1).unwrap();
    let sizes = layout.sizes();
    assert!(sizes.windows(2).all(|pair| pair[0].0 >= pair[1].0), "{sizes:?}");
    assert!(layout.panels(200, 60).contains(&"strips"));
    assert!(!layout.panels(60, 16).contains(&"strips"));
}

#[test]
fn regress_which_screen_is_shown_does_not_change_from_one_frame_to_the_next() {
    // Cells that are asked for and not there came out one way or another, and with them the screen.
    for layout in built_in() {
        for (width, height) in [(60, 16), (80, 24), (100, 30), (120, 40), (140, 42), (200, 60)] {
            let area = Rect::new(0, 1, width, height - 2);
            let first = layout.places(area);
            assert!((0..20).all(|_| layout.places(area) == first), "{} at {width} x {height}", layout.name());
        }
    }
}

#[test]
fn a_block_of_words_is_a_panel() {
    let text = "about = 'x'\n[[screen]]\ncolumns = '1 =20'\npicture = '''\npoles .\npoles force\n'''";
    let layout = Layout::read("mine", text).unwrap();
    let placed = layout.places(Rect::new(0, 0, 100, 20));
    let named: Vec<_> = placed.into_iter().map(|(kind, area)| (PANELS[kind].name, area)).collect();
    assert_eq!(named, [("poles", Rect::new(0, 0, 80, 20)), ("force", Rect::new(80, 10, 20, 10))]);
    assert_eq!((layout.name(), layout.about()), ("mine", "x"));
}

#[test]
fn faults_name_line_and_column() {
    for (text, fault) in [
        ("", "1:1: no screen: expected [[screen]] with a picture"),
        ("about = 3", "1:9: about = 3: expected a text in quotes"),
        ("colour = 1\n[[screen]]\npicture = 'poles'", "1:1: unknown key 'colour': expected one of about, screen"),
        ("[[screen]]\nrows = '1'", "1:1: a screen without a picture: expected picture = \"\"\" ... \"\"\""),
        ("[[screen]]\npicture = '''\npoles force\npoles\n'''", "4:1: 1 words: expected 2, as in the line above"),
        (
            "[[screen]]\npicture = '''\npoles\nforce\npoles\n'''",
            "5:1: 'poles' again: expected one rectangle of a panel's name",
        ),
        (
            "[[screen]]\npicture = '''\npoles poles\npoles force\n'''",
            "4:7: 'force' within 'poles': expected one rectangle of a panel's name",
        ),
        (
            "[[screen]]\ncolumns = '1 x'\npicture = 'poles force'",
            "2:14: 'x': expected a share from 1 to 1000, or =CELLS",
        ),
        (
            "[[screen]]\ncolumns = '1'\npicture = 'poles force'",
            "2:11: 1 sizes: expected one for each of the 2 words of a line",
        ),
        (
            "[[screen]]\nstrips = 'y y.1+speed'\npicture = 'strips'",
            "2:13: 'y.1+speed': expected series of one unit, and speed has another",
        ),
        ("[[screen]]\nstrips = 'y u y'\npicture = 'strips'", "2:15: 'y' again: expected each strip once"),
        (
            "[[screen]]\nstrips = 'y'\npicture = 'poles'",
            "2:10: strips = 'y': expected a screen with strips in its picture, or no word of what they show",
        ),
        (
            "[[screen]]\npicture = 'poles'\n[[screen]]\npicture = 'poles'",
            "3:1: screen 2 is never shown: expected one for smaller terminals: screen 1 fits wherever it does",
        ),
        ("[[screen]]\nstrips = 3\npicture = 'strips'", "2:10: strips = 3: expected words in quotes"),
    ] {
        assert_eq!(wrong(text), fault, "{text}");
    }
    assert!(
        wrong("[[screen]]\nstrips = 'y foo'\npicture = 'strips'")
            .starts_with("2:13: 'foo': expected tau, angle, speed")
    );
    assert!(wrong("[[screen]]\npicture = 'pole'").starts_with("2:12: no panel 'pole': expected one of poles, damping"));
    assert!(
        wrong("[[screen]]\ncolumns = '1 1 1 1'\npicture = 'poles force orbits settings'")
            .contains("the last screen needs a terminal of")
    );
    assert_eq!(wrong("[[screen]\n"), "1:10: unclosed array table: expected `]`");
}

#[test]
fn every_panel_is_in_a_built_in_layout() {
    for (at, kind) in PANELS.iter().enumerate() {
        let large = Rect::new(0, 0, 200, 58);
        let is_shown = built_in().iter().any(|layout| layout.places(large).iter().any(|(shown, _)| *shown == at));
        assert!(is_shown, "no layout shows {}", kind.name);
    }
}
