//! The smallest damping around where one is, over the speed and the selected setting.
//!
//! ```text
//! ┌ map  damping to 0.11 over speed and kd ┐
//! │  0 ▓▓▓▓▓▓▒▒▒▒▒▒▒▒░░░░░░░░·······        │   the fuller the better damped, dots: unstable
//! │    ▓▓▓▓▓▓▓▒▒▒▒▒▒▒▒░░░░░░░░░·····        │
//! │    ▓▓▓▓▓▓▓▒▒▒▒▒┼▒▒▒░░░░░◇░░░░···        │   the cross: the settings in force; the diamond: what is typed or offered
//! │    ███▓▓▓▓▓▒▒▒▒▒▒▒▒▒░░░░░░░░░░··        │
//! │ -1 ████▓▓▓▓▓▓▒▒▒▒▒▒▒▒▒░░░░░░░░░░        │
//! │    0                           5 w0     │
//! └─────────────────────────────────────────┘
//! ```

use std::sync::Arc;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use rotor::{Key, Rotor, Settings};
use telemetry::jobs::{DampingMap, DampingMapRequest};
use text::number::{short, trimmed};

use super::panel::Panel;
use super::settings::rows;
use crate::drawing::{framed, write};
use crate::fit_text::{longest, width};
use crate::theme;
use crate::view::View;

/// From little damping to much.
const SHADES: [&str; 4] = ["░", "▒", "▓", "█"];
const UNSTABLE: &str = "·";

/// The panel.
#[derive(Debug, Default)]
pub(crate) struct DampingMapPanel {
    /// What was asked last: whether linear analysis knows a setting takes a model of the whole machine to say, and is asked anew only where
    /// something has changed.
    asked: Option<Asked>,
}

/// A question, and what it is about.
#[derive(Debug)]
struct Asked {
    rotor: Arc<Rotor>,
    settings: Settings,
    key: Key,
    request: Option<DampingMapRequest>,
}

impl DampingMapPanel {
    /// What to ask about settings, at the speed that they have, up along one of them.
    fn request(&mut self, rotor: Arc<Rotor>, settings: &Settings, key: Key) -> Option<DampingMapRequest> {
        let is_same =
            |asked: &&Asked| Arc::ptr_eq(&asked.rotor, &rotor) && asked.key == key && asked.settings == *settings;
        if let Some(asked) = self.asked.as_ref().filter(is_same) {
            return asked.request.clone();
        }
        let request = DampingMapRequest::with(rotor.clone(), settings, settings.speed, key);
        self.asked = Some(Asked { rotor, settings: settings.clone(), key, request: request.clone() });
        request
    }
}

impl Panel for DampingMapPanel {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(self, view, area, buffer);
    }
}

fn draw(panel: &mut DampingMapPanel, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let known = || Some((data.rotor.clone()?, data.settings.as_ref()?));
    let Some((rotor, settings)) = known() else {
        framed(Line::from(" map "), area, buffer);
        return;
    };
    let keys = rows(settings, Some(&rotor));
    let selected = keys.get(view.cursor.row.min(keys.len().saturating_sub(1))).copied();
    let here = Settings { speed: speed_of(view, settings), ..settings.clone() };
    let request = selected.and_then(|key| panel.request(rotor, &here, key));
    let Some(request) = request else {
        let inner = framed(Line::from(" map "), area, buffer);
        let label = selected.map_or(String::new(), |key| settings.label(key));
        let told = format!("{label} does nothing to damping: select a gain, the speed, or a part of the loop");
        let short = format!("{label}: not linear");
        write(buffer, inner, inner.left(), inner.top(), &longest(&[&told, &short], inner.width.into()), theme::quiet());
        return;
    };
    let Some(map) = view.jobs.damping_map(&request) else {
        framed(Line::from(" map  being computed "), area, buffer);
        return;
    };
    let (units, largest) = (data.units(), map.largest());
    let over = format!("over speed and {}", settings.label(map.key));
    let title = [format!(" map  damping to {} {over} ", trimmed(largest, 2)), format!(" map  {over} "), " map ".into()];
    let title = longest(&title.each_ref().map(String::as_str), area.width.saturating_sub(2).into());
    let inner = framed(Line::from(title), area, buffer);
    let of_value = |value: f64| short(value * units.setting(map.key).factor, 3);
    let [low, high] = map.values.map(of_value);
    let beside = (width(&low).max(width(&high)) + 1) as u16;
    if inner.width <= beside + 2 || inner.height < 3 {
        return;
    }
    let plot = Rect { x: inner.x + beside, width: inner.width - beside, height: inner.height - 1, ..inner };
    draw_cells(&map, largest, plot, buffer);
    let mut mark = |settings: &Settings, sign: &str, color| {
        let Some([across, up]) = map.place(settings) else { return };
        let cell = |part: f64, count: u16| (part * f64::from(count - 1)).round() as u16;
        let (x, y) = (plot.x + cell(across, plot.width), plot.bottom() - 1 - cell(up, plot.height));
        write(buffer, plot, x, y, sign, theme::loud(color));
    };
    mark(&here, "┼", theme::CURSOR);
    if let Some(what_if) = view.what_if {
        mark(&what_if.settings, "◇", theme::CANDIDATE);
    }
    write(buffer, inner, inner.left() + beside - 1 - width(&high) as u16, plot.top(), &high, theme::quiet());
    write(buffer, inner, inner.left() + beside - 1 - width(&low) as u16, plot.bottom() - 1, &low, theme::quiet());
    let speed = settings.key("speed").map(|key| units.setting(key));
    let [from, to] = map.speeds.map(|at| short(speed.as_ref().map_or(1.0, |unit| unit.factor) * at, 4));
    let to = format!("{to} {}", speed.as_ref().map_or("", |unit| unit.name));
    write(buffer, inner, plot.left(), plot.bottom(), &from, theme::quiet());
    let end = plot.right().saturating_sub(width(&to) as u16);
    if end > plot.left() + width(&from) as u16 {
        write(buffer, inner, end, plot.bottom(), &to, theme::quiet());
    }
}

