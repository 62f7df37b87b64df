//! What `whirl response` and `whirl cycles` share: sweeps over speed for exact circular orbits, and their tables.

use rotor::circular::{Circular, Orbit};
use serde::Serialize;
use text::number::counted;
use units::Dimension;

use super::linear::MARGINAL;
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::machine_args::MachineArgs;
use crate::output::{Cell, rounded};
use crate::quantity::{self, QuantityRange};
use crate::units::CommandUnits;

/// The most speeds there can be: all orbits of a long rotor at more of them no longer fit into 200 MB.
const MOST_POINTS: i64 = 20_000;

/// The speeds, and settings that have no option of their own.
#[derive(Debug, clap::Args)]
pub(super) struct SweepArgs {
    /// Spin speeds R, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, value_parser = quantity::range(Dimension::Speed))]
    over: QuantityRange,
    /// How many speeds, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 61, value_parser = clap::value_parser!(u32).range(1..=MOST_POINTS))]
    points: u32,
}

impl SweepArgs {
    /// The machine, and the speeds `R`, all of them in range.
    pub(super) fn prepare(&self, machine: &MachineArgs) -> Result<(Machine, Vec<f64>), Failure> {
        let (machine, over) = Machine::open_over(machine, self.over)?;
        Ok((machine, over.points(self.points as usize)))
    }
}

/// The orbits at one speed.
#[derive(Debug, Serialize)]
pub(super) struct PointDocument<Branch> {
    speed: f64,
    /// Whether it is proven, but for rounding, that there are no other branches.
    complete: bool,
    /// How many orbits of the loop without its limits are left out, because the actuator cannot hold them.
    beyond_limits: usize,
    branches: Vec<Branch>,
}

/// All orbits, speed by speed.
pub(super) fn points<'a, Branch: From<&'a Orbit>>(found: &'a Circular) -> Vec<PointDocument<Branch>> {
    let point = |at: usize| PointDocument {
        speed: found.speeds[at],
        complete: found.complete[at],
        beyond_limits: found.beyond_limits[at],
        branches: found.orbits[at].iter().map(Into::into).collect(),
    };
    (0..found.speeds.len()).map(point).collect()
}

/// How far the list of branches is proven complete.
#[derive(Debug, Serialize)]
pub(super) struct CompletenessDocument {
    /// How many support bearings have stiffness and clearance.
    clearances: usize,
    /// Branches that press on at most this many of them at a time are all found, but for rounding.
    enumerated: usize,
    /// At how many of the speeds nothing can be missing.
    complete: usize,
    /// Where the others come from: `none` are needed, or a `search`, which is no proof.
    others: &'static str,
}

/// What is proven of `found`, where branches on at most `enumerated` bearings at a time are all found; and a line that says so.
pub(super) fn completeness(machine: &Machine, found: &Circular, enumerated: usize) -> (CompletenessDocument, String) {
    let gapped = |(place, g): (usize, &f64)| machine.rotor.has_contact(place) && *g > 0.0;
    let clearances = machine.settings.deadband.iter().enumerate().filter(|of| gapped(*of)).count();
    let (complete, total) = (found.complete.iter().filter(|all| **all).count(), found.complete.len());
    let mut bearings = machine.settings.feedback.bearings.iter();
    let is_limited = bearings.any(|bearing| bearing.parts.limit.min(bearing.parts.slew).is_finite());
    let words = if complete == total {
        "proven complete: no other circular orbit at these speeds, but for rounding".to_owned()
    } else {
        let proven = match complete {
            0 => "NOT proven complete".to_owned(),
            _ => format!("proven complete at {complete} of {total} speeds only"),
        };
        let all = match enumerated {
            0 => String::new(),
            1 => format!(
                "all orbits that press on at most one bearing of the {clearances} with clearance at a time are listed; of those on more, "
            ),
            _ => format!(
                "all orbits that press on at most {enumerated} bearings of the {clearances} with clearance at a time are listed; of those on more, "
            ),
        };
        format!("{proven}: {all}what a search found (homotopy, many starts, continuation), and others may exist")
    };
    let beyond: usize = found.beyond_limits.iter().sum();
    let limits = match (is_limited, beyond) {
        (false, _) => String::new(),
        (true, 0) => "\nthe actuator has limits: orbits at which it reaches them are not sought".to_owned(),
        (true, some) => format!(
            "\nthe actuator has limits: {some} orbits that ask for more than it delivers are left out, and those at which it \
             reaches them are not sought"
        ),
    };
    let mut bearings = machine.settings.feedback.bearings.iter();
    let sensors = if bearings.any(|bearing| bearing.parts.noise > 0.0 || bearing.parts.quantum > 0.0) {
        "\nnoise and resolution of the sensors are left out"
    } else {
        ""
    };
    let words = format!("{words}{limits}{sensors}");
    let others = if complete == total { "none" } else { "search" };
    (CompletenessDocument { clearances, enumerated, complete, others }, words)
}

