//! `whirl tail`: prints live telemetry, one line a step; or what happens, one line an event.
//!
//! A reader that sleeps loses the oldest. What was lost is told where it is missing, and all of it again at the end.

mod events;

use std::fmt::Write as _;
use std::io::Write as _;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use serde::Serialize;
use serde_json::{Map, Value};
use telemetry::units::{ScreenUnits, Unit};
use wire::Channel;
use wire::message::Flags;
use wire::{BenchName, HostState, Listener, SharedListener, Step, WireError};

use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::interrupt;
use crate::output::rounded;

/// Silence after which we look whether the simulation still lives.
const SILENCE: Duration = Duration::from_millis(300);

/// Options of `whirl tail`.
#[derive(Debug, clap::Args)]
pub(crate) struct TailArgs {
    #[command(flatten)]
    bench: BenchArgs,
    /// Print what happens instead, who did it and why: first what has happened so far (the last 64), then what comes
    #[arg(long, conflicts_with = "every")]
    events: bool,
    /// Print every Nth step
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// End after N lines
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    count: Option<u64>,
    /// Print JSON lines
    #[arg(long)]
    json: bool,
}

/// One JSON line.
#[derive(Debug, Serialize)]
struct StepLine {
    seq: u64,
    /// Steps that were sent before this one, after the line before it, and did not reach us.
    lost: u64,
    tau: f64,
    speed: f64,
    masses: Vec<MassDocument>,
    force: ForceDocument,
    revision: u64,
    flags: Vec<String>,
    run_id: String,
    /// The same of an SI rotor in its units.
    #[serde(skip_serializing_if = "Option::is_none")]
    si: Option<InSi>,
    /// Every other channel of the table, by its name in files.
    #[serde(flatten)]
    others: Map<String, Value>,
}

/// Channels that the fields of a line tell of.
const TOLD: [Channel; 12] = [
    Channel::RunId,
    Channel::Seq,
    Channel::Revision,
    Channel::Flags,
    Channel::Tau,
    Channel::Speed,
    Channel::ForceY,
    Channel::ForceZ,
    Channel::Y,
    Channel::Z,
    Channel::Vy,
    Channel::Vz,
];

#[derive(Debug, Serialize)]
struct MassDocument {
    y: f64,
    z: f64,
    vy: f64,
    vz: f64,
}

#[derive(Debug, Serialize)]
struct ForceDocument {
    y: f64,
    z: f64,
}

/// What a line tells, in SI units.
#[derive(Debug, Serialize)]
struct InSi {
    /// Seconds since the machine began to move.
    time: f64,
    speed_rpm: f64,
    /// In m and m/s.
    masses: Vec<MassDocument>,
    /// In N, of the first control bearing.
    force: ForceDocument,
}

impl InSi {
    fn of(state: &impl Step, units: &ScreenUnits) -> Option<Self> {
        let scales = units.scales?;
        let place = |p: wire::Point| {
            let [y, z] = [p.y, p.z].map(|length| scales.metres(length));
            let [vy, vz] = [p.vy, p.vz].map(|velocity| scales.metres(velocity) * scales.w0);
            MassDocument { y, z, vy, vz }
        };
        let [y, z] = state.force_delivered().map(|force| force * units.force.factor);
        Some(Self {
            time: scales.seconds(state.tau()),
            speed_rpm: scales.rpm(state.speed()),
            masses: state.points().map(place).collect(),
            force: ForceDocument { y, z },
        })
    }
}

impl StepLine {
    fn new(state: &impl Step, lost: u64, units: &ScreenUnits) -> Self {
        let [y, z] = state.force_delivered();
        let others = state.layout().columns().zip(state.words()).filter(|(column, _)| !TOLD.contains(&column.channel));
        let value = |channel: Channel, word: u64| {
            if channel.is_number() { Value::from(f64::from_bits(word)) } else { Value::from(word) }
        };
        Self {
            seq: state.seq(),
            lost,
            tau: state.tau(),
            speed: state.speed(),
            masses: state.points().map(|p| MassDocument { y: p.y, z: p.z, vy: p.vy, vz: p.vz }).collect(),
            force: ForceDocument { y, z },
            revision: state.revision(),
            flags: state.flags().names(),
            run_id: format!("{:016x}", state.run_id()),
            si: InSi::of(state, units),
            others: others.map(|(column, word)| (column.name(), value(column.channel, *word))).collect(),
        }
    }
}

/// What has been lost before a line, as a line of its own.
pub(super) fn gap(lost: u64, what: &str) -> String {
    if lost == 0 { String::new() } else { format!("  ... {lost} {what} lost: this was read too slowly ...\n") }
}

