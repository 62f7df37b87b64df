//! A scene as SVG: a tenth of a pixel is as fine as a screen shows, so that is what is written.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::scene::{Anchor, Label, Scene, Shape};
use super::{Color, HEIGHT, WIDTH, font};

/// Width of the line around words that stand on something, in pixels.
const HALO: f64 = 4.0;

/// The scene as one `svg` element that scales to its surroundings and needs nothing else, its letters as outlines.
///
/// `title` is for those who hear it. `name` begins every id in it, so that several may stand on one page: letters, digits,
/// dots and hyphens, a letter first.
#[must_use]
pub fn svg(scene: &Scene, name: &str, title: &str) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         width=\"{WIDTH}\" height=\"{HEIGHT}\" role=\"img\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n\
         <title>{}</title>\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n",
        escaped(title)
    );
    define_letters(&mut out, scene, name);
    for shape in &scene.shapes {
        element(&mut out, shape, name);
        out.push('\n');
    }
    out.push_str("</svg>\n");
    out
}

/// The outline of every letter that the scene uses, once.
fn define_letters(out: &mut String, scene: &Scene, name: &str) {
    let texts = scene.shapes.iter().filter_map(|shape| match shape {
        Shape::Label(words) => Some(&words.text),
        _ => None,
    });
    let numbers: BTreeSet<u16> = texts.flat_map(|text| font::letters(text)).map(|letter| letter.number).collect();
    out.push_str("<defs>\n");
    for number in numbers {
        let outline = font::outline(number);
        if !outline.is_empty() {
            let _ = writeln!(out, "<path id=\"{name}-{number}\" d=\"{outline}\"/>");
        }
    }
    out.push_str("</defs>\n");
}

/// Text as it may stand in XML.
#[must_use]
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn element(out: &mut String, shape: &Shape, name: &str) {
    // Writing to a string does not fail.
    let _ = match shape {
        Shape::Line { points, color, width, dash } => {
            let dash = dash
                .map(|[on, off]| format!(" stroke-dasharray=\"{on} {off}\" stroke-linecap=\"butt\""))
                .unwrap_or_default();
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
        Shape::Label(words) => write!(out, "{}", group(words, name)),
    };
}

/// Words as references to their letters, in a group that is scaled from the units of the font.
fn group(words: &Label, name: &str) -> String {
    let (text, scale) = (&words.text, words.size / font::units());
    let before = match words.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => 0.5,
        Anchor::End => 1.0,
    };
    let mut here = -(before * font::width(text, words.size) / scale).round() as i64;
    let mut letters = String::new();
    for letter in font::letters(text) {
        if !font::outline(letter.number).is_empty() {
            let _ = write!(letters, "<use xlink:href=\"#{name}-{}\" x=\"{here}\"/>", letter.number);
        }
        here += i64::from(letter.advance);
    }
    let turn = if words.upright { "" } else { " rotate(-90)" };
    let place = format!("translate({} {}){turn} scale({scale} {})", tenths(words.at.0), tenths(words.at.1), -scale);
    let (fill, label) = (hex(Color::BLACK), escaped(text));
    let mut out = format!("<g transform=\"{place}\" fill=\"{fill}\" aria-label=\"{label}\">");
    if words.halo {
        // All of it below all letters: the halo of one must not cover its neighbour.
        let _ = write!(out, "<g stroke=\"#fff\" stroke-width=\"{:.0}\">{letters}</g>", HALO / scale);
    }
    out + &letters + "</g>"
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
        let text = svg(&scene, "x", "x > y");
        assert!(
            text.contains("\"a &lt; b &amp; &quot;c&quot;\"") && text.contains("<title>x &gt; y</title>"),
            "{text}"
        );
    }

    /// Whoever opens the picture has none of our fonts, and others of the same name.
    #[test]
    fn letters_are_outlines_each_defined_once_and_used_where_it_stands() {
        let mut scene = Scene::default();
        scene.text((100.0, 50.0), "noon no", 20.0, Anchor::Start);
        let text = svg(&scene, "fig-1", "");
        assert!(!text.contains("<text") && !text.contains("font-family"), "{text}");
        assert_eq!((text.matches("<path id=\"fig-1-").count(), text.matches("<use ").count()), (2, 6));
        let end: f64 = text.rsplit_once(" x=\"").and_then(|(_, x)| x.split_once('"')?.0.parse().ok()).expect("a place");
        assert!((end * 20.0 / font::units() - font::width("noon n", 20.0)).abs() < 0.01, "{end}");
    }
}
