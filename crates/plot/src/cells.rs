//! A field of numbers as coloured cells: which colour a number has, and the bar that says so.
//!
//! Colours run from dark to light and can be told apart by everybody (viridis, of Smith and van der Walt). Numbers below 0, where a field
//! has both signs, are shades of red: the line between is where the sign changes.

use crate::clip::Frame;
use crate::layout::Scale;
use crate::scene::{Anchor, Scene, Shape};
use crate::{Axis, Color};

/// Of viridis, evenly spaced.
const STOPS: [Color; 6] = [
    Color(0x44, 0x01, 0x54),
    Color(0x41, 0x44, 0x87),
    Color(0x2A, 0x78, 0x8E),
    Color(0x22, 0xA8, 0x84),
    Color(0x7A, 0xD1, 0x51),
    Color(0xFD, 0xE7, 0x25),
];
/// Just below 0, and far below.
const BELOW: [Color; 2] = [Color(0xF6, 0xC4, 0xB8), Color(0x9E, 0x1B, 0x12)];
/// Where there is no number.
const NOWHERE: Color = Color(0xDD, 0xDD, 0xDD);
/// Shades: finer differences are not seen, and cells of one shade are one shape.
const SHADES: f64 = 48.0;

/// Numbers of one sign whose ratio is more than this are coloured by their logarithm.
const DECADES: f64 = 100.0;
/// Numbers that differ by no more than this part of their size are one colour: rounding is no pattern.
const SAME: f64 = 1e-6;

/// Which colour a number has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shading {
    /// The least number.
    pub from: f64,
    /// The largest.
    pub to: f64,
}

impl Shading {
    /// That of all of these numbers; what is not finite does not count.
    #[must_use]
    pub fn of<'a>(values: impl IntoIterator<Item = &'a f64>) -> Self {
        let finite = values.into_iter().copied().filter(|value| value.is_finite());
        let [from, to] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        if from > to { Self { from: 0.0, to: 1.0 } } else { Self { from, to } }
    }

    /// Whether equal steps of colour are equal ratios: of numbers of one sign that span some decades.
    #[must_use]
    pub fn is_logarithmic(&self) -> bool {
        self.from > 0.0 && self.to > DECADES * self.from
    }

    /// The number so far up the bar.
    fn number(&self, part: f64) -> f64 {
        if self.is_logarithmic() {
            self.from * (self.to / self.from).powf(part)
        } else {
            self.from + (self.to - self.from) * part
        }
    }

    /// How far a number is from dark to light, 0 to 1, or below 0 down to -1 where signs differ; `None` of what is no number.
    #[must_use]
    pub fn part(&self, value: f64) -> Option<f64> {
        let shade = |part: f64| (part.clamp(0.0, 1.0) * SHADES).round() / SHADES;
        if !value.is_finite() {
            return None;
        }
        Some(match self.from < 0.0 && self.to > 0.0 {
            true if value < 0.0 => -shade(value / self.from).max(1.0 / SHADES),
            true => shade(value / self.to),
            false if self.is_logarithmic() => shade((value / self.from).ln() / (self.to / self.from).ln()),
            false if self.to - self.from > SAME * self.to.abs().max(self.from.abs()) => {
                shade((value - self.from) / (self.to - self.from))
            }
            false => 0.5,
        })
    }

    /// The colour of a number.
    #[must_use]
    pub fn color(&self, value: f64) -> Color {
        let between = |a: Color, b: Color, part: f64| {
            let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * part).round() as u8;
            Color(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
        };
        match self.part(value) {
            None => NOWHERE,
            Some(part) if part < 0.0 => between(BELOW[0], BELOW[1], -part),
            Some(part) => {
                let place = part * (STOPS.len() - 1) as f64;
                let low = (place.floor() as usize).min(STOPS.len() - 2);
                between(STOPS[low], STOPS[low + 1], place - low as f64)
            }
        }
    }
}

/// A field of numbers on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Where they are across, rising; each in the middle of its cell.
    pub xs: Vec<f64>,
    /// Where they are up, rising.
    pub ys: Vec<f64>,
    /// The numbers, `[x][y]`.
    pub values: Vec<Vec<f64>>,
    /// Their colours.
    pub shading: Shading,
    /// What they are, over the bar.
    pub label: String,
}

