//! The program under test: `whirl` itself, with the same `main`.

fn main() -> std::process::ExitCode {
    whirl::main()
}
