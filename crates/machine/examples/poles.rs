//! The poles of a rotor of your own over speed: `cargo run -p machine --example poles -- mine.toml`.

#![allow(clippy::print_stdout, reason = "it prints what it finds")]

use std::error::Error;

use machine::MachinePoles;
use rotor::{Settings, builtin, file};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("expected the file of a rotor, as `whirl rotor show` prints one")?;
    for (speed, poles) in poles(&std::fs::read_to_string(path)?, &[0.0, 1.0, 2.0, 3.0])? {
        for mode in &poles.modes {
            println!("R = {speed}  {:9.5}  damping {:8.5}  {}", mode.pole, mode.damping(), mode.whirl());
        }
    }
    Ok(())
}

/// The poles of the rotor in a file, without control, at each of some speeds; the least damped first.
pub(crate) fn poles(text: &str, speeds: &[f64]) -> Result<Vec<(f64, MachinePoles)>, Box<dyn Error>> {
    let rotor = file::read_rotor(text, "mine")?;
    let off = builtin::feedback(&rotor, "off").ok_or("every rotor can do without control")?;
    let settings = Settings::new(&rotor, 0.0, off);
    speeds.iter().map(|&speed| Ok((speed, MachinePoles::at(&rotor, &settings, speed)?))).collect()
}
