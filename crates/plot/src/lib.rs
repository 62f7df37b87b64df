//! Charts, as SVG, as PNG, and as text in a terminal.
//!
//! A [`Chart`] says what is to be seen, in the units of the data. [`Chart::scene`] lays it out as lines, discs and words on
//! a canvas of [`WIDTH`] by [`HEIGHT`], [`svg`] writes that scene down, and [`png`] is that SVG as pixels: there is one way
//! of drawing. The letters are outlines from a font that is part of the program, so that a picture looks the same on every
//! machine and nothing need be installed.
//!
//! ```
//! use plot::{Axis, Chart, Color, Look, Series, png, svg};
//!
//! let decay = (0..=50).map(|i| (0.2 * f64::from(i), (-0.1 * f64::from(i)).exp())).collect();
//! let chart = Chart {
//!     title: "A mode that dies away".into(),
//!     x: Axis::new("time τ (-)", 0.0, 10.0),
//!     y: Axis::new("amplitude (eₜ)", 0.0, 1.0),
//!     equal: false,
//!     series: vec![Series::new("first mode", Look::Solid, Color::BLUE, decay)],
//!     notes: Vec::new(),
//! };
//! let picture = svg(&chart.scene(), "decay", &chart.title);
//! assert!(picture.starts_with("<svg"));
//! assert!(png(&picture)?.starts_with(b"\x89PNG"));
//! # Ok::<(), plot::RasterError>(())
//! ```
//!
//! Colours are Okabe and Ito's, which the colour-blind can tell apart, and no two series differ by colour alone.

mod cells;
mod clip;
mod font;
mod layout;
mod png;
mod scene;
mod svg;
mod terminal;
mod ticks;

pub use cells::{Cells, Shading};
pub use layout::stacked;
pub use png::{RasterError, png};
pub use scene::Scene;
pub use svg::{escaped, svg};

/// Width of the canvas, in pixels at normal size.
pub const WIDTH: f64 = 800.0;
/// Height of the canvas, in pixels at normal size.
pub const HEIGHT: f64 = 600.0;

/// A colour, red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

/// The palette.
impl Color {
    /// Text, frames, the first of several equals.
    pub const BLACK: Self = Self(0x22, 0x22, 0x22);
    /// Forward whirl; the first series.
    pub const BLUE: Self = Self(0x00, 0x72, 0xB2);
    /// Backward whirl; the second series.
    pub const VERMILLION: Self = Self(0xD5, 0x5E, 0x00);
    /// The third series.
    pub const GREEN: Self = Self(0x00, 0x7D, 0x5B);
    /// The fourth series.
    pub const PURPLE: Self = Self(0x9B, 0x4F, 0x7C);
    /// What is in the background: clearances, mirror images, axes.
    pub const GREY: Self = Self(0x8A, 0x8A, 0x8A);
    /// Grid lines.
    pub const FAINT: Self = Self(0xE2, 0xE2, 0xE2);
}

/// One axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: String,
    /// Its lower end; above zero if `log`.
    pub from: f64,
    /// Its upper end, above `from`.
    pub to: f64,
    /// Decades at even distances.
    pub log: bool,
}

impl Axis {
    /// A linear axis.
    #[must_use]
    pub fn new(label: &str, from: f64, to: f64) -> Self {
        Self { label: label.to_owned(), from, to, log: false }
    }
}

/// How the points of a series are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// A solid line.
    Solid,
    /// A thin solid line, for long orbits.
    Thin,
    /// A dashed line.
    Dashed,
    /// A dotted line.
    Dotted,
    /// Filled dots, not joined.
    Dots,
    /// Rings, not joined.
    Rings,
    /// Crosses, not joined.
    Crosses,
}

/// One series of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What the legend says; empty keeps it out of the legend.
    pub name: String,
    /// The points, `(x, y)`; a point that is not finite breaks the line.
    pub points: Vec<(f64, f64)>,
    /// How they are shown.
    pub look: Look,
    /// In which colour.
    pub color: Color,
    /// Points at which an arrowhead shows the way of the line.
    pub arrows: Vec<usize>,
}

impl Series {
    /// A series without arrowheads.
    #[must_use]
    pub fn new(name: &str, look: Look, color: Color, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.to_owned(), points, look, color, arrows: Vec::new() }
    }
}

/// Where words stand beside the point that they are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// To its right.
    Right,
    /// To its left.
    Left,
    /// Above it.
    Above,
    /// Below it.
    Below,
}

/// Words at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    /// The point, in the units of the axes.
    pub at: (f64, f64),
    /// The words.
    pub text: String,
    /// On which side of it.
    pub side: Side,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Over the frame.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// One unit is as long on both axes: circles are round. One axis is widened for it.
    pub equal: bool,
    /// What is shown, later ones on top.
    pub series: Vec<Series>,
    /// Words in the chart.
    pub notes: Vec<Note>,
}
