//! The letters: DejaVu Sans, cut down to Latin, Greek and the signs of mathematics (its licence is beside it).

use std::sync::OnceLock;

use tiny_skia::{Path, PathBuilder, Transform};
use ttf_parser::{Face, OutlineBuilder};

/// What browsers are asked for, so that the SVG looks like the PNG where the font is there.
pub(super) const FAMILY: &str = "DejaVu Sans, Verdana, Helvetica, sans-serif";

fn face() -> &'static Face<'static> {
    static FACE: OnceLock<Face<'static>> = OnceLock::new();
    FACE.get_or_init(|| {
        Face::parse(include_bytes!("../../assets/DejaVuSans-subset.ttf"), 0).expect("the font in the program is sound")
    })
}

/// Width of `text` in letters of `size` pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let face = face();
    let units: f64 = text.chars().map(|c| advance(face, c)).sum();
    units * size / f64::from(face.units_per_em())
}

fn advance(face: &Face<'_>, letter: char) -> f64 {
    let glyph = face.glyph_index(letter).unwrap_or_default();
    f64::from(face.glyph_hor_advance(glyph).unwrap_or_default())
}

/// The outline of `text` in letters of `size` pixels, from the origin along the x axis, y downwards.
pub(super) fn outline(text: &str, size: f64) -> Option<Path> {
    let face = face();
    let scale = (size / f64::from(face.units_per_em())) as f32;
    let mut pen = Pen { builder: PathBuilder::new(), at: 0.0 };
    for letter in text.chars() {
        face.outline_glyph(face.glyph_index(letter).unwrap_or_default(), &mut pen);
        pen.at += advance(face, letter) as f32;
    }
    pen.builder.finish()?.transform(Transform::from_scale(scale, -scale))
}

struct Pen {
    builder: PathBuilder,
    at: f32,
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.builder.move_to(self.at + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.builder.line_to(self.at + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.builder.quad_to(self.at + x1, y1, self.at + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.builder.cubic_to(self.at + x1, y1, self.at + x2, y2, self.at + x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_that_charts_use_is_in_the_font() {
        for letter in "Rλτω₀ζ−⁻⁰¹²³⁴⁵⁶⁷⁸⁹×°·…≤≈|±→µ²".chars() {
            assert!(face().glyph_index(letter).is_some(), "{letter}");
        }
        assert!((width("mm", 10.0) - 2.0 * width("m", 10.0)).abs() < 1e-9 && width("m", 10.0) > 5.0);
    }
}
