//! A plot of dots: each cell of the screen is 2 x 4 of them, drawn as one braille character.
//!
//! Ours rather than ratatui's canvas, which keeps a list of shapes and redraws it point by point: an orbit of ten
//! thousand points must cost well under a millisecond.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};

/// Bit of each dot of a cell, by row and column: the order of the Unicode braille block.
const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

/// The part of the plane that a plot shows: `x` to the right, `y` upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
}

/// Dots over an area of the screen. A cell has the colour of the last dot set in it.
#[derive(Debug)]
pub(crate) struct Plot {
    area: Rect,
    window: Window,
    cells: Vec<(u8, Color)>,
}

impl Plot {
    /// An empty plot of `window` over `area`.
    pub(crate) fn new(area: Rect, window: Window) -> Self {
        Self { area, window, cells: vec![(0, Color::Reset); usize::from(area.width) * usize::from(area.height)] }
    }

    /// The largest window around the origin, `radius` to the nearest edge, in which a circle is round: dots are square.
    pub(crate) fn round(area: Rect, radius: f64) -> Window {
        let (width, height) = (f64::from(area.width) * 2.0, f64::from(area.height) * 4.0);
        let per_dot = 2.0 * radius / width.min(height).max(1.0);
        let (x, y) = (0.5 * width * per_dot, 0.5 * height * per_dot);
        Window { x: [-x, x], y: [-y, y] }
    }

    fn size(&self) -> (f64, f64) {
        (f64::from(self.area.width) * 2.0, f64::from(self.area.height) * 4.0)
    }

    /// Position in dots from the upper left corner; may lie outside.
    fn dots(&self, x: f64, y: f64) -> (f64, f64) {
        let (width, height) = self.size();
        let Window { x: [left, right], y: [bottom, top] } = self.window;
        ((x - left) / (right - left) * width, (top - y) / (top - bottom) * height)
    }

    /// The cell in which a point lies, if it is in view.
    pub(crate) fn cell(&self, x: f64, y: f64) -> Option<(u16, u16)> {
        let (column, row) = self.dots(x, y);
        let (width, height) = self.size();
        // Not finite is never in view either.
        if !((0.0..width).contains(&column) && (0.0..height).contains(&row)) {
            return None;
        }
        Some((self.area.x + (column / 2.0) as u16, self.area.y + (row / 4.0) as u16))
    }

    fn set(&mut self, column: f64, row: f64, color: Color) {
        let (width, height) = self.size();
        if (0.0..width).contains(&column) && (0.0..height).contains(&row) {
            light(&mut self.cells, usize::from(self.area.width), column as usize, row as usize, color);
        }
    }

    /// One dot.
    pub(crate) fn dot(&mut self, x: f64, y: f64, color: Color) {
        let (column, row) = self.dots(x, y);
        self.set(column, row, color);
    }

