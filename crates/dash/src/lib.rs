//! The dashboard: telemetry in, frames out, commands back.
//!
//! Three threads beside the one that draws. The **reader** ([`link`]) drains states and bench statuses into a bounded
//! [`feed`]; the **clerk** ([`clerk`]) carries edits to the simulation and knows what can be undone; the **keyboard**
//! ([`input`]) turns terminal events into messages, as a fourth does with signals ([`signals`]). The loop in [`app`] takes input first, then answers,
//! then the clock, and draws a [`picture::Picture`], made from the [`history`] and the [`view_time`]: pausing stops the view, never the data.
//!
//! [`run`] is all that other crates need; [`session`] starts and ends the threads around the loop.

mod actions;
mod analysis;
mod app;
mod axis;
mod beside;
mod clerk;
mod complete;
mod config;
mod contact;
mod feed;
mod fit;
mod hands;
mod headless;
mod history;
mod input;
mod journal;
mod keymap;
mod layers;
mod layout;
mod link;
mod looks;
mod manual;
mod options;
mod panels;
mod picture;
mod plot;
mod pointed;
mod portrait;
mod presets;
mod recall;
mod replay;
mod screen;
mod search;
mod session;
mod signals;
mod still_file;
mod terminal;
mod theme;
mod told;
mod typing;
mod units;
mod view;
mod view_time;
mod what_if;

pub use config::Config;
pub use hands::{Keeper, OutsideError, Scribe, ScribeNews};
pub use headless::{Frames, Headless};
pub use keymap::Keymap;
pub use layout::{BUILT_IN as LAYOUTS, Layout, built_in as built_in_layouts};
pub use looks::still::Still;
pub use looks::{ThemeName, UnknownTheme, Wishes};
pub use manual::{manual_commands, manual_keys};
pub use options::{DashError, Ended, Options};
pub use panels::registry::panels;
pub use portrait::{Presses, portrait};
pub use replay::{Past, PastEvent, PastWhat, replay};
pub use session::run;
pub use still_file::stamp;
pub use terminal::restore_on_panic;
