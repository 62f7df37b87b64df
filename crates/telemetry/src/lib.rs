//! What a console knows of a bench or of a recording, and what it can ask of them. No screen: whoever shows it is another
//! crate, and this one knows neither keys nor colours.
//!
//! [`reader`] drains what a bench sends into the bounded [`feed`]: steps into its [`history`], events into words.
//! [`replay`] fills the same feed from a recording. [`view_time`] says which moment is looked at, and
//! [`Feed::frame_data`](feed::Feed::frame_data) is all that one frame shows of it. [`edits`] carries changes to the simulation on a
//! thread of its own and knows what can be undone; [`jobs`] computes what takes longer than a frame; [`gain_search`] looks for gains.
//!
//! ```
//! use std::time::Instant;
//! use telemetry::feed::Feed;
//! use wire::{StepLayout, State};
//!
//! // What a reader thread does with every step that it hears of a rotor of three masses.
//! let mut feed = Feed::new("looking for a bench");
//! feed.push_step(&State::new(StepLayout::new(3)), Instant::now());
//! assert_eq!(feed.history().kept(), 0..1);
//! ```

pub mod command_history;
pub mod comparison;
pub mod connection;
pub mod damping_verdict;
pub mod drill;
pub mod edits;
pub mod event_log;
pub mod feed;
pub mod frame_data;
pub mod gain_search;
pub mod history;
pub mod jobs;
pub mod past;
pub mod presets;
pub mod processes;
pub mod reader;
pub mod replay;
mod settings_trail;
#[cfg(any(test, feature = "test-support"))]
pub mod test_support;
pub mod units;
pub mod view_time;
pub mod what_if;
mod wording;
