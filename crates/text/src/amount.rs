//! Durations and sizes as typed: `10min`, `30s`, `500MB`.

/// Why a text is no duration, or no size.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AmountError {
    /// Not a positive number of a known unit.
    #[error("'{0}': expected a duration such as 30s, 10min or 1h")]
    Duration(String),
    /// Not a positive number of a known unit.
    #[error("'{0}': expected a size such as 500MB or 2GB")]
    Size(String),
    /// Less than a byte, or more than can be counted.
    #[error("'{0}': expected a size from 1 B to 9e9 GB")]
    OutOfRange(String),
}

/// Seconds of a duration as typed: a number and `ms`, `s`, `min` or `h`; without a unit, seconds.
///
/// # Errors
/// Not a positive number, or another unit.
pub fn seconds(typed: &str) -> Result<f64, AmountError> {
    amount(typed, &[("ms", 1e-3), ("s", 1.0), ("min", 60.0), ("h", 3600.0), ("", 1.0)])
        .ok_or_else(|| AmountError::Duration(typed.to_owned()))
}

/// Bytes of a size as typed: a number and `B`, `kB`, `MB` or `GB`.
///
/// # Errors
/// Not a positive number, another unit, or a size that no file has.
pub fn bytes(typed: &str) -> Result<u64, AmountError> {
    let bytes = amount(typed, &[("B", 1.0), ("kB", 1e3), ("MB", 1e6), ("GB", 1e9)])
        .ok_or_else(|| AmountError::Size(typed.to_owned()))?;
    if (1.0..=9e18).contains(&bytes) { Ok(bytes as u64) } else { Err(AmountError::OutOfRange(typed.to_owned())) }
}

fn amount(typed: &str, units: &[(&str, f64)]) -> Option<f64> {
    let typed = typed.trim();
    let split = typed.find(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E')).unwrap_or(typed.len());
    let (number, unit) = typed.split_at(split);
    let (_, factor) = units.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit.trim()))?;
    let number: f64 = number.trim().parse().ok()?;
    let value = number * factor;
    (value.is_finite() && value > 0.0).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_read_as_typed() {
        assert_eq!(seconds("10min"), Ok(600.0));
        assert_eq!(seconds("1.5 h"), Ok(5400.0));
        assert_eq!(seconds("250ms"), Ok(0.25));
        assert_eq!(seconds("30"), Ok(30.0));
        assert_eq!(bytes("1e3kB"), Ok(1_000_000));
        assert_eq!(bytes("2gb"), Ok(2_000_000_000));
        for bad in ["", "min", "-3s", "0", "nan", "inf", "3 weeks", "1e999"] {
            assert!(seconds(bad).unwrap_err().to_string().contains("expected a duration"), "{bad}");
        }
        for bad in ["5", "5s", "-1MB", "0B"] {
            assert!(bytes(bad).unwrap_err().to_string().contains("expected a size such as"), "{bad}");
        }
    }

    #[test]
    fn sizes_out_of_range_are_refused_and_not_made_to_fit() {
        for bad in ["0.5B", "0.0000001kB", "1e30GB"] {
            assert_eq!(bytes(bad), Err(AmountError::OutOfRange(bad.into())));
        }
        assert_eq!((bytes("1B"), bytes("9e9GB")), (Ok(1), Ok(9_000_000_000_000_000_000)));
    }
}
