//! TOML text with a column of comments.

use crate::number;

/// Lines of TOML being written.
///
/// ```
/// let mut lines = text::Lines::default();
/// lines.header("mass");
/// lines.key("mass", text::number::toml(2.0), "in kg");
/// lines.key("damping", text::number::toml(0.25), "");
/// assert_eq!(lines.into_text(), "\n[[mass]]\nmass = 2.0  # in kg\ndamping = 0.25\n");
/// ```
#[derive(Debug, Default)]
pub struct Lines(Vec<(String, String)>);

impl Lines {
    /// `key = value  # comment`; no comment if it is empty.
    pub fn key(&mut self, key: &str, value: impl std::fmt::Display, comment: &str) {
        self.0.push((format!("{key} = {value}"), comment.to_owned()));
    }

    /// A blank line and `[[header]]`.
    pub fn header(&mut self, header: &str) {
        self.0.push((String::new(), String::new()));
        self.0.push((format!("[[{header}]]"), String::new()));
    }

    /// A blank line and `[header]`.
    pub fn table(&mut self, header: &str) {
        self.0.push((String::new(), String::new()));
        self.0.push((format!("[{header}]"), String::new()));
    }

    /// A comment on a line of its own; a blank line if it is empty.
    pub fn comment(&mut self, comment: &str) {
        let line = if comment.is_empty() { String::new() } else { format!("# {comment}") };
        self.0.push((line, String::new()));
    }

    /// All of it, the comments in one column unless a line is very long.
    #[must_use]
    pub fn into_text(self) -> String {
        let commented = self.0.iter().filter(|(_, comment)| !comment.is_empty());
        let column = commented.map(|(line, _)| line.chars().count()).max().unwrap_or(0).min(44);
        let line = |(line, comment): (String, String)| match comment.as_str() {
            "" => line + "\n",
            _ => format!("{line:column$}  # {comment}\n"),
        };
        self.0.into_iter().map(line).collect()
    }
}

/// A list of numbers, each reading back to the last bit.
#[must_use]
pub fn numbers(numbers: impl IntoIterator<Item = f64>) -> String {
    format!("[{}]", numbers.into_iter().map(number::toml).collect::<Vec<_>>().join(", "))
}

/// A quoted string of printable text.
#[must_use]
pub fn string(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
