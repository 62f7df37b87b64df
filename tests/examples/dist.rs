//! A release in one file: `cargo run -p promises --example dist` builds the program optimised and makes, in `target/dist`,
//! `whirl-VERSION-TARGET.tar.gz` (program, man pages, completions, the C header, licences of it and of all that is in it) and its SHA-256
//! beside it, as `sha256sum --check` reads it. Behind `--` may be features of the program, as `--features rerun`.
//!
//! It needs `tar` and `sha256sum`, as every Linux has them.

#![expect(clippy::print_stdout, reason = "it says what it has made")]

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use promises::paper::top;
use serde_json::Value;

type Done<T> = Result<T, Box<dyn Error>>;

fn main() -> Done<()> {
    let features = features(std::env::args().skip(1))?;
    let build = ["build", "--release", "--locked", "-p", "whirl"];
    run(Command::new("cargo").args(build).args(&features).current_dir(top()))?;
    let asked = ["metadata", "--locked", "--format-version", "1"];
    let metadata: Value = serde_json::from_str(&run(Command::new("cargo").args(asked).current_dir(top()))?)?;
    let target =
        PathBuf::from(metadata["target_directory"].as_str().ok_or("cargo metadata without a target directory")?);
    let name = format!("whirl-{}-{}", env!("CARGO_PKG_VERSION"), host()?);
    let dist = target.join("dist");
    let folder = dist.join(&name);
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(folder.join("bin"))?;
    fs::copy(target.join("release/whirl"), folder.join("bin/whirl"))?;
    for (from, to) in [("docs/man", "share/man"), ("docs/completions", "share/completions")] {
        copy_all(&top().join(from), &folder.join(to))?;
    }
    fs::create_dir_all(folder.join("include"))?;
    fs::copy(top().join("crates/wire/whirl.h"), folder.join("include/whirl.h"))?;
    for paper in ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(top().join(paper), folder.join(paper))?;
    }
    let (licences, crates, without) = licences(&metadata, &features)?;
    fs::write(folder.join("LICENCES-OF-DEPENDENCIES"), licences)?;
    let archive = format!("{name}.tar.gz");
    // The same files make the same archive: in order, of nobody, at one time.
    let same = ["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mtime=2020-01-01 00:00Z"];
    run(Command::new("tar")
        .args(same)
        .args(["--use-compress-program=gzip -n", "-cf", &archive, &name])
        .current_dir(&dist))?;
    let sum = run(Command::new("sha256sum").arg(&archive).current_dir(&dist))?;
    fs::write(dist.join(format!("{archive}.sha256")), &sum)?;
    println!("{}", dist.join(&archive).display());
    println!(
        "{} bytes, sha256 {}",
        fs::metadata(dist.join(&archive))?.len(),
        sum.split(' ').next().unwrap_or_default()
    );
    println!("licences of {crates} crates, of which {without} bring no text and are named with their licence alone");
    Ok(())
}

/// What was asked for, which decides which crates are in the program; anything else would make another program than the one that is packed.
fn features(asked: impl Iterator<Item = String>) -> Done<Vec<String>> {
    let mut features = Vec::new();
    let mut is_list = false;
    for word in asked {
        let is_known = is_list
            || ["--features", "--all-features", "--no-default-features"].contains(&word.as_str())
            || word.starts_with("--features=");
        if !is_known {
            return Err(format!("{word}: expected --features LIST, --all-features or --no-default-features").into());
        }
        is_list = word == "--features";
        features.push(word);
    }
    Ok(features)
}

/// Runs a command, and gives what it prints.
fn run(command: &mut Command) -> Done<String> {
    let output =
        command.stderr(std::process::Stdio::inherit()).output().map_err(|error| format!("{command:?}: {error}"))?;
    if !output.status.success() {
        return Err(format!("{command:?}: {}", output.status).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// The target that rustc builds for here.
fn host() -> Done<String> {
    let told = run(Command::new("rustc").arg("-vV"))?;
    Ok(told.lines().find_map(|line| line.strip_prefix("host: ")).ok_or("rustc does not say its host")?.to_owned())
}

fn copy_all(from: &Path, to: &Path) -> Done<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        fs::copy(entry.path(), to.join(entry.file_name()))?;
    }
    Ok(())
}

/// The licences of every crate that is in the program, each text once; how many crates there are, and how many bring no text.
fn licences(metadata: &Value, features: &[String]) -> Done<(String, usize, usize)> {
    let tree = ["tree", "--locked", "-p", "whirl", "--edges", "normal", "--prefix", "none", "--format", "{p}"];
    let listed = run(Command::new("cargo").args(tree).args(features).current_dir(top()))?;
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let (mut out, mut crates, mut without) =
        (String::from("Whirl is made of these crates, under these licences. Their texts follow.\n\n"), 0, 0);
    let packages = metadata["packages"].as_array().ok_or("cargo metadata without packages")?;
    for package in packages.iter().filter(|package| !package["source"].is_null()) {
        let text = |key: &str| package[key].as_str().unwrap_or_default();
        let name = format!("{} v{}", text("name"), text("version"));
        if !listed.lines().any(|line| line.trim_end_matches(" (*)").trim_end_matches(" (proc-macro)") == name) {
            continue;
        }
        crates += 1;
        out += &format!("{name}: {}\n", text("license"));
        let found = texts_in(Path::new(text("manifest_path")).parent().ok_or("a manifest without a folder")?)?;
        without += usize::from(found.is_empty());
        for text in found {
            texts.entry(text).or_default().push(name.clone());
        }
    }
    for (text, of) in texts {
        out += &format!("\n{}\n{}\n\n{}\n", "=".repeat(80), of.join(", "), text.trim_end());
    }
    Ok((out, crates, without))
}

/// The texts of licences and notices in the folder of a crate.
fn texts_in(folder: &Path) -> Done<Vec<String>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_uppercase();
        if path.is_file()
            && ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"].iter().any(|begin| name.starts_with(begin))
        {
            found.push(String::from_utf8_lossy(&fs::read(&path)?).replace("\r\n", "\n"));
        }
    }
    found.sort();
    Ok(found)
}
