//! Writes the C header of the messages: `cargo run -p wire --example header -- crates/wire/whirl.h`.

fn main() -> std::io::Result<()> {
    let path = std::env::args_os().nth(1).unwrap_or_else(|| "whirl.h".into());
    std::fs::write(path, wire::header::text())
}
