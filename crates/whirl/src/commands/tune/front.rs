//! `--pareto`: what damping costs in force or gain, as a table, a picture, and feedback files.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use plot::{Axis, Chart, Color, Look, Series};
use rotor::file::FeedbackDocument;
use serde::Serialize;
use tuner::{ParetoPoint, Price, Stop, WIDEST_PEAK, pareto};

use super::question::Asked;
use super::{TuneArgs, Watch, write_file};
use crate::failure::Failure;
use crate::output::{Cell, Table, rounded};
use crate::picture;
use crate::units::UnitsDocument;

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    price: Price,
    /// Dearest first.
    points: Vec<PointDocument<'a>>,
    /// Wall time, of all of it.
    seconds: f64,
    seed: u64,
    interrupted: bool,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct PointDocument<'a> {
    /// The limit on force, in `w0^2 e_t`, on gains, or on the peak of the sensitivity.
    limit: f64,
    min_damping: f64,
    worst_speed: f64,
    proven: bool,
    max_force: f64,
    max_gain: f64,
    /// The peak of the sensitivity that is reached, where that is the price.
    #[serde(skip_serializing_if = "Option::is_none")]
    peak: Option<f64>,
    feedback: FeedbackDocument<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
}

/// Searches, prints, draws and writes.
pub(super) fn run(args: &TuneArgs, asked: &Asked, flag: &AtomicBool) -> Result<(), Failure> {
    let [(bearing, sensors)] = &asked.choices()[..] else {
        return Err(Failure::Usage("--pareto is for one place: give --bearing and --sensors by number".into()));
    };
    let problem = asked.problem(*bearing, sensors);
    let price: Price = args.pareto.map_or(Price::Force, Into::into);
    let (watch, begun) = (Watch::new(), std::time::Instant::now());
    let front =
        pareto(&problem, price, args.points as usize, &args.options(&problem), &|p| watch.say(p), Stop::when(flag))?;
    watch.end();
    super::answer::known(asked, &front[0].tuned)?;
    let units = asked.units();
    let mass = asked.rotor().control_mass(*bearing);
    let columns = units.pick(
        &["limit", "min damping", "worst speed", "max force", "max gain"],
        &["limit", "min damping", "worst speed (rpm)", "max force (N)", "max gain"],
    );
    let of_peak: &[&str] = if price == Price::Sensitivity { &["peak"] } else { &[] };
    let mut table = Table::new(&[&columns[..], of_peak].concat());
    let mut points = Vec::new();
    for (k, point) in front.iter().enumerate() {
        let tuned = &point.tuned;
        let limit = if price == Price::Force { units.force(point.limit, mass) } else { point.limit };
        let force = units.force(tuned.force, mass);
        let peak = tuned.peak_sensitivity().filter(|_| price == Price::Sensitivity);
        let values = [limit, tuned.worst.value, units.speed(tuned.worst.point[0]), force, tuned.largest_gain()];
        let mut row: Vec<Cell> = values.map(Cell::from).into();
        row.extend((price == Price::Sensitivity).then(|| peak.map_or(Cell::Without("not known"), Cell::from)));
        table.row(row);
        let mut file = None;
        if let Some(folder) = &args.out
            && (tuned.worst.stable() == Some(true) || args.write_unstable)
        {
            std::fs::create_dir_all(folder)
                .map_err(|error| Failure::Usage(format!("cannot make '{}': {error}", folder.display())))?;
            let path = point_file(folder, k + 1);
            let about = format!(
                "point {} of {}: min damping {}, force at most {} {}, gains at most {}",
                k + 1,
                front.len(),
                rounded(tuned.worst.value),
                rounded(force),
                units.force_unit(),
                rounded(point.tuned.largest_gain())
            );
            write_file(&path, args.force, (&tuned.feedback, asked.rotor()), &[about])?;
            file = Some(path.display().to_string());
        }
        points.push(PointDocument {
            limit: point.limit,
            min_damping: tuned.worst.value,
            worst_speed: tuned.worst.point[0],
            proven: tuned.worst.proven,
            max_force: tuned.force,
            max_gain: tuned.largest_gain(),
            peak,
            feedback: FeedbackDocument(&tuned.feedback),
            file,
        });
    }
    if let Some(path) = &args.plot {
        picture::draw(path, args.force, &[chart(asked, price, &front)])?;
    }
    let interrupted = front.iter().any(|point| point.tuned.interrupted);
    let document = Document {
        rotor: asked.rotor().name(),
        price,
        points,
        seconds: begun.elapsed().as_secs_f64(),
        seed: args.seed,
        interrupted,
        units: units.document(),
    };
    let word = match price {
        Price::Force => "control force",
        Price::Gain => "gain",
        Price::Sensitivity => "peak of the sensitivity",
    };
    let footer = match (price, interrupted) {
        (_, true) => "interrupted: what was found until then".to_owned(),
        (Price::Sensitivity, _) => format!("peaks up to {WIDEST_PEAK}: larger ones are no machine's"),
        _ => String::new(),
    };
    let heading = format!("{}, {}: min damping against {word}", asked.rotor().name(), asked.range_text);
    args.format.print(&document, &heading, &table, &footer)?;
    let best = &front[0].tuned;
    if interrupted {
        return Err(Failure::Interrupted);
    }
    super::answer::verdict(asked, best)
}

fn chart(asked: &Asked, price: Price, front: &[ParetoPoint]) -> Chart {
    let mut points: Vec<(f64, f64)> =
        front.iter().map(|point| (price.of(&point.tuned), point.tuned.worst.value)).collect();
    points.reverse();
    let (far, high) = points.iter().fold((0.0_f64, 0.0_f64), |(x, y), p| (x.max(p.0), y.max(p.1)));
    let label = match price {
        Price::Force => "steady control force, linear rotor, w0^2 e_t",
        Price::Gain => "largest gain",
        Price::Sensitivity => "peak of the sensitivity",
    };
    Chart {
        title: format!("{}, {}: what damping costs", asked.rotor().name(), asked.range_text),
        x: Axis::new(label, 0.0, 1.05 * far.max(1e-9)),
        y: Axis::new("min damping ratio", 0.0, 1.1 * high.max(1e-9)),
        equal: false,
        series: vec![
            Series::new("", Look::Solid, Color::BLUE, points.clone()),
            Series::new("", Look::Dots, Color::BLUE, points),
        ],
        notes: Vec::new(),
    }
}

/// The file of a point of the trade, counted from 1.
pub(super) fn point_file(folder: &Path, point: usize) -> PathBuf {
    folder.join(format!("point-{point:02}.toml"))
}