/// Masses in contact, counted from 1.
pub(super) fn contact(orbit: &Orbit) -> Vec<usize> {
    (0..orbit.amplitude.len()).filter(|k| orbit.contact >> k & 1 == 1).map(|k| k + 1).collect()
}

/// `name`, and behind it the unit in parentheses if the numbers are in SI units.
pub(super) fn heading(name: &str, units: CommandUnits, si: &str) -> String {
    units.pick(name.to_owned(), format!("{name} ({si})"))
}

/// Headings of a table of orbits: `first`, the radii mass by mass, `last`.
pub(super) fn headings(first: &[String], masses: usize, last: &[String], units: CommandUnits) -> Vec<String> {
    let radii = (1..=masses).map(|k| heading(&format!("r{k}"), units, "m"));
    first.iter().cloned().chain(radii).chain(last.iter().cloned()).collect()
}

/// The radii of an orbit as shown, mass by mass.
pub(super) fn radii(orbit: &Orbit, units: CommandUnits) -> impl Iterator<Item = Cell> {
    orbit.radii().into_iter().map(move |radius| units.length(radius).into())
}

/// `deadband 1, 0, 1 e_t`, or in m.
pub(super) fn deadband_text(machine: &Machine) -> String {
    let units = machine.units();
    // Of a chain every mass has one, as in its file; of shaft elements only what has play.
    let tells = |place: usize| machine.rotor.is_chain() || machine.rotor.has_contact(place);
    let places = machine.settings.deadband.iter().enumerate().filter(|(place, _)| tells(*place));
    let typed: Vec<f64> = places.map(|(_, g)| units.length(*g)).collect();
    if typed.is_empty() {
        return "no bearing with play".to_owned();
    }
    format!("deadband {} {}", listed(&typed), units.length_unit())
}

/// Speeds as shown, with their name or unit: `R = 1, 2`, or `300, 600 rpm`.
pub(super) fn speeds_text(speeds: &[f64], units: CommandUnits) -> String {
    let shown = listed(&speeds.iter().map(|speed| units.speed(*speed)).collect::<Vec<_>>());
    units.pick(format!("R = {shown}"), format!("{shown} rpm"))
}

/// How an orbit stands, as scripts read it.
#[derive(Debug, Serialize)]
pub(super) struct JudgedDocument {
    /// `null` where the orbit is marginal, or cannot be judged.
    stable: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stable_null: Option<String>,
    /// Largest real part of the linearised motion in the rotating frame; `null` where it cannot be had.
    growth: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    growth_null: Option<String>,
}

impl From<&Orbit> for JudgedDocument {
    fn from(orbit: &Orbit) -> Self {
        let why = orbit.growth.as_ref().err().map(ToString::to_string);
        let stable = is_stable(orbit);
        let stable_null = stable.is_none().then(|| why.clone().unwrap_or_else(|| MARGINAL.to_owned()));
        Self { stable, stable_null, growth: orbit.growth.as_ref().ok().copied(), growth_null: why }
    }
}

/// Whether it is stable; nothing where that cannot be said.
pub(super) fn is_stable(orbit: &Orbit) -> Option<bool> {
    orbit.stability().ok()?.is_stable()
}

/// `stable`, `marginal`, `unstable` or `unknown`.
pub(super) fn stability(orbit: &Orbit) -> String {
    orbit.stability().map_or_else(|_| "unknown".to_owned(), |stability| stability.to_string())
}

/// How many orbits cannot be judged, and why.
pub(super) fn unjudged(found: &Circular) -> Option<String> {
    let mut why = found.orbits.iter().flatten().filter_map(|orbit| orbit.growth.as_ref().err());
    let first = why.next()?;
    let orbits = counted(1 + why.count(), "orbit", "orbits");
    Some(format!("the stability of {orbits} is unknown: {first}"))
}

/// Numbers for people, separated by commas.
fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|n| rounded(*n)).collect::<Vec<_>>().join(", ")
}
