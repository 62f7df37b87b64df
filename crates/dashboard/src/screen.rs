//! The screen: a line that says how things stand, the panels of a [`Layout`], a line of hints, and what lies on top.

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Flex, Layout as Split, Position, Rect};
use ratatui::style::Modifier;
use ratatui::text::Line;
use ratatui::widgets::Widget;

use crate::drawing::write;
use crate::layers::Layer;
use crate::layout::{Layout, SMALLEST};
use crate::panels::panel::PanelCommand;
use crate::panels::registry::{PANELS, Panels, rows_needed};
use crate::theme;
use crate::view::{Message, View};
use crate::{help, log, popup, status_line, time_line};

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
        None => status_line::draw_top(view, top, buffer),
        Some(show) => {
            time_line::draw_top(show, view, top, buffer);
            time_line::draw_time(show, line, buffer);
        }
    }
    let (places, strips) = layout.places_and_strips(body);
    panels.command_any(&PanelCommand::StripsOfLayout(strips));
    let over = view.pointer.map(Position::from).filter(|_| view.layers.is_empty());
    let mut told = None;
    for (kind, place) in with_room_for_settings(places, view) {
        panels.draw(kind, view, place, buffer);
        if PANELS[kind].is_of_motion && view.standstill().is_some() {
            dim(place, buffer);
        }
        if view.selection.plot == Some(kind) {
            mark_chosen(place, buffer);
        }
        if let Some(at) = over.filter(|at| place.contains(*at)) {
            told = panels.told_at(kind, view, place, at);
        }
    }
    match told.filter(|_| *view.message == Message::Hints) {
        Some(told) => write(buffer, foot, foot.x + 1, foot.y, &told, theme::loud(theme::CURSOR)),
        None => {
            status_line::draw_foot(view, foot, buffer);
            foot.x
        }
    };
    let title = match view.layers.last() {
        Some(Layer::AskFound(..) | Layer::AskUnstable(..)) => popup::BESIDE,
        _ => popup::COMPLETES,
    };
    popup::draw(title, view.popup, body, buffer);
    let log = view.layers.iter().find_map(|layer| match layer {
        Layer::Log(from) => Some(*from),
        _ => None,
    });
    if let Some(from) = log {
        log::draw(view, from, body, buffer);
    }
    let help = view.layers.iter().find_map(|layer| match layer {
        Layer::Help(from) => Some(*from),
        _ => None,
    });
    if let Some(from) = help {
        help::draw(view, from, area, buffer);
    }
}

