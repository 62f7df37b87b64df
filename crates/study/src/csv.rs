//! Rows of comma-separated values, the one way in which every table goes to a spreadsheet, a data frame or a database.
//!
//! Readers guess the type of a column from its first rows. So a number that is measured or computed always has a point,
//! and every digit; what is counted never has one; and what is not finite, or not there, is an empty field, because a word
//! in a column of numbers makes it a column of words.

use std::io::{self, Write};

/// One field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Field<'a> {
    /// What is measured or computed.
    Number(f64),
    /// What is counted.
    Count(u64),
    /// Words.
    Text(&'a str),
    /// Nothing.
    Empty,
}

impl From<Option<f64>> for Field<'_> {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Empty, Self::Number)
    }
}

/// A number with a point and every digit: `1.0`, `1.0e-7`; nothing if it is not finite.
#[must_use]
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let text = format!("{value:?}");
    match text.split_once('e') {
        Some((digits, power)) if !digits.contains('.') => format!("{digits}.0e{power}"),
        _ => text,
    }
}

/// Writes rows.
pub struct Csv<W: Write> {
    rows: ::csv::Writer<W>,
}

impl<W: Write> Csv<W> {
    /// Begins with the names of the columns.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn begin<N: AsRef<[u8]>>(out: W, names: impl IntoIterator<Item = N>) -> io::Result<Self> {
        let mut rows = ::csv::WriterBuilder::new().flexible(true).from_writer(out);
        rows.write_record(names)?;
        Ok(Self { rows })
    }

    /// Adds a row of as many fields as there are columns.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn row<'a>(&mut self, fields: impl IntoIterator<Item = Field<'a>>) -> io::Result<()> {
        for field in fields {
            match field {
                Field::Number(value) => self.rows.write_field(number(value))?,
                Field::Count(value) => self.rows.write_field(value.to_string())?,
                Field::Text(text) => self.rows.write_field(text)?,
                Field::Empty => self.rows.write_field("")?,
            }
        }
        self.rows.write_record(None::<&[u8]>)?;
        Ok(())
    }

    /// What the rows have been written to, all of them.
    ///
    /// # Errors
    /// The rest cannot be written.
    pub fn finish(self) -> io::Result<W> {
        self.rows.into_inner().map_err(::csv::IntoInnerError::into_error)
    }
}

/// Rows in memory, which takes everything.
pub struct Lines(Csv<Vec<u8>>);

impl Lines {
    /// Begins with the names of the columns.
    #[must_use]
    pub fn new<N: AsRef<[u8]>>(names: impl IntoIterator<Item = N>) -> Self {
        let mut rows = ::csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
        let _ = rows.write_record(names);
        Self(Csv { rows })
    }

    /// Adds a row of as many fields as there are columns.
    pub fn row<'a>(&mut self, fields: impl IntoIterator<Item = Field<'a>>) {
        let _ = self.0.row(fields);
    }

    /// The rows as text.
    #[must_use]
    pub fn finish(self) -> String {
        String::from_utf8_lossy(&self.0.finish().unwrap_or_default()).into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_whole_numbers_of_a_column_of_numbers_have_a_point_and_infinity_is_empty() {
        for (value, expected) in [
            (1.0, "1.0"),
            (-0.0, "-0.0"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e16, "1.0e16"),
            (5e-324, "5.0e-324"),
            (1.5e300, "1.5e300"),
            (f64::INFINITY, ""),
            (f64::NAN, ""),
        ] {
            assert_eq!(number(value), expected);
            assert!(expected.is_empty() || number(value).parse::<f64>().unwrap().to_bits() == value.to_bits());
        }
    }

    #[test]
    fn words_are_quoted_and_counts_stay_whole() {
        let mut lines = Lines::new(["a", "b", "c"]);
        lines.row([Field::Number(2.0), Field::Count(2), Field::Text("x, \"y\"")]);
        lines.row([None.into(), Field::Count(0), Field::Empty]);
        assert_eq!(lines.finish(), "a,b,c\n2.0,2,\"x, \"\"y\"\"\"\n,0,\n");
    }
}
