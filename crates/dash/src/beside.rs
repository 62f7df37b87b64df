//! What gains that were found do beside those in force, in a few rows: what a person looks at before saying yes.

use std::sync::Arc;

use rotor::{GainKind, Rotor, Settings, circular};

use crate::analysis::over_speed::{OverSpeed, Question};
use crate::units::{Units, rounded};
use crate::view::Offer;

/// What one set of gains does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Deeds {
    settings: Settings,
    /// The smallest damping ratio over the speeds that were searched.
    pub(crate) min_damping: f64,
    /// Every range of speeds, from rest to beyond those, in which all modes decay.
    pub(crate) stable: Vec<[f64; 2]>,
    /// The largest steady force at the present speed; none where no steady motion is stable.
    force: Option<f64>,
}

impl Deeds {
    /// What `settings` do to `rotor` over the speeds `from..=to` and a quarter beyond.
    pub(crate) fn of(rotor: &Arc<Rotor>, settings: &Settings, [from, to]: [f64; 2]) -> Self {
        let top = settings.speed.max(to);
        let over = OverSpeed::of(&Question::at(rotor.clone(), settings.feedback.clone(), top));
        let within = over.speeds.iter().zip(&over.min_damping).filter(|(speed, _)| (from..=to).contains(speed));
        let ends = [from, to].map(|speed| over.at(speed));
        let min_damping = within.map(|(_, damping)| *damping).chain(ends).fold(f64::INFINITY, f64::min);
        let orbits = circular::synchronous(rotor, &settings.feedback, &settings.deadband, &[settings.speed]).ok();
        let stable = orbits.iter().flat_map(|found| found.orbits.iter().flatten()).filter(|orbit| orbit.is_stable());
        let force = stable.map(|orbit| orbit.force).reduce(f64::max);
        Self { settings: settings.clone(), min_damping, stable: over.stable, force }
    }

    /// The highest speed up to which it is stable from rest on; 0 if not even there.
    fn holds_to(&self) -> f64 {
        self.stable.first().filter(|range| range[0] == 0.0).map_or(0.0, |range| range[1])
    }

    /// Whether `other` holds less far from rest than this.
    pub(crate) fn holds_farther_than(&self, other: &Self) -> bool {
        self.holds_to() > other.holds_to()
    }
}

/// The rows: each quantity under the gains in force and under those found, in the units of the rotor.
pub(crate) fn rows(now: &Deeds, found: &Deeds, units: &Units) -> Vec<Offer> {
    let row = |word: &str, [now, found]: [String; 2]| Offer {
        word: word.to_owned(),
        detail: if now == found { format!("{now} in both") } else { format!("{now} in force, {found} found") },
    };
    let both = [now, found];
    let ranges = |deeds: &Deeds| match &deeds.stable[..] {
        [] => "nowhere".to_owned(),
        ranges => {
            let told = ranges.iter().map(|[from, to]| match units.scales {
                Some(_) => format!("{} to {} rpm", units.speed(*from), units.speed(*to)),
                None => format!("R {} to {}", units.speed(*from), units.speed(*to)),
            });
            told.collect::<Vec<_>>().join(" and ")
        }
    };
    let force = |deeds: &Deeds| deeds.force.map_or_else(|| "none steady".to_owned(), |u| units.force.told(u, 5));
    let mut rows = vec![
        row("min damping", both.map(|deeds| format!("{:.4}", deeds.min_damping))),
        row("stable", both.map(ranges)),
        row("force", both.map(force)),
    ];
    let signals = now.settings.feedback.signals.iter().zip(&found.settings.feedback.signals).enumerate();
    for (i, (before, after)) in signals {
        for kind in GainKind::ALL {
            let name = if now.settings.feedback.signals.len() > 1 {
                format!("{}.{}", kind.name(), i + 1)
            } else {
                kind.name().to_owned()
            };
            let at = |signal: &rotor::Signal| rounded(signal.gain(kind).at(now.settings.speed), 4).to_string();
            rows.push(row(&name, [at(before), at(after)]));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    fn deeds(feedback: &str) -> Deeds {
        let rotor = Arc::new(builtin::rotor("three-mass").unwrap());
        let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).unwrap());
        settings.deadband.fill(0.0);
        Deeds::of(&rotor, &settings, [0.0, 2.8])
    }

    #[test]
    fn what_is_found_stands_beside_what_is_in_force() {
        let (now, found) = (deeds("composite"), deeds("off"));
        let rows = rows(&now, &found, &Units::DIMENSIONLESS);
        let words: Vec<&str> = rows.iter().map(|row| row.word.as_str()).collect();
        assert_eq!(words, ["min damping", "stable", "force", "kd", "cd", "kc", "cc"]);
        // The composite gains hold to 7.07, none to 1.7755; without control nothing pushes.
        assert!(rows[1].detail.contains("R 0 to 7.07") && rows[1].detail.contains("R 0 to 1.77"), "{rows:?}");
        assert!(now.holds_farther_than(&found) && !found.holds_farther_than(&now));
        assert_eq!(rows[3].detail, "-0.5879 in force, 0 found");
        assert!(now.force.is_some() && found.min_damping < 0.0, "{rows:?}");
    }

    #[test]
    fn an_si_rotor_is_told_in_rpm_and_newtons() {
        let (now, found) = (deeds("composite"), deeds("off"));
        let units = Units::of(Some(crate::units::tests::SI), Some(1.0));
        let rows = rows(&now, &found, &units);
        assert!(rows[1].detail.contains(" rpm in force") && rows[2].detail.contains("N in force"), "{rows:?}");
    }
}
