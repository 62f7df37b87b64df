//! What was measured beside what is computed: table, JSON, picture, and what bends the one away from the other.

use linear::AmplitudePeak;
use machine::{ISO_14839_3, TransferFunction, sensitivity_zone};
use plot::{Chart, Color, Look, Series};
use rotor::C64;
use serde::Serialize;
use serde_json::{Value, json};

use super::super::bode::{Show, chart};
use super::Subject;
use super::collect::Measured;
use super::plan::Plan;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table, rounded};
use crate::units::UnitsDocument;

/// From here on what is measured is said to differ from what is computed, and periods from each other.
const DIFFERS: f64 = 0.01;
const INCOHERENT: f64 = 0.99;

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speed: f64,
    revision: u64,
    seed: u64,
    /// Of each tone, in `w0^2 e_t`.
    amplitude: f64,
    /// In `tau`.
    period: f64,
    periods: usize,
    settled: f64,
    from: f64,
    lost: u64,
    /// The largest `|S|` among the tones.
    peak: Value,
    /// The largest `|S|` of the computed curve, between the tones too.
    curve: Value,
    largest_difference: Value,
    least_coherence: Value,
    contact: &'a [f64],
    saturated: f64,
    bent_by: Vec<String>,
    points: Vec<Value>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// A tone, measured and computed.
struct ToneRow {
    frequency: f64,
    measured: C64,
    computed: C64,
    coherence: f64,
}

impl ToneRow {
    fn difference(&self) -> f64 {
        (self.measured - self.computed).norm() / self.computed.norm()
    }
}

fn rows(subject: &Subject, measured: &Measured) -> Vec<ToneRow> {
    let row = |p: &study::measured::MeasuredPoint| ToneRow {
        frequency: p.frequency,
        measured: p.value,
        computed: subject.machine.gain.at(p.frequency).sensitivity(),
        coherence: p.coherence,
    };
    measured.points.iter().map(row).collect()
}

/// Prints it.
pub(super) fn print(subject: &Subject, plan: &Plan, measured: &Measured, format: Format) -> Result<(), Failure> {
    let (units, rows) = (subject.units, rows(subject, measured));
    let mut table = Table::new(&[
        units.pick("frequency", "frequency (Hz)"),
        "|S| measured",
        "|S| computed",
        "phase measured",
        "phase computed",
        "difference",
        "coherence",
    ]);
    for row in &rows {
        let [measured, computed] = [row.measured, row.computed].map(C64::to_polar);
        let cells = [
            units.frequency(row.frequency),
            measured.0,
            computed.0,
            measured.1.to_degrees(),
            computed.1.to_degrees(),
            row.difference(),
            row.coherence,
        ];
        table.row(cells.map(Cell::from));
    }
    let curve = subject.machine.gain.margins();
    let worst = rows.iter().max_by(|a, b| a.difference().total_cmp(&b.difference()));
    let least = rows.iter().min_by(|a, b| a.coherence.total_cmp(&b.coherence));
    let at = |row: Option<&ToneRow>, value: fn(&ToneRow) -> f64| json!({"value": row.map(value), "frequency": row.map(|r| r.frequency)});
    let bent_by = bent_by(subject, measured);
    let document = Document {
        rotor: subject.rotor.name(),
        speed: subject.settings.speed,
        revision: subject.revision,
        seed: plan.multisine.seed,
        amplitude: plan.multisine.amplitude,
        period: plan.multisine.period,
        periods: measured.periods,
        settled: plan.settle as f64 * subject.dtau,
        from: measured.from,
        lost: measured.lost,
        peak: json!({"measured": peaks(&rows, |row| row.measured), "computed": peaks(&rows, |row| row.computed)}),
        curve: curve_peak(curve.sensitivity()),
        largest_difference: at(worst, ToneRow::difference),
        least_coherence: at(least, |row| row.coherence),
        contact: &measured.contact,
        saturated: measured.saturated,
        bent_by: bent_by.clone(),
        points: rows.iter().map(point).collect(),
        units: units.document(),
    };
    let heading = format!(
        "{}: sensitivity measured at {}, {} periods of {}, tones of {}{}",
        subject.rotor.name(),
        units.speed_text(subject.settings.speed),
        measured.periods,
        units.time_text(plan.multisine.period),
        rounded(units.force(plan.multisine.amplitude, subject.bearing_mass())),
        units.pick(" w0^2 e_t".to_owned(), format!(" {}", units.force_unit())),
    );
    let footer = footer(subject, measured, &rows, curve.sensitivity(), &bent_by);
    format.print(&document, &heading, &table, &footer)
}

fn point(row: &ToneRow) -> Value {
    let of = |z: C64| json!({"re": z.re, "im": z.im, "amplitude": z.norm(), "phase": z.arg().to_degrees()});
    json!({
        "frequency": row.frequency,
        "measured": of(row.measured),
        "computed": of(row.computed),
        "difference": row.difference(),
        "coherence": row.coherence,
    })
}

