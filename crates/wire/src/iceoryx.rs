//! What all services of a bench share: the flavour of iceoryx2, their names, their size, and its errors in our words.

use std::fmt::Debug;
use std::path::Path;
use std::time::{Duration, Instant};

use iceoryx2::prelude::*;
use iceoryx2::service::builder::Builder;

use crate::faults::{Fault, Refusal};
use crate::{BenchName, Topic, WireError};

/// The flavour of iceoryx2: between processes, ports bound to their thread, no locks.
pub(crate) type Ipc = ipc::Service;

/// Readers of one bench's motion: dashboards, `tail`, a recorder.
pub const MAX_READERS: usize = 16;

/// Those who only look at how a bench stands or ask it for something, beside the readers: `set`, `status`, `note`.
/// They have places of their own, so that a house full of readers keeps nobody from commanding.
pub(crate) const MAX_GLANCES: usize = 16;

/// Who hears bench statuses and the recorder's status, and who asks: every reader may, and some more.
pub(crate) const MAX_PARTIES: usize = MAX_READERS + MAX_GLANCES;

/// Nodes that may have one service open: two a process, and those who come only to be told that the house is full.
pub(crate) const MAX_NODES: usize = 4 * MAX_PARTIES;

/// How long a service that is being made or taken down by somebody else is waited for.
const FLUX: Duration = Duration::from_secs(2);

/// A root that iceoryx2 cannot use.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConfigError {
    /// Its path is too long, or has what no path may have.
    #[error("not a path that iceoryx2 can use ({0})")]
    Path(SemanticStringError),
    /// The same of the prefix of names in shared memory.
    #[error("not a prefix that iceoryx2 can use ({0})")]
    Prefix(SemanticStringError),
}

/// The configuration of iceoryx2 for services under `folder` whose shared memory is called `prefix` and so on. Nothing
/// of it comes from files or the environment, so that all processes have the same.
pub(crate) fn config(folder: &Path, prefix: &str) -> Result<Config, ConfigError> {
    let mut config = Config::default();
    let path = iceoryx2::prelude::Path::new(folder.as_os_str().as_encoded_bytes()).map_err(ConfigError::Path)?;
    config.global.set_root_path(&path);
    config.global.prefix = FileName::new(prefix.as_bytes()).map_err(ConfigError::Prefix)?;
    Ok(config)
}

/// The builder of one of a bench's services.
pub(crate) fn service(node: &Node<Ipc>, bench: &BenchName, topic: Topic) -> Result<Builder<Ipc>, WireError> {
    let name = ServiceName::new(&format!("whirl/{bench}/{topic}")).map_err(internal)?;
    Ok(node.service_builder(&name))
}

/// What should not happen, told as it is: for a person to read, never to be told apart by its words.
pub(crate) fn internal(error: impl Debug) -> WireError {
    WireError::Internal(format!("{error:?}"))
}

/// Opens or makes a service with `open`, again and again while somebody else is making it or taking it down, though not
/// for long.
pub(crate) fn opened<T, E: Refusal>(
    bench: &BenchName,
    mut open: impl FnMut() -> Result<Result<T, E>, WireError>,
) -> Result<T, WireError> {
    let start = Instant::now();
    loop {
        let error = match open()? {
            Ok(service) => return Ok(service),
            Err(error) => error,
        };
        if error.fault() == Fault::InFlux && start.elapsed() < FLUX {
            std::thread::sleep(Duration::from_millis(2));
            continue;
        }
        let detail = format!("{error:?}");
        let bench = bench.clone();
        return Err(match error.fault() {
            Fault::Missing => WireError::NoBench(bench),
            Fault::Full => WireError::Full { bench, what: "processes", most: MAX_NODES },
            Fault::OtherVersion => WireError::Version { bench, detail },
            // Two iceoryx2 versions on one service look like this too.
            Fault::HalfMade | Fault::InFlux => WireError::LeftBehind { bench, detail },
            Fault::Other => WireError::Internal(detail),
        });
    }
}

/// iceoryx2's reasons for not making a port: all `most` of them are taken, or something is amiss.
pub(crate) fn full(bench: &BenchName, what: &'static str, most: usize, error: &impl Refusal) -> WireError {
    port(error, || WireError::Full { bench: bench.clone(), what, most })
}

/// Why a port is not to be had: `taken` if all of its kind are, else what is amiss.
pub(crate) fn port(error: &impl Refusal, taken: impl FnOnce() -> WireError) -> WireError {
    if error.fault() == Fault::Full { taken() } else { internal(error) }
}
