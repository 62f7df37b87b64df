//! From a chart to a scene: frame, marks, series, words, and a legend below everything, where it hides nothing.

use super::clip::Frame;
use super::scene::{Anchor, Label, Scene, Shape};
use super::ticks::ticks;
use super::{Axis, Cells, Chart, Color, HEIGHT, Look, Note, Series, Side, WIDTH, font};

/// Sizes of letters.
const TITLE: f64 = 18.0;
const LABEL: f64 = 17.0;
const SMALL: f64 = 15.0;
/// Height of a row of the legend.
const ROW: f64 = 24.0;
/// Room beside a frame for the bar of colours.
const BAR: f64 = 96.0;
/// Length of a mark where there are no grid lines.
const TICK: f64 = 5.0;

/// From the units of the data to pixels.
pub(super) struct Scale<'a> {
    pub(super) frame: Frame,
    pub(super) x: &'a Axis,
    pub(super) y: &'a Axis,
}

impl Scale<'_> {
    fn part(axis: &Axis, value: f64) -> f64 {
        if axis.log {
            (value / axis.from).log10() / (axis.to / axis.from).log10()
        } else {
            (value - axis.from) / (axis.to - axis.from)
        }
    }

    pub(super) fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let f = &self.frame;
        let right = f.left + Self::part(self.x, x) * (f.right - f.left);
        (right, f.bottom - Self::part(self.y, y) * (f.bottom - f.top))
    }
}

impl Chart {
    /// Lays the chart out on the canvas.
    #[must_use]
    pub fn scene(&self) -> Scene {
        stacked(std::slice::from_ref(self))
    }

    /// The same over coloured cells, with a bar that says what the colours mean.
    #[must_use]
    pub fn scene_over(&self, cells: &Cells) -> Scene {
        let mut scene = Scene::default();
        let rows = legend_rows(&self.series);
        let bottom = HEIGHT - ROW * rows.len() as f64;
        self.lay_over(&mut scene, 0.0, bottom, Some(cells));
        legend(&mut scene, &rows, bottom + 10.0);
        scene
    }

    /// Lays it out between two heights, without its legend.
    fn lay(&self, scene: &mut Scene, top: f64, bottom: f64) {
        self.lay_over(scene, top, bottom, None);
    }

    fn lay_over(&self, scene: &mut Scene, top: f64, bottom: f64, cells: Option<&Cells>) {
        let beside = if cells.is_some() { BAR } else { 0.0 };
        let frame = Frame { left: 92.0, top: top + 44.0, right: WIDTH - 24.0 - beside, bottom: bottom - 64.0 };
        let (mut x, mut y) = (self.x.clone(), self.y.clone());
        if self.equal {
            widen(&mut x, &mut y, (frame.right - frame.left) / (frame.bottom - frame.top));
        }
        let scale = Scale { frame, x: &x, y: &y };

        scene.text((0.5 * (frame.left + frame.right), top + 28.0), &self.title, TITLE, Anchor::Middle);
        match cells {
            // Grid lines would cut cells.
            Some(cells) => {
                cells.draw(scene, &scale);
                marks(scene, &scale, false);
                cells.bar(scene, &frame);
            }
            None => marks(scene, &scale, true),
        }
        for series in &self.series {
            draw(scene, &scale, series);
        }
        outline(scene, &frame);
        for note in &self.notes {
            write(scene, &scale, note);
        }
    }
}

/// Charts one above the other on one canvas, as amplitude and phase are shown, with the legend of the first below all.
#[must_use]
pub fn stacked(charts: &[Chart]) -> Scene {
    let mut scene = Scene::default();
    let Some(first) = charts.first() else { return scene };
    let rows = legend_rows(&first.series);
    let bottom = HEIGHT - ROW * rows.len() as f64;
    let each = bottom / charts.len() as f64;
    for (k, chart) in charts.iter().enumerate() {
        chart.lay(&mut scene, k as f64 * each, (k + 1) as f64 * each);
    }
    legend(&mut scene, &rows, bottom + 10.0);
    scene
}

/// Widens one of two axes until a unit is as long on both.
pub(super) fn widen(x: &mut Axis, y: &mut Axis, aspect: f64) {
    let (width, height) = (x.to - x.from, y.to - y.from);
    let (axis, wanted) = if width < height * aspect { (x, height * aspect) } else { (y, width / aspect) };
    let middle = 0.5 * (axis.from + axis.to);
    (axis.from, axis.to) = (middle - 0.5 * wanted, middle + 0.5 * wanted);
}

