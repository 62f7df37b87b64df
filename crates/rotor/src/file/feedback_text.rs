//! Feedback written as a file.

use super::document::is_plain;
use super::loop_toml;
use super::write::{Lines, number, numbers, string};
use crate::{BeamRotor, ControlBearing, Feedback, Gain, GainKind, PARAMETERS, Rotor, Signal};

/// Writes feedback as TOML with comments. What [`super::read_feedback`] makes of it is the same feedback, bit for bit.
#[must_use]
pub fn write_feedback(feedback: &Feedback) -> String {
    written(feedback, None)
}

/// The same for a rotor, whose places it calls as files for it do. What [`super::read_feedback_for`] makes of it is the same feedback, bit for bit.
#[must_use]
pub fn write_feedback_for(feedback: &Feedback, rotor: &Rotor) -> String {
    written(feedback, rotor.beam())
}

fn written(feedback: &Feedback, beam: Option<&BeamRotor>) -> String {
    let mut lines = Lines::default();
    lines.comment(
        "Dimensionless for any rotor: displacements in e_t, time tau = w0 t, schedules over speed R = w / w0.",
    );
    // A place that is no station has no name in a file: it is told by its weights.
    let number = |place: usize| match beam {
        Some(beam) => beam.places().get(place).and_then(|place| Some(place.station? + 1)),
        None => Some(place + 1),
    };
    let key = if beam.is_some() { "station" } else { "mass" };
    if let Some(bearing) = is_plain(feedback) {
        let station = number(bearing.station).unwrap_or(bearing.station + 1);
        lines.key("bearing", station, &format!("the {key} that carries the control bearing"));
        write_bearing(&mut lines, bearing, "", (key, &number));
    } else {
        for bearing in &feedback.bearings {
            lines.header("bearing");
            if let Some(name) = &bearing.name {
                lines.key("name", string(name), "what it is called in front of its settings");
            }
            let station = number(bearing.station).unwrap_or(bearing.station + 1);
            lines.key(key, station, &format!("the {key} that carries it"));
            write_bearing(&mut lines, bearing, "bearing.", (key, &number));
        }
    }
    lines.into_text()
}

/// What drives a bearing, its tables under `within`.
fn write_bearing(
    lines: &mut Lines,
    bearing: &ControlBearing,
    within: &str,
    (key, numbered): (&str, &dyn Fn(usize) -> Option<usize>),
) {
    loop_toml::write_filters(lines, &bearing.filters, "what shapes the sum of the signals");
    for signal in &bearing.signals {
        lines.header(&format!("{within}signal"));
        match sensor(signal).and_then(numbered) {
            Some(place) => lines.key(key, place, &format!("the {key} that carries the sensor")),
            None => {
                lines.key("displacement", numbers(signal.displacement.iter().copied()), "weights a, b, c...");
                lines.key("velocity", numbers(signal.velocity.iter().copied()), "weights d, e, f...");
            }
        }
        for kind in GainKind::ALL {
            let meaning = PARAMETERS.iter().find(|p| p.name == kind.name()).map_or("", |p| p.meaning);
            lines.key(kind.name(), gain_text(signal.gain(kind)), meaning);
        }
        loop_toml::write_filters(lines, &signal.filters, "what shapes it");
    }
    loop_toml::write_parts(lines, &bearing.parts, &format!("{within}loop"));
}

/// The one mass that a signal measures, if its weights pick exactly one.
pub(super) fn sensor(signal: &Signal) -> Option<usize> {
    let mass = signal.displacement.iter().position(|&weight| weight == 1.0)?;
    let picked = Signal::at_mass(mass, signal.displacement.len(), [0.0; 4]);
    // By bits: a weight of -0 is kept as it is.
    let bits = |weights: &[f64]| weights.iter().map(|w| w.to_bits()).collect::<Vec<_>>();
    let same = |a: &[f64], b: &[f64]| bits(a) == bits(b);
    (same(&signal.displacement, &picked.displacement) && same(&signal.velocity, &picked.velocity)).then_some(mass)
}

fn gain_text(gain: &Gain) -> String {
    match gain {
        Gain::Constant(value) => number(*value),
        Gain::Linear { at_zero, slope } => format!("{{ at_zero = {}, slope = {} }}", number(*at_zero), number(*slope)),
        Gain::Table(points) => {
            let (speeds, values): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
            format!("{{ speed = {}, value = {} }}", numbers(speeds), numbers(values))
        }
    }
}
