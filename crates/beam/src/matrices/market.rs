//! Matrix Market, of coordinates or whole arrays (R. F. Boisvert, R. Pozo, K. A. Remington, NISTIR 5935, 1996).

use nalgebra::DMatrix;

use super::{MatrixError, check_size};

const HEADER: &str = "%%MatrixMarket matrix coordinate|array real|integer general|symmetric|skew-symmetric";

pub(super) fn matrix(text: &str) -> Result<DMatrix<f64>, MatrixError> {
    let header = text.lines().next().unwrap_or_default();
    let words: Vec<String> = header.split_whitespace().map(str::to_ascii_lowercase).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let ["%%matrixmarket", "matrix", layout @ ("coordinate" | "array"), "real" | "integer" | "double", symmetry] =
        words[..]
    else {
        let short: String = header.chars().take(60).collect();
        return Err(MatrixError::new("line 1", format!("'{}'", short.escape_debug()), HEADER));
    };
    let sign = match symmetry {
        "general" => None,
        "symmetric" => Some(1.0),
        "skew-symmetric" => Some(-1.0),
        _ => return Err(MatrixError::new("line 1", symmetry, "general, symmetric or skew-symmetric")),
    };
    let body = text.lines().enumerate().skip(1).map(|(i, line)| (i + 1, line.trim()));
    let mut body = body.filter(|(_, line)| !line.is_empty() && !line.starts_with('%'));
    let (at, sizes) = body.next().unwrap_or((1, ""));
    let place = format!("line {at}");
    let sizes: Vec<usize> = sizes.split_whitespace().map_while(|size| size.parse().ok()).collect();
    let (rows, columns, count) = match (layout, sizes.as_slice()) {
        ("coordinate", &[rows, columns, count]) => (rows, columns, Some(count)),
        ("array", &[rows, columns]) => (rows, columns, None),
        _ => {
            return Err(MatrixError::new(
                place,
                "no sizes",
                "rows, columns and, of coordinates, the number of entries",
            ));
        }
    };
    check_size(&place, rows, columns)?;
    if sign.is_some() && rows != columns {
        return Err(MatrixError::new(place, format!("{rows} rows and {columns} columns"), "as many of each"));
    }
    // Where the entries of an array go: down each column, only below the diagonal where the rest mirrors it.
    let first = |column: usize| match symmetry {
        "general" => 0,
        "symmetric" => column,
        _ => column + 1,
    };
    let mut places = (0..columns).flat_map(|column| (first(column)..rows).map(move |row| (row, column)));
    let mut matrix = DMatrix::zeros(rows, columns);
    let mut read = 0;
    for (at, line) in body {
        let place = format!("line {at}");
        let fields: Vec<&str> = line.split_whitespace().collect();
        let wrong = |expected: &str| {
            let short: String = line.chars().take(40).collect();
            MatrixError::new(&place, format!("'{}'", short.escape_debug()), expected)
        };
        let number = |field: &str| field.parse().ok().filter(|number: &f64| number.is_finite());
        let (row, column, value) = match (count, fields.as_slice()) {
            (Some(_), &[row, column, value]) => {
                let index = |field: &str, most: usize| {
                    field.parse().ok().filter(|index| (1..=most).contains(index)).map(|index| index - 1)
                };
                let parts = (index(row, rows), index(column, columns), number(value));
                let (Some(row), Some(column), Some(value)) = parts else {
                    return Err(wrong("a row, a column and a finite number, counted from 1 and within the sizes"));
                };
                (row, column, value)
            }
            (None, &[value]) => {
                let value = number(value).ok_or_else(|| wrong("a finite number"))?;
                let (row, column) = places.next().ok_or_else(|| wrong("no more entries than the sizes say"))?;
                (row, column, value)
            }
            (Some(_), _) => return Err(wrong("a row, a column and a number")),
            (None, _) => return Err(wrong("one number")),
        };
        read += 1;
        matrix[(row, column)] += value;
        if let (Some(sign), true) = (sign, row != column) {
            matrix[(column, row)] += sign * value;
        }
    }
    let expected = count.unwrap_or_else(|| (0..columns).map(|column| rows.saturating_sub(first(column))).sum());
    if read != expected {
        return Err(MatrixError::new("the file", format!("{read} entries"), format!("{expected}, as its sizes say")));
    }
    Ok(matrix)
}
