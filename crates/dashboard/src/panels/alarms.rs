//! How everything that is watched stands against its limits, and what has been past them.
//!
//! ```text
//! ┌ alarms  1 not acknowledged: a ─────────────────────────────────┐
//! │                 now  warning    alarm                            │
//! │ damping      0.0535   0.0159   0.0000  ok                        │
//! │ sensitivity   2.903   4.0000   5.0000  ok                        │
//! │ orbit         12.30        -        -  no limit                  │
//! │ lateness      0.012   0.0100   0.1000  ! WARNING                 │
//! │ 14:03:27 to 14:03:31  !! ALARM damping -0.0306, limit 0  not ack │   the newest first; times are UTC
//! └─────────────────────────────────────────────────────────────────┘
//! ```

use alarms::{Entry, Level, Watch};
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};

use super::panel::{Panel, PanelRequest};
use crate::drawing::{framed, write};
use crate::fit_text::{longest, width};
use crate::input::Mouse;
use crate::list::{List, draw_overflow, filter_title, passes, row_of};
use crate::theme;
use crate::view::View;
use telemetry::units::{ScreenUnits, Unit};

/// The panel; its list is that of what has been. A click on one that nobody has acknowledged does that, on any other it looks
/// at its moment.
#[derive(Debug, Default)]
pub(crate) struct AlarmList {
    list: List,
    /// What a click on the entries that were last drawn asks for, and the row of the first.
    drawn: (usize, Vec<PanelRequest>),
}

impl Panel for AlarmList {
    fn scroll(&mut self, rows: isize) {
        self.list.scroll(rows);
    }

    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        self.drawn = draw(&mut self.list, view, area, buffer);
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        match mouse {
            Mouse::Wheel(notches) => self.scroll(3 * notches as isize),
            // What the frame says is of all of them.
            Mouse::Click if at.y == area.y && view.alarms.unseen() > 0 && view.replay.is_none() => {
                return Some(PanelRequest::Acknowledge);
            }
            Mouse::Click => {
                let (first, intents) = &self.drawn;
                return intents.get(row_of(area, at)?.checked_sub(*first)?).cloned();
            }
            Mouse::Drag(_) => {}
        }
        None
    }
}

/// What a click on an entry asks for. Those of a recording were for others to acknowledge.
fn intent(entry: &Entry, is_recorded: bool) -> PanelRequest {
    match entry.seen_ns {
        None if !is_recorded => PanelRequest::Acknowledge,
        _ => PanelRequest::LookAtTime { wall_ns: entry.rose.wall_ns, tau: entry.rose.tau },
    }
}

/// Draws it, and returns what a click on the entries asks for, with the row of the first.
fn draw(list: &mut List, view: &View<'_>, area: Rect, buffer: &mut Buffer) -> (usize, Vec<PanelRequest>) {
    let alarms = view.alarms;
    let mut title = vec![Span::raw(" alarms ")];
    if alarms.unseen() > 0 {
        let (unseen, room) = (alarms.unseen(), usize::from(area.width).saturating_sub(2 + " alarms ".len()));
        let ways = [format!(" {unseen} not acknowledged: a "), format!(" {unseen} new: a ")];
        let text = longest(&ways.each_ref().map(String::as_str), room);
        title.push(Span::styled(text, theme::badge(theme::level_color(alarms.shown()))));
    }
    let judged = view.replay.as_ref().is_none_or(|show| show.judged);
    if !judged {
        title.push(Span::styled(" recorded without alarms ", theme::quiet()));
    }
    let all = alarms.entries().count();
    let units = view.data.units();
    let entries: Vec<&Entry> = alarms.entries().filter(|entry| passes(view.filter, &words(entry, &units))).collect();
    title.push(Span::raw(filter_title(view.filter, entries.len(), all)));
    let inner = framed(Line::from(title), area, buffer);
    let mut rows = (inner.top()..inner.bottom()).map(|y| Rect { y, height: 1, ..inner });
    // What has been matters more than what is watched, where there is no room for both.
    let told = entries.len();
    let watched = Watch::ALL.len() + 1;
    if usize::from(inner.height) > watched.min(told + 2) {
        draw_standings(view, &units, &mut rows, told.min(3), buffer);
    }
    let below = Rect { y: inner.bottom() - rows.len() as u16, height: rows.len() as u16, ..inner };
    let in_view = list.rows(told, below.height, 0);
    for (row, entry) in rows.by_ref().zip(&entries[in_view.clone()]) {
        draw_entry(entry, &units, row, buffer);
    }
    draw_overflow(&in_view, told, area, buffer);
    if all == 0
        && judged
        && let Some(row) = rows.next()
    {
        let told = longest(&["nothing has been past its limit", "nothing past its limit"], usize::from(row.width));
        write(buffer, row, row.x, row.y, &told, theme::quiet());
    }
    (
        usize::from(below.y - inner.y),
        entries[in_view].iter().map(|entry| intent(entry, view.replay.is_some())).collect(),
    )
}

