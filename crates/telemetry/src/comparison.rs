//! What gains that were found do beside those in force, in a few rows: what a person looks at before saying yes.

use std::sync::Arc;

use rotor::{GainKind, Rotor, Settings, circular};
use text::number::{short, significant};
use tuner::{Family, Options, Problem, Schedule, Stop, Structure};

use crate::jobs::loop_analysis::{ISO_14839_3, LoopAnalysis, LoopRequest, sensitivity_zone};
use crate::jobs::pole_trace::{PoleTrace, PoleTraceRequest};
use crate::units::ScreenUnits;

/// What one set of gains does.
#[derive(Clone, Debug, PartialEq)]
pub struct GainEffects {
    settings: Settings,
    /// The smallest damping ratio over the speeds that were searched, of the modes that count, as everywhere on the console.
    pub min_damping: f64,
    /// Every range of speeds, from rest to beyond those, in which all modes decay.
    pub stable: Vec<[f64; 2]>,
    /// How far up they were looked for.
    top: f64,
    /// The smallest damping ratio over those speeds with any share of its stiffness left to each support bearing; none where no
    /// bearing has a clearance, or there are too many to look at.
    pub any_deadband: Option<f64>,
    /// The largest steady force at the present speed; none where no steady motion is stable.
    force: Option<f64>,
    /// The largest orbit of a self-excited whirl at the present speed that the rotor would stay on; none if there is none.
    whirl: Option<f64>,
    /// The peak of the loop's sensitivity at the present speed, and the delay more that it bears there, if any is too long; none where
    /// it is not stable.
    margins: Option<(f64, Option<f64>)>,
}

impl GainEffects {
    /// What `settings` do to `rotor` over the speeds `from..=to` and a quarter beyond.
    pub fn of(rotor: &Arc<Rotor>, settings: &Settings, [from, to]: [f64; 2], stop: Stop) -> Self {
        let top = settings.speed.max(to);
        let over = PoleTrace::of(&PoleTraceRequest::at(rotor.clone(), settings.feedback.clone(), top));
        let within = over.speeds.iter().zip(&over.min_damping).filter(|(speed, _)| (from..=to).contains(speed));
        let ends = [from, to].map(|speed| over.min_damping_at(speed));
        let min_damping = within.map(|(_, damping)| *damping).chain(ends).fold(f64::INFINITY, f64::min);
        let Settings { feedback, deadband, speed, .. } = settings;
        let stable = |found: Result<circular::Circular, _>| {
            let orbits = found.ok().into_iter().flat_map(|found| found.orbits.into_iter().flatten());
            orbits.filter(circular::Orbit::is_stable).collect::<Vec<_>>()
        };
        let steady = stable(circular::synchronous(&settings.unbalanced(rotor), feedback, deadband, &[*speed]));
        let cycles = if has_deadband(settings) {
            stable(circular::cycles(rotor, feedback, deadband, &[*speed]))
        } else {
            vec![]
        };
        let opened = LoopAnalysis::of(&LoopRequest { rotor: rotor.clone(), feedback: feedback.clone(), speed: *speed });
        Self {
            settings: settings.clone(),
            min_damping,
            top: over.top(),
            stable: over.stable,
            any_deadband: worst_deadband(rotor, settings, [from, to], stop).map(|worst| worst.min(min_damping)),
            force: steady.iter().map(|orbit| orbit.force).reduce(f64::max),
            margins: opened.peak().map(|(peak, _)| (peak, opened.delay())),
            whirl: cycles.iter().map(circular::Orbit::largest_radius).reduce(f64::max),
        }
    }

    /// Takes what a search says of the worst damping that it found, of any deadband or of full stiffness: so that all that is told of these
    /// gains has one number for it. The search gives modes past those that count a weight of their own, and looks where samples do not.
    pub(crate) fn settle(&mut self, worst: f64, any_deadband: bool) -> f64 {
        let place = match &mut self.any_deadband {
            Some(worst) if any_deadband => worst,
            _ => &mut self.min_damping,
        };
        *place = place.min(worst);
        *place
    }

    /// The highest speed up to which it is stable from rest on; 0 if not even there.
    fn holds_to(&self) -> f64 {
        self.stable.first().filter(|range| range[0] == 0.0).map_or(0.0, |range| range[1])
    }

    /// In what `found` is worse than this: some words each.
    pub fn drawbacks_of(&self, found: &Self) -> Vec<&'static str> {
        let less =
            |now: Option<f64>, found: Option<f64>| matches!((now, found), (Some(now), Some(found)) if found < now);
        // A force, or a whirl, that there was none of is the worst of them.
        let more = |now: Option<f64>, found: Option<f64>| found.is_some_and(|found| found > now.unwrap_or(0.0) * 1.001);
        let lost = self.force.is_some() && found.force.is_none();
        let all = [
            (self.holds_to() > found.holds_to(), "stable LESS FAR from rest"),
            (less(self.any_deadband, found.any_deadband), "LESS damped in the worst deadband state"),
            (more(self.whirl, found.whirl), "a LARGER self-excited whirl"),
            (lost, "NO steady motion at the present speed"),
            (self.force.is_some() && more(self.force, found.force), "MORE force"),
            (worse_zone(self.margins, found.margins), "a WORSE zone of sensitivity"),
            (halves_delay(self.margins, found.margins), "LESS THAN HALF the delay margin"),
        ];
        all.into_iter().filter_map(|(worse, words)| worse.then_some(words)).collect()
    }
}

