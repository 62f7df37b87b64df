//! The help screen: every key, from the one table of keys, and the signs that the panels use.

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Clear, Paragraph, Widget};
use rotor::PARAMETERS;

use crate::keymap::BINDINGS;
use crate::theme;

/// Signs whose meaning the panels do not spell out.
const SIGNS: [(&str, &str); 6] = [
    ("▲ ▼", "poles of forward and backward whirl"),
    ("◆", "the least damped mode; right of the yellow line it grows"),
    (".05 .1 .2 .5", "rays of equal damping ratio"),
    ("●", "where a mass was when the rotor had made another turn"),
    ("⊕", "the mass that carries the control bearing"),
    ("blue circle", "clearance of the support bearing"),
];

pub(crate) fn draw(area: Rect, buffer: &mut Buffer) {
    let row = |key: &str, meaning: &str| {
        Line::from(vec![Span::styled(format!(" {key:<27} "), Style::new().bold()), Span::raw(meaning.to_owned())])
    };
    let mut lines: Vec<Line<'_>> = BINDINGS.iter().map(|binding| row(binding.keys, binding.meaning)).collect();
    let heading = |text: &'static str| Line::styled(text, theme::loud(theme::FORWARD));
    lines.push(heading(" signs"));
    lines.extend(SIGNS.iter().map(|(sign, meaning)| row(sign, meaning)));
    lines.push(heading(" settings"));
    lines.extend(PARAMETERS.iter().map(|parameter| row(parameter.name, parameter.meaning)));
    let height = (lines.len() as u16 + 2).min(area.height);
    let width = 92.min(area.width);
    let [middle] = Layout::horizontal([Constraint::Length(width)]).flex(ratatui::layout::Flex::Center).areas(area);
    let [middle] = Layout::vertical([Constraint::Length(height)]).flex(ratatui::layout::Flex::Center).areas(middle);
    Clear.render(middle, buffer);
    let block = Block::bordered().title(" help: ? or esc closes it ");
    Paragraph::new(lines).block(block).render(middle, buffer);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panels::tests::drawn;

    #[test]
    fn every_key_sign_and_setting_is_explained() {
        let frame = drawn(100, 39, draw);
        for binding in &BINDINGS {
            assert!(frame.contains(binding.keys) && frame.contains(binding.meaning), "{}:\n{frame}", binding.keys);
        }
        for parameter in &PARAMETERS {
            assert!(frame.contains(parameter.name), "{}:\n{frame}", parameter.name);
        }
        insta::assert_snapshot!("help", frame);
    }
}
