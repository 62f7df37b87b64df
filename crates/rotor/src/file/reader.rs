//! Walks the tables of a TOML file and collects what is wrong with it.
//!
//! Every method that reads a value returns a stand-in where it reports a problem, so that reading goes on and all
//! problems are found; [`Reader::finish`] lets no stand-in out.

use std::ops::Range as Span;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::problem::{Problem, Problems, position};
use crate::Range;

/// A table of the file.
pub(super) type Table<'t> = DeTable<'t>;
/// A value of the file and where it stands.
pub(super) type Value<'t> = Spanned<DeValue<'t>>;

/// A file being read.
pub(super) struct Reader<'t> {
    text: &'t str,
    problems: Vec<Draft>,
}

/// A problem at a byte of the text: lines are counted once it is known which problems are told.
struct Draft {
    at: usize,
    found: String,
    expected: String,
}

impl<'t> Reader<'t> {
    /// Parses `text`.
    ///
    /// # Errors
    /// What is not TOML: then nothing else is looked at, because the parser's guesses are not the author's words.
    pub(super) fn parse(text: &'t str) -> Result<(Self, Table<'t>), Problems> {
        let (table, errors) = DeTable::parse_recoverable(text);
        let mut reader = Self { text, problems: Vec::new() };
        // Of a long file of nonsense, the first errors are enough.
        let mut errors: Vec<_> = errors.iter().collect();
        errors.sort_by_key(|error| error.span().map_or(0, |span| span.start));
        for error in errors.into_iter().take(Problems::MOST) {
            let span = error.span().unwrap_or(0..0);
            let (what, expected) = match error.message().split_once(", expected ") {
                None | Some((_, "nothing")) => (error.message().trim_end_matches(", expected nothing"), "TOML"),
                Some(parts) => parts,
            };
            let there = reader.written(span.clone());
            let found = if there.is_empty() { what.to_owned() } else { format!("{what}: '{there}'") };
            reader.problem(span, found, expected);
        }
        reader.check()?;
        Ok((reader, table.into_inner()))
    }

    /// `value`, unless something was wrong.
    ///
    /// # Errors
    /// All that was.
    pub(super) fn finish<T>(mut self, value: T) -> Result<T, Problems> {
        self.check().map(|()| value)
    }

    /// Stops here if anything was wrong so far.
    ///
    /// # Errors
    /// All that was.
    pub(super) fn check(&mut self) -> Result<(), Problems> {
        let mut drafts = std::mem::take(&mut self.problems);
        drafts.sort_by_key(|draft| draft.at);
        let told = drafts.into_iter().take(Problems::MOST).map(|Draft { at, found, expected }| {
            let (line, column) = position(self.text, at);
            Problem { line, column, found, expected }
        });
        Problems::some(told.collect()).map_or(Ok(()), Err)
    }

    /// Notes a problem.
    pub(super) fn problem(&mut self, at: Span<usize>, found: impl Into<String>, expected: impl Into<String>) {
        self.problems.push(Draft { at: at.start, found: found.into(), expected: expected.into() });
    }

    /// Notes that the value of `key` is not what was expected.
    pub(super) fn wrong(&mut self, key: &str, value: &Value<'_>, expected: impl Into<String>) {
        let written = self.written(value.span());
        let found = match value.get_ref() {
            // The span of a table is its header, unless it is written inline.
            DeValue::Table(_) if written.starts_with('[') => written,
            DeValue::Array(_) if written.starts_with("[[") => written,
            _ => format!("{key} = {written}"),
        };
        self.problem(value.span(), found, expected);
    }

    /// Some of the file as written, short enough for a message and harmless to a terminal.
    fn written(&self, span: Span<usize>) -> String {
        let text = self.text.get(span).unwrap_or_default().trim_end();
        let mut short: String = text.chars().take(40).flat_map(harmless).collect();
        if text.chars().nth(40).is_some() {
            short.push_str("...");
        }
        short
    }

    /// Notes every key of `table` that is not `known`.
    pub(super) fn only(&mut self, table: &Table<'_>, known: &[&str]) {
        for key in table.keys() {
            if known.contains(&key.get_ref().as_ref()) {
                continue;
            }
            let mut expected = match known {
                [one] => (*one).to_owned(),
                _ => format!("one of {}", known.join(", ")),
            };
            if let Some(meant) = nearest(key.get_ref(), known) {
                expected += &format!("; did you mean '{meant}'?");
            }
            self.problem(key.span(), format!("unknown key '{}'", self.written(key.span())), expected);
        }
    }

