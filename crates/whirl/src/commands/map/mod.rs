//! `whirl map`: a quantity over a plane of two parameters.

mod basins;
mod live;
mod picture;
mod shown;

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use study::map::{self, MapAxis, MapError, MapKey, MapPlan, MapQuantity, QUANTITIES};
use study::sweep::Task;
use study::table::{Form, FormError};
use units::Dimension;
use variation::Model;

use super::linear;
use crate::catalog::{self, Machine};
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::{BelowArgs, MachineArgs};
use crate::output::{self, Format};
use crate::picture::is_picture;
use crate::place::Force;
use crate::quantity::{self, TypedQuantity};
use crate::range::Range;
use crate::varied::{By, Varied};
use basins::Basins;
use live::Live;
use shown::{Shown, dimension_of, quantity_unit, unit};

/// Cells of a map of linear quantities, and of one that is simulated, if nobody says.
const POINTS: [Points; 2] = [Points { x: 81, y: 61 }, Points { x: 31, y: 21 }];

/// How many cells a map has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Points {
    x: usize,
    y: usize,
}

impl std::str::FromStr for Points {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let count = |typed: &str| typed.trim().parse().ok().filter(|count| (2..=1_000_000).contains(count));
        let made = typed.split_once(['x', 'X']).and_then(|(x, y)| Some(Self { x: count(x)?, y: count(y)? }));
        made.ok_or_else(|| format!("'{typed}': expected NxM with at least 2 of either, such as 80x60"))
    }
}

/// Options of `whirl map`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("written").args(["out"]))]
pub(crate) struct MapArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    below: BelowArgs,
    /// Spin speed R = w / w0 where no axis is it (SI rotors: in rpm)
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Speed))]
    speed: Option<TypedQuantity>,
    /// What varies across: a setting as for `--set`, a parameter of the rotor such as damping.1, a start such as start.1.y, or an impulse
    /// on the settled motion such as impulse.1.vy
    #[arg(long, value_name = "KEY=A..B")]
    x: Varied,
    /// What varies up, likewise
    #[arg(long, value_name = "KEY=A..B")]
    y: Varied,
    /// How many values across and up [default: 81x61; 31x21 where every cell is simulated]
    #[arg(long, value_name = "NxM")]
    points: Option<Points>,
    /// What is mapped
    #[arg(long, value_name = "NAME", value_parser = quantity, default_value = "damping")]
    quantity: MapQuantity,
    /// A simulated motion that has not settled by then is told as it is then, in tau (SI rotors: in s)
    #[arg(long, value_name = "T", value_parser = quantity::of(Dimension::Time))]
    duration: Option<TypedQuantity>,
    /// Write the map as a picture (.svg, .png) or a table (.csv, .parquet)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    format: Format,
}

fn quantity(typed: &str) -> Result<MapQuantity, String> {
    let known =
        || QUANTITIES.iter().map(|row| format!("{} ({})", row.name, row.meaning)).collect::<Vec<_>>().join(", ");
    let row = QUANTITIES.iter().find(|row| row.name == typed);
    row.map(|row| row.quantity).ok_or_else(|| format!("expected {}", known()))
}

/// Maps.
///
/// # Errors
/// A machine or an axis that cannot be, an interrupt, or a file that cannot be written.
pub(crate) fn run(args: &MapArgs) -> Result<(), Failure> {
    let form = args.out.as_deref().map(|path| table_form(path, args.force)).transpose()?;
    let plan = plan(args)?;
    let (machine, plan) = (&plan.0, &plan.1);
    plan.check()?;
    if !plan.quantity.has_clearance() {
        linear::neglects(&args.machine);
    }
    let stop = interrupt::flag()?;
    let live = Live::of(machine, plan);
    let map = map::map(plan, &stop, &|cell, value| live.took(cell, value));
    live.end();
    let map = map?;
    let basins = Basins::of(plan, &stop)?;
    let shown = Shown { machine, plan, map: &map, basins: &basins };
    match (&args.out, form) {
        (Some(path), Some(Some(form))) => shown.write(path, form, args.force)?,
        (Some(path), _) => picture::draw(&shown, path, args.force)?,
        _ => {}
    }
    if args.format.json {
        return shown.print_json();
    }
    if args.format.csv {
        return shown.print_csv();
    }
    let text = picture::text(&shown, std::io::stdout().is_terminal());
    output::print_text(&format!("{text}{}\n", machine.with_taken(&shown.footer()).trim_end_matches('\n')))
}

/// The cells of a map as rows, for a sweep.
///
/// # Errors
/// A machine or an axis that cannot be, or options that are of no use there.
pub(crate) fn task(args: &MapArgs) -> Result<Task, Failure> {
    if args.out.is_some() || args.format.json || args.format.csv {
        return Err(Failure::Usage(
            "--out, --json and --csv are of no use in a sweep: its shards are the result".into(),
        ));
    }
    let (machine, plan) = plan(args)?;
    plan.check()?;
    let [x, y] = [&plan.x, &plan.y].map(|axis| unit(&machine, &axis.key));
    let units = [x, y, quantity_unit(&machine, plan.quantity)];
    Ok(Task::Map { plan, units })
}

