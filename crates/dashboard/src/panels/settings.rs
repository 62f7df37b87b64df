//! Speed, deadbands, gains and trip limit: values, steps, what is selected, what is being typed.
//!
//! ```text
//! ┌ settings  rev 3 by dash:812 ────┐
//! │  speed           2.5    ±0.05 w0│
//! │  trip           1000      ±10 e_t
//! │▶ kd          -0.5879    ±0.01   │   ▶ selected: left and right lower and raise it
//! │  kc      -1.25 linear   ±0.01   │   a scheduled gain at the present speed
//! │  cc ▲0.0012  0.6483     ±0.01   │   where there is room: what a step up does to the smallest damping; ◆ where it is best as it is
//! │  cd         0.4948  held 0.25   │   in place of the step: what it is in the settings that are held, or "-> 0.25" would be
//! └─────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Margin, Position, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::Line;
use rotor::{Gain, Key, Rotor, Scope, Settings};
use telemetry::jobs::{SettingSlopes, SlopeRequest};
use text::number::significant;

use super::damping_map::speed_of;
use super::panel::{Panel, PanelRequest};
use super::setting_numbers::{compact, in_brief, step_of, tiny};
use crate::drawing::{framed, write, write_line};
use crate::fit_text::width;
use crate::input::Mouse;
use crate::list::{draw_overflow, filter_title, passes};
use crate::theme;
use crate::view::{SettingsCursor, View};
use telemetry::units::ScreenUnits;

/// Every key that means something on a rotor, if that is known: clearances only where a support bearing has play, faults only where they
/// are.
pub(crate) fn every_row(settings: &Settings, rotor: Option<&Rotor>) -> Vec<Key> {
    let has_play = |place: usize| rotor.is_none_or(|rotor| rotor.has_contact(place));
    let of_place = |key: &Key| key.index.filter(|_| key.parameter.scope == Scope::Mass && !key.parameter.is_fault());
    let is_there = |key: &Key| !key.parameter.is_fault() || settings.get(*key).ok() != key.parameter.off;
    settings.keys().into_iter().filter(|key| is_there(key) && of_place(key).is_none_or(has_play)).collect()
}

/// The rows of the panel: those keys, but one deadband for all masses where they are all alike, and no index on the gains of a single
/// signal.
pub(crate) fn rows(settings: &Settings, rotor: Option<&Rotor>) -> Vec<Key> {
    let keys = every_row(settings, rotor);
    let is_clearance = |key: &Key| key.parameter.scope == Scope::Mass && !key.parameter.is_fault();
    let places: Vec<usize> = keys.iter().filter(|key| is_clearance(key)).filter_map(|key| key.index).collect();
    let alike = places.windows(2).all(|pair| settings.deadband[pair[0]] == settings.deadband[pair[1]]);
    let one_signal = settings.feedback.signal_count() == 1;
    let is_one = |key: &Key| match key.parameter.scope {
        Scope::Machine => false,
        Scope::Mass => is_clearance(key) && alike,
        Scope::Signal => one_signal,
        Scope::Bearing => false,
    };
    let first = |key: &Key| match key.parameter.scope {
        Scope::Mass => key.index == places.first().copied(),
        _ => key.index == Some(0),
    };
    let rows = keys.into_iter().filter(|key| !is_one(key) || first(key));
    rows.map(|key| if is_one(&key) { Key { index: None, ..key } } else { key }).collect()
}

/// The places among [`rows`] of those that a filter lets through, and of the selected one, which is never hidden.
pub(crate) fn shown_rows(settings: &Settings, rotor: Option<&Rotor>, filter: &str, selected: usize) -> Vec<usize> {
    let row = |key: &Key| format!("{key} {} {}", settings.label(*key), key.parameter.meaning);
    let keys = rows(settings, rotor);
    if filter.is_empty() {
        return (0..keys.len()).collect();
    }
    let places = keys.iter().enumerate().filter(|(at, key)| *at == selected || passes(filter, &row(key)));
    places.map(|(at, _)| at).collect()
}

