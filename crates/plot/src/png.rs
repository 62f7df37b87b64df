//! A picture in SVG as PNG: what is drawn is that very SVG, so that both show the same.
//!
//! By resvg, without text. Beside a rasteriser of our own on the same tiny-skia that costs 19 s of processor time in the
//! first release build (33 against 14), 1 MB of program and 1 to 7 ms of some 100 for a chart; pixels differ at edges alone.

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{self, Options, Tree};

/// Pixels of the PNG to one of the canvas.
const SCALE: f32 = 2.0;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// The picture is no SVG that can be drawn.
    #[error("cannot read the SVG: {0}")]
    Svg(#[from] usvg::Error),
    /// There is no room for it.
    #[error("no memory for the pixels of a picture")]
    Memory,
    /// It cannot be coded.
    #[error("cannot write PNG: {0}")]
    Png(String),
}

/// `svg` as a PNG file, two pixels wide and high for each of its own: 1600 by 1200 for a [`crate::Chart`]. Letters must
/// be outlines, as [`crate::svg`] makes them: text is left out.
///
/// # Errors
/// Not an SVG, not enough memory, or data that PNG cannot hold.
pub fn png(svg: &str) -> Result<Vec<u8>, RasterError> {
    let tree = Tree::from_str(svg, &Options::default())?;
    let size = tree.size().to_int_size().scale_by(SCALE).ok_or(RasterError::Memory)?;
    let mut pixels = Pixmap::new(size.width(), size.height()).ok_or(RasterError::Memory)?;
    pixels.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| RasterError::Png(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_the_colours_of_its_svg_where_they_are() {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20\" height=\"10\">\
                   <rect x=\"10\" width=\"10\" height=\"10\" fill=\"#0072b2\"/></svg>";
        let pixels = Pixmap::decode_png(&png(svg).expect("draws")).expect("a PNG");
        assert_eq!((pixels.width(), pixels.height()), (40, 20));
        let color = |x, y| pixels.pixel(x, y).map(|p| (p.red(), p.green(), p.blue(), p.alpha()));
        assert_eq!(color(10, 10), Some((255, 255, 255, 255)));
        assert_eq!(color(30, 10), Some((0x00, 0x72, 0xb2, 255)));
    }

    #[test]
    fn what_is_no_svg_is_refused() {
        assert!(matches!(png("not a picture"), Err(RasterError::Svg(_))));
    }
}
