//! Good files with a few things wrong: another number, a line less or twice, a word from elsewhere, a byte, an end too soon.

use proptest::prelude::*;

/// Numbers that readers and arithmetic stumble over, and a few that are fine.
const NUMBERS: [&str; 32] = [
    "0",
    "0.0",
    "-0.0",
    "1",
    "1.0",
    "0.5",
    "2",
    "-1",
    "3",
    "16",
    "17",
    "0.25",
    "1e-5",
    "1e-12",
    "1e-300",
    "5e-324",
    "1e5",
    "1e12",
    "1e150",
    "1e300",
    "1.7976931348623157e308",
    "1e999",
    "inf",
    "-inf",
    "nan",
    "9223372036854775807",
    "-9223372036854775808",
    "0x10",
    "1_000",
    "1e",
    "true",
    "\"1\"",
];

/// What may stand in the place of anything.
const WORDS: [&str; 26] = [
    "=",
    "[",
    "]",
    "[[mass]]",
    "[[shaft]]",
    "[[signal]]",
    "[[screen]]",
    "[keys]",
    "[alarms]",
    "[loop]",
    "\"",
    "\"\"\"",
    "'''",
    "#",
    "{",
    "}",
    ",",
    "..",
    "units = \"si\"",
    "picture = \"poles\"",
    "strips = \"y y\"",
    "\u{0}",
    "\u{202e}",
    "\u{1f980}",
    "\u{301}",
    "poles",
];

/// One thing done to a text: what, where, with what.
type Edit = (u8, u32, u16);

/// Texts that are one of `seeds` with up to seven edits.
pub(crate) fn mutated(seeds: Vec<String>) -> impl Strategy<Value = String> {
    let edits = prop::collection::vec((any::<u8>(), any::<u32>(), any::<u16>()), 0..8);
    (0..seeds.len(), edits).prop_map(move |(seed, edits)| edits.iter().fold(seeds[seed].clone(), edited))
}

#[allow(clippy::needless_pass_by_value, reason = "a step of a fold")]
fn edited(text: String, &(what, at, with): &Edit) -> String {
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let (line, with) = (at as usize % lines.len().max(1), usize::from(with));
    let mut changed = lines.clone();
    match what % 8 {
        // Numbers most of all: the rest is mostly told at once.
        0..=2 => number_in_place(&text, at as usize, NUMBERS[with % NUMBERS.len()]),
        3 if !lines.is_empty() => {
            changed.remove(line);
            changed.concat()
        }
        4 if !lines.is_empty() => {
            changed.insert(with % lines.len(), lines[line]);
            changed.concat()
        }
        5 => insert(&text, at as usize, WORDS[with % WORDS.len()]),
        6 => insert(&text, at as usize, char::from_u32(with as u32).unwrap_or('?').encode_utf8(&mut [0; 4])),
        _ => text[..place(&text, at as usize)].to_owned(),
    }
}

/// A place in `text` between two characters.
fn place(text: &str, at: usize) -> usize {
    text.floor_char_boundary(at % (text.len() + 1))
}

fn insert(text: &str, at: usize, what: &str) -> String {
    let (before, behind) = text.split_at(place(text, at));
    [before, what, behind].concat()
}

/// Puts `number` in the place of one that is there.
fn number_in_place(text: &str, at: usize, number: &str) -> String {
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e');
    let starts: Vec<usize> = text
        .char_indices()
        .filter(|(place, c)| c.is_ascii_digit() && !text[..*place].ends_with(is_part))
        .map(|(place, _)| place)
        .collect();
    let Some(&start) = starts.get(at % starts.len().max(1)) else { return text.to_owned() };
    let length = text[start..].find(|c| !is_part(c)).unwrap_or(text.len() - start);
    [&text[..start], number, &text[start + length..]].concat()
}
