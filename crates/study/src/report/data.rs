//! What a figure shows, as a table of numbers.

use std::fmt::Write;

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
        let mut out = self.header.join(",") + "\n";
        for row in &self.rows {
            for (i, value) in row.iter().enumerate() {
                let comma = if i == 0 { "" } else { "," };
                // Writing to a string does not fail.
                let _ = match value.is_finite() {
                    true => write!(out, "{comma}{}", significant(*value)),
                    false => write!(out, "{comma}"),
                };
            }
            out.push('\n');
        }
        out
    }
}

/// Ten significant digits, as the shortest number that has them.
fn significant(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_empty() {
        let mut data = Data::new(&["a", "b", "c"]);
        data.rows.push(vec![1.0 / 3.0, f64::NAN, -2.0]);
        assert_eq!(data.csv(), "a,b,c\n0.3333333333,,-2\n");
    }
}
