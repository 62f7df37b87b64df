//! Writes the page of JSON fields, asked of the program: `cargo build -p promises && cargo run -p promises --example json -- docs/book/src/json.md`.

use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let page = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("json.md"), PathBuf::from);
    std::fs::write(page, promises::reference::json(&|words| promises::run(words).json()))
}
