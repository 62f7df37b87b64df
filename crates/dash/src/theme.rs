//! Colours by meaning, from the sixteen that every terminal has and lets its owner choose, so that they stand on light
//! and dark alike. Nothing is told by colour alone: words and signs say it too.

use ratatui::style::{Color, Modifier, Style};

/// Good, and where the machine runs.
pub(crate) const GOOD: Color = Color::Green;
/// Near a limit.
pub(crate) const WARN: Color = Color::Yellow;
/// Past a limit.
pub(crate) const BAD: Color = Color::Red;
/// Forward whirl, and what belongs to y.
pub(crate) const FORWARD: Color = Color::Cyan;
/// Backward whirl, and what belongs to z.
pub(crate) const BACKWARD: Color = Color::Magenta;
/// Axes, boundaries and rays.
pub(crate) const GRID: Color = Color::DarkGray;
/// Deadband circles.
pub(crate) const CLEARANCE: Color = Color::Blue;
/// The keyphasor.
pub(crate) const KEY: Color = Color::Yellow;
/// Control force.
pub(crate) const FORCE: Color = Color::Yellow;

/// Traces of several masses, by mass.
pub(crate) const TRACES: [Color; 4] = [Color::Cyan, Color::Green, Color::Magenta, Color::Blue];

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

/// Minimum damping below which a rotor is stable but only just: API 684 asks for a log decrement of 0.1, which is this.
pub(crate) const MARGINAL_DAMPING: f64 = 0.0159;

/// The colour and the word for a minimum damping.
pub(crate) fn verdict(min_damping: f64) -> (Color, &'static str) {
    if min_damping <= 0.0 {
        (BAD, "UNSTABLE")
    } else if min_damping < MARGINAL_DAMPING {
        (WARN, "marginal")
    } else {
        (GOOD, "stable")
    }
}
