//! What a loop holds, written down and taken up again to the last bit.

use super::Controller;
use crate::delay_line::DelayLine;
use crate::state_words::StateWords;

impl Controller {
    /// Writes down all it holds beside its continuous states.
    pub fn save(&self, words: &mut StateWords) {
        words.put(self.next_sample);
        words.put(u64::from(self.output.saturated));
        for z in [self.acting, self.output.commanded, self.output.delivered] {
            words.put_c64(z);
        }
        self.sampled.iter().chain(self.reading.iter().flatten()).for_each(|z| words.put_c64(*z));
        words.put(self.waiting.len() as u64);
        for (time, command) in &self.waiting {
            words.put_f64(*time);
            words.put_c64(*command);
        }
        if let Some(noise) = &self.noise {
            words.put(noise.random.get_seed());
            noise.displacement.iter().chain(&noise.velocity).for_each(|z| words.put_c64(*z));
        }
        if let Some(line) = &self.line {
            line.save(words);
        }
    }

    /// Words that [`Controller::save`] writes at most.
    #[must_use]
    pub fn words_at_most(&self) -> usize {
        let sensors = self.sensors.len();
        let noise = self.noise.as_ref().map_or(0, |_| 1 + 4 * sensors);
        let line = self.line.as_ref().map_or(0, DelayLine::words_at_most);
        9 + 2 * self.sampled.len() + 4 * sensors + 3 * self.waiting.capacity() + noise + line
    }

    /// Takes up what was written down by a loop like this. `None` if the words do not fit; it is then in no good state.
    #[must_use]
    pub fn restore(&mut self, words: &mut StateWords) -> Option<()> {
        self.next_sample = words.take()?;
        self.output.saturated = words.take()? != 0;
        self.acting = words.take_c64()?;
        self.output.commanded = words.take_c64()?;
        self.output.delivered = words.take_c64()?;
        for z in self.sampled.iter_mut().chain(self.reading.iter_mut().flatten()) {
            *z = words.take_c64()?;
        }
        self.waiting.clear();
        for _ in 0..words.take()? {
            let entry = (words.take_f64()?, words.take_c64()?);
            if self.waiting.len() == self.waiting.capacity() {
                return None;
            }
            self.waiting.push_back(entry);
        }
        if let Some(noise) = &mut self.noise {
            noise.random = fastrand::Rng::with_seed(words.take()?);
            for z in noise.displacement.iter_mut().chain(&mut noise.velocity) {
                *z = words.take_c64()?;
            }
        }
        match &mut self.line {
            Some(line) => line.restore(words),
            None => Some(()),
        }
    }
}
