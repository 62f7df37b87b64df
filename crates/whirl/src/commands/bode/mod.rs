//! `whirl bode`: frequency responses at one speed, and the response to unbalance over speed.

pub(super) mod chart;
mod unbalance;

use std::path::PathBuf;
use std::str::FromStr;

use machine::{FrequencyPoint, MachineLoop, MachinePoles, MarginsError, TransferFunction};
use rotor::C64;
use serde::Serialize;
use units::Dimension;

use super::linear;
use crate::catalog::{self, Machine};
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::{MachineArgs, Whole};
use crate::output::{Cell, Format, Table, print_text, rounded};
use crate::picture;
use crate::place::Force;
use crate::quantity::{self, QuantityRange, TypedQuantity};
use crate::units::{CommandUnits, UnitsDocument};

/// Rows of the table that people see.
const ROWS: usize = 41;

/// Options of `whirl bode`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("written").multiple(true).args(["out"]))]
#[command(group = clap::ArgGroup::new("speeds").required(true).args(["speed", "over"]))]
pub(crate) struct BodeArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    whole: Whole,
    /// Spin speed R = w / w0 (SI rotors: in rpm)
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Speed))]
    speed: Option<TypedQuantity>,
    /// Spin speeds R of the response to unbalance, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Speed))]
    over: Option<QuantityRange>,
    /// Which: the loop's gain, its sensitivity, the closed loop, displacement at a mass per force, or unbalance over speed
    #[arg(long, value_name = "loop|sensitivity|closed|unbalance|station=N", default_value = "loop")]
    of: What,
    /// Frequencies, negative for backward whirl, in radians per tau (SI rotors: in Hz) [default: all that matter]
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Frequency))]
    band: Option<QuantityRange>,
    /// What a picture shows
    #[arg(long, value_enum, default_value_t = Show::Bode, requires = "drawn")]
    show: Show,
    /// Draw it into a file that ends in .svg or .png
    #[arg(long, value_name = "FILE", group = "drawn")]
    out: Option<PathBuf>,
    /// Draw it in the terminal, in place of the table
    #[arg(long, group = "drawn", conflicts_with_all = ["json", "csv"])]
    draw: bool,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    format: Format,
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Show {
    /// Amplitude, and phase below it
    Bode,
    /// Amplitude over frequency
    Amplitude,
    /// Phase over frequency
    Phase,
    /// The response in the complex plane, with -1 and circles of equal sensitivity around it
    Nyquist,
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    /// Over frequency.
    Frequency(TransferFunction),
    /// Over speed.
    Unbalance,
}

impl FromStr for What {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let station = || typed.strip_prefix("station=")?.parse().ok().filter(|n: &usize| *n > 0);
        Ok(match typed {
            "loop" => Self::Frequency(TransferFunction::Loop),
            "sensitivity" => Self::Frequency(TransferFunction::Sensitivity),
            "closed" => Self::Frequency(TransferFunction::Closed),
            "unbalance" => Self::Unbalance,
            _ => match station() {
                Some(n) => Self::Frequency(TransferFunction::Station(n - 1)),
                None => return Err("expected loop, sensitivity, closed, unbalance, or station=N with N from 1".into()),
            },
        })
    }
}

impl std::fmt::Display for What {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Frequency(TransferFunction::Loop) => f.write_str("loop"),
            Self::Frequency(TransferFunction::Sensitivity) => f.write_str("sensitivity"),
            Self::Frequency(TransferFunction::Closed) => f.write_str("closed"),
            Self::Frequency(TransferFunction::Station(n)) => write!(f, "station={}", n + 1),
            Self::Unbalance => f.write_str("unbalance"),
        }
    }
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speed: f64,
    of: String,
    /// Whether the loop is open: its own gain; everything else is of the closed loop.
    open: bool,
    points: Vec<PointDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct PointDocument {
    frequency: f64,
    re: f64,
    im: f64,
    amplitude: f64,
    /// In degrees, from -180 to 180.
    phase: f64,
}

/// Prints the response, and draws it.
///
/// # Errors
/// A machine that cannot be made, a closed loop that is not stable, a file that cannot be written.
pub(crate) fn run(args: &BodeArgs) -> Result<(), Failure> {
    interrupt::end_at_once()?;
    linear::neglects(&args.machine);
    if let Some(path) = &args.out {
        picture::check(path, args.force)?;
    }
    match (args.of, args.speed, args.over) {
        (What::Unbalance, _, Some(over)) => unbalance::run(args, over),
        (What::Unbalance, ..) => Err(Failure::Usage("--of unbalance is over speed: expected --over A..B".into())),
        (What::Frequency(of), Some(speed), _) => frequency(args, of, speed),
        _ => Err(Failure::Usage(format!("--of {} is at one speed: expected --speed R", args.of))),
    }
}

