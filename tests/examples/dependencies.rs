//! What comes in from outside, checked: `cargo run -p promises --example dependencies`.
//!
//! * every licence is one of those that may be passed on in a program under ours;
//! * every crate is from crates.io, as `Cargo.lock` has it;
//! * nothing is in the program twice, in two versions, but for what is listed here;
//! * no crate of ours names a dependency that it does not use, or uses in tests alone.
//!
//! What `cargo deny` and `cargo machete` do, as far as it needs no list of advisories from the network. Those two are programs of
//! their own, which would be built anew on every machine.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "what it finds is what it is for")]

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;
use std::process::{Command, ExitCode};

use serde_json::Value;
use spdx::{Expression, ParseMode};

type Done<T> = Result<T, Box<dyn Error>>;

/// Licences that may be part of a program under ours. MPL-2.0 is about the files under it, which we do not change.
const LICENCES: [&str; 11] = [
    "0BSD",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CDLA-Permissive-2.0",
    "ISC",
    "MIT",
    "MPL-2.0",
    "Unicode-3.0",
    "Zlib",
];

/// What is in the program in two versions, and through whom. Not more, and no longer than need be.
const TWICE: [(&str, &str); 10] = [
    ("darling", "macros at build time: of derive_builder in tui-big-text, and of instability in ratatui"),
    ("darling_core", "as darling"),
    ("darling_macro", "as darling"),
    ("itertools", "of ratatui, and of tui-big-text"),
    ("miniz_oxide", "of png, and of flate2, which png has too"),
    ("signal-hook", "of crossterm, and ours"),
    ("syn", "macros at build time"),
    ("thiserror", "of filedescriptor in crossterm, and everybody else's"),
    ("thiserror-impl", "as thiserror"),
    ("winnow", "of toml, and of toml_parser in it"),
];

fn main() -> Done<ExitCode> {
    let mut faults = licences()?;
    faults.extend(sources()?);
    faults.extend(duplicates()?);
    faults.extend(unused()?);
    faults.iter().for_each(|fault| eprintln!("{fault}"));
    println!("{} faults in what comes from outside", faults.len());
    Ok(ExitCode::from(u8::from(!faults.is_empty())))
}

/// Runs cargo on this workspace.
fn cargo(arguments: &[&str]) -> Done<String> {
    let ran = Command::new(env!("CARGO")).args(arguments).arg("--locked").output()?;
    if !ran.status.success() {
        return Err(format!("cargo {}: {}", arguments.join(" "), String::from_utf8_lossy(&ran.stderr)).into());
    }
    Ok(String::from_utf8(ran.stdout)?)
}

/// Names, versions and licences of what `cargo tree` shows with these options.
fn tree(options: &[&str]) -> Done<BTreeSet<(String, String, String)>> {
    let listed = cargo(&[&["tree", "--prefix", "none", "--format", "{p}|{l}"], options].concat())?;
    let entry = |line: &str| {
        let (package, licence) = line.trim_end_matches(" (*)").split_once('|')?;
        let mut words = package.split(' ');
        Some((words.next()?.to_owned(), words.next()?.to_owned(), licence.to_owned()))
    };
    listed
        .lines()
        .filter(|line| !line.is_empty())
        .map(|line| entry(line).ok_or_else(|| line.to_owned().into()))
        .collect()
}

/// Of everything that any feature brings on this system, tests and all.
fn licences() -> Done<Vec<String>> {
    let mut faults = Vec::new();
    let all = tree(&["--workspace", "--all-features", "--edges", "normal,build,dev"])?;
    for (name, version, licence) in &all {
        let expression = Expression::parse_mode(licence, ParseMode::LAX);
        let may = expression
            .is_ok_and(|all| all.evaluate(|one| one.license.id().is_some_and(|id| LICENCES.contains(&id.name))));
        if !may {
            faults.push(format!(
                "{name} {version}: licence '{licence}' is none of those that may be part of the program"
            ));
        }
    }
    println!("{} crates under licences that may be part of the program", all.len() - faults.len());
    Ok(faults)
}

