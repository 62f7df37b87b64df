//! The folder under which one user's benches live, and the lease that says somebody uses it.
//!
//! iceoryx2 keeps service descriptions and node monitors in files under a root folder and its data in POSIX shared
//! memory, which is one name space for the whole machine. A root of the user's own, not readable by others, and a
//! prefix made from its path keep two users, or two tests, apart. Any path will do: see [`crate::short_path`].

use std::fs;
use std::os::fd::OwnedFd;
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustix::fs::{FlockOperation, Mode, OFlags};

use crate::document::hash_of;
use crate::short_path::ShortPath;
use crate::{WireError, benches, iceoryx};

/// The folder in the root that iceoryx2 fills and we sweep.
const OURS: &str = "iceoryx2";

/// A root folder that is ours to use. Clones share one lease; the last one out sweeps up.
#[derive(Clone, Debug)]
pub struct Root {
    lease: Arc<Lease>,
}

/// A shared lock on the root, held for as long as this process may touch shared memory below it.
#[derive(Debug)]
struct Lease {
    path: PathBuf,
    /// The root's name where iceoryx2 is concerned.
    short: ShortPath,
    prefix: String,
    lock: OwnedFd,
}

impl Root {
    /// The root that `WHIRL_ROOT` names, else `whirl` in `XDG_RUNTIME_DIR`, else `whirl-UID` in the temporary folder.
    ///
    /// # Errors
    /// See [`Root::at`].
    pub fn from_environment() -> Result<Self, WireError> {
        let folder = |variable| std::env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from);
        let path = folder("WHIRL_ROOT")
            .or_else(|| folder("XDG_RUNTIME_DIR").filter(|dir| dir.is_dir()).map(|dir| dir.join("whirl")))
            .unwrap_or_else(|| std::env::temp_dir().join(format!("whirl-{}", rustix::process::geteuid().as_raw())));
        Self::at(&path)
    }

    /// The root at `path`, made if it is not there.
    ///
    /// # Errors
    /// A path that is not absolute, or a folder that cannot be made, is not ours, or is open to others.
    pub fn at(path: &Path) -> Result<Self, WireError> {
        let refuse = |problem: String| WireError::Root { path: path.to_owned(), problem };
        if !path.is_absolute() {
            return Err(refuse("expected an absolute path".into()));
        }
        fs::DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(path)
            .map_err(|error| refuse(format!("cannot be made: {error}")))?;
        let found = fs::metadata(path).map_err(|error| refuse(format!("cannot be read: {error}")))?;
        if found.uid() != rustix::process::geteuid().as_raw() {
            return Err(refuse(format!("belongs to user {}, not to you", found.uid())));
        }
        if found.mode() & 0o022 != 0 {
            return Err(refuse(format!("others can write to it (mode {:o})", found.mode() & 0o777)));
        }
        let lock = rustix::fs::open(
            path.join("lease"),
            OFlags::CREATE | OFlags::RDWR | OFlags::CLOEXEC,
            Mode::RUSR | Mode::WUSR,
        )
        .map_err(|error| refuse(format!("cannot be written to: {error}")))?;
        rustix::fs::flock(&lock, FlockOperation::LockShared)
            .map_err(|error| refuse(format!("cannot be locked: {error}")))?;
        // Two spellings of one folder must not become two name spaces.
        let canonical = fs::canonicalize(path).map_err(|error| refuse(format!("cannot be followed: {error}")))?;
        let hash = hash_of(canonical.as_os_str().as_encoded_bytes());
        // After the lock: the last one out removes a short name, and must have gone before it is made anew.
        let short = ShortPath::of(&canonical, OURS, hash).map_err(|error| refuse(error.to_string()))?;
        let prefix = format!("whirl_{hash:016x}_");
        Ok(Self { lease: Arc::new(Lease { path: canonical, short, prefix, lock }) })
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.lease.path
    }

    /// The folder in it that is iceoryx2's, by a name that iceoryx2 can use: what a reader without this crate gives it
    /// as its root path.
    #[must_use]
    pub fn iceoryx2(&self) -> PathBuf {
        self.lease.iceoryx2()
    }

    /// What the names of our shared memory begin with.
    #[must_use]
    pub fn prefix(&self) -> &str {
        &self.lease.prefix
    }

    /// Whether no other process uses this root. If so, everything below it has been swept; if not, only what the dead
    /// have left.
    pub(crate) fn sweep_if_alone(&self) -> bool {
        self.lease.sweep_if_alone(false)
    }
}