/// Takes the colours of a state from what is no longer so.
fn dim(area: Rect, buffer: &mut Buffer) {
    for at in area.positions() {
        if let Some(cell) = buffer.cell_mut(at) {
            cell.set_style(theme::quiet().remove_modifier(Modifier::BOLD | Modifier::REVERSED));
        }
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
    if is_enough {
        with_room_for_settings(layout.places(parts(area, view.replay.is_some())[2]), view)
    } else {
        Vec::new()
    }
}

/// The same places, but the settings take of the panels above and below them in their column the rows that those have nothing for.
fn with_room_for_settings(mut places: Vec<(usize, Rect)>, view: &View<'_>) -> Vec<(usize, Rect)> {
    let Some(&(kind, own)) = places.iter().find(|(kind, _)| PANELS[*kind].name == "settings") else { return places };
    let wanted = rows_needed(kind, view).unwrap_or(0).saturating_sub(own.height);
    // What stands in the same column, from the top.
    let mut column: Vec<usize> =
        (0..places.len()).filter(|at| (places[*at].1.x, places[*at].1.width) == (own.x, own.width)).collect();
    column.sort_by_key(|at| places[*at].1.y);
    let Some(&first) = column.first() else { return places };
    let is_whole = column.windows(2).all(|pair| places[pair[0]].1.bottom() == places[pair[1]].1.y);
    if wanted == 0 || !is_whole {
        return places;
    }
    let (top, mut left) = (places[first].1.y, wanted);
    for at in &column {
        let (kind, place) = &mut places[*at];
        if let Some(needed) = rows_needed(*kind, view).filter(|_| PANELS[*kind].name != "settings") {
            let given = place.height.saturating_sub(needed.max(PANELS[*kind].least.1)).min(left);
            (place.height, left) = (place.height - given, left - given);
        }
    }
    let mut y = top;
    for at in column {
        let (kind, place) = &mut places[at];
        if PANELS[*kind].name == "settings" {
            place.height += wanted - left;
        }
        place.y = y;
        y += place.height;
    }
    places
}

/// The line at the top, the line of time if there is one, the panels, and the line at the foot.
fn parts(area: Rect, has_line_of_time: bool) -> [Rect; 4] {
    let heights = [Constraint::Length(1), Constraint::Length(u16::from(has_line_of_time)), Constraint::Min(0)];
    Split::vertical(heights.into_iter().chain([Constraint::Length(1)])).areas(area)
}

#[cfg(test)]
mod tests {
    use wire::Step;

    use super::*;
    use crate::screenshot::image::text;
    use crate::view::tests::view;
    use telemetry::connection::Connection;
    use telemetry::feed::Feed;
    use telemetry::frame_data::FrameData;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    fn frame(data: &FrameData, width: u16, height: u16, help: bool) -> String {
        frame_of("overview", data, width, height, help)
    }

    fn frame_of(layout: &str, data: &FrameData, width: u16, height: u16, help: bool) -> String {
        let area = Rect::new(0, 0, width, height);
        let mut buffer = Buffer::empty(area);
        let layouts = crate::layout::built_in();
        let layout = layouts.iter().find(|built_in| built_in.name() == layout).unwrap();
        let layers = if help { vec![Layer::Help(0)] } else { Vec::new() };
        draw(&View { layers: &layers, ..view(data) }, layout, &mut Panels::new(), area, &mut buffer);
        text(&buffer)
    }

    #[test]
    fn every_panel_is_on_the_usual_screens() {
        let data = tests::frame_data();
        for (width, height) in [SMALLEST, (80, 24), (200, 60)] {
            let frame = frame(&data, width, height, false);
            for panel in ["poles", "minimum damping", "orbits", "tau", "settings", "force", "RUNNING", "select"] {
                assert!(frame.contains(panel), "{panel} at {width} x {height}:\n{frame}");
            }
        }
        insta::assert_snapshot!("screen_80x24", frame(&data, 80, 24, false));
        insta::assert_snapshot!("screen_120x40", frame(&data, 120, 40, false));
        insta::assert_snapshot!("screen_200x60", frame(&data, 200, 60, false));
        insta::assert_snapshot!("screen_60x16", frame(&data, 60, 16, false));
    }

    #[test]
    fn every_layout_has_its_screen() {
        let data = tests::frame_data();
        for layout in crate::layout::built_in() {
            for (width, height) in [SMALLEST, (80, 24), (120, 40), (200, 60)] {
                let name = format!("{}_{width}x{height}", layout.name());
                if layout.name() != "overview" {
                    insta::assert_snapshot!(name, frame_of(layout.name(), &data, width, height, false));
                }
            }
        }
    }

    /// A bench on which every number is long, and things have happened.
    fn long_numbers(scales: Option<rotor::Scales>) -> (FrameData, alarms::Alarms) {
        let now = std::time::Instant::now();
        let mut feed = Feed::new("");
        let mut bench_status = tests::bench_status("three-mass", "composite");
        bench_status.scales = scales.map_or([0.0; 4], |s| [s.w0, s.k_t, s.m_t, s.e_t]);
        let mut settings = bench_status.settings.get().clone();
        for (key, value) in [
            ("speed", 2.345_678_901_234),
            ("kd", -0.587_912_345_678),
            ("cd", 0.494_812_345_678),
            ("trip", 1_234.567_890_123),
            ("deadband.2", 1.234_567_890_123),
        ] {
            settings.set(key.parse().unwrap(), value).unwrap();
        }
        bench_status.settings = wire::SettingsDocument::of(&settings);
        (bench_status.health.steps, bench_status.health.missed) = (123_456_789, 12_345);
        (bench_status.health.lateness_p50_us, bench_status.health.lateness_p99_us) = (12_345.0, 123_456.0);
        feed.push_bench_status(bench_status);
        for seq in 0..17_000_u64 {
            let mut state = tests::state(3, seq);
            for mass in 0..3 {
                let wire::Point { y, z, .. } = state.point(mass);
                let (y, z, vy, vz) = (-1.494_96 * y, -1.494_96 * z, -12.345_678, -0.001_234_567);
                state = state.with_point(mass, wire::Point { y, z, vy, vz });
            }
            let (tau, angle) = (state.tau() + 12_345.678, state.angle() + 123_456.789);
            feed.push_step(&state.with(wire::Channel::Tau, 0, tau).with(wire::Channel::Angle, 0, angle), now);
        }
        let trip = wire::message::Trip { cause: 1, mass: 2, step: 9, radius: 1_234.567_891, limit: 1_000.123_456 };
        let impulse = wire::Happening::Impulse { mass: 1, velocity: rotor::C64::new(-2.512_345_678, 0.25) };
        for (number, happening) in (1..).zip([wire::Happening::Started, impulse, wire::Happening::Tripped(trip)]) {
            feed.push_event(&telemetry::test_support::event(number, &happening, &settings));
        }
        let mut alarms = alarms::Alarms::default();
        let at = wire::Moment { wall_ns: 50_607_000_000_000, ..wire::Moment::default() };
        let cause = trip.told(scales);
        alarms.read(&alarms::Reading::new(at).with(alarms::Watch::Damping, -0.030_612_345).tripped(&cause));
        (feed.frame_data(&ViewTime::LIVE, now), alarms)
    }

    /// What has a digit in it between blanks and lines.
    fn numbers(text: &str) -> Vec<&str> {
        let is_part = |letter: char| letter.is_alphanumeric() || "._+-±=:/²".contains(letter);
        text.split(|letter| !is_part(letter)).filter(|word| word.contains(|c: char| c.is_ascii_digit())).collect()
    }

    #[test]
    fn no_number_on_any_screen_is_a_part_of_another_or_touches_one() {
        let long =
            "kd.1 -0.5879123 -> 0.2512345, cd.1 0.4948123 -> 0.1234567, from step 1234567890, made by dash:812345";
        let message = crate::view::Message::Good(long.to_owned());
        let mut wrong = Vec::new();
        for scales in [None, Some(telemetry::test_support::SI)] {
            let (data, alarms) = long_numbers(scales);
            for (layout, (width, height)) in crate::layout::built_in()
                .into_iter()
                .flat_map(|layout| [(60, 16), (80, 24), (120, 40), (200, 60)].map(|size| (layout.clone(), size)))
            {
                let area = Rect::new(0, 0, width, height);
                let mut buffer = Buffer::empty(area);
                let mut panels = Panels::new();
                crate::drawing::tests::written();
                let seen = View { alarms: &alarms, message: &message, ..view(&data) };
                draw(&seen, &layout, &mut panels, area, &mut buffer);
                let told = crate::drawing::tests::written();
                let frame = text(&buffer);
                let place = format!("{} at {width} x {height}", layout.name());
                for (y, row) in frame.lines().enumerate() {
                    let told = told.iter().filter(|(at, _)| usize::from(*at) == y);
                    let whole: Vec<&str> = told.flat_map(|(_, text)| numbers(text)).collect();
                    let parts = numbers(row).into_iter().filter(|number| !whole.contains(number));
                    wrong.extend(parts.map(|number| format!("'{number}' in {place}, told {whole:?}:\n{row}")));
                }
                // A rotor in SI units is told in them, wherever.
                let others = ["e_t", "w0", "R 2.3", "R = "].into_iter().filter(|_| scales.is_some());
                for unit in others.filter(|unit| frame.contains(unit)) {
                    wrong.push(format!("'{unit}' in {place}:\n{frame}"));
                }
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    /// The cells of a frame that are in a colour of the state.
    fn state_colours(data: &FrameData) -> (Vec<ratatui::style::Color>, String) {
        let area = Rect::new(0, 0, 120, 40);
        let mut buffer = Buffer::empty(area);
        draw(&view(data), &crate::layout::built_in()[0], &mut Panels::new(), area, &mut buffer);
        let of_panels = buffer.content[120..39 * 120].iter().map(|cell| cell.fg);
        let is_state = |color: &ratatui::style::Color| [theme::GOOD, theme::WARN, theme::BAD].contains(color);
        (of_panels.filter(is_state).collect(), text(&buffer))
    }

    #[test]
    fn a_machine_that_is_gone_or_tripped_is_dim_and_not_called_stable() {
        let data = tests::frame_data();
        let (colours, frame) = state_colours(&data);
        assert!(colours.contains(&theme::GOOD) && frame.contains(" stable "), "{frame}");
        let gone = FrameData { connection: Connection::Gone, ..tests::frame_data() };
        let tripped = FrameData { tripped: true, ..tests::frame_data() };
        for (data, word) in [(gone, "gone"), (tripped, "tripped")] {
            let (colours, frame) = state_colours(&data);
            assert!(colours.is_empty() && frame.contains(word), "{colours:?}\n{frame}");
        }
    }

    #[test]
    fn a_small_screen_says_what_it_needs_on_one_line() {
        let data = tests::frame_data();
        for (width, height) in [(59, 16), (60, 15), (50, 3)] {
            let frame = frame(&data, width, height, true);
            let said: Vec<&str> = frame.lines().filter(|line| !line.is_empty()).collect();
            assert_eq!(said.len(), 1);
            assert!(said[0].contains(&format!("needs 60 x 16 (is {width} x {height}), q quits")), "{frame}");
        }
    }

    #[test]
    fn no_size_and_no_state_of_the_feed_breaks_a_frame() {
        let waiting = Feed::new("waiting for bench 'x'").frame_data(&ViewTime::LIVE, std::time::Instant::now());
        let mut gone = tests::frame_data();
        gone.connection = Connection::Gone;
        for data in [&waiting, &gone, &tests::frame_data()] {
            for (width, height) in
                [(0, 0), (0, 5), (5, 0), (1, 1), (3, 2), (60, 16), (61, 17), (80, 24), (500, 10), (60, 200)]
            {
                frame(data, width, height, false);
                frame(data, width, height, true);
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
            let mut bench_status = tests::bench_status("jeffcott", "cancel");
            bench_status.set_rotor(&rotor);
            let settings = rotor::Settings::new(&rotor, 1.0, rotor::builtin::feedback(&rotor, "off").unwrap());
            bench_status.settings = wire::SettingsDocument::of(&settings);
            feed.push_bench_status(bench_status);
            (0..300).for_each(|seq| feed.push_step(&tests::state(masses, seq), now));
            let drawn = frame(&feed.frame_data(&ViewTime::LIVE, now), 160, 50, false);
            assert!(drawn.contains(&format!("{masses}")) && drawn.contains("orbits"), "{drawn}");
        }
    }
}
