//! Where in a step's words which channel is: how wide a step is, and what its columns are called.

use rotor::{MAX_MASSES, Rotor};

use crate::channels::{Channel, Scope, WHOLES, channels_of};

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

    /// The layout as a step tells it, beside its flags.
    pub(crate) fn told(self) -> u64 {
        u64::from(self.masses) << 32 | u64::from(self.sensors) << 48
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
}
