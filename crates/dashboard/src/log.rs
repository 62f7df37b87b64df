//! Every event and every alarm in full, the newest first: what a row of their panels has no room for.

use ::alarms::Entry;
use ratatui::buffer::Buffer;
use ratatui::layout::{Margin, Rect};
use ratatui::style::Style;
use ratatui::text::Line;
use ratatui::widgets::{Block, Clear, Widget};
use telemetry::event_log::LoggedEvent;
use telemetry::units::ScreenUnits;
use text::number::short;

use crate::drawing::write;
use crate::fit_text::width;
use crate::list::passes;
use crate::panels::{alarms, events};
use crate::theme;
use crate::view::View;

/// Cells by which the words of one entry stand in from its time.
const INDENT: usize = 2;

/// One thing that happened: when, nanoseconds since 1970, its heading and its words.
struct Told {
    wall_ns: u64,
    heading: (String, Style),
    words: String,
}

/// Draws it over `area`, from line `from` on.
pub(crate) fn draw(view: &View<'_>, from: usize, area: Rect, buffer: &mut Buffer) {
    let units = view.data.units();
    let mut all: Vec<Told> = view.data.events.iter().map(of_event).collect();
    all.extend(view.alarms.entries().map(|entry| of_alarm(entry, &units)));
    all.retain(|told| passes(view.filter, &format!("{} {}", told.heading.0, told.words)));
    all.sort_by_key(|told| std::cmp::Reverse(told.wall_ns));
    Clear.render(area, buffer);
    let inner = area.inner(Margin::new(1, 1));
    let mut lines: Vec<(String, Style)> = Vec::new();
    for told in all {
        lines.push(told.heading);
        let words = wrapped(&told.words, usize::from(inner.width).saturating_sub(INDENT));
        lines.extend(words.into_iter().map(|line| (format!("{}{line}", " ".repeat(INDENT)), Style::new())));
    }
    if lines.is_empty() {
        lines.push(("nothing has happened".into(), theme::quiet()));
    }
    let from = from.min(lines.len().saturating_sub(usize::from(inner.height)));
    let more = if from + usize::from(inner.height) < lines.len() { ", up and down move it" } else { "" };
    let title = format!(" events and alarms in full: esc closes it, / filters it{more} ");
    Block::bordered()
        .title(crate::fit_text::cut_line(Line::from(title), usize::from(inner.width)))
        .render(area, buffer);
    for (y, (text, style)) in (inner.top()..inner.bottom()).zip(&lines[from..]) {
        write(buffer, inner, inner.left(), y, text, *style);
    }
}

fn of_event(entry: &LoggedEvent) -> Told {
    let (sign, color) = events::sign(entry);
    let by = if entry.why.is_empty() { String::new() } else { format!(", {}", entry.why) };
    let heading = format!("{}  tau {}  {}{by}", alarms::clock(entry.wall_ns), short(entry.tau, 7), entry.who);
    let style = color.map_or_else(|| Style::new().bold(), theme::loud);
    Told { wall_ns: entry.wall_ns, heading: (heading, style), words: format!("{sign}{}", entry.what) }
}

fn of_alarm(entry: &Entry, units: &ScreenUnits) -> Told {
    let until = entry.fell.map_or_else(|| "now".to_owned(), |at| alarms::clock(at.wall_ns));
    let seen = entry.seen_ns.map_or_else(|| "not acknowledged".to_owned(), |at| format!("seen {}", alarms::clock(at)));
    let heading = format!("{} to {until}  tau {}  {seen}", alarms::clock(entry.rose.wall_ns), short(entry.rose.tau, 7));
    let style = theme::loud(theme::level_color(entry.level));
    let words = format!("{} {}", theme::level_words(entry.level), alarms::what(entry, units));
    Told { wall_ns: entry.rose.wall_ns, heading: (heading, style), words }
}

/// A text in lines of at most so many cells, between its words where it can be.
fn wrapped(text: &str, room: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().map_or(0, |line| width(line));
        match lines.last_mut() {
            Some(last) if line == 0 || line + 1 + width(word) <= room => {
                if line > 0 {
                    last.push(' ');
                }
                last.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use ::alarms::{Alarms, Reading};
    use wire::{Happening, Moment};

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    #[test]
    fn what_a_row_has_no_room_for_is_told_in_full_the_newest_first() {
        let now = std::time::Instant::now();
        let mut feed = Feed::new("");
        let settings = tests::bench_status("three-mass", "composite").settings.get().clone();
        feed.push_event(&tests::event(1, &Happening::Started, &settings));
        let note = "the bearing of mass 2 grows warm after an hour at this speed, and hums at about 1.25";
        feed.push_event(&tests::event(2, &Happening::Note(note.into()), &settings));
        let mut alarms = Alarms::default();
        let at = Moment { wall_ns: 50_607_000_000_000, tau: 12.5, ..Moment::default() };
        alarms.read(&Reading::new(at).tripped("orbit of mass 2 reached 1000.5000 e_t, past the limit of 1000 e_t"));
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let seen = View { alarms: &alarms, ..view(&data) };
        let frame = drawn(60, 14, |area, buffer| draw(&seen, 0, area, buffer));
        assert!(frame.contains("hums at about 1.25") && frame.contains("the limit of 1000 e_t"), "{frame}");
        insta::assert_snapshot!("log", frame);
        let filtered =
            drawn(60, 14, |area, buffer| draw(&View { filter: "hums", ..seen_of(&data, &alarms) }, 0, area, buffer));
        assert!(filtered.contains("about 1.25") && !filtered.contains("trip"), "{filtered}");
    }

    fn seen_of<'a>(data: &'a telemetry::frame_data::FrameData, alarms: &'a Alarms) -> View<'a> {
        View { alarms, ..view(data) }
    }

    #[test]
    fn a_word_too_long_for_a_line_has_one_of_its_own() {
        assert_eq!(wrapped("a bc def", 4), ["a bc", "def"]);
        assert_eq!(wrapped("abcdefgh i", 4), ["abcdefgh", "i"]);
        assert_eq!(wrapped("", 4), [""]);
    }
}
