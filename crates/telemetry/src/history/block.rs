//! A run of consecutive steps in columns, with the range of every column over groups of them: drawing a million steps
//! then looks at thousands of ranges.

use wire::{Channel, PAIRS, Pair, Step, StepLayout};

/// Steps in a block.
pub(crate) const STEPS: usize = 1024;
/// Steps whose range is kept.
const GROUP: usize = 64;

/// One quantity of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepQuantity {
    /// A number that is told, of a mass or sensor counted from 0; of what occurs once, 0.
    Of(Channel, usize),
    /// The size of a pair of [`PAIRS`], by its place in the table, of a mass or sensor.
    Size(usize, usize),
}

impl StepQuantity {
    /// Dimensionless time.
    pub const TAU: Self = Self::Of(Channel::Tau, 0);
    /// Spin angle in radians, unwrapped.
    pub const ANGLE: Self = Self::Of(Channel::Angle, 0);
    /// Spin speed `R`.
    pub const SPEED: Self = Self::Of(Channel::Speed, 0);
    /// Control delivered along y.
    pub const FORCE_Y: Self = Self::Of(Channel::ForceY, 0);
    /// Control delivered along z.
    pub const FORCE_Z: Self = Self::Of(Channel::ForceZ, 0);
    /// Control asked for along y.
    pub const COMMAND_Y: Self = Self::Of(Channel::CommandY, 0);
    /// Control asked for along z.
    pub const COMMAND_Z: Self = Self::Of(Channel::CommandZ, 0);
    /// Magnitude of the control delivered.
    pub const FORCE: Self = Self::size(Channel::ForceY, 0);

    /// Size of the control delivered by a control bearing, counted from 0.
    #[must_use]
    pub const fn force(bearing: usize) -> Self {
        let (channels, index) = wire::force_channels(bearing);
        Self::size(channels[1][0], index)
    }

    /// The control bearing, counted from 0, of whose control it tells; nothing of any other quantity.
    #[must_use]
    pub fn bearing(self) -> Option<usize> {
        match self {
            Self::Of(channel, index) => wire::bearing_of(channel, index),
            Self::Size(pair, index) => wire::bearing_of(PAIRS[pair].channels[0], index),
        }
    }

    /// Displacement of a mass along y.
    pub const fn y(mass: usize) -> Self {
        Self::Of(Channel::Y, mass)
    }

    /// Displacement of a mass along z.
    pub const fn z(mass: usize) -> Self {
        Self::Of(Channel::Z, mass)
    }

    /// Distance of a mass from the centre.
    pub const fn radius(mass: usize) -> Self {
        Self::size(Channel::Y, mass)
    }

    /// The size of the pair that begins with `y`.
    pub const fn size(y: Channel, index: usize) -> Self {
        let mut pair = 0;
        while PAIRS[pair].channels[0] as usize != y as usize {
            pair += 1;
        }
        Self::Size(pair, index)
    }

    /// Its place among the columns, of those whose ranges are kept.
    fn column(self, layout: StepLayout) -> usize {
        match self {
            Self::Of(channel, index) => layout.place(channel, index) - wire::WHOLES,
            Self::Size(pair, index) => layout.numbers() + sizes(layout, pair) + index,
        }
    }
}

/// Sizes that come before those of pair `pair`.
fn sizes(layout: StepLayout, pair: usize) -> usize {
    PAIRS[..pair].iter().map(|pair| layout.count(scope_of(pair))).sum()
}

fn scope_of(pair: &Pair) -> wire::Scope {
    pair.channels[0].row().scope
}

/// Columns whose ranges are kept: the numbers of a step, and the sizes of its pairs.
fn ranged(layout: StepLayout) -> usize {
    layout.numbers() + sizes(layout, PAIRS.len())
}

/// No values yet: whatever is added becomes the range.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn widen(range: &mut [f64; 2], other: [f64; 2]) {
    *range = [range[0].min(other[0]), range[1].max(other[1])];
}

