//! Where the marks of an axis are, and what stands at them.

use super::Axis;

/// Marks of an axis, with their words: about `wanted` of them at 1, 2 or 5 times a power of ten, or the decades.
pub(super) fn ticks(axis: &Axis, wanted: f64) -> Vec<(f64, String)> {
    if axis.log {
        return decades(axis);
    }
    let rough = (axis.to - axis.from) / wanted;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough * 0.999).unwrap_or(rough);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let (first, last) = ((axis.from / step - 1e-9).ceil() as i64, (axis.to / step + 1e-9).floor() as i64);
    (first..=last)
        .map(|i| {
            let value = i as f64 * step;
            (value, number(&format!("{value:.decimals$}")))
        })
        .collect()
}

fn decades(axis: &Axis) -> Vec<(f64, String)> {
    let (first, last) = ((axis.from.log10() - 1e-9).ceil() as i32, (axis.to.log10() + 1e-9).floor() as i32);
    let every = ((last - first) / 8 + 1).max(1);
    (first..=last).filter(|i| i % every == 0).map(|i| (10_f64.powi(i), format!("10{}", superscript(i)))).collect()
}

fn superscript(exponent: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => char::from_u32(0x2070 + c.to_digit(10).unwrap_or(0)).unwrap_or(c),
    };
    exponent.to_string().chars().map(digit).collect()
}

/// A number with a minus sign in place of a hyphen.
pub(super) fn number(text: &str) -> String {
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_and_inside() {
        let words = |from, to, log| -> Vec<String> {
            let axis = Axis { label: String::new(), from, to, log };
            ticks(&axis, 6.0).into_iter().map(|(_, w)| w).collect()
        };
        assert_eq!(words(0.0, 5.0, false), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(words(-1.0, 0.2, false), ["−1.0", "−0.8", "−0.6", "−0.4", "−0.2", "0.0", "0.2"]);
        assert_eq!(words(1e-2, 1e3, true), ["10⁻²", "10⁻¹", "10⁰", "10¹", "10²", "10³"]);
        assert_eq!(words(0.03, 0.05, false), ["0.030", "0.035", "0.040", "0.045", "0.050"]);
    }
}
