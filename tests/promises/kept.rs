//! Nothing that is there is overwritten unless that is asked for: one rule for every file that a command writes.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::path::Path;

use promises::run;

const OLD: &str = "what was there";

/// Every command that writes a file, without the file.
const WRITERS: [&[&str]; 8] = [
    // Hours, if it were not refused first.
    &["run", "--speed", "1", "--duration", "1e7", "--out", "FILE.csv"],
    &["assign", "jeffcott", "--cancel", "--out", "FILE.toml"],
    &["tune", "--over", "0..6", "--starts", "100000", "--out", "FILE.toml"],
    &["tune", "--over", "0..6", "--starts", "100000", "--track", "3", "--plot", "FILE.svg"],
    &["tune", "--over", "0..6", "--starts", "100000", "--pareto", "force", "--plot", "FILE.png"],
    &["report", "--page", "FILE.md"],
    &["dash", "--picture", "FILE.svg"],
    &["dash", "--picture", "FILE.txt"],
];

fn in_folder(arguments: &[&str], folder: &Path) -> (Vec<String>, std::path::PathBuf) {
    let mut file = None;
    let mut place = |argument: &str| match argument.strip_prefix("FILE") {
        Some(ending) => {
            let path = folder.join(format!("there{ending}"));
            file = Some(path.clone());
            path.to_str().unwrap().to_owned()
        }
        None => argument.to_owned(),
    };
    let typed = arguments.iter().map(|argument| place(argument)).collect();
    (typed, file.unwrap())
}

#[test]
fn regress_no_command_replaces_a_file_that_it_was_not_told_to_replace() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in WRITERS {
        let (typed, file) = in_folder(arguments, folder.path());
        std::fs::write(&file, OLD).unwrap();
        let ran = run(&typed.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{arguments:?}: {ran:?}");
        let told = "is already there: choose another name, or replace it with --force";
        assert!(ran.stderr.contains(told) && ran.stderr.contains(file.to_str().unwrap()), "{arguments:?}: {ran:?}");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), OLD, "{arguments:?}");
    }
    // One point of a trade is enough.
    std::fs::create_dir(folder.path().join("front")).unwrap();
    let point = folder.path().join("front/point-03.toml");
    std::fs::write(&point, OLD).unwrap();
    let front = folder.path().join("front");
    let ran = run(&["tune", "--over", "0..6", "--pareto", "force", "--out", front.to_str().unwrap()]);
    assert!(ran.code == Some(2) && ran.stderr.contains("point-03.toml' is already there"), "{ran:?}");
    assert_eq!(std::fs::read_to_string(&point).unwrap(), OLD);
}

#[test]
fn what_is_to_be_replaced_is_replaced_and_force_alone_is_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["run", "--speed", "1", "--duration", "2", "--out", "FILE.csv", "--force"][..],
        &["assign", "jeffcott", "--cancel", "--out", "FILE.toml", "--force"],
    ] {
        let (typed, file) = in_folder(arguments, folder.path());
        std::fs::write(&file, OLD).unwrap();
        let ran = run(&typed.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(ran.code, Some(0), "{arguments:?}: {ran:?}");
        assert_ne!(std::fs::read_to_string(&file).unwrap(), OLD, "{arguments:?}");
    }
    for arguments in [&["run", "--speed", "1", "--duration", "2", "--force"][..], &["tune", "--speed", "1", "--force"]]
    {
        assert_eq!(run(arguments).code, Some(2), "{arguments:?}");
    }
}
