//! A rig instead of a simulation: plays a CSV file of a real machine as if it were live, so that dashboards, recorders and alarms work on it.
//!
//! ```text
//! cargo run -p wire --example rig -- measured.csv --rotor rotor.toml --bench rig --rate 1000
//! ```
//!
//! The file has a line of names and then a line a step. The names are those of the channels (docs/book/src/protocol.md): `y1` and `z1` of every mass must
//! be there; `tau`, `speed`, `angle`, `uy`, `uz` and the rest may be. What is not measured is told so far as it follows from what is: velocities are
//! differences of displacements, readings are the displacements, and what does not follow is 0. Only a model knows poles: of a rig none are
//! told, and its rotor, a file, is there for names, masses and units alone. At its end the file begins anew, as another turn of the same run.
//!
//! A real rig does the same with what its sensors say in place of a file.

#![allow(clippy::print_stdout, reason = "it says how it went")]

use std::collections::HashMap;
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use rotor::{Rotor, Settings, builtin};
use wire::message::BenchStatusMessage;
use wire::{
    Answer, BenchStatus, Carrier, Change, Channel, Column, Event, Happening, Host, Inbox, NewsSender, Request, Root,
    RowMut, SettingsDocument, SharedMemory, StateSender, Step, StepLayout, Text,
};

/// How often it says how it stands.
const HEARTBEAT: Duration = Duration::from_millis(100);

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("expected a CSV file")?;
    let mut options: HashMap<String, String> = HashMap::new();
    while let (Some(name), Some(value)) = (arguments.next(), arguments.next()) {
        options.insert(name, value);
    }
    let option = |name: &str| options.get(name).map(String::as_str);
    let rotor = match option("--rotor") {
        Some(path) => rotor::file::read_rotor(&std::fs::read_to_string(path)?, path)?,
        None => builtin::rotor("three-mass").ok_or("built in")?,
    };
    let rate: f64 = option("--rate").unwrap_or("1000").parse()?;
    let turns: usize = option("--turns").map_or(Ok(usize::MAX), str::parse)?;
    let measured = Measured::read(Path::new(&file), StepLayout::new(rotor.len()))?;
    let carrier = SharedMemory::new(&Root::from_environment()?, "sim")?;
    let host = carrier.host(&option("--bench").unwrap_or("default").parse()?)?;
    println!("{} steps of {file} at {rate}/s", measured.rows.len());
    Rig::new(&rotor, rate, &measured)?.play(&host, &measured, |turn| turn < turns)
}

/// A file of numbers, a row a step.
#[derive(Debug)]
pub(crate) struct Measured {
    columns: Vec<Column>,
    pub(crate) rows: Vec<Vec<f64>>,
    layout: StepLayout,
}

impl Measured {
    /// Reads a CSV file for this layout.
    pub(crate) fn read(path: &Path, layout: StepLayout) -> Result<Self, Box<dyn Error>> {
        let text = std::fs::read_to_string(path)?;
        let mut lines = text.lines().filter(|line| !line.trim().is_empty());
        let names: Vec<&str> = lines.next().ok_or("an empty file")?.split(',').map(str::trim).collect();
        let known: Vec<Column> = layout.number_columns().collect();
        let mut columns = Vec::new();
        for name in &names {
            let found = known.iter().find(|column| column.name() == *name);
            columns.push(*found.ok_or_else(|| {
                let all: Vec<String> = known.iter().map(|column| column.name()).collect();
                format!("column '{name}': expected names among {}", all.join(", "))
            })?);
        }
        for mass in 1..=layout.masses() {
            for axis in ["y", "z"] {
                if !names.contains(&&*format!("{axis}{mass}")) {
                    return Err(format!(
                        "no column '{axis}{mass}': expected y and z of each of {} masses",
                        layout.masses()
                    )
                    .into());
                }
            }
        }
        let mut rows = Vec::new();
        for (at, line) in lines.enumerate() {
            let row: Result<Vec<f64>, _> = line.split(',').map(|number| number.trim().parse::<f64>()).collect();
            let row = row.map_err(|error| format!("line {}: {error}", at + 2))?;
            if row.len() != names.len() || !row.iter().all(|number| number.is_finite()) {
                return Err(format!("line {}: expected {} finite numbers", at + 2, names.len()).into());
            }
            rows.push(row);
        }
        if rows.len() < 2 {
            return Err("expected two steps and more".into());
        }
        Ok(Self { columns, rows, layout })
    }

    fn number(&self, row: usize, channel: Channel, index: usize) -> Option<f64> {
        let place = self.columns.iter().position(|column| column.channel == channel && column.index == index)?;
        Some(self.rows[row][place])
    }

    /// Writes a step: what was measured, and what follows from it. `dtau` is the time of a step.
    pub(crate) fn fill(&self, row: usize, dtau: f64, out: &mut RowMut<'_>) {
        for (column, number) in self.columns.iter().zip(&self.rows[row]) {
            out.set(column.channel, column.index, *number);
        }
        for mass in 0..self.layout.masses() {
            let at = |row, channel| self.number(row, channel, mass).unwrap_or(0.0);
            for (place, velocity, reading) in
                [(Channel::Y, Channel::Vy, Channel::ReadingY), (Channel::Z, Channel::Vz, Channel::ReadingZ)]
            {
                if self.number(row, velocity, mass).is_none() {
                    // Backwards, as of a machine whose next step nobody knows; at the beginning of the file forwards.
                    let (from, to) = if row == 0 { (0, 1) } else { (row - 1, row) };
                    out.set(velocity, mass, (at(to, place) - at(from, place)) / dtau);
                }
                if self.number(row, reading, mass).is_none() {
                    out.set(reading, mass, at(row, place));
                }
            }
        }
    }
}

