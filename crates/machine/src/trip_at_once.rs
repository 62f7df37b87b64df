//! The other question that stands before a change of a running machine: would it trip at once, because its orbit is past the limit already?

use std::fmt;

use rotor::Settings;

/// A machine that moves would trip with its next steps: the limit would come to lie below its orbit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TripAtOnce {
    /// The largest orbit of late, in `e_t`.
    pub orbit: f64,
    /// The limit that it would have, in `e_t`.
    pub limit: f64,
}

impl TripAtOnce {
    /// What a change from `now` to `then` makes of a machine whose largest orbit of late, of any place, is `orbit`: nothing where the limit
    /// does not come down, or stays above it.
    #[must_use]
    pub fn between(now: &Settings, then: &Settings, orbit: f64) -> Option<Self> {
        (Self::is_possible(now, then) && orbit > then.trip).then_some(Self { orbit, limit: then.trip })
    }

    /// Whether a change lets the limit come down at all: the orbit need not be looked for where it does not.
    #[must_use]
    pub fn is_possible(now: &Settings, then: &Settings) -> bool {
        then.trip < now.trip
    }

    /// In words, with lengths as `length` tells them.
    pub fn words(&self, length: impl Fn(f64) -> String) -> String {
        format!("trips at once: its orbit is {}, past a limit of {}", length(self.orbit), length(self.limit))
    }
}

impl fmt::Display for TripAtOnce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words(|length| format!("{length:.4} e_t")))
    }
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    #[test]
    fn a_limit_trips_at_once_where_it_comes_down_below_the_orbit() {
        let rotor = builtin::rotor("three-mass").expect("there is");
        let now = Settings { trip: 100.0, ..Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "off").expect("is")) };
        let of = |trip, orbit| TripAtOnce::between(&now, &Settings { trip, ..now.clone() }, orbit);
        let found = of(5.0, 12.5).expect("asked");
        assert_eq!((found.orbit, found.limit), (12.5, 5.0));
        assert_eq!(found.to_string(), "trips at once: its orbit is 12.5000 e_t, past a limit of 5.0000 e_t");
        // Above the orbit; no lower than it was, whatever the orbit (it is on its way to a trip then, but not by this).
        assert_eq!(of(13.0, 12.5), None);
        assert_eq!(of(100.0, 120.0), None);
        assert_eq!(of(110.0, 120.0), None);
    }
}
