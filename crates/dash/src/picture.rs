//! What one frame is drawn from: all panels look at the same moment, the one under the cursor.

use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use rotor::{C64, Rotor, Settings};
use wire::message::{Flags, Trip};
use wire::{Bulletin, RecorderStatus};

use crate::feed::Contact;
use crate::history::{Block, Channel, Era, Mark, STEPS};
use crate::journal::Entry;
use crate::units::Units;

/// Consecutive steps, shared with the history; the first has the index 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Track {
    masses: usize,
    blocks: Vec<Arc<Block>>,
    first: u64,
    /// Index within the first block of the first step.
    skipped: usize,
    len: usize,
}

impl Track {
    /// `len` steps from the one that is `skipped` steps into the first block; its place in the history is `first`.
    pub(crate) fn new(masses: usize, blocks: Vec<Arc<Block>>, first: u64, skipped: usize, len: usize) -> Self {
        Self { masses, blocks, first, skipped, len }
    }

    /// How many masses the rotor of these steps has; 0 before the first.
    pub(crate) fn masses(&self) -> usize {
        self.masses
    }

    /// How many steps there are.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Place in the history of the first step.
    pub(crate) fn first(&self) -> u64 {
        self.first
    }

    /// Displacements `[y, z]` of a mass over some steps.
    pub(crate) fn places(&self, steps: Range<usize>, mass: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
        let (from, to) = (self.skipped + steps.start, self.skipped + steps.end.min(self.len).max(steps.start));
        let blocks = if from < to { from / STEPS..to.div_ceil(STEPS) } else { 0..0 };
        blocks.flat_map(move |at| {
            let within = from.max(at * STEPS) - at * STEPS..to.min((at + 1) * STEPS) - at * STEPS;
            let block = &self.blocks[at];
            let [y, z] = [Channel::Y(mass), Channel::Z(mass)].map(|channel| &block.values(channel)[within.clone()]);
            y.iter().zip(z).map(|(y, z)| [*y, *z])
        })
    }

    /// Place of step `step` in the history: never used twice.
    pub(crate) fn place_of(&self, step: usize) -> u64 {
        self.first + step as u64
    }

    fn block(&self, step: usize) -> (&Block, usize) {
        let at = self.skipped + step;
        (&self.blocks[at / STEPS], at % STEPS)
    }

    /// A quantity at step `step`.
    pub(crate) fn value(&self, channel: Channel, step: usize) -> f64 {
        let (block, at) = self.block(step);
        block.value(channel, at)
    }

    /// The least and the greatest value of a quantity over some steps; `None` if there are none. Cheap over any length.
    pub(crate) fn range(&self, channel: Channel, steps: Range<usize>) -> Option<[f64; 2]> {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let (mut at, end) = (self.skipped + steps.start, self.skipped + steps.end.min(self.len));
        while at < end {
            let block = &self.blocks[at / STEPS];
            let to = (end - at / STEPS * STEPS).min(STEPS);
            block.widen(&mut range, channel, at % STEPS, to);
            at = (at / STEPS + 1) * STEPS;
        }
        (range[0] <= range[1]).then_some(range)
    }

    /// Dimensionless time of step `step`.
    pub(crate) fn tau(&self, step: usize) -> f64 {
        self.value(Channel::Tau, step)
    }

    /// Spin angle at step `step`, in radians.
    pub(crate) fn angle(&self, step: usize) -> f64 {
        self.value(Channel::Angle, step)
    }

    /// Spin speed `R` at step `step`.
    pub(crate) fn speed(&self, step: usize) -> f64 {
        self.value(Channel::Speed, step)
    }

    /// Control `[y, z]` delivered at step `step`.
    pub(crate) fn force(&self, step: usize) -> [f64; 2] {
        [self.value(Channel::ForceY, step), self.value(Channel::ForceZ, step)]
    }

    /// Control `[y, z]` asked for at step `step`.
    pub(crate) fn commanded(&self, step: usize) -> [f64; 2] {
        [self.value(Channel::CommandY, step), self.value(Channel::CommandZ, step)]
    }

    /// Displacement `[y, z]` of a mass at step `step`.
    pub(crate) fn place(&self, step: usize, mass: usize) -> [f64; 2] {
        [self.value(Channel::Y(mass), step), self.value(Channel::Z(mass), step)]
    }

    /// Velocity `[y, z]` of a mass at step `step`.
    pub(crate) fn velocity(&self, step: usize, mass: usize) -> [f64; 2] {
        [self.value(Channel::Vy(mass), step), self.value(Channel::Vz(mass), step)]
    }

    /// When step `step` was due to be sent, nanoseconds since 1970.
    pub(crate) fn wall_ns(&self, step: usize) -> u64 {
        let (block, at) = self.block(step);
        block.wall_ns(at)
    }

    /// What was special about step `step`.
    pub(crate) fn flags(&self, step: usize) -> Flags {
        let (block, at) = self.block(step);
        Flags(block.flags(at))
    }

