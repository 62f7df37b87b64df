//! What happened, the newest first: who changed what and why, trips, notes.
//!
//! ```text
//! ┌ events ─────────────────────────────────────────────────┐
//! │ 14:03:27  tau 412.3  kd.1 -0.5879 -> 0.1  dash:812, typed │   times are UTC
//! │ 14:03:20  tau 405.1  !! tripped: orbit of mass 2 ...  sim │
//! │ 14:02:11  tau 336.0  note: here it hums  note:77          │   dim: after the cursor
//! └─────────────────────────────────────────────────────────┘
//! ```

use alarms::Level;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::{Color, Style};
use ratatui::text::Line;
use wire::Happening;

use super::alarms::clock;
use super::panel::{Panel, PanelRequest};
use crate::drawing::{framed, write};
use crate::input::Mouse;
use crate::list::{List, draw_overflow, filter_title, passes, row_of};
use crate::theme;
use crate::view::View;
use telemetry::event_log::LoggedEvent;
use text::number::short;

/// The list; a click looks at the moment of an event.
#[derive(Debug, Default)]
pub(crate) struct Events {
    list: List,
    /// The moments of the rows that were last drawn, wall clock and tau, from the first row on.
    drawn: Vec<(u64, f64)>,
}

impl Panel for Events {
    fn scroll(&mut self, rows: isize) {
        self.list.scroll(rows);
    }

    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        let data = view.data;
        let shown: Vec<&LoggedEvent> =
            data.events.iter().rev().filter(|entry| passes(view.filter, &words(entry))).collect();
        let title = format!(" events {}", filter_title(view.filter, shown.len(), data.events.len()));
        let inner = framed(Line::from(title), area, buffer);
        if data.events.is_empty() {
            write(buffer, inner, inner.left(), inner.top(), "nothing has happened", theme::quiet());
        }
        // While the newest step is looked at, nothing is after it.
        let until = data.now.filter(|_| data.behind > 0).map(|now| data.track.wall_ns(now));
        let is_after = |entry: &LoggedEvent| until.is_some_and(|until| entry.wall_ns > until);
        // What is after the cursor takes no more than a third: what was before it must be found.
        let after = shown.iter().take_while(|entry| is_after(entry)).count();
        let first = after.saturating_sub(usize::from(inner.height / 3));
        let rows = self.list.rows(shown.len(), inner.height, first);
        for (y, entry) in (inner.top()..inner.bottom()).zip(&shown[rows.clone()]) {
            draw_entry(entry, is_after(entry), Rect { y, height: 1, ..inner }, buffer);
        }
        draw_overflow(&rows, shown.len(), area, buffer);
        self.drawn.clear();
        self.drawn.extend(shown[rows].iter().map(|entry| (entry.wall_ns, entry.tau)));
    }

    fn mouse(&mut self, _view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        if let Mouse::Wheel(notches) = mouse {
            self.scroll(3 * notches as isize);
        }
        let (wall_ns, tau) = *self.drawn.get(row_of(area, at)?).filter(|_| mouse == Mouse::Click)?;
        Some(PanelRequest::LookAtTime { wall_ns, tau })
    }
}

/// When, what and who, as a row shows them.
fn words(entry: &LoggedEvent) -> String {
    format!("{}{}{}", when(entry), sign(entry).0, what_and_who(entry).join("  "))
}

fn when(entry: &LoggedEvent) -> String {
    format!("{}  tau {:<7} ", clock(entry.wall_ns), short(entry.tau, 5))
}

fn what_and_who(entry: &LoggedEvent) -> [String; 2] {
    let by = if entry.why.is_empty() { entry.who.clone() } else { format!("{}, {}", entry.who, entry.why) };
    [entry.what.clone(), by]
}

fn draw_entry(entry: &LoggedEvent, is_after: bool, row: Rect, buffer: &mut Buffer) {
    let (sign, color) = sign(entry);
    let (when, [what, by]) = (when(entry), what_and_who(entry));
    let x = write(buffer, row, row.x, row.y, &when, theme::quiet());
    let what = format!("{sign}{what}");
    let style = match color {
        _ if is_after => theme::quiet(),
        Some(color) => theme::loud(color),
        None => Style::new(),
    };
    let x = write(buffer, row, x, row.y, &what, style);
    write(buffer, row, x + 2, row.y, &by, theme::quiet());
}