/// The same for people, in the units of the machine: step, time, where the masses are, control, and what is special.
fn for_people(state: &impl Step, lost: u64, units: &ScreenUnits) -> String {
    let mut line = gap(lost, "steps");
    let is_si = units.scales.is_some();
    let _ = match units.scales {
        Some(scales) => write!(line, "{:>9}  {:>11.6} s", state.seq(), scales.seconds(state.tau())),
        None => write!(line, "{:>9}  tau {:>10.3}", state.seq(), state.tau()),
    };
    let mut pair = |what: &str, pair: [f64; 2], unit: Unit| {
        let [y, z] = pair.map(|value| rounded(value * unit.factor));
        let name = if is_si { format!(" {unit}") } else { String::new() };
        let _ = write!(line, "  {what}: {y:>10} {z:>10}{name}");
    };
    for (i, p) in state.points().enumerate() {
        pair(&(i + 1).to_string(), [p.y, p.z], units.length);
    }
    pair("u", state.force_delivered(), units.force);
    for flag in [Flags::SATURATED, Flags::TRIPPED, Flags::LATE, Flags::EXTERNAL, Flags::HELD, Flags::COASTING] {
        if state.flags().has(flag) {
            let _ = write!(line, "  {}", flag.names().concat());
        }
    }
    line
}

/// The units of the machine on a bench.
fn units_of(listener: &mut SharedListener, bench: &BenchName) -> Result<ScreenUnits, Failure> {
    let bench_status = attach::first_bench_status(listener, bench)?;
    let rotor = bench_status.rotor().ok();
    let units = rotor.map(|rotor| ScreenUnits::of_machine(&rotor, &bench_status.settings.get().feedback));
    Ok(units.unwrap_or(ScreenUnits::DIMENSIONLESS))
}

