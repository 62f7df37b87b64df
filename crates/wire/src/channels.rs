//! What is told of a step: one table of channels, of which everything is made that carries or shows steps: the words of a
//! message, the columns of a recording and of an exported table, the history of a dashboard, the names of strips, the raw
//! panel, the C header. A new channel is one row here and one place where it is filled.
//!
//! Dimensionless units of the model throughout: displacement in `e_t`, velocity in `w0 e_t`, control in `w0^2 e_t` (the force
//! on the bearing's mass, divided by that mass).

use units::Dimension;

/// How often a channel occurs in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Once.
    Once,
    /// For every mass.
    Mass,
    /// For every sensor: there is one at every mass.
    Sensor,
    /// For every control bearing after the first, whose channels occur once.
    Further,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct ChannelRow {
    /// Which one it is.
    pub channel: Channel,
    /// Its name in files; of a mass, a sensor or a further control bearing followed by its number.
    pub name: &'static str,
    /// Its name on screens; of a mass, a sensor or a further control bearing followed by `.N`.
    pub label: &'static str,
    /// How often it occurs.
    pub scope: Scope,
    /// What it counts.
    pub dimension: Dimension,
    /// What it is.
    pub meaning: &'static str,
}

macro_rules! channels {
    ($($channel:ident $name:literal $label:literal $scope:ident $dimension:ident $meaning:literal;)*) => {
        /// One quantity of a step.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Channel {
            $(#[doc = $meaning] $channel,)*
        }

        /// The table, in the order of a step's words: first all that occurs once, whole numbers leading, then the channels of
        /// each mass, then those of each sensor, then those of each control bearing after the first.
        pub const CHANNELS: &[ChannelRow] = &[
            $(ChannelRow {
                channel: Channel::$channel,
                name: $name,
                label: $label,
                scope: Scope::$scope,
                dimension: Dimension::$dimension,
                meaning: $meaning,
            },)*
        ];
    };
}

channels! {
    RunId "run_id" "run" Once Whole "which run of which process: changes when the simulation starts anew";
    Seq "seq" "step" Once Whole "number of the step since the process started: up by 1 each, also while tripped";
    WallNs "wall_ns" "wall" Once Whole "wall clock when the step was due to be sent, nanoseconds since 1970";
    Revision "revision" "revision" Once Whole "revision of the settings that the step was made with";
    Flags "flags" "flags" Once Whole "bits 0 to 31: what is special; 32 to 47: how many masses; 48 to 55: how many sensors; 56 to 63: how many control bearings after the first";
    Tau "tau" "tau" Once Time "time since the rotor was last at rest; stands still while the machine is held after a trip";
    Angle "angle" "angle" Once Angle "spin angle, unwrapped: the unbalance points along it";
    Speed "speed" "speed" Once Speed "spin speed R";
    SpeedRate "speed_rate" "rate" Once SpeedRate "rate of change of the spin speed";
    CommandY "uy_commanded" "command.y" Once Force "control that the feedback asks for at the first control bearing, y";
    CommandZ "uz_commanded" "command.z" Once Force "control that the feedback asks for at the first control bearing, z";
    ForceY "uy" "u.y" Once Force "control that the first control bearing delivers, y";
    ForceZ "uz" "u.z" Once Force "control that the first control bearing delivers, z";
    Y "y" "y" Mass Length "displacement, y";
    Z "z" "z" Mass Length "displacement, z";
    Vy "vy" "vy" Mass Velocity "velocity, y";
    Vz "vz" "vz" Mass Velocity "velocity, z";
    ReadingY "reading_y" "reading.y" Sensor Length "displacement as the loop reads it, y";
    ReadingZ "reading_z" "reading.z" Sensor Length "displacement as the loop reads it, z";
    FurtherCommandY "bearing_uy_commanded" "bearing.command.y" Further Force "control that the feedback asks for, y";
    FurtherCommandZ "bearing_uz_commanded" "bearing.command.z" Further Force "control that the feedback asks for, z";
    FurtherForceY "bearing_uy" "bearing.u.y" Further Force "control that the bearing delivers, y";
    FurtherForceZ "bearing_uz" "bearing.u.z" Further Force "control that the bearing delivers, z";
}

