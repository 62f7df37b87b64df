//! What a person wants to know of an answer.

use std::f64::consts::TAU;

use serde_json::Value;
use tuner::{Measure, Problem};

use super::answer::Document;
use super::corners;
use super::question::Asked;
use crate::output::rounded;
use crate::units::CommandUnits;

/// What a person wants to know of the answer, in lines.
pub(super) fn summary(asked: &Asked, problem: &Problem, document: &Document<'_>) -> Vec<String> {
    let units = asked.units();
    let what = if problem.measure == Measure::default() { "min damping" } else { "objective" };
    let sure = if document.proven {
        format!("proven within {:e} over all conditions ({})", document.tolerance, boxes(document.boxes))
    } else {
        format!("the worst of {} conditions looked at, not proven between them", document.checked)
    };
    let mut lines = vec![format!(
        "{what} {} at {}{}: {sure}",
        rounded(document.objective),
        speed_text(units, document.worst["speed"].as_f64()),
        others(&document.worst)
    )];
    if let Measure::Cost(_) = problem.measure
        && document.objective > 0.0
    {
        let cost = units.length(document.objective.sqrt().recip());
        lines.push(format!("cost {} {}: the objective is 1 / cost^2 (in e_t)", rounded(cost), units.length_unit()));
    }
    if what == "objective" {
        lines.push(format!(
            "min damping {} at {}",
            rounded(document.min_damping),
            speed_text(units, Some(document.worst_speed))
        ));
    }
    if let Some(below) = document.below {
        let hertz = below / TAU / units.time(1.0);
        lines.push(format!("modes up to {} Hz count; those above are stable if the worth is above 0", rounded(hertz)));
    }
    if document.marginal {
        lines.push("a mode is marginal: within rounding of the axis, neither stable nor unstable".to_owned());
    }
    if let Some(line) = document.count_right_of {
        let per = units.time(1.0);
        lines.push(format!(
            "with delay: every pole right of {} {} there is found and counted; what decays faster is no part of this",
            rounded(line / per),
            units.pick("per tau", "per s")
        ));
    }
    let mass = asked.rotor().control_mass(problem.structure.bearing());
    lines.push(format!(
        "steady control force up to {} {} (linear rotor), at {}{}",
        rounded(units.force(document.max_force, mass)),
        units.force_unit(),
        speed_text(units, document.max_force_at["speed"].as_f64()),
        others(&document.max_force_at)
    ));
    if let (Some(peak), Some(delay)) = (document.margins.get("sensitivity"), document.margins.get("delay")) {
        let place = |of: &Value| format!("{}{}", speed_text(units, of["at"]["speed"].as_f64()), others(&of["at"]));
        let number = |value: &Value| rounded(value.as_f64().unwrap_or(f64::NAN));
        let sure = match peak["below"].as_f64() {
            Some(below) => format!("; proven to be below {} at every condition", rounded(below)),
            None => "; not proven between the conditions looked at".to_owned(),
        };
        lines.push(format!("peak of the sensitivity {} at {}{sure}", number(&peak["peak"]), place(peak)));
        lines.push(match delay["tau"].as_f64() {
            Some(tau) => format!("delay margin {} at {}", units.time_text(tau), place(delay)),
            None => "no delay makes it unstable".to_owned(),
        });
    }
    if !document.corners.is_empty() {
        lines.push(units.pick("corners in radians per tau", "corners in Hz, rates of integrators in 1/s").to_owned());
    }
    lines.extend(corners::at_ends(&problem.structure, document.found));
    let s = document.stationarity;
    // Corners are bounded too, and told by name where they are at an end.
    let at_bound = count(s.at_bound - corners::ends(&problem.structure, document.found).len().min(s.at_bound), "gain");
    lines.push(format!(
        "local optimality {:.1e}: {}, {}, {} at the bound",
        s.norm,
        count(s.active, "active mode"),
        count(s.merging, "merging pair"),
        at_bound
    ));
    lines.push(format!(
        "{} of {} starts within 1 % of the best; {} eigenvalue problems in {:.3} s; seed {}",
        document.starts_within_1_percent, document.starts, document.evaluations, document.seconds, document.seed
    ));
    if document.interrupted {
        lines.push("interrupted: the best found until then".to_owned());
    }
    lines
}

/// A speed that was found, not typed: six digits are enough.
pub(super) fn speed_text(units: CommandUnits, speed: Option<f64>) -> String {
    units.speed_text((speed.unwrap_or(f64::NAN) * 1e6).round() / 1e6)
}

fn boxes(number: u64) -> String {
    if number == 1 { "1 box".into() } else { format!("{number} boxes") }
}

fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

/// The coordinates of a condition beside its speed: `, factor.1 = 0, factor.3 = 1`.
fn others(condition: &Value) -> String {
    let known = ["speed", "re", "im", "damping", "value"];
    let each = condition.as_object().into_iter().flatten().filter(|(name, _)| !known.contains(&name.as_str()));
    each.map(|(name, value)| format!(", {name} = {}", rounded(value.as_f64().unwrap_or(f64::NAN)))).collect()
}
