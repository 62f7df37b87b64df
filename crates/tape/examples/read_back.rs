//! A recording read back: `cargo run -p tape --features rerun --example read_back -- recordings/run-up.rrd`.

#![allow(clippy::print_stdout, reason = "it prints what it reads")]

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

use tape::Recording;
use wire::Step;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("expected a recording, FILE.rrd")?;
    let (speed, tau, radius) = widest(Path::new(&path))?;
    println!("the widest orbit: {radius:.4} e_t, at tau = {tau:.2} and R = {speed:.4}");
    Ok(())
}

/// Speed, time and size of the widest orbit of any mass in all of a recording, whatever changed and tripped under way.
pub(crate) fn widest(path: &Path) -> Result<(f64, f64, f64), tape::TapeError> {
    let mut recording = Recording::open(path)?;
    let mut found = (0.0, 0.0, 0.0);
    recording.visit(0..u64::MAX, 1, |step| {
        if step.largest_radius() > found.2 {
            found = (step.speed(), step.tau(), step.largest_radius());
        }
        ControlFlow::Continue(())
    })?;
    Ok(found)
}
