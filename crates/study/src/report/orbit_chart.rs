//! Orbits (Figs. 3.5, 3.6, 3.8 to 3.10, 4.17 to 4.22, 4.24 to 4.26): where a mass goes, the clearance of its bearing around
//! the centre.

use super::data::Data;
use super::motion::Record;
use plot::{Axis, Chart, Color, Look, Note, Series, Side};

/// How much of the way from rest is shown where the settled motion is the subject.
const SPIN_UP: f64 = 30.0;

/// The chart of one mass's orbit, counted from 0: from the start to `settled` thin, from there on to the end in full, and
/// the clearance if the mass has a bearing with one.
pub(super) fn chart(record: &Record, mass: usize, title: &str, settled: Option<f64>, bearing: bool) -> Chart {
    let from = settled.unwrap_or(f64::INFINITY);
    // Between the start and the end of a long run nothing was kept.
    let start = record.orbit(mass, 0.0, if settled.is_some() { SPIN_UP } else { f64::INFINITY });
    let rest = record.orbit(mass, from, f64::INFINITY);
    let mut series = Vec::new();
    if bearing && record.deadband > 0.0 {
        let name = format!("clearance of the bearing, g = {}", record.deadband);
        series.push(Series::new(&name, Look::Dashed, Color::GREEN, circle(record.deadband)));
    }
    let mut notes = Vec::new();
    match settled {
        None => {
            let mut line = Series::new("from rest", Look::Thin, Color::BLUE, start);
            line.arrows = arrows(&line.points);
            notes.extend(line.points.first().map(|at| Note { at: *at, text: "start".into(), side: Side::Below }));
            series.push(line);
        }
        Some(_) => {
            series.push(Series::new("from rest", Look::Thin, Color::GREY, start));
            let many_turns = rest.len() > 400;
            let look = if many_turns { Look::Thin } else { Look::Solid };
            series.push(Series::new("once transients have died", look, Color::BLUE, rest));
        }
    }
    let reach = 1.08 * series.iter().flat_map(|s| &s.points).map(|(y, z)| y.abs().max(z.abs())).fold(0.0, f64::max);
    Chart {
        title: title.to_owned(),
        x: Axis::new("y (e_t)", -reach, reach),
        y: Axis::new("z (e_t)", -reach, reach),
        equal: true,
        series,
        notes,
    }
}

/// The samples of one mass, and the control force with them.
pub(super) fn data(record: &Record, mass: usize) -> Data {
    let mut data = Data::new(&["tau", "y", "z", "uy", "uz"]);
    for sample in &record.samples {
        let (p, u) = (sample.displacement[mass], sample.control);
        data.rows.push(vec![sample.tau, p.re, p.im, u.re, u.im]);
    }
    data
}

fn circle(radius: f64) -> Vec<(f64, f64)> {
    let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / 180.0;
    (0..=180).map(|i| (radius * angle(i).cos(), radius * angle(i).sin())).collect()
}

/// A few arrowheads early on, where the way can still be told.
fn arrows(points: &[(f64, f64)]) -> Vec<usize> {
    [0.04, 0.12, 0.5].iter().map(|part| (part * points.len() as f64) as usize).filter(|i| *i > 0).collect()
}
