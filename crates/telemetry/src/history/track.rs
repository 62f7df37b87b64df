//! A stretch of the history, for whoever draws it.

use std::ops::Range;
use std::sync::Arc;

use wire::StepLayout;
use wire::message::Flags;

use super::block::{Block, STEPS, StepQuantity};

/// Consecutive steps, shared with the history; the first has the index 0.
#[derive(Clone, Debug, Default)]
pub struct Track {
    layout: StepLayout,
    blocks: Vec<Arc<Block>>,
    first: u64,
    /// Index within the first block of the first step.
    skipped: usize,
    len: usize,
}

impl Track {
    /// `len` steps from the one that is `skipped` steps into the first block; its place in the history is `first`.
    pub(crate) fn new(layout: StepLayout, blocks: Vec<Arc<Block>>, first: u64, skipped: usize, len: usize) -> Self {
        Self { layout, blocks, first, skipped, len }
    }

    /// The steps of some places among these; shares all of them.
    #[must_use]
    pub fn part(&self, over: &Range<u64>) -> Self {
        let end = over.end.clamp(self.first, self.first + self.len as u64);
        let start = over.start.clamp(self.first, end);
        let [from, to] = [start, end].map(|place| self.skipped + (place - self.first) as usize);
        let blocks = self.blocks.get(from / STEPS..to.div_ceil(STEPS)).unwrap_or_default().to_vec();
        Self { layout: self.layout, blocks, first: start, skipped: from % STEPS, len: to - from }
    }

    /// How many masses the rotor of these steps has; 0 before the first.
    pub fn masses(&self) -> usize {
        self.layout.masses()
    }

    /// What is told of a step.
    pub fn layout(&self) -> StepLayout {
        self.layout
    }

    /// How many steps there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Index in the history of the first step.
    pub fn first(&self) -> u64 {
        self.first
    }

    /// Displacements `[y, z]` of a mass over some steps.
    pub fn displacements(&self, steps: Range<usize>, mass: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
        let (from, to) = (self.skipped + steps.start, self.skipped + steps.end.min(self.len).max(steps.start));
        let blocks = if from < to { from / STEPS..to.div_ceil(STEPS) } else { 0..0 };
        blocks.flat_map(move |at| {
            let within = from.max(at * STEPS) - at * STEPS..to.min((at + 1) * STEPS) - at * STEPS;
            let block = &self.blocks[at];
            let [y, z] =
                [StepQuantity::y(mass), StepQuantity::z(mass)].map(|channel| &block.values(channel)[within.clone()]);
            y.iter().zip(z).map(|(y, z)| [*y, *z])
        })
    }

    /// Place of step `step` in the history: never used twice.
    pub fn index_of(&self, step: usize) -> u64 {
        self.first + step as u64
    }

    fn block(&self, step: usize) -> (&Block, usize) {
        let at = self.skipped + step;
        (&self.blocks[at / STEPS], at % STEPS)
    }

    /// A quantity at step `step`.
    pub fn value(&self, channel: StepQuantity, step: usize) -> f64 {
        let (block, at) = self.block(step);
        block.value(channel, at)
    }

    /// The least and the greatest value of a quantity over some steps; `None` if there are none. Cheap over any length.
    pub fn range(&self, channel: StepQuantity, steps: Range<usize>) -> Option<[f64; 2]> {
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
    pub fn tau(&self, step: usize) -> f64 {
        self.value(StepQuantity::TAU, step)
    }

    /// Spin angle at step `step`, in radians.
    pub fn angle(&self, step: usize) -> f64 {
        self.value(StepQuantity::ANGLE, step)
    }

    /// Spin speed `R` at step `step`.
    pub fn speed(&self, step: usize) -> f64 {
        self.value(StepQuantity::SPEED, step)
    }

    /// Control `[y, z]` delivered at step `step`.
    pub fn force(&self, step: usize) -> [f64; 2] {
        [self.value(StepQuantity::FORCE_Y, step), self.value(StepQuantity::FORCE_Z, step)]
    }

    /// Control `[y, z]` asked for at a control bearing, counted from 0, at step `step`, and what it delivers.
    pub fn forces(&self, step: usize, bearing: usize) -> [[f64; 2]; 2] {
        let (channels, index) = wire::force_channels(bearing);
        channels.map(|pair| pair.map(|channel| self.value(StepQuantity::Of(channel, index), step)))
    }

    /// Control `[y, z]` asked for at step `step`.
    pub fn commanded(&self, step: usize) -> [f64; 2] {
        [self.value(StepQuantity::COMMAND_Y, step), self.value(StepQuantity::COMMAND_Z, step)]
    }

    /// Displacement `[y, z]` of a mass at step `step`.
    pub fn displacement(&self, step: usize, mass: usize) -> [f64; 2] {
        [self.value(StepQuantity::y(mass), step), self.value(StepQuantity::z(mass), step)]
    }

    /// Velocity `[y, z]` of a mass at step `step`.
    pub fn velocity(&self, step: usize, mass: usize) -> [f64; 2] {
        [
            self.value(StepQuantity::Of(wire::Channel::Vy, mass), step),
            self.value(StepQuantity::Of(wire::Channel::Vz, mass), step),
        ]
    }

    /// When step `step` was due to be sent, nanoseconds since 1970.
    pub fn wall_ns(&self, step: usize) -> u64 {
        let (block, at) = self.block(step);
        block.wall_ns(at)
    }

    /// What was special about step `step`.
    pub fn flags(&self, step: usize) -> Flags {
        let (block, at) = self.block(step);
        Flags(block.flags(at))
    }

    /// Divides some steps into at most `count` columns of as many steps each, in order. Their borders stay at the same
    /// steps while the window moves on, so that a plot scrolls and does not flicker.
    pub fn columns(&self, steps: Range<usize>, count: usize) -> impl ExactSizeIterator<Item = Range<usize>> + Clone {
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