    /// The number under `key`; `None` if there is no such key.
    pub(super) fn number(&mut self, table: &Table<'_>, key: &str, range: Range) -> Option<f64> {
        let value = table.get(key)?;
        match as_number(value) {
            Some(number) if range.admits(number) => Some(number),
            _ => {
                self.wrong(key, value, range.words());
                Some(f64::NAN)
            }
        }
    }

    /// The number under `key`, which must be there; `within` is the table, for the message.
    pub(super) fn required(&mut self, table: &Table<'_>, within: (&str, Span<usize>), key: &str, range: Range) -> f64 {
        self.number(table, key, range).unwrap_or_else(|| {
            self.problem(within.1, format!("{} without {key}", within.0), format!("{key} = {}", range.words()));
            f64::NAN
        })
    }

    /// The whole number from 1 to `most` under `key`, counted from 0; `of` says what it counts. `None` if there is no
    /// such key.
    pub(super) fn counted(&mut self, table: &Table<'_>, key: &str, most: usize, of: &str) -> Option<usize> {
        let value = table.get(key)?;
        let found = match value.get_ref() {
            DeValue::Integer(i) => usize::from_str_radix(i.as_str(), i.radix()).ok().and_then(|i| i.checked_sub(1)),
            _ => None,
        };
        match found {
            Some(found) if found < most => Some(found),
            _ => {
                self.wrong(key, value, format!("{of}, 1 to {most}"));
                Some(0)
            }
        }
    }

    /// The finite numbers of the list under `key`, with the place of each; `None` if there is no such key.
    pub(super) fn numbers(&mut self, table: &Table<'_>, key: &str, of: &str) -> Option<Vec<(f64, Span<usize>)>> {
        let value = table.get(key)?;
        let DeValue::Array(list) = value.get_ref() else {
            self.wrong(key, value, format!("a list of {of}"));
            return Some(Vec::new());
        };
        let mut numbers = Vec::with_capacity(list.len());
        for (i, item) in list.iter().enumerate() {
            let number = as_number(item).filter(|number| number.is_finite()).unwrap_or_else(|| {
                self.problem(
                    item.span(),
                    format!("{key}, entry {}: {}", i + 1, self.written(item.span())),
                    "a finite number",
                );
                f64::NAN
            });
            numbers.push((number, item.span()));
        }
        Some(numbers)
    }

    /// The tables under `key`, each with the place of its header; there have to be 1 to `most`, or any number from 0
    /// if `most` is `None`.
    pub(super) fn tables<'v>(
        &mut self,
        table: &'v Table<'t>,
        key: &str,
        most: Option<usize>,
    ) -> Vec<(&'v Table<'t>, Span<usize>)> {
        let expected = format!("[[{key}]] and its keys on lines of their own");
        let (list, place): (Vec<&'v Value<'t>>, _) = match table.get(key).map(|value| (value, value.get_ref())) {
            None => (Vec::new(), 0..0),
            Some((value, DeValue::Array(list))) => (list.iter().collect(), value.span()),
            Some((value, _)) => {
                self.wrong(key, value, expected);
                return Vec::new();
            }
        };
        let mut tables = Vec::with_capacity(list.len());
        for &item in &list {
            match item.get_ref() {
                DeValue::Table(table) => tables.push((table, item.span())),
                _ => self.wrong(key, item, expected.clone()),
            }
        }
        if let Some(most) = most {
            if list.is_empty() {
                self.problem(place, format!("no [[{key}]]"), format!("1 to {most} of them"));
            } else if let Some(item) = list.get(most) {
                self.problem(item.span(), format!("{} times [[{key}]]", list.len()), format!("1 to {most} of them"));
            }
        }
        tables
    }
}

/// A character as it can stand in a message: escaped if it would move the cursor.
fn harmless(c: char) -> impl Iterator<Item = char> {
    let escaped = c.is_control().then(|| c.escape_debug());
    let plain = escaped.is_none().then_some(c);
    escaped.into_iter().flatten().chain(plain)
}

/// Which of `known` was probably meant by `typed`.
pub(super) fn nearest<'k>(typed: &str, known: &[&'k str]) -> Option<&'k str> {
    // The distance is quadratic in the length, and no long word is near a short one.
    let close = known
        .iter()
        .map(|&word| (strsim::damerau_levenshtein(&typed.chars().take(40).collect::<String>(), word), word));
    close
        .filter(|&(distance, word)| distance <= 1.max(word.len() / 3))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, word)| word)
}

/// The number a value is, integers included.
pub(super) fn as_number(value: &Value<'_>) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(number) => number.as_str().parse().ok(),
        DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
        DeValue::Integer(number) => u64::from_str_radix(number.as_str(), number.radix()).ok().map(|n| n as f64),
        _ => None,
    }
}