fn frequency(args: &BodeArgs, of: TransferFunction, speed: TypedQuantity) -> Result<(), Failure> {
    let machine = Machine::open(&args.machine, Some(speed), catalog::Default::Analysis)?.whole(args.whole)?;
    let (rotor, units) = (&machine.rotor, machine.units());
    let speed = machine.settings.speed;
    let of = match (of, rotor.beam()) {
        // As everywhere, a number is that of the drawing.
        (TransferFunction::Station(station), Some(beam)) => {
            let known = || {
                let stations = beam.places().iter().filter_map(|place| Some((place.station? + 1).to_string()));
                stations.collect::<Vec<_>>().join(", ")
            };
            let missing = || {
                let (asked, there) = (station + 1, known());
                Failure::Usage(format!("--of station={asked}: expected a station that is simulated: {there}"))
            };
            TransferFunction::Station(beam.coordinate(station).ok_or_else(missing)?)
        }
        _ => of,
    };
    if let TransferFunction::Station(station) = of
        && station >= rotor.len()
    {
        let (asked, there) = (station + 1, rotor.len());
        return Err(Failure::Usage(format!("--of station={asked}: {} has masses 1 to {there}", rotor.name())));
    }
    if of != TransferFunction::Loop {
        let poles = MachinePoles::of(rotor, &machine.settings)?;
        let rightmost = poles.modes.iter().map(|mode| mode.pole).max_by(|a, b| a.re.total_cmp(&b.re));
        if let Some(pole) = rightmost.filter(|pole| pole.re >= 0.0) {
            return Err(super::margin::told(&MarginsError::Unstable { speed, pole }, units));
        }
    }
    let looped = MachineLoop::at(rotor, &machine.settings, speed)?;
    let band = match args.band {
        None => looped.band(),
        Some(typed) => {
            let band = units.read_range("--band", typed)?;
            [band.from, band.to]
        }
    };
    let Some(points) = looped.response(of, band)? else {
        return Err(Failure::Usage(format!(
            "--of {}: through a sampled loop a pure whirl does not stay one: take the samples out with --set sample=off",
            args.of
        )));
    };
    let scale = match of {
        TransferFunction::Station(_) => units.length(1.0) / units.force(1.0, machine.bearing_mass()),
        _ => 1.0,
    };
    let unit = match of {
        TransferFunction::Station(_) => units.pick(" (1 / w0^2)", " (m/N)"),
        _ => "",
    };
    let (what, at, typed) = (name(of, rotor), units.speed_text(speed), args.machine.subtitle());
    let title = format!("{}, {what} at {at}{typed}", rotor.name());
    let charts = || chart::of(&points, &title, args.show, units, scale, unit, of == TransferFunction::Loop);
    if let Some(path) = &args.out {
        picture::draw(path, args.force, &charts())?;
    }
    let frequency = units.pick("frequency", "frequency (Hz)");
    let mut table =
        Table::new(&[frequency, &format!("re{unit}"), &format!("im{unit}"), &format!("amplitude{unit}"), "phase"]);
    // A spreadsheet gets all of them.
    let every = if args.format.csv { 1 } else { points.len().div_ceil(ROWS).max(1) };
    for point in points.iter().step_by(every) {
        let FrequencyPoint { frequency, value } = *point;
        let z = value * scale;
        table.row([units.frequency(frequency), z.re, z.im, z.norm(), degrees(z)].map(Cell::from));
    }
    let largest = points.iter().max_by(|a, b| a.value.norm_sqr().total_cmp(&b.value.norm_sqr()));
    let most = largest.map_or(String::new(), |p| {
        format!(
            "largest of these frequencies: {}{unit} at {}{}",
            rounded(p.value.norm() * scale),
            rounded(units.frequency(p.frequency)),
            units.pick("", " Hz")
        )
    });
    let most = match of {
        TransferFunction::Loop => format!("{most}\n{}", crossing(&points)),
        _ => most,
    };
    let rest = if every > 1 { "\n--csv and --json have every point" } else { "" };
    let document = Document {
        rotor: rotor.name(),
        speed,
        of: args.of.to_string(),
        open: of == TransferFunction::Loop,
        points: points.iter().map(|p| PointDocument::of(p.frequency, p.value)).collect(),
        units: units.document(),
    };
    let heading = format!(
        "{}: {} at {}, deadband neglected; phase in degrees, negative frequencies are backward whirl",
        rotor.name(),
        name(of, rotor),
        units.speed_text(speed)
    );
    if args.draw {
        return print_text(&format!("{heading}\n{}{most}\n", picture::in_terminal(&charts())));
    }
    args.format.print(&document, &heading, &table, &machine.with_taken(&(most + rest)))
}

impl PointDocument {
    fn of(frequency: f64, z: C64) -> Self {
        Self { frequency, re: z.re, im: z.im, amplitude: z.norm(), phase: degrees(z) }
    }
}

/// Whether the loop's gain comes to 1 among these frequencies, where delay and phase margins are.
fn crossing(points: &[FrequencyPoint]) -> &'static str {
    let is_large = |point: &FrequencyPoint| point.value.norm_sqr() > 1.0;
    if points.iter().all(|point| point.value == C64::ZERO) {
        "no crossing: there is no gain at all"
    } else if points.iter().all(is_large) {
        "no crossing: the gain is above 1 at all of these frequencies"
    } else if points.iter().any(is_large) {
        "the gain crosses 1 among these frequencies: whirl margin tells where"
    } else {
        "no crossing: the gain is below 1 at all of these frequencies"
    }
}

fn degrees(z: C64) -> f64 {
    z.arg().to_degrees()
}

/// What a response is, in words.
fn name(of: TransferFunction, rotor: &rotor::Rotor) -> String {
    match of {
        TransferFunction::Loop => "gain of the open loop".into(),
        TransferFunction::Sensitivity => "sensitivity".into(),
        TransferFunction::Closed => "closed loop".into(),
        TransferFunction::Station(station) => {
            format!("displacement of {} per force at the first control bearing", rotor.place_name(station))
        }
    }
}

/// The label of an axis of frequencies.
fn frequency_label(units: CommandUnits) -> &'static str {
    units.pick("|frequency|, rad per unit of τ", "|frequency|, Hz")
}