    /// Divides some steps into at most `count` columns of as many steps each, in order. Their borders stay at the same
    /// steps while the window moves on, so that a plot scrolls and does not flicker.
    pub(crate) fn columns(
        &self,
        steps: Range<usize>,
        count: usize,
    ) -> impl ExactSizeIterator<Item = Range<usize>> + Clone {
        let most = count.saturating_sub(1).max(1);
        let each = steps.len().div_ceil(most).max(1);
        let phase = ((self.first + steps.start as u64) % each as u64) as usize;
        let columns = if steps.is_empty() { 0 } else { (phase + steps.len()).div_ceil(each) };
        (0..columns.min(count)).map(move |column| {
            let from = steps.start + (column * each).saturating_sub(phase);
            let to = steps.start + (column + 1) * each - phase;
            from..to.min(steps.end)
        })
    }
}

/// What one frame is drawn from. Everything is at the cursor's moment, unless it says that it is live.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// Steps around the window and before the cursor.
    pub(crate) track: Track,
    /// The steps in view.
    pub(crate) window: Range<usize>,
    /// A longer look back, for what changes slowly: a minute, or the window if that is longer; ends with the window.
    pub(crate) overview: Range<usize>,
    /// The step under the cursor: while live, the newest.
    pub(crate) now: Option<usize>,
    /// The settings and poles in force at the cursor.
    pub(crate) era: Option<Arc<Era>>,
    /// Those in force over the overview, each with the first step that it holds for.
    pub(crate) eras: Vec<(usize, Arc<Era>)>,
    /// What happened during the overview, each before the step of that number.
    pub(crate) marks: Vec<(usize, Mark)>,
    /// The largest control between the last change of settings or restart and the cursor.
    pub(crate) peak_force: f64,
    /// Seconds from step to step, as the simulation means it; 0 while unknown.
    pub(crate) seconds: f64,
    /// Live: the settings in force, once they are known.
    pub(crate) settings: Option<Settings>,
    /// Live: the rotor, once it is known.
    pub(crate) rotor: Option<Arc<Rotor>>,
    /// Live: the latest bulletin.
    pub(crate) bulletin: Option<Arc<Bulletin>>,
    /// Live: what has happened, the oldest first.
    pub(crate) events: Arc<Vec<Entry>>,
    /// Live: steps that were sent and did not reach us.
    pub(crate) lost: u64,
    /// Live: steps a second that reach us.
    pub(crate) rate: f64,
    /// Live: age of the latest step.
    pub(crate) age: Option<Duration>,
    /// Live: how things stand.
    pub(crate) contact: Contact,
    /// Live: what is known of a recorder.
    pub(crate) recorder: Option<Box<RecorderStatus>>,
    /// A recorder was started here, and has not spoken up yet.
    pub(crate) recorder_starts: bool,
    /// Live: whether the machine has tripped.
    pub(crate) tripped: bool,
    /// Steps from the cursor to the newest one.
    pub(crate) behind: u64,
}

impl Picture {
    /// How many masses have been heard of.
    pub(crate) fn masses(&self) -> usize {
        self.track.masses
    }

    /// The minimum damping and the poles, least damped first, if they are known.
    pub(crate) fn poles(&self) -> Option<(f64, &[C64])> {
        let era = self.era.as_ref()?;
        (!era.poles.is_empty()).then_some((era.min_damping, &era.poles))
    }

    /// The units that things are shown in.
    pub(crate) fn units(&self) -> Units {
        let scales = self.bulletin.as_ref().and_then(|bulletin| bulletin.scales());
        let mass = self.era.as_ref().and_then(|era| {
            let rotor = era.rotor.as_ref().or(self.rotor.as_ref())?;
            Some(rotor.masses().get(era.settings.feedback.bearing)?.mass)
        });
        // Before the first step no era is known, but the scales may be.
        Units::of(scales, mass.or(scales.map(|_| 1.0)))
    }

    /// The least minimum damping that was in force over some steps, if any is known.
    pub(crate) fn least_damping(&self, steps: &Range<usize>) -> Option<f64> {
        let from = self.eras.partition_point(|(first, _)| *first <= steps.start).saturating_sub(1);
        let over = self.eras.iter().skip(from).take_while(|(first, _)| *first < steps.end.max(steps.start + 1));
        over.filter(|(_, era)| !era.poles.is_empty()).map(|(_, era)| era.min_damping).reduce(f64::min)
    }

    /// The trip, while there is one; live.
    pub(crate) fn trip(&self) -> Option<Trip> {
        self.bulletin.as_ref().map(|bulletin| bulletin.trip).filter(Trip::is_tripped)
    }

    /// How long before the newest step the cursor is.
    pub(crate) fn ago(&self) -> Duration {
        Duration::from_secs_f64((self.behind as f64 * self.seconds).clamp(0.0, 1e9))
    }
}
