//! A step as words: how they are laid out, and views of them.
//!
//! A step is a row of 64-bit words, one a channel ([`crate::CHANNELS`]), doubles as their bits, as wide as the rotor needs.
//! Rows lie one after the other in a message, filled and read where they lie. Each says itself how many masses and sensors it
//! has, so that no reader takes a row of another run for one of this.

use rotor::{MAX_MASSES, Rotor};

use crate::channels::{Channel, Scope, WHOLES, channels_of};
use crate::message::Flags;

/// How a step's words are laid out: how many masses and sensors there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Layout {
    masses: u16,
    sensors: u16,
}

/// Words of the widest step.
pub const MAX_WIDTH: usize = Layout::new(MAX_MASSES).width();

/// A channel, of one mass or sensor where it has many: one word of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Column {
    /// The channel.
    pub channel: Channel,
    /// The mass or sensor, counted from 0; 0 for what occurs once.
    pub index: usize,
}

impl Column {
    /// Its name in files: `tau`, `y1`.
    #[must_use]
    pub fn name(self) -> String {
        let row = self.channel.row();
        if row.scope == Scope::Once { row.name.to_owned() } else { format!("{}{}", row.name, self.index + 1) }
    }

    /// What it is, in words.
    #[must_use]
    pub fn meaning(self) -> String {
        let row = self.channel.row();
        match row.scope {
            Scope::Once => row.meaning.to_owned(),
            Scope::Mass => format!("{}, of mass {}", row.meaning, self.index + 1),
            Scope::Sensor => format!("{}, at mass {}", row.meaning, self.index + 1),
        }
    }
}

impl Layout {
    /// The layout for a rotor of so many masses, with a sensor at each; of more than [`MAX_MASSES`], for those.
    #[must_use]
    pub const fn new(masses: usize) -> Self {
        let masses = if masses < MAX_MASSES { masses } else { MAX_MASSES } as u16;
        Self { masses, sensors: masses }
    }

    /// The layout for a rotor.
    #[must_use]
    pub fn of(rotor: &Rotor) -> Self {
        Self::new(rotor.len())
    }

    /// The layout that a word of flags tells of; `None` if no step has one like this.
    #[must_use]
    pub fn told_by(flags: u64) -> Option<Self> {
        let told = Self { masses: (flags >> 32) as u16, sensors: (flags >> 48) as u16 };
        (told == Self::new(told.masses())).then_some(told)
    }

    /// How many masses there are.
    #[must_use]
    pub const fn masses(self) -> usize {
        self.masses as usize
    }

    /// How many sensors there are.
    #[must_use]
    pub const fn sensors(self) -> usize {
        self.sensors as usize
    }

    /// How often a channel of this scope occurs.
    #[must_use]
    pub const fn count(self, scope: Scope) -> usize {
        match scope {
            Scope::Once => 1,
            Scope::Mass => self.masses(),
            Scope::Sensor => self.sensors(),
        }
    }

    /// Words of a step.
    #[must_use]
    pub const fn width(self) -> usize {
        channels_of(Scope::Once)
            + self.masses() * channels_of(Scope::Mass)
            + self.sensors() * channels_of(Scope::Sensor)
    }

    /// Doubles of a step: its last words.
    #[must_use]
    pub const fn numbers(self) -> usize {
        self.width() - WHOLES
    }

    /// Where a channel's word is; for what occurs once `index` is 0.
    #[must_use]
    pub const fn place(self, channel: Channel, index: usize) -> usize {
        let once = channels_of(Scope::Once);
        let within = channel.place_in_scope();
        match channel.row().scope {
            Scope::Once => within,
            Scope::Mass => once + index * channels_of(Scope::Mass) + within,
            Scope::Sensor => {
                once + self.masses() * channels_of(Scope::Mass) + index * channels_of(Scope::Sensor) + within
            }
        }
    }

    /// Every word of a step, in order.
    pub fn columns(self) -> impl Iterator<Item = Column> + Clone {
        [Scope::Once, Scope::Mass, Scope::Sensor].into_iter().flat_map(move |scope| {
            let of_scope = crate::CHANNELS.iter().filter(move |row| row.scope == scope).map(|row| row.channel);
            (0..self.count(scope)).flat_map(move |index| of_scope.clone().map(move |channel| Column { channel, index }))
        })
    }

    /// Every double of a step, in order.
    pub fn number_columns(self) -> impl Iterator<Item = Column> + Clone {
        self.columns().skip(WHOLES)
    }
}

/// Where one mass is and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Displacement along y.
    pub y: f64,
    /// Displacement along z.
    pub z: f64,
    /// Velocity along y.
    pub vy: f64,
    /// Velocity along z.
    pub vz: f64,
}

impl Point {
    /// Distance from the centre.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.y.hypot(self.z)
    }
}

/// A step, wherever its words lie.
pub trait Step {
    /// How its words are laid out.
    fn layout(&self) -> Layout;

    /// Its words: [`Layout::width`] of them.
    fn words(&self) -> &[u64];

    /// The word of a channel that occurs once.
    fn word(&self, channel: Channel) -> u64 {
        self.words()[self.layout().place(channel, 0)]
    }

