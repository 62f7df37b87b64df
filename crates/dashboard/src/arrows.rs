//! Modules of this crate name each other one way. Actions and panels, say, may be read, changed and tested apart.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Which modules each module names, tests left out.
fn named() -> BTreeMap<String, BTreeSet<String>> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut named: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut open = vec![(source, None::<String>)];
    while let Some((folder, module)) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let module = module.clone().unwrap_or_else(|| stem.clone());
            match path.extension() {
                None if !["tests", "snapshots"].contains(&&*stem) => open.push((path, Some(module))),
                Some(kind) if kind == "rs" && !["tests", "fuzz", "arrows", "lib"].contains(&&*stem) => {
                    let text = fs::read_to_string(path).unwrap();
                    named.entry(module).or_default().extend(names_in(&text));
                }
                _ => {}
            }
        }
    }
    for (module, names) in &mut named {
        names.remove(module);
    }
    named
}

/// The modules of this crate that a source names before its tests.
fn names_in(text: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let code = code.split("#[cfg(test)]\npub(crate) mod tests {").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let mut names = BTreeSet::new();
    for part in lines.flat_map(|line| line.split("crate::").skip(1)) {
        let part = part.split([';', '}']).next().unwrap_or_default();
        let several = part.strip_prefix('{').map(|list| list.split(", ").collect::<Vec<_>>());
        for path in several.unwrap_or_else(|| vec![part]) {
            names.insert(path.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect());
        }
    }
    names
}

#[test]
fn no_two_modules_name_each_other_however_far_round() {
    let mut named = named();
    assert!(named.len() > 25 && named["app"].contains("panels") && named["screen"].contains("popup"), "{named:?}");
    // Those that name none that is left are at the bottom; what is left at the end goes round.
    while let Some(bottom) = named.iter().find(|(_, names)| names.iter().all(|name| !named.contains_key(name))) {
        let bottom = bottom.0.clone();
        named.remove(&bottom);
    }
    assert!(named.is_empty(), "these name each other: {named:?}");
}

#[test]
fn the_data_of_a_console_knows_no_terminal() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../telemetry/Cargo.toml");
    let manifest = fs::read_to_string(manifest).unwrap();
    assert!(manifest.contains("wire"));
    for library in ["ratatui", "crossterm", "tui-", "dashboard"] {
        assert!(!manifest.contains(library), "telemetry names {library}");
    }
}
