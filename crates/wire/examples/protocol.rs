//! Writes the page of the protocol: `cargo run -p wire --example protocol -- docs/book/src/protocol.md`.

fn main() -> std::io::Result<()> {
    let path = std::env::args_os().nth(1).unwrap_or_else(|| "protocol.md".into());
    std::fs::write(path, wire::protocol::page())
}
