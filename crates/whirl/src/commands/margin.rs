//! `whirl margin`: how far the loop is from instability, at one speed or at the worst of a range, and of a machine that is not quite
//! what is thought.

mod margins_told;
mod simulated;
mod unsure;

use ::linear::{AmplitudePeak, CertifiedPeak, PeakProof};
use machine::{
    BearingMargins, ISO_14839_3, MachineLoop, MarginsError, WORST, margins, sensitivity_zone, worst_margins,
};
use serde::Serialize;
use serde_json::{Map, Value, json};
use units::Dimension;

use super::linear;
use crate::catalog::{self, Machine};
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::{BelowArgs, MachineArgs, Whole, counted};
use crate::output::{Cell, Format, Table, rounded};
use crate::quantity::{self, QuantityRange, TypedQuantity};
use crate::units::{CommandUnits, UnitsDocument};
use margins_told::{COLUMNS, COLUMNS_SI, MarginsTold, WITHOUT};
use unsure::Unsure;

/// How many speeds of a range are looked at, if nobody says.
const POINTS: u32 = 201;

/// Options of `whirl margin`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("speeds").required(true).args(["speed", "over"]))]
pub(crate) struct MarginArgs {
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    whole: Whole,
    /// Spin speed R = w / w0 (SI rotors: in rpm)
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Speed))]
    speed: Option<TypedQuantity>,
    /// The worst over spin speeds R, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Speed))]
    over: Option<QuantityRange>,
    /// How many speeds of the range, evenly spaced; the worst is sought between them too [default: 201]
    #[arg(long, value_name = "N", requires = "over", value_parser = clap::value_parser!(u32).range(2..=20_000))]
    points: Option<u32>,
    /// Peaks of sensitivity at which zones A, B and C end [default: 3,4,5, those of ISO 14839-3]
    #[arg(long, value_name = "A,B,C", value_delimiter = ',', num_args = 1)]
    zones: Option<Vec<f64>>,
    #[command(flatten)]
    unsure: Unsure,
    #[command(flatten)]
    below: BelowArgs,
    #[command(flatten)]
    format: Format,
}

/// The JSON document of one speed.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    speed: f64,
    stable: bool,
    min_damping: f64,
    /// The damping of modes with `|lambda|` up to this counts, in radians per tau; of a chain all do.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    #[serde(flatten)]
    margins: Map<String, Value>,
    /// One a control bearing, with the others closed.
    bearings: Vec<Value>,
    #[serde(flatten)]
    unsure: Map<String, Value>,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// The JSON document of a range.
#[derive(Debug, Serialize)]
struct OverDocument<'a> {
    rotor: &'a str,
    over: [f64; 2],
    checked: usize,
    stable: bool,
    /// The damping of modes with `|lambda|` up to this counts, in radians per tau; of a chain all do.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    /// For each margin all of them at the speed where it is worst.
    worst: Map<String, Value>,
    #[serde(flatten)]
    units: UnitsDocument,
}

impl From<MarginsError> for Failure {
    fn from(error: MarginsError) -> Self {
        Self::Work(error.to_string())
    }
}

