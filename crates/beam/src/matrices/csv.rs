//! Numbers in rows, separated by commas, semicolons or spaces. A first line of words is a header; `#` begins a comment.

use nalgebra::DMatrix;

use super::{MatrixError, check_size};

pub(super) fn matrix(text: &str) -> Result<DMatrix<f64>, MatrixError> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut header = true;
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let separators = |c: char| c == ',' || c == ';' || c.is_whitespace();
        let fields: Vec<&str> = line.split(separators).filter(|field| !field.is_empty()).collect();
        if fields.is_empty() {
            continue;
        }
        let place = format!("line {}", i + 1);
        // Words alone: numbers among them are a row with a mistake.
        if std::mem::take(&mut header) && fields.iter().all(|field| field.parse::<f64>().is_err()) {
            continue;
        }
        let mut row = Vec::with_capacity(fields.len());
        for field in fields {
            let number = field.parse().ok().filter(|number: &f64| number.is_finite());
            row.push(number.ok_or_else(|| {
                let short: String = field.chars().take(40).collect();
                MatrixError::new(&place, format!("'{}'", short.escape_debug()), "a finite number")
            })?);
        }
        if let Some(before) = rows.last()
            && before.len() != row.len()
        {
            let expected = format!("{} numbers, as in the row before", before.len());
            return Err(MatrixError::new(place, format!("a row of {}", row.len()), expected));
        }
        check_size(&place, rows.len() + 1, row.len())?;
        rows.push(row);
    }
    let columns = rows.first().map_or(0, Vec::len);
    check_size("the file", rows.len(), columns)?;
    Ok(DMatrix::from_row_iterator(rows.len(), columns, rows.into_iter().flatten()))
}
