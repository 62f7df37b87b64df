//! `whirl drill`: faults on a running bench, one at a time, and a row of them over time.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use machine::StabilityLoss;
use rotor::Key;
use serde::Serialize;
use telemetry::drill::{BUILTIN, Drill, DrillError, DrillLog, Fault, FaultOrder, OVER, builtin, read_drill};
use telemetry::units::ScreenUnits;
use wire::{BenchName, BenchStatus, Glance, HostState, Listener, WireError};

use crate::asking::{NotAccepted, SettingsRequest};
use crate::attach::{self, BenchArgs};
use crate::catalog::{self, FileError};
use crate::failure::Failure;
use crate::output::{Cell, Table};
use crate::{interrupt, output};

/// How long the events of a run may take to come: they are handed out ten times a second.
const NEWS: Duration = Duration::from_secs(2);
/// How often to look whether it is time, or over.
const LOOK: Duration = Duration::from_millis(10);

/// Options of `whirl drill`.
#[derive(Debug, clap::Args)]
pub(crate) struct DrillArgs {
    /// A fault, a built-in drill, a drill file, or off, which puts the fault back; without it, what there is
    #[arg(value_name = "NAME|FILE")]
    name: Option<String>,
    /// Where a fault is: the number or name of a mass or control bearing
    #[arg(long, value_name = "PLACE", requires = "name")]
    at: Option<String>,
    /// How large it is, in the units of the bench
    #[arg(long, value_name = "SIZE", requires = "name", allow_hyphen_values = true)]
    size: Option<String>,
    #[command(flatten)]
    bench: BenchArgs,
    /// Make the fault even if a stable machine becomes unstable by it
    #[arg(long, requires = "name")]
    force: bool,
    /// Print JSON, one object a change
    #[arg(long)]
    json: bool,
}

/// A change that a drill has made, as scripts read it.
#[derive(Debug, Serialize)]
struct Made {
    /// The step of the drill; a fault alone has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<String>,
    /// The fault as it was asked for; `null` where it was put back.
    fault: Option<String>,
    /// What changed, by key, dimensionless: before and after.
    changed: Vec<ChangedDocument>,
    revision: u64,
    applied_at_step: u64,
    /// What changed, for people.
    #[serde(skip)]
    told: String,
}

#[derive(Debug, Serialize)]
struct ChangedDocument {
    key: String,
    was: f64,
    is: f64,
}

impl From<DrillError> for Failure {
    fn from(error: DrillError) -> Self {
        Self::Usage(error.to_string())
    }
}

/// Holds a drill, or a fault, or says what there is.
///
/// # Errors
/// No such fault or drill, a file that is wrong, no such bench, or a change that is refused.
pub(crate) fn run(args: &DrillArgs) -> Result<(), Failure> {
    let Some(name) = &args.name else { return list(args) };
    let of_fault = args.at.is_some() || args.size.is_some();
    let wanted = Wanted::named(name, args)?;
    if of_fault && !matches!(wanted, Wanted::Fault(_)) {
        return Err(Failure::Usage(format!("--at and --size are of a fault, and '{name}' is none")));
    }
    let stop = interrupt::flag()?;
    let mut bench = DrilledBench::attach(args)?;
    match wanted {
        Wanted::Off => {
            let made = bench.put_back()?.ok_or_else(|| {
                Failure::Work("no fault of a drill is there, as far as the events of the bench tell".into())
            })?;
            tell(&made, args.json)
        }
        Wanted::Fault(order) => {
            let made = bench.inject(&order, None)?;
            tell(&made, args.json)?;
            if args.json { Ok(()) } else { output::print_text("`whirl drill off` puts it back\n") }
        }
        Wanted::Drill(drill) => hold(&mut bench, &drill, args.json, &stop),
    }
}

/// What is asked for.
enum Wanted {
    Off,
    Fault(FaultOrder),
    Drill(Drill),
}

