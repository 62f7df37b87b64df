//! The help screen: every key, from the one table of keys, and the signs that the panels use.

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Clear, Paragraph, Widget};
use rotor::PARAMETERS;

use crate::actions::{ACTIONS, MOUSE};
use crate::fit_text::{cut_line, padded};
use crate::list::passes;
use crate::theme;
use crate::view::View;

/// Signs whose meaning the panels do not spell out.
const SIGNS: [(&str, &str); 12] = [
    ("▲ ▼", "poles of forward and backward whirl"),
    ("◆", "the least damped mode; right of the upright line through 0 it grows"),
    ("◇", "where the poles would be with what is being typed"),
    ("◈", "the mode that is pointed at"),
    ("┆", "the frequency or the speed that is pointed at"),
    ("fixed, =", "a scale that stands still"),
    ("ζ 0.05 .. 0.5", "rays of equal damping ratio"),
    ("●", "where a mass was when the rotor had made another turn"),
    ("⊕", "the mass that carries the control bearing"),
    ("thin circle", "clearance of the support bearing"),
    ("✗ ! ▼ ◇ ↑", "recording: a trip, an alarm, a note, a change, an impulse or a restart"),
    ("░ ━ █ ◆", "recording: missing steps, the loop, the moment, where what-if begins"),
];

/// Draws it over `area`, from line `from` on.
pub(crate) fn draw(view: &View<'_>, from: usize, area: Rect, buffer: &mut Buffer) {
    let matches = |line: &Line<'_>| passes(view.filter, &line.to_string());
    let lines: Vec<Line<'_>> = lines(view).into_iter().filter(matches).collect();
    let count = lines.len();
    let height = (count as u16 + 2).min(area.height);
    let width = 104.min(area.width);
    let [middle] = Layout::horizontal([Constraint::Length(width)]).flex(ratatui::layout::Flex::Center).areas(area);
    let [middle] = Layout::vertical([Constraint::Length(height)]).flex(ratatui::layout::Flex::Center).areas(middle);
    Clear.render(middle, buffer);
    let shown = usize::from(height.saturating_sub(2));
    let from = from.min(count.saturating_sub(shown));
    let more = if from + shown < count { ", up and down move it" } else { "" };
    let block = Block::bordered().title(format!(" help: ? or esc closes it, / filters it{more} "));
    let room = usize::from(width.saturating_sub(2));
    Paragraph::new(lines.into_iter().skip(from).map(|line| cut_line(line, room)).collect::<Vec<_>>())
        .block(block)
        .render(middle, buffer);
}

fn lines<'a>(view: &'a View<'_>) -> Vec<Line<'a>> {
    let row = |key: &str, meaning: &str| {
        Line::from(vec![
            Span::styled(format!(" {} ", padded(key, 27)), Style::new().bold()),
            Span::raw(meaning.to_owned()),
        ])
    };
    let heading = |text: &'static str| Line::styled(text, theme::loud(theme::FORWARD));
    let mut lines = Vec::new();
    for (action, keys) in ACTIONS.iter().flat_map(|action| action.keys.iter().map(move |keys| (action, keys))) {
        let shown = view.keymap.shown(action, keys);
        if !shown.is_empty() {
            lines.push(row(&shown, keys.meaning));
        }
    }
    lines.extend(view.keymap.own().map(|(key, command)| row(&key, &format!(":{command}"))));
    lines.push(heading(" mouse"));
    lines.extend(MOUSE.iter().map(|(gesture, meaning)| row(gesture, meaning)));
    lines.push(heading(" commands, typed after :"));
    let commands = ACTIONS.iter().filter(|action| !matches!(action.name, "command" | "filter" | "escape" | "type"));
    lines.extend(commands.map(|action| row(format!("{} {}", action.name, action.argument).trim_end(), action.meaning)));
    lines.push(heading(" signs"));
    lines.extend(SIGNS.iter().map(|(sign, meaning)| row(sign, meaning)));
    lines.push(heading(" settings"));
    lines.extend(PARAMETERS.iter().map(|parameter| row(parameter.name, parameter.meaning)));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;

    #[test]
    fn every_key_command_sign_and_setting_is_explained() {
        let data = telemetry::test_support::frame_data();
        let view = crate::view::tests::view(&data);
        let frame = drawn(120, 145, |area, buffer| draw(&view, 0, area, buffer));
        for row in ACTIONS {
            for keys in row.keys {
                assert!(
                    frame.contains(&view.keymap.shown(row, keys)) && frame.contains(keys.meaning),
                    "{}:\n{frame}",
                    row.name
                );
            }
        }
        for parameter in &PARAMETERS {
            assert!(frame.contains(parameter.name), "{}:\n{frame}", parameter.name);
        }
        // A meaning that is cut off explains nothing.
        let cut: Vec<&str> = frame.lines().filter(|line| line.ends_with('│') && !line.ends_with(" │")).collect();
        assert_eq!(cut, [""; 0], "lines that do not fit");
        insta::assert_snapshot!("help", frame);
    }

    #[test]
    fn a_small_screen_shows_a_part_and_how_to_see_the_rest() {
        let data = telemetry::test_support::frame_data();
        let view = crate::view::tests::view(&data);
        let first = drawn(80, 20, |area, buffer| draw(&view, 0, area, buffer));
        assert!(first.contains("up and down move it") && first.contains("this help"), "{first}");
        let last = drawn(80, 20, |area, buffer| draw(&view, 1000, area, buffer));
        assert!(last.contains("unbalance added at a place"), "the last of all: {last}");
    }
}