/// The unit of what is watched; a share and a ratio have none.
pub(crate) fn unit_of(watch: Watch, units: &ScreenUnits) -> Unit {
    match watch {
        Watch::Orbit => units.length,
        Watch::Force => units.force,
        Watch::DelayMargin => match units.scales {
            Some(scales) => Unit { factor: scales.seconds(1e3), name: "ms" },
            None => Unit { factor: 1.0, name: "" },
        },
        _ => Unit { factor: 1.0, name: "" },
    }
}

/// Of some levels the places of so many that are worst, in their order; of equals the first.
fn worst(levels: &[Level], room: usize) -> Vec<usize> {
    let mut places: Vec<usize> = (0..levels.len()).collect();
    places.sort_by_key(|at| std::cmp::Reverse(levels[*at]));
    places.truncate(room);
    places.sort_unstable();
    places
}

/// A line for each watched thing, but for the last `spared` rows. Where there are too few rows, those that stand worst have one, and the
/// heading says how many have none.
fn draw_standings(
    view: &View<'_>,
    units: &ScreenUnits,
    rows: &mut impl ExactSizeIterator<Item = Rect>,
    spared: usize,
    buffer: &mut Buffer,
) {
    let room = rows.len().saturating_sub(spared);
    let all: Vec<_> = view.alarms.standings().collect();
    let shown = worst(&all.iter().map(|(_, standing, _)| standing.at).collect::<Vec<_>>(), room.saturating_sub(1));
    let missing = match all.len() - shown.len() {
        0 => String::new(),
        count => format!("{count} not shown"),
    };
    let heading = (missing, ["now", "warning", "alarm"].map(str::to_owned), Span::styled("", Style::new()));
    let lines = shown.iter().map(|at| &all[*at]).map(|&(watch, standing, limit)| {
        let unit = unit_of(watch, units);
        let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| unit.short(value, 5));
        let of = |level| number(limit.map(|limit| limit.at(level)));
        let [warning, alarm] = [of(Level::Warning), of(Level::Alarm)];
        let cells = match watch {
            // It has or it has not.
            Watch::Trip => {
                [standing.value.map_or("-", |value| if value > 0.0 { "yes" } else { "no" }), "", ""].map(str::to_owned)
            }
            _ => [number(standing.value), warning, alarm],
        };
        let state = match (limit, standing.value) {
            (None, _) => Span::styled("no limit", theme::quiet()),
            // A recorder that told of nothing has judged all the same.
            (Some(_), None) if view.replay.is_none() => Span::styled("unknown", theme::quiet()),
            (Some(_), _) => Span::styled(theme::level_words(standing.at), theme::loud(theme::level_color(standing.at))),
        };
        let unit = if units.scales.is_some() { unit.name } else { "" };
        (format!("{} {unit}", watch.name()).trim_end().to_owned(), cells, state)
    });
    // The longest name with its unit is `delay-margin ms`.
    let long = if units.scales.is_some() { 15 } else { 12 };
    let all = std::iter::once(heading).chain(lines).take(room).zip(rows).enumerate();
    for (place, ((name, [now, warning, alarm], mut state), row)) in all {
        let style = if place == 0 { theme::quiet() } else { Style::new() };
        // What it is and how it stands come before the limits, and those before the name's last letters.
        let text = match usize::from(row.width) {
            wide if wide >= long + 36 => format!("{name:<long$}{now:>8}{warning:>9}{alarm:>9}  "),
            wide if wide >= long + 27 => format!("{name:<long$}{now:>8}{alarm:>9}  "),
            wide => {
                // The name and the number are whole.
                let left = wide.saturating_sub(width(&now).max(6) + 1 + "!! ALARM".len());
                format!("{name:<named$}{now:>6} ", named = left.min(13).max(width(&name)))
            }
        };
        // Of a warning four letters say enough.
        if width(&text) + state.width() > usize::from(row.width) && state.content.starts_with("! ") {
            state.content = "! WARN".into();
        }
        let x = write(buffer, row, row.x, row.y, &text, style);
        write(buffer, row, x, row.y, &state.content, state.style);
    }
}

