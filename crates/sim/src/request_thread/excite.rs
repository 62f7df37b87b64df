//! What the request thread has to do with excitations of the loop: one at a time, none that would trip, and an event when it is over.

use std::sync::atomic::Ordering;

use machine::{Excitation, Multisine};
use wire::Happening;

use super::RequestThread;
use crate::excitation::{Excited, Present};
use crate::log::When;

impl RequestThread<'_> {
    /// Notes that the excitation is over by itself, if it is.
    pub(super) fn watch_excitation(&mut self) {
        if let Some(ends) = self.excited.as_ref().map(Excited::ends)
            && When::now(self.exchange).tau >= ends.tau
        {
            self.excitation_over(ends);
        }
    }

    /// Notes that there is no excitation any more, if there was one.
    pub(super) fn excitation_over(&mut self, when: When) {
        if self.excited.take().is_some() {
            self.log.note(&Happening::ExcitationOver, when, &self.bench_status);
            self.news = true;
        }
    }

    /// An excitation, ready to begin; or why there must be none.
    pub(super) fn excitation(&self, multisine: &Multisine) -> Result<Box<Excitation>, String> {
        if self.excited.is_some() {
            return Err("the loop is excited already: one at a time".into());
        }
        let recent = self.radii.iter().copied().fold(0.0, f64::max);
        let now = f64::from_bits(self.exchange.counters.radius_bits.load(Ordering::Relaxed));
        let present = Present {
            rotor: self.rotor,
            settings: &self.settings,
            speed: self.speed(),
            radius: recent.max(now),
            is_tripped: self.bench_status.trip.is_tripped(),
        };
        present.excitation(multisine)
    }
}