/// What plays it.
pub(crate) struct Rig {
    status: Box<BenchStatus>,
    dtau: f64,
    rate: f64,
    seq: u64,
    /// Events so far.
    number: u64,
}

impl Rig {
    /// For a rotor, at so many steps a second.
    pub(crate) fn new(rotor: &Rotor, rate: f64, measured: &Measured) -> Result<Self, Box<dyn Error>> {
        let tau = |row| measured.number(row, Channel::Tau, 0);
        let dtau = match (tau(0), tau(1)) {
            (Some(first), Some(second)) if second > first => second - first,
            _ => 0.01,
        };
        // Nobody outside knows the law of a real machine: it is told as off.
        let feedback = builtin::feedback(rotor, "off").ok_or("no feedback")?;
        let speed = measured.number(0, Channel::Speed, 0).unwrap_or(0.0);
        let mut status = Box::new(BenchStatus::from(BenchStatusMessage {
            run_id: wall_ns().rotate_left(20) ^ u64::from(std::process::id()),
            started_ns: wall_ns(),
            pid: std::process::id(),
            version: Text::new(env!("CARGO_PKG_VERSION")),
            rate_hz: rate,
            dtau,
            substeps: 1,
            revision: 1,
            changed_by: Text::new("rig"),
            ..BenchStatusMessage::default()
        }));
        status.set_rotor(rotor);
        status.settings = SettingsDocument::of(&Settings::new(rotor, speed, feedback));
        Ok(Self { status, dtau, rate, seq: 0, number: 0 })
    }

    /// Plays it turn by turn, as long as there is to be one `more`, step by step when each is due.
    pub(crate) fn play(
        mut self,
        host: &impl Host,
        measured: &Measured,
        mut more: impl FnMut(usize) -> bool,
    ) -> Result<(), Box<dyn Error>> {
        let (mut states, mut news, mut inbox) = (host.states(measured.layout)?, host.news()?, host.inbox()?);
        news.event(&self.event(&Happening::Started))?;
        news.event(&self.event(&Happening::Note("a rig plays a file: no poles, and nothing can be set".into())))?;
        let (start, mut beat) = (Instant::now(), None::<Instant>);
        for turn in (0..).take_while(|turn| more(*turn)) {
            for row in 0..measured.rows.len() {
                let due = start + Duration::from_secs_f64(self.seq as f64 / self.rate);
                while let Some(left) = due.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()) {
                    // Notes are taken while there is time; all else is refused.
                    let mut happened = Vec::new();
                    inbox.serve(left.min(Duration::from_millis(5)), |request| self.answer(request, &mut happened))?;
                    happened.iter().try_for_each(|event| news.event(event))?;
                }
                let seq = self.seq;
                let tau = (turn * measured.rows.len() + row) as f64 * self.dtau;
                let run_id = self.status.run_id;
                states.send(1, |_, out| {
                    out.set(Channel::Tau, 0, tau);
                    measured.fill(row, self.dtau, out);
                    if turn > 0 {
                        // Time goes on while the file begins anew.
                        out.set(Channel::Tau, 0, tau);
                    }
                    out.set_word(Channel::RunId, run_id);
                    out.set_word(Channel::Seq, seq);
                    out.set_word(Channel::WallNs, wall_ns());
                    out.set_word(Channel::Revision, 1);
                    self.status.analysis.speed = out.speed();
                })?;
                self.seq += 1;
                if beat.is_none_or(|beat| beat.elapsed() >= HEARTBEAT) {
                    beat = Some(Instant::now());
                    news.welcome()?;
                    self.status.number += 1;
                    self.status.wall_ns = wall_ns();
                    self.status.health.steps = self.seq;
                    self.status.health.subscribers = host.listeners() as u32;
                    news.bench_status(&self.status)?;
                }
            }
        }
        news.event(&self.event(&Happening::Ended))?;
        Ok(())
    }

    fn answer(&mut self, request: &Request, happened: &mut Vec<Event>) -> Answer {
        let answer = match Change::of(request) {
            Ok(Change::Note { text }) => {
                let mut event = self.event(&Happening::Note(text));
                (event.who, event.why) = (request.who, request.why);
                happened.push(event);
                Answer::accepted(1, self.seq, self.seq as f64 * self.dtau)
            }
            _ => Answer::refused(1, "this bench is a rig that plays a file: nothing can be set"),
        };
        Answer { substeps: [1; 2], settings: self.status.settings.hash(), ..answer }
    }

    fn event(&mut self, happening: &Happening) -> Event {
        self.number += 1;
        let mut event = happening.event();
        event.run_id = self.status.run_id;
        event.number = self.number;
        event.seq = self.seq;
        event.tau = self.seq as f64 * self.dtau;
        event.wall_ns = wall_ns();
        event.revision = 1;
        event.settings = self.status.settings.clone();
        event.substeps = 1;
        event.who = Text::new("rig");
        *event
    }
}

fn wall_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos() as u64
}