impl Wanted {
    fn named(name: &str, args: &DrillArgs) -> Result<Self, Failure> {
        if name == "off" {
            return Ok(Self::Off);
        }
        if let Some(drill) = builtin(name) {
            return drill.map(Self::Drill).map_err(|faults| Failure::Work(faults.in_file(name)));
        }
        if catalog::is_file(name) {
            let text = catalog::text(name)?;
            return read_drill(&text).map(Self::Drill).map_err(|faults| FileError::wrong(name, &text, faults).into());
        }
        let fault = Fault::named(name).map_err(|error| {
            let drills: Vec<&str> = BUILTIN.iter().map(|(name, _)| *name).collect();
            Failure::Usage(format!("{error}; a drill ({}), a file, or off", drills.join(", ")))
        })?;
        let mut order = FaultOrder { fault, at: args.at.clone(), size: None };
        order.size = args.size.as_deref().map(|size| order.read_size(size)).transpose()?;
        Ok(Self::Fault(order))
    }
}

/// Says what there is.
fn list(args: &DrillArgs) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct DrillEntry {
        name: String,
        meaning: String,
        at: &'static str,
        size: &'static str,
    }
    let faults = Fault::ALL.into_iter().map(|fault| DrillEntry {
        name: fault.name().to_owned(),
        meaning: fault.meaning().to_owned(),
        at: fault.place(),
        size: fault.size(),
    });
    let drills = BUILTIN.iter().filter_map(|(name, _)| builtin(name)?.ok());
    let drills = drills.map(|drill| DrillEntry { name: drill.name, meaning: drill.about, at: "", size: "" });
    let rows: Vec<DrillEntry> = faults.chain(drills).collect();
    if args.json {
        return output::print_json(&rows);
    }
    let mut table = Table::new(&["fault or drill", "what it is", "--at", "--size"]);
    for row in &rows {
        table.row([Cell::from(&row.name), Cell::from(&row.meaning), Cell::from(&row.at), Cell::from(&row.size)]);
    }
    output::print_text(&table.to_text())
}

fn tell(made: &Made, json: bool) -> Result<(), Failure> {
    if json {
        return output::print_json(made);
    }
    let Made { step, fault, told, revision, applied_at_step, .. } = made;
    let what = step.as_deref().or(fault.as_deref()).unwrap_or(OVER);
    output::print_text(&format!("{what}: {told}; revision {revision} from step {applied_at_step}\n"))
}

/// Holds a drill from its first step to its end, and leaves nothing of it however it ends.
fn hold(bench: &mut DrilledBench, drill: &Drill, json: bool, stop: &AtomicBool) -> Result<(), Failure> {
    let began = Instant::now();
    let held = drill.steps.iter().try_for_each(|step| {
        bench.wait_until(began + Duration::from_secs_f64(step.at), stop)?;
        let made = match &step.fault {
            Some(order) => Some(bench.inject(order, Some(&step.name))?),
            None => bench.put_back()?.map(|made| Made { step: Some(step.name.clone()), ..made }),
        };
        made.map_or(Ok(()), |made| tell(&made, json))
    });
    let held = held.and_then(|()| bench.wait_until(began + Duration::from_secs_f64(drill.end), stop));
    if let Err(Failure::Bench(_)) = held {
        return held;
    }
    let back = bench.put_back()?;
    back.map_or(Ok(()), |made| tell(&made, json))?;
    held
}

/// A bench, and what is known of its drills.
struct DrilledBench {
    name: BenchName,
    listener: <wire::SharedMemory as wire::Carrier>::Listener,
    commander: <wire::SharedMemory as wire::Carrier>::Commander,
    status: Box<BenchStatus>,
    log: DrillLog,
    who: String,
    force: bool,
}

impl DrilledBench {
    fn attach(args: &DrillArgs) -> Result<Self, Failure> {
        let name = args.bench.name()?;
        let carrier = attach::carrier("drill")?;
        let mut listener = attach::listen(&carrier, &name)?;
        let commander = attach::command(&carrier, &name)?;
        let status = attach::first_bench_status(&mut listener, &name)?;
        let (who, force) = (format!("drill:{}", std::process::id()), args.force);
        let mut made = Self { name, listener, commander, status, log: DrillLog::default(), who, force };
        made.look()?;
        Ok(made)
    }

