//! `whirl assess`: what standards ask of a machine, line by line, as a table or as a page.

use std::path::{Path, PathBuf};

use serde::Serialize;
use study::assess::{
    AID, Asked, AssessError, Assessment, AssessmentCase, Finding, Grade, Limits, PageWords, Quantity, Where, assess,
};
use units::Dimension;

use crate::catalog::{self, FileError, Machine};
use crate::failure::Failure;
use crate::interrupt;
use crate::machine_args::{BelowArgs, MachineArgs, counted};
use crate::output::{Cell, Format, Table, print_text, rounded};
use crate::place::Force;
use crate::quantity::{self, QuantityRange, TypedQuantity};
use crate::range::Range;
use crate::units::{CommandUnits, UnitsDocument};

/// Options of `whirl assess`.
#[derive(Debug, clap::Args)]
#[command(
    group = clap::ArgGroup::new("written").args(["out"]),
    after_help = "An aid, not a certificate. The log decrement of every mode, cross-coupled stiffness that is borne, critical speeds \
                  with their separation, the response to the residual unbalance, orbit, force and sensitivity, each against what \
                  API 617, API 684, ISO 14839 and ISO 21940 are commonly quoted to ask. --print-limits prints every limit with its origin."
)]
pub(crate) struct AssessArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Spin speeds R that the machine passes, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, required_unless_present = "print_limits", value_parser = quantity::range(Dimension::Speed))]
    over: Option<QuantityRange>,
    /// Of them those at which it stays [default: all of them]
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Speed))]
    operating: Option<QuantityRange>,
    /// Balance quality grade, such as G2.5 (SI rotors)
    #[arg(long, value_name = "GRADE")]
    grade: Option<Grade>,
    /// The cross-coupled stiffness that is expected, in K_t (SI rotors: in N/m)
    #[arg(long, value_name = "Q", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Stiffness))]
    cross_stiffness: Option<TypedQuantity>,
    /// The mass, counted from 1, to which cross-coupled stiffness is added [default: the middle one]
    #[arg(long, value_name = "MASS")]
    cross_at: Option<usize>,
    /// Smallest radial clearance, in e_t (SI rotors: in m) [default: the smallest clearance of a bearing]
    #[arg(long, value_name = "G", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Length))]
    clearance: Option<TypedQuantity>,
    /// The largest force of the control bearing, in w0^2 e_t (SI rotors: in N) [default: the limit of the loop]
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = quantity::of(Dimension::Force))]
    force_limit: Option<TypedQuantity>,
    /// A file of limits, for those that are to be others than the table's
    #[arg(long, value_name = "FILE")]
    limits: Option<String>,
    /// Print every limit with its origin, as such a file to start from, and end
    #[arg(long, exclusive = true)]
    print_limits: bool,
    /// Write a page that ends in .html, with its charts, or in .md
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    below: BelowArgs,
    #[command(flatten)]
    force: Force,
    #[command(flatten)]
    format: Format,
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    over: [f64; 2],
    operating: [f64; 2],
    /// Whether everything that could be judged was passed.
    passed: bool,
    /// The damping of modes with `|lambda|` up to this counts, in radians per tau; of a chain all do.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    lines: Vec<LineDocument<'a>>,
    /// Smallest logarithmic decrement over added cross-coupled stiffness.
    cross_coupling: CrossDocument,
    #[serde(flatten)]
    units: UnitsDocument,
}

#[derive(Debug, Serialize)]
struct LineDocument<'a> {
    what: &'a str,
    found: Option<f64>,
    asked: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    relation: Option<&'static str>,
    unit: &'static str,
    passed: Option<bool>,
    #[serde(rename = "where")]
    place: PlaceDocument,
    source: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<&'a str>,
}

#[derive(Debug, Serialize)]
struct PlaceDocument {
    speed: Option<f64>,
    /// Counted from 1.
    station: Option<usize>,
    frequency: Option<f64>,
}

#[derive(Debug, Serialize)]
struct CrossDocument {
    speed: f64,
    station: usize,
    borne: Option<f64>,
    curve: Vec<[f64; 2]>,
}

impl From<AssessError> for Failure {
    fn from(error: AssessError) -> Self {
        Self::Work(error.to_string())
    }
}

