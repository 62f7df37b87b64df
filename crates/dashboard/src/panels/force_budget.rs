//! What the control bearing is asked for, and by which term of the feedback; of several that of the selected setting, or the first.
//!
//! ```text
//! ┌ force budget  m_b w0² e_t ──────────────────────┐
//! │ now    0.8000  ████████████░░░░░░░               │   of the limit of the alarm, or of the largest; "was" in the past
//! │ max    1.4230  ███████████████████               │   since the settings changed
//! │ limit 2.0000  in view 1.1200                     │   of the alarm; the most within the window
//! │ y      0.7132  ██████████░░░░░░░░░               │
//! │ z     -0.3621  █████░░░░░░░░░░░░░░               │
//! │ signal 1  displacement 0.5512   velocity 0.9310  │   |(kd - j kc) p| and |(cd - j cc) p'|
//! │   kd 0.3121  kc 0.4544  cd 0.7012  cc 0.6123     │   the share of each gain alone
//! └──────────────────────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::Line;
use rotor::{C64, J, Signal};

use super::force::when;
use super::panel::Panel;
use super::settings::bearing_in_view;
use crate::axis::PlotAxis;
use crate::drawing::{framed, write};
use crate::fit_text::longest;
use crate::theme;
use crate::view::View;
use telemetry::history::{StepQuantity, Track};
use text::number::short;

/// Width of a label and its number.
const HEAD: u16 = 16;

/// What one signal adds to the control, gain by gain: `u` is the sum over all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Terms {
    pub(crate) kd: C64,
    pub(crate) kc: C64,
    pub(crate) cd: C64,
    pub(crate) cc: C64,
}

impl Terms {
    /// Of `signal` at spin speed `speed` with the masses where they are at step `step`:
    /// `u = - sum [(kd - j kc) p + (cd - j cc) p']`.
    pub(crate) fn of(signal: &Signal, speed: f64, track: &Track, step: usize) -> Self {
        let sum = |weights: &[f64], of: &dyn Fn(usize) -> [f64; 2]| -> C64 {
            weights
                .iter()
                .enumerate()
                .map(|(mass, weight)| {
                    let [y, z] = of(mass);
                    C64::new(y, z) * weight
                })
                .sum()
        };
        let p = sum(&signal.displacement, &|mass| track.displacement(step, mass));
        let v = sum(&signal.velocity, &|mass| track.velocity(step, mass));
        let [kd, cd, kc, cc] = [0, 1, 2, 3].map(|gain| signal.gains[gain].at(speed));
        Self { kd: -kd * p, kc: J * kc * p, cd: -cd * v, cc: J * cc * v }
    }

    /// What it adds in all.
    #[cfg(test)]
    fn sum(&self) -> C64 {
        self.kd + self.kc + self.cd + self.cc
    }
}

/// The budget; the wheel changes the scale of its bars.
#[derive(Debug, Default)]
pub(crate) struct ForceBudget {
    scale: PlotAxis,
}

impl Panel for ForceBudget {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, &mut self.scale, area, buffer);
    }

    fn scale(&mut self) -> Option<&mut PlotAxis> {
        Some(&mut self.scale)
    }
}

fn draw(view: &View<'_>, axis: &mut PlotAxis, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let bearing = bearing_in_view(view);
    let unit = data.units().force_of(bearing);
    let several = data.era.as_ref().map(|era| &era.settings.feedback).filter(|feedback| feedback.only().is_none());
    let of = several.map_or(String::new(), |feedback| format!(" {}", feedback.label(bearing)));
    let mut title = format!(" force budget{of}  {} ", unit.name);
    if axis.is_fixed() {
        let [_, full] = axis.over([0.0, 1.0]);
        title += &format!(" bars to {} fixed ", short(full, 3));
    }
    let inner = framed(Line::from(title), area, buffer);
    let Some(now) = data.now else { return };
    let track = &data.track;
    let factor = unit.factor;
    // A zero has no sign.
    // When another machine takes the name, its settings and its steps do not come at the same moment.
    let bearing = bearing.min(track.layout().bearings() - 1);
    let [y, z] = track.forces(now, bearing)[1].map(|part| part * factor + 0.0);
    let most = data.peak_forces[bearing] * factor;
    let force = StepQuantity::force(bearing);
    let within = track.range(force, data.window.clone()).map_or(0.0, |[_, high]| high * factor);
    // Limits are of the force as that of the first control bearing.
    let per_first = data.masses_of_bearings().as_of_first(bearing, 1.0);
    let limit = view.alarms.limits().of_bearing(bearing).map(|limit| limit.alarm / per_first * factor);
    let [_, full] = axis.over([0.0, limit.unwrap_or(most).max(f64::MIN_POSITIVE)]);
    let mut rows = (inner.top()..inner.bottom()).map(|y| Rect { y, height: 1, ..inner });
    let past = |value: f64| if limit.is_some_and(|limit| value > limit) { theme::BAD } else { theme::FORCE };
    let (u, told) = (y.hypot(z), limit.map_or_else(|| "none set".to_owned(), |limit| short(limit, 5)));
    for (row, (name, value, color)) in rows.by_ref().take(2).zip([(when(view), u, past(u)), ("max", most, past(most))])
    {
        gauge(name, value, full, color, row, buffer);
    }
    if let Some(row) = rows.next() {
        let limit = format!("limit {told}");
        let both = longest(&[&format!("{limit}  in view {}", short(within, 5)), &limit], usize::from(row.width));
        write(buffer, row, row.x, row.y, &both, Style::new());
    }
    for (row, (name, value, color)) in rows.by_ref().take(2).zip([("y", y, theme::FORWARD), ("z", z, theme::BACKWARD)])
    {
        gauge(name, value, full, color, row, buffer);
    }
    let mut lines = Vec::new();
    if let Some(era) = &data.era {
        let speed = track.speed(now);
        let signals = era.settings.feedback.bearings.get(bearing).map_or(&[][..], |bearing| &bearing.signals);
        for (at, signal) in signals.iter().enumerate() {
            let terms = Terms::of(signal, speed, track, now);
            let told = |term: C64| short(term.norm() * factor, 4);
            let (p, v) = (told(terms.kd + terms.kc), told(terms.cd + terms.cc));
            let full = format!("signal {}  displacement {p}  velocity {v}", at + 1);
            let brief = format!("signal {}  disp. {p}  vel. {v}", at + 1);
            lines.push((longest(&[&full, &brief], usize::from(inner.width)), Style::new()));
            let [kd, kc, cd, cc] = [terms.kd, terms.kc, terms.cd, terms.cc].map(told);
            lines.push((format!("  kd {kd}  kc {kc}  cd {cd}  cc {cc}"), theme::quiet()));
        }
    }
    for (row, (line, style)) in rows.zip(lines) {
        write(buffer, row, row.x, row.y, &line, style);
    }
}

