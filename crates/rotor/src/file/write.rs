//! How files are written.

pub(super) use text::number::toml as number;
pub(super) use text::{Lines, numbers, string};
