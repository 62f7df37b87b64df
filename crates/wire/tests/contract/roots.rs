//! Of shared memory alone: where a root may be.

use std::path::Path;

use wire::{Carrier, Host, StateSender};

use crate::support::{LAYOUT, bench, drained, number};

/// The whole of a bench, used once under `root`.
fn works_under(path: &Path) {
    let root = wire::Root::at(path).unwrap_or_else(|error| panic!("{error}"));
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let name = bench("here");
    let host = carrier.host(&name).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let (mut states, _inbox) = (host.states(LAYOUT).unwrap(), host.inbox().unwrap());
    let mut listener = carrier.listen(&name).unwrap();
    let _commander = carrier.command(&name).unwrap();
    states.send(1, number(3)).unwrap();
    assert_eq!(drained(&mut listener), [3]);
    // Another process would come by the same name, whatever it calls the folder.
    let again = wire::Root::at(&path.join(".")).unwrap();
    let seen = wire::SharedMemory::new(&again, "other").unwrap().benches().unwrap();
    assert_eq!(seen[0].name, name);
}

#[test]
fn a_root_may_be_as_long_as_the_system_lets_it_be_and_have_any_characters() {
    use std::os::unix::ffi::OsStrExt;

    let dir = tempfile::tempdir().unwrap();
    let mut links = Vec::new();
    let mut try_at = |path: &Path| {
        works_under(path);
        // All that stays is the empty root: its own files have gone, and so has its short name.
        let files: Vec<_> = std::fs::read_dir(path).unwrap().flatten().map(|e| e.file_name()).collect();
        assert_eq!(files, ["lease"], "{}", path.display());
        links.push(std::fs::canonicalize(path).unwrap());
    };
    // Around every limit that there is: sockets, the paths of iceoryx2, and far beyond.
    let here = dir.path().as_os_str().len() + 1;
    for length in (here + 1..=60).chain([80, 120, 160, 254, 256, 300]) {
        let mut path = dir.path().join("x".repeat((length - here).min(100)));
        while path.as_os_str().len() + 1 < length {
            path.push("y".repeat((length - path.as_os_str().len() - 1).min(100)));
        }
        try_at(&path);
    }
    for name in ["m\u{fc}hle", "\u{65e5}\u{672c}", "two words", "what? *<|>\"'"] {
        try_at(&dir.path().join(name));
    }
    try_at(&dir.path().join(std::ffi::OsStr::from_bytes(b"not \xff utf-8")));
    let user = rustix::process::geteuid().as_raw();
    for entry in std::fs::read_dir(format!("/tmp/whirl-{user}")).into_iter().flatten().flatten() {
        let leads = std::fs::read_link(entry.path()).unwrap_or_default();
        assert!(!links.contains(&leads), "{} was left", entry.path().display());
    }
    let beyond = dir.path().join("z".repeat(300));
    let told = wire::Root::at(&beyond).unwrap_err().to_string();
    assert!(told.contains("cannot be made: File name too long"), "{told}");
}
