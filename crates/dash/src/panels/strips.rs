//! Strips of y, z and control over the window of time, with what they are under the cursor.
//!
//! ```text
//! ┌ last 41 tau  1 2 3 ─────────────┐
//! │y ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀   ±5 │
//! │z ⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈     ±5 │
//! │u ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀   ±1 │
//! └ 4.1 s ──────────────────────────┘
//! ```

use std::ops::Range;

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Margin, Position, Rect};
use ratatui::style::Color;
use ratatui::text::{Line, Span};

use super::registry::{Intent, Mouse, Panel};
use super::{framed, write, write_right};
use crate::actions::Action;
use crate::history::{Channel, Mark};
use crate::plot::{Plot, Window, nice_ceiling, short};
use crate::replay::Beside;
use crate::screen::View;
use crate::theme;

/// The strips: a click looks at a moment, the wheel zooms.
pub(crate) struct Strips;

impl Panel for Strips {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, area, buffer);
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<Intent> {
        let inner = area.inner(Margin::new(1, 1));
        match mouse {
            Mouse::Wheel(notches) => Some(Intent::Do(Action::Zoom(if notches > 0 { 1.25 } else { 0.8 }))),
            Mouse::Click | Mouse::Drag(_) if inner.contains(at) => {
                let window = &view.picture.window;
                let along = (f64::from(at.x - inner.x) + 0.5) / f64::from(inner.width);
                let step = window.start + (along * window.len() as f64) as usize;
                (!window.is_empty()).then(|| Intent::Look(view.picture.track.first() + step as u64))
            }
            Mouse::Click | Mouse::Drag(_) => None,
        }
    }
}

/// One line of a strip.
type Trace = (Color, Channel);
/// The middle of a column of dots, in steps, and the range of a quantity over it.
type Column = (f64, [f64; 2]);

fn draw(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let picture = view.picture;
    let window = picture.window.clone();
    // A strip of more masses than colours would be a tangle: the first few stand for all.
    let masses = picture.masses().min(theme::TRACES.len());
    let dtau = picture.bulletin.as_ref().map_or(0.0, |bulletin| bulletin.dtau);
    let tau = short(window.len() as f64 * dtau, 3);
    let which = if view.time.is_live() { "last " } else { "" };
    let mut title = vec![Span::raw(format!(" {which}{tau} tau  mass "))];
    title.extend((0..masses).map(|mass| Span::styled(format!("{} ", mass + 1), theme::loud(theme::TRACES[mass]))));
    let inner = framed(Line::from(title), area, buffer);
    if window.is_empty() {
        return;
    }
    if area.height > 1 {
        let label = format!(" {} s ", short(window.len() as f64 * picture.seconds, 3));
        let edge = Rect { width: area.width.saturating_sub(2), ..area };
        write(buffer, edge, area.left() + 1, area.bottom() - 1, &label, theme::quiet());
    }
    let of_masses = |channel: fn(usize) -> Channel| -> Vec<Trace> {
        (0..masses).map(|mass| (theme::TRACES[mass], channel(mass))).collect()
    };
    let force = vec![(theme::BACKWARD, Channel::ForceZ), (theme::FORCE, Channel::ForceY)];
    let rows = Layout::vertical([Constraint::Fill(1); 3]).split(inner);
    let strips = [("y", of_masses(Channel::Y)), ("z", of_masses(Channel::Z)), ("u", force)];
    for ((name, traces), row) in strips.into_iter().zip(rows.iter()) {
        strip(name, &traces, view, *row, buffer);
    }
}

