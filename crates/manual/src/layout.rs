//! A page laid out for a terminal, or for whatever reads a pipe.

use unicode_width::UnicodeWidthStr;

use crate::block::{Block, blocks};
use crate::inline::{Style, Word, words};
use crate::table;

/// Whether styles are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// Text alone; code keeps its backticks where it would not be told from words.
    Plain,
    /// Bold headings, code and signs of a terminal (SGR).
    Styled,
}

/// How far commands, files and output are moved in.
const INDENT: &str = "    ";

/// A page of Markdown as text.
pub(crate) fn show(markdown: &str, width: usize, look: Look) -> String {
    let width = width.max(20);
    let mut out = String::new();
    let mut was_item = false;
    for block in blocks(markdown) {
        let is_item = matches!(block, Block::Item(..));
        // Items of a list follow each other at once.
        let goes_on = is_item && was_item;
        if !out.is_empty() && !goes_on {
            out.push('\n');
        }
        was_item = is_item;
        match block {
            Block::Heading(depth, title) => heading(&mut out, depth, &title, width, look),
            Block::Paragraph(text) => lines(&mut out, &words(&text), ("", ""), width, look),
            Block::Item(indent, sign, text) => {
                let first = format!("{}{sign} ", " ".repeat(indent));
                let further = " ".repeat(first.len());
                lines(&mut out, &words(&text), (&first, &further), width, look);
            }
            Block::Verbatim(all) => {
                for line in all {
                    out += format!("{INDENT}{line}").trim_end();
                    out.push('\n');
                }
            }
            Block::Table(rows) => out += &table::show(&rows, width, look),
        }
    }
    out
}

fn heading(out: &mut String, depth: usize, title: &str, width: usize, look: Look) {
    let bold = |word: Word| word.into_iter().map(|(_, piece)| (Style::Bold, piece)).collect();
    let title: Vec<Word> = words(title).into_iter().map(bold).collect();
    let begin = out.len();
    lines(out, &title, ("", ""), width, look);
    // Without bold letters a heading is told by the line below it.
    if look == Look::Plain && depth < 3 {
        let wide = out[begin..].lines().map(UnicodeWidthStr::width).max().unwrap_or(0);
        *out += &(if depth == 1 { "=" } else { "-" }).repeat(wide);
        out.push('\n');
    }
}

/// Words in lines of at most `width` cells, the first and the others begun by these.
fn lines(out: &mut String, words: &[Word], (first, further): (&str, &str), width: usize, look: Look) {
    let room = width.saturating_sub(first.width());
    for (at, line) in wrapped(words, room, look).iter().enumerate() {
        out.push_str(if at == 0 { first } else { further });
        out.push_str(line);
        out.push('\n');
    }
}

/// Words in lines of at most `room` cells. A word that is longer has a line of its own, and keeps its length.
pub(crate) fn wrapped(words: &[Word], room: usize, look: Look) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut used = 0;
    let mut last = Style::Plain;
    for (at, word) in words.iter().enumerate() {
        let alone = cells(word, look);
        // Code that goes on over a blank has its backticks at either end alone.
        let before = words.get(at.wrapping_sub(1)).and_then(|before| before.last()).map(|(style, _)| *style);
        let goes_on = look == Look::Plain
            && matches!(before, Some(Style::Code(_)))
            && before == word.first().map(|(style, _)| *style);
        let mut wide = alone - if used > 0 && goes_on { 2 } else { 0 };
        if used > 0 && used + 1 + wide > room {
            if let Some(line) = lines.last_mut() {
                switch(line, &mut last, Style::Plain, look);
            }
            lines.push(String::new());
            (used, wide) = (0, alone);
        }
        let Some(line) = lines.last_mut() else { continue };
        if used > 0 {
            // A blank between words that look alike looks like them.
            if word.first().is_none_or(|(style, _)| *style != last) {
                switch(line, &mut last, Style::Plain, look);
            }
            line.push(' ');
            used += 1;
        }
        for (style, piece) in word {
            switch(line, &mut last, *style, look);
            line.push_str(piece);
        }
        // Code that ends with its word, or goes on in the next one.
        let goes_on = words.get(at + 1).and_then(|next| next.first()).is_some_and(|(style, _)| *style == last);
        if !goes_on {
            switch(line, &mut last, Style::Plain, look);
        }
        used += wide;
    }
    if let Some(line) = lines.last_mut() {
        switch(line, &mut last, Style::Plain, look);
    }
    lines
}

/// The cells that a word takes alone, with the backticks that plain text has.
fn cells(word: &Word, look: Look) -> usize {
    let wide: usize = word.iter().map(|(_, piece)| piece.width()).sum();
    let codes = word.iter().filter(|(style, _)| matches!(style, Style::Code(_))).count();
    if look == Look::Plain { wide + 2 * codes } else { wide }
}

/// Goes over from one style to another.
fn switch(line: &mut String, last: &mut Style, next: Style, look: Look) {
    if *last == next {
        return;
    }
    match look {
        Look::Plain => {
            let tick = |style| if matches!(style, Style::Code(_)) { "`" } else { "" };
            line.push_str(tick(*last));
            line.push_str(tick(next));
        }
        Look::Styled => {
            if *last != Style::Plain {
                line.push_str("\x1b[0m");
            }
            line.push_str(match next {
                Style::Plain => "",
                Style::Code(_) => "\x1b[36m",
                Style::Bold => "\x1b[1m",
                Style::Italic => "\x1b[3m",
            });
        }
    }
    *last = next;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topics;

    #[test]
    fn text_is_wrapped_and_commands_are_not() {
        let page = "# Title\n\nOne two `whirl up` three four five.\n\n* an item that goes on\n\n```sh\nwhirl poles three-mass --speed 2.5   # long\n```\n";
        assert_eq!(
            show(page, 20, Look::Plain),
            "Title\n=====\n\nOne two `whirl up`\nthree four five.\n\n* an item that goes\n  on\n\n    whirl poles three-mass --speed 2.5   # long\n"
        );
        assert_eq!(
            show("## A `b`\n\na `b c` **d** e", 80, Look::Styled),
            "\x1b[1mA b\x1b[0m\n\na \x1b[36mb c\x1b[0m \x1b[1md\x1b[0m e\n"
        );
    }

    #[test]
    fn every_page_fits_a_terminal_but_for_what_must_not_be_broken() {
        for page in topics().map(|topic| crate::page(topic).expect("it is listed")) {
            let kept: Vec<String> = blocks(page.markdown)
                .into_iter()
                .filter_map(|block| if let Block::Verbatim(lines) = block { Some(lines) } else { None })
                .flatten()
                .collect();
            for width in [60, 80, 120] {
                let shown = page.show(width, Look::Plain);
                assert!(!shown.contains('\x1b') && !shown.contains("]("), "{}", page.topic);
                for line in shown.lines().filter(|line| line.width() > width) {
                    let is_kept = kept.iter().any(|kept| kept.trim() == line.trim());
                    let is_one_word = line.split_whitespace().any(|word| word.width() + 20 > width);
                    assert!(is_kept || is_one_word, "{} at {width}: {line}", page.topic);
                }
                // Styles change nothing but how it looks.
                let styled = page.show(width, Look::Styled);
                assert_eq!(styled.matches("\x1b[0m").count() * 2, styled.matches('\x1b').count(), "{}", page.topic);
            }
        }
    }
}