/// The control bearing that is looked at, counted from 0: the one that the selected setting belongs to, else the first.
pub(super) fn bearing_in_view(view: &View<'_>) -> usize {
    let data = view.data;
    let selected = data.settings.as_ref().and_then(|settings| {
        let keys = rows(settings, data.rotor.as_deref());
        settings.bearing_of(*keys.get(view.cursor.row.min(keys.len().saturating_sub(1)))?)
    });
    let count = data.era.as_ref().map_or(1, |era| era.settings.feedback.bearings.len());
    selected.filter(|bearing| *bearing < count).unwrap_or(0)
}

/// The settings: a click selects one, a drag nudges it a step a cell, the wheel selects the next.
pub(crate) struct SettingsPanel;

impl Panel for SettingsPanel {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, area, buffer);
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        let inner = area.inner(Margin::new(1, 1));
        let selected = view.cursor.row;
        let shown = shown_rows(view.data.settings.as_ref()?, view.data.rotor.as_deref(), view.filter, selected);
        match mouse {
            Mouse::Wheel(notches) => Some(PanelRequest::SelectRows(notches as isize)),
            Mouse::Drag(0) => None,
            Mouse::Drag(cells) => Some(PanelRequest::Nudge(f64::from(cells))),
            Mouse::Click => {
                let first = first_row(&shown, selected, inner.height);
                let row = shown.get(first + usize::from(at.y.checked_sub(inner.y)?))?;
                inner.contains(at).then_some(PanelRequest::SelectSetting(*row))
            }
        }
    }
}

/// The first of the rows in view: the selected one is.
fn first_row(shown: &[usize], selected: usize, height: u16) -> usize {
    let (height, count) = (usize::from(height), shown.len());
    let at = shown.iter().position(|row| *row == selected).unwrap_or(count.saturating_sub(1));
    (at + 1).saturating_sub(height).min(count.saturating_sub(height))
}

fn draw(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let (data, cursor) = (view.data, view.cursor);
    let rotor = data.rotor.as_deref();
    let keys = data.settings.as_ref().map(|settings| rows(settings, rotor)).unwrap_or_default();
    let shown = |settings| shown_rows(settings, rotor, view.filter, cursor.row);
    let shown = data.settings.as_ref().map(shown).unwrap_or_default();
    let passed = filter_title(view.filter, shown.len(), keys.len());
    let title = match &data.bench_status {
        Some(bench_status) => {
            format!(" settings  rev {} by {} {passed}", bench_status.revision, bench_status.changed_by.as_str())
        }
        None => " settings ".to_owned(),
    };
    let inner = framed(Line::from(title), area, buffer);
    let Some(settings) = &data.settings else { return };
    let units = data.units();
    let slopes = data
        .rotor
        .clone()
        .and_then(|rotor| view.jobs.slopes(&SlopeRequest::with(rotor, settings, speed_of(view, settings))));
    let first = first_row(&shown, cursor.row, inner.height);
    let in_view = || shown[first..].iter().take(usize::from(inner.height));
    // One column for all, so that the values stand below each other.
    let steps: Vec<String> = in_view().map(|at| step_of(settings, &units, keys[*at], inner.width)).collect();
    let column = steps.iter().map(|step| width(step)).max().unwrap_or(0);
    for ((y, at), step) in (inner.top()..inner.bottom()).zip(in_view()).zip(steps) {
        let row = Rect { y, height: 1, ..inner };
        let other = other_of(view, settings, &units, keys[*at]);
        let arrow = slopes.as_ref().and_then(|slopes| arrow(slopes, settings, &units, keys[*at]));
        let beside = Beside { step, other, arrow };
        draw_row((settings, &units), keys[*at], (*at == cursor.row).then_some(cursor), beside, (row, column), buffer);
    }
    // On the frame, where no value is hidden by it.
    let last = (first + usize::from(inner.height)).min(shown.len());
    draw_overflow(&(first..last), shown.len(), area, buffer);
}

