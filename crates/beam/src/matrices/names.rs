//! What the coordinates of a matrix are called: by the rows and columns of its file.

use super::MatrixError;
use crate::check::is_name;

/// A name for each coordinate, with the line that has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Names {
    names: Vec<(String, usize)>,
}

/// The names of a file with a header, names of rows, or both; the same of both.
pub(super) fn named_in(
    header: Option<(usize, Vec<String>)>,
    rows: Vec<(String, usize)>,
) -> Result<Option<Names>, MatrixError> {
    let of_header = |line: usize, names: Vec<String>| names.into_iter().map(|name| (name, line)).collect::<Vec<_>>();
    let names = match header {
        None if rows.is_empty() => return Ok(None),
        None => rows,
        Some((line, columns)) => {
            let differs = |(column, (row, _)): &(&String, &(String, usize))| *column != row;
            if let Some((column, (row, at))) = columns.iter().zip(&rows).find(differs) {
                let expected = format!("'{column}', as the columns have it in line {line}");
                return Err(MatrixError::new(format!("line {at}"), format!("a row '{row}'"), expected));
            }
            of_header(line, columns)
        }
    };
    for (i, (name, line)) in names.iter().enumerate() {
        let fault = |found: String, expected: &str| Err(MatrixError::new(format!("line {line}"), found, expected));
        if !is_name(name) {
            return fault(format!("a coordinate called {name:?}"), "a name of at most 64 bytes of printable text");
        }
        if names[..i].iter().any(|(other, _)| other == name) {
            return fault(format!("'{name}' again"), "a name of its own for each coordinate");
        }
    }
    Ok(Some(Names { names }))
}

impl Names {
    /// The names alone.
    pub(crate) fn list(&self) -> Vec<String> {
        self.names.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Where `self`, of `file`, has another name than `first`: what was found with its line, and what was expected.
    pub(crate) fn differs(&self, file: &str, (first, of): (&[String], &str)) -> Option<(String, String)> {
        let mine = self.names.iter().map(Some).chain(std::iter::repeat(None));
        let theirs = first.iter().map(Some).chain(std::iter::repeat(None));
        let most = self.names.len().max(first.len());
        let (mine, theirs) =
            mine.zip(theirs).take(most).find(|(mine, theirs)| mine.map(|(name, _)| name) != *theirs)?;
        let found = mine.map_or_else(
            || format!("{file}: {} names", self.names.len()),
            |(name, line)| format!("{file}: line {line}: '{name}'"),
        );
        let expected = theirs.map_or_else(|| format!("{} names", first.len()), |name| format!("'{name}'"));
        Some((found, format!("{expected}, as {of} has it")))
    }
}
