//! What is wrong with a file, and where.

use std::fmt;
use std::ops::Range;

/// One thing that is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Fault {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// The bytes of the text that it is about; empty where something is missing.
    #[serde(skip)]
    pub span: Range<usize>,
    /// What is there, as written.
    pub found: String,
    /// What should be there.
    pub expected: String,
}

impl Fault {
    /// A fault in the bytes `span` of `text`.
    #[must_use]
    pub fn at(text: &str, span: Range<usize>, found: impl Into<String>, expected: impl Into<String>) -> Self {
        let (line, column) = position(text, span.start);
        Self { line, column, span, found: found.into(), expected: expected.into() }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, column, found, expected, .. } = self;
        write!(f, "{line}:{column}: {found}: expected {expected}")
    }
}

/// All that is wrong with a file, in the order of its lines; never empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Faults(Vec<Fault>);

impl Faults {
    /// The longest list that helps anyone.
    pub const MOST: usize = 20;

    /// These faults, if there are any.
    #[must_use]
    pub fn some(found: Vec<Fault>) -> Option<Self> {
        (!found.is_empty()).then_some(Self(found))
    }

    /// The faults, at most [`Faults::MOST`] of a file that was read.
    #[must_use]
    pub fn list(&self) -> &[Fault] {
        &self.0
    }

    /// One line a fault, each after the name of the file: `bad.toml:7:8: mass = -0.25: expected ...`.
    #[must_use]
    pub fn in_file(&self, file: &str) -> String {
        self.0.iter().map(|fault| format!("{file}:{fault}")).collect::<Vec<_>>().join("\n")
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self(vec![fault])
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.0.iter().enumerate() {
            write!(f, "{}{fault}", if i > 0 { "\n" } else { "" })?;
        }
        Ok(())
    }
}

impl std::error::Error for Faults {}

/// The largest file that is read, in bytes: sixteen masses with a comment each take less than a hundredth of it.
pub const MAX_BYTES: usize = 1 << 20;

/// The text of a file's bytes; `what` says what kind of file it is meant to be, for the message.
///
/// # Errors
/// More than [`MAX_BYTES`], or bytes that are not UTF-8, at the first of them.
pub fn utf8<'b>(bytes: &'b [u8], what: &str) -> Result<&'b str, Faults> {
    if bytes.len() > MAX_BYTES {
        return Err(Fault::at("", 0..0, "more than 1 MiB", format!("{what} of at most 1 MiB")).into());
    }
    std::str::from_utf8(bytes).map_err(|error| {
        let (valid, rest) = bytes.split_at(error.valid_up_to());
        let found = format!("byte 0x{:02x} is not UTF-8", rest.first().copied().unwrap_or_default());
        let at = valid.len();
        Fault::at(&String::from_utf8_lossy(valid), at..at, found, "TOML text in UTF-8").into()
    })
}

/// Line and column, both counted from 1, of the byte `offset` of `text`.
fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = text.char_indices().take_while(|&(at, _)| at < offset).map(|(_, c)| c);
    before.fold((1, 1), |(line, column), c| if c == '\n' { (line + 1, 1) } else { (line, column + 1) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let text = "ä = 1\r\nβγ = 2";
        for (offset, place) in [(0, (1, 1)), (2, (1, 2)), (8, (2, 1)), (12, (2, 3)), (999, (2, 7))] {
            assert_eq!(position(text, offset), place, "byte {offset}");
        }
    }

    #[test]
    fn bytes_that_are_no_text_are_told_with_their_place() {
        assert_eq!(utf8(b"a = 1", "a rotor"), Ok("a = 1"));
        assert_eq!(
            utf8(b"x\na\xfc", "a rotor").unwrap_err().to_string(),
            "2:2: byte 0xfc is not UTF-8: expected TOML text in UTF-8"
        );
        assert_eq!(
            utf8(&vec![b' '; MAX_BYTES + 1], "a rotor").unwrap_err().to_string(),
            "1:1: more than 1 MiB: expected a rotor of at most 1 MiB"
        );
    }
}