fn strip(name: &str, traces: &[Trace], view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let picture = view.picture;
    let columns = usize::from(area.width) * 2;
    if columns == 0 {
        return;
    }
    // Every column of dots shows the range of its steps, so that no peak falls between two columns.
    let steps = picture.track.columns(picture.window.clone(), columns);
    let ranges: Vec<(Color, Vec<Column>)> = traces
        .iter()
        .map(|(color, channel)| {
            let range = |steps: Range<usize>| {
                let middle = 0.5 * (steps.start + steps.end) as f64;
                (middle, picture.track.range(*channel, steps).unwrap_or([0.0, 0.0]))
            };
            (*color, steps.clone().map(range).collect())
        })
        .collect();
    let all = ranges.iter().flat_map(|(_, columns)| columns);
    let reach = all.fold(0.0, |reach: f64, (_, [low, high])| reach.max(-low).max(*high));
    let beside = view.replay.as_ref().and_then(|replay| replay.beside);
    let others: Vec<Vec<Column>> =
        traces.iter().filter_map(|(_, channel)| Some(beside_columns(&beside?, *channel, steps.clone()))).collect();
    let other = others.iter().flatten().fold(0.0, |reach: f64, (_, [low, high])| reach.max(-low).max(*high));
    // A machine that runs away beside this one must not make a line of it.
    let scale = nice_ceiling(if reach > 0.0 { reach.max(other.min(4.0 * reach)) } else { other });
    let [left, right] = [picture.window.start as f64, picture.window.end as f64];
    let mut plot = Plot::new(area, Window { x: [left, right], y: [-scale, scale] });
    plot.line([left, 0.0], [right, 0.0], theme::GRID);
    let mut upright = |step: usize, color| {
        let x = step as f64 + 0.5;
        plot.line([x, -scale], [x, scale], color);
    };
    for (step, mark) in &picture.marks {
        match mark {
            Mark::Lost(_) | Mark::Trip => upright(*step, theme::BAD),
            Mark::NewRun | Mark::Restart => upright(*step, theme::WARN),
            Mark::Note => upright(*step, theme::FORWARD),
            Mark::Settings(_) => {}
        }
    }
    let cursor = picture.now.filter(|_| !view.time.is_live());
    if let Some(now) = cursor {
        upright(now, theme::WARN);
    }
    let recorded = ranges.iter().map(|(color, columns)| (*color, columns));
    for (color, columns) in others.iter().map(|columns| (theme::CANDIDATE, columns)).chain(recorded) {
        for (at, (x, [low, high])) in columns.iter().enumerate() {
            plot.line([*x, *low], [*x, *high], color);
            if let Some((next, [bottom, _])) = columns.get(at + 1) {
                plot.line([*x, *high], [*next, *bottom], color);
            }
        }
    }
    plot.paint(buffer);
    write(buffer, area, area.left(), area.top(), name, theme::quiet());
    write_right(buffer, area, area.top(), &format!("±{}", short(scale, 1)), theme::quiet());
    if let Some(now) = cursor {
        let mut x = area.left() + 2;
        for (color, channel) in traces {
            let text = short(picture.track.value(*channel, now), 4);
            write(buffer, area, x, area.top(), &text, theme::loud(*color));
            x += text.chars().count() as u16 + 1;
        }
    }
}

/// The range of a quantity of the machine beside, column by column, as far as it has come.
fn beside_columns(beside: &Beside<'_>, channel: Channel, columns: impl Iterator<Item = Range<usize>>) -> Vec<Column> {
    let value = |step| match channel {
        Channel::Y(mass) => beside.place(step, mass).map(|[y, _]| y),
        Channel::Z(mass) => beside.place(step, mass).map(|[_, z]| z),
        Channel::ForceY => beside.force(step).map(|[y, _]| y),
        Channel::ForceZ => beside.force(step).map(|[_, z]| z),
        _ => None,
    };
    let of = |steps: Range<usize>| {
        let middle = 0.5 * (steps.start + steps.end) as f64;
        let values = steps.filter_map(value).map(|value| [value, value]);
        Some((middle, values.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)])?))
    };
    columns.filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::tests;
    use crate::panels::tests::drawn;
    use crate::screen::tests::view;
    use crate::view_time::ViewTime;

    #[test]
    fn y_z_and_control_each_have_a_strip() {
        let picture = tests::picture();
        let frame = drawn(60, 11, |area, buffer| draw(&view(&picture), area, buffer));
        for sign in ["│y", "│z", "│u", "last 30.0 tau"] {
            assert!(frame.contains(sign), "{sign}:\n{frame}");
        }
        insta::assert_snapshot!("strips", frame);
    }

    #[test]
    fn the_cursor_reads_what_was_and_losses_are_marked() {
        let now = std::time::Instant::now();
        let mut feed = crate::feed::Feed::new("");
        feed.read(tests::bulletin("three-mass", "composite"));
        (0..2000).chain(2100..4000).for_each(|seq| feed.hear(&tests::state(3, seq), now));
        let mut time = ViewTime::LIVE;
        time.at(1000, &feed.history().places(), feed.seconds());
        let picture = feed.picture(&time, now);
        let seen = View { time: &time, ..view(&picture) };
        let frame = drawn(60, 11, |area, buffer| draw(&seen, area, buffer));
        let at = tests::state(3, 1000);
        for value in [at.masses[0].y, at.masses[2].z, at.force_delivered[0]] {
            assert!(frame.contains(&short(value, 4)), "{value}:\n{frame}");
        }
        insta::assert_snapshot!("strips_with_cursor", frame);
    }

    #[test]
    fn a_peak_of_one_step_is_seen() {
        let now = std::time::Instant::now();
        let mut feed = crate::feed::Feed::new("");
        for seq in 0..4000 {
            let mut state = tests::state(1, seq);
            state.masses[0].y = if seq == 2222 { 4.9 } else { 0.0 };
            feed.hear(&state, now);
        }
        let picture = feed.picture(&ViewTime::LIVE, now);
        let frame = drawn(40, 14, |area, buffer| draw(&view(&picture), area, buffer));
        assert!(frame.contains("±5"), "{frame}");
    }
}
