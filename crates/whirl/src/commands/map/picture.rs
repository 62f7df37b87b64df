//! A map as a picture: in a file, or in the terminal as half blocks, two cells a character.

use std::fmt::Write;
use std::path::Path;

use plot::{Axis, Cells, Chart, Color, Look, Series, Shading, png, svg};

use study::map::MapAxis;

use super::shown::{Shown, dimension_of};
use super::unit;
use crate::failure::Failure;
use crate::output::{may_colour, rounded};
use crate::place::Force;

/// Where colours are not to be had: from little to much. Below 0 is blank, and so is what has no value.
const SHADES: [char; 4] = ['░', '▒', '▓', '█'];
/// Columns and rows where nobody says how large the terminal is.
const UNKNOWN: (usize, usize) = (100, 30);
/// Room beside a map for the numbers of its axis.
const MARGIN: usize = 12;

impl Shown<'_> {
    fn cells(&self) -> Cells {
        let factor = self.quantity_unit();
        let values: Vec<Vec<f64>> =
            self.map.values.iter().map(|column| column.iter().map(|value| value * factor).collect()).collect();
        Cells {
            xs: self.shown(&self.plan.x),
            ys: self.shown(&self.plan.y),
            shading: Shading::of(values.iter().flatten()),
            values,
            label: self.plan.quantity.row().name.to_owned(),
        }
    }

    /// The name of an axis with its unit.
    fn label(&self, axis: &MapAxis) -> String {
        self.machine.units().with_unit(&axis.key.name(), dimension_of(&axis.key))
    }

    fn title(&self) -> String {
        let (rotor, row) = (self.machine.rotor.name(), self.plan.quantity.row());
        format!("{rotor}: {} over {} and {}", row.name, self.plan.x.key.name(), self.plan.y.key.name())
    }
}

/// Draws a map into a file that ends in `.svg` or `.png`.
///
/// # Errors
/// The file cannot be written, or the picture not drawn.
pub(super) fn draw(shown: &Shown<'_>, path: &Path, force: Force) -> Result<(), Failure> {
    let cells = shown.cells();
    let [x_unit, y_unit] = [&shown.plan.x, &shown.plan.y].map(|axis| unit(shown.machine, &axis.key));
    let traced = shown.map.boundary.iter().enumerate().map(|(k, curve)| {
        let points = curve.iter().map(|[x, y]| (x * x_unit, y * y_unit)).collect();
        Series::new(if k == 0 { "smallest damping 0" } else { "" }, Look::Solid, Color::BLACK, points)
    });
    let ends = |values: &[f64]| (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(1.0));
    let axis = |name: String, values: &[f64]| {
        let (from, to) = ends(values);
        Axis::new(&name, from, to)
    };
    let chart = Chart {
        title: shown.title(),
        x: axis(shown.label(&shown.plan.x), &cells.xs),
        y: axis(shown.label(&shown.plan.y), &cells.ys),
        equal: false,
        series: traced.collect(),
        notes: Vec::new(),
    };
    let picture = svg(&chart.scene_over(&cells), "map", &chart.title);
    if path.extension().is_some_and(|end| end == "png") {
        let bytes =
            png(&picture).map_err(|error| Failure::Work(format!("cannot draw '{}': {error}", path.display())))?;
        return force.write(path, bytes);
    }
    force.write(path, picture)
}

/// A map as text, as wide as the terminal, where there is one.
pub(super) fn text(shown: &Shown<'_>, on_terminal: bool) -> String {
    let size = terminal_size::terminal_size().map_or(UNKNOWN, |(w, h)| (usize::from(w.0), usize::from(h.0)));
    let colours = on_terminal && may_colour();
    let cells = shown.cells();
    let (across, up) = (cells.xs.len(), cells.ys.len());
    let columns = size.0.saturating_sub(MARGIN).clamp(1, across.max(2));
    let per_row = if colours { 2 } else { 1 };
    let rows = size.1.saturating_sub(8).clamp(1, up.div_ceil(per_row));
    // The value that a dot shows: the nearest.
    let value = |column: usize, dot: usize| {
        let place = |at: usize, of: usize, all: usize| (at * all + all / 2) / of;
        let up_to = place(rows * per_row - 1 - dot, rows * per_row, up);
        cells.values[place(column, columns, across).min(across - 1)][up_to.min(up - 1)]
    };
    let mut text = shown.title() + "\n";
    for row in 0..rows {
        let label = match row {
            0 => rounded(cells.ys[up - 1]),
            _ if row + 1 == rows => rounded(cells.ys[0]),
            _ => String::new(),
        };
        let _ = write!(text, "{label:>width$} ", width = MARGIN - 2);
        for column in 0..columns {
            if colours {
                let [above, below] = [0, 1].map(|k| cells.shading.color(value(column, 2 * row + k)));
                let (Color(r, g, b), Color(r2, g2, b2)) = (above, below);
                let _ = write!(text, "\x1b[38;2;{r};{g};{b};48;2;{r2};{g2};{b2}m▀");
            } else {
                text.push(shade(cells.shading.part(value(column, row))));
            }
        }
        text += if colours { "\x1b[0m\n" } else { "\n" };
    }
    let (first, last) = (rounded(cells.xs[0]), rounded(cells.xs[across - 1]));
    let blank = " ".repeat(MARGIN - 1);
    let gap = columns.saturating_sub(last.chars().count()).max(first.chars().count() + 1);
    let _ = writeln!(text, "{blank}{first:<gap$}{last}");
    let Shading { from, to } = cells.shading;
    let _ = writeln!(
        text,
        "{blank}{} across, {} up; {} {} to {}",
        shown.plan.x.key.name(),
        shown.plan.y.key.name(),
        cells.label,
        rounded(from),
        rounded(to)
    );
    if !colours && from < 0.0 && to > 0.0 {
        let _ = writeln!(text, "{blank}blank: below 0");
    }
    text
}

fn shade(part: Option<f64>) -> char {
    match part {
        Some(part) if part >= 0.0 => SHADES[((part * SHADES.len() as f64) as usize).min(SHADES.len() - 1)],
        _ => ' ',
    }
}
