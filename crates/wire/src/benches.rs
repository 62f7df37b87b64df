//! Which benches there are under a root, who is attached to them, and what the dead have left behind.

use std::collections::BTreeMap;
use std::time::Duration;

use iceoryx2::node::{DeadNodeView, NodeListFailure, NodeView};
use iceoryx2::prelude::*;
use rustix::process::{Pid, test_kill_process};

use crate::iceoryx::Ipc;
use crate::shared_memory::HOST_ROLE;
use crate::{BenchName, SharedMemory, Topic, WireError};

/// A bench, and who has it open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BenchEntry {
    /// Its name.
    pub name: BenchName,
    /// Live processes that have it open, the simulation among them, by process id.
    pub processes: Vec<AttachedProcess>,
}

impl BenchEntry {
    /// Whether its simulation lives.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.processes.iter().any(|process| process.role == HOST_ROLE)
    }
}

/// A live process that has a bench open.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AttachedProcess {
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
        let mut found: BTreeMap<BenchName, Vec<AttachedProcess>> = BTreeMap::new();
        let listed = Ipc::list(self.config(), |service| {
            let name = service.static_details.name().as_str().to_owned();
            let bench =
                name.strip_suffix(Topic::State.name()).and_then(|rest| rest.strip_prefix("whirl/")?.strip_suffix('/'));
            if let Some(bench) = bench.and_then(|bench| bench.parse::<BenchName>().ok()) {
                let processes = found.entry(bench).or_default();
                for node in service.dynamic_details.iter().flat_map(|details| &details.nodes) {
                    if let NodeState::Alive(view) = node
                        && let Some(details) = view.details()
                    {
                        let pid = details.process_id().value() as u32;
                        processes.push(AttachedProcess { pid, role: details.name().as_str().to_owned() });
                    }
                }
                processes.sort();
                processes.dedup();
            }
            CallbackProgression::Continue
        });
        listed.map_err(|error| WireError::Internal(format!("the benches cannot be listed ({error:?})")))?;
        Ok(found.into_iter().map(|(name, processes)| BenchEntry { name, processes }).collect())
    }
}

/// Who has nodes of iceoryx2 below one root.
struct Nodes {
    /// Whether any of them may live.
    living: bool,
    /// Those whose process has gone without closing them.
    dead: Vec<DeadNodeView<Ipc>>,
}

/// Looks at all nodes.
fn nodes(config: &Config) -> Result<Nodes, NodeListFailure> {
    let mut found = Nodes { living: false, dead: Vec::new() };
    Node::<Ipc>::list(config, |node| {
        match node {
            NodeState::Alive(_) | NodeState::Inaccessible(_) => found.living = true,
            NodeState::Dead(view) => found.dead.push(view),
            // One that cannot be made sense of is half made, or half gone: its maker may be at it.
            NodeState::Undefined(id) => {
                let maker = id.pid::<Ipc>().ok().and_then(|pid| Pid::from_raw(pid.value()));
                found.living |= maker.is_none_or(|pid| test_kill_process(pid).is_ok());
            }
        }
        CallbackProgression::Continue
    })?;
    Ok(found)
}

/// Whether nobody has a node there that lives, lease or no lease. If somebody has, clears away the dead ones.
pub(crate) fn nobody_lives(config: &Config) -> bool {
    // A list that cannot be read is no evidence of death.
    let Ok(found) = nodes(config) else { return false };
    if found.living {
        for dead in found.dead {
            if let Err(error) = dead.try_remove_stale_resources() {
                tracing::debug!(?error, "a dead node could not be cleared away");
            }
        }
    }
    !found.living
}

/// Removes what dead processes left below the root of `carrier`, which must hold nothing open in this process. Nobody
/// who lives loses anything. Returns how many dead processes were cleared away.
///
/// # Errors
/// The root cannot be used.
pub fn clean(carrier: &SharedMemory) -> Result<usize, WireError> {
    let found = nodes(carrier.config())
        .map_err(|error| WireError::Internal(format!("the processes cannot be listed ({error:?})")))?;
    // With nobody else about, even what iceoryx2 cannot make sense of goes; else the dead only, one by one.
    if !carrier.root().sweep_if_alone() {
        let node = carrier.node("clean")?;
        let _ = node.blocking_cleanup_dead_nodes(Duration::from_secs(2));
    }
    Ok(found.dead.len())
}
