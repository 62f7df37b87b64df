//! The letters: DejaVu Sans, cut down to Latin, Greek and the signs of mathematics (its licence is beside it).
//!
//! A picture holds their outlines and no text, so that it looks the same wherever it is opened, whatever fonts are there.

use std::fmt::Write;
use std::sync::OnceLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

fn face() -> &'static Face<'static> {
    static FACE: OnceLock<Face<'static>> = OnceLock::new();
    FACE.get_or_init(|| {
        Face::parse(include_bytes!("../assets/DejaVuSans-subset.ttf"), 0).expect("the font in the program is sound")
    })
}

/// What a letter of one unit of size measures in the units of the font.
pub(super) fn units() -> f64 {
    f64::from(face().units_per_em())
}

/// Width of `text` in letters of `size` pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let units: u32 = letters(text).map(|letter| u32::from(letter.advance)).sum();
    f64::from(units) * size / self::units()
}

/// A letter as it is in the font.
#[derive(Clone, Copy, Debug)]
pub(super) struct Letter {
    /// Its number there; 0 for a sign that the font lacks.
    pub number: u16,
    /// How far on the next one begins, in the units of the font.
    pub advance: u16,
}

/// The letters of `text`, one after the other.
pub(super) fn letters(text: &str) -> impl Iterator<Item = Letter> {
    text.chars().map(|sign| {
        let glyph = face().glyph_index(sign).unwrap_or_default();
        Letter { number: glyph.0, advance: face().glyph_hor_advance(glyph).unwrap_or_default() }
    })
}

/// The outline of a letter as the path data of SVG, in the units of the font with y upwards. Empty for a space.
pub(super) fn outline(number: u16) -> String {
    let mut pen = Pen::default();
    face().outline_glyph(GlyphId(number), &mut pen);
    pen.path
}

#[derive(Default)]
struct Pen {
    path: String,
    at: (f32, f32),
}

impl Pen {
    /// A command in steps from where the pen is: shorter than places.
    fn draw(&mut self, command: char, points: &[(f32, f32)]) {
        self.path.push(command);
        for (i, (x, y)) in points.iter().enumerate() {
            let (right, up) = (x - self.at.0, y - self.at.1);
            // A minus sign parts two numbers as well as a space does. Writing to a string does not fail.
            let gap = if i > 0 && right >= 0.0 { " " } else { "" };
            let between = if up >= 0.0 { " " } else { "" };
            let _ = write!(self.path, "{gap}{right}{between}{up}");
        }
        if let Some(last) = points.last() {
            self.at = *last;
        }
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        // In places: after a `z` the pen is back where the contour began.
        let _ = write!(self.path, "M{x} {y}");
        self.at = (x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.draw('l', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.draw('q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.draw('c', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.path.push('z');
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

    #[test]
    fn outlines_are_closed_and_a_space_has_none() {
        let number = |text: &str| letters(text).next().expect("a letter").number;
        assert_eq!(outline(number(" ")), "");
        // A capital I is a bar.
        let bar = outline(number("I"));
        assert!(bar.starts_with('M') && bar.ends_with('z') && bar.matches('l').count() >= 3, "{bar}");
        // An i is two contours.
        assert_eq!(outline(number("i")).matches('z').count(), 2);
    }
}
