//! Reading layout files: every problem at its line and column.

use std::ops::Range;

use text::{Fault as Problem, Faults as Problems};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::{Layout, Place, Screen, Size};
use crate::layout::SMALLEST;
use crate::panels::registry::PANELS;
use crate::series::Strip;

type Value<'t> = Spanned<DeValue<'t>>;

/// Reads a layout.
pub(super) fn read(name: &str, text: &str) -> Result<Layout, Problems> {
    let (table, errors) = DeTable::parse_recoverable(text);
    let mut reader = Reader { text, problems: Vec::new() };
    for error in &errors {
        reader.problem(error.span().unwrap_or(0..0).start, error.message(), "TOML");
    }
    if let Some(problems) = Problems::some(reader.problems) {
        return Err(problems);
    }
    let mut reader = Reader { text, problems: Vec::new() };
    let mut layout = Layout { name: name.to_owned(), about: String::new(), screens: Vec::new() };
    let (mut last, mut places) = (0, Vec::new());
    for (key, value) in table.get_ref() {
        match (&**key.get_ref(), value.get_ref()) {
            ("about", DeValue::String(about)) => layout.about = about.to_string(),
            ("about", _) => reader.problem(value.span().start, reader.written(value), "a text"),
            ("screen", DeValue::Array(screens)) => {
                for screen in screens {
                    last = screen.span().start;
                    let read = reader.screen(screen);
                    places.extend(read.as_ref().map(|_| last));
                    layout.screens.extend(read);
                }
            }
            ("screen", _) => reader.problem(value.span().start, reader.written(value), "[[screen]], once a screen"),
            (other, _) => reader.problem(key.span().start, format!("'{other}'"), "about or [[screen]]"),
        }
    }
    if reader.problems.is_empty() {
        let sizes = layout.sizes();
        for (at, (width, height)) in sizes.iter().enumerate() {
            // The first screen that fits is shown.
            if let Some(before) = sizes[..at].iter().position(|size| size.0 <= *width && size.1 <= *height) {
                let found = format!("screen {} is never shown", at + 1);
                let expected = format!("one for smaller terminals: screen {} fits wherever it does", before + 1);
                reader.problem(places[at], found, expected);
            }
        }
        match sizes.last() {
            None => reader.problem(0, "no screen", "[[screen]] with a picture"),
            Some(&(width, height)) if width > SMALLEST.0 || height > SMALLEST.1 => {
                let found = format!("the last screen needs a terminal of {width} x {height}");
                let (width, height) = SMALLEST;
                reader.problem(last, found, format!("a last screen for {width} x {height}"));
            }
            Some(_) => {}
        }
    }
    reader.problems.sort_by_key(|problem| (problem.line, problem.column));
    Problems::some(reader.problems).map_or(Ok(layout), Err)
}

struct Reader<'t> {
    text: &'t str,
    problems: Vec<Problem>,
}

/// A word of a picture, and the byte it starts at.
type Word<'t> = (usize, &'t str);

impl<'t> Reader<'t> {
    fn problem(&mut self, at: usize, found: impl Into<String>, expected: impl Into<String>) {
        self.problems.push(Problem::at(self.text, at..at, found, expected));
    }

    /// A value as it is written, cut short.
    fn written(&self, value: &Value<'_>) -> String {
        let written = self.text.get(value.span()).unwrap_or_default();
        let line = written.lines().next().unwrap_or_default();
        format!("'{}'", line.chars().take(40).collect::<String>())
    }

    fn screen(&mut self, screen: &Value<'t>) -> Option<Screen> {
        let DeValue::Table(table) = screen.get_ref() else {
            self.problem(screen.span().start, self.written(screen), "a table with a picture");
            return None;
        };
        let (mut columns, mut rows, mut picture, mut strips) = (None, None, None, None);
        for (key, value) in table {
            match &**key.get_ref() {
                "columns" => columns = Some((value.span().start, self.sizes(value))),
                "rows" => rows = Some((value.span().start, self.sizes(value))),
                "picture" => picture = Some(value),
                "strips" => strips = self.strips(value),
                other => self.problem(key.span().start, format!("'{other}'"), "picture, columns, rows or strips"),
            }
        }
        let strips_at = table.get("strips").map_or(0, |value| value.span().start);
        let Some(picture) = picture else {
            self.problem(screen.span().start, "a screen without a picture", "picture = \"\"\" ... \"\"\"");
            return None;
        };
        let lines = self.lines(picture)?;
        let places = self.places(&lines)?;
        if strips.is_some() && !places.iter().any(|place| PANELS[place.kind].name == "strips") {
            self.problem(strips_at, "strips", "a screen with strips in its picture, or no word of what they show");
        }
        let mut sized = |given: Option<(usize, Vec<Size>)>, count: usize, what: &str| match given {
            None => vec![Size::Share(1); count],
            Some((at, sizes)) => {
                if sizes.len() != count {
                    self.problem(at, format!("{} sizes", sizes.len()), format!("one for each of the {count} {what}"));
                }
                sizes
            }
        };
        let columns = sized(columns, lines[0].len(), "words of a line");
        let rows = sized(rows, lines.len(), "lines of the picture");
        // Sizes that do not fit the picture have been told of: the screen is of no use then.
        (columns.len() == lines[0].len() && rows.len() == lines.len()).then_some(Screen {
            columns,
            rows,
            places,
            strips,
        })
    }

