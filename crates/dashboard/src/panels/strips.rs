//! Strips of chosen series over the window of time, with what they are under the cursor.
//!
//! ```text
//! ┌ last 41 tau  mass 1 2 3 ────────┐
//! │y ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀   ±5 │   one strip a word of `:strips`; "=" before a scale that stands still
//! │z ⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈     ±5 │
//! │u ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀   ±1 │   with a cursor, its values there
//! └ 4.1 s ───────-2──────-1─────────┘   seconds before the end; a strip of three rows or fewer shows how far its lines reach within a turn
//! ```

use std::ops::Range;

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Margin, Position, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};

use super::panel::{Panel, PanelCommand, PanelRequest};
use super::{look_at, wheel_times};
use crate::axis::{PlotAxis, Scaling};
use crate::drawing::{framed, write, write_right};
use crate::fit_text::width;
use crate::input::Mouse;
use crate::series::{Strip, Trace};

use crate::plot::{Plot, Window};
use crate::theme;
use crate::ticks;
use crate::view::View;
use telemetry::history::{Mark, StepQuantity};
use telemetry::replay::WhatIfRun;
use telemetry::units::Unit;
use text::number::{neat, nice_ceiling, short};

/// What strips show if neither a person nor the layout says otherwise.
const USUAL: &str = "y z u";
/// The share of the width that the unit of a scale may take.
const ROOM_FOR_UNIT: usize = 8;
/// Rows up to which a strip of several lines is one of how far they reach.
const LOW: u16 = 3;
/// Height from which the lines of a strip are told apart by marks too.
const ROOM_FOR_MARKS: u16 = 4;

/// The strips: a click looks at a moment, the wheel shows more or less time.
pub(crate) struct Strips {
    usual: Vec<Strip>,
    /// What the layout wants to be shown.
    of_layout: Option<Vec<Strip>>,
    /// What a person wants to be shown.
    chosen: Option<Vec<Strip>>,
    /// The scale of every strip that has ever been shown, by its name.
    scales: Vec<(String, PlotAxis)>,
    /// The mass that a person looks at, counted from 0; that with the control bearing if there is none.
    mass: Option<usize>,
}

impl Default for Strips {
    fn default() -> Self {
        let usual = Strip::read_all(USUAL).unwrap_or_default();
        Self { usual, of_layout: None, chosen: None, scales: Vec::new(), mass: None }
    }
}

impl Strips {
    fn shown(&self) -> &[Strip] {
        self.chosen.as_ref().or(self.of_layout.as_ref()).unwrap_or(&self.usual)
    }

    /// The scale of a strip.
    fn scale(&mut self, name: &str) -> &mut PlotAxis {
        let at = self.scales.iter().position(|(of, _)| of == name).unwrap_or(self.scales.len());
        if at == self.scales.len() {
            self.scales.push((name.to_owned(), PlotAxis::default()));
        }
        &mut self.scales[at].1
    }

    /// Scales the strip `name`, or all that are shown.
    fn rescale(&mut self, name: Option<&str>, scaling: Scaling) -> Option<Result<(), String>> {
        let shown: Vec<String> = self.shown().iter().map(|strip| strip.name.clone()).collect();
        let meant = |strip: &&String| name.is_none_or(|name| name == **strip);
        let done = shown.iter().filter(meant).map(|strip| self.scale(strip).take(scaling, None));
        done.reduce(Result::and)
    }
}

