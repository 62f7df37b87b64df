//! Reading layout files.

use std::ops::Range;

use text::{Faults, Reader, Table, Value};

use super::{Layout, Place, SMALLEST, Screen, Size};
use crate::panels::registry::PANELS;
use crate::series::Strip;

/// Reads a layout.
pub(super) fn read(name: &str, text: &str) -> Result<Layout, Faults> {
    let (mut reader, file) = Reader::parse(text)?;
    reader.only(&file, &["about", "screen"]);
    let about = reader.string(&file, "about", "a text in quotes").unwrap_or_default().to_owned();
    let tables = reader.tables(&file, "screen", None);
    let mut screens = Screens { reader, text };
    let read: Vec<Option<Screen>> = tables.iter().map(|(table, at)| screens.screen(table, at)).collect();
    let Screens { mut reader, .. } = screens;
    reader.check()?;
    let layout = Layout { name: name.to_owned(), about, screens: read.into_iter().flatten().collect() };

    let sizes = layout.sizes();
    for (i, (width, height)) in sizes.iter().enumerate() {
        // The first screen that fits is shown.
        if let Some(before) = sizes[..i].iter().position(|size| size.0 <= *width && size.1 <= *height) {
            let found = format!("screen {} is never shown", i + 1);
            let expected = format!("one for smaller terminals: screen {} fits wherever it does", before + 1);
            reader.fault(tables[i].1.clone(), found, expected);
        }
    }
    match sizes.last() {
        None => reader.fault(0..0, "no screen", "[[screen]] with a picture"),
        Some(&(width, height)) if width > SMALLEST.0 || height > SMALLEST.1 => {
            let at = tables.last().map_or(0..0, |(_, at)| at.clone());
            let found = format!("the last screen needs a terminal of {width} x {height}");
            let (width, height) = SMALLEST;
            reader.fault(at, found, format!("a last screen for {width} x {height}"));
        }
        Some(_) => {}
    }
    reader.finish(layout)
}

/// A word of a text, and the byte it starts at.
type Word<'t> = (usize, &'t str);

fn span((at, word): Word<'_>) -> Range<usize> {
    at..at + word.len()
}

/// Reads screens; what is wrong with one is known to the reader, and the screen then is of no use.
struct Screens<'t> {
    reader: Reader<'t>,
    text: &'t str,
}

impl<'t> Screens<'t> {
    fn screen(&mut self, table: &Table<'_>, at: &Range<usize>) -> Option<Screen> {
        self.reader.only(table, &["picture", "columns", "rows", "strips"]);
        let columns = self.sizes(table, "columns");
        let rows = self.sizes(table, "rows");
        let strips = self.strips(table);
        let Some(picture) = table.get("picture") else {
            self.reader.fault(at.clone(), "a screen without a picture", "picture = \"\"\" ... \"\"\"");
            return None;
        };
        let lines = self.lines(picture)?;
        let places = self.places(&lines)?;
        if let (Some(_), Some(value)) = (&strips, table.get("strips"))
            && !places.iter().any(|place| PANELS[place.kind].name == "strips")
        {
            let expected = "a screen with strips in its picture, or no word of what they show";
            self.reader.wrong("strips", value, expected);
        }
        let mut sized = |key: &str, given: Option<Vec<Size>>, count: usize, what: &str| match (given, table.get(key)) {
            (Some(sizes), Some(value)) if sizes.len() != count => {
                let expected = format!("one for each of the {count} {what}");
                self.reader.fault(value.span(), format!("{} sizes", sizes.len()), expected);
                None
            }
            (given, _) => Some(given.unwrap_or_else(|| vec![Size::Share(1); count])),
        };
        let columns = sized("columns", columns, lines[0].len(), "words of a line");
        let rows = sized("rows", rows, lines.len(), "lines of the picture");
        Some(Screen { columns: columns?, rows: rows?, places, strips })
    }