/// Edges of cells about places: half way between, and at the ends of an axis.
fn edges(places: &[f64], axis: &Axis) -> Vec<f64> {
    let between = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    std::iter::once(axis.from).chain(between).chain([axis.to]).collect()
}

impl Cells {
    /// Every cell, those of one colour above each other as one.
    pub(crate) fn draw(&self, scene: &mut Scene, scale: &Scale<'_>) {
        let (xs, ys) = (edges(&self.xs, scale.x), edges(&self.ys, scale.y));
        for (column, ends) in self.values.iter().zip(xs.windows(2)) {
            let mut from = 0;
            for k in 1..=column.len() {
                let color = self.shading.color(column[from]);
                if k < column.len() && self.shading.color(column[k]) == color {
                    continue;
                }
                let (low, high) = (scale.at((ends[0], ys[from])), scale.at((ends[1], ys[k])));
                // A little wider than it is: no gap shows between neighbours.
                let (right, top) = ((high.0 + 0.6).min(scale.frame.right), (high.1 - 0.6).max(scale.frame.top));
                let points = vec![(low.0, low.1), (right, low.1), (right, top), (low.0, top)];
                scene.shapes.push(Shape::Fill { points, color });
                from = k;
            }
        }
    }

    /// The bar of colours beside the frame.
    pub(crate) fn bar(&self, scene: &mut Scene, frame: &Frame) {
        const PIECES: usize = 64;
        let (left, right, height) = (frame.right + 16.0, frame.right + 34.0, frame.bottom - frame.top);
        let Shading { from, to } = self.shading;
        for k in 0..PIECES {
            let [low, high] = [k, k + 1].map(|k| frame.bottom - height * k as f64 / PIECES as f64);
            let color = self.shading.color(self.shading.number((k as f64 + 0.5) / PIECES as f64));
            let points = vec![(left, low), (right, low), (right, high - 0.3), (left, high - 0.3)];
            scene.shapes.push(Shape::Fill { points, color });
        }
        let mut marks = vec![(from, frame.bottom), (to, frame.top + 10.0)];
        if self.shading.is_logarithmic() {
            marks.push((self.shading.number(0.5), frame.bottom - 0.5 * height + 5.0));
        }
        if from < 0.0 && to > 0.0 {
            marks.push((0.0, frame.bottom + height * from / (to - from) + 5.0));
        }
        for (value, at) in marks {
            let size = value.abs();
            let text = if value == 0.0 || (1e-3..1e4).contains(&size) {
                format!("{value:.3}")
            } else {
                format!("{value:.1e}")
            };
            scene.text((right + 4.0, at), &text, 13.0, Anchor::Start);
        }
        scene.text((frame.right + 54.0, frame.top - 10.0), &self.label, 13.0, Anchor::Middle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_have_colours_of_their_own_and_what_is_no_number_has_none() {
        let both = Shading::of(&[-2.0, 4.0, f64::NAN]);
        assert_eq!((both.from, both.to), (-2.0, 4.0));
        assert_eq!(
            [both.part(4.0), both.part(0.0), both.part(-2.0), both.part(f64::NAN)],
            [Some(1.0), Some(0.0), Some(-1.0), None]
        );
        assert!(both.part(-1e-12).is_some_and(|part| part < 0.0), "a sign is not rounded away");
        assert_eq!((both.color(4.0), both.color(0.0)), (STOPS[5], STOPS[0]));
        assert_eq!(both.color(-2.0), BELOW[1]);
        assert_eq!(Shading::of(&[3.0]).part(3.0), Some(0.5));
        let decades = Shading::of(&[1.0, 1e4]);
        assert!(
            decades.is_logarithmic() && decades.part(100.0) == Some(0.5) && (decades.number(0.5) - 100.0).abs() < 1e-10
        );
        assert_eq!(Shading::of(&[1.0, 1.0 + 1e-12]).part(1.0), Some(0.5), "rounding is no pattern");
        assert_eq!(Shading::of(&[f64::NAN]), Shading { from: 0.0, to: 1.0 });
    }
}