/// Prints the page, and writes it.
///
/// # Errors
/// A machine that cannot be made, limits that are none, or a file that cannot be written.
pub(crate) fn run(args: &AssessArgs) -> Result<(), Failure> {
    interrupt::end_at_once()?;
    if args.print_limits {
        return print_text(&Limits::default().file());
    }
    let limits = match &args.limits {
        None => Limits::default(),
        Some(path) => {
            let text = catalog::text(path)?;
            Limits::read(&text).map_err(|faults| FileError::wrong(path, &text, faults))?
        }
    };
    let Some(over) = args.over else { return Err(Failure::Usage("--over A..B is missing".into())) };
    if let Some(path) = &args.out {
        check(path, args.force)?;
    }
    let (machine, range) = Machine::open_over(&args.machine, over)?;
    let (rotor, units) = (&machine.rotor, machine.units());
    let operating = operating(args, over, range, units)?;
    let positive = |option: &str, typed: Option<TypedQuantity>, mass: f64| match typed {
        None => Ok(None),
        Some(typed) if typed.number().is_finite() && typed.number() > 0.0 => {
            units.read_on(mass, option, typed).map(Some)
        }
        Some(typed) => Err(Failure::Usage(format!("{option} {typed}: expected a finite number above 0"))),
    };
    let cross_at = match args.cross_at {
        None => rotor.len() / 2,
        Some(mass) if (1..=rotor.len()).contains(&mass) => mass - 1,
        Some(mass) => {
            return Err(Failure::Usage(format!("--cross-at {mass}: expected a mass from 1 to {}", rotor.len())));
        }
    };
    if args.grade.is_some() && units.scales().is_none() {
        return Err(Failure::Usage(
            "--grade: expected a rotor in SI units, because a grade is eccentricity times speed in mm/s".into(),
        ));
    }
    let question = AssessmentCase {
        rotor,
        settings: &machine.settings,
        over: [range.from, range.to],
        operating: [operating.from, operating.to],
        cross_at,
        modes: args.below.modes(rotor, &machine.settings, range.to)?,
        cross_stiffness: positive("--cross-stiffness", args.cross_stiffness, 1.0)?,
        grade: args.grade,
        clearance: positive("--clearance", args.clearance, 1.0)?,
        force: positive("--force-limit", args.force_limit, machine.bearing_mass())?,
        limits: &limits,
    };
    let found = assess(&question)?;
    let told = FindingsTold { machine: &machine, units };
    let rows: Vec<[String; 6]> = found.lines.iter().map(|line| told.row(line)).collect();
    let heading = format!("{}: what standards ask, {}", rotor.name(), units.range_text(over));
    let about = told.about(&question, args);
    if let Some(path) = &args.out {
        let words = PageWords {
            title: heading.clone(),
            about: about.clone(),
            columns: COLUMNS.to_vec(),
            rows: rows.iter().map(|row| row.to_vec()).collect(),
        };
        let page = if is_html(path) { found.html(&words) } else { found.markdown(&words) };
        args.force.write(path, page)?;
    }
    let document = told.document(&question, &found);
    let (for_people, sources) = table(rows);
    let table = if args.format.csv { sheet(&document) } else { for_people };
    let footer = [sources, about, vec![AID.to_owned()]].concat().join("\n");
    args.format.print(&document, &heading, &table, &machine.with_taken(&footer))
}

const COLUMNS: [&str; 6] = ["what", "found", "asked", "passed", "where", "source"];

/// The rows as a table for people: each source is a number, told once below it.
fn table(rows: Vec<[String; 6]>) -> (Table, Vec<String>) {
    let mut table = Table::new(&COLUMNS);
    let mut sources: Vec<String> = Vec::new();
    for row in rows {
        let mut cells = row.each_ref().map(Cell::from);
        let [.., source] = &row;
        let at = sources.iter().position(|known| known == source).unwrap_or_else(|| {
            sources.push(source.clone());
            sources.len() - 1
        });
        cells[5] = Cell::from(&format!("[{}]", at + 1));
        table.row(cells);
    }
    (table, sources.iter().enumerate().map(|(at, source)| format!("[{}] {source}", at + 1)).collect())
}

/// The lines as a spreadsheet has them: a number a cell, its unit beside it.
fn sheet(document: &Document<'_>) -> Table {
    let number = |value: Option<f64>| value.map_or(Cell::Without("none"), Cell::from);
    let words = |text: Option<&str>| text.map_or(Cell::Without("none"), |text| Cell::from(&text));
    let mut table = Table::new(&[
        "what",
        "found",
        "relation",
        "asked",
        "unit",
        "passed",
        "speed",
        "station",
        "frequency",
        "note",
        "source",
    ]);
    for line in &document.lines {
        table.row([
            Cell::from(&line.what),
            number(line.found),
            words(line.relation),
            number(line.asked),
            Cell::from(&line.unit),
            line.passed.map_or(Cell::Without("none"), |passed| Cell::from(&passed)),
            number(line.place.speed),
            line.place.station.map_or(Cell::Without("none"), |station| Cell::from(&station)),
            number(line.place.frequency),
            words(line.note),
            Cell::from(&line.source),
        ]);
    }
    table
}

fn is_html(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "html")
}

fn check(path: &Path, force: Force) -> Result<(), Failure> {
    if is_html(path) || path.extension().is_some_and(|end| end == "md") {
        return force.check(path);
    }
    Err(Failure::Usage(format!("'{}': expected a page that ends in .html or .md", path.display())))
}

