//! Where in a step's words which channel is: how wide a step is, and what its columns are called.

use rotor::{MAX_BEARINGS, MAX_MASSES};

use crate::channels::{Channel, Scope, WHOLES, channels_of};

/// How a step's words are laid out: how many masses, sensors and control bearings there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StepLayout {
    masses: u16,
    sensors: u16,
    /// Control bearings after the first.
    further: u16,
}

/// Words of the widest step.
pub const MAX_WIDTH: usize = StepLayout::new(MAX_MASSES).with_bearings(MAX_BEARINGS).width();

/// A channel, of one mass, sensor or control bearing where it has many: one word of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Column {
    /// The channel.
    pub channel: Channel,
    /// The mass or sensor, counted from 0, or the control bearing after the first, likewise; 0 for what occurs once.
    pub index: usize,
}

impl Column {
    /// Its number on screens and in files, counted from 1; control bearings are counted with the first. `None` for what occurs once.
    #[must_use]
    pub fn number(self) -> Option<usize> {
        match self.channel.row().scope {
            Scope::Once => None,
            Scope::Mass | Scope::Sensor => Some(self.index + 1),
            Scope::Further => Some(self.index + 2),
        }
    }

    /// Its name in files: `tau`, `y1`.
    #[must_use]
    pub fn name(self) -> String {
        let row = self.channel.row();
        self.number().map_or_else(|| row.name.to_owned(), |number| format!("{}{number}", row.name))
    }

    /// What it is, in words.
    #[must_use]
    pub fn meaning(self) -> String {
        let row = self.channel.row();
        match row.scope {
            Scope::Once => row.meaning.to_owned(),
            Scope::Mass => format!("{}, of mass {}", row.meaning, self.index + 1),
            Scope::Sensor => format!("{}, at mass {}", row.meaning, self.index + 1),
            Scope::Further => format!("{}, of control bearing {}", row.meaning, self.index + 2),
        }
    }
}

impl StepLayout {
    /// The layout for a rotor of so many masses, with a sensor at each, and one control bearing; of more than [`MAX_MASSES`], for
    /// those.
    #[must_use]
    pub const fn new(masses: usize) -> Self {
        let masses = if masses < MAX_MASSES { masses } else { MAX_MASSES } as u16;
        Self { masses, sensors: masses, further: 0 }
    }

    /// The same with so many control bearings: at least one, and no more than [`MAX_BEARINGS`].
    #[must_use]
    pub const fn with_bearings(self, bearings: usize) -> Self {
        let bearings = if bearings < MAX_BEARINGS { bearings } else { MAX_BEARINGS };
        Self { further: bearings.saturating_sub(1) as u16, ..self }
    }

    /// The layout that a word of flags tells of; `None` if no step has one like this.
    #[must_use]
    pub fn told_by(flags: u64) -> Option<Self> {
        let further = (flags >> 56) as u16;
        let told = Self { masses: (flags >> 32) as u16, sensors: (flags >> 48 & 0xff) as u16, further };
        (told == Self::new(told.masses()).with_bearings(usize::from(further) + 1)).then_some(told)
    }

    /// The layout as a step tells it, beside its flags.
    pub(crate) fn told(self) -> u64 {
        u64::from(self.masses) << 32 | u64::from(self.sensors) << 48 | u64::from(self.further) << 56
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

    /// How many control bearings there are.
    #[must_use]
    pub const fn bearings(self) -> usize {
        self.further as usize + 1
    }

    /// How often a channel of this scope occurs.
    #[must_use]
    pub const fn count(self, scope: Scope) -> usize {
        match scope {
            Scope::Once => 1,
            Scope::Mass => self.masses(),
            Scope::Sensor => self.sensors(),
            Scope::Further => self.further as usize,
        }
    }

    /// Words of a step.
    #[must_use]
    pub const fn width(self) -> usize {
        channels_of(Scope::Once)
            + self.masses() * channels_of(Scope::Mass)
            + self.sensors() * channels_of(Scope::Sensor)
            + self.further as usize * channels_of(Scope::Further)
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
            Scope::Further => {
                once + self.masses() * channels_of(Scope::Mass)
                    + self.sensors() * channels_of(Scope::Sensor)
                    + index * channels_of(Scope::Further)
                    + within
            }
        }
    }

    /// Every word of a step, in order.
    pub fn columns(self) -> impl Iterator<Item = Column> + Clone {
        [Scope::Once, Scope::Mass, Scope::Sensor, Scope::Further].into_iter().flat_map(move |scope| {
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
    fn a_row_of_three_masses_takes_248_bytes_and_the_widest_1096() {
        assert_eq!((StepLayout::new(3).width() * 8, MAX_WIDTH * 8), (248, 1096));
    }

    #[test]
    fn every_column_has_the_place_that_the_layout_gives_it() {
        for (masses, bearings) in [(0, 1), (1, 1), (3, 1), (3, 2), (MAX_MASSES, MAX_BEARINGS)] {
            let layout = StepLayout::new(masses).with_bearings(bearings);
            assert_eq!(StepLayout::told_by(layout.told()), Some(layout));
            let columns: Vec<Column> = layout.columns().collect();
            assert_eq!((columns.len(), layout.number_columns().count()), (layout.width(), layout.numbers()));
            for (at, column) in columns.into_iter().enumerate() {
                assert_eq!(layout.place(column.channel, column.index), at, "{}", column.name());
            }
        }
        let names: Vec<String> = StepLayout::new(1).with_bearings(3).columns().map(Column::name).collect();
        assert_eq!(names[19..23], ["bearing_uy_commanded2", "bearing_uz_commanded2", "bearing_uy2", "bearing_uz2"]);
        let names: Vec<String> = StepLayout::new(2).columns().map(Column::name).collect();
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
