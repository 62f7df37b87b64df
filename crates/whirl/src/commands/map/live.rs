//! A map while it fills: on the terminal that errors go to, drawn anew now and then over itself, and gone when the map is whole.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use study::map::{Map, MapPlan};

use super::basins::Basins;
use super::{Shown, picture};
use crate::catalog::Machine;

/// Time between two drawings; a map that is whole before the first is over is never drawn half.
const BETWEEN: Duration = Duration::from_millis(150);

/// A map that fills.
pub(super) struct Live<'a> {
    machine: &'a Machine,
    plan: &'a MapPlan,
    /// What is known of every cell, as bits; not a number where nothing is. None where nobody looks.
    cells: Vec<AtomicU64>,
    known: AtomicU64,
    drawn: Mutex<Drawn>,
}

struct Drawn {
    at: Instant,
    /// Lines that stand on the terminal.
    lines: usize,
}

impl<'a> Live<'a> {
    /// A map of which nothing is known.
    pub(super) fn of(machine: &'a Machine, plan: &'a MapPlan) -> Self {
        let count = if std::io::stderr().is_terminal() { plan.cells() } else { 0 };
        Self {
            machine,
            plan,
            cells: (0..count).map(|_| AtomicU64::new(f64::NAN.to_bits())).collect(),
            known: AtomicU64::new(0),
            drawn: Mutex::new(Drawn { at: Instant::now(), lines: 0 }),
        }
    }

    /// A cell is known.
    pub(super) fn took(&self, cell: u64, value: f64) {
        let Some(place) = self.cells.get(cell as usize) else { return };
        place.store(value.to_bits(), Ordering::Relaxed);
        let known = self.known.fetch_add(1, Ordering::Relaxed) + 1;
        // Whoever draws is let draw: nobody waits for a picture.
        if let Ok(mut drawn) = self.drawn.try_lock()
            && drawn.at.elapsed() >= BETWEEN
        {
            self.draw(&mut drawn, known);
        }
    }

    fn draw(&self, drawn: &mut Drawn, known: u64) {
        let numbers: Vec<f64> = self.cells.iter().map(|bits| f64::from_bits(bits.load(Ordering::Relaxed))).collect();
        let values = numbers.chunks(self.plan.y.values.len()).map(<[f64]>::to_vec).collect();
        let map = Map { values, settled: vec![], boundary: vec![] };
        let shown = Shown { machine: self.machine, plan: self.plan, map: &map, basins: &Basins::default() };
        let text = format!("{}{known} of {} cells\n", picture::text(&shown, true), self.cells.len());
        let _ = write!(std::io::stderr(), "{}{}", rubbed_out(drawn.lines), text.replace('\n', "\x1b[K\n"));
        *drawn = Drawn { at: Instant::now(), lines: text.lines().count() };
    }

    /// Rubs it out.
    pub(super) fn end(&self) {
        if let Ok(drawn) = self.drawn.lock()
            && drawn.lines > 0
        {
            let _ = write!(std::io::stderr(), "{}", rubbed_out(drawn.lines));
        }
    }
}

/// What takes so many lines above off the terminal.
fn rubbed_out(lines: usize) -> String {
    if lines == 0 { String::new() } else { format!("\x1b[{lines}A\r\x1b[J") }
}
