//! Colours by meaning. Panels paint in *roles*: palette numbers that are never sent to a terminal. The last pass over a
//! frame, `appearance::Look::finish`, puts the chosen theme's colours in their place. Green, amber and red are what is stable, near a
//! limit and past it, and nothing else. Nothing is told by colour alone: words and signs say it too.

use alarms::Level;
use ratatui::style::{Color, Modifier, Style};
use telemetry::damping_verdict::DampingVerdict;
use telemetry::jobs::loop_analysis::{ISO_14839_3, sensitivity_zone};

/// How many roles there are.
pub(crate) const ROLES: usize = 23;

/// The colour that stands for a role until the frame is finished.
const fn role(number: u8) -> Color {
    assert!((number as usize) < ROLES);
    Color::Indexed(number)
}

/// Good, and where the machine runs.
pub(crate) const GOOD: Color = role(0);
/// Near a limit.
pub(crate) const WARN: Color = role(1);
/// Past a limit.
pub(crate) const BAD: Color = role(2);
/// Forward whirl, and what belongs to y.
pub(crate) const FORWARD: Color = role(3);
/// Backward whirl, and what belongs to z.
pub(crate) const BACKWARD: Color = role(4);
/// Axes, boundaries and rays.
pub(crate) const GRID: Color = role(5);
/// Deadband circles.
pub(crate) const CLEARANCE: Color = role(6);
/// Where poles go over speed.
pub(crate) const TRAIL: Color = CLEARANCE;
/// The keyphasor.
pub(crate) const KEYPHASOR: Color = role(7);
/// Control force.
pub(crate) const FORCE: Color = role(8);

/// Traces of several masses, by mass.
pub(crate) const TRACES: [Color; 4] = [role(9), role(10), role(11), role(12)];

/// What would be, beside what is.
pub(crate) const CANDIDATE: Color = role(13);
/// Where a person points, and the present within a plot.
pub(crate) const CURSOR: Color = role(14);

/// From little to much: waterfalls.
pub(crate) const HEAT: [Color; 8] = [role(15), role(16), role(17), role(18), role(19), role(20), role(21), role(22)];

/// Text that explains.
pub(crate) fn quiet() -> Style {
    Style::new().fg(GRID)
}

/// Text that must be seen.
pub(crate) fn loud(color: Color) -> Style {
    Style::new().fg(color).add_modifier(Modifier::BOLD)
}

/// A word on a bar of its colour.
pub(crate) fn badge(color: Color) -> Style {
    Style::new().fg(color).add_modifier(Modifier::BOLD | Modifier::REVERSED)
}

/// The colour and the word for a minimum damping.
pub(crate) fn verdict(min_damping: f64) -> (Color, &'static str) {
    let stability = DampingVerdict::of(min_damping);
    let color = match stability {
        DampingVerdict::Unstable | DampingVerdict::Marginal => BAD,
        DampingVerdict::Low => WARN,
        DampingVerdict::Stable => GOOD,
    };
    (color, stability.word())
}

/// The colour of a peak of the sensitivity: by the zone of ISO 14839-3 that it lies in.
pub(crate) fn sensitivity(peak: f64) -> Color {
    match sensitivity_zone(peak, ISO_14839_3) {
        "A" | "B" => GOOD,
        "C" => WARN,
        _ => BAD,
    }
}

/// A level as a sign and a word.
pub(crate) fn level_words(level: Level) -> &'static str {
    match level {
        Level::Fine => "ok",
        Level::Warning => "! WARNING",
        Level::Alarm => "!! ALARM",
    }
}

/// The colour of a level.
pub(crate) fn level_color(level: Level) -> Color {
    match level {
        Level::Fine => GOOD,
        Level::Warning => WARN,
        Level::Alarm => BAD,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_damping_is_marginal_and_little_is_low() {
        let words = [-1e-9, -0.0, 0.0, 1e-9, 0.5].map(|damping| verdict(damping).1);
        assert_eq!(words, ["UNSTABLE", "MARGINAL", "MARGINAL", "low", "stable"]);
    }
}