/// What stands before an event, and its colour.
pub(crate) fn sign(entry: &LoggedEvent) -> (&'static str, Option<Color>) {
    match entry.happening {
        _ if entry.level == Level::Alarm => ("!! ", Some(theme::BAD)),
        _ if entry.level == Level::Warning => ("! ", Some(theme::WARN)),
        Happening::Tripped(_) => ("!! ", Some(theme::BAD)),
        Happening::Refused { .. } | Happening::Late { .. } => ("! ", Some(theme::WARN)),
        Happening::Note(_) => ("● ", Some(theme::FORWARD)),
        _ => ("", None),
    }
}

#[cfg(test)]
mod tests {
    use wire::message::Trip;

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::test_support as tests;
    use telemetry::test_support::event;
    use telemetry::view_time::ViewTime;

    #[test]
    fn who_did_what_and_why_is_told_newest_first() {
        let now = std::time::Instant::now();
        let mut feed = Feed::new("");
        let mut settings = tests::bench_status("three-mass", "composite").settings.get().clone();
        feed.push_event(&event(1, &Happening::Started, &settings));
        settings.set("kd".parse().unwrap(), 0.1).unwrap();
        let mut change = event(2, &Happening::Settings, &settings);
        change.why = wire::Text::new("typed");
        feed.push_event(&change);
        feed.push_event(&event(3, &Happening::Note("here it hums".into()), &settings));
        let trip = Trip { cause: 1, mass: 2, step: 9, radius: 1000.5, limit: 1000.0 };
        feed.push_event(&event(4, &Happening::Tripped(trip), &settings));
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let frame_of =
            |width, height| drawn(width, height, |area, buffer| Events::default().draw(&view(&data), area, buffer));
        let frame = frame_of(100, 7);
        let rows: Vec<&str> = frame.lines().collect();
        assert!(rows[1].contains("14:03:24") && rows[1].contains("!! tripped: orbit of mass 2"), "{frame}");
        assert!(rows[2].contains("note: here it hums"), "{frame}");
        assert!(rows[3].contains("-0.5879 -> 0.1  dash:812, typed"), "{frame}");
        insta::assert_snapshot!("events", frame);
        insta::assert_snapshot!("events_small", frame_of(40, 4));
        insta::assert_snapshot!("events_large", frame_of(140, 12));
    }

    #[test]
    fn where_one_looks_back_there_is_what_had_happened_by_then() {
        let mut feed = Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        let settings = tests::bench_status("three-mass", "composite").settings.get().clone();
        for number in 1..=100 {
            feed.push_event(&event(number, &Happening::Note(format!("number {number}")), &settings));
        }
        // Steps a second apart, as the events are.
        for seq in 0..100 {
            feed.push_step(
                &tests::state(3, seq).with_word(wire::Channel::WallNs, (50_600 + seq) * 1_000_000_000),
                std::time::Instant::now(),
            );
        }
        let mut time = ViewTime::LIVE;
        time.jump_to(50);
        let data = feed.frame_data(&time, std::time::Instant::now());
        let view = crate::view::View { time: &time, ..view(&data) };
        let frame = drawn(60, 11, |area, buffer| Events::default().draw(&view, area, buffer));
        let rows: Vec<&str> = frame.lines().collect();
        assert!(
            rows[1].contains("number 53") && rows[4].contains("number 50") && rows[9].contains("number 45"),
            "{frame}"
        );
    }

    #[test]
    fn nothing_is_told_as_such() {
        let data = tests::frame_data();
        let frame = drawn(40, 4, |area, buffer| Events::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("nothing has happened"), "{frame}");
    }

    #[test]
    fn a_long_list_is_scrolled_and_filtered() {
        let now = std::time::Instant::now();
        let mut feed = Feed::new("");
        let settings = tests::bench_status("three-mass", "composite").settings.get().clone();
        for number in 1..=40 {
            let text = format!("{} {number}", if number % 4 == 0 { "Hum" } else { "quiet" });
            feed.push_event(&event(number, &Happening::Note(text), &settings));
        }
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let mut events = Events::default();
        let frame_of = |events: &mut Events, filter: &str| {
            let area = Rect::new(0, 0, 80, 7);
            let mut buffer = Buffer::empty(area);
            events.draw(&View { filter, ..view(&data) }, area, &mut buffer);
            crate::screenshot::image::text(&buffer)
        };
        assert!(frame_of(&mut events, "").contains("35 more ▼"));
        events.scroll(10);
        let middle = frame_of(&mut events, "");
        assert!(
            middle.contains("10 more ▲") && middle.contains("quiet 30") && middle.contains("25 more ▼"),
            "{middle}"
        );
        let hums = frame_of(&mut events, "note hum");
        assert!(
            hums.contains(" events  /note hum 10 of 40 ") && hums.contains("Hum 4") && !hums.contains("quiet"),
            "{hums}"
        );
    }
}
