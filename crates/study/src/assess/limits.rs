//! What is asked: one table, whose values can be changed, and where each comes from.

use machine::ISO_14839_3 as ZONES;
use text::{Domain, Faults, Reader};

/// One limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Its key in a file of limits.
    pub key: &'static str,
    /// Its value unless another is given.
    pub value: f64,
    /// What it is.
    pub what: &'static str,
    /// Where it comes from.
    pub source: &'static str,
}

const API_617: &str = "API 617, 9th ed., 6.8, as commonly quoted";
const API_684: &str = "API 684, SP6.8.2, as commonly quoted";
const ISO_14839_2: &str = "ISO 14839-2, as commonly quoted";
const ISO_14839_3: &str = "ISO 14839-3, as commonly quoted";

macro_rules! limits {
    ($($key:ident = $value:expr, $what:literal, $source:expr;)*) => {
        /// Every limit, in the order of the page.
        pub const LIMITS: &[Limit] =
            &[$(Limit { key: stringify!($key), value: $value, what: $what, source: $source }),*];

        /// What is asked of a machine.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Limits {
            $(#[doc = $what] pub $key: f64,)*
        }

        impl Default for Limits {
            fn default() -> Self {
                Self { $($key: $value,)* }
            }
        }

        impl Limits {
            /// Those that a file changes, the others as they are.
            ///
            /// # Errors
            /// All that is wrong with it: unknown keys, values that are not finite numbers above 0.
            pub fn read(text: &str) -> Result<Self, Faults> {
                let (mut reader, table) = Reader::parse(text)?;
                reader.only(&table, &[$(stringify!($key)),*]);
                let mut limits = Self::default();
                $(if let Some(value) = reader.number(&table, stringify!($key), Domain::Positive) {
                    limits.$key = value;
                })*
                reader.check()?;
                if let (false, Some(value)) = ([1.0, 2.0, 3.0].contains(&limits.zone), table.get("zone")) {
                    reader.wrong("zone", value, "1, 2 or 3");
                }
                for (zones, [first, last]) in [
                    (limits.orbit_zones(), ["orbit_zone_a", "orbit_zone_c"]),
                    (limits.sensitivity_zones(), ["sensitivity_zone_a", "sensitivity_zone_c"]),
                ] {
                    if !zones.is_sorted() {
                        reader.fault(0..0, format!("{first} to {last} = {zones:?}"), "ends of zones that rise");
                    }
                }
                reader.finish(limits)
            }

            /// The value of a limit by its key.
            #[must_use]
            pub fn get(&self, key: &str) -> Option<f64> {
                match key {
                    $(stringify!($key) => Some(self.$key),)*
                    _ => None,
                }
            }
        }
    };
}

limits! {
    log_decrement = 0.1, "smallest logarithmic decrement of any mode", API_617;
    cross_coupling_ratio = 2.0, "smallest ratio of the cross-coupled stiffness that is borne to the one that is expected", API_617;
    amplification = 2.5, "amplification factor from which a peak asks for a separation margin", API_684;
    separation_below = 16.0, "largest separation margin asked for below the operating range, in percent", API_684;
    separation_above = 26.0, "largest separation margin asked for above the operating range, in percent", API_684;
    residual_unbalance = 6350.0, "U_r N / W, in g mm rpm / kg", API_617;
    vibration = 25.4, "largest vibration at a sensor below 12 000 rpm, in um peak to peak; above, times sqrt(12 000 / N)", API_617;
    scale_factor = 6.0, "largest factor by which the response to unbalance is scaled up to the vibration allowed", API_617;
    clearance_share = 75.0, "largest scaled major axis, in percent of the smallest diametral clearance", API_617;
    orbit_zone_a = 0.3, "orbit in parts of the smallest clearance up to which it is in zone A", ISO_14839_2;
    orbit_zone_b = 0.4, "the same of zone B", ISO_14839_2;
    orbit_zone_c = 0.5, "the same of zone C", ISO_14839_2;
    sensitivity_zone_a = ZONES[0], "peak of the sensitivity up to which it is in zone A", ISO_14839_3;
    sensitivity_zone_b = ZONES[1], "the same of zone B", ISO_14839_3;
    sensitivity_zone_c = ZONES[2], "the same of zone C", ISO_14839_3;
    zone = 1.0, "the last zone that is passed: 1 is A, that of new machines, 2 is B, 3 is C", "ISO 14839, of machines newly commissioned";
    force_share = 1.0, "largest dynamic force in parts of what the bearing can hold", "the limit of the loop, or as given";
}

