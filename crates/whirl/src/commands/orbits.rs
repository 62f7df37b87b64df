//! What `whirl response` and `whirl cycles` share: sweeps over speed for exact circular orbits, and their tables.

use rotor::circular::{Circular, Orbit};
use serde::Serialize;

use crate::catalog::Machine;
use crate::failure::Failure;
use crate::machine_args::MachineArgs;
use crate::output::{Cell, rounded};
use crate::range::Range;
use crate::units::Units;

/// The most speeds there can be: all orbits of a long rotor at more of them no longer fit into 200 MB.
const MOST_POINTS: i64 = 20_000;

/// The speeds, and settings that have no option of their own.
#[derive(Debug, clap::Args)]
pub(super) struct SweepArgs {
    /// Spin speeds R, both ends included (SI rotors: in rpm)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    over: Range,
    /// How many speeds, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 61, value_parser = clap::value_parser!(u32).range(1..=MOST_POINTS))]
    points: u32,
    /// Any other setting, such as deadband.2=0.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl SweepArgs {
    /// The machine, and the speeds `R`, all of them in range.
    pub(super) fn prepare(&self, machine: &MachineArgs) -> Result<(Machine, Vec<f64>), Failure> {
        if let Some(assignment) = self.set.iter().find(|assignment| assignment.starts_with("speed=")) {
            return Err(Failure::Usage(format!("{assignment}: the speeds are those of --over")));
        }
        let (mut machine, over) = Machine::open_over(machine, self.over)?;
        machine.set(&self.set)?;
        Ok((machine, over.points(self.points as usize)))
    }
}

/// The orbits at one speed.
#[derive(Debug, Serialize)]
pub(super) struct PointDocument<Branch> {
    speed: f64,
    branches: Vec<Branch>,
}

/// All orbits, speed by speed.
pub(super) fn points<'a, Branch: From<&'a Orbit>>(found: &'a Circular) -> Vec<PointDocument<Branch>> {
    let point = |(&speed, orbits): (&f64, &'a Vec<Orbit>)| PointDocument {
        speed,
        branches: orbits.iter().map(Into::into).collect(),
    };
    found.speeds.iter().zip(&found.orbits).map(point).collect()
}

/// Masses in contact, counted from 1.
pub(super) fn contact(orbit: &Orbit) -> Vec<usize> {
    (0..orbit.amplitude.len()).filter(|k| orbit.contact >> k & 1 == 1).map(|k| k + 1).collect()
}

/// `name`, and behind it the unit in parentheses if the numbers are in SI units.
pub(super) fn heading(name: &str, units: Units, si: &str) -> String {
    units.pick(name.to_owned(), format!("{name} ({si})"))
}

/// Headings of a table of orbits: `first`, the radii mass by mass, `last`.
pub(super) fn headings(first: &[String], masses: usize, last: &[String], units: Units) -> Vec<String> {
    let radii = (1..=masses).map(|k| heading(&format!("r{k}"), units, "m"));
    first.iter().cloned().chain(radii).chain(last.iter().cloned()).collect()
}

/// The radii of an orbit as shown, mass by mass.
pub(super) fn radii(orbit: &Orbit, units: Units) -> impl Iterator<Item = Cell> {
    orbit.radii().into_iter().map(move |radius| units.length(radius).into())
}

/// `deadband 1, 0, 1 e_t`, or in m.
pub(super) fn deadband_text(machine: &Machine) -> String {
    let units = machine.units();
    let typed: Vec<f64> = machine.settings.deadband.iter().map(|g| units.length(*g)).collect();
    format!("deadband {} {}", listed(&typed), units.length_unit())
}

/// Speeds as shown, with their name or unit: `R = 1, 2`, or `300, 600 rpm`.
pub(super) fn speeds_text(speeds: &[f64], units: Units) -> String {
    let shown = listed(&speeds.iter().map(|speed| units.speed(*speed)).collect::<Vec<_>>());
    units.pick(format!("R = {shown}"), format!("{shown} rpm"))
}

/// `stable` or `unstable`.
pub(super) fn stability(orbit: &Orbit) -> &'static str {
    if orbit.is_stable() { "stable" } else { "unstable" }
}

/// Numbers for people, separated by commas.
fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|n| rounded(*n)).collect::<Vec<_>>().join(", ")
}
