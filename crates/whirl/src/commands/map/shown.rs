//! A map with what is shown of it: rows, a document, and what is said below it.

use std::path::Path;

use machine::CountedModes;
use serde::Serialize;
use study::map::{Map, MapAxis, MapKey, MapPlan, MapQuantity};
use study::table::{self, Form};
use units::Dimension;

use super::basins::Basins;
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::machine_args::counted;
use crate::output::{self, Format, rounded};
use crate::place::Force;
use crate::units::UnitsDocument;
use crate::varied;

#[derive(Debug, Serialize)]
struct AxisDocument<'a> {
    key: String,
    values: &'a [f64],
}

/// The JSON document.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    x: AxisDocument<'a>,
    y: AxisDocument<'a>,
    quantity: &'static str,
    /// `[x][y]`; `null` where there is none.
    values: &'a [Vec<f64>],
    values_null: Option<&'static str>,
    /// Of simulated quantities how many cells had not settled: what they tell is of a motion on its way.
    #[serde(skip_serializing_if = "Option::is_none")]
    unsettled: Option<usize>,
    /// `[x][y]`, where some had not.
    #[serde(skip_serializing_if = "Option::is_none")]
    settled: Option<&'a [Vec<bool>]>,
    /// Up to where modes count, `|lambda|` in radians per `tau`, of a map of damping of shafts.
    #[serde(skip_serializing_if = "Option::is_none")]
    below: Option<f64>,
    /// Where the smallest damping is 0, of linear quantities.
    boundary: &'a [Vec<[f64; 2]>],
    /// Of a map of starts and impulses.
    #[serde(flatten)]
    basins: &'a Basins,
    #[serde(flatten)]
    units: UnitsDocument,
}

/// A map with what is shown of it.
pub(super) struct Shown<'a> {
    pub(super) machine: &'a Machine,
    pub(super) plan: &'a MapPlan,
    pub(super) map: &'a Map,
    pub(super) basins: &'a Basins,
}

/// What one of a key is in the unit that it is shown in.
pub(super) fn unit(machine: &Machine, key: &MapKey) -> f64 {
    match key {
        MapKey::Parameter(parameter) => varied::shown(machine, parameter, 1.0),
        key => machine.units().quantity(dimension_of(key), 1.0, 1.0),
    }
}

/// What a key measures.
pub(super) fn dimension_of(key: &MapKey) -> Dimension {
    match key {
        MapKey::Parameter(parameter) => varied::dimension(parameter),
        MapKey::Start { part: 0 | 1, .. } => Dimension::Length,
        MapKey::Start { .. } | MapKey::Impulse { .. } => Dimension::Velocity,
    }
}

/// What one of a quantity is in the unit that it is shown in.
pub(super) fn quantity_unit(machine: &Machine, quantity: MapQuantity) -> f64 {
    let units = machine.units();
    match quantity {
        MapQuantity::Damping | MapQuantity::Stability | MapQuantity::Sensitivity => 1.0,
        MapQuantity::Delay => units.time(1.0),
        MapQuantity::Orbit | MapQuantity::Cycle => units.length(1.0),
        MapQuantity::Force => units.quantity(Dimension::Force, machine.bearing_mass(), 1.0),
        MapQuantity::CycleFrequency => units.frequency(1.0),
    }
}

