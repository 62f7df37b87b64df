//! Writes the messages for Python: `cargo run -p wire --example python -- crates/wire/python/whirl/messages.py`.

fn main() -> std::io::Result<()> {
    let path = std::env::args_os().nth(1).unwrap_or_else(|| "messages.py".into());
    std::fs::write(path, wire::python::text())
}