impl Panel for Strips {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, self, area, buffer);
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        match mouse {
            Mouse::Wheel(notches) => Some(PanelRequest::ZoomTime(wheel_times(notches))),
            Mouse::Click | Mouse::Drag(_) => {
                let inner = area.inner(Margin::new(1, 1));
                look_at(view.data, &view.data.window, inner, at)
            }
        }
    }

    fn told_at(&self, view: &View<'_>, area: Rect, at: Position) -> Option<String> {
        let (data, inner) = (view.data, area.inner(Margin::new(1, 1)));
        let window = &data.window;
        if !inner.contains(at) || window.is_empty() {
            return None;
        }
        let along = (f64::from(at.x - inner.x) + 0.5) / f64::from(inner.width);
        let step = window.start + (along * window.len() as f64) as usize;
        let rows = Layout::vertical(vec![Constraint::Fill(1); usize::from(inner.height).min(self.shown().len())]);
        let row = rows.split(inner).iter().position(|row| row.contains(at))?;
        let strip = self.shown().get(row)?;
        let unit = strip.unit(&data.units());
        let value = |trace: &Trace| Some(format!("{} {}", trace.label, unit.short(trace.value(data, step)?, 5)));
        let values: Vec<String> = strip.traces(data.track.layout()).iter().filter_map(value).collect();
        let ago = (window.end - 1 - step) as f64 * data.seconds;
        let (ago, moment) = (short(-ago, 4), data.units().moment_told(data.track.tau(step), 6));
        Some(format!("{ago} s  {moment}  {} {}", values.join("  "), unit.name))
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        match command {
            PanelCommand::Value(scalings) => self.rescale(None, *scalings.first()?),
            PanelCommand::Strip(name, scalings) => self.rescale(Some(name), *scalings.first()?),
            PanelCommand::Strips(strips) => {
                self.chosen = strips.map(<[Strip]>::to_vec);
                Some(Ok(()))
            }
            PanelCommand::Mass(mass) => {
                self.mass = *mass;
                Some(Ok(()))
            }
            PanelCommand::StripsOfLayout(strips) => {
                if self.of_layout.as_deref() != *strips {
                    self.of_layout = strips.map(<[Strip]>::to_vec);
                }
                Some(Ok(()))
            }
            _ => None,
        }
    }
}

/// The middle of a column of dots, in steps, and the range of a quantity over it.
type Column = (f64, [f64; 2]);

fn draw(view: &View<'_>, strips: &mut Strips, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let window = data.window.clone();
    let dtau = data.bench_status.as_ref().map_or(0.0, |bench_status| bench_status.dtau);
    let lasts = data.units().time_told(window.len() as f64 * dtau, 3);
    let which = if view.time.is_live() { "last " } else { "" };
    let mut title = vec![Span::raw(format!(" {which}{lasts} "))];
    let shown = strips.shown().to_vec();
    if shown.iter().any(Strip::is_of_every_mass) {
        title.push(Span::raw(" mass "));
        let masses = data.masses().min(theme::TRACES.len());
        title.extend((0..masses).map(|mass| Span::styled(format!("{} ", mass + 1), theme::loud(theme::TRACES[mass]))));
    }
    let inner = framed(Line::from(title), area, buffer);
    if window.is_empty() {
        return;
    }
    if area.height > 1 {
        let label = format!(" {} s ", short(window.len() as f64 * data.seconds, 3));
        let edge = Rect { width: area.width.saturating_sub(2), ..area };
        write(buffer, edge, area.left() + 1, area.bottom() - 1, &label, theme::quiet());
    }
    // What has no row of its own is left out, and said to be.
    let room = usize::from(inner.height).min(shown.len());
    if room < shown.len() && room > 0 {
        let edge = Rect { width: area.width.saturating_sub(1), ..area };
        write_right(
            buffer,
            edge,
            area.bottom() - 1,
            &format!(" {} more ▼ ", shown.len() - room),
            theme::loud(theme::CURSOR),
        );
    }
    let rows = Layout::vertical(vec![Constraint::Fill(1); room]).split(inner);
    let on_top = strips.mass.unwrap_or_else(|| data.bearing_mass());
    let units = data.units();
    for (strip, row) in shown.iter().zip(rows.iter()) {
        let unit = strip.unit(&units);
        draw_strip(strip, unit, strips.scale(&strip.name), view, (on_top, area, *row), buffer);
    }
    // Seconds before the end of what is shown.
    let seconds = window.len() as f64 * data.seconds;
    let column = |at: f64| {
        let along = 1.0 + at / seconds;
        (0.0..1.0).contains(&along).then(|| inner.x + (along * f64::from(inner.width)) as u16)
    };
    ticks::level(area, [-seconds, 0.0], column, buffer);
}

