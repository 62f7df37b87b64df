//! `whirl modes`: mode shapes, as numbers and as the orbits that Figs. 4.3 to 4.5 draw.

mod shapes;

use std::path::PathBuf;

use machine::MachinePoles;
use rotor::{C64, Mode, Modes};
use serde::Serialize;
use units::Dimension;

use super::linear::{self, ComplexDocument, PoleDocument};
use crate::catalog::{self, Machine};
use crate::failure::Failure;
use crate::machine_args::{MachineArgs, Whole};
use crate::output::{Cell, Format, Table, print_text};
use crate::picture;
use crate::place::Force;
use crate::quantity::{self, TypedQuantity};
use crate::units::{CommandUnits, UnitsDocument};

/// Options of `whirl modes`.
#[derive(Debug, clap::Args)]
pub(crate) struct ModesArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    whole: Whole,
    /// Spin speed R = w / w0 (SI rotors: in rpm)
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Speed))]
    speed: TypedQuantity,
    /// Points of an orbit, the last of which ends the whirl period, with --json or --csv [default: 65]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..))]
    points: Option<u16>,
    /// Draw the slowest modes along the rotor into a file that ends in .svg or .png
    #[arg(long, value_name = "FILE", group = "written")]
    out: Option<PathBuf>,
    /// Draw them in the terminal, in place of the table
    #[arg(long, conflicts_with_all = ["json", "csv", "out"])]
    draw: bool,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speed: f64,
    modes: Vec<ModeDocument>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// One mode. `orbits[i]` is the path of mass i + 1 over one whirl period, `p_i = shape_i exp(lambda tau)`: an exact solution of
/// the linear rotor, which spirals in or out by `exp(-log_dec)` a turn and closes on a threshold.
#[derive(Debug, Serialize)]
struct ModeDocument {
    #[serde(flatten)]
    pole: PoleDocument,
    /// `null` for a pole on the real axis, as are the orbits.
    period: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    period_null: Option<&'static str>,
    shape: Vec<ComplexDocument>,
    orbits: Option<Vec<Vec<OrbitPoint>>>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct OrbitPoint {
    tau: f64,
    y: f64,
    z: f64,
}

/// The points of an orbit if nobody says how many.
const POINTS: u16 = 65;

/// The period of a mode's whirl.
fn period(mode: &Mode) -> Option<f64> {
    Some(std::f64::consts::TAU / mode.frequency()).filter(|period| period.is_finite())
}

/// The path of each mass over one period; none if it leaves the range of numbers.
fn orbits(mode: &Mode, points: u16) -> Option<Vec<Vec<OrbitPoint>>> {
    let period = period(mode)?;
    let point = |shape: C64, i: u16| {
        let tau = period * f64::from(i) / f64::from(points - 1);
        let p = shape * (mode.pole * tau).exp();
        OrbitPoint { tau, y: p.re, z: p.im }
    };
    let orbits: Vec<Vec<_>> = mode.shape.iter().map(|&shape| (0..points).map(|i| point(shape, i)).collect()).collect();
    orbits.iter().flatten().all(|p| p.y.is_finite() && p.z.is_finite()).then_some(orbits)
}

/// Prints the mode shapes.
///
/// # Errors
/// A machine that cannot be made, or eigenvalues that do not converge.
pub(crate) fn run(args: &ModesArgs) -> Result<(), Failure> {
    if args.points.is_some() && !args.format.json && !args.format.csv {
        return Err(Failure::Usage("--points: the orbits are in the output of --json and --csv alone".into()));
    }
    let points = args.points.unwrap_or(POINTS);
    let machine = Machine::open(&args.machine, Some(args.speed), catalog::Default::Analysis)?.whole(args.whole)?;
    linear::neglects(&args.machine);
    let (Machine { rotor, settings, .. }, units) = (&machine, machine.units());
    if let Some(path) = &args.out {
        picture::check(path, args.force)?;
    }
    let linear = MachinePoles::of(rotor, settings)?.into_modes();
    let charts = || shapes::charts(rotor, &linear.modes, units);
    if let Some(path) = &args.out {
        picture::draw(path, args.force, &charts())?;
    }
    let document = Document {
        rotor: rotor.name(),
        speed: settings.speed,
        modes: linear
            .modes
            .iter()
            .map(|mode| {
                let orbits = orbits(mode, points);
                ModeDocument {
                    pole: mode.into(),
                    period: orbits.as_ref().and(period(mode)),
                    period_null: orbits
                        .is_none()
                        .then_some("the pole is real or all but real: there is no orbit to draw"),
                    shape: mode.shape.iter().map(|&p| p.into()).collect(),
                    orbits,
                }
            })
            .collect(),
        units: units.document(),
    };
    let heading = format!(
        "{} at {}, deadband neglected; largest mass 1, phase in degrees",
        rotor.name(),
        units.speed_text(settings.speed)
    );
    if args.draw {
        return print_text(&format!("{heading}\n{}", picture::in_terminal(&charts())));
    }
    let footer =
        "orbit: p = shape exp(lambda tau); negative phase lags in the sense of the spin; points with --json or --csv";
    let table = if args.format.csv { orbit_table(&linear, points, units) } else { shape_table(&linear, &machine) };
    args.format.print(&document, &heading, &table, &machine.with_taken(footer))
}

/// For people: one row a mode and mass.
fn shape_table(linear: &Modes, machine: &Machine) -> Table {
    let (units, place) = (machine.units(), machine.place_heading());
    let mut table = Table::new(&units.pick(
        ["mode", "re", "im", "whirl", "period", place, "radius", "phase"],
        ["mode", "re (1/s)", "im (rad/s)", "whirl", "period (s)", place, "radius", "phase"],
    ));
    for (k, mode) in linear.modes.iter().enumerate() {
        for (i, p) in mode.shape.iter().enumerate() {
            // What is rounding reads as the zero that it stands for.
            let tidy = |x: f64| if x.abs() < 1e-12 { 0.0 } else { x };
            let (radius, phase) = (tidy(p.norm()), tidy(p.arg().to_degrees()));
            let phase = if radius == 0.0 { 0.0 } else { phase };
            let of_mode = [mode.pole.re, mode.pole.im].map(|part| Cell::from(units.rate(part)));
            let [re, im] = if i == 0 { of_mode } else { [Cell::from(&""), Cell::from(&"")] };
            let (name, whirl, period) = if i == 0 {
                let period = period(mode).map_or_else(|| Cell::Without("none"), |tau| units.time(tau).into());
                (Cell::from(&(k + 1)), Cell::from(&mode.whirl()), period)
            } else {
                (Cell::from(&""), Cell::from(&""), Cell::from(&""))
            };
            table.row([name, re, im, whirl, period, machine.place_cell(i), radius.into(), phase.into()]);
        }
    }
    table
}

/// For spreadsheets: one row an orbit point.
fn orbit_table(linear: &Modes, points: u16, units: CommandUnits) -> Table {
    let time = units.pick("tau", "t (s)");
    let mut table = Table::new(&["mode", "mass", time, "y", "z"]);
    for (k, mode) in linear.modes.iter().enumerate() {
        for (i, orbit) in orbits(mode, points).into_iter().flatten().enumerate() {
            for p in orbit {
                table.row([
                    Cell::from(&(k + 1)),
                    Cell::from(&(i + 1)),
                    units.time(p.tau).into(),
                    p.y.into(),
                    p.z.into(),
                ]);
            }
        }
    }
    table
}
