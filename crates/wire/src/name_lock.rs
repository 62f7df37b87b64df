//! The lock on a bench's name: a file lock, which the kernel gives to one process alone and takes back from the dead.
//!
//! iceoryx2 has a limit on publishers, but services have to be made, and opened, before it counts them: simulations that
//! are started together met in the middle of that, and failed in words of their own. Here all but one are told at once,
//! before anything is made.

use std::fs;
use std::io::ErrorKind;
use std::os::fd::OwnedFd;
use std::sync::Arc;

use rustix::fs::{FlockOperation, Mode, OFlags};
use rustix::io::Errno;

use crate::{BenchName, Root, WireError};

/// Where the locks lie, below what of the root is ours to sweep.
const FOLDER: &str = "names";

/// A bench's name, held until the last clone is gone.
#[derive(Clone, Debug)]
pub(crate) struct NameLock {
    _held: Arc<OwnedFd>,
    // After it: whoever gives a name back still has a lease on the root.
    _root: Root,
}

impl NameLock {
    /// Takes `bench` under `root`, whose lease keeps the file from being swept meanwhile.
    pub(crate) fn take(root: &Root, bench: &BenchName) -> Result<Self, WireError> {
        let refuse = |why: &dyn std::fmt::Display| WireError::Root {
            path: root.path().to_owned(),
            problem: format!("the name '{bench}' cannot be locked: {why}"),
        };
        let folder = root.iceoryx2().join(FOLDER);
        match fs::create_dir_all(&folder) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => return Err(refuse(&error)),
            _ => {}
        }
        let flags = OFlags::CREATE | OFlags::RDWR | OFlags::CLOEXEC;
        let file = rustix::fs::open(folder.join(bench.as_str()), flags, Mode::RUSR | Mode::WUSR)
            .map_err(|error| refuse(&error))?;
        match rustix::fs::flock(&file, FlockOperation::NonBlockingLockExclusive) {
            Ok(()) => Ok(Self { _held: Arc::new(file), _root: root.clone() }),
            Err(Errno::WOULDBLOCK) => Err(WireError::Taken(bench.clone())),
            Err(error) => Err(refuse(&error)),
        }
    }
}
