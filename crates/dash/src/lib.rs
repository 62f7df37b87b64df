//! The dashboard: telemetry in, frames out, commands back.
//!
//! Three threads beside the one that draws. The **reader** ([`link`]) drains states and bulletins into a bounded
//! [`feed`]; the **clerk** ([`clerk`]) carries edits to the simulation and keeps the undo stacks; the **keyboard**
//! ([`input`]) turns terminal events and signals into messages. The loop in [`app`] takes input first, then answers,
//! then the clock, and draws a [`feed::Picture`], which is a copy: pausing stops the picture, never the data.
//!
//! [`run`] is all that other crates need; [`session`] starts and ends the threads around the loop.

mod app;
mod clerk;
mod feed;
mod input;
mod keymap;
mod link;
mod looks;
mod panels;
mod plot;
mod screen;
mod session;
mod terminal;
mod theme;

pub use looks::{ThemeName, UnknownTheme, Wishes};
pub use session::{DashError, Ended, Keeper, run};