/// A name, a number, and a bar as long as its share of `full`.
fn gauge(name: &str, value: f64, full: f64, color: Color, row: Rect, buffer: &mut Buffer) {
    let style = theme::loud(color);
    write(buffer, row, row.x, row.y, &format!("{name:<4}{:>10}", short(value, 5)), style);
    let cells = row.width.saturating_sub(HEAD);
    let filled = (value.abs() / full * f64::from(cells)).round().clamp(0.0, f64::from(cells)) as usize;
    let bar = "█".repeat(filled) + &"░".repeat(usize::from(cells) - filled);
    write(buffer, row, row.x + HEAD, row.y, &bar, style);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rotor::{Feedback, builtin};

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    #[test]
    fn now_most_and_each_term_are_told() {
        let data = tests::frame_data();
        let frame_of = |width, height| {
            drawn(width, height, |area, buffer| ForceBudget::default().draw(&view(&data), area, buffer))
        };
        insta::assert_snapshot!("force_budget", frame_of(52, 9));
        insta::assert_snapshot!("force_budget_small", frame_of(24, 5));
        insta::assert_snapshot!("force_budget_large", frame_of(100, 14));
        assert!(frame_of(52, 9).contains("now     0.8000"), "{}", frame_of(52, 9));
    }

    #[test]
    fn of_several_control_bearings_that_of_the_selected_setting_is_told_in_newtons_of_its_own() {
        let data = tests::frame_data_of_two_bearings();
        let settings = data.settings.as_ref().unwrap();
        let frame_of = |label: &str| {
            let keys = crate::panels::settings::rows(settings, data.rotor.as_deref());
            let row = keys.iter().position(|key| settings.label(*key) == label).unwrap();
            let cursor = crate::view::SettingsCursor { row, typed: None };
            let view = crate::view::View { cursor: &cursor, ..view(&data) };
            drawn(52, 9, |area, buffer| ForceBudget::default().draw(&view, area, buffer))
        };
        // 3 times 18 N, and 2 times 54 N.
        for (label, told) in
            [("speed", "54.000"), ("left.kd", "54.000"), ("right.kd", "108.00"), ("right.lag", "108.00")]
        {
            let frame = frame_of(label);
            let name = if told == "108.00" { "right" } else { "left" };
            assert!(frame.contains(&format!("force budget {name}  N")), "{frame}");
            assert!(
                frame.contains(&format!("now     {told}")) && frame.contains(&format!("max     {told}")),
                "{frame}"
            );
            assert!(frame.contains(&format!("in view {told}")), "{frame}");
        }
    }

    proptest! {
        /// The terms of all signals sum up to the control that the rotor's own control law gives.
        #[test]
        fn terms_sum_up_to_the_control(
            gains in prop::array::uniform4(-3.0..3.0),
            others in prop::array::uniform4(-3.0..3.0),
            weights in prop::collection::vec(-2.0..2.0, 3),
            speed in 0.0..8.0,
            at in prop::collection::vec(-5.0..5.0, 12),
        ) {
            let rotor = builtin::rotor("three-mass").unwrap();
            let signals = vec![Signal::composite(&weights, gains), Signal::at_mass(2, 3, others)];
            let feedback = Feedback::new(0, signals);
            let mut state = tests::state(3, 0);
            let (mut p, mut v) = ([C64::ZERO; 3], [C64::ZERO; 3]);
            for (mass, q) in at.chunks(4).enumerate() {
                state = state.with_point(mass, wire::Point { y: q[0], z: q[1], vy: q[2], vz: q[3] });
                (p[mass], v[mass]) = (C64::new(q[0], q[1]), C64::new(q[2], q[3]));
            }
            let now = std::time::Instant::now();
            let mut feed = Feed::new("");
            feed.push_step(&state, now);
            let track = feed.frame_data(&ViewTime::LIVE, now).track;
            let sum: C64 = feedback.signals().map(|signal| Terms::of(signal, speed, &track, 0).sum()).sum();
            let row = feedback.first().at(speed);
            let law = -(0..rotor.len()).map(|m| row.displacement[m] * p[m] + row.velocity[m] * v[m]).sum::<C64>();
            prop_assert!((sum - law).norm() < 1e-12 * (1.0 + law.norm()), "{sum} and {law}");
        }
    }
}