/// When, how bad and what, as a row shows it.
fn words(entry: &Entry, units: &ScreenUnits) -> String {
    format!("{}{} {}", when(entry), theme::level_words(entry.level), what(entry, units))
}

fn when(entry: &Entry) -> String {
    let fell = entry.fell.map_or_else(|| "     now".to_owned(), |at| clock(at.wall_ns));
    format!("{} to {fell}  ", clock(entry.rose.wall_ns))
}

pub(crate) fn what(entry: &Entry, units: &ScreenUnits) -> String {
    if entry.cause.is_empty() {
        let unit = unit_of(entry.watch, units);
        let limit = if units.scales.is_some() { unit.told(entry.limit, 5) } else { unit.short(entry.limit, 5) };
        format!("{} {}, limit {limit}", entry.watch.name(), unit.short(entry.worst, 5))
    } else {
        format!("{}: {}", entry.watch.name(), entry.cause)
    }
}

fn draw_entry(entry: &Entry, units: &ScreenUnits, row: Rect, buffer: &mut Buffer) {
    let color = theme::level_color(entry.level);
    let words = theme::level_words(entry.level);
    let sign = words.split(' ').next().unwrap_or(words);
    let style = if entry.seen_ns.is_none() { theme::badge(color) } else { theme::loud(color) };
    let seen = if entry.seen_ns.is_none() { "  not acknowledged" } else { "" };
    let (name, rose) = (entry.watch.name(), format!("{} ", clock(entry.rose.wall_ns)));
    // What it is of comes before how much it is, and before how long; the time it rose, and a sign, always stand there.
    let what = what(entry, units);
    let full = [when(entry), format!(" {words} "), format!(" {what}{seen}")];
    let told = |level: &str, what: &str| [rose.clone(), format!(" {level} "), format!(" {what}")];
    let brief = [told(words, &what), told(sign, &what), told(words, name), told(sign, name)];
    let wide = |parts: &[String; 3]| parts.iter().map(|part| width(part)).sum::<usize>();
    // A cause is a sentence, which may be cut where its beginning can be read.
    let long = if entry.cause.is_empty() { wide(&full) - width(seen) } else { width(&full[0]) + width(&full[1]) + 24 };
    let mut ways = vec![(long, full)];
    ways.extend(brief.map(|parts| (wide(&parts), parts)));
    let found = ways.into_iter().find(|(long, _)| *long <= usize::from(row.width));
    let [when, words, what] = found.map_or_else(|| told(sign, name), |(_, parts)| parts);
    let x = write(buffer, row, row.x, row.y, &when, theme::quiet());
    let x = write(buffer, row, x, row.y, &words, style);
    write(buffer, row, x, row.y, &what, Style::new());
}

/// The time of day of nanoseconds since 1970, UTC.
pub(crate) fn clock(wall_ns: u64) -> String {
    let second = wall_ns / 1_000_000_000 % 86_400;
    format!("{:02}:{:02}:{:02}", second / 3600, second / 60 % 60, second % 60)
}

