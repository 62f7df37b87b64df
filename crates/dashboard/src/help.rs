//! The help screen: every key, from the one table of keys, and the signs that the panels use.

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Clear, Paragraph, Widget};
use rotor::PARAMETERS;

use crate::actions::{ACTIONS, MOUSE};
use crate::fit_text::{cut_line, padded, width};
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
    let width = 104.min(area.width);
    let room = usize::from(width.saturating_sub(2));
    let matching = lines(view).into_iter().filter(matches);
    let lines: Vec<Line<'_>> = matching.flat_map(|line| wrapped(line, room.saturating_sub(1))).collect();
    let count = lines.len();
    let height = (count as u16 + 2).min(area.height);
    let [middle] = Layout::horizontal([Constraint::Length(width)]).flex(ratatui::layout::Flex::Center).areas(area);
    let [middle] = Layout::vertical([Constraint::Length(height)]).flex(ratatui::layout::Flex::Center).areas(middle);
    Clear.render(middle, buffer);
    let shown = usize::from(height.saturating_sub(2));
    let from = from.min(count.saturating_sub(shown));
    let more = if from + shown < count { ", up and down move it" } else { "" };
    let block = Block::bordered().title(format!(" help: ? or esc closes it, / filters it{more} "));
    Paragraph::new(lines.into_iter().skip(from).map(|line| cut_line(line, room)).collect::<Vec<_>>())
        .block(block)
        .render(middle, buffer);
}

/// Cells before what a key does.
const INDENT: usize = 29;

/// A line on as many as it takes, its second part below itself, and below a first part that fills the line.
fn wrapped(line: Line<'_>, room: usize) -> Vec<Line<'_>> {
    let [key, meaning] = &line.spans[..] else { return vec![line] };
    let keys = filled(key.content.trim_end(), [room, room.saturating_sub(4)]);
    let lone = width(&key.content) >= room;
    let first = if lone { 0 } else { room.saturating_sub(width(&key.content)) };
    let mut meanings = filled(&meaning.content, [first, room.saturating_sub(INDENT)]).into_iter();
    let rows = |indent: usize, text: String, style: Style| {
        Line::from(vec![Span::raw(" ".repeat(indent)), Span::styled(text, style)])
    };
    let mut lines: Vec<Line<'_>> = if lone {
        keys.into_iter().enumerate().map(|(at, text)| rows(if at == 0 { 0 } else { 4 }, text, key.style)).collect()
    } else {
        Vec::new()
    };
    let head = meanings.next().unwrap_or_default();
    if !lone {
        lines.push(Line::from(vec![key.clone(), Span::styled(head, meaning.style)]));
    }
    lines.extend(meanings.map(|text| rows(INDENT, text, meaning.style)));
    lines
}

/// The words of a text in rows: so many cells in the first, so many in each of the others.
fn filled(text: &str, [first, rest]: [usize; 2]) -> Vec<String> {
    let mut rows = vec![String::new()];
    for word in text.split(' ') {
        let room = if rows.len() == 1 { first } else { rest };
        match rows.last_mut() {
            Some(last) if last.is_empty() && width(word) <= room => last.push_str(word),
            Some(last) if !last.is_empty() && width(last) + 1 + width(word) <= room => {
                last.push(' ');
                last.push_str(word);
            }
            _ => rows.push(word.to_owned()),
        }
    }
    rows
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
    fn on_a_narrow_screen_what_is_long_goes_on_below_itself() {
        let data = telemetry::test_support::frame_data();
        let view = crate::view::tests::view(&data);
        let frame = drawn(60, 300, |area, buffer| draw(&view, 0, area, buffer));
        assert!(!frame.contains('…'), "{frame}");
        let flat: String = frame.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        for row in ACTIONS.iter().flat_map(|row| row.keys.iter().map(|keys| keys.meaning)) {
            assert!(flat.contains(row), "{row}:\n{frame}");
        }
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
