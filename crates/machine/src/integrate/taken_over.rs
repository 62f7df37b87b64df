//! What an integrator holds, written down and taken up again, and taken over by another one.

use control::{Controller, Output, StateWords};

use super::{Integrator, seen};

impl Integrator {
    /// Writes down the excitation, if there is one that goes on after `tau`: of a control bearing after the first, its number before.
    pub(crate) fn save_excitation(&self, tau: f64, words: &mut StateWords) {
        let Some(bearing) = self.controllers.iter().position(|controller| controller.is_excited(tau)) else { return };
        if self.controllers.len() > 1 {
            words.put(bearing as u64);
        }
        self.controllers[bearing].save_excitation(tau, words);
    }

    /// Takes up an excitation that was written down, if one was. `None` if the words do not fit.
    pub(crate) fn restore_excitation(&mut self, words: &mut StateWords) -> Option<()> {
        self.controllers.iter_mut().for_each(Controller::stop_excitation);
        let several = self.controllers.len() > 1 && !words.is_at_end();
        let bearing = if several { words.take()? as usize } else { 0 };
        self.controllers.get_mut(bearing)?.restore_excitation(words)
    }

    /// Begins the loops in the middle of a motion, whose outputs were these.
    pub(crate) fn start(&mut self, outputs: &[Output], tau: f64, speed: f64) {
        let n = self.order();
        let Self { plant, controllers, state, stage: spare, stations, .. } = self;
        let looked = seen(plant, stations, state, tau, 0.0, speed);
        let mut into = &mut spare[2 * n..];
        for (k, controller) in controllers.iter_mut().enumerate() {
            let (own, rest) = into.split_at_mut(controller.order());
            controller.start(outputs.get(k).copied().unwrap_or_default(), &looked, own);
            into = rest;
        }
        state[2 * n..].copy_from_slice(&spare[2 * n..]);
    }

    /// Takes over the motion of another plant and loop at `tau`: what they hold goes on as far as it still means something.
    pub(crate) fn adopt(&mut self, other: &Self, tau: f64, speed: f64) {
        let n = self.order();
        self.state[..2 * n].copy_from_slice(&other.state[..2 * n]);
        let Self { plant, controllers, state, stage: spare, stations, .. } = self;
        let looked = seen(plant, stations, state, tau, 0.0, speed);
        let (mut from, mut into) = (&other.state[2 * n..], &mut spare[2 * n..]);
        for (k, controller) in controllers.iter_mut().enumerate() {
            let (own, rest) = into.split_at_mut(controller.order());
            match other.controllers.get(k) {
                Some(before) => {
                    let (held, rest_of_held) = from.split_at(before.order());
                    controller.adopt(before, held, &looked, own);
                    from = rest_of_held;
                }
                None => controller.start(Output::default(), &looked, own),
            }
            into = rest;
        }
        state[2 * n..].copy_from_slice(&spare[2 * n..]);
    }

    /// Words that it saves at most.
    pub(crate) fn words_at_most(&self) -> usize {
        1 + 2 * self.state.len() + self.controllers.iter().map(Controller::words_at_most).sum::<usize>()
    }

    pub(crate) fn save(&self, words: &mut StateWords) {
        words.put(self.state.len() as u64);
        self.state.iter().for_each(|z| words.put_c64(*z));
        self.controllers.iter().for_each(|controller| controller.save(words));
    }

    pub(crate) fn restore(&mut self, words: &mut StateWords) -> Option<()> {
        words.take().filter(|width| *width == self.state.len() as u64)?;
        for z in &mut self.state {
            *z = words.take_c64()?;
        }
        self.controllers.iter_mut().try_for_each(|controller| controller.restore(words))
    }
}
