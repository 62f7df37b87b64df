//! The two lines of a player: how it plays, and what happened where.
//!
//! ```text
//!  REPLAY ▶ 2x  s.rrd  00:12.345 of 10:00.000  tau 123.45  step 12345  loop  WHAT IF from tau 120.00: damping 0.012, was -0.003
//! ├──────◇───────█───╎─────░░─────✗──┤ 12 steps are missing in 1 places, the first at step 7
//! ```

use alarms::Level;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::Widget;
use wire::Happening;

use crate::status_line::draw_alarms;
use crate::theme;
use crate::view::View;
use telemetry::frame_data::FrameData;
use telemetry::replay::{LoopRange, RecordedKind, ReplayStatus, WhatIfRun};
use text::number::short;

/// `12:34.567`, or with hours.
fn clock(seconds: f64) -> String {
    let (minutes, rest) = ((seconds / 60.0).floor(), seconds.rem_euclid(60.0));
    let hours = (minutes / 60.0).floor();
    let minutes = minutes - 60.0 * hours;
    if hours > 0.0 { format!("{hours}:{minutes:02}:{rest:06.3}") } else { format!("{minutes:02}:{rest:06.3}") }
}

/// The line at the top.
pub(crate) fn draw_top(show: &ReplayStatus<'_>, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let mut line = vec![Span::styled(" REPLAY ", theme::badge(theme::KEYPHASOR))];
    let mut add = |text: String, style: Style| line.push(Span::styled(text, style));
    let plain = Style::new();
    let sign = if show.playing { "▶" } else { "■" };
    add(format!(" {sign} {}x  ", show.speed), plain.bold());
    if data.tripped {
        let why = data.trip().map_or_else(String::new, |trip| format!(": {}", data.units().trip(&trip)));
        add(format!("TRIPPED{why}  "), theme::loud(theme::BAD));
    }
    if let Some(beside) = &show.beside {
        add(what_if(beside, data), theme::loud(theme::CANDIDATE));
    }
    add(show.name.clone(), plain.bold());
    let at = |seq: u64| clock((seq - show.ends[0].min(seq)) as f64 / show.rate);
    add(format!("  {} of {}", at(show.seq), at(show.ends[1])), plain);
    if let Some(now) = data.now {
        add(format!("  {}", data.units().moment_told(data.track.tau(now), 6)), plain);
    }
    add(format!("  step {}", show.seq), plain);
    match show.repeat {
        LoopRange::Off => {}
        LoopRange::From(from) => add(format!("  loop from {}", at(from)), theme::loud(theme::KEYPHASOR)),
        LoopRange::Over(from, to) => add(format!("  loop {}..{}", at(from), at(to)), theme::loud(theme::KEYPHASOR)),
    }
    if let (Some(bench_status), Some(settings)) = (&data.bench_status, &data.settings) {
        let speed = data.units().speed_told(settings.speed);
        add(format!("  {}  {speed}", bench_status.rotor_name.as_str()), plain);
    }
    Line::from(line).render(area, buffer);
    draw_alarms(view.alarms, area, buffer);
}

/// `WHAT IF from tau 120.00: min damping 0.0120 beside -0.0030`.
fn what_if(beside: &WhatIfRun<'_>, data: &FrameData) -> String {
    let from = short(beside.tau(), 5);
    let lag = beside.lag();
    if lag > 0 {
        let way = beside.length();
        let gone = way - lag;
        return format!("WHAT IF from tau {from}: running on, {} % of the way  ", 100 * gone / way.max(1));
    }
    let damping =
        |damping: Option<f64>| damping.map_or_else(|| "unknown".to_owned(), |damping| format!("{damping:.4}"));
    let here = damping(beside.min_damping());
    let recorded = damping(data.poles().map(|(least, _)| least));
    let trip = if beside.trip().is_some() { ", TRIPS" } else { "" };
    format!("WHAT IF from tau {from}: min damping {here} beside {recorded}{trip}  ")
}

/// The line of time: what happened where, and where we stand.
pub(crate) fn draw_time(show: &ReplayStatus<'_>, area: Rect, buffer: &mut Buffer) {
    if area.height == 0 || area.width < 4 {
        return;
    }
    let [first, last] = show.ends;
    let notice = show.notices.join("; ");
    let told = (notice.chars().count() as u16 + 1).min(area.width / 2);
    let told = if notice.is_empty() { 0 } else { told };
    let bar = Rect { width: area.width - told, ..area };
    let columns = u64::from(bar.width - 2);
    let column = |seq: u64| {
        let along = (seq.clamp(first, last) - first) as f64 / (last - first).max(1) as f64;
        bar.x + 1 + (along * (columns - 1) as f64).round() as u16
    };
    let mut put = |x: u16, sign: &str, style: Style| {
        buffer[(x, bar.y)].set_symbol(sign).set_style(style);
    };
    (bar.left()..bar.right()).for_each(|x| put(x, "─", theme::quiet()));
    put(bar.left(), "├", theme::quiet());
    put(bar.right() - 1, "┤", theme::quiet());
    if let LoopRange::Over(from, to) = show.repeat {
        (column(from)..=column(to)).for_each(|x| put(x, "━", theme::loud(theme::KEYPHASOR)));
    }
    for gap in show.missing {
        (column(gap.start)..=column(gap.end)).for_each(|x| put(x, "░", theme::loud(theme::WARN)));
    }
    // The most important last, on top of what shares its place.
    for rank in 0..3 {
        for event in show.events {
            let (of, sign, color) = sign_of(&event.what);
            if of == rank && (first..=last).contains(&event.at.seq) {
                put(column(event.at.seq), sign, theme::loud(color));
            }
        }
    }
    if let Some(beside) = &show.beside {
        put(column(beside.from()), "◆", theme::loud(theme::CANDIDATE));
    }
    put(column(show.seq), "█", theme::loud(theme::KEYPHASOR));
    let rest = Rect { x: bar.right(), width: told, ..area };
    Line::styled(format!(" {notice}"), theme::loud(theme::WARN)).render(rest, buffer);
}

/// How important an event is, and how it is drawn.
fn sign_of(what: &RecordedKind) -> (u8, &'static str, Color) {
    let happening = match what {
        RecordedKind::Happening(happening) => happening,
        RecordedKind::Alarm(turn) => match turn.level {
            Level::Alarm => return (2, "!", theme::BAD),
            Level::Warning => return (1, "!", theme::WARN),
            Level::Fine => return (0, "╎", theme::GRID),
        },
        RecordedKind::Remark(_) => return (0, "╎", theme::GRID),
    };
    match happening {
        Happening::Tripped(_) => (2, "✗", theme::BAD),
        Happening::Note(_) => (2, "▼", theme::FORWARD),
        Happening::Settings | Happening::Excited(_) => (1, "◇", theme::FORWARD),
        Happening::Impulse { .. } | Happening::Restarted => (1, "↑", theme::CANDIDATE),
        Happening::Refused { .. }
        | Happening::Late { .. }
        | Happening::Started
        | Happening::Ended
        | Happening::ExcitationOver => (0, "╎", theme::GRID),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_as_clocks() {
        for (seconds, text) in
            [(0.0, "00:00.000"), (12.3456, "00:12.346"), (754.5, "12:34.500"), (3661.0, "1:01:01.000")]
        {
            assert_eq!(clock(seconds), text);
        }
    }
}