impl Channel {
    /// Its row of the table.
    #[must_use]
    pub const fn row(self) -> &'static ChannelRow {
        &CHANNELS[self as usize]
    }

    /// Whether it is a double; else it is a whole number.
    #[must_use]
    pub const fn is_number(self) -> bool {
        !matches!(self.row().dimension, Dimension::Whole)
    }

    /// Its place among the channels of its scope.
    #[must_use]
    pub const fn place_in_scope(self) -> usize {
        PLACES[self as usize]
    }

    /// What stands for it in recordings made before it was told, when every loop was ideal and every speed steady.
    #[must_use]
    pub const fn substitute(self) -> Substitute {
        match self {
            Self::ReadingY => Substitute::Channel(Self::Y),
            Self::ReadingZ => Substitute::Channel(Self::Z),
            Self::SpeedRate => Substitute::Zero,
            _ => Substitute::None,
        }
    }
}

/// What stands for a channel in recordings made before it was told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Substitute {
    /// Nothing: it has been told from the first version on.
    None,
    /// Zero.
    Zero,
    /// The same as another channel.
    Channel(Channel),
}

/// Channels of each scope.
const COUNTS: [usize; 4] = [
    count_before(Scope::Once, CHANNELS.len()),
    count_before(Scope::Mass, CHANNELS.len()),
    count_before(Scope::Sensor, CHANNELS.len()),
    count_before(Scope::Further, CHANNELS.len()),
];

/// The place of each channel among those of its scope.
const PLACES: [usize; CHANNELS.len()] = {
    let (mut places, mut at) = ([0; CHANNELS.len()], 0);
    while at < CHANNELS.len() {
        places[at] = count_before(CHANNELS[at].scope, at);
        at += 1;
    }
    places
};

/// How many of the first `end` channels have a scope.
const fn count_before(scope: Scope, end: usize) -> usize {
    let (mut at, mut count) = (0, 0);
    while at < end {
        if CHANNELS[at].scope as usize == scope as usize {
            count += 1;
        }
        at += 1;
    }
    count
}

/// How many channels have a scope.
#[must_use]
pub const fn channels_of(scope: Scope) -> usize {
    COUNTS[scope as usize]
}

/// Whole numbers, which lead a step's words.
pub const WHOLES: usize = {
    let (mut at, mut count) = (0, 0);
    while at < CHANNELS.len() {
        if matches!(CHANNELS[at].dimension, Dimension::Whole) {
            count += 1;
        }
        at += 1;
    }
    count
};

/// Two channels along y and z that are one quantity in the plane, whose size has a name of its own.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// What its size is called on screens.
    pub label: &'static str,
    /// The two.
    pub channels: [Channel; 2],
}

/// Every pair whose size is shown.
pub const PAIRS: [Pair; 6] = [
    Pair { label: "command", channels: [Channel::CommandY, Channel::CommandZ] },
    Pair { label: "force", channels: [Channel::ForceY, Channel::ForceZ] },
    Pair { label: "radius", channels: [Channel::Y, Channel::Z] },
    Pair { label: "reading", channels: [Channel::ReadingY, Channel::ReadingZ] },
    Pair { label: "bearing.command", channels: [Channel::FurtherCommandY, Channel::FurtherCommandZ] },
    Pair { label: "bearing.force", channels: [Channel::FurtherForceY, Channel::FurtherForceZ] },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_order_and_its_names_are_its_own() {
        for (at, row) in CHANNELS.iter().enumerate() {
            assert_eq!(row.channel as usize, at);
            assert_eq!(row.channel.is_number(), at >= WHOLES, "whole numbers lead: {}", row.name);
            let same = |other: &&ChannelRow| other.name == row.name || other.label == row.label;
            assert_eq!(CHANNELS.iter().filter(same).count(), 1, "{}", row.name);
            assert!(!row.name.ends_with(|c: char| c.is_ascii_digit()), "{}: a number is a mass's", row.name);
        }
        assert!(CHANNELS.is_sorted_by_key(|row| row.scope as usize));
        for pair in PAIRS {
            let [y, z] = pair.channels.map(Channel::row);
            assert_eq!((y.scope, y.dimension), (z.scope, z.dimension), "{}", pair.label);
            assert!(CHANNELS.iter().all(|row| row.label != pair.label));
        }
    }
}