    /// A channel's double.
    fn number(&self, channel: Channel, index: usize) -> f64 {
        f64::from_bits(self.words()[self.layout().place(channel, index)])
    }

    /// All its doubles, in the order of [`Layout::number_columns`].
    fn numbers(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.words()[WHOLES..].iter().map(|word| f64::from_bits(*word))
    }

    /// Which run of which process.
    fn run_id(&self) -> u64 {
        self.word(Channel::RunId)
    }

    /// Number of the step since the process started.
    fn seq(&self) -> u64 {
        self.word(Channel::Seq)
    }

    /// Wall clock when it was due, nanoseconds since 1970.
    fn wall_ns(&self) -> u64 {
        self.word(Channel::WallNs)
    }

    /// Revision of the settings that it was made with.
    fn revision(&self) -> u64 {
        self.word(Channel::Revision)
    }

    /// What is special about it.
    fn flags(&self) -> Flags {
        Flags(self.word(Channel::Flags) as u32)
    }

    /// Dimensionless time.
    fn tau(&self) -> f64 {
        self.number(Channel::Tau, 0)
    }

    /// Spin angle in radians.
    fn angle(&self) -> f64 {
        self.number(Channel::Angle, 0)
    }

    /// Spin speed `R`.
    fn speed(&self) -> f64 {
        self.number(Channel::Speed, 0)
    }

    /// Its rate of change.
    fn speed_rate(&self) -> f64 {
        self.number(Channel::SpeedRate, 0)
    }

    /// Control `[y, z]` that the feedback asks for.
    fn force_commanded(&self) -> [f64; 2] {
        [Channel::CommandY, Channel::CommandZ].map(|channel| self.number(channel, 0))
    }

    /// Control `[y, z]` that the bearing delivers.
    fn force_delivered(&self) -> [f64; 2] {
        [Channel::ForceY, Channel::ForceZ].map(|channel| self.number(channel, 0))
    }

    /// How many masses there are.
    fn masses(&self) -> usize {
        self.layout().masses()
    }

    /// Where a mass is, counted from 0, and how it moves.
    fn point(&self, mass: usize) -> Point {
        let [y, z, vy, vz] =
            [Channel::Y, Channel::Z, Channel::Vy, Channel::Vz].map(|channel| self.number(channel, mass));
        Point { y, z, vy, vz }
    }

    /// The same of every mass.
    fn points(&self) -> impl ExactSizeIterator<Item = Point> + '_ {
        (0..self.masses()).map(|mass| self.point(mass))
    }

    /// The largest distance of a mass from the centre.
    fn largest_radius(&self) -> f64 {
        self.points().map(|point| point.radius()).fold(0.0, f64::max)
    }

    /// What the loop reads of a sensor, counted from 0, as `[y, z]`.
    fn reading(&self, sensor: usize) -> [f64; 2] {
        [Channel::ReadingY, Channel::ReadingZ].map(|channel| self.number(channel, sensor))
    }
}

/// A step in a message.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    layout: Layout,
    words: &'a [u64],
}

impl<'a> Row<'a> {
    /// The rows of a message, one after the other; what is no row, which only a foreign writer can send, ends them.
    pub fn all(words: &'a [u64]) -> impl Iterator<Item = Self> {
        let mut rest = words;
        std::iter::from_fn(move || {
            let layout = Layout::told_by(*rest.get(Channel::Flags as usize)?)?;
            let (words, after) = rest.split_at_checked(layout.width())?;
            rest = after;
            Some(Self { layout, words })
        })
    }
}

impl Step for Row<'_> {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn words(&self) -> &[u64] {
        self.words
    }
}

/// A step in a message that is being filled.
#[derive(Debug)]
pub struct RowMut<'a> {
    layout: Layout,
    words: &'a mut [u64],
}

impl<'a> RowMut<'a> {
    /// The first words of `words` as a step of this layout; `None` if they are too few.
    pub fn new(layout: Layout, words: &'a mut [u64]) -> Option<Self> {
        let mut row = Self { layout, words: words.get_mut(..layout.width())? };
        row.set_flags(Flags::default());
        Some(row)
    }

    /// Sets the word of a channel that occurs once.
    pub fn set_word(&mut self, channel: Channel, word: u64) {
        self.words[self.layout.place(channel, 0)] = word;
    }

    /// Sets a channel's double.
    pub fn set(&mut self, channel: Channel, index: usize, number: f64) {
        self.words[self.layout.place(channel, index)] = number.to_bits();
    }

    /// Sets a channel pair's doubles.
    pub fn set_pair(&mut self, [y, z]: [Channel; 2], index: usize, [of_y, of_z]: [f64; 2]) {
        self.set(y, index, of_y);
        self.set(z, index, of_z);
    }

