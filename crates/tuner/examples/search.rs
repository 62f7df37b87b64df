//! A gain search: `cargo run --release -p tuner --example search`.

#![allow(clippy::print_stdout, reason = "it prints what it finds")]

use std::error::Error;

use rotor::{builtin, file};
use tuner::{Family, Options, Problem, Schedule, Stop, Structure, Tuned, tune};

fn main() -> Result<(), Box<dyn Error>> {
    let found = search(0.0, 6.0)?;
    println!("# least damping {:.6} at R = {:.4}", found.worst.value, found.worst.point[0]);
    print!("{}", file::write_feedback(&found.feedback));
    Ok(())
}

/// One set of gains for the three-mass rotor that damps its worst mode best over all speeds of a range: control bearing at
/// mass 1, sensors at masses 1 and 2, one weighted signal, no gain beyond 5.
pub(crate) fn search(from: f64, to: f64) -> Result<Tuned, Box<dyn Error>> {
    let rotor = builtin::rotor("three-mass").ok_or("it is built in")?;
    let family = Family::new(&rotor, from, to)?;
    let structure = Structure::new(&rotor, &Structure::composite(3, 0, &[0, 1]), Schedule::Fixed)?;
    let problem = Problem::new(family, structure, 5.0);
    Ok(tune(&problem, &Options::for_problem(&problem), &|_| (), Stop::NEVER)?)
}
