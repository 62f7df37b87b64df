//! What the player shows: the line at the top, the line of time below it, and the machine beside the recorded one.
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
use wire::message::{Flags, Trip};

use super::branch::Branch;
use super::loaded::Loaded;
use super::player::{Player, Repeat};
use super::{PastEvent, PastWhat};
use crate::panels::status::draw_alarms;
use crate::picture::Picture;
use crate::plot::short;
use crate::screen::View;
use crate::theme;

/// What is shown of a player beside the picture.
#[derive(Clone, Debug)]
pub(crate) struct Show<'a> {
    name: String,
    /// The step we stand at, and the first and the last.
    seq: u64,
    ends: [u64; 2],
    rate: f64,
    playing: bool,
    speed: f64,
    repeat: Repeat,
    events: &'a [PastEvent],
    missing: &'a [std::ops::Range<u64>],
    notices: Vec<String>,
    /// Whether alarms were judged while it was made.
    pub(crate) judged: bool,
    pub(crate) beside: Option<Beside<'a>>,
}

/// The machine that is run on beside the recorded one, by the steps of the picture's track.
#[derive(Clone, Copy)]
pub(crate) struct Beside<'a> {
    branch: &'a Branch,
    loaded: &'a Loaded,
    /// Place of the track's first step.
    first: u64,
    /// The step we stand at.
    seq: u64,
}

impl std::fmt::Debug for Beside<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Beside").field("from", &self.branch.from()).finish_non_exhaustive()
    }
}

impl Beside<'_> {
    /// Displacement `[y, z]` of a mass at step `step` of the track; none before it begins.
    pub(crate) fn place(&self, step: usize, mass: usize) -> Option<[f64; 2]> {
        self.branch.place(self.loaded.seq_of(self.first + step as u64), mass)
    }

    /// Control `[y, z]` at step `step` of the track.
    pub(crate) fn force(&self, step: usize) -> Option<[f64; 2]> {
        self.branch.force(self.loaded.seq_of(self.first + step as u64))
    }

    fn trip(&self) -> Option<Trip> {
        self.branch.trip()
    }
}

impl Player {
    /// Makes a picture of the feed one of the moment we stand at: what is live elsewhere is of that moment here.
    pub(crate) fn finish(&self, picture: &mut Picture) {
        picture.tripped = picture.now.is_some_and(|now| picture.track.flags(now).has(Flags::TRIPPED));
        picture.lost = self.missing.iter().map(|gap| self.seq().min(gap.end).saturating_sub(gap.start)).sum();
        picture.rate = if self.is_playing() { self.rate() * self.speed() } else { 0.0 };
        picture.age = None;
    }

    /// What is shown of it beside the picture.
    pub(crate) fn shown(&self, picture: &Picture) -> Show<'_> {
        let beside = |branch| Beside { branch, loaded: &self.loaded, first: picture.track.first(), seq: self.seq() };
        Show {
            name: self.name(),
            seq: self.seq(),
            ends: self.ends(),
            rate: self.rate(),
            playing: self.is_playing(),
            speed: self.speed(),
            repeat: self.repeat,
            events: &self.events,
            missing: &self.missing,
            notices: self.notices(),
            judged: self.judged,
            beside: self.branch.as_ref().map(beside),
        }
    }
}

/// An event in a line: what, by whom, why.
pub(super) fn words(event: &PastEvent) -> String {
    let PastEvent { what, who, why, .. } = event;
    let by = if who.is_empty() || who == "sim" { String::new() } else { format!(" by {who}") };
    let why = if why.is_empty() { String::new() } else { format!(" ({why})") };
    format!("{what}{by}{why}")
}

/// `12:34.567`, or with hours.
fn clock(seconds: f64) -> String {
    let (minutes, rest) = ((seconds / 60.0).floor(), seconds.rem_euclid(60.0));
    let hours = (minutes / 60.0).floor();
    let minutes = minutes - 60.0 * hours;
    if hours > 0.0 { format!("{hours}:{minutes:02}:{rest:06.3}") } else { format!("{minutes:02}:{rest:06.3}") }
}