    /// Sets all doubles, in the order of [`Layout::number_columns`].
    pub fn set_numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.words[WHOLES..].iter_mut().zip(numbers).for_each(|(word, number)| *word = number.to_bits());
    }

    /// Says what is special about the step.
    pub fn set_flags(&mut self, flags: Flags) {
        let Layout { masses, sensors } = self.layout;
        let word = u64::from(flags.0) | u64::from(masses) << 32 | u64::from(sensors) << 48;
        self.set_word(Channel::Flags, word);
    }

    /// Says where a mass is, counted from 0, and how it moves.
    pub fn set_point(&mut self, mass: usize, point: Point) {
        let Point { y, z, vy, vz } = point;
        self.set_pair([Channel::Y, Channel::Z], mass, [y, z]);
        self.set_pair([Channel::Vy, Channel::Vz], mass, [vy, vz]);
    }
}

impl Step for RowMut<'_> {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn words(&self) -> &[u64] {
        self.words
    }
}

/// A step of one's own.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct State {
    layout: Layout,
    words: [u64; MAX_WIDTH],
}

impl State {
    /// A step that is all zero.
    #[must_use]
    pub fn new(layout: Layout) -> Self {
        let mut made = Self { layout, words: [0; MAX_WIDTH] };
        made.row_mut().set_flags(Flags::default());
        made
    }

    /// A copy of a step.
    #[must_use]
    pub fn of(step: &impl Step) -> Self {
        let mut made = Self { layout: step.layout(), words: [0; MAX_WIDTH] };
        made.words[..step.words().len()].copy_from_slice(step.words());
        made
    }

    /// It, to be filled.
    pub fn row_mut(&mut self) -> RowMut<'_> {
        let width = self.layout.width();
        RowMut { layout: self.layout, words: &mut self.words[..width] }
    }

    /// The same with another word for a channel that occurs once.
    #[must_use]
    pub fn with_word(mut self, channel: Channel, word: u64) -> Self {
        self.row_mut().set_word(channel, word);
        self
    }

    /// The same with another double for a channel.
    #[must_use]
    pub fn with(mut self, channel: Channel, index: usize, number: f64) -> Self {
        self.row_mut().set(channel, index, number);
        self
    }

    /// The same with other flags.
    #[must_use]
    pub fn with_flags(mut self, flags: Flags) -> Self {
        self.row_mut().set_flags(flags);
        self
    }

    /// The same with a mass somewhere else; what is read of it follows, as by an ideal sensor.
    #[must_use]
    pub fn with_point(mut self, mass: usize, point: Point) -> Self {
        let mut row = self.row_mut();
        row.set_point(mass, point);
        row.set_pair([Channel::ReadingY, Channel::ReadingZ], mass, [point.y, point.z]);
        self
    }
}

impl Default for State {
    fn default() -> Self {
        Self::new(Layout::default())
    }
}

impl Step for State {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn words(&self) -> &[u64] {
        &self.words[..self.layout.width()]
    }
}

impl std::fmt::Debug for State {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut all = f.debug_struct("State");
        for (column, word) in self.layout.columns().zip(self.words()) {
            if column.channel.is_number() {
                all.field(&column.name(), &f64::from_bits(*word));
            } else {
                all.field(&column.name(), word);
            }
        }
        all.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_three_masses_takes_248_bytes_and_the_widest_872() {
        assert_eq!((Layout::new(3).width() * 8, MAX_WIDTH * 8), (248, 872));
    }

    #[test]
    fn every_column_has_the_place_that_the_layout_gives_it() {
        for masses in [0, 1, 3, MAX_MASSES] {
            let layout = Layout::new(masses);
            let columns: Vec<Column> = layout.columns().collect();
            assert_eq!((columns.len(), layout.number_columns().count()), (layout.width(), layout.numbers()));
            for (at, column) in columns.into_iter().enumerate() {
                assert_eq!(layout.place(column.channel, column.index), at, "{}", column.name());
            }
        }
        let names: Vec<String> = Layout::new(2).columns().map(Column::name).collect();
        assert_eq!(names[..6], ["run_id", "seq", "wall_ns", "revision", "flags", "tau"]);
        assert_eq!(
            names[13..],
            [
                "y1",
                "z1",
                "vy1",
                "vz1",
                "y2",
                "z2",
                "vy2",
                "vz2",
                "reading_y1",
                "reading_z1",
                "reading_y2",
                "reading_z2"
            ]
        );
    }

    #[test]
    fn rows_of_another_width_are_told_apart_and_what_is_no_row_ends_them() {
        let one =
            State::new(Layout::new(1)).with_word(Channel::Seq, 7).with_point(0, Point { y: 1.5, ..Point::default() });
        let three = State::new(Layout::new(3)).with_word(Channel::Seq, 8).with_flags(Flags::TRIPPED);
        let mut words = [one.words(), three.words()].concat();
        let read: Vec<State> = Row::all(&words).map(|row| State::of(&row)).collect();
        assert_eq!(read, [one, three]);
        assert_eq!((read[0].reading(0), read[1].flags()), ([1.5, 0.0], Flags::TRIPPED));
        words.pop();
        assert_eq!(Row::all(&words).count(), 1, "a row that is cut off is none");
        words[Channel::Flags as usize] = u64::MAX;
        assert_eq!(Row::all(&words).count(), 0);
        assert!(RowMut::new(Layout::new(3), &mut words[..30]).is_none());
    }
}
