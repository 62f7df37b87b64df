//! The largest steady control force over speed (Figs. 3.7 and 4.16).

use super::data::Data;
use super::evidence::{DEADBANDS, Forces};
use crate::plot::{Axis, Chart, Color, Look, Series};

const LOOKS: [(Look, Color); 3] =
    [(Look::Solid, Color::BLUE), (Look::Dashed, Color::VERMILLION), (Look::Dotted, Color::GREEN)];

/// The curves, one a clearance; decades where they are far apart.
pub(super) fn chart(forces: &Forces, title: &str, log: bool) -> Chart {
    let series: Vec<Series> = DEADBANDS
        .iter()
        .zip(LOOKS)
        .zip(&forces.by_deadband)
        .map(|((deadband, (look, color)), points)| {
            let line = forces.speeds.iter().zip(points).map(|(speed, p)| (*speed, p.max_force));
            Series::new(&format!("g = {deadband}"), look, color, line.collect())
        })
        .collect();
    let top = series.iter().flat_map(|s| &s.points).map(|(_, f)| *f).fold(0.0, f64::max);
    let last = forces.speeds.last().copied().unwrap_or(1.0);
    let label = "Largest steady |u| (ω₀² e_t)";
    let y = if log {
        Axis { label: label.to_owned(), from: 0.01, to: 10_f64.powf(top.log10().ceil()), log: true }
    } else {
        Axis::new(label, 0.0, 1.08 * top)
    };
    Chart {
        title: title.to_owned(),
        x: Axis::new("Spin speed R (ω/ω₀)", 0.0, last),
        y,
        equal: false,
        series,
        notes: Vec::new(),
    }
}

/// Speeds and forces.
pub(super) fn data(forces: &Forces) -> Data {
    let mut data = Data::new(&["speed"]);
    data.header.extend(DEADBANDS.iter().map(|g| format!("max_force_g{g}")));
    for (i, speed) in forces.speeds.iter().enumerate() {
        let row = forces.by_deadband.iter().map(|points| points[i].max_force);
        data.rows.push(std::iter::once(*speed).chain(row).collect());
    }
    data
}
