//! Walks the tables of a TOML file and collects what is wrong with it.
//!
//! Every method that reads a value returns a stand-in where it reports a fault, so that reading goes on and all
//! faults are found; [`Reader::finish`] lets no stand-in out.

use std::ops::Range as Span;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::{Domain, Fault, Faults};

/// A table of the file.
pub type Table<'t> = DeTable<'t>;
/// A value of the file and where it stands.
pub type Value<'t> = Spanned<DeValue<'t>>;
/// A key of the file and where it stands.
pub type Key<'t> = Spanned<DeString<'t>>;

/// A file being read.
pub struct Reader<'t> {
    text: &'t str,
    drafts: Vec<Draft>,
}

/// A fault at some bytes of the text: lines are counted once it is known which faults are told.
struct Draft {
    span: Span<usize>,
    found: String,
    expected: String,
}

impl<'t> Reader<'t> {
    /// Parses `text`.
    ///
    /// # Errors
    /// What is not TOML: then nothing else is looked at, because the parser's guesses are not the author's words.
    pub fn parse(text: &'t str) -> Result<(Self, Table<'t>), Faults> {
        let (table, errors) = DeTable::parse_recoverable(text);
        let mut reader = Self { text, drafts: Vec::new() };
        // Of a long file of nonsense, the first errors are enough.
        let mut errors: Vec<_> = errors.iter().collect();
        errors.sort_by_key(|error| error.span().map_or(0, |span| span.start));
        for error in errors.into_iter().take(Faults::MOST) {
            let span = error.span().unwrap_or(0..0);
            let (what, expected) = match error.message().split_once(", expected ") {
                None | Some((_, "nothing")) => (error.message().trim_end_matches(", expected nothing"), "TOML"),
                Some(parts) => parts,
            };
            let there = reader.written(span.clone());
            let found = if there.is_empty() { what.to_owned() } else { format!("{what}: '{there}'") };
            reader.fault(span, found, expected);
        }
        reader.check()?;
        Ok((reader, table.into_inner()))
    }

    /// `value`, unless something was wrong.
    ///
    /// # Errors
    /// All that was.
    pub fn finish<T>(mut self, value: T) -> Result<T, Faults> {
        self.check().map(|()| value)
    }

    /// Stops here if anything was wrong so far.
    ///
    /// # Errors
    /// All that was.
    pub fn check(&mut self) -> Result<(), Faults> {
        let mut drafts = std::mem::take(&mut self.drafts);
        drafts.sort_by_key(|draft| draft.span.start);
        let told = drafts.into_iter().take(Faults::MOST);
        let faults = told.map(|Draft { span, found, expected }| Fault::at(self.text, span, found, expected));
        Faults::some(faults.collect()).map_or(Ok(()), Err)
    }

    /// Notes a fault.
    pub fn fault(&mut self, at: Span<usize>, found: impl Into<String>, expected: impl Into<String>) {
        self.drafts.push(Draft { span: at, found: found.into(), expected: expected.into() });
    }

    /// Notes a fault that somebody else tells as `FOUND: expected EXPECTED`; `otherwise` is expected where that says only what
    /// was found.
    pub fn told(&mut self, at: Span<usize>, fault: &str, otherwise: &str) {
        let (found, expected) = fault.split_once(": expected ").unwrap_or((fault, otherwise));
        self.fault(at, found, expected);
    }

    /// Notes that the value of `key` is not what was expected.
    pub fn wrong(&mut self, key: &str, value: &Value<'_>, expected: impl Into<String>) {
        let written = self.written(value.span());
        let found = match value.get_ref() {
            // The span of a table is its header, unless it is written inline.
            DeValue::Table(_) if written.starts_with('[') => written,
            DeValue::Array(_) if written.starts_with("[[") => written,
            _ => format!("{key} = {written}"),
        };
        self.fault(value.span(), found, expected);
    }

    /// Some of the file as written, short enough for a message and harmless to a terminal.
    #[must_use]
    pub fn written(&self, span: Span<usize>) -> String {
        let text = self.text.get(span).unwrap_or_default().trim_end();
        let mut short: String = text.chars().take(40).flat_map(harmless).collect();
        if text.chars().nth(40).is_some() {
            short.push_str("...");
        }
        short
    }

    /// Notes every key of `table` that is not `known`.
    pub fn only(&mut self, table: &Table<'_>, known: &[&str]) {
        for key in table.keys() {
            if known.contains(&key.get_ref().as_ref()) {
                continue;
            }
            let expected = match known {
                [one] => (*one).to_owned(),
                _ => format!("one of {}", known.join(", ")),
            };
            self.unknown(key, known, expected);
        }
    }