/// The form of a table that a path asks for; `None` of a picture.
fn table_form(path: &Path, force: Force) -> Result<Option<Form>, Failure> {
    force.check(path)?;
    if is_picture(path) {
        return Ok(None);
    }
    match Form::of(path) {
        Ok(form) => Ok(Some(form)),
        Err(FormError::Unknown(path)) => Err(Failure::Usage(format!(
            "'{}': expected a file name that ends in .svg, .png, .csv or .parquet",
            path.display()
        ))),
        Err(error @ FormError::NoParquet) => Err(Failure::Usage(error.to_string())),
    }
}

/// The machine, and what is to be mapped of it.
fn plan(args: &MapArgs) -> Result<(Machine, MapPlan), Failure> {
    let is_speed = |varied: &Varied| varied.key == "speed";
    let along = [&args.x, &args.y].into_iter().any(is_speed);
    match (args.speed, along) {
        (Some(_), true) => {
            return Err(Failure::Usage("--speed does nothing: an axis is the speed. Expected one of the two".into()));
        }
        (None, false) => {
            return Err(Failure::Usage(
                "--speed: expected the spin speed, or an axis that is it: --x speed=A..B".into(),
            ));
        }
        _ => {}
    }
    if along {
        args.machine.leaves_speed_alone("an axis")?;
    }
    for (name, varied) in [("--x", &args.x), ("--y", &args.y)] {
        let sets = |typed: &&String| rotor::typed::pair(typed).is_ok_and(|(key, _)| key == varied.key);
        if let Some(typed) = args.machine.set.iter().find(sets) {
            return Err(Failure::Usage(format!("'{typed}' does nothing: {name} is the same. Expected one of the two")));
        }
    }
    let machine = Machine::open(&args.machine, args.speed, catalog::Default::Analysis)?;
    let model = Model::new(machine.rotor.clone(), machine.settings.clone());
    let points = args.points.unwrap_or(POINTS[usize::from(args.quantity.row().is_simulated)]);
    let axis = |varied: &Varied, count: usize| -> Result<MapAxis, Failure> {
        let key = MapKey::of(&model, &varied.key)?;
        let range = match (&key, &varied.by) {
            (MapKey::Parameter(_), _) => {
                let range = crate::varied::range(&machine, &model, varied)?;
                Range { from: range.from, to: range.to }
            }
            (MapKey::Start { .. } | MapKey::Impulse { .. }, By::Part(_)) => {
                return Err(Failure::Usage(format!("'{}': a part of it is nothing; give a range", varied.key)));
            }
            (key, By::Range(ends)) => {
                let unit = unit(&machine, key);
                let ends = crate::varied::read(&varied.key, ends, dimension_of(key))?;
                machine.units().read_ends(1.0, &varied.key, ends, |alone| alone / unit)?
            }
        };
        // Memory is not asked for before it is known to be there.
        let cells = points.x as u64 * points.y as u64;
        if cells > map::MOST_CELLS {
            return Err(MapError::Cells(cells).into());
        }
        Ok(MapAxis { key, values: range.points(count) })
    };
    let duration = args.duration.map(|typed| machine.units().read("--duration", typed)).transpose()?;
    if let Some(duration) = duration.filter(|duration| !(duration.is_finite() && *duration > 0.0)) {
        return Err(Failure::Usage(format!("--duration {duration}: expected a finite number above 0")));
    }
    if args.duration.is_some() && !args.quantity.row().is_simulated {
        let name = args.quantity.row().name;
        return Err(Failure::Usage(format!("--duration does nothing: {name} is not simulated")));
    }
    let [x, y] = [axis(&args.x, points.x)?, axis(&args.y, points.y)?];
    // One set of modes all over the map, or it would change where a mode is left out.
    let speeds = [(&args.x, &x), (&args.y, &y)].into_iter().filter(|(varied, _)| is_speed(varied));
    let top = speeds.filter_map(|(_, axis)| axis.values.last().copied()).next().unwrap_or(machine.settings.speed);
    let plan = MapPlan {
        model: counting(args, model, top)?,
        x,
        y,
        quantity: args.quantity,
        longest: duration.unwrap_or(study::force::LONGEST),
    };
    Ok((machine, plan))
}

/// The machine with the modes that its damping is told of, `top` being the highest speed of the map.
fn counting(args: &MapArgs, model: Model, top: f64) -> Result<Model, Failure> {
    let is_damping = args.quantity == MapQuantity::Damping;
    if args.below.below.is_some() && !is_damping {
        let name = args.quantity.row().name;
        return Err(Failure::Usage(format!("--below does nothing: {name} is of no modes. Expected it beside damping")));
    }
    match args.below.modes(&model.rotor, &model.settings, top) {
        Ok(modes) => Ok(model.counting(modes)),
        // Without poles at the top of the map those count in each cell that count at its speed.
        Err(Failure::Work(_)) if args.below.below.is_none() => Ok(model),
        Err(error) => Err(error),
    }
}

impl From<MapError> for Failure {
    fn from(error: MapError) -> Self {
        match error {
            MapError::Machine(error) => error.into(),
            MapError::Program(error) => error.into(),
            MapError::Run(error) => error.into(),
            MapError::Cycles(error) => error.into(),
            MapError::Interrupted => Self::Interrupted,
            error => Self::Usage(error.to_string()),
        }
    }
}