/// Prints until the count is reached, a signal comes, or the simulation ends.
///
/// # Errors
/// No such bench, or output that cannot be written.
pub(crate) fn run(args: &TailArgs) -> Result<(), Failure> {
    let bench = args.bench.name()?;
    let stop = interrupt::flag()?;
    let mut listener = attach::listen(&attach::carrier("tail")?, &bench)?;
    let mut printer: Box<dyn Printer> = if args.events {
        let bench_status = attach::first_bench_status(&mut listener, &bench)?;
        let (units, teller) = (
            crate::units::CommandUnits::with(bench_status.scales()),
            events::Teller::of(bench_status.rotor().ok().as_ref()),
        );
        Box::new(Happenings { teller, units, json: args.json })
    } else {
        let units = units_of(&mut listener, &bench)?;
        Box::new(Steps { every: args.every, json: args.json, units, last: None, untold: 0, lost: 0 })
    };
    let mut left = args.count.unwrap_or(u64::MAX);
    let mut lines = String::new();
    let mut heard = Instant::now();
    while left > 0 {
        if stop.load(Ordering::Relaxed) {
            if let Some(lost) = printer.losses() {
                // Whoever interrupts has no use for another exit code, but for the number.
                let _ = writeln!(std::io::stderr(), "whirl: {lost}");
            }
            return Err(Failure::Interrupted);
        }
        lines.clear();
        let came = printer.print(&mut listener, &mut left, &mut lines)?;
        let mut stdout = std::io::stdout().lock();
        stdout.write_all(lines.as_bytes())?;
        stdout.flush()?;
        if came {
            heard = Instant::now();
        } else if heard.elapsed() > SILENCE {
            if listener.host() == HostState::Gone {
                return Err(WireError::NoBench(bench).into());
            }
            heard = Instant::now();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    printer.losses().map_or(Ok(()), |lost| Err(Failure::Work(lost)))
}

/// What is printed of a bench.
trait Printer {
    /// Puts what has arrived in `lines`, at most `left` of them. Returns whether anything has.
    fn print(&mut self, listener: &mut SharedListener, left: &mut u64, lines: &mut String) -> Result<bool, WireError>;
    /// What did not reach us, in words.
    fn losses(&self) -> Option<String>;
}

struct Steps {
    every: u64,
    json: bool,
    /// Those in which people are told; scripts read dimensionless numbers too.
    units: ScreenUnits,
    last: Option<(u64, u64)>,
    /// Lost since the last line.
    untold: u64,
    lost: u64,
}

impl Printer for Steps {
    fn print(&mut self, listener: &mut SharedListener, left: &mut u64, lines: &mut String) -> Result<bool, WireError> {
        let drained = listener.drain(|state| {
            if let Some((run_id, seq)) = self.last
                && run_id == state.run_id()
            {
                let lost = state.seq().saturating_sub(seq + 1);
                self.untold += lost;
                self.lost += lost;
            }
            self.last = Some((state.run_id(), state.seq()));
            if *left > 0 && state.seq() % self.every == 0 {
                *left -= 1;
                let untold = std::mem::take(&mut self.untold);
                if self.json {
                    // A line of plain numbers and words always serialises.
                    *lines += &serde_json::to_string(&StepLine::new(&state, untold, &self.units)).unwrap_or_default();
                } else {
                    *lines += &for_people(&state, untold, &self.units);
                }
                lines.push('\n');
            }
        })?;
        Ok(drained > 0)
    }

    fn losses(&self) -> Option<String> {
        (self.lost > 0).then(|| format!("{} steps were lost: the output was read too slowly", self.lost))
    }
}

struct Happenings {
    teller: events::Teller,
    units: crate::units::CommandUnits,
    json: bool,
}

impl Printer for Happenings {
    fn print(&mut self, listener: &mut SharedListener, left: &mut u64, lines: &mut String) -> Result<bool, WireError> {
        let came = listener.events(|event| {
            if *left > 0 {
                *left -= 1;
                *lines += &self.teller.line(event, self.units, self.json);
                lines.push('\n');
            }
        })?;
        // The steps go on meanwhile, and must not pile up.
        let steps = listener.drain(|_| ())?;
        Ok(came + steps > 0)
    }

    fn losses(&self) -> Option<String> {
        let lost = self.teller.lost;
        (lost > 0).then(|| format!("{lost} events were lost: the output was read too slowly"))
    }
}

#[cfg(test)]
mod tests {
    use wire::{CHANNELS, State, StepLayout};

    use super::*;

    #[test]
    fn a_line_tells_every_channel_of_the_table() {
        let layout = StepLayout::new(2);
        let mut state = State::new(layout);
        for (at, column) in layout.number_columns().enumerate() {
            state = state.with(column.channel, column.index, 0.5 + at as f64);
        }
        let line = serde_json::to_value(StepLine::new(&state, 0, &ScreenUnits::DIMENSIONLESS)).unwrap();
        for column in layout.columns() {
            let told = line[column.name()].as_f64();
            if column.channel.is_number() && !TOLD.contains(&column.channel) {
                assert_eq!(told, Some(state.number(column.channel, column.index)), "{}", column.name());
            }
        }
        // The rest stands in fields of their own: all numbers of the table are there, each once.
        let mut numbers = Vec::new();
        let mut todo = vec![&line];
        while let Some(value) = todo.pop() {
            match value {
                Value::Object(fields) => todo.extend(fields.values()),
                Value::Array(items) => todo.extend(items),
                value => numbers.extend(value.as_f64().filter(|number| number.fract() == 0.5)),
            }
        }
        numbers.sort_by(f64::total_cmp);
        assert!(numbers.iter().copied().eq(state.numbers()), "{line}");
        assert_eq!(CHANNELS.iter().filter(|row| TOLD.contains(&row.channel)).count(), TOLD.len());
    }

    #[test]
    fn val_a_line_of_an_si_rotor_has_its_numbers_in_si_units_beside() {
        // w0 = 300 rad/s, e_t = 20 um, and a quarter of 40 kg at the bearing: 10 kg (300/s)^2 20e-6 m = 18 N.
        let scales = rotor::Scales { w0: 300.0, k_t: 3.6e6, m_t: 40.0, e_t: 20e-6 };
        let mass = |mass| rotor::PhysicalMass { mass, bearing_stiffness: 1.8e6, unbalance: 1e-5, ..Default::default() };
        let two = rotor::Rotor::from_si("two", vec![mass(30.0), mass(10.0)], vec![1e6], None).unwrap();
        let units = ScreenUnits::of(Some(scales), rotor::ControlMasses::of(&two, &rotor::Feedback::new(1, vec![])));
        let state = State::new(StepLayout::new(1)).with_point(0, wire::Point { y: 2.0, z: -1.0, vy: 0.5, vz: 0.0 });
        let state = state.with(Channel::Tau, 0, 30.0).with(Channel::Speed, 0, 1.0).with(Channel::ForceY, 0, 3.0);
        let line = serde_json::to_value(StepLine::new(&state, 0, &units)).unwrap();
        let found = |pointer: &str| line.pointer(pointer).and_then(Value::as_f64).unwrap();
        for (pointer, value) in [
            ("/si/time", 0.1),
            ("/si/speed_rpm", 2864.788975654116),
            ("/si/masses/0/y", 4e-5),
            ("/si/masses/0/z", -2e-5),
            ("/si/masses/0/vy", 3e-3),
            ("/si/force/y", 54.0),
            // As they were.
            ("/tau", 30.0),
            ("/speed", 1.0),
            ("/masses/0/y", 2.0),
            ("/force/y", 3.0),
        ] {
            assert!((found(pointer) / value - 1.0).abs() < 1e-12, "{pointer}: {line}");
        }
        assert!(
            serde_json::to_value(StepLine::new(&state, 0, &ScreenUnits::DIMENSIONLESS)).unwrap().get("si").is_none()
        );
    }
}
