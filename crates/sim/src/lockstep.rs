//! The stepping thread of a bench that waits for its controller: as fast as both can, and bit for bit the same every time.
//!
//! Nothing of it is in real time, so nothing is late: deadlines and lateness are those of steps that are due when they are made.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use wire::{ControlHost, StateSender, WireError};

use crate::engine::{Engine, Exchange};
use crate::external::{External, Ready};
use crate::pacer::Wake;

/// Looks at the queue without giving the processor away: a controller that answers at once takes some microseconds.
const SPINS: u32 = 2000;
/// Looks that give way to others.
const YIELDS: u32 = 20_000;
/// Then, how long to sleep between two looks.
const NAP: Duration = Duration::from_micros(500);
/// How often readers of the readings that have come since are given them.
const WELCOME: Duration = Duration::from_millis(5);

/// Steps until `stop`.
pub(crate) fn step_until(
    stop: &AtomicBool,
    mut states: impl StateSender,
    mut engine: Engine,
    mut external: External<impl ControlHost>,
    exchange: &Exchange,
    answering: &std::thread::Thread,
) -> Result<(), WireError> {
    let (mut looks, mut welcomed) = (0, Instant::now());
    while !stop.load(Ordering::Relaxed) {
        let ordered = engine.take_orders(exchange);
        engine.save(ordered, exchange);
        let begun = match external.before_step(&mut engine, exchange, crate::wall_ns())? {
            Ready::Yes => None,
            Ready::Tripped(trip) => Some(trip),
            Ready::NotYet => {
                if ordered {
                    answering.unpark();
                }
                looks += 1;
                if looks < SPINS {
                    std::hint::spin_loop();
                } else if looks < YIELDS {
                    std::thread::yield_now();
                } else {
                    std::thread::sleep(NAP);
                }
                if looks > SPINS && welcomed.elapsed() > WELCOME {
                    external.welcome()?;
                    welcomed = Instant::now();
                }
                continue;
            }
        };
        looks = 0;
        let tripped = begun.or(engine.step());
        states.send(1, |_, row| engine.fill(row, crate::wall_ns(), false))?;
        if let Some(trip) = tripped {
            exchange.report_trip(trip, engine.tau());
        }
        if ordered || tripped.is_some() {
            answering.unpark();
        }
        if engine.is_held() {
            // It stands still, and so do its readers.
            std::thread::sleep(NAP);
        }
        exchange.counters.count(&Wake::single(), engine.tau(), engine.speed());
        exchange.counters.reach(engine.largest_radius());
    }
    Ok(())
}
