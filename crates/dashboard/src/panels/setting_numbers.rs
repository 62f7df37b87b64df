//! Numbers of the settings panel: as short as they can be told.

use ratatui::style::Style;
use ratatui::text::Line;
use rotor::{Key, Settings};
use telemetry::units::ScreenUnits;
use text::number::{short, significant, trimmed};

/// Two digits, none of them a zero that says nothing.
pub(super) fn tiny(value: f64) -> String {
    if value < 1e-3 { short(value, 2) } else { trimmed(value, 2) }
}

/// The step of a setting, or what it counts in: as much as there is room for in a row; the value always is. What a number counts in matters
/// more than its step.
pub(super) fn step_of(settings: &Settings, units: &ScreenUnits, key: Key, wide: u16) -> String {
    let (step, unit) = (units.step_among(key, settings), units.setting(key).name);
    match (wide, units.scales) {
        (0..26, None) => String::new(),
        (26..34, None) => format!("±{}", compact(step)),
        (0..34, Some(_)) => format!("{unit:<5}"),
        (_, None) => format!("±{:<4} {unit:<3}", compact(step)),
        (_, Some(_)) => format!("±{:<5} {unit:<5}", brief(step)),
    }
}

/// A large number in few digits with an exponent; others as they are.
fn brief(value: f64) -> String {
    if value.abs() >= 1e5 { format!("{:e}", significant(value, 4)) } else { compact(value) }
}

/// A large value in four digits; nothing of others, which are as short already.
pub(super) fn in_brief(settings: &Settings, units: &ScreenUnits, key: Key, style: Style) -> Option<Line<'static>> {
    let value = settings.get(key).ok()? * units.setting(key).factor;
    (value.is_finite() && value.abs() >= 1e5).then(|| Line::styled(brief(value), style))
}

/// Every digit there is, without a row of zeros in front: `0.05`, `5e-6`.
pub(super) fn compact(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 { format!("{value:e}") } else { value.to_string() }
}