impl Shown<'_> {
    /// What one of the quantity is in the unit that it is shown in.
    pub(super) fn quantity_unit(&self) -> f64 {
        quantity_unit(self.machine, self.plan.quantity)
    }

    /// An axis as it is shown.
    pub(super) fn shown(&self, axis: &MapAxis) -> Vec<f64> {
        let unit = unit(self.machine, &axis.key);
        axis.values.iter().map(|value| value * unit).collect()
    }

    pub(super) fn columns(&self) -> [String; 3] {
        [self.plan.x.key.name(), self.plan.y.key.name(), self.plan.quantity.row().name.to_owned()]
    }

    /// The same of a table, where each cell says whether its motion had settled.
    fn table_columns(&self) -> Vec<String> {
        let settled = (!self.map.settled.is_empty()).then(|| "settled".to_owned());
        self.columns().into_iter().chain(settled).collect()
    }

    /// The rows of a table.
    fn table_rows(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let settled = self.map.settled.iter().flatten().map(|settled| Some(f64::from(u8::from(*settled))));
        let rows = self.rows().zip(settled.chain(std::iter::repeat(None)));
        rows.map(|(row, settled)| row.into_iter().chain(settled).collect())
    }

    /// How many cells have a value of a motion that had not settled.
    fn unsettled(&self) -> usize {
        let cells = self.map.values.iter().flatten().zip(self.map.settled.iter().flatten());
        cells.filter(|(value, settled)| value.is_finite() && !**settled).count()
    }

    /// Every cell: both keys and the quantity, as they are shown.
    pub(super) fn rows(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let (xs, ys, unit) = (self.shown(&self.plan.x), self.shown(&self.plan.y), self.quantity_unit());
        let rows = self.map.values.iter().zip(xs);
        rows.flat_map(move |(column, x)| {
            let ys = ys.clone();
            column.iter().zip(ys).map(move |(value, y)| [x, y, value * unit])
        })
    }

    pub(super) fn write(&self, path: &Path, form: Form, force: Force) -> Result<(), Failure> {
        let mut to = table::Table::create(path, form, &self.table_columns(), &[], force.existing())?;
        for row in self.table_rows() {
            to.row(&row, &[])?;
        }
        Ok(to.finish()?)
    }

    pub(super) fn print_csv(&self) -> Result<(), Failure> {
        let mut table = output::Table::new(&self.table_columns());
        self.table_rows().for_each(|row| table.row(row.into_iter().map(output::Cell::from)));
        Format { json: false, csv: true }.print(&(), "", &table, "")
    }

    pub(super) fn print_json(&self) -> Result<(), Failure> {
        let is_whole = self.map.values.iter().flatten().all(|value| value.is_finite());
        output::print_json(&Document {
            rotor: self.machine.rotor.name(),
            x: AxisDocument { key: self.plan.x.key.name(), values: &self.plan.x.values },
            y: AxisDocument { key: self.plan.y.key.name(), values: &self.plan.y.values },
            quantity: self.plan.quantity.row().name,
            values: &self.map.values,
            values_null: (!is_whole).then_some(nowhere(self.plan.quantity)),
            unsettled: (!self.map.settled.is_empty()).then(|| self.unsettled()),
            settled: (self.unsettled() > 0).then_some(&self.map.settled),
            below: self.counted().and_then(|modes| modes.below()),
            boundary: &self.map.boundary,
            basins: self.basins,
            units: self.machine.units().document(),
        })
    }

    /// The modes that the damping of every cell is told of.
    pub(super) fn counted(&self) -> Option<CountedModes> {
        self.plan.model.counted_everywhere().filter(|_| self.plan.quantity == MapQuantity::Damping)
    }

    /// The extremes, where they are, and how much is stable.
    pub(super) fn footer(&self) -> String {
        let [x, y, quantity] = self.columns();
        let finite = || self.rows().filter(|row| row[2].is_finite());
        let told = |row: Option<[f64; 3]>, word: &str| {
            row.map_or(String::new(), |[at_x, at_y, value]| {
                format!("{word} {} at {x} = {}, {y} = {}\n", rounded(value), rounded(at_x), rounded(at_y))
            })
        };
        let all = self.map.values.iter().map(Vec::len).sum::<usize>();
        let mut text = told(finite().min_by(|a, b| a[2].total_cmp(&b[2])), "least");
        text += &told(finite().max_by(|a, b| a[2].total_cmp(&b[2])), "largest");
        let without = all - finite().count();
        if without > 0 {
            text += &format!("{without} of {all} cells have no {quantity}: {}\n", nowhere(self.plan.quantity));
        }
        let unsettled = self.unsettled();
        if unsettled > 0 {
            text += &format!(
                "{unsettled} cells of {all} had NOT settled: their {quantity} is that of a motion on its way, see the column settled of --csv\n"
            );
        }
        if matches!(self.plan.quantity, MapQuantity::Damping | MapQuantity::Stability) {
            let stable = finite().filter(|row| row[2] > 0.0).count();
            text += &format!("{stable} of {all} cells are stable\n");
        }
        if !self.map.boundary.is_empty() {
            let pieces = text::number::counted(self.map.boundary.len(), "piece", "pieces");
            text += &format!("the boundary of stability is traced in {pieces}\n");
        }
        text += &self.basins.text(self.quantity_unit(), self.machine.units());
        if let Some(told) = self.counted().and_then(|modes| counted(&modes, self.machine.units())) {
            text += &format!("{told}\n");
        }
        text
    }
}

/// Why a cell has no value.
fn nowhere(quantity: MapQuantity) -> &'static str {
    match quantity {
        MapQuantity::Damping | MapQuantity::Stability => "the poles cannot be had",
        MapQuantity::Delay => "the machine is not stable, or no delay makes it unstable",
        MapQuantity::Sensitivity => "the machine is not stable",
        MapQuantity::Orbit | MapQuantity::Force => "the motion leaves all bounds",
        MapQuantity::Cycle => "the stability of a limit cycle cannot be had",
        MapQuantity::CycleFrequency => "there is no stable limit cycle, or the stability of one cannot be had",
    }
}