    /// The words of a text as they stand in the file, by line; `None` if it is none.
    fn words(&mut self, key: &str, value: &Value<'_>) -> Option<Vec<Vec<Word<'t>>>> {
        if value.get_ref().as_str().is_none() {
            self.reader.wrong(key, value, "words in quotes");
            return None;
        }
        let Range { start, end } = value.span();
        let quotes = self.text[start..].chars().take_while(|c| matches!(c, '"' | '\'')).count().min(3);
        let quotes = if quotes == 2 { 1 } else { quotes };
        let text: &'t str = self.text;
        let inside = &text[start + quotes..(end - quotes).max(start + quotes)];
        let byte = |part: &str| part.as_ptr() as usize - text.as_ptr() as usize;
        let words =
            |line: &'t str| -> Vec<Word<'t>> { line.split_whitespace().map(|word| (byte(word), word)).collect() };
        Some(inside.lines().map(words).filter(|words| !words.is_empty()).collect())
    }

    /// What strips show, a word each.
    fn strips(&mut self, table: &Table<'_>) -> Option<Vec<Strip>> {
        let value = table.get("strips")?;
        let words = self.words("strips", value)?.concat();
        if words.is_empty() {
            self.reader.wrong("strips", value, "series, such as \"y z u\"");
        }
        let mut strips = Vec::new();
        for word in words {
            match Strip::read(word.1) {
                Ok(strip) if strips.contains(&strip) => {
                    self.reader.fault(span(word), format!("'{}' again", word.1), "each strip once");
                }
                Ok(strip) => strips.push(strip),
                Err(why) => self.reader.told(span(word), &why, "a series"),
            }
        }
        Some(strips).filter(|strips| !strips.is_empty())
    }

    fn sizes(&mut self, table: &Table<'_>, key: &str) -> Option<Vec<Size>> {
        let words = self.words(key, table.get(key)?)?.concat();
        let mut sizes = Vec::new();
        for word in words {
            let size = match word.1.strip_prefix('=') {
                Some(cells) => cells.parse().ok().filter(|cells| (1..=1000).contains(cells)).map(Size::Cells),
                None => word.1.parse().ok().filter(|share| (1..=1000).contains(share)).map(Size::Share),
            };
            if size.is_none() {
                self.reader.fault(span(word), format!("'{}'", word.1), "a share from 1 to 1000, or =CELLS");
            }
            sizes.push(size.unwrap_or(Size::Share(1)));
        }
        Some(sizes)
    }

    /// The lines of a picture, all of the same number of words.
    fn lines(&mut self, value: &Value<'_>) -> Option<Vec<Vec<Word<'t>>>> {
        let lines = self.words("picture", value)?;
        let Some(first) = lines.first() else {
            self.reader.fault(value.span(), "an empty picture", "lines of panel names");
            return None;
        };
        let count = first.len();
        let mut are_alike = true;
        for line in lines.iter().filter(|line| line.len() != count) {
            let expected = format!("{count}, as in the line above");
            self.reader.fault(span(line[0]), format!("{} words", line.len()), expected);
            are_alike = false;
        }
        are_alike.then_some(lines)
    }

    /// The blocks of equal words of a picture. Once is enough to be told of one that is none.
    fn places(&mut self, lines: &[Vec<Word<'t>>]) -> Option<Vec<Place>> {
        let mut places: Vec<Place> = Vec::new();
        let word = |x: usize, y: usize| -> &'t str { lines[y][x].1 };
        for (top, line) in lines.iter().enumerate() {
            for (left, &(at, name)) in line.iter().enumerate() {
                let covered = |place: &Place| {
                    (place.left..place.right).contains(&left) && (place.top..place.bottom).contains(&top)
                };
                if name == "." || places.iter().any(covered) {
                    continue;
                }
                let Some(kind) = PANELS.iter().position(|kind| kind.name == name) else {
                    self.reader.fault(span((at, name)), format!("no panel '{name}'"), known());
                    return None;
                };
                if places.iter().any(|place| place.kind == kind) {
                    self.reader.fault(span((at, name)), format!("'{name}' again"), "one rectangle of a panel's name");
                    return None;
                }
                let right = (left..line.len()).find(|x| word(*x, top) != name).unwrap_or(line.len());
                let bottom = (top..lines.len()).find(|y| word(left, *y) != name).unwrap_or(lines.len());
                let hole =
                    (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y))).find(|(x, y)| word(*x, *y) != name);
                if let Some((x, y)) = hole {
                    let found = format!("'{}' within '{name}'", word(x, y));
                    self.reader.fault(span(lines[y][x]), found, "one rectangle of a panel's name");
                    return None;
                }
                places.push(Place { kind, left, top, right, bottom });
            }
        }
        if places.is_empty() {
            self.reader.fault(span(lines[0][0]), "no panel", known());
            return None;
        }
        Some(places)
    }
}

fn known() -> String {
    let names: Vec<&str> = PANELS.iter().map(|kind| kind.name).collect();
    format!("one of {}", names.join(", "))
}
