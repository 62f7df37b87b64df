//! What is wrong with a file, and where.

use std::fmt;

/// One thing that is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Problem {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// What is there, as written.
    pub found: String,
    /// What should be there.
    pub expected: String,
}

impl Problem {
    /// A problem at the byte `offset` of `text`.
    #[must_use]
    pub fn at(text: &str, offset: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        let (line, column) = position(text, offset);
        Self { line, column, found: found.into(), expected: expected.into() }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, column, found, expected } = self;
        write!(f, "{line}:{column}: {found}: expected {expected}")
    }
}

/// All that is wrong with a file, in the order of its lines; never empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problems(Vec<Problem>);

impl Problems {
    /// The longest list that helps anyone.
    pub(super) const MOST: usize = 20;

    /// These problems, if there are any.
    #[must_use]
    pub fn some(found: Vec<Problem>) -> Option<Self> {
        (!found.is_empty()).then_some(Self(found))
    }

    /// The problems, at most 20 of them.
    #[must_use]
    pub fn list(&self) -> &[Problem] {
        &self.0
    }

    /// One line a problem, each after the name of the file: `bad.toml:7:8: mass = -0.25: expected ...`.
    #[must_use]
    pub fn in_file(&self, file: &str) -> String {
        self.0.iter().map(|problem| format!("{file}:{problem}")).collect::<Vec<_>>().join("\n")
    }
}

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Self(vec![problem])
    }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.0.iter().enumerate() {
            write!(f, "{}{problem}", if i > 0 { "\n" } else { "" })?;
        }
        Ok(())
    }
}

impl std::error::Error for Problems {}

/// Line and column, both counted from 1, of the byte `offset` of `text`.
pub(super) fn position(text: &str, offset: usize) -> (usize, usize) {
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
}