/// Up to [`STEPS`] steps.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    layout: StepLayout,
    /// Columns whose ranges are kept.
    ranged: usize,
    len: usize,
    /// Column after column, [`STEPS`] values each.
    values: Box<[f64]>,
    /// Group after group, the range of every column.
    groups: Box<[[f64; 2]]>,
    /// The range of every column over the block.
    whole: Box<[[f64; 2]]>,
    wall_ns: Box<[u64]>,
    flags: Box<[u32]>,
}

impl Block {
    /// An empty block for steps of this layout.
    pub(crate) fn new(layout: StepLayout) -> Self {
        let ranged = ranged(layout);
        Self {
            layout,
            ranged,
            len: 0,
            values: vec![0.0; STEPS * layout.numbers()].into(),
            groups: vec![NOTHING; STEPS / GROUP * ranged].into(),
            whole: vec![NOTHING; ranged].into(),
            wall_ns: vec![0; STEPS].into(),
            flags: vec![0; STEPS].into(),
        }
    }

    /// Bytes of a block for steps of this layout.
    pub(crate) fn bytes(layout: StepLayout) -> usize {
        size_of::<Self>() + STEPS * (8 * layout.numbers() + 8 + 4) + 16 * (STEPS / GROUP + 1) * ranged(layout)
    }

    /// How many steps it holds.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Takes in one step of the same layout. The block must not be full.
    pub(crate) fn push(&mut self, step: &impl Step) {
        let at = self.len;
        self.wall_ns[at] = step.wall_ns();
        self.flags[at] = step.flags().0;
        let group = at / GROUP * self.ranged;
        let mut range = |column: usize, value: f64| {
            widen(&mut self.groups[group + column], [value; 2]);
            widen(&mut self.whole[column], [value; 2]);
        };
        for (column, value) in step.numbers().enumerate() {
            range(column, value);
            self.values[column * STEPS + at] = value;
        }
        let mut column = self.layout.numbers();
        for pair in &PAIRS {
            for index in 0..self.layout.count(scope_of(pair)) {
                let [y, z] = pair.channels.map(|channel| step.number(channel, index));
                range(column, y.hypot(z));
                column += 1;
            }
        }
        self.len += 1;
    }

    /// A quantity at step `at`.
    pub(crate) fn value(&self, channel: StepQuantity, at: usize) -> f64 {
        match channel {
            StepQuantity::Of(..) => self.values[channel.column(self.layout) * STEPS + at],
            StepQuantity::Size(pair, index) => {
                let [y, z] = PAIRS[pair].channels.map(|part| self.value(StepQuantity::Of(part, index), at));
                y.hypot(z)
            }
        }
    }

    /// A quantity of its own, over all steps that there is room for.
    pub(crate) fn values(&self, channel: StepQuantity) -> &[f64] {
        let column = channel.column(self.layout);
        &self.values[column * STEPS..(column + 1) * STEPS]
    }

    /// When step `at` was due to be sent.
    pub(crate) fn wall_ns(&self, at: usize) -> u64 {
        self.wall_ns[at]
    }

    /// What was special about step `at`.
    pub(crate) fn flags(&self, at: usize) -> u32 {
        self.flags[at]
    }

    /// Widens `range` by the values of a quantity over the steps `from..to` of this block.
    pub(crate) fn widen(&self, range: &mut [f64; 2], channel: StepQuantity, from: usize, to: usize) {
        let column = channel.column(self.layout);
        if from == 0 && to == self.len {
            widen(range, self.whole[column]);
            return;
        }
        let mut at = from;
        while at < to {
            let group_ends = (at / GROUP + 1) * GROUP;
            if at.is_multiple_of(GROUP) && group_ends <= to {
                widen(range, self.groups[at / GROUP * self.ranged + column]);
            } else {
                let steps = at..group_ends.min(to);
                match self.values.get(column * STEPS..(column + 1) * STEPS) {
                    Some(values) => values[steps].iter().for_each(|value| widen(range, [*value; 2])),
                    None => steps.for_each(|at| widen(range, [self.value(channel, at); 2])),
                }
            }
            at = group_ends;
        }
    }
}
