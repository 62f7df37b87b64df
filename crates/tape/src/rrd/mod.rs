//! Everything that knows rerun: the encoder on a file of ours, the store's chunks, the layout for the viewer, the reader.

mod chunks;
mod encode;
mod fence;
mod ipc;
mod join;
mod ledger;
mod read;
mod scene;
mod shaft;
mod view;
mod viewer;
mod write;

pub(crate) use join::join;
pub(crate) use read::{open, run_of};
pub(crate) use viewer::Viewer;
pub(crate) use write::Writer;
