//! Modal orbits (Figs. 4.3 to 4.5): the eigenvector turned by its eigenvalue, real part kept, as orbits along the shaft.

use rotor::{C64, Mode};

use super::data::Data;
use plot::{Axis, Chart, Color, Look, Note, Series, Side};

/// How far y is drawn along the shaft: the shaft is seen at an angle.
const OBLIQUE: f64 = 0.32;
/// Points of an orbit.
const POINTS: u32 = 120;
/// Distance between two masses.
const APART: f64 = 1.2;

/// The chart of one mode.
pub(super) fn chart(mode: &Mode, title: &str) -> Chart {
    let masses = mode.shape.len();
    let place = |k: usize, p: C64| (APART * k as f64 + OBLIQUE * p.re, p.im);
    let shaft = |angle: f64| -> Vec<(f64, f64)> { (0..masses).map(|k| place(k, at(mode, k, angle))).collect() };
    let end = APART * (masses as f64 - 1.0);
    let mut series = vec![Series::new("shaft at rest", Look::Dashed, Color::GREY, vec![(-0.5, 0.0), (end + 0.5, 0.0)])];
    for k in 0..masses {
        let orbit = (0..=POINTS).map(|i| place(k, at(mode, k, angle(i)))).collect();
        let name = if k == 0 { "orbit of each mass over one turn of whirl" } else { "" };
        let mut line = Series::new(name, Look::Solid, Color::BLUE, orbit);
        line.arrows = if mode.shape[k].norm() > 0.05 { vec![POINTS as usize / 8 + 8] } else { Vec::new() };
        series.push(line);
    }
    let now = 0.125 * std::f64::consts::TAU;
    series.push(Series::new("shaft an eighth of a turn on", Look::Dotted, Color::VERMILLION, shaft(2.0 * now)));
    series.push(Series::new("shaft and masses at one moment", Look::Solid, Color::VERMILLION, shaft(now)));
    series.push(Series::new("", Look::Dots, Color::VERMILLION, shaft(now)));
    let notes =
        (0..masses).map(|k| Note { at: (APART * k as f64, -1.18), text: format!("mass {}", k + 1), side: Side::Below });
    Chart {
        title: title.to_owned(),
        x: Axis::new("Along the shaft (y is drawn at an angle)", -0.6, end + 0.6),
        y: Axis::new("z (of the largest)", -1.4, 1.4),
        equal: false,
        series,
        notes: notes.collect(),
    }
}

/// The orbits.
pub(super) fn data(mode: &Mode) -> Data {
    let mut data = Data::new(&["mass", "angle", "y", "z"]);
    for k in 0..mode.shape.len() {
        for i in 0..=POINTS {
            let p = at(mode, k, angle(i));
            data.rows.push(vec![k as f64 + 1.0, angle(i), p.re, p.im]);
        }
    }
    data
}

fn angle(i: u32) -> f64 {
    std::f64::consts::TAU * f64::from(i) / f64::from(POINTS)
}

/// Mass `k` when the mode has whirled by `angle`, with the growth or decay that goes with it.
fn at(mode: &Mode, k: usize, angle: f64) -> C64 {
    let growth = mode.pole.re / mode.pole.im.abs();
    mode.shape[k] * (growth * angle).exp() * C64::cis(angle * mode.pole.im.signum())
}
