//! The dashboard: telemetry in, frames out, commands back.
//!
//! Threads beside the one that draws: the [`reader`](telemetry::reader) drains a bench into the [`feed`](telemetry::feed), the
//! [`edits`](telemetry::edits) thread carries changes to the simulation, those of [`jobs`](telemetry::jobs) compute what takes
//! longer than a frame; the **keyboard** ([`input`]) turns terminal events into messages, and one more does so with signals
//! ([`signals`]). The loop in [`app`] takes input first, then answers, then the clock, and draws a
//! [`FrameData`](telemetry::frame_data::FrameData): pausing stops the view, never the data.
//!
//! Modules name each other one way: what can be said of a plot ([`axis`], [`series`], [`selection`]) knows nobody; [`actions`] are
//! made of it, [`keymap`] and [`layers`] of them; a [`view`] is all that [`panels`] see; [`screen`] puts panels, lines and layers
//! together, and [`app`] alone carries actions out.
//!
//! [`run`] is all that other crates need; [`session`] starts and ends the threads around the loop.
//!
//! ```
//! // A screen is a layout of panels; one of your own is a file with a picture of it in words.
//! let layouts = dashboard::built_in_layouts();
//! let operator = layouts.iter().find(|layout| layout.name() == "operator").ok_or("built in")?;
//! assert!(operator.panels(140, 42).contains(&"alarms"));
//! # Ok::<(), &str>(())
//! ```

mod actions;
mod app;
mod appearance;
#[cfg(test)]
mod arrows;
mod axis;
mod capture;
mod complete;
mod config;
mod drawing;
mod fit_text;
mod headless;
mod help;
mod input;
mod keymap;
mod layers;
mod layout;
mod line_editor;
mod list;
mod log;
mod manual;
mod on_alarm;
mod options;
mod panels;
mod plot;
mod popup;
mod question;
mod recorder_sign;
mod replay;
mod screen;
mod screenshot;
mod selection;
mod series;
mod session;
mod signals;
mod status_line;
mod terminal;
mod theme;
mod ticks;
mod time_line;
mod view;

pub use appearance::{AppearanceOptions, ThemeName, UnknownTheme};
pub use capture::{KeyPresses, take_screenshot};
pub use config::Config;
pub use headless::{Frames, Headless};
pub use keymap::Keymap;
pub use layout::{BUILT_IN as LAYOUTS, Layout, built_in as built_in_layouts};
pub use manual::{manual_commands, manual_keys};
pub use on_alarm::OnAlarm;
pub use options::{DashboardError, Ended, Options};
pub use panels::registry::panels;
pub use replay::replay;
pub use screenshot::file::stamp;
pub use screenshot::image::Screenshot;
pub use session::run;
pub use terminal::restore_on_panic;