fn draw_strip(
    strip: &Strip,
    unit: Unit,
    axis: &mut PlotAxis,
    view: &View<'_>,
    (on_top, frame, area): (usize, Rect, Rect),
    buffer: &mut Buffer,
) {
    let data = view.data;
    let columns = usize::from(area.width) * 2;
    if columns == 0 {
        return;
    }
    let traces = strip.traces(data.track.layout());
    // Every column of dots shows the range of its steps, so that no peak falls between two columns.
    let steps = data.track.columns(data.window.clone(), columns);
    let columns_of = |trace: &Trace| -> Vec<Column> {
        let range = |steps: Range<usize>| {
            let middle = 0.5 * (steps.start + steps.end) as f64;
            let [low, high] = trace.range(data, steps)?;
            Some((middle, [low * unit.factor, high * unit.factor]))
        };
        steps.clone().filter_map(range).collect()
    };
    let lines: Vec<Vec<Column>> = traces.iter().map(columns_of).collect();
    let beside = view.replay.as_ref().and_then(|replay| replay.beside);
    let columns_beside = |trace: &Trace| {
        let factor = unit.factor * data.factor_of(trace.channel?);
        Some(beside_columns(&beside?, trace.channel?, factor, steps.clone()))
    };
    let others: Vec<Vec<Column>> = traces.iter().filter_map(columns_beside).collect();
    let [bottom, top] = axis.over(whole(&lines, &others, strip.is_size()));
    let [left, right] = [data.window.start as f64, data.window.end as f64];
    let mut plot = Plot::new(area, Window { x: [left, right], y: [bottom, top] });
    plot.line([left, 0.0], [right, 0.0], theme::GRID);
    let mut upright = |step: usize, color| {
        let x = step as f64 + 0.5;
        plot.line([x, bottom], [x, top], color);
    };
    for (step, mark) in &data.marks {
        match mark {
            Mark::Lost(_) | Mark::Trip => upright(*step, theme::BAD),
            Mark::NewRun | Mark::Restart => upright(*step, theme::CANDIDATE),
            Mark::Note => upright(*step, theme::FORWARD),
            Mark::Settings(_) => {}
        }
    }
    let cursor = data.now.filter(|_| !view.time.is_live());
    if let Some(now) = cursor {
        upright(now, theme::CURSOR);
    }
    if area.height <= LOW && traces.len() > 1 {
        envelope(&lines, &traces, view, &mut plot);
    }
    // The first lies on top, and on it the mass that is looked at.
    let mut recorded: Vec<_> = traces.iter().map(|trace| trace.color).zip(&lines).rev().collect();
    if strip.is_of_every_mass() && on_top < recorded.len() {
        let chosen = recorded.remove(traces.len() - 1 - on_top);
        recorded.push(chosen);
    }
    let recorded = recorded.into_iter().filter(|_| area.height > LOW || traces.len() == 1);
    for (color, columns) in others.iter().map(|columns| (theme::CANDIDATE, columns)).chain(recorded) {
        for (at, (x, [low, high])) in columns.iter().enumerate() {
            plot.line([*x, *low], [*x, *high], color);
            if let Some((next, [bottom, _])) = columns.get(at + 1) {
                plot.line([*x, *high], [*next, *bottom], color);
            }
        }
    }
    plot.paint(buffer);
    if traces.len() > 1 && area.height >= ROOM_FOR_MARKS {
        for (trace, line) in traces.iter().zip(&lines).rev() {
            let at = line.last().and_then(|(_, [low, high])| plot.cell(right - 0.5, 0.5 * (low + high)));
            if let Some((_, y)) = at {
                write_right(buffer, area, y, &trace.mark.to_string(), theme::loud(trace.color));
            }
        }
    }
    ticks::upright(frame, area, [bottom, top], |value| plot.cell(left, value).map(|(_, y)| y), neat, buffer);
    let label = scale_text(
        [bottom, top],
        axis,
        if unit.name.len() * ROOM_FOR_UNIT <= usize::from(area.width) { unit.name } else { "" },
    );
    write_right(buffer, area, area.top(), &label, theme::quiet());
    let room = Rect { width: area.width.saturating_sub(width(&label) as u16), ..area };
    write_labels(strip, &traces, cursor.map(|now| (now, unit)), view, room, buffer);
}

/// Draws how far each line reaches within a turn of the rotor about each moment: what can still be read where there is no room for the
/// lines.
fn envelope(lines: &[Vec<Column>], traces: &[Trace], view: &View<'_>, plot: &mut Plot) {
    let data = view.data;
    let dtau = data.bench_status.as_ref().map_or(0.0, |bench_status| bench_status.dtau);
    let speed = data.now.map_or(0.0, |now| data.track.speed(now));
    let steps_a_turn = std::f64::consts::TAU / (speed * dtau);
    for (trace, line) in traces.iter().zip(lines).rev() {
        let [Some((first, _)), Some((last, _))] = [line.first(), line.last()] else { continue };
        let columns_a_turn = steps_a_turn * (line.len() - 1) as f64 / (last - first).max(1.0);
        // Half a turn to each side, unless the machine hardly turns.
        let reach = if columns_a_turn.is_finite() { (0.5 * columns_a_turn).ceil() as usize } else { 0 };
        let reach = reach.min(line.len() / 8);
        let about = |at: usize| {
            let near = &line[at.saturating_sub(reach)..(at + reach + 1).min(line.len())];
            near.iter().fold(line[at].1, |[a, b], (_, [low, high])| [a.min(*low), b.max(*high)])
        };
        for at in 1..line.len() {
            let (before, here) = (about(at - 1), about(at));
            for edge in [0, 1] {
                plot.line([line[at - 1].0, before[edge]], [line[at].0, here[edge]], trace.color);
            }
        }
    }
}

