//! Numbers as people read them, and as files keep them.

/// `value` with so many significant digits, as the nearest number that has no more of them: what conversion between units, a
/// search or a product of round factors leaves behind its digits is not part of a number. What is not finite stays as it is.
///
/// ```
/// assert_eq!(text::number::significant(0.1 + 0.2, 7), 0.3);
/// assert_eq!(text::number::significant(12_345.0, 3), 12_300.0);
/// ```
#[must_use]
pub fn significant(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// `value` in so many significant digits, its last zeros among them: for columns. Plain where that reads well, from 1e-4 to
/// 1e7, and with an exponent beyond; the digits of a whole number are never cut.
///
/// ```
/// use text::number::in_digits;
/// assert_eq!([0.5, 123_456.7, 2.5e-7].map(|value| in_digits(value, 6)), ["0.500000", "123457", "2.50000e-7"]);
/// ```
#[must_use]
pub fn in_digits(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    let size = value.abs();
    if size != 0.0 && !(1e-4..1e7).contains(&size) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    // Digits before the point, or less the zeros behind it: what lengths in metres need to keep theirs.
    let leading = if size == 0.0 { 0 } else { size.log10().floor() as i32 + 1 };
    format!("{value:.*}", usize::try_from(digits as i32 - leading).unwrap_or(0))
}

/// `value` in so many significant digits without the zeros at its end, never with an exponent: for sentences. The digits of a
/// whole number are never cut, and no more than twelve follow the point.
///
/// ```
/// use text::number::trimmed;
/// assert_eq!([-0.030_561, 0.0, 12_345.6, 1e-20].map(|value| trimmed(value, 4)), ["-0.03056", "0", "12346", "0"]);
/// ```
#[must_use]
pub fn trimmed(value: f64, digits: usize) -> String {
    let magnitude = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    let decimals = (digits as f64 - 1.0 - magnitude).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The least round number that is not below `value`: scales that move rarely and read well.
#[must_use]
pub fn nice_ceiling(value: f64) -> f64 {
    if !(value.is_finite() && value > 1e-12) {
        return 1.0;
    }
    let decade = 10_f64.powf(value.log10().floor());
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
        .into_iter()
        .map(|digit| digit * decade)
        .find(|nice| *nice >= value * (1.0 - 1e-12))
        .unwrap_or(10.0 * decade)
}

/// A round number as short as it can be told, for scales: 4, 0.06, 1.5.
#[must_use]
pub fn neat(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e5).contains(&rounded.abs()) { format!("{}", rounded + 0.0) } else { short(value, 3) }
}

/// A number in about `digits` characters, for labels.
#[must_use]
pub fn short(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "-".into();
    }
    let size = value.abs();
    if size >= 1e5 || (size != 0.0 && size < 1e-3) {
        return format!("{value:.1e}");
    }
    let whole = if size >= 1.0 { size.log10().floor() as usize + 1 } else { 1 };
    format!("{value:.*}", digits.saturating_sub(whole))
}

/// `value` as a TOML float that reads back to the last bit: `2.0`, `inf`, `nan`.
#[must_use]
pub fn toml(value: f64) -> String {
    if value.is_nan() { "nan".to_owned() } else { format!("{value:?}") }
}

/// `no masses`, `1 mass`, `3 masses`.
///
/// ```
/// assert_eq!([0, 1, 3].map(|n| text::number::counted(n, "mass", "masses")), ["no masses", "1 mass", "3 masses"]);
/// ```
#[must_use]
pub fn counted(count: usize, one: &str, many: &str) -> String {
    match count {
        0 => format!("no {many}"),
        1 => format!("1 {one}"),
        _ => format!("{count} {many}"),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn columns_keep_their_digits() {
        for (number, text) in [
            (0.0, "0.000000"),
            (0.496_714_3, "0.496714"),
            (-12.345_678, "-12.3457"),
            (123_456.7, "123457"),
            (1_234_567.8, "1234568"),
            (0.000_265_123_4, "0.000265123"),
            (2.5e-7, "2.50000e-7"),
            (3e9, "3.00000e9"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(in_digits(number, 6), text);
        }
    }

    #[test]
    fn scales_are_round_numbers() {
        for (value, nice) in [
            (0.0, 1.0),
            (f64::NAN, 1.0),
            (1.0, 1.0),
            (1.01, 1.5),
            (2.1, 3.0),
            (8.1, 10.0),
            (0.031, 0.04),
            (999.0, 1000.0),
        ] {
            assert!((nice_ceiling(value) - nice).abs() < 1e-9 * nice, "{value}");
        }
        for (value, text) in
            [(4.0, "4"), (0.06, "0.06"), (-1.5, "-1.5"), (0.1 + 0.2, "0.3"), (150.0, "150"), (0.0, "0")]
        {
            assert_eq!(neat(value), text);
        }
        assert_eq!((neat(2e6), neat(f64::NAN)), ("2.0e6".into(), "-".into()));
        for (value, text) in
            [(0.0, "0.000"), (12.345, "12.35"), (-0.5, "-0.500"), (1234.5, "1234"), (2e6, "2.0e6"), (f64::NAN, "-")]
        {
            assert_eq!(short(value, 4), text);
        }
    }

    proptest! {
        /// Rounding is off by half a digit at most, and rounding again changes nothing.
        #[test]
        fn significant_digits_are_kept(value in prop::num::f64::NORMAL, digits in 1_usize..16) {
            let rounded = significant(value, digits);
            prop_assert_eq!(significant(rounded, digits), rounded);
            if rounded.is_finite() {
                let half = 0.5 * 10_f64.powi(1 - digits as i32);
                prop_assert!(((rounded - value) / value).abs() <= half * (1.0 + 1e-9) + f64::EPSILON, "{value:?} {rounded:?}");
            }
        }

        /// What is written to a file is the number that is read.
        #[test]
        fn files_keep_the_last_bit(value in prop::num::f64::ANY) {
            let read: f64 = toml(value).parse().unwrap();
            prop_assert!(read.to_bits() == value.to_bits() || (read.is_nan() && value.is_nan()));
        }
    }
}
