//! The orbit in parts of the clearance, and the force in parts of what the bearing can hold: over the operating range, on the exact
//! circular orbits under the rotor's own unbalance, the largest stable one of each speed.

use rotor::circular::{self, CircularError, Orbit};
use rotor::{ControlMasses, Stability};

use super::{Asked, AssessError, AssessmentCase, Finding, Findings, Quantity, SPEEDS, Where};

pub(super) fn lines(question: &AssessmentCase<'_>) -> Result<Findings, AssessError> {
    let (settings, limits) = (question.settings, question.limits);
    let orbit_source = limits.source("orbit_zone_a");
    let force_source = limits.source("force_share");
    let (orbit, force) = ("orbit / clearance", "dynamic force");
    let speeds = AssessmentCase::speeds(question.operating);
    let found = match circular::synchronous(question.rotor, &settings.feedback, &settings.deadband, &speeds) {
        Ok(found) => found,
        Err(CircularError::Sampled) => {
            let why = "a sampled loop: no orbit of it is a circle";
            return Ok((
                vec![
                    Finding::without(orbit, Quantity::Number, why, &orbit_source),
                    Finding::without(force, Quantity::Force, why, &force_source),
                ],
                vec![],
            ));
        }
        Err(error) => return Err(error.into()),
    };
    let [low, high] = question.operating;
    let along = found.curves.iter().flat_map(|curve| &curve.orbits).filter(|o| (low..=high).contains(&o.speed));
    let all: Vec<&Orbit> = found.orbits.iter().flatten().chain(along).collect();
    let unknown = all.iter().find_map(|orbit| orbit.growth.as_ref().err());
    let stable: Vec<&Orbit> = all.iter().copied().filter(|orbit| orbit.is_stable()).collect();
    let largest = largest(question, &stable, &Orbit::largest_radius)?;
    let is_held = |orbit: &Orbit| orbit.stability() != Ok(Stability::Unstable);
    let unheld = found.orbits.iter().zip(&found.speeds).find(|(orbits, _)| !orbits.iter().any(is_held));
    let mut lines = vec![orbit_line(question, orbit, largest.as_ref(), &orbit_source)];
    let count = settings.feedback.bearings.len();
    for bearing in 0..count {
        let what = if count == 1 { force.to_owned() } else { format!("{force}, {}", settings.feedback.label(bearing)) };
        lines.push(force_line(question, &what, bearing, &stable, &force_source)?);
    }
    if let Some((_, speed)) = unheld {
        for line in &mut lines {
            let note = line.note.take().map_or(String::new(), |note| format!("{note}; "));
            let beyond =
                if found.beyond_limits.iter().any(|count| *count > 0) { " within the limit of the force" } else { "" };
            line.note = Some(format!("{note}there are speeds without a stable orbit{beyond}"));
            line.passed = Some(false);
            if line.found.is_none() {
                line.place = Where::speed(*speed);
            }
        }
    }
    if let Some(why) = unknown {
        for line in &mut lines {
            let note = line.note.take().map_or(String::new(), |note| format!("{note}; "));
            line.note = Some(format!("{note}orbits whose stability is unknown are left out: {why}"));
            // They might be larger, and stable.
            line.passed = line.passed.filter(|passed| !passed);
        }
    }
    Ok((lines, vec![]))
}

/// The orbit that is largest by `size` among those known, and between the speeds at which they are.
fn largest(
    question: &AssessmentCase<'_>,
    orbits: &[&Orbit],
    size: &dyn Fn(&Orbit) -> f64,
) -> Result<Option<Orbit>, AssessError> {
    let Some(known) = orbits.iter().max_by(|a, b| size(a).total_cmp(&size(b))) else { return Ok(None) };
    let mut best = (*known).clone();
    let settings = question.settings;
    let [from, to] = question.operating;
    let apart = (to - from) / (SPEEDS - 1) as f64;
    let (low, high) = ((best.speed - apart).max(from), (best.speed + apart).min(to));
    let look = |speed: f64| -> Result<f64, AssessError> {
        let found = circular::synchronous(question.rotor, &settings.feedback, &settings.deadband, &[speed])?;
        let stable = found.orbits.into_iter().flatten().filter(Orbit::is_stable);
        let Some(here) = stable.max_by(|a, b| size(a).total_cmp(&size(b))) else { return Ok(0.0) };
        let value = size(&here);
        if value > size(&best) {
            best = here;
        }
        Ok(-value)
    };
    linear::least([low, high], 1e-8 * (1.0 + high), look)?;
    Ok(Some(best))
}

fn orbit_line(question: &AssessmentCase<'_>, what: &str, largest: Option<&Orbit>, source: &str) -> Finding {
    let limits = question.limits;
    let Some(clearance) = question.smallest_clearance() else {
        return Finding::without(what, Quantity::Number, "no clearance is set", source);
    };
    let Some(orbit) = largest else {
        return Finding::without(what, Quantity::Number, "no stable orbit was found", source);
    };
    let share = orbit.largest_radius() / clearance;
    let (zone, most) = limits.zone_of(share, limits.orbit_zones());
    let line = Finding::judged(what, Quantity::Number, share, Asked::AtMost(most), source);
    let radii = orbit.radii();
    let station = (0..radii.len()).max_by(|a, b| radii[*a].total_cmp(&radii[*b])).unwrap_or(0);
    line.at(Where::speed(orbit.speed).of(station)).noted(format!("zone {zone}"))
}

/// The force of a control bearing, counted from 0, against what it can hold; both as if the first had to.
fn force_line(
    question: &AssessmentCase<'_>,
    what: &str,
    bearing: usize,
    orbits: &[&Orbit],
    source: &str,
) -> Result<Finding, AssessError> {
    let masses = ControlMasses::of(question.rotor, &question.settings.feedback);
    let of_first = |control: f64| masses.as_of_first(bearing, control);
    let force = |orbit: &Orbit| of_first(orbit.forces.get(bearing).copied().unwrap_or(0.0));
    let own = &question.settings.feedback.bearings[bearing];
    let limit = own.parts.limit;
    let holds = question.force.or((limit > 0.0 && limit.is_finite()).then(|| of_first(limit)));
    let Some(hardest) = largest(question, orbits, &force)? else {
        return Ok(Finding::without(what, Quantity::Force, "no stable orbit was found", source));
    };
    let place = Where::speed(hardest.speed).of(own.station);
    Ok(match holds {
        Some(most) => {
            let asked = Asked::AtMost(question.limits.force_share * most);
            Finding::judged(what, Quantity::Force, force(&hardest), asked, source).at(place)
        }
        None => {
            let line = Finding::told(what, Quantity::Force, force(&hardest), source).at(place);
            line.noted("no limit of the force is set")
        }
    })
}
