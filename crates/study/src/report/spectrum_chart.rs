//! Full spectra (Figs. 3.11 and 4.23): backward whirl to the left, forward to the right, multiples of the spin marked.

use super::ReportError;
use super::data::Data;
use super::motion::Record;
use crate::spectrum::{Spectrum, SpectrumError};
use plot::{Axis, Chart, Color, Look, Note, Series, Side};

/// Decades shown below the highest line.
const DECADES: i32 = 8;

/// The chart of mass 1's spectrum; `names` says how many of the highest lines are named.
///
/// # Errors
/// No spectrum was asked for in that run.
pub(super) fn chart(record: &Record, title: &str, names: usize) -> Result<Chart, ReportError> {
    let (spectrum, peaks) = of(record)?;
    let reach = 1.5 * record.speed;
    let top = spectrum.density.iter().copied().fold(0.0, f64::max);
    let highest = top.log10().ceil() as i32;
    let floor = 10_f64.powi(highest - DECADES);
    let mut series = Vec::new();
    for order in [-1.0, -0.5, 0.5, 1.0] {
        let at = order * record.speed;
        let mut line = Series::new("", Look::Dotted, Color::GREY, vec![(at, floor), (at, 10_f64.powi(highest + 1))]);
        if order == 1.0 {
            line.name = "±0.5X and ±1X".into();
        }
        series.push(line);
    }
    let points = spectrum.frequency.iter().zip(&spectrum.density).map(|(f, d)| (*f, d.max(0.01 * floor)));
    series.push(Series::new("density of y + jz, mass 1", Look::Solid, Color::BLUE, points.collect()));
    let notes = peaks.iter().take(names).map(|peak| Note {
        at: (peak.frequency, peak.density),
        text: if peak.name == "1X" { "1X".to_owned() } else { format!("{:.2} rad/τ = {}", peak.frequency, peak.name) },
        side: Side::Above,
    });
    Ok(Chart {
        title: title.to_owned(),
        x: Axis::new("Whirl frequency (rad per unit of τ; negative: backward)", -reach, reach),
        y: Axis {
            label: "Power density (e_t² per rad/τ)".into(),
            from: floor,
            to: 10_f64.powi(highest + 1),
            log: true,
        },
        equal: false,
        series,
        notes: notes.collect(),
    })
}

/// Frequencies and densities.
///
/// # Errors
/// As for [`chart`].
pub(super) fn data(record: &Record) -> Result<Data, ReportError> {
    let (spectrum, _) = of(record)?;
    let mut data = Data::new(&["frequency", "density"]);
    data.rows = spectrum.frequency.iter().zip(&spectrum.density).map(|(f, d)| vec![*f, *d]).collect();
    Ok(data)
}

fn of(record: &Record) -> Result<&(Spectrum, Vec<crate::spectrum::Peak>), ReportError> {
    record.spectrum.as_ref().ok_or(ReportError::Spectrum(SpectrumError::TooFew(0)))
}
