//! A short name for a folder whose own is too long, or has characters that iceoryx2 does not take.
//!
//! A socket's whole path has to fit into 107 bytes, most of which iceoryx2 needs for itself; and its paths are plain
//! ASCII. Where a root does not fit, a link in a folder of the user's stands for it. Links are never turned to another
//! root, so that what a dead process wrote down about its files stays true for whoever clears them away; and since they
//! all lead to the same files, processes need not agree on one.

use std::fs;
use std::io::{self, ErrorKind};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, symlink};
use std::path::{Path, PathBuf};

/// The longest path that iceoryx2 can be given: a socket's 107 bytes less `/`, the prefix, a number of up to 39 digits and
/// `.event`. Numbers grow with their use, so a path is not to be judged by whether it happens to work.
const LONGEST: usize = 107 - 1 - PREFIX - 39 - 6;

/// The length of a root's prefix: `whirl_`, 16 digits, `_`.
const PREFIX: usize = 23;

/// How many names are tried for a link.
const TRIES: u64 = 1000;

/// A name for a folder that iceoryx2 can use. The link behind it, if there is one, is left in place until
/// [`ShortPath::remove`].
#[derive(Debug)]
pub(crate) struct ShortPath {
    /// The name.
    pub(crate) path: PathBuf,
    /// Where it leads, if it is a link.
    target: Option<PathBuf>,
}

impl ShortPath {
    /// A name for `root`, which is an absolute path without links, of which iceoryx2 will use the folder `below`.
    /// `hash` is a number that another root is unlikely to have.
    ///
    /// # Errors
    /// No folder for links can be had.
    pub(crate) fn of(root: &Path, below: &str, hash: u64) -> io::Result<Self> {
        if is_plain(&root.join(below)) {
            return Ok(Self { path: root.to_owned(), target: None });
        }
        let user = format!("whirl-{}", rustix::process::geteuid().as_raw());
        let mut refusal = io::Error::from(ErrorKind::NotFound);
        for folder in [PathBuf::from("/tmp"), std::env::temp_dir()] {
            let folder = folder.join(&user);
            match link(&folder, below, root, hash) {
                Ok(path) => return Ok(Self { path, target: Some(root.to_owned()) }),
                Err(error) => {
                    let told = format!("no short name in {}: {error}", folder.display());
                    refusal = io::Error::new(error.kind(), told);
                }
            }
        }
        Err(refusal)
    }

    /// Removes the link, and its folder if that was the last one.
    pub(crate) fn remove(&self) {
        if self.target.as_ref().is_some_and(|target| fs::read_link(&self.path).is_ok_and(|leads| leads == *target)) {
            let _ = fs::remove_file(&self.path);
            // Fails as long as anything else is in it.
            let _ = self.path.parent().map(fs::remove_dir);
        }
    }
}

/// Whether iceoryx2 can use this path as it is.
fn is_plain(path: &Path) -> bool {
    let bytes = path.as_os_str().as_encoded_bytes();
    bytes.len() <= LONGEST && bytes.iter().all(|byte| byte.is_ascii_alphanumeric() || b"/._-+@".contains(byte))
}

/// A link to `root` in `folder`, made if it is not there.
fn link(folder: &Path, below: &str, root: &Path, hash: u64) -> io::Result<PathBuf> {
    for turn in 0..TRIES {
        // Six digits leave room for any user's number; two roots that share them have neighbouring links.
        let path = folder.join(format!("{:06x}", hash.wrapping_add(turn) & 0x00ff_ffff));
        if !is_plain(&path.join(below)) {
            return Err(io::Error::new(ErrorKind::InvalidFilename, "too long itself"));
        }
        // Here, because the last one out may have taken the folder away since the last try.
        make_private(folder)?;
        match symlink(root, &path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                if fs::read_link(&path).is_ok_and(|leads| leads == root) {
                    return Ok(path);
                }
            }
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(ErrorKind::AlreadyExists, "all are taken"))
}

/// Makes a folder that nobody else can write to, or finds it so: whoever could turn a link could read along.
fn make_private(folder: &Path) -> io::Result<()> {
    fs::DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    let found = fs::symlink_metadata(folder)?;
    if found.is_dir() && found.uid() == rustix::process::geteuid().as_raw() && found.mode() & 0o022 == 0 {
        return Ok(());
    }
    Err(io::Error::new(ErrorKind::PermissionDenied, "the folder is not yours alone"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_roots_with_one_hash_have_neighbouring_links_and_each_finds_its_own_again() {
        let folder = tempfile::Builder::new().prefix("w").tempdir_in("/tmp").unwrap();
        let (one, other) = (Path::new("/a/long/one"), Path::new("/a/long/other"));
        let made = [one, other, one].map(|root| link(folder.path(), "x", root, u64::MAX).unwrap());
        assert_eq!(made[0], made[2]);
        assert_ne!(made[0], made[1]);
        assert_eq!(made.map(|path| fs::read_link(path).unwrap()), [one, other, one]);
    }

    #[test]
    fn any_user_has_room_for_a_link_and_a_folder_of_others_is_not_trusted() {
        assert!(is_plain(Path::new("/tmp/whirl-4294967295/abcdef/iceoryx2")));
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o777)).unwrap();
        assert!(make_private(folder.path()).is_err());
        // Nor is a link to a folder of one's own.
        symlink(folder.path(), folder.path().join("link")).unwrap();
        assert!(make_private(&folder.path().join("link")).is_err());
    }
}