/// What else the setting may become, where that is another value: that of a change that is being typed or asked about, else the one that is
/// held to compare with.
fn other_of(view: &View<'_>, settings: &Settings, units: &ScreenUnits, key: Key) -> Option<String> {
    let differs = |other: &&Settings| other.get(key) != settings.get(key) || other.gain(key) != settings.gain(key);
    let told = |other: &Settings| value_of(other, units, key);
    let then = view.what_if.map(|what_if| &what_if.settings).filter(differs).map(|then| format!("-> {}", told(then)));
    then.or_else(|| view.held.filter(differs).map(|held| format!("held {}", told(held))))
}

/// Changes of the damping that are less than this are rounding.
const LEAST: f64 = 1e-9;

/// What a step up does to the smallest damping: where to and by how much, or a diamond where it falls either way. Nothing where it does
/// nothing, or that is not known.
fn arrow(slopes: &SettingSlopes, settings: &Settings, units: &ScreenUnits, key: Key) -> Option<String> {
    let slope = slopes.slope(key)?;
    if slope.up < 0.0 && slope.down > 0.0 {
        return Some("◆".into());
    }
    let change = slope.up * units.step_among(key, settings) / units.setting(key).factor;
    let sign = if change > 0.0 { '▲' } else { '▼' };
    (change.abs() > LEAST && change.is_finite()).then(|| format!("{sign}{}", tiny(change.abs())))
}

/// What stands beside a value.
struct Beside {
    step: String,
    other: Option<String>,
    arrow: Option<String>,
}

fn draw_row(
    (settings, units): (&Settings, &ScreenUnits),
    key: Key,
    cursor: Option<&SettingsCursor>,
    Beside { step, other, arrow }: Beside,
    (row, column): (Rect, usize),
    buffer: &mut Buffer,
) {
    let style = if cursor.is_some() { Style::new().add_modifier(Modifier::BOLD) } else { Style::new() };
    write(buffer, row, row.left(), row.top(), if cursor.is_some() { "▶" } else { " " }, theme::loud(theme::CURSOR));
    let name = write(buffer, row, row.left() + 2, row.top(), &settings.label(key), style) - row.left();
    let typed = cursor.and_then(|cursor| cursor.typed.as_ref());
    let value = match typed {
        Some(typed) => Line::from(typed.spans(theme::badge(theme::CURSOR))),
        None => Line::styled(value_of(settings, units, key), style),
    };
    // What kind of gain it is goes first, then the step; the value stays whole.
    // What is typed may cover the name: its end must be seen.
    let room = row.width.saturating_sub(if typed.is_some() { 2 } else { name + 1 });
    let value = match value.to_string().split_once(' ') {
        Some((number, _)) if value.width() > usize::from(room) => Line::styled(number.to_owned(), style),
        _ => value,
    };
    // What it may become stands in place of the step.
    let (step, color) = match other {
        Some(other) => (other, theme::loud(theme::CANDIDATE)),
        None => (step, theme::quiet()),
    };
    let own = if step.is_empty() { 0 } else { width(&step).max(5) as u16 + 2 };
    let common = if own == 0 { 0 } else { own.max(column as u16 + 2) };
    // A number that leaves no room for what it counts in is told in four digits, with its unit.
    let value = match (units.scales, typed) {
        (Some(_), None) if own > 0 && value.width() as u16 + own > room => {
            in_brief(settings, units, key, style).unwrap_or(value)
        }
        _ => value,
    };
    let has_room = |beside: &u16| value.width() as u16 + *beside <= room;
    let beside = [common, own].into_iter().find(has_room).unwrap_or(0);
    if beside > 0 {
        write(buffer, row, row.right().saturating_sub(beside - 2), row.top(), &step, color);
    }
    let wide = (value.width() as u16).min(room);
    let place = Rect { x: row.right() - beside - wide, width: wide, ..row };
    if let Some(arrow) = arrow.filter(|_| typed.is_none()) {
        // One column free towards the name, two towards the value, or one where there is no more.
        let long = width(&arrow) as u16;
        let ends = [2, 1].map(|free| place.x.saturating_sub(free));
        if let Some(end) = ends.into_iter().find(|end| *end >= row.left() + name + 1 + long) {
            write(buffer, row, end - long, row.top(), &arrow, theme::quiet());
        }
    }
    write_line(buffer, place, value);
}