/// The line at the top.
pub(crate) fn draw_top(show: &Show<'_>, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let picture = view.picture;
    let mut line = vec![Span::styled(" REPLAY ", theme::badge(theme::KEY))];
    let mut add = |text: String, style: Style| line.push(Span::styled(text, style));
    let plain = Style::new();
    let sign = if show.playing { "▶" } else { "■" };
    add(format!(" {sign} {}x  ", show.speed), plain.bold());
    if picture.tripped {
        let why = picture.trip().map_or_else(String::new, |trip| format!(": {trip}"));
        add(format!("TRIPPED{why}  "), theme::loud(theme::BAD));
    }
    if let Some(beside) = &show.beside {
        add(what_if(beside, picture), theme::loud(theme::CANDIDATE));
    }
    add(show.name.clone(), plain.bold());
    let at = |seq: u64| clock((seq - show.ends[0].min(seq)) as f64 / show.rate);
    add(format!("  {} of {}", at(show.seq), at(show.ends[1])), plain);
    if let Some(now) = picture.now {
        add(format!("  tau {}", short(picture.track.tau(now), 6)), plain);
    }
    add(format!("  step {}", show.seq), plain);
    match show.repeat {
        Repeat::Off => {}
        Repeat::From(from) => add(format!("  loop from {}", at(from)), theme::loud(theme::KEY)),
        Repeat::Over(from, to) => add(format!("  loop {}..{}", at(from), at(to)), theme::loud(theme::KEY)),
    }
    if let (Some(bulletin), Some(settings)) = (&picture.bulletin, &picture.settings) {
        add(format!("  {}  R {}", bulletin.rotor_name.as_str(), short(settings.speed, 4)), plain);
    }
    Line::from(line).render(area, buffer);
    draw_alarms(view.alarms, area, buffer);
}

/// `WHAT IF from tau 120.00: min damping 0.0120 beside -0.0030`.
fn what_if(beside: &Beside<'_>, picture: &Picture) -> String {
    let from = short(beside.branch.tau(), 5);
    let lag = beside.branch.lag(beside.seq);
    if lag > 0 {
        let (way, gone) = (beside.seq - beside.branch.from(), beside.seq - beside.branch.from() - lag);
        return format!("WHAT IF from tau {from}: running on, {} % of the way  ", 100 * gone / way.max(1));
    }
    let damping =
        |damping: Option<f64>| damping.map_or_else(|| "unknown".to_owned(), |damping| format!("{damping:.4}"));
    let here = damping(beside.branch.judged().map(|judged| judged.min_damping));
    let recorded = damping(picture.poles().map(|(least, _)| least));
    let trip = if beside.trip().is_some() { ", TRIPS" } else { "" };
    format!("WHAT IF from tau {from}: min damping {here} beside {recorded}{trip}  ")
}

/// The line of time: what happened where, and where we stand.
pub(crate) fn draw_time(show: &Show<'_>, area: Rect, buffer: &mut Buffer) {
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
    if let Repeat::Over(from, to) = show.repeat {
        (column(from)..=column(to)).for_each(|x| put(x, "━", theme::loud(theme::KEY)));
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
        put(column(beside.branch.from()), "◆", theme::loud(theme::CANDIDATE));
    }
    put(column(show.seq), "█", theme::loud(theme::KEY));
    let rest = Rect { x: bar.right(), width: told, ..area };
    Line::styled(format!(" {notice}"), theme::loud(theme::WARN)).render(rest, buffer);
}

/// How important an event is, and how it is drawn.
fn sign_of(what: &PastWhat) -> (u8, &'static str, Color) {
    let happening = match what {
        PastWhat::Happening(happening) => happening,
        PastWhat::Alarm(turn) => match turn.level {
            Level::Alarm => return (2, "!", theme::BAD),
            Level::Warning => return (1, "!", theme::WARN),
            Level::Fine => return (0, "╎", theme::GRID),
        },
        PastWhat::Remark(_) => return (0, "╎", theme::GRID),
    };
    match happening {
        Happening::Tripped(_) => (2, "✗", theme::BAD),
        Happening::Note(_) => (2, "▼", theme::GOOD),
        Happening::Settings => (1, "◇", theme::FORWARD),
        Happening::Impulse { .. } | Happening::Restarted => (1, "↑", theme::WARN),
        Happening::Refused { .. } | Happening::Late { .. } | Happening::Started | Happening::Ended => {
            (0, "╎", theme::GRID)
        }
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
