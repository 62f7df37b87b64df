//! The reference part of the book, made of the tables that the program itself goes by. What is here is order and words around them;
//! `just manual` writes the pages, and a test makes them again and compares.

mod commands;
mod console;
mod files;
mod json;
mod settings;

use std::fs;
use std::io;
use std::path::Path;

pub use json::page as json;

/// A page by its name: what it is made by.
type Maker = (&'static str, fn() -> String);

const PAGES: [Maker; 7] = [
    ("commands.md", commands::page),
    ("exit-codes.md", commands::exit_codes),
    ("settings.md", settings::page),
    ("keys.md", console::keys),
    ("layouts.md", console::layouts),
    ("alarms.md", settings::alarms),
    ("file-keys.md", files::page),
];

/// The names of the pages.
pub fn names() -> impl Iterator<Item = &'static str> {
    PAGES.iter().map(|(name, _)| *name)
}

/// Writes the pages into a folder that is there.
///
/// # Errors
/// They cannot be written.
pub fn write(folder: &Path) -> io::Result<()> {
    PAGES.iter().try_for_each(|(name, make)| fs::write(folder.join(name), make()))
}

/// The beginning of a page that nobody edits.
fn begin(title: &str, about: &str) -> String {
    format!("<!-- Made by `just manual` of the program's tables: do not edit. -->\n\n# {title}\n\n{about}\n")
}

/// Markdown whose brackets are read as such: outside of code `<enter>` is an element of HTML that nobody sees.
fn with_brackets(text: &str) -> String {
    let pieces = text.split('`').enumerate();
    let each = pieces.map(|(k, piece)| if k % 2 == 0 { piece.replace('<', "\\<") } else { piece.to_owned() });
    each.collect::<Vec<_>>().join("`")
}

/// A table, cells as Markdown.
fn table<const N: usize>(out: &mut String, heading: [&str; N], rows: impl IntoIterator<Item = [String; N]>) {
    let line = |cells: [String; N]| {
        format!("| {} |\n", cells.map(|cell| with_brackets(&cell).replace('|', "\\|")).join(" | "))
    };
    out.push('\n');
    *out += &line(heading.map(str::to_owned));
    *out += &format!("|{}\n", "---|".repeat(N));
    rows.into_iter().for_each(|row| *out += &line(row));
}

/// A number as it is typed: small ones and large ones with an exponent.
fn number(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-3..1e6).contains(&size) => format!("{value}"),
        _ => format!("{value:e}"),
    }
}

/// Between backticks.
fn code(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("`{text}`") }
}