/// The operating range as typed, which must lie within all speeds.
fn operating(args: &AssessArgs, over: QuantityRange, all: Range, units: CommandUnits) -> Result<Range, Failure> {
    let Some(typed) = args.operating else { return Ok(all) };
    let range = units.read_range("--operating", typed)?;
    let outside = || Failure::Usage(format!("--operating {typed}: expected a range within --over {over}"));
    range.within(all).ok_or_else(outside)
}

/// Lines in the words and units of a person.
struct FindingsTold<'a> {
    machine: &'a Machine,
    units: CommandUnits,
}

impl FindingsTold<'_> {
    /// A number as shown, and its unit.
    fn value(&self, quantity: Quantity, value: f64) -> (f64, &'static str) {
        let units = self.units;
        match quantity {
            Quantity::Number => (value, ""),
            Quantity::Percent => (value, "%"),
            Quantity::Length => (units.length(value), units.length_unit()),
            Quantity::Force => (units.force(value, self.machine.bearing_mass()), units.force_unit()),
            Quantity::Stiffness => (units.stiffness(value), units.stiffness_unit()),
        }
    }

    fn cell(&self, quantity: Quantity, value: f64) -> String {
        let (value, unit) = self.value(quantity, value);
        format!("{} {unit}", rounded(value)).trim_end().to_owned()
    }

    fn place(&self, place: &Where) -> String {
        let speed = place.speed.map(|speed| self.units.speed_text_rounded(speed));
        let station = place.station.map(|station| format!("mass {}", station + 1));
        let frequency = place
            .frequency
            .map(|w| format!("{} {}", rounded(self.units.frequency(w)), self.units.pick("per tau", "Hz")));
        [speed, station, frequency].into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    fn row(&self, line: &Finding) -> [String; 6] {
        let found = match (line.found, &line.note) {
            (Some(found), None) => self.cell(line.quantity, found),
            (Some(found), Some(note)) => format!("{}; {note}", self.cell(line.quantity, found)),
            (None, note) => note.clone().unwrap_or_default(),
        };
        let asked = match line.asked {
            Some(asked) => format!("{} {}", relation(asked), self.cell(line.quantity, asked.value())),
            None => "-".into(),
        };
        let passed = match line.passed {
            Some(true) => "yes",
            Some(false) => "NO",
            None => "-",
        };
        [line.what.clone(), found, asked, passed.into(), self.place(&line.place), line.source.clone()]
    }

    /// What was assessed, and how.
    fn about(&self, question: &AssessmentCase<'_>, args: &AssessArgs) -> Vec<String> {
        let [from, to] = question.operating.map(|speed| self.units.speed_text_rounded(speed));
        let mut about = vec![
            format!(
                "Feedback {}; operating range {from} to {to}; cross-coupled stiffness is added at mass {}.",
                args.machine.feedback.as_deref().unwrap_or(rotor::builtin::analysis_feedback_name(question.rotor)),
                question.cross_at + 1
            ),
            "Decrement, cross-coupling, critical speeds, sensitivity and the response to residual unbalance count every support bearing \
             at its full stiffness; orbit and force are the largest stable circular orbits under the rotor's own unbalance, clearances \
             and all."
                .into(),
        ];
        about.extend(counted(&question.modes, self.units).map(|told| format!("Damping: {told}.")));
        about
    }

    fn document<'a>(&'a self, question: &AssessmentCase<'_>, found: &'a Assessment) -> Document<'a> {
        let lines = found.lines.iter().map(|line| LineDocument {
            what: &line.what,
            found: line.found.map(|value| self.value(line.quantity, value).0),
            asked: line.asked.map(|asked| self.value(line.quantity, asked.value()).0),
            relation: line.asked.map(relation),
            unit: self.value(line.quantity, 0.0).1,
            passed: line.passed,
            place: PlaceDocument {
                speed: line.place.speed,
                station: line.place.station.map(|station| station + 1),
                frequency: line.place.frequency,
            },
            source: &line.source,
            note: line.note.as_deref(),
        });
        Document {
            rotor: self.machine.rotor.name(),
            over: question.over,
            operating: question.operating,
            passed: found.passed(),
            below: question.modes.below(),
            lines: lines.collect(),
            cross_coupling: CrossDocument {
                speed: found.cross_coupling.speed,
                station: found.cross_coupling.station + 1,
                borne: found.cross_coupling.borne,
                curve: found.cross_coupling.curve.iter().map(|(q, decrement)| [*q, *decrement]).collect(),
            },
            units: self.units.document(),
        }
    }
}

fn relation(asked: Asked) -> &'static str {
    match asked {
        Asked::AtLeast(_) => "at least",
        Asked::AtMost(_) => "at most",
    }
}