/// Prints the margins.
///
/// # Errors
/// A machine that cannot be made or is not stable, or poles that cannot be had.
pub(crate) fn run(args: &MarginArgs) -> Result<(), Failure> {
    interrupt::end_at_once()?;
    let zones = zones(args.zones.as_deref())?;
    linear::neglects(&args.machine);
    if let Some(over) = args.over {
        return run_over(args, over, zones);
    }
    let machine = Machine::open(&args.machine, args.speed, catalog::Default::Analysis)?.whole(args.whole)?;
    let (rotor, units) = (&machine.rotor, machine.units());
    let modes = args.below.modes(rotor, &machine.settings, machine.settings.speed)?;
    let found = margins(rotor, &machine.settings, machine.settings.speed).map_err(|error| told(&error, units))?;
    let min_damping = modes.min_damping(found.poles.iter().copied());
    let told = MarginsTold::of_all(&found, units, zones, machine.bearing_mass());
    let feedback = &machine.settings.feedback;
    let name =
        |k: usize| feedback.bearings[k].name.clone().unwrap_or_else(|| rotor.place_name(feedback.bearings[k].station));
    let columns = units.pick(&COLUMNS, &COLUMNS_SI);
    let several = found.bearings.len() > 1;
    let mut table = if several { Table::new(&[&columns[..], &["bearing"]].concat()) } else { Table::new(columns) };
    let mut rows = |told: &MarginsTold<'_>, of: &str| {
        for kind in 0..WORST.len() {
            let mut row = told.row(kind, None);
            row.extend(several.then(|| Cell::from(&of)));
            table.row(row);
        }
    };
    // Of several bearings the bound is that of the worst mixture of their commands.
    // A proof that is below what was found is none.
    let largest = found.together.as_ref().map_or(found.margins.sensitivity(), |together| together.largest_sensitivity);
    let certified = certified(&machine, found.speed)
        .filter(|proven| proven.below >= largest.amplitude * (1.0 - 1e-6))
        .map(|proven| CertifiedPeak { below: proven.below.max(largest.amplitude), ..proven });
    let mut bearings = Vec::with_capacity(found.bearings.len());
    rows(&told, "all");
    for (k, BearingMargins { margins, force }) in found.bearings.iter().enumerate() {
        let mass = rotor.control_mass(feedback.bearings[k].station);
        let own = MarginsTold { speed: found.speed, margins, force: *force, units, zones, mass };
        if several {
            rows(&own, &name(k));
        }
        let mut fields = Map::new();
        fields.insert("name".into(), json!(name(k)));
        fields.extend(own.fields());
        if !several {
            put_certified(&mut fields, "sensitivity", certified.as_ref());
        }
        bearings.push(Value::Object(fields));
    }
    let mut fields = told.fields();
    if let Some(together) = &found.together {
        let largest = together.largest_sensitivity;
        fields.insert("largest_sensitivity".into(), json!({"peak": largest.amplitude, "frequency": largest.frequency}));
    }
    put_certified(&mut fields, if several { "largest_sensitivity" } else { "sensitivity" }, certified.as_ref());
    let document = Document {
        rotor: rotor.name(),
        speed: found.speed,
        stable: true,
        min_damping,
        below: modes.below(),
        margins: fields,
        bearings,
        unsure: Map::new(),
        units: units.document(),
    };
    let heading =
        format!("{}: margins at {}, deadband neglected", rotor.name(), units.speed_text(machine.settings.speed));
    let unsure = args.unsure.told(&machine, modes)?;
    let document = Document { unsure: unsure.fields, ..document };
    let table = unsure.rows.filter(|_| args.format.csv).unwrap_or(table);
    let above = certified.as_ref().map_or(String::new(), |peak| {
        let how = match peak.proof {
            PeakProof::Hamiltonian => "by its Hamiltonian matrix",
            PeakProof::Covered => "by bounds over the whole axis",
        };
        let what = if several { "a largest singular value of S" } else { "a sensitivity" };
        format!("no frequency has {what} above {} ({how})\n", rounded(peak.below))
    });
    let which = counted(&modes, units).map_or(String::new(), |told| format!("{told}\n"));
    let mixed = found.together.as_ref().map_or(String::new(), |together| {
        let AmplitudePeak { amplitude, frequency } = together.largest_sensitivity;
        let at = frequency
            .map_or("far out".to_owned(), |w| format!("at {}{}", rounded(units.frequency(w)), units.pick("", " Hz")));
        let zone = sensitivity_zone(amplitude, zones);
        format!("all commands opened at once: largest singular value of S {}, zone {zone}, {at}\n", rounded(amplitude))
    });
    let is_open = machine.settings.feedback.is_off();
    let none = if is_open { "there is no feedback: the loop has no gain, and nothing to lose\n" } else { "" };
    let footer =
        format!("minimum damping {}\n{none}{which}{mixed}{above}{}", rounded(min_damping), told.remarks(&machine));
    let footer = footer + "\n" + &unsure.text;
    args.format.print(&document, &heading, &table, &machine.with_taken(&footer))
}

/// The samples of a machine as rows, for a sweep.
///
/// # Errors
/// A machine that cannot be made, or no samples.
pub(crate) fn task(args: &MarginArgs) -> Result<study::sweep::Task, Failure> {
    if args.format.json || args.format.csv {
        return Err(Failure::Usage("--json and --csv are of no use in a sweep: its shards are the result".into()));
    }
    let machine = Machine::open(&args.machine, args.speed, catalog::Default::Analysis)?.whole(args.whole)?;
    let modes = args.below.modes(&machine.rotor, &machine.settings, machine.settings.speed)?;
    args.unsure.task(&machine, modes)
}

