//! The `whirl` binary: everything is in the library, so that other packages can test it whole.

fn main() -> std::process::ExitCode {
    whirl::main()
}
