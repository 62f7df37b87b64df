//! The panels: one file each, from a [`FrameData`](telemetry::frame_data::FrameData) and an area to cells of the screen. A panel keeps what is its own, such as
//! the scale of its axes; what is selected, typed or pointed at for all comes in as an argument.

pub(crate) mod alarms;
mod bent_shaft;
pub(crate) mod campbell;
pub(crate) mod damping;
pub(crate) mod damping_map;
mod damping_over_speed;
pub(crate) mod events;
pub(crate) mod force;
pub(crate) mod force_budget;
pub(crate) mod loop_in_view;
pub(crate) mod margins;
pub(crate) mod modes;
pub(crate) mod nyquist;
pub(crate) mod orbits;
pub(crate) mod panel;
pub(crate) mod polar;
pub(crate) mod poles;
pub(crate) mod raw;
pub(crate) mod registry;
pub(crate) mod run_up;
pub(crate) mod sensitivity;
mod setting_numbers;
pub(crate) mod settings;
pub(crate) mod spectral;
pub(crate) mod spectrum;
pub(crate) mod strips;
mod verdict;
pub(crate) mod waterfall;

use std::ops::Range;

use ratatui::layout::{Position, Rect};

use panel::PanelRequest;
use telemetry::frame_data::FrameData;

/// What a click asks for where the steps `over` of the frame are drawn across `area`: to look at the one there.
fn look_at(data: &FrameData, over: &Range<usize>, area: Rect, at: Position) -> Option<PanelRequest> {
    if over.is_empty() || !area.contains(at) {
        return None;
    }
    let along = (f64::from(at.x - area.x) + 0.5) / f64::from(area.width);
    let step = over.start + (along * over.len() as f64) as usize;
    Some(PanelRequest::LookAtStep(data.track.first() + step as u64))
}

/// How many times as much a plot shows after so many notches of the wheel towards us.
fn wheel_times(notches: i32) -> f64 {
    1.25_f64.powi(notches.clamp(-50, 50))
}
