//! A reader of telemetry: `cargo run -p wire --example watch -- NAME` tells once a second how far a running bench whirls.

#![allow(clippy::print_stdout, reason = "it prints what it hears")]

use std::error::Error;
use std::time::Duration;

use wire::{BenchName, Carrier, HostState, Listener, Root, SharedMemory, Step};

fn main() -> Result<(), Box<dyn Error>> {
    let bench: BenchName = std::env::args().nth(1).as_deref().unwrap_or("default").parse()?;
    let mut listener = SharedMemory::new(&Root::from_environment()?, "watch")?.listen(&bench)?;
    while listener.host() == HostState::Alive {
        std::thread::sleep(Duration::from_secs(1));
        if let Some((tau, radius)) = largest(&mut listener)? {
            println!("tau = {tau:.2}: at most {radius:.4} e_t since the last line");
        }
    }
    Ok(())
}

/// The largest orbit of any mass in all steps since the last call, and the time of the last step; `None` if none came.
pub(crate) fn largest(listener: &mut impl Listener) -> Result<Option<(f64, f64)>, wire::WireError> {
    let mut found: Option<(f64, f64)> = None;
    listener.drain(|step| {
        let before = found.map_or(0.0, |(_, radius)| radius);
        found = Some((step.tau(), step.largest_radius().max(before)));
    })?;
    Ok(found)
}