/// Whether the peak of the sensitivity lies in a worse zone of ISO 14839-3; within a zone more of it is no drawback.
fn worse_zone(now: Option<(f64, Option<f64>)>, found: Option<(f64, Option<f64>)>) -> bool {
    let zone = |(peak, _): (f64, Option<f64>)| sensitivity_zone(peak, ISO_14839_3);
    matches!((now.map(zone), found.map(zone)), (Some(now), Some(found)) if found > now)
}

/// Whether less than half the delay can be borne that was; a little less is no drawback.
fn halves_delay(now: Option<(f64, Option<f64>)>, found: Option<(f64, Option<f64>)>) -> bool {
    let (Some((_, now)), Some((_, Some(found)))) = (now, found) else { return false };
    now.is_none_or(|now| found < 0.5 * now)
}

/// Whether any support bearing has a clearance.
pub fn has_deadband(settings: &Settings) -> bool {
    settings.deadband.iter().any(|deadband| *deadband > 0.0)
}

/// The worst damping over `from..=to` whatever stiffness its clearance leaves each support bearing.
pub(crate) fn worst_deadband(rotor: &Rotor, settings: &Settings, [from, to]: [f64; 2], stop: Stop) -> Option<f64> {
    if !has_deadband(settings) {
        return None;
    }
    let mut family = Family::new(rotor, from, to).ok()?;
    family.any_deadband(true).ok()?;
    let structure = Structure::new(rotor, &settings.feedback, Schedule::Fixed).ok()?;
    let gains = structure.variables_of(&settings.feedback);
    let problem = Problem::new(family, structure, gains.iter().fold(1.0, |most, gain| gain.abs().max(most)));
    let options = Options { prove: false, ..Options::for_problem(&problem) };
    tuner::evaluate(&problem, &options, &gains, stop).ok().map(|found| found.worst.value)
}

/// Ranges of speeds in words, of which the last may end where nobody looked any further, at `top`: `0 to 7.074`, `0 to 15942 rpm at
/// least`.
#[must_use]
pub fn ranges_told(ranges: &[[f64; 2]], top: f64, units: &ScreenUnits, between: &str) -> String {
    let unit = if units.scales.is_some() { " rpm" } else { "" };
    let told = ranges.iter().map(|[from, to]| {
        let further = if *to >= top { " at least" } else { "" };
        format!("{} to {}{unit}{further}", units.speed(*from), units.speed(*to))
    });
    told.collect::<Vec<_>>().join(between)
}

/// One quantity under the gains in force and under those found, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compared {
    /// Which.
    pub quantity: String,
    /// What it is under both.
    pub told: String,
}