    /// Takes in what the bench has told.
    fn hear(&mut self) -> Result<(), Failure> {
        let Self { listener, log, .. } = self;
        listener.drain(|_| ())?;
        listener.events(|event| log.push(event))?;
        if let Some(status) = listener.bench_status()? {
            self.status = status;
        }
        Ok(())
    }

    /// The same, until the events have told as much as the bench status.
    fn look(&mut self) -> Result<(), Failure> {
        let began = Instant::now();
        loop {
            self.hear()?;
            if self.log.known_up_to() >= (self.status.run_id, self.status.revision) || began.elapsed() > NEWS {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn wait_until(&mut self, then: Instant, stop: &AtomicBool) -> Result<(), Failure> {
        while Instant::now() < then {
            if stop.load(Ordering::Relaxed) {
                return Err(Failure::Interrupted);
            }
            self.hear()?;
            if self.listener.host() == HostState::Gone {
                return Err(WireError::NoBench(self.name.clone()).into());
            }
            std::thread::sleep(LOOK.min(then.saturating_duration_since(Instant::now())));
        }
        Ok(())
    }

    /// Makes a fault, in place of the one that is there.
    fn inject(&mut self, order: &FaultOrder, step: Option<&str>) -> Result<Made, Failure> {
        let made = self.change(&order.cause(), |bench, rotor, units| {
            let settings = bench.status.settings.get();
            Ok(order.changes(rotor, settings, (units, ScreenUnits::setting_in_files), bench.log.active())?)
        })?;
        Ok(Made { step: step.map(str::to_owned), fault: Some(order.to_string()), ..made })
    }

    /// Puts the fault back that is there, if one is.
    fn put_back(&mut self) -> Result<Option<Made>, Failure> {
        self.look()?;
        if self.log.active().is_none() {
            return Ok(None);
        }
        let back =
            |bench: &Self, _: &_, _: &_| Ok(bench.log.active().map_or_else(Vec::new, |active| active.back.clone()));
        self.change(OVER, back).map(Some)
    }

    /// Has values changed for a reason, judged by the newest settings.
    fn change(
        &mut self,
        why: &str,
        of: impl Fn(&Self, &rotor::Rotor, &ScreenUnits) -> Result<Vec<(Key, f64)>, Failure>,
    ) -> Result<Made, Failure> {
        let who = self.who.clone();
        let mut asking = SettingsRequest::new(&who, why);
        loop {
            self.look()?;
            let rotor = self.status.rotor().map_err(|error| Failure::Work(error.to_string()))?;
            let before = self.status.settings.get().clone();
            let units = ScreenUnits::of_machine(&rotor, &before.feedback);
            let mut settings = before.clone();
            for (key, value) in of(self, &rotor, &units)? {
                settings.set(key, value)?;
            }
            if !self.force
                && why != OVER
                && let Some(loss) = StabilityLoss::between(&rotor, &before, &settings, self.status.present_speed())
            {
                return Err(Failure::Work(format!("not changed: {loss}; --force makes it all the same")));
            }
            let base_revision = self.status.revision;
            let told = units.difference(&before, &settings);
            let values = |(key, was): (Key, f64)| {
                let is = settings.get(key).ok().filter(|is| *is != was)?;
                Some(ChangedDocument { key: settings.label(key), was, is })
            };
            let keys = settings.keys().into_iter().filter_map(|key| Some((key, before.get(key).ok()?)));
            let changed = keys.filter_map(values).collect();
            let answer = asking.ask(&mut self.commander, base_revision, settings).map_err(|why| match why {
                NotAccepted::Unanswered(silence) => attach::unanswered(&silence),
                NotAccepted::Refused(reason) => Failure::Work(format!("not changed: {reason}")),
                NotAccepted::Failed(failure) => failure,
            })?;
            if let Some(answer) = answer {
                // What comes next is judged by what is in force now.
                let heard = Instant::now();
                while self.status.revision < answer.revision && heard.elapsed() < NEWS {
                    self.hear()?;
                    std::thread::sleep(Duration::from_millis(1));
                }
                let (revision, applied_at_step) = (answer.revision, answer.applied_at_step);
                return Ok(Made { step: None, fault: None, changed, revision, applied_at_step, told });
            }
            std::thread::sleep(LOOK);
        }
    }
}
