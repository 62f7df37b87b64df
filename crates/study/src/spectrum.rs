//! Samples of an orbit for its [full spectrum](spectrum), taken while it runs.

use std::io;

use machine::Machine;
use rotor::C64;
pub use spectrum::{Peak, Spectrum, SpectrumError, segment_length, welch};

use crate::run::Observer;

/// Samples kept at most: the first half of them is given up for more, as a spectrum needs only the end of a long run.
const MOST_SAMPLES: usize = 1 << 22;

/// Keeps every so-many-th sample of one mass's orbit.
#[derive(Clone, Debug)]
pub struct Collector {
    mass: usize,
    stride: u64,
    from: f64,
    seen: u64,
    samples: Vec<C64>,
    times: (f64, f64),
}

impl Collector {
    /// Follows mass `mass`, counted from 0, from `from` on, keeping one sample in `stride` (at least 1).
    ///
    /// The samples are evenly spaced only if no impulse falls in between: let `from` be after the last one.
    #[must_use]
    pub fn new(mass: usize, stride: u64, from: f64) -> Self {
        Self { mass, stride: stride.max(1), from, seen: 0, samples: Vec::new(), times: (0.0, 0.0) }
    }

    /// The samples from `from` on, and the time between two.
    #[must_use]
    pub fn samples_from(&self, from: f64) -> (&[C64], f64) {
        let count = self.samples.len();
        if count < 2 {
            return (&self.samples, 0.0);
        }
        let apart = (self.times.1 - self.times.0) / (count - 1) as f64;
        let skipped = ((from - self.times.0) / apart - 1e-6).ceil().clamp(0.0, count as f64) as usize;
        (&self.samples[skipped..], apart)
    }
}

impl Observer for Collector {
    fn sample(&mut self, machine: &Machine) -> io::Result<()> {
        let motion = machine.motion();
        if motion.tau < self.from - 1e-9 {
            return Ok(());
        }
        // The sample before an impulse and the one after it are at the same time: one is enough.
        let again = self.seen > 0 && motion.tau == self.times.1 && self.stride == 1;
        if self.seen.is_multiple_of(self.stride) && !again {
            if self.samples.is_empty() {
                self.times.0 = motion.tau;
            }
            self.times.1 = motion.tau;
            if self.samples.len() == MOST_SAMPLES {
                let apart = (self.times.1 - self.times.0) / MOST_SAMPLES as f64;
                self.samples.drain(..MOST_SAMPLES / 2);
                self.times.0 += apart * (MOST_SAMPLES / 2) as f64;
            }
            self.samples.push(motion.displacement.get(self.mass).copied().unwrap_or_default());
        }
        self.seen += 1;
        Ok(())
    }
}