/// The range that shows all of some lines, and as much of others as leaves these readable.
fn whole(lines: &[Vec<Column>], others: &[Vec<Column>], is_size: bool) -> [f64; 2] {
    let reach = |lines: &[Vec<Column>], of: fn([f64; 2]) -> f64| {
        lines.iter().flatten().map(|(_, range)| of(*range)).fold(0.0, f64::max)
    };
    let low = |[low, _]: [f64; 2]| -low;
    let high = |[_, high]: [f64; 2]| high;
    let own = reach(lines, low).max(reach(lines, high));
    let other = reach(others, low).max(reach(others, high));
    // A machine that runs away beside this one must not make a line of it.
    let scale = nice_ceiling(if own > 0.0 { own.max(other.min(4.0 * own)) } else { other });
    match is_size {
        // A damping may be negative.
        true if reach(lines, low) > 0.0 => [-nice_ceiling(reach(lines, low)), scale],
        true => [0.0, scale],
        false => [-scale, scale],
    }
}

/// A range as a label.
fn scale_text([low, high]: [f64; 2], axis: &PlotAxis, unit: &str) -> String {
    let range = if low == -high { format!("±{}", neat(high)) } else { format!("{} to {}", neat(low), neat(high)) };
    format!("{}{range} {unit}", axis.sign()).trim_end().to_owned()
}

/// The name of a strip, or those of its lines; with the values under a cursor. Where they have no room, the marks of the lines
/// stand for their names, and what then has none is left out: half a number would mislead.
fn write_labels(
    strip: &Strip,
    traces: &[Trace],
    cursor: Option<(usize, Unit)>,
    view: &View<'_>,
    area: Rect,
    buffer: &mut Buffer,
) {
    let is_one = strip.is_of_every_mass() || strip.name == "u" || traces.is_empty();
    let value = |trace: &Trace| {
        let (now, unit) = cursor?;
        Some(unit.short(trace.value(view.data, now)?, 4))
    };
    let words = |short: bool| -> Vec<(String, Style)> {
        let mut words = if is_one { vec![(strip.name.clone(), theme::quiet())] } else { Vec::new() };
        for trace in traces {
            let style = theme::loud(trace.color);
            let name = if short { trace.mark.to_string() } else { trace.label.clone() };
            words.extend(Some((name, style)).filter(|_| !is_one));
            words.extend(value(trace).map(|value| (value, style)));
        }
        words
    };
    let wide = |words: &[(String, Style)]| words.iter().map(|(word, _)| width(word) + 1).sum::<usize>();
    let full = words(false);
    let words = if wide(&full) <= usize::from(area.width) { full } else { words(true) };
    let mut x = area.left();
    for (word, style) in words {
        let wide = width(&word) as u16 + 1;
        if x + wide > area.right() {
            break;
        }
        // What is drawn below must not run into the words.
        write(buffer, area, x, area.top(), &format!("{word} "), style);
        x += wide;
    }
}

