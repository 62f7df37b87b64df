//! A controller outside a bench, which does what the built-in feedback `individual` of the three-mass rotor does:
//!
//! ```text
//! whirl sim three-mass --bench lab --feedback individual --set sample=0.01 --set delay=0.01 --set external=20 &
//! cargo run --release -p wire --example controller -- lab
//! ```
//!
//! With `whirl sim --lockstep` the machine waits for it. With a number behind the name it ends after so many commands.

#![allow(clippy::print_stdout, reason = "it says how it went")]

use std::error::Error;
use std::time::{Duration, Instant};

use wire::{BenchName, Carrier, Controlling, HostState, Readings, Root, SharedMemory};

/// Of each sensor `[kd, cd, kc, cc]`: `u = - sum [(kd - j kc) p + (cd - j cc) p']`.
const GAINS: [[f64; 4]; 2] = [[4.0, 3.1168, 3.1241, 0.9175], [-2.3419, 4.0, -3.7635, 4.0]];

/// How long to look for readings without giving the processor away.
const SPIN: Duration = Duration::from_micros(50);

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let bench: BenchName = arguments.next().as_deref().unwrap_or("default").parse()?;
    let most: u64 = arguments.next().map_or(Ok(u64::MAX), |most| most.parse())?;
    let mut controller = SharedMemory::new(&Root::from_environment()?, "controller")?.controller(&bench)?;
    let (mut count, mut idle, mut ages, mut began) = (0, Instant::now(), Ages::default(), None::<Instant>);
    while count < most {
        let Some(readings) = newest(&mut controller)? else {
            if idle.elapsed() > Duration::from_secs(1) {
                if controller.host() == HostState::Gone {
                    break;
                }
                idle = Instant::now();
            } else if idle.elapsed() > SPIN {
                std::thread::sleep(Duration::from_micros(20));
            }
            continue;
        };
        let mut command = readings.answer(law(&readings));
        command.stamp();
        controller.command(&command)?;
        ages.add(command.wall_ns.saturating_sub(readings.wall_ns));
        began.get_or_insert_with(Instant::now);
        (count, idle) = (count + 1, Instant::now());
    }
    let seconds = began.map_or(0.0, |began| began.elapsed().as_secs_f64());
    let [half, most] = [0.5, 0.99].map(|share| ages.quantile(share));
    println!(
        "{count} commands, {:.0}/s, sent {half} us after the readings at the median, {most} us at the 99th percentile",
        count as f64 / seconds
    );
    Ok(())
}

/// How long after the readings commands were sent: counts for every microsecond.
struct Ages(Vec<u64>);

impl Default for Ages {
    fn default() -> Self {
        Self(vec![0; 10_000])
    }
}

impl Ages {
    fn add(&mut self, ns: u64) {
        let place = (ns / 1000).min(self.0.len() as u64 - 1) as usize;
        self.0[place] += 1;
    }

    fn quantile(&self, share: f64) -> usize {
        let all = self.0.iter().sum::<u64>() as f64;
        let mut below = 0;
        let found = self.0.iter().position(|count| {
            below += count;
            below as f64 >= share * all
        });
        found.unwrap_or(0)
    }
}

/// The newest readings: what waits before them would be answered too late.
fn newest(controller: &mut impl Controlling) -> Result<Option<Readings>, wire::WireError> {
    let mut found = None;
    while let Some(readings) = controller.readings()? {
        found = Some(readings);
    }
    Ok(found)
}

/// The law, in the order in which the bench itself computes it, so that the last bit agrees.
pub(crate) fn law(readings: &Readings) -> [f64; 2] {
    let mut command = [0.0; 2];
    for ([kd, cd, kc, cc], [y, z, vy, vz]) in GAINS.into_iter().zip(readings.readings) {
        // (kd - j kc) (y + j z), and the same of the velocity.
        let on_displacement = [kd * y - (-kc) * z, kd * z + (-kc) * y];
        let on_velocity = [cd * vy - (-cc) * vz, cd * vz + (-cc) * vy];
        command[0] -= on_displacement[0] + on_velocity[0];
        command[1] -= on_displacement[1] + on_velocity[1];
    }
    command
}