    /// The words of a text as they stand in the file, with the byte that each starts at.
    fn words(&mut self, value: &Value<'_>) -> Vec<Vec<Word<'t>>> {
        let Range { start, end } = value.span();
        let DeValue::String(_) = value.get_ref() else {
            self.problem(start, self.written(value), "words in quotes");
            return Vec::new();
        };
        let quotes = self.text[start..].chars().take_while(|c| matches!(c, '"' | '\'')).count().min(3);
        let quotes = if quotes == 2 { 1 } else { quotes };
        let text: &'t str = self.text;
        let inside = &text[start + quotes..(end - quotes).max(start + quotes)];
        let byte = |part: &str| part.as_ptr() as usize - text.as_ptr() as usize;
        let words =
            |line: &'t str| -> Vec<Word<'t>> { line.split_whitespace().map(|word| (byte(word), word)).collect() };
        inside.lines().map(words).filter(|words| !words.is_empty()).collect()
    }

    /// What strips show, a word each.
    fn strips(&mut self, value: &Value<'t>) -> Option<Vec<Strip>> {
        let before = self.problems.len();
        let words = self.words(value).concat();
        // What is no text has been told of.
        if words.is_empty() && self.problems.len() == before {
            self.problem(value.span().start, self.written(value), "series, such as \"y z u\"");
        }
        let mut strips = Vec::new();
        for (at, word) in words {
            match Strip::read(word) {
                Ok(strip) if strips.contains(&strip) => self.problem(at, format!("'{word}' again"), "each strip once"),
                Ok(strip) => strips.push(strip),
                Err(why) => {
                    let (found, expected) = why.split_once(": expected ").unwrap_or((&*why, "a series"));
                    self.problem(at, found, expected);
                }
            }
        }
        Some(strips).filter(|strips| !strips.is_empty())
    }

    fn sizes(&mut self, value: &Value<'_>) -> Vec<Size> {
        let words = self.words(value).concat();
        let mut sizes = Vec::new();
        for (at, word) in words {
            let size = match word.strip_prefix('=') {
                Some(cells) => cells.parse().ok().filter(|cells| (1..=1000).contains(cells)).map(Size::Cells),
                None => word.parse().ok().filter(|share| (1..=1000).contains(share)).map(Size::Share),
            };
            match size {
                Some(size) => sizes.push(size),
                None => {
                    self.problem(at, format!("'{word}'"), "a share from 1 to 1000, or =CELLS");
                    sizes.push(Size::Share(1));
                }
            }
        }
        sizes
    }

    /// The lines of a picture, all of the same number of words.
    fn lines(&mut self, value: &Value<'_>) -> Option<Vec<Vec<Word<'t>>>> {
        let before = self.problems.len();
        let lines = self.words(value);
        let Some(first) = lines.first() else {
            if self.problems.len() == before {
                self.problem(value.span().start, "an empty picture", "lines of panel names");
            }
            return None;
        };
        let count = first.len();
        for line in lines.iter().filter(|line| line.len() != count) {
            self.problem(line[0].0, format!("{} words", line.len()), format!("{count}, as in the line above"));
        }
        (self.problems.len() == before).then_some(lines)
    }

    /// The blocks of equal words of a picture.
    fn places(&mut self, lines: &[Vec<Word<'t>>]) -> Option<Vec<Place>> {
        let before = self.problems.len();
        let mut places: Vec<Place> = Vec::new();
        let word = |x: usize, y: usize| -> &'t str { lines[y][x].1 };
        for (top, line) in lines.iter().enumerate() {
            for (left, (at, name)) in line.iter().copied().enumerate() {
                let covered = |place: &Place| {
                    (place.left..place.right).contains(&left) && (place.top..place.bottom).contains(&top)
                };
                if name == "." || places.iter().any(covered) {
                    continue;
                }
                let Some(kind) = PANELS.iter().position(|kind| kind.name == name) else {
                    self.problem(at, format!("no panel '{name}'"), known());
                    // Once is enough.
                    return None;
                };
                if places.iter().any(|place| place.kind == kind) {
                    self.problem(at, format!("'{name}' again"), "one rectangle of a panel's name");
                    return None;
                }
                let right = (left..line.len()).find(|x| word(*x, top) != name).unwrap_or(line.len());
                let bottom = (top..lines.len()).find(|y| word(left, *y) != name).unwrap_or(lines.len());
                let hole =
                    (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y))).find(|(x, y)| word(*x, *y) != name);
                if let Some((x, y)) = hole {
                    self.problem(
                        lines[y][x].0,
                        format!("'{}' within '{name}'", word(x, y)),
                        "one rectangle of a panel's name",
                    );
                    return None;
                }
                places.push(Place { kind, left, top, right, bottom });
            }
        }
        if places.is_empty() && self.problems.len() == before {
            self.problem(lines[0][0].0, "no panel", known());
        }
        (self.problems.len() == before).then_some(places)
    }
}

fn known() -> String {
    let names: Vec<&str> = PANELS.iter().map(|kind| kind.name).collect();
    format!("one of {}", names.join(", "))
}
