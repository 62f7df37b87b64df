//! The papers at the top of the repository tell of what is there.

use std::fs;
use std::path::{Path, PathBuf};

use promises::run;

/// The repository.
fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests stand in the repository").to_owned()
}

fn paper(name: &str) -> String {
    fs::read_to_string(top().join(name)).expect("the paper is there")
}

#[test]
fn the_architecture_names_every_crate() {
    let architecture = paper("ARCHITECTURE.md");
    for entry in fs::read_dir(top().join("crates")).expect("crates").flatten() {
        let name = format!("`crates/{}`", entry.file_name().to_string_lossy());
        assert!(architecture.contains(&name), "ARCHITECTURE.md does not name {name}");
    }
}

#[test]
fn the_readme_and_the_changelog_show_every_command() {
    let help = run(&["--help"]).stdout;
    let commands = help.split("Commands:").nth(1).and_then(|rest| rest.split("Options:").next()).expect("commands");
    let names: Vec<&str> = commands.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.contains(&"up") && names.len() > 8, "{help}");
    let (readme, changelog) = (paper("README.md"), paper("CHANGELOG.md"));
    for name in names {
        assert!(readme.contains(&format!("whirl {name}")), "README.md does not show `whirl {name}`");
        assert!(
            changelog.contains(&format!("`{name}`")) || changelog.contains(&format!("whirl {name}`")),
            "CHANGELOG.md does not name `{name}`"
        );
    }
}

#[test]
fn the_manual_and_the_completions_are_those_of_the_program() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    promises::manual::write(folder.path()).expect("it can be written");
    let mut compared = 0;
    for part in ["man", "completions"] {
        let names = |folder: &Path| -> Vec<String> {
            let entries = fs::read_dir(folder).expect("the folder is there").flatten();
            let mut names: Vec<String> =
                entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
            names.sort();
            names
        };
        let (made, kept) = (folder.path().join(part), top().join("docs").join(part));
        assert_eq!(names(&made), names(&kept), "docs/{part}: `just manual` makes it again");
        for name in names(&made) {
            let [made, kept] = [&made, &kept].map(|folder| fs::read_to_string(folder.join(&name)).expect("a text"));
            assert!(made == kept, "docs/{part}/{name} is not of this program: `just manual` makes it again");
            compared += 1;
        }
    }
    assert!(compared > 20, "only {compared} files");
}
