//! A scene as SVG: a tenth of a pixel is as fine as a screen shows, so that is what is written.

use std::fmt::Write;

use super::scene::{Anchor, Scene, Shape};
use super::{Color, HEIGHT, WIDTH, font};

/// The scene as one `svg` element that scales to its surroundings and needs nothing else; `title` is for those who hear it.
#[must_use]
pub fn svg(scene: &Scene, title: &str) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" \
         height=\"{HEIGHT}\" role=\"img\" font-family=\"{}\" fill=\"none\" stroke-linejoin=\"round\">\n\
         <title>{}</title>\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n",
        font::FAMILY,
        escaped(title)
    );
    for shape in &scene.shapes {
        element(&mut out, shape);
        out.push('\n');
    }
    out.push_str("</svg>\n");
    out
}

/// Text as it may stand in XML.
#[must_use]
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn element(out: &mut String, shape: &Shape) {
    // Writing to a string does not fail.
    let _ = match shape {
        Shape::Line { points, color, width, dash } => {
            let dash = dash.map(|[on, off]| format!(" stroke-dasharray=\"{on} {off}\"")).unwrap_or_default();
            write!(out, "<path d=\"{}\" stroke=\"{}\" stroke-width=\"{width}\"{dash}/>", path(points), hex(*color))
        }
        Shape::Fill { points, color } => write!(out, "<path d=\"{}z\" fill=\"{}\"/>", path(points), hex(*color)),
        Shape::Disc { at, radius, color, ring } => {
            let look = match ring {
                Some(width) => format!("stroke=\"{}\" stroke-width=\"{width}\"", hex(*color)),
                None => format!("fill=\"{}\"", hex(*color)),
            };
            write!(out, "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" {look}/>", tenths(at.0), tenths(at.1))
        }
        Shape::Text { at, text, size, anchor, upright, halo } => {
            let (x, y) = (tenths(at.0), tenths(at.1));
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            };
            let turn = if *upright { String::new() } else { format!(" transform=\"rotate(-90 {x} {y})\"") };
            let halo = if *halo { " stroke=\"#fff\" stroke-width=\"4\" paint-order=\"stroke\"" } else { "" };
            let (fill, text) = (hex(Color::BLACK), escaped(text));
            write!(
                out,
                "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{fill}\"{anchor}{turn}{halo}>{text}</text>"
            )
        }
    };
}

fn hex(Color(red, green, blue): Color) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// To a tenth of a pixel, without what a reader does not need.
fn tenths(value: f64) -> String {
    let text = format!("{value:.1}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

/// Path data in relative steps of whole tenths, which are shorter; points that do not move are left out.
fn path(points: &[(f64, f64)]) -> String {
    let mut out = String::with_capacity(points.len() * 8);
    let mut last: Option<(i64, i64)> = None;
    for (x, y) in points {
        let here = ((x * 10.0).round() as i64, (y * 10.0).round() as i64);
        let _ = match last {
            None => write!(out, "M{} {}", tenths(*x), tenths(*y)),
            Some(last) if last == here => continue,
            Some((x, y)) => {
                write!(out, "l{} {}", tenths((here.0 - x) as f64 / 10.0), tenths((here.1 - y) as f64 / 10.0))
            }
        };
        last = Some(here);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_relative_and_words_are_escaped() {
        assert_eq!(path(&[(1.0, 2.0), (1.01, 2.0), (3.25, 1.0)]), "M1 2l2.3 -1");
        let mut scene = Scene::default();
        scene.text((1.0, 2.0), "a < b & \"c\"", 12.0, Anchor::Middle);
        let text = svg(&scene, "x > y");
        assert!(
            text.contains("a &lt; b &amp; &quot;c&quot;</text>") && text.contains("<title>x &gt; y</title>"),
            "{text}"
        );
    }
}
