//! What is added to the command for a while, so that the loop can be measured: where the law's output becomes the command, before delay,
//! lag and limits. The command over it is then the sensitivity.

use super::Controller;
use crate::state_words::StateWords;
use crate::{C64, Excitation};

impl Controller {
    /// Takes an excitation that has begun, or none, in place of the one that it has, which is left in its place.
    pub fn excite(&mut self, excitation: &mut Option<Box<Excitation>>) {
        std::mem::swap(&mut self.excitation, excitation);
        self.is_exciting = false;
    }

    /// Whether an excitation goes on after `tau`.
    #[must_use]
    pub fn is_excited(&self, tau: f64) -> bool {
        self.excitation.as_ref().is_some_and(|excitation| excitation.until() > tau + self.tolerance)
    }

    /// When something jumps next; infinite in a continuous loop that is not excited.
    #[must_use]
    pub fn next_event(&self) -> f64 {
        let excited = self.excitation.as_ref().filter(|_| self.is_exciting).map_or(f64::INFINITY, |e| e.until());
        self.next_sample_event().min(excited)
    }

    /// Ends the excitation, and keeps its memory: to be freed with the loop, or by who takes it out.
    pub fn stop_excitation(&mut self) {
        self.is_exciting = false;
        if let Some(excitation) = &mut self.excitation {
            excitation.stop();
        }
    }

    #[inline]
    pub(super) fn excited(&self, command: C64, tau: f64) -> C64 {
        match &self.excitation {
            Some(excitation) if self.is_exciting => command + excitation.at(tau),
            _ => command,
        }
    }

    #[inline]
    pub(super) fn excited_rate(&self, rate: C64, tau: f64) -> C64 {
        match &self.excitation {
            Some(excitation) if self.is_exciting => rate + excitation.rate_at(tau),
            _ => rate,
        }
    }

    /// Writes down the excitation, if it goes on after `tau`.
    pub fn save_excitation(&self, tau: f64, words: &mut StateWords) {
        if let Some(excitation) = self.excitation.as_ref().filter(|_| self.is_excited(tau)) {
            excitation.save(words);
        }
    }

    /// Takes up an excitation that was written down, if one was; a loop that was not excited then is not now. `None` if the words do not fit.
    #[must_use]
    pub fn restore_excitation(&mut self, words: &mut StateWords) -> Option<()> {
        self.is_exciting = false;
        self.excitation = match words.is_at_end() {
            true => None,
            false => Some(Box::new(Excitation::restored(words)?)),
        };
        Some(())
    }
}
