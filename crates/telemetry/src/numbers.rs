//! Numbers for people: round ones for the ends of scales, and as few digits as there is room for.

/// The least round number that is not below `value`: scales that move rarely and read well.
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
pub fn neat(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e5).contains(&rounded.abs()) { format!("{}", rounded + 0.0) } else { short(value, 3) }
}

/// A number in about `digits` characters, for labels.
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
