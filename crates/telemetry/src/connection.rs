//! Whether the simulation is there and sends.

/// Whether the simulation is there and sends.
#[derive(Clone, Debug, PartialEq)]
pub enum Connection {
    /// No bench of that name yet, or a reason why we cannot attach.
    Waiting(String),
    /// States arrive.
    Live,
    /// The process lives but sends nothing.
    Stalled,
    /// The process has ended.
    Gone,
}