/// The range of a quantity of the machine beside, column by column, as far as it has come.
fn beside_columns(
    beside: &WhatIfRun<'_>,
    channel: StepQuantity,
    factor: f64,
    columns: impl Iterator<Item = Range<usize>>,
) -> Vec<Column> {
    let value = |step| beside.value(channel, step);
    let of = |steps: Range<usize>| {
        let middle = 0.5 * (steps.start + steps.end) as f64;
        let values = steps.filter_map(value).map(|value| [value * factor; 2]);
        Some((middle, values.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)])?))
    };
    columns.filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use wire::Step;

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    #[test]
    fn y_z_and_control_each_have_a_strip() {
        let data = tests::frame_data();
        let frame = drawn(60, 11, |area, buffer| Strips::default().draw(&view(&data), area, buffer));
        for sign in ["│y", "│z", "│u", "last 30.0 tau"] {
            assert!(frame.contains(sign), "{sign}:\n{frame}");
        }
        insta::assert_snapshot!("strips", frame);
    }

    #[test]
    fn the_cursor_reads_what_was_and_losses_are_marked() {
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        (0..2000).chain(2100..4000).for_each(|seq| feed.push_step(&tests::state(3, seq), now));
        let mut time = ViewTime::LIVE;
        time.look_at(1000, &feed.history().kept(), feed.step_seconds());
        let data = feed.frame_data(&time, now);
        let seen = View { time: &time, ..view(&data) };
        let frame = drawn(60, 11, |area, buffer| Strips::default().draw(&seen, area, buffer));
        let at = tests::state(3, 1000);
        for value in [at.point(0).y, at.point(2).z, at.force_delivered()[0]] {
            assert!(frame.contains(&short(value, 4)), "{value}:\n{frame}");
        }
        insta::assert_snapshot!("strips_with_cursor", frame);
    }

    #[test]
    fn the_force_of_each_control_bearing_is_told_in_newtons_of_its_own() {
        let data = tests::frame_data_of_two_bearings();
        let strip = Strip::read("force+bearing.force.2").unwrap();
        let traces = strip.traces(data.track.layout());
        let unit = strip.unit(&data.units());
        let told: Vec<String> = traces.iter().map(|trace| unit.told(trace.value(&data, 99).unwrap(), 4)).collect();
        assert_eq!(told, ["54.00 N", "108.0 N"]);
        let ranges: Vec<f64> =
            traces.iter().map(|trace| trace.range(&data, 0..100).unwrap()[1] * unit.factor).collect();
        assert!((ranges[0] - 54.0).abs() < 1e-9 && (ranges[1] - 108.0).abs() < 1e-9, "{ranges:?}");
    }

    #[test]
    fn chosen_strips_have_their_names_their_values_under_the_cursor_and_their_units() {
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        (0..4000).for_each(|seq| feed.push_step(&tests::state(3, seq), now));
        let mut time = ViewTime::LIVE;
        time.look_at(1000, &feed.history().kept(), feed.step_seconds());
        let data = feed.frame_data(&time, now);
        let seen = View { time: &time, ..view(&data) };
        let chosen = Strip::read_all("radius.2 y.1+z.1 force damping speed").unwrap();
        let mut strips = Strips::default();
        strips.command(&PanelCommand::Strips(Some(&chosen)));
        strips.command(&PanelCommand::Strip("speed", &[Scaling::Fix([2.0, 3.0])]));
        let strips = std::cell::RefCell::new(strips);
        let frame = drawn(90, 22, |area, buffer| strips.borrow_mut().draw(&seen, area, buffer));
        let [y, z] = data.track.displacement(1000, 0).map(|part| short(part, 4));
        let damping = short(data.era.as_ref().unwrap().min_damping, 4);
        for words in [
            "radius.2 2.500 ",
            &format!("y.1 {y} z.1 {z} "),
            "force 0.800 ",
            &format!("damping {damping} "),
            "speed 2.500 ",
            "0 to 3 e_t│",
            "±1.5 e_t│",
            "=2 to 3 R│",
        ] {
            assert!(frame.contains(words), "{words}:\n{frame}");
        }
        insta::assert_snapshot!("strips_chosen", frame);
    }

    #[test]
    fn the_mass_that_is_looked_at_lies_on_top() {
        let data = tests::frame_data();
        let top_of = |mass: Option<usize>| {
            let mut strips = Strips::default();
            strips.command(&PanelCommand::Mass(mass));
            let area = Rect::new(0, 0, 40, 14);
            let mut buffer = Buffer::empty(area);
            strips.draw(&view(&data), area, &mut buffer);
            // How many cells of the strip of y are in the colour of each mass.
            let cells = |color| buffer.content[40..5 * 40].iter().filter(|cell| cell.fg == color).count();
            theme::TRACES.map(cells)
        };
        let [bearing, second, third] = [None, Some(1), Some(2)].map(top_of);
        assert!(
            second[1] > bearing[1] && third[2] > bearing[2] && bearing[0] > second[0],
            "{bearing:?} {second:?} {third:?}"
        );
    }

    #[test]
    fn a_peak_of_one_step_is_seen() {
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        for seq in 0..4000 {
            let y = if seq == 2222 { 4.9 } else { 0.0 };
            feed.push_step(&tests::state(1, seq).with(wire::Channel::Y, 0, y), now);
        }
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let frame = drawn(40, 14, |area, buffer| Strips::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("±5"), "{frame}");
    }
}
