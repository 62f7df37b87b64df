//! Screenshots: a finished frame as text and as SVG ([`image`]), kept in files that replace nothing ([`file`]).

pub(crate) mod file;
pub(crate) mod image;
