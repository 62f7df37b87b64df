//! The screen: which panel where.
//!
//! ```text
//!  RUNNING  default  three-mass  R 2.5 ...
//! ┌ poles ─────────┐┌ orbits ───────────┐┌ settings ──────┐
//! │                ││                   ││                │
//! ├ min damping ───┤├ y z u ────────────┤├ control force ─┤
//! └────────────────┘└───────────────────┘└────────────────┘
//!  up down select  left right nudge  0 off ...
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Flex, Layout, Rect};
use ratatui::text::Line;
use ratatui::widgets::Widget;

use crate::panels::settings::Cursor;
use crate::panels::status::Message;
use crate::panels::{damping, force, help, orbits, poles, settings, status, strips};
use crate::picture::Picture;
use crate::theme;
use crate::view_time::ViewTime;

/// The smallest screen that the panels fit on.
pub(crate) const SMALLEST: (u16, u16) = (60, 16);

/// All that a frame shows.
#[derive(Debug)]
pub(crate) struct View<'a> {
    pub(crate) picture: &'a Picture,
    pub(crate) time: &'a ViewTime,
    pub(crate) bench: &'a str,
    pub(crate) cursor: &'a Cursor,
    pub(crate) message: &'a Message,
    pub(crate) help: bool,
}

/// Draws everything.
pub(crate) fn draw(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    if area.width < SMALLEST.0 || area.height < SMALLEST.1 {
        let (width, height) = SMALLEST;
        let needed = format!("needs {width} x {height} (is {} x {}), q quits", area.width, area.height);
        let [middle] = Layout::vertical([Constraint::Length(1)]).flex(Flex::Center).areas(area);
        // The size comes first and is the last thing to be cut off.
        let line = Line::styled(needed, theme::loud(theme::WARN));
        let line = if line.width() <= usize::from(area.width) { line.centered() } else { line };
        line.render(middle, buffer);
        return;
    }
    let [top, body, foot] =
        Layout::vertical([Constraint::Length(1), Constraint::Min(0), Constraint::Length(1)]).areas(area);
    let side = |percent: u16, least: u16, most: u16| (area.width * percent / 100).clamp(least, most);
    let [left, middle, right] = Layout::horizontal([
        Constraint::Length(side(31, 22, 64)),
        Constraint::Min(0),
        // From 80 columns on, wide enough for the steps of the settings.
        Constraint::Length(side(24, if area.width < 80 { 20 } else { 28 }, 40)),
    ])
    .areas(body);
    let [upper_left, lower_left] =
        Layout::vertical([Constraint::Min(0), Constraint::Length((body.height * 2 / 5).clamp(6, 14))]).areas(left);
    let [upper_middle, lower_middle] = Layout::vertical([Constraint::Fill(3), Constraint::Fill(2)]).areas(middle);
    let [upper_right, lower_right] = Layout::vertical([Constraint::Min(0), Constraint::Length(4)]).areas(right);

    status::draw_top(view, top, buffer);
    poles::draw(view, upper_left, buffer);
    damping::draw(view, lower_left, buffer);
    orbits::draw(view, upper_middle, buffer);
    strips::draw(view, lower_middle, buffer);
    settings::draw(view, upper_right, buffer);
    force::draw(view, lower_right, buffer);
    status::draw_foot(view.message, foot, buffer);
    if view.help {
        help::draw(area, buffer);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::feed::{Contact, Feed, tests};
    use crate::panels::tests::text;

    static CURSOR: Cursor = Cursor { row: 0, typed: None };
    static HINTS: Message = Message::Hints;
    static LIVE: ViewTime = ViewTime::LIVE;

    /// A view of `picture` by somebody who has pressed nothing yet.
    pub(crate) fn view(picture: &Picture) -> View<'_> {
        View { picture, time: &LIVE, bench: "default", cursor: &CURSOR, message: &HINTS, help: false }
    }

    fn frame(picture: &Picture, width: u16, height: u16, help: bool) -> String {
        let area = Rect::new(0, 0, width, height);
        let mut buffer = Buffer::empty(area);
        draw(&View { help, ..view(picture) }, area, &mut buffer);
        text(&buffer)
    }

    #[test]
    fn every_panel_is_on_the_usual_screens() {
        let picture = tests::picture();
        for (width, height) in [SMALLEST, (80, 24), (200, 60)] {
            let frame = frame(&picture, width, height, false);
            for panel in ["poles", "minimum damping", "orbits", "tau", "settings", "control force", "RUNNING", "select"]
            {
                assert!(frame.contains(panel), "{panel} at {width} x {height}:\n{frame}");
            }
        }
        insta::assert_snapshot!("screen_80x24", frame(&picture, 80, 24, false));
        insta::assert_snapshot!("screen_200x60", frame(&picture, 200, 60, false));
        insta::assert_snapshot!("screen_60x16", frame(&picture, 60, 16, false));
    }

    #[test]
    fn a_small_screen_says_what_it_needs_on_one_line() {
        let picture = tests::picture();
        for (width, height) in [(59, 16), (60, 15), (50, 3)] {
            let frame = frame(&picture, width, height, true);
            let said: Vec<&str> = frame.lines().filter(|line| !line.is_empty()).collect();
            assert_eq!(said.len(), 1);
            assert!(said[0].contains(&format!("needs 60 x 16 (is {width} x {height}), q quits")), "{frame}");
        }
    }

    #[test]
    fn no_size_and_no_state_of_the_feed_breaks_a_frame() {
        let waiting = Feed::new("waiting for bench 'x'").picture(&ViewTime::LIVE, std::time::Instant::now());
        let mut gone = tests::picture();
        gone.contact = Contact::Gone;
        for picture in [&waiting, &gone, &tests::picture()] {
            for (width, height) in
                [(0, 0), (0, 5), (5, 0), (1, 1), (3, 2), (60, 16), (61, 17), (80, 24), (500, 10), (60, 200)]
            {
                frame(picture, width, height, false);
                frame(picture, width, height, true);
            }
        }
        assert!(frame(&waiting, 80, 24, false).contains("waiting for bench 'x'"));
        assert!(frame(&gone, 80, 24, false).contains("SIMULATION GONE"));
    }

    #[test]
    fn rotors_of_every_size_have_a_screen() {
        let now = std::time::Instant::now();
        for masses in 1..=16 {
            let mut feed = Feed::new("");
            let rotor = rotor::Rotor::new(
                "chain",
                vec![rotor::Mass { mass: 1.0, bearing_stiffness: 0.5, ..rotor::Mass::default() }; masses],
                vec![1.0; masses - 1],
            )
            .unwrap();
            let mut bulletin = tests::bulletin("jeffcott", "cancel");
            bulletin.set_rotor(&rotor);
            let settings = rotor::Settings::new(&rotor, 1.0, rotor::builtin::feedback(&rotor, "off").unwrap());
            bulletin.settings = wire::SettingsMessage::pack(&settings).unwrap();
            feed.read(bulletin);
            (0..300).for_each(|seq| feed.hear(&tests::state(masses, seq), now));
            let drawn = frame(&feed.picture(&ViewTime::LIVE, now), 160, 50, false);
            assert!(drawn.contains(&format!("{masses}")) && drawn.contains("orbits"), "{drawn}");
        }
    }
}