    /// Notes a key that is none of `known`; `expected` tells those.
    pub fn unknown(&mut self, key: &Key<'_>, known: &[&str], expected: impl Into<String>) {
        let mut expected = expected.into();
        if let Some(meant) = nearest(key.get_ref(), known) {
            expected += &format!("; did you mean '{meant}'?");
        }
        self.fault(key.span(), format!("unknown key '{}'", self.written(key.span())), expected);
    }

    /// The number under `key`; `None` if there is no such key.
    pub fn number(&mut self, table: &Table<'_>, key: &str, domain: Domain) -> Option<f64> {
        let value = table.get(key)?;
        match as_number(value) {
            Some(number) if domain.admits(number) => Some(number),
            _ => {
                self.wrong(key, value, domain.words());
                Some(f64::NAN)
            }
        }
    }

    /// The number under `key`, which must be there; `within` is the table, for the message.
    pub fn required(&mut self, table: &Table<'_>, within: (&str, Span<usize>), key: &str, domain: Domain) -> f64 {
        self.number(table, key, domain).unwrap_or_else(|| {
            self.fault(within.1, format!("{} without {key}", within.0), format!("{key} = {}", domain.words()));
            f64::NAN
        })
    }

    /// The whole number from 1 to `most` under `key`, counted from 0; `of` says what it counts. `None` if there is no
    /// such key.
    pub fn counted(&mut self, table: &Table<'_>, key: &str, most: usize, of: &str) -> Option<usize> {
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
    pub fn numbers(&mut self, table: &Table<'_>, key: &str, of: &str) -> Option<Vec<(f64, Span<usize>)>> {
        let value = table.get(key)?;
        let DeValue::Array(list) = value.get_ref() else {
            self.wrong(key, value, format!("a list of {of}"));
            return Some(Vec::new());
        };
        let mut numbers = Vec::with_capacity(list.len());
        for (i, item) in list.iter().enumerate() {
            let number = as_number(item).filter(|number| number.is_finite()).unwrap_or_else(|| {
                self.fault(
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

    /// The table under `key`, written `[key]`; `None` if there is no such key, or no table there.
    pub fn table<'v, 'f>(&mut self, table: &'v Table<'f>, key: &str) -> Option<&'v Table<'f>> {
        let value = table.get(key)?;
        if let DeValue::Table(table) = value.get_ref() {
            return Some(table);
        }
        self.wrong(key, value, format!("[{key}] and its keys on lines of their own"));
        None
    }

    /// The text under `key`; `None` if there is no such key, or no text there. `expected` says what it stands for.
    pub fn string<'v>(&mut self, table: &'v Table<'_>, key: &str, expected: &str) -> Option<&'v str> {
        let value = table.get(key)?;
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.wrong(key, value, expected);
        }
        text
    }

    /// Which of `choices` stands under `key`; `None` if there is no such key, or something else there.
    pub fn choice<'c>(&mut self, table: &Table<'_>, key: &str, choices: &[&'c str]) -> Option<&'c str> {
        let value = table.get(key)?;
        let typed = value.get_ref().as_str();
        let chosen = choices.iter().copied().find(|choice| typed == Some(choice));
        if chosen.is_none() {
            let mut expected = match choices {
                [one] => format!("\"{one}\""),
                [one, other] => format!("\"{one}\" or \"{other}\""),
                _ => format!("one of {}", choices.join(", ")),
            };
            if let (Some(meant), true) = (typed.and_then(|typed| nearest(typed, choices)), choices.len() > 1) {
                expected += &format!("; did you mean \"{meant}\"?");
            }
            self.wrong(key, value, expected);
        }
        chosen
    }

    /// Whether `true` or `false` stands under `key`; `None` if there is no such key, or neither there.
    pub fn boolean(&mut self, table: &Table<'_>, key: &str) -> Option<bool> {
        let value = table.get(key)?;
        let DeValue::Boolean(found) = value.get_ref() else {
            self.wrong(key, value, "true or false");
            return None;
        };
        Some(*found)
    }

    /// The tables under `key`, each with the place of its header; there have to be 1 to `most`, or any number from 0
    /// if `most` is `None`.
    pub fn tables<'v, 'f>(
        &mut self,
        table: &'v Table<'f>,
        key: &str,
        most: Option<usize>,
    ) -> Vec<(&'v Table<'f>, Span<usize>)> {
        let expected = format!("[[{key}]] and its keys on lines of their own");
        let (list, place): (Vec<&'v Value<'f>>, _) = match table.get(key).map(|value| (value, value.get_ref())) {
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
                self.fault(place, format!("no [[{key}]]"), format!("1 to {most} of them"));
            } else if let Some(item) = list.get(most) {
                self.fault(item.span(), format!("{} times [[{key}]]", list.len()), format!("1 to {most} of them"));
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

/// `did you mean 'NAME'? `, of the known name that is nearest to what was typed; nothing if none is near.
#[must_use]
pub fn meant(typed: &str, known: &[&str]) -> String {
    nearest(typed, known).map_or_else(String::new, |name| format!("did you mean '{name}'? "))
}

/// Which of `known` was probably meant by `typed`.
pub fn nearest<'k>(typed: &str, known: &[&'k str]) -> Option<&'k str> {
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
pub fn as_number(value: &Value<'_>) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(number) => number.as_str().parse().ok(),
        DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
        DeValue::Integer(number) => u64::from_str_radix(number.as_str(), number.radix()).ok().map(|n| n as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is wrong with `text`, read by `read`.
    fn told(text: &str, read: impl Fn(&mut Reader<'_>, &Table<'_>)) -> Vec<String> {
        let (mut reader, table) = Reader::parse(text).expect("TOML");
        read(&mut reader, &table);
        reader.finish(()).err().into_iter().flat_map(|faults| faults.list().to_vec()).map(|f| f.to_string()).collect()
    }

    #[test]
    fn every_fault_is_told_at_its_place_in_the_order_of_the_file() {
        let found = told("b = 0\na = 'x'\nc = nan\nz = 1", |reader, table| {
            for key in ["c", "a", "b"] {
                reader.number(table, key, Domain::Positive);
            }
            reader.only(table, &["a", "b", "c"]);
        });
        assert_eq!(
            found,
            [
                "1:5: b = 0: expected a finite number greater than 0",
                "2:5: a = 'x': expected a finite number greater than 0",
                "3:5: c = nan: expected a finite number greater than 0",
                "4:1: unknown key 'z': expected one of a, b, c; did you mean 'a'?",
            ]
        );
    }

    #[test]
    fn one_of_some_words_is_told_with_the_one_that_was_meant() {
        let of = |choices: &'static [&'static str]| {
            move |reader: &mut Reader<'_>, table: &Table<'_>| {
                let _ = reader.choice(table, "k", choices);
            }
        };
        assert_eq!(told("k = 'si'", of(&["si", "dimensionless"])), [""; 0]);
        assert_eq!(
            told("k = 'SU'", of(&["si", "dimensionless"])),
            ["1:5: k = 'SU': expected \"si\" or \"dimensionless\""]
        );
        assert_eq!(told("k = 2", of(&["si"])), ["1:5: k = 2: expected \"si\""]);
        let filters = of(&["lowpass", "notch", "lead"]);
        assert_eq!(
            told("k = 'notsch'", filters),
            ["1:5: k = 'notsch': expected one of lowpass, notch, lead; did you mean \"notch\"?"]
        );
    }

    #[test]
    fn texts_tables_and_truths_are_no_other_things() {
        assert_eq!(told("k = 1", |r, t| assert_eq!(r.string(t, "k", "a name"), None)), ["1:5: k = 1: expected a name"]);
        assert_eq!(told("k = 1", |r, t| assert_eq!(r.boolean(t, "k"), None)), ["1:5: k = 1: expected true or false"]);
        assert_eq!(
            told("k = 1", |r, t| assert!(r.table(t, "k").is_none())),
            ["1:5: k = 1: expected [k] and its keys on lines of their own"]
        );
        assert_eq!(told("k = true", |r, t| assert_eq!(r.boolean(t, "k"), Some(true))), [""; 0]);
        assert_eq!(told("", |r, t| assert_eq!((r.boolean(t, "k"), r.string(t, "k", "")), (None, None))), [""; 0]);
    }

    #[test]
    fn no_more_faults_are_told_than_help() {
        let text: String = (0..100).map(|i| format!("k{i} = 1\n")).collect();
        assert_eq!(told(&text, |r, t| r.only(t, &["other"])).len(), Faults::MOST);
        assert_eq!(Reader::parse(&"= \n".repeat(100)).err().map(|faults| faults.list().len()), Some(Faults::MOST));
    }
}
