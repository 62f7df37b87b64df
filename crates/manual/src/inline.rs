//! What stands within a line of Markdown: words, each of pieces that look alike.

/// How a piece of a word looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Style {
    /// As it is.
    #[default]
    Plain,
    /// Between backticks; of two spans behind each other one is odd and one is even, so that they stay apart.
    Code(bool),
    /// Between two stars.
    Bold,
    /// Between single stars.
    Italic,
}

/// What no blank is within: pieces and how they look.
pub(crate) type Word = Vec<(Style, String)>;

/// The words of a text.
pub(crate) fn words(text: &str) -> Vec<Word> {
    let mut words = Words::default();
    let mut rest = text;
    let mut style = Style::Plain;
    let mut is_odd = false;
    while let Some(first) = rest.chars().next() {
        let (taken, left) = if let Some((code, left)) = code(rest) {
            is_odd = !is_odd;
            words.add(Style::Code(is_odd), code);
            (0, left)
        } else if let Some((told, left)) = link(rest) {
            words.add_all(told);
            (0, left)
        } else if rest.starts_with("**") {
            style = if style == Style::Bold { Style::Plain } else { Style::Bold };
            (2, rest)
        } else if first == '*' && is_emphasis(text, rest) {
            style = if style == Style::Italic { Style::Plain } else { Style::Italic };
            (1, rest)
        } else {
            // An escaped sign is itself.
            let behind =
                rest.strip_prefix('\\').filter(|behind| behind.starts_with(|c: char| c.is_ascii_punctuation()));
            let shown = behind.unwrap_or(rest).chars().next().unwrap_or(first);
            words.add(style, shown.encode_utf8(&mut [0; 4]));
            (usize::from(behind.is_some()) + shown.len_utf8(), rest)
        };
        rest = &left[taken..];
    }
    words.finish()
}

/// The code that a text begins with, and what is behind it.
fn code(text: &str) -> Option<(&str, &str)> {
    text.strip_prefix('`')?.split_once('`')
}

/// Whether the star that `rest` begins with opens or closes italics: a letter is on the one side of it and none on the other.
fn is_emphasis(text: &str, rest: &str) -> bool {
    let before = text[..text.len() - rest.len()].chars().next_back();
    let behind = rest[1..].chars().next();
    let is_blank = |c: Option<char>| c.is_none_or(|c| c.is_whitespace() || c == '(');
    is_blank(before) != is_blank(behind) || behind.is_some_and(|c| c.is_ascii_punctuation())
}

/// What a link or picture that a text begins with is told as, and what is behind it.
fn link(text: &str) -> Option<(Vec<Word>, &str)> {
    let (is_picture, inner) = match text.strip_prefix('!') {
        Some(behind) => (true, behind.strip_prefix('[')?),
        None => (false, text.strip_prefix('[')?),
    };
    let (label, behind) = inner.split_once("](")?;
    // A bracket that opens before the link is no part of it.
    if label.contains(']') || label.contains('\n') {
        return None;
    }
    let (target, behind) = behind.split_once(')')?;
    let (file, _) = target.split_once('#').unwrap_or((target, ""));
    let topic = file.strip_suffix(".md");
    let told = match topic {
        _ if is_picture => words(&format!("(picture: {label})")),
        _ if target.contains("://") => words(&format!("{label} <{target}>")),
        // A page called by its name is told as the command that shows it.
        Some(topic) if label == file || label == topic => help(topic),
        Some(topic) => {
            let mut told = words(label);
            let mut command = help(topic);
            if let Some(first) = command.first_mut() {
                first.insert(0, (Style::Plain, "(".into()));
            }
            if let Some(last) = command.last_mut() {
                last.push((Style::Plain, ")".into()));
            }
            told.extend(command);
            told
        }
        None => words(label),
    };
    Some((told, behind))
}

fn help(topic: &str) -> Vec<Word> {
    ["whirl", "help", topic].map(|word| vec![(Style::Code(false), word.to_owned())]).into()
}

/// Words that are being put together.
#[derive(Default)]
struct Words {
    done: Vec<Word>,
    open: Word,
}

impl Words {
    /// Adds text, in which blanks end words.
    fn add(&mut self, style: Style, text: &str) {
        for c in text.chars() {
            if c.is_whitespace() {
                self.end();
                continue;
            }
            match self.open.last_mut() {
                Some((last, piece)) if *last == style => piece.push(c),
                _ => self.open.push((style, c.to_string())),
            }
        }
    }

    /// Adds words: the first goes on with what is open, and the last stays so.
    fn add_all(&mut self, words: Vec<Word>) {
        for (at, word) in words.into_iter().enumerate() {
            if at > 0 {
                self.end();
            }
            self.open.extend(word);
        }
    }

    fn end(&mut self) {
        if !self.open.is_empty() {
            self.done.push(std::mem::take(&mut self.open));
        }
    }

    fn finish(mut self) -> Vec<Word> {
        self.end();
        self.done
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> String {
        let told: Vec<String> = words(text).iter().map(|word| word.iter().map(|(_, t)| t.as_str()).collect()).collect();
        told.join(" ")
    }

    #[test]
    fn links_are_told_as_what_shows_them() {
        assert_eq!(plain("see [join.md](join.md#sim), or"), "see whirl help join, or");
        assert_eq!(plain("keep a [recording](recordings.md)."), "keep a recording (whirl help recordings).");
        assert_eq!(plain("[Keys](#keys) · [Gains](#gains)"), "Keys · Gains");
        assert_eq!(plain("the [Rerun](https://rerun.io) viewer"), "the Rerun <https://rerun.io> viewer");
        assert_eq!(plain("![poles and damping](pictures/a.svg)"), "(picture: poles and damping)");
        assert_eq!(plain("keys `[ ]` seek [sic] (a)"), "keys [ ] seek [sic] (a)");
    }

    #[test]
    fn signs_of_emphasis_go_and_stars_within_code_stay() {
        assert_eq!(plain("**Find** it, *proven*; `a * b` \\| 2 * 3"), "Find it, proven; a * b | 2 * 3");
        assert_eq!(
            words("*Waits*: a`b`"),
            [
                vec![(Style::Italic, "Waits".into()), (Style::Plain, ":".into())],
                vec![(Style::Plain, "a".into()), (Style::Code(true), "b".into())]
            ]
        );
    }
}
