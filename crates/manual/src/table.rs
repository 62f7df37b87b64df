//! Tables: columns beside each other, their cells wrapped where the width asks for it.

use unicode_width::UnicodeWidthStr;

use crate::inline::{Word, words};
use crate::layout::{Look, wrapped};

/// Between two columns.
const GAP: usize = 2;
/// No column is made narrower than this, even where the table is wider than the terminal then.
const LEAST: usize = 4;
/// A column is at least as wide as its longest word where there is room, but no longer word than this asks for it.
const WORD: usize = 16;

/// A table as text.
pub(crate) fn show(rows: &[Vec<String>], width: usize, look: Look) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let rows: Vec<Vec<Vec<Word>>> =
        rows.iter().map(|row| (0..columns).map(|at| words(row.get(at).map_or("", String::as_str))).collect()).collect();
    let wide: Vec<usize> = (0..columns).map(|at| rows.iter().map(|row| length(&row[at])).max().unwrap_or(0)).collect();
    let longest = |at: usize| rows.iter().flat_map(|row| &row[at]).map(|word| length(std::slice::from_ref(word))).max();
    let least: Vec<usize> = (0..columns).map(|at| longest(at).unwrap_or(0).min(WORD)).collect();
    let wide = fitted(wide, &least, width);
    let is_wrapped = rows.iter().any(|row| row.iter().zip(&wide).any(|(cell, wide)| length(cell) > *wide));
    let mut out = String::new();
    for (at, row) in rows.iter().enumerate() {
        let cells = row.iter().zip(&wide).map(|(cell, wide)| wrapped(&cut(cell, *wide), *wide, look));
        let cells: Vec<Vec<String>> = cells.collect();
        let high = cells.iter().map(Vec::len).max().unwrap_or(0);
        for line in 0..high {
            let mut told = String::new();
            for (cell, wide) in cells.iter().zip(&wide) {
                let part = cell.get(line).map_or("", String::as_str);
                told += part;
                told += &" ".repeat((wide + GAP).saturating_sub(shown_width(part)));
            }
            out += told.trim_end();
            out.push('\n');
        }
        // Rows of several lines are told apart by what is between them.
        if at == 0 {
            let rule: Vec<String> = wide.iter().map(|wide| "-".repeat(*wide)).collect();
            out += rule.join("  ").trim_end();
            out.push('\n');
        } else if is_wrapped && at + 1 < rows.len() {
            out.push('\n');
        }
    }
    out
}

/// The same words, those cut that are wider than their column: a column that is left would push the others away.
fn cut(words: &[Word], wide: usize) -> Vec<Word> {
    let mut cut: Vec<Word> = Vec::new();
    for word in words {
        if length(std::slice::from_ref(word)) <= wide {
            cut.push(word.clone());
            continue;
        }
        // Room for the backticks of code at either end.
        let room = wide.saturating_sub(2).max(1);
        for (style, piece) in word {
            let mut part = String::new();
            for c in piece.chars() {
                let longer = format!("{part}{c}");
                if longer.width() > room && !part.is_empty() {
                    cut.push(vec![(*style, std::mem::take(&mut part))]);
                }
                part.push(c);
            }
            cut.push(vec![(*style, part)]);
        }
    }
    cut
}

/// The cells that words take in one line of plain text.
fn length(words: &[Word]) -> usize {
    wrapped(words, usize::MAX / 2, Look::Plain).first().map_or(0, |line| line.width())
}

/// The cells that a part of a line takes, without its styles.
fn shown_width(text: &str) -> usize {
    let mut wide = 0;
    for (at, part) in text.split('\x1b').enumerate() {
        wide += if at == 0 { part } else { part.split_once('m').map_or("", |(_, rest)| rest) }.width();
    }
    wide
}

/// Widths that fit: each column has its longest word, and what is left goes where text is long. Where not even the words fit, what is narrow
/// stays and the rest share what is left.
fn fitted(mut wide: Vec<usize>, least: &[usize], width: usize) -> Vec<usize> {
    let room = width.saturating_sub(GAP * wide.len().saturating_sub(1));
    if wide.iter().sum::<usize>() <= room {
        return wide;
    }
    let taken: usize = least.iter().sum();
    if taken <= room {
        let missing = |at: usize| wide[at].saturating_sub(least[at]);
        let all: usize = (0..wide.len()).map(missing).sum();
        return (0..wide.len()).map(|at| least[at] + missing(at) * (room - taken) / all.max(1)).collect();
    }
    let mut order: Vec<usize> = (0..wide.len()).collect();
    order.sort_by_key(|&at| wide[at]);
    let mut left = room;
    for (done, &at) in order.iter().enumerate() {
        let share = left / (order.len() - done);
        wide[at] = wide[at].min(share.max(LEAST));
        left = left.saturating_sub(wide[at]);
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rows: &[&[&str]]) -> Vec<Vec<String>> {
        rows.iter().map(|row| row.iter().map(|cell| (*cell).to_owned()).collect()).collect()
    }

    #[test]
    fn columns_stand_below_each_other_and_wrap_where_they_must() {
        let table = rows(&[&["key", "what it does"], &["`q`", "quits"], &["漢", "it"]]);
        assert_eq!(show(&table, 80, Look::Plain), "key  what it does\n---  ------------\n`q`  quits\n漢   it\n");
        let long = rows(&[&["key", "what"], &["a", "one two three four"], &["b", "x"]]);
        assert_eq!(
            show(&long, 20, Look::Plain),
            "key  what\n---  ---------------\na    one two three\n     four\n\nb    x\n"
        );
    }

    #[test]
    fn narrow_columns_keep_their_width() {
        assert_eq!(fitted(vec![4, 5, 6], &[1, 1, 1], 60), [4, 5, 6]);
        // 56 cells: 4, 8 and 10 for words, and the 34 that are left go to the long one.
        assert_eq!(fitted(vec![4, 100, 10], &[4, 8, 10], 60), [4, 42, 10]);
        // No room for the words.
        assert_eq!(fitted(vec![100, 100], &[16, 16], 22), [10, 10]);
    }
}
