//! The gains that were found, and corners, as a table.

use rotor::GainKind;
use tuner::Tuned;

use crate::output::{Cell, Table, rounded};

/// What the `k`-th of all signals is called: its number, and of several bearings the bearing's name before its number there.
fn signal_name(tuned: &Tuned, k: usize) -> String {
    match tuned.feedback.place_of_signal(k).filter(|_| tuned.feedback.bearings.len() > 1) {
        Some((bearing, place)) => format!("{}.{}", tuned.feedback.label(bearing), place + 1),
        None => (k + 1).to_string(),
    }
}

/// The gains, one a row; a scheduled one as its file says it.
pub(super) fn gains(tuned: &Tuned) -> Table {
    let mut table = Table::new(&["signal", "gain", "value"]);
    for (k, signal) in tuned.feedback.signals().enumerate() {
        let name = signal_name(tuned, k);
        for kind in GainKind::ALL {
            let value = match signal.gain(kind) {
                rotor::Gain::Constant(value) => Cell::from(*value),
                rotor::Gain::Linear { at_zero, slope } => Cell::from(&format!("{} {:+.6} R", rounded(*at_zero), slope)),
                rotor::Gain::Table(points) => {
                    let each: Vec<String> = points.iter().map(|(r, v)| format!("{r}: {}", rounded(*v))).collect();
                    Cell::from(&each.join("  "))
                }
            };
            table.row([Cell::from(&name), Cell::from(&kind.name()), value]);
        }
    }
    table
}

/// The same for spreadsheets: a number a row, of a scheduled gain with the speed where it is that; linear between two.
pub(super) fn gains_in_rows(tuned: &Tuned, (from, to): (f64, f64)) -> Table {
    let mut table = Table::new(&["signal", "gain", "speed", "value"]);
    for (k, signal) in tuned.feedback.signals().enumerate() {
        let name = signal_name(tuned, k);
        for kind in GainKind::ALL {
            let gain = signal.gain(kind);
            let points: Vec<(Cell, f64)> = match gain {
                rotor::Gain::Constant(value) => vec![(Cell::Without("any"), *value)],
                rotor::Gain::Linear { .. } => [from, to].map(|speed| (speed.into(), gain.at(speed))).to_vec(),
                rotor::Gain::Table(points) => points.iter().map(|(speed, value)| ((*speed).into(), *value)).collect(),
            };
            for (speed, value) in points {
                table.row([Cell::from(&name), Cell::from(&kind.name()), speed, value.into()]);
            }
        }
    }
    table
}
