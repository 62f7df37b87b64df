//! A chart as text: lines of braille dots in a frame, two by four a cell, with marks on both axes. For a look, not for reading off.

use crate::layout::{Scale, widen};
use crate::{Chart, Look, clip::Frame, ticks::ticks};

/// Dots of a cell: across, and down.
const ACROSS: usize = 2;
const DOWN: usize = 4;
/// The cell without dots.
const BLANK: char = '\u{2800}';
/// Which bit each dot of a cell has, row by row.
const BITS: [[u32; ACROSS]; DOWN] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
/// Fewer columns or rows than this hold no chart.
const SMALLEST: (usize, usize) = (24, 6);

/// Dots on a grid of cells.
struct Canvas {
    columns: usize,
    rows: usize,
    cells: Vec<u32>,
}

impl Canvas {
    fn dot(&mut self, x: i64, y: i64) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        let (column, row) = (x / ACROSS, y / DOWN);
        if column < self.columns && row < self.rows {
            self.cells[row * self.columns + column] |= BITS[y % DOWN][x % ACROSS];
        }
    }

    /// A line from dot to dot; every `gap`th is left out, which tells series apart.
    fn line(&mut self, from: (f64, f64), to: (f64, f64), drawn: &dyn Fn(usize) -> bool, count: &mut usize) {
        let length = (to.0 - from.0).abs().max((to.1 - from.1).abs()).ceil().max(1.0);
        for k in 0..=length as usize {
            let part = k as f64 / length;
            if drawn(*count) {
                self.dot(
                    (from.0 + part * (to.0 - from.0)).round() as i64,
                    (from.1 + part * (to.1 - from.1)).round() as i64,
                );
            }
            *count += 1;
        }
    }

    fn row(&self, row: usize) -> String {
        let cells = &self.cells[row * self.columns..(row + 1) * self.columns];
        cells.iter().map(|bits| char::from_u32(BLANK as u32 + bits).filter(|c| *c != BLANK).unwrap_or(' ')).collect()
    }
}

/// Whether the `k`th dot of a line with this look is drawn.
fn drawn(look: Look) -> fn(usize) -> bool {
    match look {
        Look::Dashed => |k| k % 8 < 5,
        Look::Dotted => |k| k % 4 == 0,
        _ => |_| true,
    }
}

/// A piece of a line with this look, for the legend.
fn sample(look: Look) -> &'static str {
    match look {
        Look::Solid | Look::Thin => "⠒⠒⠒",
        Look::Dashed => "⠒⠂⠒",
        Look::Dotted => "⠂⠂⠂",
        Look::Dots | Look::Rings | Look::Crosses => "⠂",
    }
}

impl Chart {
    /// The chart as text of so many columns and rows, its title and marks among them; `None` if that is too small for any.
    #[must_use]
    pub fn text(&self, columns: usize, rows: usize) -> Option<String> {
        let (mut x, mut y) = (self.x.clone(), self.y.clone());
        let labels: Vec<(f64, String)> = ticks(&y, rows as f64);
        let margin = labels.iter().map(|(_, words)| words.chars().count()).max().unwrap_or(0) + 1;
        // The title, the frame's two lines, marks and label below.
        let (inner, high) = (columns.checked_sub(margin + 2)?, rows.checked_sub(5)?);
        if columns < SMALLEST.0 || rows < SMALLEST.1 || inner < 8 || high < 1 {
            return None;
        }
        let frame = Frame { left: 0.0, top: 0.0, right: (ACROSS * inner - 1) as f64, bottom: (DOWN * high - 1) as f64 };
        if self.equal {
            // Dots are as far apart across as down, near enough.
            widen(&mut x, &mut y, frame.right / frame.bottom);
        }
        let scale = Scale { frame, x: &x, y: &y };
        let mut canvas = Canvas { columns: inner, rows: high, cells: vec![0; inner * high] };
        for series in &self.series {
            let places: Vec<(f64, f64)> = series.points.iter().map(|point| scale.at(*point)).collect();
            if matches!(series.look, Look::Dots | Look::Rings | Look::Crosses) {
                places
                    .iter()
                    .filter(|p| frame.has(**p))
                    .for_each(|(x, y)| canvas.dot(x.round() as i64, y.round() as i64));
                continue;
            }
            let mut count = 0;
            for part in frame.cut(&places) {
                part.windows(2).for_each(|pair| canvas.line(pair[0], pair[1], &drawn(series.look), &mut count));
            }
        }
        Some(self.framed(&canvas, &scale, margin))
    }

