//! Numbers in rows, separated by commas, semicolons or spaces. A first line of words names the columns, a word before the numbers of each
//! row that row; `#` begins a comment.

use nalgebra::DMatrix;

use super::names::{Names, named_in};
use super::{MatrixError, check_size};

pub(super) fn matrix(text: &str) -> Result<(DMatrix<f64>, Option<Names>), MatrixError> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut header: Option<(usize, Vec<String>, bool)> = None;
    let mut labels: Vec<(String, usize)> = Vec::new();
    let mut is_first = true;
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let is_separated = line.contains([',', ';']);
        let fields = fields(line, is_separated);
        if fields.iter().all(|field| field.is_empty()) {
            continue;
        }
        let place = format!("line {}", i + 1);
        // Words alone: numbers among them are a row with a mistake.
        let is_word = |field: &&str| field.parse::<f64>().is_err();
        if std::mem::take(&mut is_first) && fields.iter().all(is_word) {
            header = Some((i + 1, fields.iter().map(|name| (*name).to_owned()).collect(), is_separated));
            continue;
        }
        let (label, numbers) = match fields.split_first() {
            Some((first, rest)) if !rest.is_empty() && !first.is_empty() && is_word(first) => (Some(*first), rest),
            _ => (None, &fields[..]),
        };
        match label {
            Some(label) if labels.len() == rows.len() => labels.push((label.to_owned(), i + 1)),
            Some(label) => {
                return Err(MatrixError::new(place, format!("'{}'", short(label)), "a finite number"));
            }
            None if !labels.is_empty() => {
                let found = format!("'{}'", short(fields.first().unwrap_or(&"")));
                return Err(MatrixError::new(place, found, "a name before the numbers, as in the rows before"));
            }
            None => {}
        }
        let mut row = Vec::with_capacity(numbers.len());
        for field in numbers.iter().flat_map(|field| field.split_whitespace()) {
            let number = field.parse().ok().filter(|number: &f64| number.is_finite());
            row.push(number.ok_or_else(|| MatrixError::new(&place, format!("'{}'", short(field)), "a finite number"))?);
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
    let header =
        header.map(|(line, names, is_separated)| of_columns(line, names, is_separated, columns)).transpose()?;
    let names = named_in(header.flatten(), labels)?;
    Ok((DMatrix::from_row_iterator(rows.len(), columns, rows.into_iter().flatten()), names))
}

/// The names that a header gives to columns. Above names of rows there may be one too many, which is of those; words without separators
/// that are no name a column are a title.
fn of_columns(
    line: usize,
    mut names: Vec<String>,
    is_separated: bool,
    columns: usize,
) -> Result<Option<(usize, Vec<String>)>, MatrixError> {
    if names.len() == columns + 1 && (is_separated || names[0].is_empty()) {
        names.remove(0);
    }
    if names.len() == columns {
        return Ok(Some((line, names)));
    }
    if !is_separated {
        return Ok(None);
    }
    let expected = format!("{columns}, one a column, or a title behind #");
    Err(MatrixError::new(format!("line {line}"), format!("{} names", names.len()), expected))
}

/// What stands between separators, or between blanks where there are none; the separator at the end of a line is none.
fn fields(line: &str, is_separated: bool) -> Vec<&str> {
    if !is_separated {
        return line.split_whitespace().collect();
    }
    let line = line.trim().trim_end_matches([',', ';']);
    line.split([',', ';']).map(|field| field.trim().trim_matches('"').trim()).collect()
}

fn short(field: &str) -> String {
    let short: String = field.chars().take(40).collect();
    short.escape_debug().to_string()
}
