//! The screen: a line that says how things stand, the panels of a [`Layout`], a line of hints, and what lies on top.

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Flex, Layout as Split, Rect};
use ratatui::text::Line;
use ratatui::widgets::Widget;

use crate::layers::Layer;
use crate::layout::{Layout, SMALLEST};
use crate::panels::offers;
use crate::panels::panel::Wish;
use crate::panels::registry::Panels;
use crate::panels::{help, status, time_line};
use crate::theme;
use crate::view::View;

/// Draws everything.
pub(crate) fn draw(view: &View<'_>, layout: &Layout, panels: &mut Panels, area: Rect, buffer: &mut Buffer) {
    if area.width < SMALLEST.0 || area.height < SMALLEST.1 {
        let (width, height) = SMALLEST;
        let needed = format!("needs {width} x {height} (is {} x {}), q quits", area.width, area.height);
        let [middle] = Split::vertical([Constraint::Length(1)]).flex(Flex::Center).areas(area);
        // The size comes first and is the last thing to be cut off.
        let line = Line::styled(needed, theme::loud(theme::WARN));
        let line = if line.width() <= usize::from(area.width) { line.centered() } else { line };
        line.render(middle, buffer);
        return;
    }
    let [top, line, body, foot] = parts(area, view.replay.is_some());
    match &view.replay {
        None => status::draw_top(view, top, buffer),
        Some(show) => {
            time_line::draw_top(show, view, top, buffer);
            time_line::draw_time(show, line, buffer);
        }
    }
    let (places, strips) = layout.places_and_strips(body);
    panels.wish_any(&Wish::StripsOfLayout(strips));
    for (kind, place) in places {
        panels.draw(kind, view, place, buffer);
        if view.pointed.plot == Some(kind) {
            mark_chosen(place, buffer);
        }
    }
    status::draw_foot(view, foot, buffer);
    offers::draw(view.offers, body, buffer);
    let help = view.layers.iter().find_map(|layer| match layer {
        Layer::Help(from) => Some(*from),
        _ => None,
    });
    if let Some(from) = help {
        help::draw(view, from, area, buffer);
    }
}

/// Thin lines of a frame, and the thick ones of a chosen plot's.
const THICK: [(&str, &str); 6] = [("┌", "┏"), ("┐", "┓"), ("└", "┗"), ("┘", "┛"), ("─", "━"), ("│", "┃")];

/// Makes the frame around `area` that of the chosen plot; what is written on it stays.
fn mark_chosen(area: Rect, buffer: &mut Buffer) {
    let (last_column, last_row) = (area.right().saturating_sub(1), area.bottom().saturating_sub(1));
    let edges = |x: &u16, y: &u16| *x == area.x || *x == last_column || *y == area.y || *y == last_row;
    let cells = (area.top()..area.bottom()).flat_map(|y| (area.left()..area.right()).map(move |x| (x, y)));
    for (x, y) in cells.filter(|(x, y)| edges(x, y)) {
        let Some(cell) = buffer.cell_mut((x, y)) else { continue };
        if let Some((_, thick)) = THICK.iter().find(|(thin, _)| *thin == cell.symbol()) {
            cell.set_symbol(thick).set_style(theme::loud(theme::CURSOR));
        }
    }
}

/// Where the panels are on a screen of this size; nowhere if it is too small for them.
pub(crate) fn panels(view: &View<'_>, layout: &Layout, area: Rect) -> Vec<(usize, Rect)> {
    let is_enough = area.width >= SMALLEST.0 && area.height >= SMALLEST.1;
    if is_enough { layout.places(parts(area, view.replay.is_some())[2]) } else { Vec::new() }
}

/// The line at the top, the line of time if there is one, the panels, and the line at the foot.
fn parts(area: Rect, has_line_of_time: bool) -> [Rect; 4] {
    let heights = [Constraint::Length(1), Constraint::Length(u16::from(has_line_of_time)), Constraint::Min(0)];
    Split::vertical(heights.into_iter().chain([Constraint::Length(1)])).areas(area)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::feed::{Feed, tests};
    use crate::looks::still::text;
    use crate::picture::Picture;
    use crate::view::tests::view;
    use crate::view_time::ViewTime;

    fn frame(picture: &Picture, width: u16, height: u16, help: bool) -> String {
        frame_of("overview", picture, width, height, help)
    }

    fn frame_of(layout: &str, picture: &Picture, width: u16, height: u16, help: bool) -> String {
        let area = Rect::new(0, 0, width, height);
        let mut buffer = Buffer::empty(area);
        let layouts = crate::layout::built_in();
        let layout = layouts.iter().find(|built_in| built_in.name() == layout).unwrap();
        let layers = if help { vec![Layer::Help(0)] } else { Vec::new() };
        draw(&View { layers: &layers, ..view(picture) }, layout, &mut Panels::new(), area, &mut buffer);
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
        insta::assert_snapshot!("screen_120x40", frame(&picture, 120, 40, false));
        insta::assert_snapshot!("screen_200x60", frame(&picture, 200, 60, false));
        insta::assert_snapshot!("screen_60x16", frame(&picture, 60, 16, false));
    }

    #[test]
    fn every_layout_has_its_screen() {
        let picture = tests::picture();
        for layout in crate::layout::built_in() {
            for (width, height) in [SMALLEST, (80, 24), (120, 40), (200, 60)] {
                let name = format!("{}_{width}x{height}", layout.name());
                if layout.name() != "overview" {
                    insta::assert_snapshot!(name, frame_of(layout.name(), &picture, width, height, false));
                }
            }
        }
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