fn sources() -> Done<Vec<String>> {
    let lock = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.lock"))?;
    let sources = lock.lines().filter_map(|line| line.strip_prefix("source = "));
    let others = sources.filter(|source| *source != "\"registry+https://github.com/rust-lang/crates.io-index\"");
    Ok(others.map(|source| format!("Cargo.lock: {source} is not crates.io")).collect())
}

/// Of the program as it is built by default.
fn duplicates() -> Done<Vec<String>> {
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (name, version, _) in tree(&["-p", "whirl", "--edges", "normal"])? {
        versions.entry(name).or_default().insert(version);
    }
    let known: BTreeSet<&str> = TWICE.iter().map(|(name, _)| *name).collect();
    let twice: BTreeSet<&str> =
        versions.iter().filter(|(_, all)| all.len() > 1).map(|(name, _)| name.as_str()).collect();
    let newly = twice.difference(&known).map(|name| format!("{name}: {:?} are all in the program", versions[*name]));
    let no_more = known.difference(&twice).map(|name| format!("{name} is listed as being there twice, and is not"));
    Ok(newly.chain(no_more).collect())
}

/// Of our own crates: a name counts as used where it stands before `::`, or after `use`, outside of comments.
fn unused() -> Done<Vec<String>> {
    let metadata: Value = serde_json::from_str(&cargo(&["metadata", "--no-deps", "--format-version", "1"])?)?;
    let text = |value: &Value| value.as_str().map(str::to_owned).ok_or("cargo metadata without a text");
    let list = |value: &Value| value.as_array().cloned().ok_or("cargo metadata without a list");
    let mut faults = Vec::new();
    for package in list(&metadata["packages"])? {
        let (name, manifest) = (text(&package["name"])?, text(&package["manifest_path"])?);
        let folder = Path::new(&manifest).parent().ok_or("a manifest without a folder")?;
        let (mut program, mut all) = (String::new(), String::new());
        gather(&folder.join("src"), &mut program)?;
        gather(folder, &mut all)?;
        for dependency in list(&package["dependencies"])? {
            let crate_name = text(&dependency["name"])?;
            let word = crate_name.replace('-', "_");
            let (in_program, anywhere) = (is_used(&program, &word), is_used(&all, &word));
            // All of this package is tests.
            let is_for_all =
                dependency["kind"].is_null() && dependency["optional"] == Value::Bool(false) && name != "promises";
            if !anywhere {
                faults.push(format!("{name}: {crate_name} is not used"));
            } else if is_for_all && !in_program {
                faults.push(format!("{name}: {crate_name} is used outside of src alone: a dev-dependency"));
            }
        }
    }
    Ok(faults)
}

fn is_used(code: &str, word: &str) -> bool {
    code.match_indices(word).any(|(at, _)| {
        let (before, behind) = (&code[..at], &code[at + word.len()..]);
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        // `::csv::` is the crate, `crate::csv::` is not.
        let path = before.strip_suffix("::").unwrap_or(before);
        let is_whole = !path.ends_with(is_part) && !path.ends_with(['>', ':']);
        is_whole && (behind.starts_with("::") || (before.ends_with("use ") && behind.starts_with([';', ' '])))
    })
}

/// All code below a folder, and what it takes from elsewhere by `#[path]`, without lines that are comments.
fn gather(folder: &Path, code: &mut String) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            gather(&path, code)?;
        } else if path.extension().is_some_and(|end| end == "rs") {
            add(&path, code)?;
        }
    }
    Ok(())
}

fn add(file: &Path, code: &mut String) -> std::io::Result<()> {
    for line in std::fs::read_to_string(file)?.lines().map(str::trim).filter(|line| !line.starts_with("//")) {
        code.push_str(line);
        code.push('\n');
        let elsewhere = line.strip_prefix("#[path = \"").and_then(|rest| rest.strip_suffix("\"]"));
        if let (Some(elsewhere), Some(folder)) = (elsewhere, file.parent()) {
            add(&folder.join(elsewhere), code)?;
        }
    }
    Ok(())
}