impl Limits {
    /// All of them as a file to start from, each with what it is and where it comes from.
    #[must_use]
    pub fn file(&self) -> String {
        let line = |limit: &Limit| {
            let value = self.get(limit.key).unwrap_or(limit.value);
            format!("# {}\n# ({})\n{} = {}\n", limit.what, limit.source, limit.key, text::number::toml(value))
        };
        LIMITS.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    /// Where a limit comes from: the origin of the table's value, or that somebody changed it.
    #[must_use]
    pub fn source(&self, key: &str) -> String {
        let Some(limit) = LIMITS.iter().find(|limit| limit.key == key) else { return String::new() };
        if self.get(key) == Some(limit.value) { limit.source.to_owned() } else { format!("changed ({})", limit.source) }
    }

    /// The zone of a value between three limits, and the largest value that is passed.
    pub(super) fn zone_of(&self, value: f64, ends: [f64; 3]) -> (char, f64) {
        let zone = ends.iter().zip('A'..).find(|(end, _)| value <= **end).map_or('D', |(_, zone)| zone);
        let last = (self.zone.round() as usize).clamp(1, 3) - 1;
        (zone, ends[last])
    }

    /// Ends of the zones of an orbit, in parts of the clearance.
    #[must_use]
    pub fn orbit_zones(&self) -> [f64; 3] {
        [self.orbit_zone_a, self.orbit_zone_b, self.orbit_zone_c]
    }

    /// Ends of the zones of the sensitivity.
    #[must_use]
    pub fn sensitivity_zones(&self) -> [f64; 3] {
        [self.sensitivity_zone_a, self.sensitivity_zone_b, self.sensitivity_zone_c]
    }

    /// The separation margin in percent that a peak of this amplification factor asks for, below and above the operating range:
    /// `min(16, 17 (1 - 1 / (AF - 1.5)))` and `min(26, 10 + 17 (1 - 1 / (AF - 1.5)))`; `None` where it asks for none.
    #[must_use]
    pub fn separation(&self, amplification: f64) -> Option<[f64; 2]> {
        (amplification > self.amplification).then(|| {
            let grows = 17.0 * (1.0 - 1.0 / (amplification - 1.5));
            [self.separation_below.min(grows), self.separation_above.min(10.0 + grows)].map(|margin| margin.max(0.0))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_the_separation_margin_is_that_of_the_formula() {
        let limits = Limits::default();
        assert_eq!(limits.separation(2.5), None);
        // AF = 3.5: 17 (1 - 1/2) = 8.5 below, 18.5 above; AF = 100: the caps.
        assert_eq!(limits.separation(3.5), Some([8.5, 18.5]));
        assert_eq!(limits.separation(100.0), Some([16.0, 26.0]));
        assert_eq!(Limits { amplification: 1.0, ..limits }.separation(1.6), Some([0.0, 0.0]));
    }

    #[test]
    fn a_file_changes_some_and_says_what_is_wrong_with_it() {
        let limits = Limits::read("log_decrement = 0.2").unwrap();
        assert_eq!((limits.log_decrement, limits.get("log_decrement")), (0.2, Some(0.2)));
        assert_eq!(limits.source("log_decrement"), format!("changed ({API_617})"));
        assert_eq!(limits.source("vibration"), API_617);
        assert_eq!(Limits::read(&limits.file()), Ok(limits));
        let faults = Limits::read("log_dec = 0.2\nvibration = 0").unwrap_err().in_file("limits.toml");
        assert!(faults.contains("limits.toml:1:1: unknown key 'log_dec'"), "{faults}");
        assert!(
            faults.contains("limits.toml:2:13: vibration = 0: expected a finite number greater than 0"),
            "{faults}"
        );
        let faults = Limits::read("zone = 1.5\nsensitivity_zone_a = 4.5").unwrap_err().in_file("limits.toml");
        assert!(faults.contains("limits.toml:1:8: zone = 1.5: expected 1, 2 or 3"), "{faults}");
        assert!(faults.contains("[4.5, 4.0, 5.0]: expected ends of zones that rise"), "{faults}");
        assert!(LIMITS.iter().all(|limit| Limits::default().get(limit.key) == Some(limit.value)));
    }

    #[test]
    fn zones_end_where_the_table_says() {
        let mut limits = Limits::default();
        let zones = limits.sensitivity_zones();
        assert_eq!([2.0, 3.0, 3.5, 4.5, 6.0].map(|peak| limits.zone_of(peak, zones).0), ['A', 'A', 'B', 'C', 'D']);
        assert_eq!(limits.zone_of(1.0, zones).1, 3.0);
        limits.zone = 2.0;
        assert_eq!(limits.zone_of(1.0, zones).1, 4.0);
    }
}
