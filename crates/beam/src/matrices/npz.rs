//! Arrays of NumPy, alone (`.npy`) and in an archive (`.npz`, a ZIP file, plain or deflated).

use nalgebra::DMatrix;

use super::{MatrixError, NAMES, check_size};
use crate::MAX_ROWS;

/// The most bytes that an array of ours unpacks to, with its header.
const MOST: usize = 8 * MAX_ROWS * MAX_ROWS + (1 << 16);

/// A number of so many bytes in `bytes`, the least byte first.
fn little(bytes: &[u8], at: usize, length: usize) -> Option<usize> {
    let part = bytes.get(at..at.checked_add(length)?)?;
    Some(part.iter().rev().fold(0, |number, &byte| number << 8 | usize::from(byte)))
}

/// Every array of an archive that has a name of ours, and the others by theirs.
pub(super) fn archive(bytes: &[u8]) -> Result<Vec<(String, DMatrix<f64>)>, MatrixError> {
    let broken =
        || MatrixError::new("the archive", "a ZIP file that is damaged", "a file that numpy.savez has written");
    // The end of the directory, behind which a comment may stand.
    let end = bytes.windows(4).rposition(|part| part == b"PK\x05\x06").ok_or_else(broken)?;
    let count = little(bytes, end + 10, 2).ok_or_else(broken)?;
    let mut at = little(bytes, end + 16, 4).ok_or_else(broken)?;
    let mut arrays = Vec::new();
    for _ in 0..count {
        let field = |offset, length| little(bytes, at + offset, length).ok_or_else(broken);
        if bytes.get(at..at + 4) != Some(b"PK\x01\x02") {
            return Err(broken());
        }
        let (method, sum, packed, length) = (field(10, 2)?, field(16, 4)?, field(20, 4)?, field(24, 4)?);
        let (name, extra, comment) = (field(28, 2)?, field(30, 2)?, field(32, 2)?);
        let local = field(42, 4)?;
        let named = bytes.get(at + 46..at + 46 + name).ok_or_else(broken)?;
        at += 46 + name + extra + comment;
        let full = String::from_utf8_lossy(named).into_owned();
        let Some(name) = full.strip_suffix(".npy") else { continue };
        if !NAMES.iter().any(|&(long, short)| name == long || name == short) {
            continue;
        }
        // Of the local header only what says how long it is: sizes there may be left out.
        let skip = |offset| little(bytes, local + offset, 2).ok_or_else(broken);
        let start = local + 30 + skip(26)? + skip(28)?;
        let data = bytes.get(start..start.saturating_add(packed)).ok_or_else(broken)?;
        if length > MOST {
            let expected = format!("at most {MAX_ROWS} rows and columns");
            return Err(MatrixError::new(name, format!("{length} bytes"), expected));
        }
        let unpacked;
        let data = match method {
            0 => data,
            8 => {
                unpacked = miniz_oxide::inflate::decompress_to_vec_with_limit(data, MOST).map_err(|_| broken())?;
                &unpacked
            }
            _ => return Err(MatrixError::new(name, format!("packed by method {method}"), "plain or deflated")),
        };
        if data.len() != length || crc32fast::hash(data) as usize != sum {
            return Err(MatrixError::new(name, "bytes that do not fit their checksum", "a file that is whole"));
        }
        arrays.push((name.to_owned(), array(data, name)?));
    }
    Ok(arrays)
}

/// One array: real, of two dimensions.
pub(super) fn array(bytes: &[u8], name: &str) -> Result<DMatrix<f64>, MatrixError> {
    let broken = || MatrixError::new(name, "bytes that are no array", "an array that NumPy has written");
    let version = bytes.strip_prefix(b"\x93NUMPY").and_then(|rest| rest.first()).ok_or_else(broken)?;
    let (length, start) = if *version == 1 { (little(bytes, 8, 2), 10) } else { (little(bytes, 8, 4), 12) };
    let end = start + length.ok_or_else(broken)?;
    let header = bytes.get(start..end).and_then(|header| std::str::from_utf8(header).ok()).ok_or_else(broken)?;
    // A dictionary of Python: {'descr': '<f8', 'fortran_order': False, 'shape': (3, 3), }
    let after =
        |key: &str| header.split_once(key).map(|(_, rest)| rest.trim_start_matches([':', ' '])).ok_or_else(broken);
    let kind = after("'descr'")?.trim_start_matches('\'').split('\'').next().unwrap_or_default();
    let by_columns = after("'fortran_order'")?.starts_with("True");
    let shape = after("'shape'")?.trim_start_matches('(').split(')').next().unwrap_or_default();
    let sizes: Vec<usize> = shape.split(',').map_while(|size| size.trim().parse().ok()).collect();
    let [rows, columns] = sizes[..] else {
        return Err(MatrixError::new(name, format!("an array of shape ({shape})"), "a matrix, of two dimensions"));
    };
    check_size(name, rows, columns)?;
    let width = match kind {
        "<f8" | "<i8" => 8,
        "<f4" | "<i4" => 4,
        _ => {
            return Err(MatrixError::new(name, format!("numbers of kind '{kind}'"), "real ones: <f8, <f4, <i8 or <i4"));
        }
    };
    let data = bytes.get(end..).filter(|data| data.len() == rows * columns * width).ok_or_else(broken)?;
    let numbers = data.chunks_exact(width).map(|bytes| match (kind, bytes) {
        ("<f8", &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
        ("<i8", &[a, b, c, d, e, f, g, h]) => i64::from_le_bytes([a, b, c, d, e, f, g, h]) as f64,
        ("<f4", &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        ("<i4", &[a, b, c, d]) => f64::from(i32::from_le_bytes([a, b, c, d])),
        _ => f64::NAN,
    });
    Ok(if by_columns {
        DMatrix::from_iterator(rows, columns, numbers)
    } else {
        DMatrix::from_row_iterator(rows, columns, numbers)
    })
}