/// A value as short as it can be told, with a word if it is a schedule.
fn value_of(settings: &Settings, units: &ScreenUnits, key: Key) -> String {
    let unit = units.setting(key);
    let value = settings.get(key).unwrap_or(f64::NAN);
    if key.parameter.off == Some(value) && key.parameter.name != "seed" {
        return "off".into();
    }
    let value = value * unit.factor;
    // What the product of a few digits leaves behind them is not part of it.
    let rounded = if units.scales.is_some() { significant(value, 7) } else { (value * 1e6).round() / 1e6 };
    match settings.gain(key) {
        Some(Gain::Linear { .. }) => format!("{} linear", compact(rounded)),
        Some(Gain::Table(_)) => format!("{} table", compact(rounded)),
        Some(Gain::Constant(_)) | None => compact(rounded),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::test_support as tests;

    #[test]
    fn small_values_have_no_row_of_zeros() {
        for (value, text) in [(0.0, "0"), (2.5, "2.5"), (-0.5879, "-0.5879"), (0.001, "0.001"), (-5e-6, "-5e-6")] {
            assert_eq!(compact(value), text);
        }
    }

    #[test]
    fn values_steps_and_selection_are_shown() {
        let data = tests::frame_data();
        let cursor = SettingsCursor { row: 3, typed: None };
        let frame = drawn(36, 10, |area, buffer| draw(&View { cursor: &cursor, ..view(&data) }, area, buffer));
        insta::assert_snapshot!("settings", frame);
        let typing = SettingsCursor { row: 3, typed: Some("-0.4".into()) };
        let frame = drawn(36, 10, |area, buffer| draw(&View { cursor: &typing, ..view(&data) }, area, buffer));
        assert!(frame.contains("▶ kd") && frame.contains("-0.4_"), "{frame}");
    }

    #[test]
    fn what_is_held_and_what_would_be_stand_beside_what_is() {
        let data = tests::frame_data();
        let mut held = data.settings.clone().unwrap();
        held.set("cd".parse().unwrap(), 0.25).unwrap();
        let of = |view: View<'_>| drawn(36, 10, |area, buffer| draw(&view, area, buffer));
        let beside = of(View { held: Some(&held), ..view(&data) });
        assert!(beside.contains("0.4948  held 0.25 ") && beside.matches("held").count() == 1, "{beside}");
        let what_if = telemetry::what_if::WhatIf::of(data.rotor.as_ref().unwrap(), held.clone()).unwrap();
        let then = of(View { held: Some(&held), what_if: Some(&what_if), ..view(&data) });
        assert!(then.contains("0.4948  -> 0.25 ") && !then.contains("held"), "{then}");
    }

    #[test]
    fn the_selected_row_stays_in_view() {
        let mut data = tests::frame_data();
        data.settings = Some(tests::bench_status("three-mass", "individual").settings.get().clone());
        let cursor = SettingsCursor { row: 10, typed: None };
        let frame = drawn(36, 5, |area, buffer| draw(&View { cursor: &cursor, ..view(&data) }, area, buffer));
        assert!(frame.contains("▶ cc.2"), "{frame}");
        let first = drawn(36, 5, |area, buffer| draw(&view(&data), area, buffer));
        assert!(first.contains("▶ speed") && first.contains('▼'), "{first}");
    }

    #[test]
    fn deadbands_that_differ_have_a_row_each() {
        let mut settings = tests::bench_status("three-mass", "composite").settings.get().clone();
        let deadbands = |settings: &Settings, rotor: Option<&Rotor>| {
            let keys = rows(settings, rotor).into_iter().filter(|key| key.parameter.name == "deadband");
            keys.map(|key| key.to_string()).collect::<Vec<_>>()
        };
        assert_eq!(deadbands(&settings, None), ["deadband"]);
        settings.deadband[0] = 0.0;
        assert_eq!(deadbands(&settings, None), ["deadband.1", "deadband.2", "deadband.3"]);
        // The middle mass has no bearing.
        let three_mass = rotor::builtin::rotor("three-mass").unwrap();
        assert_eq!(deadbands(&settings, Some(&three_mass)), ["deadband.1", "deadband.3"]);
    }

    #[test]
    fn there_are_rows_of_clearances_only_where_something_has_play() {
        let rotor = rotor::builtin::rotor("rig").unwrap();
        let mut settings = Settings::new(&rotor, 0.0, rotor::builtin::feedback(&rotor, "own").unwrap());
        let deadbands = |settings: &Settings| {
            let keys = rows(settings, Some(&rotor)).into_iter().filter(|key| key.parameter.name == "deadband");
            keys.map(|key| key.index).collect::<Vec<_>>()
        };
        let met: Vec<usize> = (0..rotor.len()).filter(|place| rotor.has_contact(*place)).collect();
        assert_eq!((met.len(), rotor.len()), (2, 12), "its touchdown bearings");
        assert_eq!(deadbands(&settings), [None], "both alike");
        settings.deadband[met[0]] *= 2.0;
        assert_eq!(deadbands(&settings), [Some(met[0]), Some(met[1])]);
    }

    #[test]
    fn settings_of_one_of_several_control_bearings_are_found_by_its_name() {
        let rotor = rotor::builtin::rotor("rig").unwrap();
        let settings = Settings::new(&rotor, 0.0, rotor::builtin::feedback(&rotor, "own").unwrap());
        let keys = rows(&settings, Some(&rotor));
        let found = shown_rows(&settings, Some(&rotor), "right", 0);
        let names: Vec<String> = found.iter().map(|at| settings.label(keys[*at])).collect();
        assert_eq!(names[0], "speed", "the selected one is never hidden");
        assert!(names.len() > 4 && names[1..].iter().all(|name| name.starts_with("right.")), "{names:?}");
    }

    #[test]
    fn a_limit_is_in_newtons_of_its_own_control_bearing() {
        let mut data = tests::frame_data_of_two_bearings();
        let settings = data.settings.as_mut().unwrap();
        let keys = ["left.limit", "right.limit"].map(|key| settings.key(key).unwrap());
        keys.iter().for_each(|key| settings.set(*key, 2.0).unwrap());
        let units = data.units();
        let told = keys.map(|key| value_of(data.settings.as_ref().unwrap(), &units, key));
        assert_eq!(told, ["36", "108"]);
        // Gains likewise, and clearances in what radii are in: K_t = 3.6e6 N/m, a quarter and three of it, and e_t = 20 um.
        let frame = drawn(36, 30, |area, buffer| draw(&view(&data), area, buffer));
        for row in [
            ["speed", "2864.789", "rpm"],
            ["trip", "20000", "μm"],
            ["left.kd", "450000", "N/m"],
            ["right.kd", "1350000", "N/m"],
            ["left.cd", "1500", "N s/m"],
        ] {
            assert!(frame.lines().any(|line| row.iter().all(|word| line.contains(word))), "{row:?}\n{frame}");
        }
        let narrow = drawn(30, 30, |area, buffer| draw(&view(&data), area, buffer));
        assert!(narrow.lines().any(|line| line.contains("left.kd") && line.contains(" N/m")), "{narrow}");
    }

    #[test]
    fn a_scheduled_gain_says_so() {
        let settings = tests::bench_status("jeffcott", "cancel").settings.get().clone();
        let kc = rows(&settings, None).into_iter().find(|key| key.parameter.name == "kc").unwrap();
        assert_eq!(value_of(&settings, &ScreenUnits::DIMENSIONLESS, kc), "-1.25 linear");
    }
}