/// Marks on both axes, and lines at them.
fn marks(scene: &mut Scene, scale: &Scale<'_>, lines: bool) {
    let f = scale.frame;
    for (value, words) in ticks(scale.x, 10.0) {
        let (at, _) = scale.at((value, scale.y.from));
        let color = if value == 0.0 && scale.x.from < 0.0 { Color::GREY } else { Color::FAINT };
        scene.line(vec![(at, if lines { f.top } else { f.bottom - TICK }), (at, f.bottom)], color, 1.0, None);
        scene.text((at, f.bottom + 21.0), &words, SMALL, Anchor::Middle);
    }
    for (value, words) in ticks(scale.y, 7.0) {
        let (_, at) = scale.at((scale.x.from, value));
        let color = if value == 0.0 && scale.y.from < 0.0 { Color::GREY } else { Color::FAINT };
        scene.line(vec![(f.left, at), (if lines { f.right } else { f.left + TICK }, at)], color, 1.0, None);
        scene.text((f.left - 8.0, at + 0.36 * SMALL), &words, SMALL, Anchor::End);
    }
    scene.text((0.5 * (f.left + f.right), f.bottom + 47.0), &scale.x.label, LABEL, Anchor::Middle);
    scene.shapes.push(Shape::Label(Label {
        at: (24.0, 0.5 * (f.top + f.bottom)),
        text: scale.y.label.clone(),
        size: LABEL,
        anchor: Anchor::Middle,
        upright: false,
        halo: false,
    }));
}

fn outline(scene: &mut Scene, f: &Frame) {
    let corners = [(f.left, f.top), (f.right, f.top), (f.right, f.bottom), (f.left, f.bottom), (f.left, f.top)];
    scene.line(corners.to_vec(), Color::BLACK, 1.2, None);
}

/// Width and dashes of a look that is a line.
fn pen(look: Look) -> Option<(f64, Option<[f64; 2]>)> {
    match look {
        Look::Solid => Some((2.4, None)),
        Look::Thin => Some((1.0, None)),
        Look::Dashed => Some((2.4, Some([10.0, 6.0]))),
        Look::Dotted => Some((2.0, Some([2.5, 5.0]))),
        Look::Dots | Look::Rings | Look::Crosses => None,
    }
}

fn draw(scene: &mut Scene, scale: &Scale<'_>, series: &Series) {
    let points: Vec<(f64, f64)> = series.points.iter().map(|p| scale.at(*p)).collect();
    if let Some((width, dash)) = pen(series.look) {
        for part in scale.frame.cut(&points) {
            scene.line(part, series.color, width, dash);
        }
    } else {
        for point in points.iter().filter(|p| scale.frame.has(**p)) {
            mark(scene, *point, series);
        }
    }
    for &at in &series.arrows {
        if let (Some(&before), Some(&tip)) = (at.checked_sub(1).and_then(|i| points.get(i)), points.get(at))
            && scale.frame.has(tip)
        {
            arrow(scene, before, tip, series.color);
        }
    }
}

fn mark(scene: &mut Scene, at: (f64, f64), series: &Series) {
    let color = series.color;
    match series.look {
        Look::Rings => scene.shapes.push(Shape::Disc { at, radius: 5.0, color, ring: Some(1.8) }),
        Look::Crosses => {
            for turn in [1.0, -1.0] {
                let arm = (4.5, 4.5 * turn);
                scene.line(vec![(at.0 - arm.0, at.1 - arm.1), (at.0 + arm.0, at.1 + arm.1)], color, 1.8, None);
            }
        }
        _ => scene.shapes.push(Shape::Disc { at, radius: 4.0, color, ring: None }),
    }
}

fn arrow(scene: &mut Scene, before: (f64, f64), tip: (f64, f64), color: Color) {
    let (dx, dy) = (tip.0 - before.0, tip.1 - before.1);
    let length = dx.hypot(dy);
    // Two points on one pixel have no direction.
    if length < 1e-6 {
        return;
    }
    let (ux, uy) = (dx / length, dy / length);
    let corner = |along: f64, across: f64| (tip.0 + along * ux - across * uy, tip.1 + along * uy + across * ux);
    scene.shapes.push(Shape::Fill { points: vec![corner(6.0, 0.0), corner(-7.0, 5.5), corner(-7.0, -5.5)], color });
}

