//! A picture of the screen: a finished frame as plain text, or as SVG that looks the same everywhere. Braille and blocks are
//! drawn dot by dot, because fonts differ in them or lack them.

use std::fmt::Write;

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

use crate::fit_text::width;

/// Width and height of a cell, in the units of the picture.
const CELL: (f64, f64) = (8.0, 16.0);
/// Size of the letters.
const FONT: f64 = 13.0;
/// Room around the screen.
const EDGE: f64 = 8.0;
/// What stands for the terminal's own colours.
const TEXT: &str = "#d0d0d0";
const BACKGROUND: &str = "#101418";
/// The sixteen colours, as xterm's successors show them.
const SIXTEEN: [&str; 16] = [
    "#000000", "#cd3131", "#0dbc79", "#e5e510", "#2f7de1", "#bc3fbc", "#11a8cd", "#e5e5e5", "#7a7a7a", "#f14c4c",
    "#23d18b", "#f5f543", "#3b8eea", "#d670d6", "#29b8db", "#ffffff",
];

/// A picture of the screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Screenshot {
    /// Its characters, a line each row.
    pub text: String,
    /// The same as SVG.
    pub svg: String,
}

impl Screenshot {
    /// A picture of a finished frame.
    pub(crate) fn of(buffer: &Buffer) -> Self {
        Self { text: text(buffer), svg: svg(buffer) }
    }
}

/// A frame as lines of text, without blanks at their ends.
pub(crate) fn text(buffer: &Buffer) -> String {
    let area = buffer.area;
    let line = |y| {
        let cells: String = row(buffer, y).map(|(_, cell)| cell.symbol()).collect();
        cells.trim_end().to_owned() + "\n"
    };
    (area.top()..area.bottom()).map(line).collect()
}

/// The cells of a row from the left, without those that a wide character before them covers: the column within the frame and
/// the cell.
fn row(buffer: &Buffer, y: u16) -> impl Iterator<Item = (u16, &Cell)> {
    let area = buffer.area;
    let mut covered = area.left();
    (area.left()..area.right()).filter_map(move |x| {
        let cell = &buffer[(x, y)];
        let shown = x >= covered;
        if shown {
            covered = x + (width(cell.symbol()) as u16).max(1);
        }
        shown.then_some((x - area.left(), cell))
    })
}

/// A finished frame as an SVG document.
fn svg(buffer: &Buffer) -> String {
    let area = buffer.area;
    let (width, height) = (f64::from(area.width) * CELL.0 + 2.0 * EDGE, f64::from(area.height) * CELL.1 + 2.0 * EDGE);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{BACKGROUND}\"/>\n\
         <g transform=\"translate({EDGE} {EDGE})\" font-family=\"DejaVu Sans Mono, Menlo, Consolas, monospace\" \
         font-size=\"{FONT}\" xml:space=\"preserve\">\n"
    );
    for row in 0..area.height {
        let cells: Vec<(u16, &Cell)> = self::row(buffer, area.y + row).collect();
        draw_row(&cells, f64::from(row) * CELL.1, &mut out);
    }
    out + "</g>\n</svg>\n"
}

/// One row: cells of one look that follow each other are one piece of text, or one path of dots.
fn draw_row(cells: &[(u16, &Cell)], y: f64, out: &mut String) {
    let mut from = 0;
    while from < cells.len() {
        let (column, first) = cells[from];
        let alike = |cell: &Cell| {
            (cell.fg, cell.bg, cell.modifier) == (first.fg, first.bg, first.modifier)
                && (kind(cell) == kind(first) || (kind(first), kind(cell)) == (Kind::Text, Kind::Blank))
        };
        let run = &cells[from..from + cells[from..].iter().take_while(|(_, cell)| alike(cell)).count()];
        // Words of one text belong together; blanks at its end do not.
        let last = run.iter().rposition(|(_, cell)| kind(cell) == kind(first)).unwrap_or(0);
        let to = from + last + 1;
        let x = f64::from(column) * CELL.0;
        let wide = cells[from..to].iter().map(|(_, cell)| width(cell.symbol()).max(1)).sum::<usize>() as f64 * CELL.0;
        let (ink, paper) = colors(first);
        if let Some(paper) = paper {
            line(
                out,
                format_args!("<rect x=\"{x}\" y=\"{y}\" width=\"{wide}\" height=\"{}\" fill=\"{paper}\"/>", CELL.1),
            );
        }
        match kind(first) {
            Kind::Blank => {}
            Kind::Dots => {
                let path: String =
                    cells[from..to].iter().map(|(at, cell)| shapes(cell, f64::from(*at) * CELL.0, y)).collect();
                line(out, format_args!("<path fill=\"{ink}\" d=\"{path}\"/>"));
            }
            Kind::Text => {
                let bold = if first.modifier.contains(Modifier::BOLD) { " font-weight=\"bold\"" } else { "" };
                let base = y + 0.77 * CELL.1;
                for piece in pieces(&cells[from..to]) {
                    let text: String = piece.iter().map(|(_, cell)| escaped(cell.symbol())).collect();
                    // Whatever font there is, and whatever reads this: every letter has its place.
                    let places: Vec<String> =
                        piece.iter().map(|(at, _)| (f64::from(*at) * CELL.0).to_string()).collect();
                    let places = places.join(" ");
                    line(out, format_args!("<text x=\"{places}\" y=\"{base}\" fill=\"{ink}\"{bold}>{text}</text>"));
                }
            }
        }
        from = to;
    }
}

