//! The largest steady control force over speed (Figs. 3.7 and 4.16).

use super::data::Data;
use super::evidence::{DEADBANDS, Forces};
use plot::{Axis, Chart, Color, Look, Series};

const LOOKS: [(Look, Color); 3] =
    [(Look::Solid, Color::BLUE), (Look::Dashed, Color::VERMILLION), (Look::Dotted, Color::GREEN)];

/// The curves, one a clearance, but for motion that has not settled; decades where they are far apart.
pub(super) fn chart(forces: &Forces, title: &str, log: bool) -> Chart {
    let series: Vec<Series> = DEADBANDS
        .iter()
        .zip(LOOKS)
        .enumerate()
        .map(|(i, (deadband, (look, color)))| {
            let line = forces.speeds.iter().copied().zip(forces.settled(i)).filter(|(_, force)| force.is_finite());
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
    let columns: Vec<Vec<f64>> = (0..DEADBANDS.len()).map(|g| forces.settled(g).collect()).collect();
    for (i, speed) in forces.speeds.iter().enumerate() {
        data.rows.push(std::iter::once(*speed).chain(columns.iter().map(|column| column[i])).collect());
    }
    data
}
