//! What an alarm does to a run-up, as the configuration says.

/// What an alarm does to a speed that rises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnAlarm {
    /// Nothing: it goes on.
    #[default]
    GoOn,
    /// It stays what it is.
    Hold,
    /// It falls to rest at the rate at which it rose.
    CoastDown,
}

impl OnAlarm {
    /// Every one by its name in the configuration file.
    pub const ALL: [(&'static str, Self); 3] =
        [("go-on", Self::GoOn), ("hold", Self::Hold), ("coast-down", Self::CoastDown)];
}
