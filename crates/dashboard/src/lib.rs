//! The dashboard: telemetry in, frames out, commands back.
//!
//! Threads beside the one that draws: the [`reader`](telemetry::reader) drains a bench into the [`feed`](telemetry::feed), the
//! [`edits`](telemetry::edits) thread carries changes to the simulation, those of [`jobs`](telemetry::jobs) compute what takes
//! longer than a frame; the **keyboard** ([`input`]) turns terminal events into messages, and one more does so with signals
//! ([`signals`]). The loop in [`app`] takes input first, then answers, then the clock, and draws a
//! [`Picture`](telemetry::frame_data::Picture): pausing stops the view, never the data.
//!
//! [`run`] is all that other crates need; [`session`] starts and ends the threads around the loop.

mod actions;
mod app;
mod axis;
mod complete;
mod config;
mod fit;
mod headless;
mod input;
mod keymap;
mod layers;
mod layout;
mod looks;
mod manual;
mod options;
mod panels;
mod plot;
mod pointed;
mod replay;
mod screen;
mod screenshot;
mod screenshot_file;
mod session;
mod signals;
mod terminal;
mod theme;
mod typing;
mod view;

pub use config::Config;
pub use headless::{Frames, Headless};
pub use keymap::Keymap;
pub use layout::{BUILT_IN as LAYOUTS, Layout, built_in as built_in_layouts};
pub use looks::still::Still;
pub use looks::{ThemeName, UnknownTheme, Wishes};
pub use manual::{manual_commands, manual_keys};
pub use options::{DashError, Ended, Options};
pub use panels::registry::panels;
pub use replay::replay;
pub use screenshot::{Presses, portrait};
pub use screenshot_file::stamp;
pub use session::run;
pub use terminal::restore_on_panic;
