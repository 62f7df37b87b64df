//! What is on a canvas: lines, discs and words, in pixels from its upper left corner.

use super::Color;

/// A canvas and what is on it, later ones on top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    pub(super) shapes: Vec<Shape>,
}

/// One thing on the canvas.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// A line through points.
    Line { points: Vec<(f64, f64)>, color: Color, width: f64, dash: Option<[f64; 2]> },
    /// A filled polygon.
    Fill { points: Vec<(f64, f64)>, color: Color },
    /// A disc, or a ring of that width.
    Disc { at: (f64, f64), radius: f64, color: Color, ring: Option<f64> },
    /// Words on a baseline.
    Label(Label),
}

/// Words on a baseline.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    pub at: (f64, f64),
    pub text: String,
    /// Of the letters, in pixels.
    pub size: f64,
    pub anchor: Anchor,
    /// Read from left to right; else from below upwards.
    pub upright: bool,
    /// With a white edge, for they stand on something.
    pub halo: bool,
}

/// Which part of the words is at their point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Scene {
    pub(super) fn line(&mut self, points: Vec<(f64, f64)>, color: Color, width: f64, dash: Option<[f64; 2]>) {
        if points.len() > 1 {
            self.shapes.push(Shape::Line { points, color, width, dash });
        }
    }

    pub(super) fn text(&mut self, at: (f64, f64), text: &str, size: f64, anchor: Anchor) {
        self.shapes.push(Shape::Label(Label { at, text: text.to_owned(), size, anchor, upright: true, halo: false }));
    }
}
