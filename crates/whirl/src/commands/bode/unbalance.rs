//! `--of unbalance`: how far unbalance deflects every mass over speed, and where that peaks.

use machine::{UnbalancePeak, UnbalancePoint, UnbalanceResponse, unbalance_response};
use plot::{Axis, Chart, Color, Look, Series};
use serde::Serialize;

use super::{BodeArgs, PointDocument, ROWS, Show, degrees};
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::output::{Cell, Table, print_text, rounded};
use crate::picture;
use crate::quantity::QuantityRange;
use crate::range::Range;
use crate::units::UnitsDocument;

/// A damping ratio of less is none.
const UNDAMPED: f64 = 1e-9;

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    of: &'static str,
    open: bool,
    points: Vec<SpeedDocument>,
    /// Speeds at which the response of a mass, counted from 1, is largest among its neighbours.
    criticals: Vec<CriticalDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct SpeedDocument {
    speed: f64,
    /// One a mass, over the direction of the unbalance; the frequency is the speed.
    stations: Vec<PointDocument>,
}

#[derive(Debug, Serialize)]
struct CriticalDocument {
    station: usize,
    speed: f64,
    amplitude: f64,
}

pub(super) fn run(args: &BodeArgs, over: QuantityRange) -> Result<(), Failure> {
    if args.band.is_some() {
        return Err(Failure::Usage("--band does nothing to the response to unbalance: leave it out".into()));
    }
    if args.show == Show::Nyquist {
        return Err(Failure::Usage(
            "--show nyquist is of a frequency response: expected bode, amplitude or phase".into(),
        ));
    }
    let (machine, range) = Machine::open_over(&args.machine, over)?;
    let machine = machine.whole(args.whole)?;
    let (rotor, units) = (&machine.rotor, machine.units());
    let Some(UnbalanceResponse { points, peaks }) =
        unbalance_response(rotor, &machine.settings, [range.from, range.to])?
    else {
        return Err(Failure::Usage(
            "--of unbalance: no orbit of a sampled loop is a circle: take the samples out with --set sample=off".into(),
        ));
    };
    let charts = || {
        let title = format!("{}: response to unbalance", rotor.name());
        let amplitude = |title: String| chart(&machine, range, &points, title, false);
        let phase = |title: String| chart(&machine, range, &points, title, true);
        match args.show {
            Show::Amplitude => vec![amplitude(title)],
            Show::Phase => vec![phase(title)],
            Show::Bode | Show::Nyquist => vec![amplitude(title), phase(String::new())],
        }
    };
    if let Some(path) = &args.out {
        picture::draw(path, args.force, &charts())?;
    }
    let mut headings = vec![units.pick("speed", "speed (rpm)").to_owned()];
    for k in 1..=rotor.len() {
        headings.extend([units.pick(format!("r{k}"), format!("r{k} (m)")), format!("phase {k}")]);
    }
    let mut table = Table::new(&headings);
    let every = if args.format.csv { 1 } else { points.len().div_ceil(ROWS).max(1) };
    for point in points.iter().step_by(every) {
        // What does not move has no phase.
        let phase = |z: &rotor::C64| if z.norm() == 0.0 { Cell::Without("none") } else { degrees(*z).into() };
        let each = point.stations.iter().flat_map(|z| [units.length(z.norm()).into(), phase(z)]);
        table.row(std::iter::once(units.speed(point.speed).into()).chain(each));
    }
    let told = |peak: &UnbalancePeak| {
        format!(
            "mass {} peaks at {}: {} {}",
            peak.station + 1,
            units.speed_text_rounded(peak.speed),
            rounded(units.length(peak.amplitude)),
            units.length_unit()
        )
    };
    let mut footer: Vec<String> = peaks.iter().map(told).collect();
    if machine.settings.unbalanced(rotor).is_balanced() {
        footer.push("the rotor has no unbalance: nothing drives it, whatever its critical speeds".into());
    } else if peaks.is_empty() {
        footer.push("no mass peaks within these speeds".into());
    }
    // At a critical speed of an undamped mode the response has no bound, and how high it is computed is rounding.
    let is_undamped = |peak: &UnbalancePeak| {
        machine::min_damping(rotor, &machine.settings, peak.speed).is_ok_and(|damping| damping.abs() < UNDAMPED)
    };
    if peaks.iter().any(is_undamped) {
        footer.push("a mode has no damping: peaks have no bound, and those heights are rounding".into());
    }
    if every > 1 && !args.draw {
        footer.push("--csv and --json have every point".into());
    }
    let document = Document {
        rotor: rotor.name(),
        of: "unbalance",
        open: false,
        points: points
            .iter()
            .map(|p| SpeedDocument {
                speed: p.speed,
                stations: p.stations.iter().map(|z| PointDocument::of(p.speed, *z)).collect(),
            })
            .collect(),
        criticals: peaks
            .iter()
            .map(|p| CriticalDocument { station: p.station + 1, speed: p.speed, amplitude: p.amplitude })
            .collect(),
        units: units.document(),
    };
    let heading = format!(
        "{}: response to unbalance for {}, deadband neglected; phase in degrees ahead of the unbalance",
        rotor.name(),
        units.range_text(over)
    );
    if args.draw {
        return print_text(&format!("{heading}\n{}{}\n", picture::in_terminal(&charts()), footer.join("\n")));
    }
    args.format.print(&document, &heading, &table, &machine.with_taken(&footer.join("\n")))
}

/// Amplitude or phase of every mass over speed.
fn chart(machine: &Machine, range: Range, points: &[UnbalancePoint], title: String, is_phase: bool) -> Chart {
    const LOOKS: [Look; 4] = [Look::Solid, Look::Dashed, Look::Dotted, Look::Thin];
    const COLORS: [Color; 5] = [Color::BLUE, Color::VERMILLION, Color::GREEN, Color::PURPLE, Color::BLACK];
    let units = machine.units();
    let value = |z: rotor::C64| match is_phase {
        true if z.norm() == 0.0 => f64::NAN,
        true => degrees(z),
        false => units.length(z.norm()),
    };
    let line = |k: usize| {
        let at = |p: &UnbalancePoint| (units.speed(p.speed), value(p.stations[k]));
        let shown: Vec<(f64, f64)> = points.iter().map(at).collect();
        let shown = if is_phase { super::chart::wrapped(shown) } else { shown };
        Series::new(&format!("mass {}", k + 1), LOOKS[k % LOOKS.len()], COLORS[k % COLORS.len()], shown)
    };
    let series: Vec<Series> = (0..machine.rotor.len()).map(line).collect();
    let top = series.iter().flat_map(|s| &s.points).map(|p| p.1).filter(|y| y.is_finite()).fold(0.0, f64::max);
    let y = if is_phase {
        Axis::new("phase, degrees", -180.0, 180.0)
    } else {
        Axis::new(&format!("radius, {}", units.length_unit()), 0.0, 1.05 * top.max(f64::MIN_POSITIVE))
    };
    let x = Axis::new(units.pick("spin speed R", "spin speed, rpm"), units.speed(range.from), units.speed(range.to));
    Chart { title, x, y, equal: false, series, notes: Vec::new() }
}