    /// A straight line; only the part in view costs anything.
    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], color: Color) {
        let (x0, y0) = self.dots(from[0], from[1]);
        let (x1, y1) = self.dots(to[0], to[1]);
        if self.cells.is_empty() {
            return;
        }
        let Some([t0, t1]) = self.visible([x0, y0], [x1, y1]) else { return };
        let along = |t: f64| [x0 + (x1 - x0) * t, y0 + (y1 - y0) * t];
        let ([xa, ya], [xb, yb]) = (along(t0), along(t1));
        // From dot to dot in whole numbers (Bresenham): rounding leaves no gaps, and a dot costs two additions.
        let (width, height) = (i32::from(self.area.width) * 2, i32::from(self.area.height) * 4);
        let whole = |value: f64, limit: i32| (value as i32).clamp(0, limit - 1);
        let (mut column, mut row) = (whole(xa, width), whole(ya, height));
        let (across, down) = (whole(xb, width) - column, whole(yb, height) - row);
        let steps = across.abs().max(down.abs());
        // What is left of a dot, in half steps.
        let (mut beside, mut below) = (steps, steps);
        let advance = |place: &mut i32, left: &mut i32, change: i32| {
            *left += 2 * change;
            if *left >= 2 * steps {
                (*place, *left) = (*place + 1, *left - 2 * steps);
            } else if *left < 0 {
                (*place, *left) = (*place - 1, *left + 2 * steps);
            }
        };
        let columns = usize::from(self.area.width);
        for step in 0..=steps {
            light(&mut self.cells, columns, column as usize, row as usize, color);
            if step < steps {
                advance(&mut column, &mut beside, across);
                advance(&mut row, &mut below, down);
            }
        }
    }

    /// Straight lines from each point to the next. Points that follow each other closely cost next to nothing: no
    /// division, no rounding, and none of what a line takes.
    pub(crate) fn path(&mut self, points: impl Iterator<Item = [f64; 2]>, color: Color) {
        let (width, height) = self.size();
        let Window { x: [left, right], y: [bottom, top] } = self.window;
        let (across, down) = (width / (right - left), height / (top - bottom));
        let columns = usize::from(self.area.width);
        // The point before, and its dot if it is in view.
        let mut before: Option<([f64; 2], Option<[usize; 2]>)> = None;
        for point in points {
            let (column, row) = ((point[0] - left) * across, (top - point[1]) * down);
            let in_view = column >= 0.0 && column < width && row >= 0.0 && row < height;
            let here = in_view.then_some([column as usize, row as usize]);
            match (before, here) {
                (Some((_, Some(there))), Some(here)) if there == here => {}
                (Some((_, Some(there))), Some(at))
                    if at[0].abs_diff(there[0]) <= 1 && at[1].abs_diff(there[1]) <= 1 =>
                {
                    light(&mut self.cells, columns, at[0], at[1], color);
                }
                (Some((from, _)), _) => self.line(from, point, color),
                (None, _) => self.dot(point[0], point[1], color),
            }
            before = Some((point, here));
        }
    }

    /// The range of the line parameter for which a line, in dots, is in view (Liang and Barsky). `None` if none is, or
    /// if an end is not finite.
    fn visible(&self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> Option<[f64; 2]> {
        let (width, height) = self.size();
        let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
        for (start, change, limit) in [(x0, x1 - x0, width), (y0, y1 - y0, height)] {
            if !(start.is_finite() && change.is_finite()) {
                return None;
            }
            if change == 0.0 {
                if !(0.0..limit).contains(&start) {
                    return None;
                }
                continue;
            }
            let (a, b) = (-start / change, (limit - start) / change);
            t0 = t0.max(a.min(b));
            t1 = t1.min(a.max(b));
        }
        (t0 <= t1).then_some([t0, t1])
    }

    /// A circle around the origin.
    pub(crate) fn circle(&mut self, radius: f64, color: Color) {
        self.circle_about([0.0, 0.0], radius, color);
    }

    /// A circle around a point.
    pub(crate) fn circle_about(&mut self, [x, y]: [f64; 2], radius: f64, color: Color) {
        let (column, _) = self.dots(x + radius, y);
        let (centre, _) = self.dots(x, y);
        // One dot apart on the rim; a circle far out of view needs no dots.
        let around = ((column - centre).abs() * std::f64::consts::TAU).ceil();
        if !(1.0..4000.0).contains(&around) {
            return;
        }
        for k in 0..around as u32 {
            let angle = f64::from(k) / around * std::f64::consts::TAU;
            self.dot(x + radius * angle.cos(), y + radius * angle.sin(), color);
        }
    }

    /// Paints the dots; cells without one are left as they are.
    pub(crate) fn paint(&self, buffer: &mut Buffer) {
        let columns = usize::from(self.area.width);
        for (at, (bits, color)) in self.cells.iter().enumerate().filter(|(_, (bits, _))| *bits != 0) {
            let position = (self.area.x + (at % columns) as u16, self.area.y + (at / columns) as u16);
            if let Some(cell) = buffer.cell_mut(position) {
                let braille = char::from_u32(0x2800 + u32::from(*bits)).unwrap_or(' ');
                cell.set_char(braille).set_style(Style::new().fg(*color));
            }
        }
    }
}