    /// The canvas with everything around it.
    fn framed(&self, canvas: &Canvas, scale: &Scale<'_>, margin: usize) -> String {
        // As few marks as tell what a row is: three, if that many fit.
        let wanted = [3.0, 2.0, 1.0].map(|every| canvas.rows as f64 / every);
        let marks = wanted.into_iter().map(|wanted| ticks(scale.y, wanted)).find(|marks| marks.len() >= 3);
        let marks = marks.unwrap_or_else(|| ticks(scale.y, canvas.rows as f64));
        let at_row = |row: usize| {
            let here = |value: f64| (scale.at((scale.x.from, value)).1 / DOWN as f64).floor() as i64 == row as i64;
            marks.iter().find(|(value, _)| here(*value)).map(|(_, words)| words.as_str())
        };
        let blank = " ".repeat(margin);
        let mut out = format!("{blank} {}   ({})\n", self.title, self.y.label);
        out += &format!("{blank}┌{}┐\n", "─".repeat(canvas.columns));
        for row in 0..canvas.rows {
            let (words, edge) = at_row(row).map_or((String::new(), '│'), |words| (format!("{words} "), '┤'));
            let pad = " ".repeat(margin.saturating_sub(words.chars().count()));
            out += &format!("{pad}{words}{edge}{}│\n", canvas.row(row));
        }
        // Marks below the frame, as far as they do not run into each other.
        let (mut line, mut words_below) = (vec!['─'; canvas.columns], vec![' '; canvas.columns + margin + 2]);
        let mut free = 0;
        for (value, words) in ticks(scale.x, canvas.columns as f64 / 10.0) {
            let column = (scale.at((value, scale.y.from)).0 / ACROSS as f64).floor() as usize;
            let from = (column + margin + 1).saturating_sub(words.chars().count() / 2);
            let to = from + words.chars().count();
            if column < canvas.columns && from >= free && to <= words_below.len() {
                line[column] = '┬';
                words.chars().enumerate().for_each(|(k, c)| words_below[from + k] = c);
                free = to + 1;
            }
        }
        out += &format!("{blank}└{}┘\n", line.into_iter().collect::<String>());
        out += words_below.into_iter().collect::<String>().trim_end();
        let named = self.series.iter().filter(|series| !series.name.is_empty());
        let legend = named.map(|series| format!("   {} {}", sample(series.look), series.name)).collect::<String>();
        out += &format!("\n{blank} {}{legend}\n", self.x.label);
        out
    }
}

#[cfg(test)]
mod tests {
    use crate::{Axis, Chart, Color, Look, Series};

    fn chart(points: Vec<(f64, f64)>) -> Chart {
        Chart {
            title: "rising".into(),
            x: Axis::new("speed", 0.0, 10.0),
            y: Axis::new("radius", 0.0, 1.0),
            equal: false,
            series: vec![Series::new("", Look::Solid, Color::BLUE, points)],
            notes: vec![],
        }
    }

    #[test]
    fn a_line_goes_from_corner_to_corner_between_its_marks() {
        let text = chart(vec![(0.0, 0.0), (10.0, 1.0)]).text(40, 12).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 12, "{text}");
        assert!(lines[0].contains("rising") && lines[11].trim() == "speed", "{text}");
        // The first row of dots ends at the right, the last begins at the left.
        assert!(!lines[2].trim_end_matches('│').ends_with(' '), "{text}");
        assert!(!lines[8].split_once(['│', '┤']).unwrap().1.starts_with(' '), "{text}");
        assert!(lines[10].trim_start().starts_with('0') && lines[10].ends_with("10"), "{text}");
        assert!(lines.iter().all(|line| line.chars().count() <= 40), "{text}");
    }

    #[test]
    fn what_is_too_small_or_not_a_number_draws_nothing() {
        assert_eq!(chart(vec![]).text(23, 12), None);
        assert_eq!(chart(vec![]).text(40, 5), None);
        let text = chart(vec![(f64::NAN, 0.5), (5.0, f64::INFINITY)]).text(40, 10).unwrap();
        assert!(!text.chars().any(|c| ('\u{2801}'..='\u{28FF}').contains(&c)), "{text}");
    }
}
