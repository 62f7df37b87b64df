//! Finding a running bench: the options that name it, and the carrier to it.

use std::time::{Duration, Instant};

use wire::{BenchName, BenchStatus, Carrier, Glance, Listener, Root, SharedListener, SharedMemory, StepRow, WireError};

use crate::failure::Failure;
use crate::logging;

/// How long a simulation that is just starting may take to make its bench.
const STARTING: Duration = Duration::from_secs(1);

/// How long a place among those who look or ask is waited for: they come and go.
const ROOM: Duration = Duration::from_secs(5);

/// How long a bench may take to say how it is: it does so ten times a second.
const FIRST_WORD: Duration = Duration::from_secs(3);

/// Which running bench.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct BenchArgs {
    /// Name of the bench
    #[arg(long, value_name = "NAME", default_value = "default")]
    pub(crate) bench: String,
}

impl BenchArgs {
    /// The name, if it is one.
    ///
    /// # Errors
    /// Not a name that a bench can have.
    pub(crate) fn name(&self) -> Result<BenchName, Failure> {
        Ok(self.bench.parse()?)
    }
}

/// The carrier under this user's root, for a process seen as `role`.
///
/// # Errors
/// The root cannot be used.
pub(crate) fn carrier(role: &str) -> Result<SharedMemory, Failure> {
    logging::to_stderr();
    Ok(SharedMemory::new(&Root::from_environment()?, role)?)
}

/// The carrier for a dashboard, whose screen log lines must not reach.
///
/// # Errors
/// The root cannot be used, or the log not be written.
pub(crate) fn dashboard_carrier() -> Result<SharedMemory, Failure> {
    let root = Root::from_environment()?;
    logging::to_file(&root)?;
    Ok(SharedMemory::new(&root, "dash")?)
}

/// Attaches to a bench for its telemetry. One that is not there is waited for a moment: it may have been started in the
/// same breath.
///
/// # Errors
/// No such bench, another version, or no room.
pub(crate) fn listen(
    carrier: &SharedMemory,
    bench: &BenchName,
) -> Result<<SharedMemory as Carrier>::Listener, WireError> {
    patiently(Duration::ZERO, || carrier.listen(bench))
}

/// Attaches to a bench to see how it stands, as [`listen`] does; for this there is always room in the end.
///
/// # Errors
/// No such bench, or another version.
pub(crate) fn glance(
    carrier: &SharedMemory,
    bench: &BenchName,
) -> Result<<SharedMemory as Carrier>::Glance, WireError> {
    patiently(ROOM, || carrier.glance(bench))
}

/// Attaches to a bench to ask it for something, as [`glance`] does.
///
/// # Errors
/// No such bench, or another version.
pub(crate) fn command(
    carrier: &SharedMemory,
    bench: &BenchName,
) -> Result<<SharedMemory as Carrier>::Commander, WireError> {
    patiently(ROOM, || carrier.command(bench))
}

/// Takes the place of the one controller outside of a bench, as [`glance`] attaches.
///
/// # Errors
/// No such bench, another version, or somebody controls it already.
pub(crate) fn controller(
    carrier: &SharedMemory,
    bench: &BenchName,
) -> Result<<SharedMemory as Carrier>::Controller, WireError> {
    patiently(Duration::ZERO, || carrier.controller(bench))
}

/// Attaches with `attach`, again and again while the bench may be starting, and for `room` while it is full.
fn patiently<T>(room: Duration, attach: impl Fn() -> Result<T, WireError>) -> Result<T, WireError> {
    let start = Instant::now();
    loop {
        let patience = match attach() {
            // While its services are being made they may also look as if somebody had died making them.
            Err(WireError::NoBench(_) | WireError::LeftBehind { .. }) => STARTING,
            Err(WireError::Full { .. }) => room,
            Ok(port) => return Ok(port),
            Err(error) => return Err(error),
        };
        if start.elapsed() >= patience {
            return attach();
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The present bench status of a bench.
///
/// # Errors
/// The bench does not speak up.
pub(crate) fn first_bench_status(listener: &mut impl Glance, bench: &BenchName) -> Result<Box<BenchStatus>, Failure> {
    let start = Instant::now();
    loop {
        if let Some(bench_status) = listener.bench_status()? {
            return Ok(bench_status);
        }
        if start.elapsed() > FIRST_WORD {
            return Err(WireError::NoAnswer(bench.clone()).into());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Looks at the motion of a bench for a moment: every step that comes is shown to `see`, as long as `goes_on` says so of the time that has
/// passed and of how many steps have come.
///
/// # Errors
/// The bench cannot be heard, or what `goes_on` ends it with.
pub(crate) fn look_at_motion(
    listener: &mut SharedListener,
    mut see: impl FnMut(&StepRow<'_>),
    mut goes_on: impl FnMut(Duration, u64) -> Result<bool, Failure>,
) -> Result<(), Failure> {
    let (start, mut seen) = (Instant::now(), 0);
    while goes_on(start.elapsed(), seen)? {
        listener.drain(|step| {
            seen += 1;
            see(&step);
        })?;
        std::thread::sleep(Duration::from_millis(2));
    }
    Ok(())
}

/// Of a change that was asked for, when no answer came: it may yet be made.
pub(crate) fn unanswered(silence: &WireError) -> Failure {
    Failure::Work(format!("not known whether it is changed, as it may yet be: {silence}"))
}

/// The benches that run under this user's root.
pub(crate) fn running() -> Result<Vec<String>, WireError> {
    running_under(&SharedMemory::new(&Root::from_environment()?, "list")?)
}

/// The benches that run under the root of a carrier.
pub(crate) fn running_under(carrier: &SharedMemory) -> Result<Vec<String>, WireError> {
    let running = carrier.benches()?.into_iter().filter(wire::BenchEntry::is_running);
    Ok(running.map(|entry| entry.name.to_string()).collect())
}

/// What is said of a bench that is not there: those that are, or how to start it.
fn no_bench(bench: &BenchName, running: &[String]) -> String {
    match running {
        [] => WireError::NoBench(bench.clone()).to_string(),
        [one] => format!("no bench '{bench}' is running; there is {one}"),
        all => format!("no bench '{bench}' is running; there are {}", all.join(", ")),
    }
}

impl From<WireError> for Failure {
    fn from(error: WireError) -> Self {
        let words = match &error {
            WireError::NoBench(bench) => no_bench(bench, &running().unwrap_or_default()),
            error => error.to_string(),
        };
        match error {
            WireError::BenchName(_) | WireError::Root { .. } => Self::Usage(words),
            WireError::NoBench(_) | WireError::Taken(_) | WireError::Recorded(_) | WireError::Controlled(_) => {
                Self::Bench(words)
            }
            WireError::Version { .. }
            | WireError::Full { .. }
            | WireError::LeftBehind { .. }
            | WireError::NoAnswer(_)
            | WireError::DoesNotFit(_)
            | WireError::Internal(_) => Self::Work(words),
        }
    }
}