/// The tone at which `|S|` is largest, of all, of those forward and of those backward.
fn peaks(rows: &[ToneRow], of: fn(&ToneRow) -> C64) -> Value {
    let largest = |wanted: fn(&f64) -> bool| {
        let rows = rows.iter().filter(|row| wanted(&row.frequency));
        rows.map(|row| (of(row).norm(), row.frequency)).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let told = |wanted: fn(&f64) -> bool| {
        let found = largest(wanted);
        json!({"peak": found.map(|(peak, _)| peak), "frequency": found.map(|(_, frequency)| frequency)})
    };
    let mut made = told(|_| true);
    made["zone"] = json!(largest(|_| true).map(|(peak, _)| sensitivity_zone(peak, ISO_14839_3)));
    made["forward"] = told(|frequency| *frequency > 0.0);
    made["backward"] = told(|frequency| *frequency < 0.0);
    made
}

fn curve_peak(AmplitudePeak { amplitude, frequency }: AmplitudePeak) -> Value {
    json!({"peak": amplitude, "frequency": frequency, "zone": sensitivity_zone(amplitude, ISO_14839_3)})
}

/// What of the machine is not linear, as far as it was seen at work.
fn bent_by(subject: &Subject, measured: &Measured) -> Vec<String> {
    let (settings, units) = (&subject.settings, subject.units);
    let percent = |share: f64| format!("{} % of the time", rounded(100.0 * share));
    let mut told = Vec::new();
    for (mass, (share, clearance)) in measured.contact.iter().zip(&settings.deadband).enumerate() {
        if *clearance > 0.0 && subject.rotor.has_contact(mass) {
            told.push(format!(
                "mass {} has a clearance of {} {} and pressed on its bearing {}, which is computed at its full stiffness",
                mass + 1,
                rounded(units.length(*clearance)),
                units.length_unit(),
                percent(*share)
            ));
        }
    }
    if measured.saturated > 0.0 {
        let which = if settings.feedback.only().is_some() { "the" } else { "a" };
        told.push(format!("{which} control bearing was at its limit {}", percent(measured.saturated)));
    }
    let parts = || settings.feedback.bearings.iter().map(|bearing| &bearing.parts);
    let has = [parts().any(|parts| parts.noise > 0.0), parts().any(|parts| parts.quantum > 0.0)];
    for (has, name) in has.into_iter().zip(["noise of the sensors", "resolution of the sensors"]) {
        if has {
            told.push(format!("{name}: a larger amplitude or more periods make it smaller"));
        }
    }
    told
}

fn footer(
    subject: &Subject,
    measured: &Measured,
    rows: &[ToneRow],
    curve: AmplitudePeak,
    bent_by: &[String],
) -> String {
    let units = subject.units;
    let at = |frequency: f64| format!("{}{}", rounded(units.frequency(frequency)), units.pick("", " Hz"));
    let largest = rows.iter().max_by(|a, b| a.measured.norm().total_cmp(&b.measured.norm()));
    let mut lines = Vec::new();
    if let Some(row) = largest {
        let peak = row.measured.norm();
        lines.push(format!(
            "largest measured: {} at {}, zone {} of ISO 14839-3, where {} is computed",
            rounded(peak),
            at(row.frequency),
            sensitivity_zone(peak, ISO_14839_3),
            rounded(row.computed.norm())
        ));
    }
    if let Some(frequency) = curve.frequency {
        lines.push(format!("the computed curve peaks at {}, with {}", at(frequency), rounded(curve.amplitude)));
    }
    let worst = rows.iter().max_by(|a, b| a.difference().total_cmp(&b.difference()));
    let least = rows.iter().map(|row| row.coherence).fold(1.0, f64::min);
    if let Some(row) = worst {
        lines.push(format!(
            "measured and computed differ by {} % at most, at {}; least coherence {}",
            rounded(100.0 * row.difference()),
            at(row.frequency),
            rounded(least)
        ));
        if row.difference() > DIFFERS || least < INCOHERENT {
            match bent_by {
                [] => lines
                    .push("nothing of the machine is known to bend it: more periods or other tones would tell".into()),
                _ => lines.extend(bent_by.iter().map(|words| format!("bent by: {words}"))),
            }
        }
    }
    if measured.lost > 0 {
        lines.push(format!("{} steps were lost, and the periods that they were in left out", measured.lost));
    }
    lines.push("negative frequencies are backward whirl; an aid, not a certificate".into());
    lines.join("\n")
}

/// Both as a chart: what is computed as lines, what is measured as dots.
pub(super) fn charts(subject: &Subject, measured: &Measured) -> Result<Vec<Chart>, Failure> {
    let units = subject.units;
    let end = measured.points.iter().map(|p| p.frequency.abs()).fold(0.0, f64::max);
    let points = subject.machine.response(TransferFunction::Sensitivity, [-end, end])?.unwrap_or_default();
    let title = format!(
        "{}, sensitivity at {}: computed, and measured (dots)",
        subject.rotor.name(),
        units.speed_text(subject.settings.speed)
    );
    let mut charts = chart::of(&points, &title, Show::Amplitude, units, 1.0, "", false);
    let dots = |name: &str, color: Color, sign: f64| {
        let shown = measured.points.iter().filter(|p| p.frequency * sign > 0.0);
        let decibels = |z: C64| 20.0 * z.norm().max(f64::MIN_POSITIVE).log10();
        let places = shown.map(|p| (units.frequency(p.frequency.abs()), decibels(p.value))).collect();
        Series::new(name, Look::Dots, color, places)
    };
    if let Some(chart) = charts.first_mut() {
        chart.series.push(dots("forward, measured", Color::BLUE, 1.0));
        chart.series.push(dots("backward, measured", Color::VERMILLION, -1.0));
        // Dots beyond the line are seen too.
        let sizes = chart.series.iter().flat_map(|series| &series.points).map(|(_, y)| *y).filter(|y| y.is_finite());
        let [low, high] =
            sizes.fold([chart.y.from, chart.y.to], |[low, high], y| [low.min(y - 1.0), high.max(y + 1.0)]);
        (chart.y.from, chart.y.to) = (low, high);
    }
    Ok(charts)
}
