//! One strip: the lines of its series, column of dots by column of dots.

use std::ops::Range;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::labels::{ROOM_FOR_UNIT, scale_text, write_labels};
use crate::axis::PlotAxis;
use crate::drawing::write_right;
use crate::fit_text::width;
use crate::plot::{Plot, Window};
use crate::series::{Strip, Trace};
use crate::theme;
use crate::ticks;
use crate::view::View;
use telemetry::history::{Mark, StepQuantity};
use telemetry::replay::WhatIfRun;
use telemetry::units::Unit;
use text::number::{neat, nice_ceiling};

/// Rows up to which a strip of several lines is one of how far they reach.
const LOW: u16 = 3;

/// Height from which the lines of a strip are told apart by marks too.
const ROOM_FOR_MARKS: u16 = 4;

/// The middle of a column of dots, in steps, and the range of a quantity over it.
type RangeColumn = (f64, [f64; 2]);

/// Draws one strip: its lines, those of the machine beside, marks, the cursor, its scale.
pub(super) fn draw_strip(
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
    let columns_of = |trace: &Trace| -> Vec<RangeColumn> {
        let range = |steps: Range<usize>| {
            let middle = 0.5 * (steps.start + steps.end) as f64;
            let [low, high] = trace.range(data, steps)?;
            Some((middle, [low * unit.factor, high * unit.factor]))
        };
        steps.clone().filter_map(range).collect()
    };
    let lines: Vec<Vec<RangeColumn>> = traces.iter().map(columns_of).collect();
    let beside = view.replay.as_ref().and_then(|replay| replay.beside);
    let columns_beside = |trace: &Trace| {
        let factor = unit.factor * data.factor_of(trace.channel?);
        Some(beside_columns(&beside?, trace.channel?, factor, steps.clone()))
    };
    let others: Vec<Vec<RangeColumn>> = traces.iter().filter_map(columns_beside).collect();
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
fn envelope(lines: &[Vec<RangeColumn>], traces: &[Trace], view: &View<'_>, plot: &mut Plot) {
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
fn whole(lines: &[Vec<RangeColumn>], others: &[Vec<RangeColumn>], is_size: bool) -> [f64; 2] {
    let reach = |lines: &[Vec<RangeColumn>], of: fn([f64; 2]) -> f64| {
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

/// The range of a quantity of the machine beside, column by column, as far as it has come.
fn beside_columns(
    beside: &WhatIfRun<'_>,
    channel: StepQuantity,
    factor: f64,
    columns: impl Iterator<Item = Range<usize>>,
) -> Vec<RangeColumn> {
    let value = |step| beside.value(channel, step);
    let of = |steps: Range<usize>| {
        let middle = 0.5 * (steps.start + steps.end) as f64;
        let values = steps.filter_map(value).map(|value| [value * factor; 2]);
        Some((middle, values.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)])?))
    };
    columns.filter_map(of).collect()
}
