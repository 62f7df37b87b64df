//! A run of consecutive steps in columns, with the range of every column over groups of them: drawing a million steps
//! then looks at thousands of ranges.

use wire::State;

/// Steps in a block.
pub(crate) const STEPS: usize = 1024;
/// Steps whose range is kept.
const GROUP: usize = 64;

/// One quantity of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    /// Dimensionless time.
    Tau,
    /// Spin angle in radians, unwrapped.
    Angle,
    /// Spin speed `R`.
    Speed,
    /// Control delivered along y.
    ForceY,
    /// Control delivered along z.
    ForceZ,
    /// Control asked for along y.
    CommandY,
    /// Control asked for along z.
    CommandZ,
    /// Displacement of a mass along y.
    Y(usize),
    /// Displacement of a mass along z.
    Z(usize),
    /// Velocity of a mass along y.
    Vy(usize),
    /// Velocity of a mass along z.
    Vz(usize),
    /// Magnitude of the control delivered.
    Force,
    /// Magnitude of the control asked for.
    Command,
    /// Distance of a mass from the centre.
    Radius(usize),
}

/// Columns before those of the masses.
const HEAD: usize = 7;
/// Columns of a mass.
const OF_MASS: usize = 4;

/// Columns that are kept for `masses` masses.
const fn kept(masses: usize) -> usize {
    HEAD + OF_MASS * masses
}

/// Columns whose ranges are kept: those, and the magnitudes.
const fn ranged(masses: usize) -> usize {
    kept(masses) + 2 + masses
}

impl Channel {
    /// Its place among the columns, for a rotor of `masses` masses.
    fn column(self, masses: usize) -> usize {
        let of_mass = |mass: usize, which: usize| HEAD + OF_MASS * mass + which;
        match self {
            Self::Tau => 0,
            Self::Angle => 1,
            Self::Speed => 2,
            Self::ForceY => 3,
            Self::ForceZ => 4,
            Self::CommandY => 5,
            Self::CommandZ => 6,
            Self::Y(mass) => of_mass(mass, 0),
            Self::Z(mass) => of_mass(mass, 1),
            Self::Vy(mass) => of_mass(mass, 2),
            Self::Vz(mass) => of_mass(mass, 3),
            Self::Force => kept(masses),
            Self::Command => kept(masses) + 1,
            Self::Radius(mass) => kept(masses) + 2 + mass,
        }
    }
}

/// No values yet: whatever is added becomes the range.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn widen(range: &mut [f64; 2], other: [f64; 2]) {
    *range = [range[0].min(other[0]), range[1].max(other[1])];
}

/// Up to [`STEPS`] steps.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    masses: usize,
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
    /// An empty block for a rotor of `masses` masses.
    pub(crate) fn new(masses: usize) -> Self {
        Self {
            masses,
            len: 0,
            values: vec![0.0; STEPS * kept(masses)].into(),
            groups: vec![NOTHING; STEPS / GROUP * ranged(masses)].into(),
            whole: vec![NOTHING; ranged(masses)].into(),
            wall_ns: vec![0; STEPS].into(),
            flags: vec![0; STEPS].into(),
        }
    }

    /// Bytes of a block for `masses` masses.
    pub(crate) const fn bytes(masses: usize) -> usize {
        size_of::<Self>() + STEPS * (8 * kept(masses) + 8 + 4) + 16 * (STEPS / GROUP + 1) * ranged(masses)
    }

    /// How many steps it holds.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Takes in one step of a rotor of as many masses. The block must not be full.
    pub(crate) fn push(&mut self, state: &State) {
        let at = self.len;
        self.wall_ns[at] = state.wall_ns;
        self.flags[at] = state.flags.0;
        let group = at / GROUP * ranged(self.masses);
        let mut place = |column: usize, value: f64| {
            widen(&mut self.groups[group + column], [value; 2]);
            widen(&mut self.whole[column], [value; 2]);
            if let Some(place) = self.values.get_mut(column * STEPS + at) {
                *place = value;
            }
        };
        let ([u_y, u_z], [c_y, c_z]) = (state.force_delivered, state.force_commanded);
        let head = [state.tau, state.angle, state.speed, u_y, u_z, c_y, c_z];
        head.into_iter().enumerate().for_each(|(column, value)| place(column, value));
        for (mass, point) in state.points().iter().enumerate() {
            place(Channel::Y(mass).column(self.masses), point.y);
            place(Channel::Z(mass).column(self.masses), point.z);
            place(Channel::Vy(mass).column(self.masses), point.vy);
            place(Channel::Vz(mass).column(self.masses), point.vz);
            place(Channel::Radius(mass).column(self.masses), point.radius());
        }
        place(Channel::Force.column(self.masses), u_y.hypot(u_z));
        place(Channel::Command.column(self.masses), c_y.hypot(c_z));
        self.len += 1;
    }

    /// A quantity at step `at`.
    pub(crate) fn value(&self, channel: Channel, at: usize) -> f64 {
        let of = |channel: Channel| self.values[channel.column(self.masses) * STEPS + at];
        match channel {
            Channel::Force => of(Channel::ForceY).hypot(of(Channel::ForceZ)),
            Channel::Command => of(Channel::CommandY).hypot(of(Channel::CommandZ)),
            Channel::Radius(mass) => of(Channel::Y(mass)).hypot(of(Channel::Z(mass))),
            channel => of(channel),
        }
    }

    /// A quantity of its own, over all steps that there is room for.
    pub(crate) fn values(&self, channel: Channel) -> &[f64] {
        let column = channel.column(self.masses);
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
    pub(crate) fn widen(&self, range: &mut [f64; 2], channel: Channel, from: usize, to: usize) {
        let column = channel.column(self.masses);
        if from == 0 && to == self.len {
            widen(range, self.whole[column]);
            return;
        }
        let mut at = from;
        while at < to {
            let group_ends = (at / GROUP + 1) * GROUP;
            if at.is_multiple_of(GROUP) && group_ends <= to {
                widen(range, self.groups[at / GROUP * ranged(self.masses) + column]);
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
