//! A step as words, and views of them.
//!
//! A step is a row of 64-bit words, one a channel ([`crate::CHANNELS`]), doubles as their bits, as wide as the rotor needs.
//! Rows lie one after the other in a message, filled and read where they lie. Each says itself how many masses, sensors and
//! control bearings it has, so that no reader takes a row of another run for one of this.

use crate::channels::{Channel, WHOLES};
use crate::layout::{MAX_WIDTH, StepLayout};
use crate::message::Flags;

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

/// The channels of a control bearing, counted from 0: what is asked for and what is delivered, `[y, z]` each, and their index.
#[must_use]
pub const fn force_channels(bearing: usize) -> ([[Channel; 2]; 2], usize) {
    match bearing.checked_sub(1) {
        None => ([[Channel::CommandY, Channel::CommandZ], [Channel::ForceY, Channel::ForceZ]], 0),
        Some(further) => (
            [[Channel::FurtherCommandY, Channel::FurtherCommandZ], [Channel::FurtherForceY, Channel::FurtherForceZ]],
            further,
        ),
    }
}

/// The control bearing, counted from 0, of whose control a channel tells; `None` of any other channel.
#[must_use]
pub fn bearing_of(channel: Channel, index: usize) -> Option<usize> {
    let tells = |bearing| force_channels(bearing).0.as_flattened().contains(&channel);
    if tells(0) { Some(0) } else { tells(1).then_some(index + 1) }
}

/// A step, wherever its words lie.
pub trait Step {
    /// How its words are laid out.
    fn layout(&self) -> StepLayout;

    /// Its words: [`StepLayout::width`] of them.
    fn words(&self) -> &[u64];

    /// The word of a channel that occurs once.
    fn word(&self, channel: Channel) -> u64 {
        self.words()[self.layout().place(channel, 0)]
    }

    /// A channel's double.
    fn number(&self, channel: Channel, index: usize) -> f64 {
        f64::from_bits(self.words()[self.layout().place(channel, index)])
    }

    /// All its doubles, in the order of [`StepLayout::number_columns`].
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

    /// Control `[y, z]` that the feedback asks for at the first control bearing.
    fn force_commanded(&self) -> [f64; 2] {
        self.force(0)[0]
    }

    /// Control `[y, z]` that the first control bearing delivers.
    fn force_delivered(&self) -> [f64; 2] {
        self.force(0)[1]
    }

    /// How many control bearings there are.
    fn bearings(&self) -> usize {
        self.layout().bearings()
    }

    /// Control `[y, z]` that is asked for at a control bearing, counted from 0, and that it delivers.
    fn force(&self, bearing: usize) -> [[f64; 2]; 2] {
        let (channels, index) = force_channels(bearing);
        channels.map(|pair| pair.map(|channel| self.number(channel, index)))
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
pub struct StepRow<'a> {
    layout: StepLayout,
    words: &'a [u64],
}

impl<'a> StepRow<'a> {
    /// The rows of a message, one after the other; what is no row, which only a foreign writer can send, ends them.
    pub fn all(words: &'a [u64]) -> impl Iterator<Item = Self> {
        let mut rest = words;
        std::iter::from_fn(move || {
            let layout = StepLayout::told_by(*rest.get(Channel::Flags as usize)?)?;
            let (words, after) = rest.split_at_checked(layout.width())?;
            rest = after;
            Some(Self { layout, words })
        })
    }
}

impl Step for StepRow<'_> {
    fn layout(&self) -> StepLayout {
        self.layout
    }

    fn words(&self) -> &[u64] {
        self.words
    }
}

/// A step in a message that is being filled.
#[derive(Debug)]
pub struct RowMut<'a> {
    layout: StepLayout,
    words: &'a mut [u64],
}

impl<'a> RowMut<'a> {
    /// The first words of `words` as a step of this layout; `None` if they are too few.
    pub fn new(layout: StepLayout, words: &'a mut [u64]) -> Option<Self> {
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

    /// Says what is asked for at a control bearing, counted from 0, and what it delivers, `[y, z]` each.
    pub fn set_force(&mut self, bearing: usize, [commanded, delivered]: [[f64; 2]; 2]) {
        let ([command, force], index) = force_channels(bearing);
        self.set_pair(command, index, commanded);
        self.set_pair(force, index, delivered);
    }

    /// Sets all doubles, in the order of [`StepLayout::number_columns`].
    pub fn set_numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.words[WHOLES..].iter_mut().zip(numbers).for_each(|(word, number)| *word = number.to_bits());
    }

    /// Says what is special about the step.
    pub fn set_flags(&mut self, flags: Flags) {
        self.set_word(Channel::Flags, u64::from(flags.0) | self.layout.told());
    }

    /// Says where a mass is, counted from 0, and how it moves.
    pub fn set_point(&mut self, mass: usize, point: Point) {
        let Point { y, z, vy, vz } = point;
        self.set_pair([Channel::Y, Channel::Z], mass, [y, z]);
        self.set_pair([Channel::Vy, Channel::Vz], mass, [vy, vz]);
    }
}

impl Step for RowMut<'_> {
    fn layout(&self) -> StepLayout {
        self.layout
    }

    fn words(&self) -> &[u64] {
        self.words
    }
}

/// A step of one's own.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct State {
    layout: StepLayout,
    words: [u64; MAX_WIDTH],
}

impl State {
    /// A step that is all zero.
    #[must_use]
    pub fn new(layout: StepLayout) -> Self {
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
        Self::new(StepLayout::default())
    }
}

impl Step for State {
    fn layout(&self) -> StepLayout {
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
    fn rows_of_another_width_are_told_apart_and_what_is_no_row_ends_them() {
        let one = State::new(StepLayout::new(1))
            .with_word(Channel::Seq, 7)
            .with_point(0, Point { y: 1.5, ..Point::default() });
        let three = State::new(StepLayout::new(3)).with_word(Channel::Seq, 8).with_flags(Flags::TRIPPED);
        let mut words = [one.words(), three.words()].concat();
        let read: Vec<State> = StepRow::all(&words).map(|row| State::of(&row)).collect();
        assert_eq!(read, [one, three]);
        assert_eq!((read[0].reading(0), read[1].flags()), ([1.5, 0.0], Flags::TRIPPED));
        words.pop();
        assert_eq!(StepRow::all(&words).count(), 1, "a row that is cut off is none");
        words[Channel::Flags as usize] = u64::MAX;
        assert_eq!(StepRow::all(&words).count(), 0);
        assert!(RowMut::new(StepLayout::new(3), &mut words[..30]).is_none());
    }
}
