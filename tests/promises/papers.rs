//! The papers at the top of the repository tell of what is there.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use promises::paper::{paper, top};
use promises::run;
use wire::Topic;

/// What stands between backticks in a text and begins with `prefix`.
fn quoted<'a>(text: &'a str, prefix: &str) -> BTreeSet<&'a str> {
    text.split('`').skip(1).step_by(2).filter(|word| word.starts_with(prefix)).collect()
}

#[test]
fn the_architecture_has_a_row_for_every_crate_and_for_no_other() {
    let architecture = paper("ARCHITECTURE.md");
    let rows: BTreeSet<String> = architecture
        .lines()
        .filter_map(|line| line.strip_prefix("| `crates/")?.split_once('`'))
        .map(|(name, _)| name.to_owned())
        .collect();
    let crates = fs::read_dir(top().join("crates")).expect("crates").flatten();
    let crates: BTreeSet<String> = crates
        .filter(|entry| entry.path().join("Cargo.toml").exists())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(rows, crates, "the first table of rooms, and the folder `crates`");
}

#[test]
fn the_architecture_and_the_crate_that_has_them_name_every_service_and_no_other() {
    let services: BTreeSet<String> = Topic::ALL.iter().map(|topic| format!("whirl/NAME/{topic}")).collect();
    assert_eq!(services.len(), Topic::ALL.len());
    for document in ["ARCHITECTURE.md", "crates/wire/src/lib.rs"] {
        let text = paper(document);
        // A row of a table each.
        let rows = text.lines().filter_map(|line| line.trim_start_matches("//! ").strip_prefix("| `whirl/NAME/"));
        let named: BTreeSet<String> =
            rows.map(|row| format!("whirl/NAME/{}", row.split('`').next().unwrap_or(""))).collect();
        assert_eq!(named, services, "{document}");
        let quoted: BTreeSet<String> = quoted(&text, "whirl/NAME/").into_iter().map(str::to_owned).collect();
        assert!(quoted.is_subset(&services), "{document}: {quoted:?}");
    }
}

#[test]
fn the_architecture_leads_to_files_that_are_there() {
    let architecture = paper("ARCHITECTURE.md");
    let paths = quoted(&architecture, "crates/");
    assert!(paths.len() > 30, "{paths:?}");
    for path in paths {
        assert!(top().join(path).exists(), "ARCHITECTURE.md leads to {path}, which is not there");
    }
}

#[test]
fn every_crate_opens_with_what_it_is_for_and_an_example_that_runs() {
    let mut crates = 0;
    for entry in fs::read_dir(top().join("crates")).expect("crates").flatten() {
        let Ok(lib) = fs::read_to_string(entry.path().join("src/lib.rs")) else { continue };
        let name = entry.file_name().to_string_lossy().into_owned();
        let front: Vec<&str> = lib.lines().take_while(|line| line.starts_with("//!")).collect();
        assert!(front.first().is_some_and(|first| first.len() > 20), "{name} does not say what it is for");
        assert!(front.contains(&"//! ```"), "{name} has no example on its front page");
        assert!(paper("crates/whirl/src/lib.rs").contains(&format!("`{name}`")) || name == "whirl", "no way to {name}");
        crates += 1;
    }
    assert!(crates > 14, "only {crates} crates");
}

#[test]
fn the_documents_and_the_changelog_show_every_command() {
    let help = run(&["--help"]).stdout;
    let commands = help.split("Commands:").nth(1).and_then(|rest| rest.split("Options:").next()).expect("commands");
    let names: Vec<&str> = commands.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(names.contains(&"up") && names.len() > 8, "{help}");
    let shown: String = [
        "README.md",
        "introduction.md",
        "analysis.md",
        "bench.md",
        "console.md",
        "join.md",
        "protocol.md",
        "recordings.md",
        "search.md",
    ]
    .map(|name| if name == "README.md" { paper(name) } else { paper(&format!("docs/book/src/{name}")) })
    .concat();
    let changelog = paper("CHANGELOG.md");
    for name in names {
        assert!(shown.contains(&format!("\nwhirl {name} ")), "no document shows `whirl {name}`");
        assert!(
            changelog.contains(&format!("`{name}`")) || changelog.contains(&format!("whirl {name}`")),
            "CHANGELOG.md does not name `{name}`"
        );
    }
}

#[test]
fn the_page_of_json_fields_is_that_of_the_program() {
    let made = promises::reference::json(&|words| run(words).json());
    assert!(made == paper("docs/book/src/json.md"), "docs/book/src/json.md: `just json` makes it again");
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
    for name in promises::reference::names() {
        let made = fs::read_to_string(folder.path().join("book/src").join(name)).expect("a text");
        assert!(made == paper(&format!("docs/book/src/{name}")), "docs/book/src/{name}: `just manual` makes it again");
    }
    assert!(compared > 20, "only {compared} files");
}

/// What a merge leaves behind where it does not know better made the justfile unreadable, and nobody noticed: no test reads it.
#[test]
fn regress_no_file_has_the_marks_of_a_merge() {
    let marks = ["<", ">"].map(|sign| format!("\n{} ", sign.repeat(7)));
    let mut folders = vec![top().to_owned()];
    let mut read = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let (path, name) = (entry.path(), entry.file_name());
            if path.is_dir() && !["target", ".git"].contains(&&*name.to_string_lossy()) {
                folders.push(path);
            } else if let Ok(text) = std::fs::read_to_string(&path) {
                read += 1;
                assert!(!marks.iter().any(|mark| text.contains(mark)), "{}", path.display());
            }
        }
    }
    assert!(read > 500, "{read} files");
}
