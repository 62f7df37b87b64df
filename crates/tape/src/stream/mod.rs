//! A file as a stream of messages, whatever is in them: where each begins, whether it is what was written, and what is
//! damaged. Needs nothing of rerun, and decodes nothing.

mod frame;
mod resync;
mod seal;
mod walk;
mod window;

#[cfg(test)]
mod tests;

#[cfg(feature = "rerun")]
pub(crate) use frame::HEADER;
#[cfg(feature = "rerun")]
pub(crate) use frame::Kind;
pub(crate) use seal::put;
#[cfg(feature = "rerun")]
pub(crate) use seal::{Seal, check};
pub(crate) use walk::{Met, Walk};