/// The speed at which the machine turns, where that is not what is set.
pub(super) fn speed_of(view: &View<'_>, settings: &Settings) -> f64 {
    let era = view.data.era.as_ref().filter(|_| view.time.is_live());
    era.map_or(settings.speed, |era| era.speed)
}

fn draw_cells(map: &DampingMap, largest: f64, plot: Rect, buffer: &mut Buffer) {
    let part = |at: u16, of: u16| f64::from(at) / f64::from(of.saturating_sub(1).max(1));
    for y in 0..plot.height {
        for x in 0..plot.width {
            let damping = map.at(part(x, plot.width), 1.0 - part(y, plot.height));
            if damping.is_nan() {
                continue;
            }
            let (color, _) = theme::verdict(damping);
            let level = damping / largest * SHADES.len() as f64;
            let sign = if damping > 0.0 { SHADES[(level as usize).min(SHADES.len() - 1)] } else { UNSTABLE };
            write(buffer, plot, plot.x + x, plot.y + y, sign, ratatui::style::Style::new().fg(color));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::SettingsCursor;
    use crate::view::tests::view;
    use telemetry::test_support as tests;

    #[test]
    fn the_cross_is_where_one_is_and_the_diamond_where_one_would_be() {
        let data = tests::frame_data();
        let settings = data.settings.clone().unwrap();
        let row_of = |name: &str| {
            let is_it = |key: &rotor::Key| settings.label(*key) == name;
            rows(&settings, data.rotor.as_deref()).iter().position(is_it).unwrap()
        };
        let cursor = SettingsCursor { row: row_of("kd"), typed: None };
        let mut other = settings.clone();
        other.set("kd".parse().unwrap(), -0.2).unwrap();
        let what_if = telemetry::what_if::WhatIf::of(data.rotor.as_ref().unwrap(), other).unwrap();
        let seen = View { cursor: &cursor, what_if: Some(&what_if), ..view(&data) };
        let frame = drawn(44, 12, |area, buffer| DampingMapPanel::default().draw(&seen, area, buffer));
        assert!(frame.contains('┼') && frame.contains('◇') && frame.contains("over speed and kd"), "{frame}");
        insta::assert_snapshot!("damping_map", frame);
        let cursor = SettingsCursor { row: row_of("trip"), typed: None };
        let frame = drawn(60, 6, |area, buffer| {
            DampingMapPanel::default().draw(&View { cursor: &cursor, ..view(&data) }, area, buffer);
        });
        assert!(frame.contains("trip"), "{frame}");
    }

    #[test]
    fn what_was_asked_is_asked_anew_only_where_something_has_changed() {
        let data = tests::frame_data();
        let (rotor, settings) = (data.rotor.clone().unwrap(), data.settings.clone().unwrap());
        let mut panel = DampingMapPanel::default();
        let [kd, cd, trip] = ["kd", "cd", "trip"].map(|name| name.parse::<Key>().unwrap());
        let fresh = |settings: &Settings, key| DampingMapRequest::with(rotor.clone(), settings, settings.speed, key);
        let other = Settings { speed: 3.0, ..settings.clone() };
        for (settings, key) in
            [(&settings, kd), (&settings, kd), (&settings, cd), (&other, cd), (&other, trip), (&settings, kd)]
        {
            assert_eq!(panel.request(rotor.clone(), settings, key), fresh(settings, key), "{key}");
        }
        assert!(
            panel.request(rotor.clone(), &settings, kd).is_some() && panel.request(rotor, &settings, trip).is_none()
        );
    }
}
