//! Zones of the peak of the sensitivity, as ISO 14839-3 has them for machines with magnetic bearings.

/// Peaks of sensitivity at which zones A, B and C end, by ISO 14839-3: 9.5, 12 and 14 dB. New machines are to be in A, those in A and B may
/// run without bound, those in C only until they can be mended, those in D not at all.
pub const ISO_14839_3: [f64; 3] = [3.0, 4.0, 5.0];

/// The zone of a peak of the sensitivity, where A, B and C end at `ends`, which rise and are in them.
#[must_use]
pub fn sensitivity_zone(peak: f64, ends: [f64; 3]) -> &'static str {
    let passed = ends.iter().filter(|end| peak > **end).count();
    ["A", "B", "C", "D"][passed]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_zones_are_those_of_the_standard() {
        let zones = [1.0, 3.0, 3.01, 4.0, 4.01, 5.0, 5.01, 80.0].map(|peak| sensitivity_zone(peak, ISO_14839_3));
        assert_eq!(zones, ["A", "A", "B", "B", "C", "C", "D", "D"]);
        // In decibels, as the standard writes them.
        for (end, decibels) in ISO_14839_3.into_iter().zip([9.5, 12.0, 14.0]) {
            assert!((20.0 * f64::log10(end) - decibels).abs() < 0.05, "{end}");
        }
    }
}
