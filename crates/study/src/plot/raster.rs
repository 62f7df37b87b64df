//! A scene as PNG.

use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use super::scene::{Anchor, Scene, Shape};
use super::{Color, HEIGHT, WIDTH, font};

/// Pixels of the picture to one of the canvas.
const SCALE: f64 = 2.0;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// There is no room for it.
    #[error("no memory for the pixels of a picture")]
    Memory,
    /// It cannot be coded.
    #[error("cannot write PNG: {0}")]
    Png(String),
}

/// The scene as a PNG file of 1600 by 1200 pixels.
///
/// # Errors
/// Not enough memory, or data that PNG cannot hold.
pub fn png(scene: &Scene) -> Result<Vec<u8>, RasterError> {
    let mut pixels = Pixmap::new((WIDTH * SCALE) as u32, (HEIGHT * SCALE) as u32).ok_or(RasterError::Memory)?;
    pixels.fill(tiny_skia::Color::WHITE);
    for shape in &scene.shapes {
        draw(&mut pixels, shape);
    }
    pixels.encode_png().map_err(|error| RasterError::Png(error.to_string()))
}

fn draw(pixels: &mut Pixmap, shape: &Shape) {
    let scale = Transform::from_scale(SCALE as f32, SCALE as f32);
    match shape {
        Shape::Line { points, color, width, dash } => {
            let Some(path) = path(points, false) else { return };
            let dash = dash.and_then(|[on, off]| StrokeDash::new(vec![on as f32, off as f32], 0.0));
            pixels.stroke_path(&path, &paint(*color), &stroke(*width, dash), scale, None);
        }
        Shape::Fill { points, color } => {
            let Some(path) = path(points, true) else { return };
            pixels.fill_path(&path, &paint(*color), FillRule::Winding, scale, None);
        }
        Shape::Disc { at, radius, color, ring } => {
            let Some(path) = PathBuilder::from_circle(at.0 as f32, at.1 as f32, *radius as f32) else { return };
            match ring {
                Some(width) => pixels.stroke_path(&path, &paint(*color), &stroke(*width, None), scale, None),
                None => pixels.fill_path(&path, &paint(*color), FillRule::Winding, scale, None),
            }
        }
        Shape::Text { at, text, size, anchor, upright, halo } => {
            let Some(letters) = font::outline(text, *size) else { return };
            let back = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => -0.5 * font::width(text, *size),
                Anchor::End => -font::width(text, *size),
            };
            let turn = if *upright { 0.0 } else { -90.0 };
            let place = Transform::from_translate(back as f32, 0.0)
                .post_concat(Transform::from_rotate(turn))
                .post_translate(at.0 as f32, at.1 as f32)
                .post_concat(scale);
            if *halo {
                pixels.stroke_path(&letters, &paint(Color(255, 255, 255)), &stroke(4.0, None), place, None);
            }
            pixels.fill_path(&letters, &paint(Color::BLACK), FillRule::Winding, place, None);
        }
    }
}

fn path(points: &[(f64, f64)], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::with_capacity(points.len() + 1, points.len() + 1);
    for (i, (x, y)) in points.iter().enumerate() {
        if i == 0 {
            builder.move_to(*x as f32, *y as f32);
        } else {
            builder.line_to(*x as f32, *y as f32);
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

fn paint(Color(red, green, blue): Color) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

fn stroke(width: f64, dash: Option<StrokeDash>) -> Stroke {
    let cap = if dash.is_some() { LineCap::Butt } else { LineCap::Round };
    Stroke { width: width as f32, line_cap: cap, line_join: LineJoin::Round, dash, ..Stroke::default() }
}
