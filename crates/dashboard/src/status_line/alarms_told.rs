//! Alarms at the right edge of a status line.

use alarms::{Alarms, Level};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use crate::drawing::write_line;
use crate::theme;

/// The alarms with the names of as many levels as `room` has, the worst first; of the others how many there are, and as the last resort
/// their signs alone.
pub(super) fn alarms_within(alarms: &Alarms, room: usize) -> Line<'static> {
    let told = |named: &[Level]| Line::from(alarms_told(alarms, named, false).collect::<Vec<_>>());
    let named: [&[Level]; 3] = [&[Level::Alarm, Level::Warning], &[Level::Alarm], &[]];
    let signs = || Line::from(alarms_told(alarms, &[], true).collect::<Vec<_>>());
    named.into_iter().map(told).find(|line| line.width() <= room).unwrap_or_else(signs)
}

/// Alarms at the right edge, over what is told there: an alarm has one place, and is never pushed off the screen.
pub(crate) fn draw_alarms(alarms: &Alarms, area: Rect, buffer: &mut Buffer) {
    let told = alarms_within(alarms, usize::from(area.width));
    let width = (told.width() as u16).min(area.width);
    write_line(buffer, Rect { x: area.right() - width, width, ..area }, told);
}

/// The alarms that must be shown, the worst first: a sign and a word for the level, then what is past its limit, or for levels that are not
/// among `named` how many. On a bar until they are acknowledged.
fn alarms_told(alarms: &Alarms, named: &[Level], signs: bool) -> impl Iterator<Item = Span<'static>> {
    [Level::Alarm, Level::Warning].into_iter().flat_map(move |level| {
        [true, false].into_iter().filter_map(move |unseen| {
            let here = alarms.standings().filter(|(_, standing, _)| standing.shown() == level);
            let names: Vec<&str> = here
                .filter(|(_, standing, _)| (standing.unseen == level) == unseen)
                .map(|(watch, ..)| watch.name())
                .collect();
            let what = if named.contains(&level) { names.join(", ") } else { names.len().to_string() };
            let words = theme::level_words(level);
            let words = if signs { words.split(' ').next().unwrap_or(words) } else { words };
            let text = format!(" {words} {what} ");
            let color = theme::level_color(level);
            let style = if unseen { theme::badge(color) } else { theme::loud(color) };
            (!names.is_empty()).then(|| Span::styled(text, style))
        })
    })
}