/// Each quantity under the gains in force and under those found, in the units of the rotor.
pub fn rows(now: &GainEffects, found: &GainEffects, units: &ScreenUnits) -> Vec<Compared> {
    let row = |word: &str, [now, found]: [String; 2]| Compared {
        quantity: word.to_owned(),
        told: if now == found { format!("{now} in both") } else { format!("{now} in force, {found} found") },
    };
    let both = [now, found];
    let ranges = |effects: &GainEffects| match &effects.stable[..] {
        [] => "nowhere".to_owned(),
        ranges => {
            let name = if units.scales.is_some() { "" } else { "R " };
            format!("{name}{}", ranges_told(ranges, effects.top, units, " and "))
        }
    };
    let force =
        |effects: &GainEffects| effects.force.map_or_else(|| "none steady".to_owned(), |u| units.force.told(u, 5));
    let mut rows = vec![row("min damping", both.map(|effects| format!("{:.4}", effects.min_damping)))];
    if let [Some(_), Some(_)] = both.map(|effects| effects.any_deadband) {
        let worst = |effects: &GainEffects| format!("{:.4}", effects.any_deadband.unwrap_or(f64::NAN));
        rows.push(row("any deadband", both.map(worst)));
    }
    rows.extend([row("stable", both.map(ranges)), row("force", both.map(force))]);
    if both.iter().any(|effects| has_deadband(&effects.settings)) {
        let whirl =
            |effects: &GainEffects| effects.whirl.map_or_else(|| "none".to_owned(), |r| units.length.told(r, 5));
        rows.push(row("self-excited whirl", both.map(whirl)));
    }
    if let [Some(_), Some(_)] = both.map(|effects| effects.margins) {
        let peak = |effects: &GainEffects| {
            let peak = effects.margins.map_or(f64::NAN, |(peak, _)| peak);
            format!("{} {}", short(peak, 4), sensitivity_zone(peak, ISO_14839_3))
        };
        let delay = |effects: &GainEffects| {
            let delay = effects.margins.and_then(|(_, delay)| delay);
            delay.map_or_else(|| "any".to_owned(), |delay| units.time_told(delay, 4))
        };
        rows.extend([row("sensitivity", both.map(peak)), row("delay margin", both.map(delay))]);
    }
    let signals = now.settings.feedback.signals().zip(found.settings.feedback.signals()).enumerate();
    for (i, (before, after)) in signals {
        for kind in GainKind::ALL {
            let name = match now.settings.feedback.signal_count() {
                1 => kind.name().to_owned(),
                _ => format!("{}.{}", kind.name(), i + 1),
            };
            let key: Option<rotor::Key> = format!("{}.{}", kind.name(), i + 1).parse().ok();
            let unit = key.map_or(ScreenUnits::DIMENSIONLESS.speed, |key| units.setting(key));
            let at = |signal: &rotor::Signal| {
                let value = significant(signal.gain(kind).at(now.settings.speed) * unit.factor, 4);
                if units.scales.is_some() { format!("{value} {}", unit.name) } else { value.to_string() }
            };
            rows.push(row(&name, [at(before), at(after)]));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    fn effects(feedback: &str) -> GainEffects {
        let rotor = Arc::new(builtin::rotor("three-mass").unwrap());
        let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).unwrap());
        settings.deadband.fill(0.0);
        GainEffects::of(&rotor, &settings, [0.0, 2.8], Stop::NEVER)
    }

    #[test]
    fn what_is_found_stands_beside_what_is_in_force() {
        let (now, found) = (effects("composite"), effects("off"));
        let rows = rows(&now, &found, &ScreenUnits::DIMENSIONLESS);
        let words: Vec<&str> = rows.iter().map(|row| row.quantity.as_str()).collect();
        assert_eq!(words, ["min damping", "stable", "force", "kd", "cd", "kc", "cc"]);
        // The composite gains hold to 7.07, none to 1.7755; without control nothing pushes.
        assert!(rows[1].told.contains("R 0 to 7.07") && rows[1].told.contains("R 0 to 1.77"), "{rows:?}");
        assert_eq!(now.drawbacks_of(&found), ["stable LESS FAR from rest", "NO steady motion at the present speed"]);
        assert!(!found.drawbacks_of(&now).contains(&"stable LESS FAR from rest"));
        assert_eq!(rows[3].told, "-0.5879 in force, 0 found");
        assert!(now.force.is_some() && found.min_damping < 0.0, "{rows:?}");
    }

    #[test]
    fn a_delay_margin_that_is_less_than_half_is_told_of() {
        for (now, found, expected) in [
            (Some(1.0), Some(0.49), true),
            (Some(1.0), Some(0.6), false),
            (None, Some(0.6), true),
            (Some(0.6), None, false),
        ] {
            assert_eq!(halves_delay(Some((1.5, now)), Some((1.5, found))), expected, "{now:?} {found:?}");
        }
        assert!(!halves_delay(None, Some((1.5, Some(0.1)))) && !halves_delay(Some((1.5, Some(0.1))), None));
    }

    #[test]
    fn with_a_clearance_the_worst_it_can_do_stands_beside_too() {
        // At R = 2.5 the composite gains are stable at the centre and whirl far out; those for any deadband do not.
        let rotor = Arc::new(builtin::rotor("three-mass").unwrap());
        let effects = |feedback: &str| {
            let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).unwrap());
            settings.deadband.fill(1.0);
            GainEffects::of(&rotor, &settings, [0.0, 2.8], Stop::NEVER)
        };
        let (composite, individual) = (effects("composite"), effects("individual"));
        assert!(composite.any_deadband.unwrap() < composite.min_damping);
        let rows = rows(&individual, &composite, &ScreenUnits::DIMENSIONLESS);
        let words: Vec<&str> = rows.iter().map(|row| row.quantity.as_str()).collect();
        let expected =
            ["min damping", "any deadband", "stable", "force", "self-excited whirl", "sensitivity", "delay margin"];
        assert_eq!(words[..7], expected);
        // As python-control has it: 2.90308, zone A still.
        assert!(rows[5].told.ends_with("2.903 A found"), "{rows:?}");
    }

    #[test]
    fn an_si_rotor_is_told_in_rpm_and_newtons() {
        let (now, found) = (effects("composite"), effects("off"));
        let units = ScreenUnits::of(Some(crate::test_support::SI), rotor::ControlMasses::default());
        let rows = rows(&now, &found, &units);
        assert!(rows[1].told.contains(" rpm in force") && rows[2].told.contains("N in force"), "{rows:?}");
    }
}