/// A run of text in pieces: those of one letter a cell together, a cell of several letters (an accent of its own) by itself.
fn pieces<'a>(run: &'a [(u16, &'a Cell)]) -> impl Iterator<Item = &'a [(u16, &'a Cell)]> {
    let is_one = |cell: &Cell| cell.symbol().chars().count() == 1;
    let pieces = run.chunk_by(move |(_, a), (_, b)| is_one(a) && is_one(b));
    pieces.filter(|piece| piece.iter().any(|(_, cell)| kind(cell) == Kind::Text))
}

fn line(out: &mut String, what: std::fmt::Arguments<'_>) {
    // Writing to a string does not fail.
    let _ = writeln!(out, "{what}");
}

/// How a cell is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Blank,
    Text,
    Dots,
}

fn kind(cell: &Cell) -> Kind {
    match cell.symbol().chars().next() {
        None | Some(' ') => Kind::Blank,
        Some('\u{2580}'..='\u{259f}' | '\u{2800}'..='\u{28ff}') => Kind::Dots,
        Some(glyph) if arms(glyph).is_some() => Kind::Dots,
        Some(_) => Kind::Text,
    }
}

/// The colours of letters and of what is behind them, the latter if it is not the screen's own.
fn colors(cell: &Cell) -> (String, Option<String>) {
    let (ink, paper) = (name(cell.fg), name(cell.bg));
    if cell.modifier.contains(Modifier::REVERSED) {
        return (paper.unwrap_or_else(|| BACKGROUND.into()), Some(ink.unwrap_or_else(|| TEXT.into())));
    }
    (ink.unwrap_or_else(|| TEXT.into()), paper)
}

/// A colour as SVG reads it; `None` is the terminal's own.
fn name(color: Color) -> Option<String> {
    let at = match color {
        Color::Reset => return None,
        Color::Rgb(r, g, b) => return Some(format!("#{r:02x}{g:02x}{b:02x}")),
        Color::Indexed(number) => usize::from(number) % 16,
        Color::Black => 0,
        Color::Red => 1,
        Color::Green => 2,
        Color::Yellow => 3,
        Color::Blue => 4,
        Color::Magenta => 5,
        Color::Cyan => 6,
        Color::Gray => 7,
        Color::DarkGray => 8,
        Color::LightRed => 9,
        Color::LightGreen => 10,
        Color::LightYellow => 11,
        Color::LightBlue => 12,
        Color::LightMagenta => 13,
        Color::LightCyan => 14,
        Color::White => 15,
    };
    Some(SIXTEEN[at].to_owned())
}

/// The dots of a braille cell or the parts of a block, as pieces of a path.
fn shapes(cell: &Cell, x: f64, y: f64) -> String {
    let Some(glyph) = cell.symbol().chars().next() else { return String::new() };
    let (w, h) = CELL;
    let rect = |[left, top, right, bottom]: [f64; 4]| {
        format!("M{} {}H{}V{}H{}z", x + left * w, y + top * h, x + right * w, y + bottom * h, x + left * w)
    };
    match glyph {
        '\u{2800}'..='\u{28ff}' => {
            let bits = glyph as u32 & 0xff;
            let dots = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
            let mut path = String::new();
            for (row, pair) in dots.into_iter().enumerate() {
                for (column, _) in pair.into_iter().enumerate().filter(|(_, bit)| bits & bit != 0) {
                    let (left, top) = (0.5 * column as f64, 0.25 * row as f64);
                    path += &rect([left + 0.1, top + 0.045, left + 0.4, top + 0.205]);
                }
            }
            path
        }
        '░' | '▒' | '▓' => {
            // As many of sixteen small squares as the shade has ink.
            let filled: &[usize] = match glyph {
                '░' => &[0, 10],
                '▒' => &[0, 2, 5, 7, 8, 10, 13, 15],
                _ => &[0, 1, 2, 4, 5, 7, 8, 9, 10, 12, 13, 15],
            };
            let square = |at: &usize| {
                let (left, top) = (0.25 * (at % 4) as f64, 0.25 * (at / 4) as f64);
                rect([left, top, left + 0.25, top + 0.25])
            };
            filled.iter().map(square).collect()
        }
        _ => arms(glyph).map_or_else(|| quadrants(glyph), strokes).into_iter().map(rect).collect(),
    }
}

/// The arms of a line that frames are made of, to the left, right, up and down: 0 for none, 1 thin, 2 thick.
fn arms(glyph: char) -> Option<[u8; 4]> {
    Some(match glyph {
        '─' => [1, 1, 0, 0],
        '│' => [0, 0, 1, 1],
        '┌' => [0, 1, 0, 1],
        '┐' => [1, 0, 0, 1],
        '└' => [0, 1, 1, 0],
        '┘' => [1, 0, 1, 0],
        '├' => [0, 1, 1, 1],
        '┤' => [1, 0, 1, 1],
        '┬' => [1, 1, 0, 1],
        '┴' => [1, 1, 1, 0],
        '┼' => [1, 1, 1, 1],
        '━' => [2, 2, 0, 0],
        '┃' => [0, 0, 2, 2],
        '┏' => [0, 2, 0, 2],
        '┓' => [2, 0, 0, 2],
        '┗' => [0, 2, 2, 0],
        '┛' => [2, 0, 2, 0],
        _ => return None,
    })
}

/// Strokes from the middle of a cell along these arms, in parts of the cell: whole pixels, so that cells meet without a gap.
fn strokes(arms: [u8; 4]) -> Vec<[f64; 4]> {
    let [left, right, up, down] = arms;
    // Half as wide as a line is, across and down.
    let half = |thick: u8| [0.5, 1.0][usize::from(thick > 1)];
    let widest = half(arms.into_iter().max().unwrap_or(1));
    let (across, along) = (widest / CELL.0, widest / CELL.1);
    let level = |thick: u8, [from, to]: [f64; 2]| {
        let half = half(thick) / CELL.1;
        (thick > 0).then_some([from, 0.5 - half, to, 0.5 + half])
    };
    let upright = |thick: u8, [from, to]: [f64; 2]| {
        let half = half(thick) / CELL.0;
        (thick > 0).then_some([0.5 - half, from, 0.5 + half, to])
    };
    [
        level(left, [0.0, 0.5 + across]),
        level(right, [0.5 - across, 1.0]),
        upright(up, [0.0, 0.5 + along]),
        upright(down, [0.5 - along, 1.0]),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The parts of a cell that a block fills.
fn quadrants(glyph: char) -> Vec<[f64; 4]> {
    let [nw, ne, sw, se] = [[0.0, 0.0, 0.5, 0.5], [0.5, 0.0, 1.0, 0.5], [0.0, 0.5, 0.5, 1.0], [0.5, 0.5, 1.0, 1.0]];
    match glyph {
        '▀' => vec![[0.0, 0.0, 1.0, 0.5]],
        '▄' => vec![[0.0, 0.5, 1.0, 1.0]],
        '▌' => vec![[0.0, 0.0, 0.5, 1.0]],
        '▐' => vec![[0.5, 0.0, 1.0, 1.0]],
        '▘' => vec![nw],
        '▝' => vec![ne],
        '▖' => vec![sw],
        '▗' => vec![se],
        '▚' => vec![nw, se],
        '▞' => vec![ne, sw],
        '▙' => vec![nw, sw, se],
        '▟' => vec![ne, sw, se],
        '▛' => vec![nw, ne, sw],
        '▜' => vec![nw, ne, se],
        // Eighths from below, and from the left.
        '\u{2581}'..='\u{2587}' => vec![[0.0, 1.0 - f64::from(glyph as u32 - 0x2580) / 8.0, 1.0, 1.0]],
        '\u{2589}'..='\u{258f}' => vec![[0.0, 0.0, f64::from(0x2590 - glyph as u32) / 8.0, 1.0]],
        '▔' => vec![[0.0, 0.0, 1.0, 0.125]],
        '▕' => vec![[0.875, 0.0, 1.0, 1.0]],
        _ => vec![[0.0, 0.0, 1.0, 1.0]],
    }
}

fn escaped(symbol: &str) -> String {
    symbol.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use ratatui::layout::Rect;
    use ratatui::style::Style;

    use super::*;

    fn frame_data(rows: &[&str], style: Style) -> Buffer {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 6, rows.len() as u16));
        for (y, row) in (0..).zip(rows) {
            buffer.set_string(0, y, row, style);
        }
        buffer
    }

    #[test]
    fn text_is_what_is_on_the_screen() {
        assert_eq!(text(&frame_data(&["ab  c ", "", "⠿"], Style::new())), "ab  c\n\n⠿\n");
    }

    #[test]
    fn wide_characters_have_no_blank_behind_them() {
        let wide = frame_data(&["漢字x"], Style::new());
        assert_eq!(text(&wide), "漢字x\n");
        assert!(svg(&wide).contains("<text x=\"0 16 32\" y=\"12.32\" fill=\"#d0d0d0\">漢字x</text>"), "{}", svg(&wide));
    }

    #[test]
    fn braille_is_drawn_dot_by_dot() {
        for bits in 0..=255_u32 {
            let glyph = char::from_u32(0x2800 + bits).unwrap().to_string();
            let drawn = svg(&frame_data(&[&glyph], Style::new()));
            let dots = drawn.split(" d=\"").nth(1).map_or(0, |path| path.matches('z').count());
            assert_eq!(dots, bits.count_ones() as usize, "{glyph}");
            assert!(!drawn.contains(&glyph));
        }
        // The lowest right dot of the second cell.
        let drawn = svg(&frame_data(&[" ⢀"], Style::new()));
        assert!(drawn.contains("M12.8 12.72H15.2V15.28H12.8z"), "{drawn}");
    }

    #[test]
    fn looks_and_letters_survive() {
        let style = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);
        let drawn = svg(&frame_data(&["a<b&c>"], style));
        assert!(drawn.contains("fill=\"#cd3131\" font-weight=\"bold\">a&lt;b&amp;c&gt;</text>"), "{drawn}");
        let bar = svg(&frame_data(&["ALARM"], style.add_modifier(Modifier::REVERSED)));
        assert!(bar.contains("width=\"40\" height=\"16\" fill=\"#cd3131\"/>"), "{bar}");
        let full = svg(&frame_data(&["x"], Style::new().fg(Color::Rgb(1, 2, 255))));
        assert!(full.contains("fill=\"#0102ff\""), "{full}");
    }

    #[test]
    fn blocks_fill_their_part_of_the_cell() {
        for (glyph, share) in [('█', 1.0), ('▀', 0.5), ('▙', 0.75), ('▂', 0.25), ('▎', 0.25), ('▗', 0.25), ('▚', 0.5)]
        {
            let filled: f64 = quadrants(glyph).iter().map(|[l, t, r, b]| (r - l) * (b - t)).sum();
            assert!((filled - share).abs() < 1e-12, "{glyph}: {filled}");
        }
    }

    #[test]
    fn every_letter_has_a_place_and_frames_are_strokes_that_meet() {
        let drawn = svg(&frame_data(&["ab e\u{301}c"], Style::new()));
        assert!(
            !drawn.contains("textLength") && drawn.contains("x=\"0 8 16\"") && drawn.contains(">e\u{301}</text>"),
            "{drawn}"
        );
        let frame = svg(&frame_data(&["┌─┐"], Style::new()));
        assert!(!frame.contains("<text ") && frame.contains("H16V8.5"), "{frame}");
        for glyph in "─│┌┐└┘├┤┬┴┼━┃┏┓┗┛".chars() {
            let parts = strokes(arms(glyph).unwrap());
            let reaches = |edge: usize, at: f64| parts.iter().any(|part| part[edge] == at);
            let found = [reaches(0, 0.0), reaches(2, 1.0), reaches(1, 0.0), reaches(3, 1.0)];
            assert_eq!(found, arms(glyph).unwrap().map(|arm| arm > 0), "{glyph}");
        }
    }

    #[test]
    fn the_document_is_whole() {
        let drawn = svg(&frame_data(&["│⠿ █x", "°∠"], Style::new()));
        assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>\n"));
        assert_eq!(drawn.matches("<g ").count(), drawn.matches("</g>").count());
        let empty = svg(&Buffer::empty(Rect::new(0, 0, 0, 0)));
        assert!(empty.ends_with("</svg>\n"));
    }
}
