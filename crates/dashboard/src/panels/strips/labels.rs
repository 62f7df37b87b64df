//! What stands on a strip: its name or those of its lines, values under the cursor, and its scale.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use crate::axis::PlotAxis;
use crate::drawing::write;
use crate::fit_text::width;
use crate::series::{Strip, Trace};
use crate::theme;
use crate::view::View;
use telemetry::units::Unit;
use text::number::neat;

/// The share of the width that the unit of a scale may take.
pub(super) const ROOM_FOR_UNIT: usize = 8;

/// A range as a label.
pub(super) fn scale_text([low, high]: [f64; 2], axis: &PlotAxis, unit: &str) -> String {
    let range = if low == -high { format!("±{}", neat(high)) } else { format!("{} to {}", neat(low), neat(high)) };
    format!("{}{range} {unit}", axis.sign()).trim_end().to_owned()
}

/// The name of a strip, or those of its lines; with the values under a cursor. Where they have no room, the marks of the lines
/// stand for their names, and what then has none is left out: half a number would mislead.
pub(super) fn write_labels(
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
