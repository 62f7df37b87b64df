//! What a figure shows, as a table of numbers.

use text::number::significant;

use crate::csv::{Field, Lines};

/// Columns with names and units, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Data {
    /// Name of every column.
    pub header: Vec<String>,
    /// The rows, each as long as the header. What is not there is not a number.
    pub rows: Vec<Vec<f64>>,
}

impl Data {
    /// An empty table.
    #[must_use]
    pub fn new(header: &[&str]) -> Self {
        Self { header: header.iter().map(|name| (*name).to_owned()).collect(), rows: Vec::new() }
    }

    /// As comma-separated values: ten significant digits, an empty field for what is not there.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut lines = Lines::new(&self.header);
        for row in &self.rows {
            lines.row(row.iter().map(|value| Field::Number(significant(*value, 10))));
        }
        lines.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_empty() {
        let mut data = Data::new(&["a", "b", "c"]);
        data.rows.push(vec![1.0 / 3.0, f64::NAN, -2.0]);
        assert_eq!(data.csv(), "a,b,c\n0.3333333333,,-2.0\n");
    }
}