#[cfg(test)]
pub(crate) mod tests {
    use alarms::{Alarms, Reading};
    use wire::Moment;

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::test_support as tests;

    fn frame(alarms: &Alarms, width: u16, height: u16) -> String {
        let data = tests::frame_data();
        drawn(width, height, |area, buffer| AlarmList::default().draw(&View { alarms, ..view(&data) }, area, buffer))
    }

    fn at(second: u64) -> Reading {
        Reading::new(Moment { wall_ns: second * 1_000_000_000, ..Moment::default() })
    }

    /// A reading of damping.
    pub(crate) fn damping(second: u64, value: f64) -> Reading {
        at(second).with(Watch::Damping, value)
    }

    /// Unstable from second 50 607 to 50 611, and tripped since.
    fn history() -> Alarms {
        let mut alarms = Alarms::default();
        alarms.read(&damping(50_600, 0.05));
        alarms.read(&damping(50_607, -0.0306));
        alarms.read(&damping(50_611, 0.05));
        alarms.acknowledge();
        let cause = "orbit of mass 2 reached 1000.5000 e_t, past the limit of 1000 e_t";
        alarms.read(&at(50_620).tripped(cause));
        alarms
    }

    #[test]
    fn names_and_numbers_are_whole_in_the_narrowest_column() {
        let mut alarms = history();
        let reading = Watch::ALL.into_iter().filter(|watch| *watch != Watch::Trip);
        alarms.read(&reading.fold(at(50_630), |reading, watch| {
            reading.with(watch, if watch == Watch::Damping { -0.0306 } else { 12.345 })
        }));
        for wide in [30, 32, 40] {
            let frame = frame(&alarms, wide, 24);
            for watch in Watch::ALL {
                let row = frame.lines().find(|row| row.starts_with(&format!("│{}", watch.name())));
                assert!(row.is_some_and(|row| !row.contains('…')), "{watch} at {wide}:\n{frame}");
            }
            assert!(frame.contains("!! ") && frame.contains("-0.0306"), "{frame}");
            assert!(frame.contains("14:03:27"), "{frame}");
        }
    }

    /// Where there is no room for all, what is past its limit has a line however far down it stands, and it is said that others have none.
    #[test]
    fn what_stands_worst_is_shown_in_few_rows() {
        let mut alarms = Alarms::default();
        alarms.read(&damping(50_600, 0.05).with(Watch::Lateness, 12.0).with(Watch::Losses, 0.0));
        for height in 6..=8 {
            let frame = frame(&alarms, 50, height);
            let lines = usize::from(height) - 4;
            assert!(frame.contains("lateness") && frame.contains("ALARM"), "{height}:\n{frame}");
            assert!(frame.contains(&format!("{} not shown", Watch::ALL.len() - lines)), "{height}:\n{frame}");
        }
        assert!(!frame(&alarms, 50, 24).contains("not shown"));
    }

    #[test]
    fn what_fired_is_found_with_its_times_level_and_cause() {
        let frame_of = |width, height| frame(&history(), width, height);
        let usual = frame_of(90, 14);
        for words in [
            "14:03:27 to 14:03:31   !! ALARM  damping -0.0306, limit 0.0000",
            "14:03:40 to      now   !! ALARM  trip: orbit of mass 2 reached 1000.5",
            "1 not acknowledged: a",
        ] {
            assert!(usual.contains(words), "{words}:\n{usual}");
        }
        insta::assert_snapshot!("alarms", usual);
        insta::assert_snapshot!("alarms_large", frame_of(120, 20));
        insta::assert_snapshot!("alarms_small", frame_of(40, 5));
        assert!(frame_of(40, 5).contains("!! ALARM  trip"), "{}", frame_of(40, 5));
    }

    #[test]
    fn nothing_past_is_told_too() {
        let quiet = frame(&Alarms::default(), 60, 14);
        assert!(quiet.contains("nothing has been past its limit") && quiet.contains("no limit"), "{quiet}");
        insta::assert_snapshot!("alarms_quiet", quiet);
    }
}
