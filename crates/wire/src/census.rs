//! Which benches there are under a root, who is attached to them, and what the dead have left behind.

use std::collections::BTreeMap;
use std::time::Duration;

use iceoryx2::node::NodeView;
use iceoryx2::prelude::*;

use crate::iceoryx::Ipc;
use crate::shared_memory::HOST_ROLE;
use crate::{BenchName, SharedMemory, WireError};

/// A bench, and who has it open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BenchEntry {
    /// Its name.
    pub name: BenchName,
    /// Live processes that have it open, the simulation among them, by process id.
    pub parties: Vec<Party>,
}

impl BenchEntry {
    /// Whether its simulation lives.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.parties.iter().any(|party| party.role == HOST_ROLE)
    }
}

/// A live process that has a bench open.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Party {
    /// Process id.
    pub pid: u32,
    /// What it is: `sim`, `dash`, `tail` ...
    pub role: String,
}

impl SharedMemory {
    /// Every bench under the root, by name, with the live processes that have it open.
    ///
    /// # Errors
    /// The root cannot be read.
    pub fn benches(&self) -> Result<Vec<BenchEntry>, WireError> {
        let mut found: BTreeMap<BenchName, Vec<Party>> = BTreeMap::new();
        let listed = Ipc::list(self.config(), |service| {
            let name = service.static_details.name().as_str().to_owned();
            let bench = name.strip_prefix("whirl/").and_then(|rest| rest.strip_suffix("/state"));
            if let Some(bench) = bench.and_then(|bench| bench.parse::<BenchName>().ok()) {
                let parties = found.entry(bench).or_default();
                for node in service.dynamic_details.iter().flat_map(|details| &details.nodes) {
                    if let NodeState::Alive(view) = node
                        && let Some(details) = view.details()
                    {
                        let pid = details.process_id().value() as u32;
                        parties.push(Party { pid, role: details.name().as_str().to_owned() });
                    }
                }
                parties.sort();
                parties.dedup();
            }
            CallbackProgression::Continue
        });
        listed.map_err(|error| WireError::Internal(format!("the benches cannot be listed ({error:?})")))?;
        Ok(found.into_iter().map(|(name, parties)| BenchEntry { name, parties }).collect())
    }
}

/// Removes what dead processes left below the root of `carrier`, which must hold nothing open in this process. Live
/// benches are not touched. Returns how many dead processes were cleared away.
///
/// # Errors
/// The root cannot be used.
pub fn clean(carrier: &SharedMemory) -> Result<usize, WireError> {
    let mut dead = 0;
    Node::<Ipc>::list(carrier.config(), |node| {
        dead += usize::from(matches!(node, NodeState::Dead(_)));
        CallbackProgression::Continue
    })
    .map_err(|error| WireError::Internal(format!("the processes cannot be listed ({error:?})")))?;
    // With nobody else about, even what iceoryx2 cannot make sense of goes; else the dead only, one by one.
    if !carrier.root().sweep_if_alone() {
        let node = carrier.node("clean")?;
        let _ = node.blocking_cleanup_dead_nodes(Duration::from_secs(2));
    }
    Ok(dead)
}
