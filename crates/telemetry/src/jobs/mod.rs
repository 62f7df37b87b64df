//! Analysis that the simulation does not send along: poles and damping over speed, spectra. Too long for the drawing thread,
//! so it is asked for there and computed on a [`Desk`].

mod latest;
pub mod over_speed;
mod spectra;

use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::Sender;

pub use latest::Latest;
pub use over_speed::{OverSpeed, Question};
pub use spectra::{Fall, Orbit, OrbitSpectrum, Over, Row, Waterfall};

/// How long a frame may wait for what a person is typing at this moment.
const PART_OF_A_FRAME: Duration = Duration::from_millis(12);

/// What is being computed for the panels. Asking hardly waits: it brings the newest answer there is.
#[derive(Debug)]
pub struct Desk {
    current: Latest<Question, OverSpeed>,
    candidate: Latest<Question, OverSpeed>,
    spectrum: Latest<Orbit, OrbitSpectrum>,
    falls: [Latest<Fall, Waterfall>; 2],
}

impl Desk {
    /// A desk with threads of its own, which end with it. Every answer puts a token into `wake`.
    ///
    /// # Errors
    /// No thread can be started.
    pub fn open(wake: &Sender<()>) -> std::io::Result<Self> {
        let wake = {
            let wake = wake.clone();
            move || {
                // A token that still lies there will do.
                let _ = wake.try_send(());
            }
        };
        Ok(Self {
            current: Latest::spawn("over-speed", OverSpeed::of, wake.clone())?,
            candidate: Latest::spawn("what-if", OverSpeed::of, wake.clone())?,
            spectrum: Latest::spawn("spectrum", OrbitSpectrum::of, wake.clone())?,
            falls: [
                Latest::spawn("waterfall", Waterfall::of, wake.clone())?,
                Latest::spawn("waterfall", Waterfall::of, wake)?,
            ],
        })
    }

    /// A desk that answers at once, on the thread that asks: for pictures and tests.
    pub fn at_once() -> Self {
        Self {
            current: Latest::inline(OverSpeed::of),
            candidate: Latest::inline(OverSpeed::of),
            spectrum: Latest::inline(OrbitSpectrum::of),
            falls: [Latest::inline(Waterfall::of), Latest::inline(Waterfall::of)],
        }
    }

    /// Poles and damping over speed of the settings in force; for a moment, of those before.
    pub fn over_speed(&self, question: &Question) -> Option<Arc<OverSpeed>> {
        self.current.ask(question)
    }

    /// The same of settings that would be: theirs and no others. Waits a part of a frame; nothing if it takes longer.
    pub fn over_speed_of_candidate(&self, question: &Question) -> Option<Arc<OverSpeed>> {
        self.candidate.ask_for(question, PART_OF_A_FRAME)
    }

    /// The spectrum of an orbit; for a moment, of an earlier one.
    pub fn spectrum(&self, orbit: &Orbit) -> Option<Arc<OrbitSpectrum>> {
        self.spectrum.ask(orbit)
    }

    /// Rows of spectra; for a moment, earlier ones.
    pub fn waterfall(&self, fall: &Fall) -> Option<Arc<Waterfall>> {
        let [time, speed] = &self.falls;
        match fall.over {
            Over::Time => time.ask(fall),
            Over::Speed => speed.ask(fall),
        }
    }
}
