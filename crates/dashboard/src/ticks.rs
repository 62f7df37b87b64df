//! Round values along the axes of a plot: marks on the frame around it, and their numbers where they hide nothing: those of an upright axis inside
//! the frame, where nothing is drawn, those of a level one on the lower edge of the frame, beside what else is told there.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use text::number::{neat, significant};

use crate::drawing::write;
use crate::fit_text::width;
use crate::theme;

/// Rows from one number of an upright axis to the next, and cells from one of a level axis to the next, at least.
const APART: (u16, u16) = (4, 10);

/// Values of a range that are whole multiples of a step of 1, 2 or 5 times a power of ten, at most so many.
pub(crate) fn round_values([low, high]: [f64; 2], most: usize) -> Vec<f64> {
    let span = high - low;
    if !(span > 0.0 && span.is_finite() && most > 0) {
        return Vec::new();
    }
    let least = span / most as f64;
    let decade = 10_f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0, 20.0].map(|times| times * decade);
    let step = steps.into_iter().find(|step| *step >= least * (1.0 - 1e-9)).unwrap_or(20.0 * decade);
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    // Not more than asked for, and a zero without a sign.
    (0..=(last - first).max(-1.0) as i64).map(|k| (first + k as f64) * step + 0.0).take(most + 1).collect()
}

/// What some values of an axis are called: as short as they can be told, with as many more digits as it takes to tell them apart.
pub(crate) fn labels(values: &[f64], told: impl Fn(f64) -> String) -> Vec<String> {
    let short: Vec<String> = values.iter().map(|value| told(*value)).collect();
    let differ = |labels: &[String]| labels.windows(2).all(|pair| pair[0] != pair[1]);
    let longer = (4..17).map(|digits| {
        let exact = |value: &f64| significant(*value, digits).to_string();
        values.iter().map(exact).collect::<Vec<_>>()
    });
    if differ(&short) { short } else { { longer }.find(|labels| differ(labels)).unwrap_or(short) }
}

/// Marks an upright axis with the values `range` at the left of `frame`; `row` is where a value stands.
pub(crate) fn upright(
    frame: Rect,
    rows: Rect,
    range: [f64; 2],
    row: impl Fn(f64) -> Option<u16>,
    told: impl Fn(f64) -> String,
    buffer: &mut Buffer,
) {
    let values = round_values(range, usize::from(rows.height / APART.0));
    for (value, label) in values.iter().zip(labels(&values, told)) {
        let value = *value;
        let Some(y) = row(value).filter(|y| (rows.top()..rows.bottom()).contains(y)) else { continue };
        if let Some(edge) = buffer.cell_mut((frame.x, y)).filter(|cell| matches!(cell.symbol(), "│" | "┃")) {
            edge.set_symbol("├");
        }
        write_blank(buffer, rows, y, &label);
    }
}

/// Marks a level axis with the values `range` on the lower edge of `frame`; `column` is where a value stands.
pub(crate) fn level(frame: Rect, range: [f64; 2], column: impl Fn(f64) -> Option<u16>, buffer: &mut Buffer) {
    let y = frame.bottom().saturating_sub(1);
    let values = round_values(range, usize::from(frame.width / APART.1));
    for (value, label) in values.iter().zip(labels(&values, neat)) {
        let wide = width(&label) as u16;
        let Some(x) = column(*value).map(|x| x.saturating_sub(wide / 2)) else { continue };
        let (from, to) = (x.saturating_sub(1), x + wide + 1);
        let is_free = |x: u16| buffer.cell((x, y)).is_some_and(|cell| matches!(cell.symbol(), "─" | "━"));
        if frame.height > 1 && from > frame.x && to < frame.right() && (from..to).all(is_free) {
            write(buffer, frame, x, y, &label, theme::quiet());
        }
    }
}

/// Writes `text` at the left of a row if nothing at all is drawn there.
fn write_blank(buffer: &mut Buffer, area: Rect, y: u16, text: &str) {
    let wide = width(text) as u16;
    let is_blank = |symbol: &str| matches!(symbol, " " | "\u{2800}");
    let mut cells = area.x..(area.x + wide + 1).min(area.right());
    if wide < area.width && cells.all(|x| buffer.cell((x, y)).is_some_and(|cell| is_blank(cell.symbol()))) {
        write(buffer, area, area.x, y, text, theme::quiet());
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn values_are_round_and_few() {
        for (range, most, values) in [
            ([0.0, 8.0], 4, vec![0.0, 2.0, 4.0, 6.0, 8.0]),
            ([-3.0, 3.0], 3, vec![-2.0, 0.0, 2.0]),
            ([-0.5, 0.1], 6, vec![-0.5, -0.4, -0.3, -0.2, -0.1, 0.0, 0.1]),
            ([0.0, 23_873.0], 3, vec![0.0, 10_000.0, 20_000.0]),
            ([1.0, 1.0], 3, vec![]),
            ([0.0, f64::INFINITY], 3, vec![]),
            ([0.0, 1.0], 0, vec![]),
        ] {
            let found = round_values(range, most);
            assert!(
                found.len() == values.len() && found.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-9),
                "{found:?}"
            );
        }
    }

    #[test]
    fn labels_of_an_axis_tell_its_values_apart() {
        let told = |range| labels(&round_values(range, 4), neat);
        assert_eq!(told([0.0, 8.0]), ["0", "2", "4", "6", "8"]);
        assert_eq!(told([0.0, 0.015]), ["0", "0.005", "0.01", "0.015"]);
        assert_eq!(told([4980.0, 4984.0]), ["4980", "4981", "4982", "4983", "4984"]);
        assert_eq!(told([0.500_1, 0.500_5]), ["0.5001", "0.5002", "0.5003", "0.5004", "0.5005"]);
    }

    proptest! {
        #[test]
        fn no_range_has_more_than_asked_for_or_a_value_outside(low in -1e6..1e6_f64, span in 1e-6..1e6_f64, most in 0_usize..20) {
            let values = round_values([low, low + span], most);
            prop_assert!(values.len() <= most + 1);
            let slack = 1e-6 * span;
            prop_assert!(values.iter().all(|value| (low - slack..=low + span + slack).contains(value)), "{values:?}");
        }
    }
}