/// Sets the dot at a column and row of dots, in view, of a plot that is `columns` cells wide.
fn light(cells: &mut [(u8, Color)], columns: usize, column: usize, row: usize, color: Color) {
    let cell = &mut cells[row / 4 * columns + column / 2];
    *cell = (cell.0 | BITS[row % 4][column % 2], color);
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rect = Rect { x: 1, y: 1, width: 4, height: 2 };

    fn painted(plot: &Plot) -> Vec<String> {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 6, 4));
        plot.paint(&mut buffer);
        (0..4).map(|y| (0..6).map(|x| buffer[(x, y)].symbol()).collect()).collect()
    }

    #[test]
    fn dots_land_where_they_belong() {
        let mut plot = Plot::new(AREA, Window { x: [0.0, 8.0], y: [0.0, 8.0] });
        plot.dot(0.5, 7.5, Color::Red);
        plot.dot(7.5, 0.5, Color::Red);
        for outside in [(-0.1, 4.0), (8.0, 4.0), (4.0, 9.0), (f64::NAN, 1.0), (f64::INFINITY, 1.0)] {
            plot.dot(outside.0, outside.1, Color::Red);
            assert_eq!(plot.cell(outside.0, outside.1), None);
        }
        assert_eq!(painted(&plot), ["      ", " ⠁    ", "    ⢀ ", "      "]);
        assert_eq!(plot.cell(7.5, 0.5), Some((4, 2)));
    }

    #[test]
    fn lines_are_cut_at_the_edge() {
        let mut plot = Plot::new(AREA, Window { x: [0.0, 8.0], y: [0.0, 8.0] });
        plot.line([-1e9, 3.5], [1e9, 3.5], Color::Red);
        plot.line([20.0, 0.0], [20.0, 9.0], Color::Red);
        plot.line([f64::NAN, 0.0], [4.0, 4.0], Color::Red);
        assert_eq!(painted(&plot), ["      ", "      ", " ⠉⠉⠉⠉ ", "      "]);
    }

    #[test]
    fn upright_lines_have_every_dot() {
        for (from, to) in [(0.5, 7.5), (6.5, 2.5), (3.5, 3.5), (-9.0, 4.5), (5.5, 90.0)] {
            let window = Window { x: [0.0, 8.0], y: [0.0, 8.0] };
            let (mut line, mut dots) = (Plot::new(AREA, window), Plot::new(AREA, window));
            line.line([2.5, from], [2.5, to], Color::Red);
            (0..8)
                .map(|row| f64::from(row) + 0.5)
                .filter(|y| (*y >= from.min(to)) && *y <= from.max(to))
                .for_each(|y| dots.dot(2.5, y, Color::Red));
            assert_eq!(painted(&line), painted(&dots), "{from} to {to}");
        }
    }

    #[test]
    fn a_path_of_close_points_is_the_same_curve() {
        // Steps far smaller than a dot, and far larger; in view and out of it; a point that is none.
        for step in [0.001, 0.05, 0.9] {
            let mut points: Vec<[f64; 2]> = (0..(12.0 / step) as u32)
                .map(|i| f64::from(i) * step)
                .map(|t| [4.0 + 5.0 * t.cos(), 4.0 + 3.0 * t.sin()])
                .collect();
            points.insert(3, [f64::NAN, 1.0]);
            let window = Window { x: [0.0, 8.0], y: [0.0, 8.0] };
            let (mut path, mut lines) = (Plot::new(AREA, window), Plot::new(AREA, window));
            path.path(points.iter().copied(), Color::Red);
            points.windows(2).for_each(|pair| lines.line(pair[0], pair[1], Color::Red));
            assert_eq!(painted(&path), painted(&lines), "{step}");
        }
    }

    #[test]
    fn circles_are_round_and_empty_areas_harmless() {
        let area = Rect::new(0, 0, 10, 4);
        let window = Plot::round(area, 1.0);
        assert_eq!((window.x, window.y), ([-1.25, 1.25], [-1.0, 1.0]));
        for area in [Rect::new(0, 0, 0, 0), Rect::new(0, 0, 0, 5), Rect::new(0, 0, 5, 0)] {
            let mut plot = Plot::new(area, Plot::round(area, 1.0));
            plot.circle(0.5, Color::Red);
            plot.line([0.0, 0.0], [1.0, 1.0], Color::Red);
            plot.paint(&mut Buffer::empty(Rect::new(0, 0, 1, 1)));
        }
    }
}
