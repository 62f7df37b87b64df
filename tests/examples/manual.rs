//! Writes the manual into a folder: `cargo run -p promises --example manual -- docs`.

use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("docs"), PathBuf::from);
    promises::manual::write(&folder)
}
