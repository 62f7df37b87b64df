//! A machine written down, and taken up again to go on to the last bit.

use control::StateWords;

use super::{Grid, Machine, Path, Trip, TripCause};

/// The first of the words that a machine writes down: raised when the rest means something else, so that words of another
/// version fit nowhere.
const FORM: u64 = 1;
/// Set beside the path in machines whose fused path takes a changing speed.
const FUSES_RAMPS: u64 = 1 << 2;

impl Machine {
    /// Words that [`Machine::save`] writes at most: with room for them it allocates nothing.
    #[must_use]
    pub fn words_at_most(&self) -> usize {
        self.program.words_at_most()
    }

    /// Writes down everything that decides how it goes on, beside its program.
    pub fn save(&self, words: &mut StateWords) {
        words.put(FORM);
        words.put_f64(self.program.dtau);
        words.put(self.path as u64 | if self.fuses_ramps { FUSES_RAMPS } else { 0 });
        words.put_f64(self.grid.from);
        words.put(self.grid.steps);
        words.put_f64(self.grid.dtau);
        self.motion.save(words);
        for output in self.outputs() {
            words.put_c64(output.commanded);
            words.put_c64(output.delivered);
            words.put(u64::from(output.saturated));
        }
        match self.trip {
            None => words.put(0),
            Some(Trip { cause, station, radius, limit }) => {
                words.put(cause as u64);
                words.put(station as u64);
                words.put_f64(radius);
                words.put_f64(limit);
            }
        }
        let sample = self.sample();
        sample.displacement.iter().chain(sample.velocity).for_each(|z| words.put_c64(*z));
        if self.path == Path::Integrated {
            self.program.integrator.save(words);
            // Last, and only while there is one: words of a machine that is not excited are those that they always were.
            self.program.integrator.save_excitation(self.tau(), words);
        }
    }

    /// How long a step was of the machine that wrote these words down; `None` if they are of another form.
    #[must_use]
    pub fn saved_dtau(words: &[u64]) -> Option<f64> {
        match words {
            [FORM, dtau, ..] => Some(f64::from_bits(*dtau)),
            _ => None,
        }
    }

    /// Takes up what a machine with this very program wrote down, to go on to the last bit.
    ///
    /// Returns whether the words fit; a machine that they do not fit is at rest again.
    #[must_use]
    pub fn restore(&mut self, words: &mut StateWords) -> bool {
        let dtau = self.program.dtau;
        let done = self.take_up(words).is_some() && words.is_at_end();
        if !done {
            self.program.dtau = dtau;
            self.grid.dtau = self.program.inner_step();
            self.restart();
        }
        done
    }

    fn take_up(&mut self, words: &mut StateWords) -> Option<()> {
        words.take().filter(|form| *form == FORM)?;
        self.program.dtau = words.take_f64()?;
        let path = words.take()?;
        let fuses_ramps = path & FUSES_RAMPS != 0;
        let path = match path & !FUSES_RAMPS {
            0 => Path::Integrated,
            1 => Path::Steady,
            2 => Path::Changing,
            _ => return None,
        };
        self.grid = Grid { from: words.take_f64()?, steps: words.take()?, dtau: words.take_f64()? };
        self.motion.restore(words)?;
        for output in &mut self.outputs[..self.program.bearings()] {
            output.commanded = words.take_c64()?;
            output.delivered = words.take_c64()?;
            output.saturated = words.take()? != 0;
        }
        self.trip = match words.take()? {
            0 => None,
            cause => Some(Trip {
                cause: TripCause::of(cause)?,
                station: words.take()? as usize,
                radius: words.take_f64()?,
                limit: words.take_f64()?,
            }),
        };
        for z in self.good.iter_mut().flatten() {
            *z = words.take_c64()?;
        }
        let [displacement, velocity] = &self.good;
        if path == Path::Integrated {
            self.program.integrator.restore(words)?;
        } else {
            let (fused, program) = (self.fused.as_mut()?, self.program.fused.as_ref()?);
            fused.load(&program.steady);
            fused.place(displacement, velocity);
            if path == Path::Steady {
                fused.set_clock(self.grid.from, self.motion.angle_from(), self.grid.steps, self.grid.dtau);
            }
        }
        self.program.integrator.restore_excitation(words)?;
        (self.path, self.fuses_ramps) = (path, fuses_ramps);
        Some(())
    }
}