impl Lease {
    fn iceoryx2(&self) -> PathBuf {
        self.short.path.join(OURS)
    }

    /// Removes all that is left below the root, if no other process can be using it, and what the dead have left
    /// otherwise. Who is `leaving` needs the root's short name no more.
    ///
    /// An exclusive lock tells the first for processes that have a lease: each holds a shared one, and the kernel drops
    /// the locks of the dead. A reader that knows only iceoryx2 has none; but its node shows that it lives.
    fn sweep_if_alone(&self, leaving: bool) -> bool {
        let alone = rustix::fs::flock(&self.lock, FlockOperation::NonBlockingLockExclusive).is_ok();
        // Listed before anybody is looked for: what comes after that is not ours to sweep.
        let leftovers = if alone { self.leftovers() } else { Vec::new() };
        let swept =
            alone && iceoryx::config(&self.iceoryx2(), &self.prefix).is_ok_and(|config| benches::nobody_lives(&config));
        if swept {
            for left in leftovers {
                let _ = if left.is_dir() { fs::remove_dir_all(&left) } else { fs::remove_file(&left) };
            }
            if leaving {
                self.short.remove();
            }
        }
        // The attempt gave up our shared lock too, whether it succeeded or not.
        let _ = rustix::fs::flock(&self.lock, FlockOperation::LockShared);
        swept
    }

    /// What iceoryx2 keeps for this root: its folders, and its shared memory on systems that show it as files.
    fn leftovers(&self) -> Vec<PathBuf> {
        let entries = |folder: &Path| fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let named = |path: &PathBuf| {
            path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.starts_with(&self.prefix))
        };
        let in_memory = entries(Path::new("/dev/shm")).filter(named);
        // Nothing else in the root is ours: somebody may have named a folder that holds other things.
        in_memory.chain(Some(self.path.join(OURS)).filter(|ours| ours.exists())).collect()
    }
}

impl Drop for Lease {
    fn drop(&mut self) {
        self.sweep_if_alone(true);
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    #[test]
    fn refuses_folders_that_others_can_reach_or_that_cannot_be() {
        let told = |path: &Path| Root::at(path).unwrap_err().to_string();
        let dir = tempfile::tempdir().unwrap();
        assert!(told(Path::new("here")).contains("expected an absolute path"));
        let file = dir.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(told(&file.join("root")).contains("cannot be made"));
        let open = dir.path().join("open");
        fs::create_dir(&open).unwrap();
        fs::set_permissions(&open, fs::Permissions::from_mode(0o777)).unwrap();
        assert!(told(&open).contains("others can write to it (mode 777)"));
    }

    #[test]
    fn one_folder_is_one_name_space_however_it_is_spelt() {
        let dir = tempfile::tempdir().unwrap();
        let plain = Root::at(&dir.path().join("root")).unwrap();
        let roundabout = Root::at(&dir.path().join("root/../root/.")).unwrap();
        assert_eq!(plain.prefix(), roundabout.prefix());
        let other = Root::at(&dir.path().join("other")).unwrap();
        assert_ne!(plain.prefix(), other.prefix());
    }

    #[test]
    fn only_the_last_one_out_sweeps() {
        let dir = tempfile::tempdir().unwrap();
        let (first, second) = (Root::at(dir.path()).unwrap(), Root::at(dir.path()).unwrap());
        let (litter, other) = (first.iceoryx2().join("nodes"), dir.path().join("mine.toml"));
        fs::create_dir_all(&litter).unwrap();
        fs::write(&other, "").unwrap();
        assert!(!first.sweep_if_alone());
        drop(first);
        assert!(litter.exists());
        drop(second);
        assert!(!litter.exists() && other.exists(), "only what is ours goes");
    }
}
