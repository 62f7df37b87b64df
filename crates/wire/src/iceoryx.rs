//! What all services of a bench share: the flavour of iceoryx2, their names, their size, and its errors in our words.

use std::fmt::Debug;

use iceoryx2::prelude::*;
use iceoryx2::service::builder::Builder;

use crate::{BenchName, WireError};

/// The flavour of iceoryx2: between processes, ports bound to their thread, no locks.
pub(crate) type Ipc = ipc::Service;

/// Readers of one bench, and as many clients.
pub(crate) const MAX_READERS: usize = 16;

/// The builder of one of a bench's services.
pub(crate) fn service(node: &Node<Ipc>, bench: &BenchName, topic: &str) -> Result<Builder<Ipc>, WireError> {
    let name = ServiceName::new(&format!("whirl/{bench}/{topic}")).map_err(internal)?;
    Ok(node.service_builder(&name))
}

/// What should not happen, told as it is.
pub(crate) fn internal(error: impl Debug) -> WireError {
    WireError::Internal(format!("{error:?}"))
}

/// iceoryx2's reasons for not opening or creating a service, in words for people. They are told apart by name, because
/// each pattern has its own error type with the same variants.
pub(crate) fn opened(bench: &BenchName, error: impl Debug) -> WireError {
    let detail = format!("{error:?}");
    let says = |words: &[&str]| words.iter().any(|word| detail.contains(word));
    if says(&["DoesNotExist", "IsMarkedForDestruction"]) {
        WireError::NoBench(bench.clone())
    } else if says(&["Incompatible", "VersionMismatch", "DoesNotSupport"]) {
        WireError::Version { bench: bench.clone(), detail }
    } else if says(&["ExceedsMax"]) {
        WireError::Full { bench: bench.clone(), what: "process" }
    } else if says(&["CorruptedState", "HangsInCreation"]) {
        // Two iceoryx2 versions on one service look like this too.
        WireError::LeftBehind { bench: bench.clone(), detail }
    } else {
        WireError::Internal(detail)
    }
}

/// iceoryx2's reasons for not making a port: all of them are taken, or something is amiss.
pub(crate) fn full(bench: &BenchName, what: &'static str, error: impl Debug) -> WireError {
    let detail = format!("{error:?}");
    if detail.contains("ExceedsMax") {
        WireError::Full { bench: bench.clone(), what }
    } else {
        WireError::Internal(detail)
    }
}
