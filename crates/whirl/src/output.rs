//! One result, three forms: a table for people, CSV for spreadsheets, one JSON document for scripts.

use std::io::{IsTerminal, Write};

use serde::Serialize;
use study::csv::{Field, Lines};
use unicode_width::UnicodeWidthStr;

use crate::failure::Failure;

/// A table of numbers and words.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    header: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

/// One entry of a [`Table`].
#[derive(Clone, Debug)]
pub(crate) enum Cell {
    /// A number: six significant digits for people, all of them in CSV.
    Number(f64),
    /// What is counted, or words.
    Text(String),
    /// Where a number would be: words for people, nothing in CSV.
    Without(&'static str),
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl<T: std::fmt::Display> From<&T> for Cell {
    fn from(text: &T) -> Self {
        Self::Text(text.to_string())
    }
}

impl Table {
    /// An empty table under these headings.
    #[must_use]
    pub(crate) fn new(header: &[impl AsRef<str>]) -> Self {
        Self { header: header.iter().map(|heading| heading.as_ref().to_owned()).collect(), rows: Vec::new() }
    }

    /// Adds a row of as many cells as there are headings.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// It as people read it.
    pub(crate) fn to_text(&self) -> String {
        let mut table = comfy_table::Table::new();
        table.load_style(comfy_table::presets::NOTHING).set_header(self.header.iter());
        for row in &self.rows {
            table.add_row(row.iter().map(|cell| match cell {
                Cell::Number(number) => {
                    comfy_table::Cell::new(rounded(*number)).set_alignment(comfy_table::CellAlignment::Right)
                }
                Cell::Text(text) => comfy_table::Cell::new(text),
                Cell::Without(words) => comfy_table::Cell::new(words),
            }));
        }
        // Trailing blanks wrap on narrow terminals and spoil diffs.
        table.to_string().lines().map(|line| line.trim_end().to_owned() + "\n").collect()
    }

    fn to_csv(&self) -> String {
        let mut lines = Lines::new(&self.header);
        for row in &self.rows {
            lines.row(row.iter().map(|cell| match cell {
                Cell::Number(number) => Field::Number(*number),
                Cell::Text(text) => Field::Text(text),
                Cell::Without(_) => Field::Empty,
            }));
        }
        lines.finish()
    }
}

/// Six significant digits, as every table has them.
#[must_use]
pub(crate) fn rounded(number: f64) -> String {
    text::number::in_digits(number, 6)
}

/// Whether whoever reads stdout sees colours: on a terminal that has them, unless `NO_COLOR` is set to anything (no-color.org).
pub(crate) fn has_colours() -> bool {
    std::io::stdout().is_terminal() && may_colour()
}

/// Whether a terminal, wherever it is, may be shown colours: it has them, and nobody refuses them.
pub(crate) fn may_colour() -> bool {
    let is_refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    !is_refused && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// `text` with blanks behind it up to `wide` cells of a terminal, in which a Chinese character takes two.
#[must_use]
pub(crate) fn padded(text: &str, wide: usize) -> String {
    format!("{text}{}", " ".repeat(wide.saturating_sub(text.width())))
}

/// How a command's result is printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::Args)]
pub(crate) struct Format {
    /// Print one JSON document
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// Print rows for a spreadsheet
    #[arg(long)]
    pub csv: bool,
}

impl Format {
    /// Prints `document` as JSON, or `table` as CSV, or `heading`, `table` and `footer` for people.
    ///
    /// # Errors
    /// The output cannot be written.
    pub(crate) fn print(
        self,
        document: &impl Serialize,
        heading: &str,
        table: &Table,
        footer: &str,
    ) -> Result<(), Failure> {
        if self.json {
            print_json(document)
        } else if self.csv {
            print_text(&table.to_csv())
        } else {
            let blocks = [heading.to_owned() + "\n", table.to_text(), footer.to_owned() + "\n"];
            print_text(&blocks.into_iter().filter(|block| !block.trim().is_empty()).collect::<String>())
        }
    }
}

/// Prints one JSON document and ends the line. Numbers keep full precision; what is not finite is `null`.
///
/// # Errors
/// The output cannot be written.
pub(crate) fn print_json(document: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string(document).map_err(|error| Failure::Work(format!("cannot write JSON: {error}")))?;
    print_text(&(text + "\n"))
}

/// Prints text on stdout, whole.
///
/// # Errors
/// The output cannot be written.
pub(crate) fn print_text(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    stdout.flush()?;
    Ok(())
}

/// Says something on stderr that a person should know, and that is no failure.
pub(crate) fn warn(text: &str) {
    // If stderr is gone there is nobody to be told.
    let _ = writeln!(std::io::stderr(), "whirl: {text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_characters_keep_columns_below_each_other() {
        assert_eq!(
            (padded("漢字", 6), padded("abc", 6), padded("abcdefg", 6)),
            ("漢字  ".into(), "abc   ".into(), "abcdefg".into())
        );
        let mut table = Table::new(&["name", "b"]);
        table.row([Cell::from(&"漢字漢"), Cell::from(&"x")]);
        table.row([Cell::from(&"abcdef"), Cell::from(&"y")]);
        assert_eq!(table.to_text(), " name    b\n 漢字漢  x\n abcdef  y\n");
    }

    #[test]
    fn csv_keeps_every_digit_and_quotes_words() {
        let mut table = Table::new(&["a", "b"]);
        table.row([Cell::from(0.1 + 0.2), Cell::from(&"x, y")]);
        table.row([Cell::from(2.0), Cell::from(&3)]);
        table.row([Cell::from(f64::INFINITY), Cell::Without("none")]);
        assert_eq!(table.to_csv(), "a,b\n0.30000000000000004,\"x, y\"\n2.0,3\n,\n");
        assert_eq!(table.to_text(), " a         b\n 0.300000  x, y\n  2.00000  3\n      inf  none\n");
    }
}