fn write(scene: &mut Scene, scale: &Scale<'_>, note: &Note) {
    let (x, y) = scale.at(note.at);
    if !scale.frame.has((x, y)) {
        return;
    }
    let middle = y + 0.36 * SMALL;
    let (at, anchor) = match note.side {
        Side::Right => ((x + 10.0, middle), Anchor::Start),
        Side::Left => ((x - 10.0, middle), Anchor::End),
        Side::Above => ((x, y - 9.0), Anchor::Middle),
        Side::Below => ((x, y + 9.0 + 0.74 * SMALL), Anchor::Middle),
    };
    let text = note.text.clone();
    scene.shapes.push(Shape::Label(Label { at, text, size: SMALL, anchor, upright: true, halo: true }));
}

/// What a legend entry takes: a sample of the line, the words, and a gap.
fn entry_width(series: &Series) -> f64 {
    44.0 + font::width(&series.name, SMALL) + 26.0
}

/// The named series, in rows that fit the canvas.
fn legend_rows(series: &[Series]) -> Vec<Vec<&Series>> {
    let mut rows: Vec<Vec<&Series>> = Vec::new();
    let mut room = 0.0;
    for series in series.iter().filter(|s| !s.name.is_empty()) {
        let width = entry_width(series);
        if width > room {
            rows.push(Vec::new());
            room = WIDTH - 60.0;
        }
        room -= width;
        if let Some(row) = rows.last_mut() {
            row.push(series);
        }
    }
    rows
}

fn legend(scene: &mut Scene, rows: &[Vec<&Series>], top: f64) {
    for (i, row) in rows.iter().enumerate() {
        let y = top + ROW * i as f64;
        let mut x = 0.5 * (WIDTH - row.iter().map(|s| entry_width(s)).sum::<f64>()) + 13.0;
        for series in row {
            match pen(series.look) {
                Some((width, dash)) => {
                    // A thin line would show no colour.
                    scene.line(vec![(x, y - 5.0), (x + 36.0, y - 5.0)], series.color, width.max(1.6), dash);
                }
                None => mark(scene, (x + 18.0, y - 5.0), series),
            }
            scene.text((x + 44.0, y), &series.name, SMALL, Anchor::Start);
            x += entry_width(series);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(equal: bool) -> Chart {
        let line = Series::new("one", Look::Solid, Color::BLUE, vec![(0.0, 0.0), (1.0, 1.0), (9.0, 9.0)]);
        Chart {
            title: "t".into(),
            x: Axis::new("x", 0.0, 1.0),
            y: Axis::new("y", 0.0, 1.0),
            equal,
            series: vec![line],
            notes: vec![Note { at: (0.5, 0.5), text: "here".into(), side: Side::Right }],
        }
    }

    #[test]
    fn nothing_leaves_the_canvas() {
        for shape in chart(false).scene().shapes {
            let points = match shape {
                Shape::Line { points, .. } | Shape::Fill { points, .. } => points,
                Shape::Disc { at, .. } | Shape::Label(Label { at, .. }) => vec![at],
            };
            assert!(points.iter().all(|(x, y)| (0.0..=WIDTH).contains(x) && (0.0..=HEIGHT).contains(y)), "{points:?}");
        }
    }

    #[test]
    fn equal_axes_make_circles_round() {
        let (mut x, mut y) = (Axis::new("", -1.0, 1.0), Axis::new("", -1.0, 1.0));
        widen(&mut x, &mut y, 1.5);
        assert_eq!((x.from, x.to, y.from, y.to), (-1.5, 1.5, -1.0, 1.0));
        assert_ne!(chart(true).scene(), chart(false).scene());
    }

    #[test]
    fn long_legends_take_more_rows() {
        let series: Vec<Series> =
            (0..9).map(|i| Series::new(&format!("a rather long name {i}"), Look::Dots, Color::BLUE, vec![])).collect();
        assert_eq!(legend_rows(&series).iter().map(Vec::len).sum::<usize>(), 9);
        assert!(legend_rows(&series).len() > 1);
    }
}