/// What no frequency exceeds; nothing of a sampled loop, or where there is no bound.
fn certified(machine: &Machine, speed: f64) -> Option<CertifiedPeak> {
    MachineLoop::at(&machine.rotor, &machine.settings, speed).ok()?.certified_peak().ok()?
}

/// Why there is no bound of the sensitivity.
const NO_BOUND: &str = "no bound is known of a loop that is sampled or has more than 100 states, nor where rounding, or a delay of several bearings, leaves it unsure";

/// Writes it beside the peak of the sensitivity: `below`, or why there is none.
fn put_certified(fields: &mut Map<String, Value>, name: &str, certified: Option<&CertifiedPeak>) {
    let Some(sensitivity) = fields.get_mut(name) else { return };
    sensitivity["below"] = json!(certified.map(|peak| peak.below));
    match certified.map(|peak| peak.proof) {
        Some(PeakProof::Hamiltonian) => sensitivity["proof"] = json!("hamiltonian"),
        Some(PeakProof::Covered) => sensitivity["proof"] = json!("covered"),
        None => sensitivity["below_null"] = json!(NO_BOUND),
    }
}

fn run_over(args: &MarginArgs, over: QuantityRange, zones: [f64; 3]) -> Result<(), Failure> {
    let (machine, range) = Machine::open_over(&args.machine, over)?;
    let machine = machine.whole(args.whole)?;
    let (rotor, units) = (&machine.rotor, machine.units());
    let speeds = range.points(args.points.unwrap_or(POINTS) as usize);
    let modes = args.below.modes(rotor, &machine.settings, range.to)?;
    let worst = worst_margins(rotor, &machine.settings, &speeds).map_err(|error| told(&error, units))?;
    let columns = units.pick(&COLUMNS, &COLUMNS_SI);
    let mut table = Table::new(&[&columns[..], &[units.pick("at R", "at (rpm)")]].concat());
    let mut fields = Map::new();
    let mut remarks = String::new();
    for (kind, (name, found)) in WORST.iter().zip(&worst).enumerate() {
        let key = name.replace(' ', "_");
        let Some(found) = found else {
            table.row([Cell::from(name), Cell::Without("none"), Cell::from(&""), Cell::Without(""), Cell::Without("")]);
            fields.insert(key.clone(), Value::Null);
            fields.insert(format!("{key}_null"), json!(WITHOUT[kind]));
            continue;
        };
        let told = MarginsTold::of_all(found, units, zones, machine.bearing_mass());
        table.row(told.row(kind, Some(found.speed)));
        let mut all = Map::new();
        all.insert("speed".into(), json!(found.speed));
        all.insert("min_damping".into(), json!(modes.min_damping(found.poles.iter().copied())));
        all.extend(told.fields());
        fields.insert(key, Value::Object(all));
        remarks = told.remarks(&machine);
    }
    let document = OverDocument {
        rotor: rotor.name(),
        over: [range.from, range.to],
        checked: speeds.len(),
        stable: true,
        below: modes.below(),
        worst: fields,
        units: units.document(),
    };
    let heading = format!("{}: worst margins for {}, deadband neglected", rotor.name(), units.range_text(over));
    let footer =
        format!("stable at all {} speeds looked at; each worst is pinned down between them\n{remarks}", speeds.len());
    args.format.print(&document, &heading, &table, &machine.with_taken(&footer))
}

/// An unstable loop is refused with its pole, in the units of the machine.
pub(super) fn told(error: &MarginsError, units: CommandUnits) -> Failure {
    match error {
        MarginsError::Unstable { speed, pole } => Failure::Work(format!(
            "the machine is not stable at {}: it has a pole at {} {:+.6} j {}, so its loop has no margins",
            units.speed_text(*speed),
            rounded(units.rate(pole.re)),
            units.rate(pole.im),
            units.pick("per tau", "per s")
        )),
        MarginsError::Poles(_) => Failure::Work(error.to_string()),
    }
}

fn zones(typed: Option<&[f64]>) -> Result<[f64; 3], Failure> {
    let Some(typed) = typed else { return Ok(ISO_14839_3) };
    match typed {
        [a, b, c] if 1.0 <= *a && a < b && b < c && c.is_finite() => Ok([*a, *b, *c]),
        _ => Err(Failure::Usage("--zones: expected three rising numbers from 1 on, such as 3,4,5".into())),
    }
}
