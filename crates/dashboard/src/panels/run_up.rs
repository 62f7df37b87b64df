//! The first order of one mass over speed as a run-up or a coast-down goes on: amplitude above, phase below.
//!
//! ```text
//! ┌ run-up  mass 1  ─ up ┄ down ─────────┐
//! │4.0 e_t      ⢸⡇         peak 3.2 at R 2│   solid while the speed rises, dotted while it falls
//! │            ⡠⠃⠱⡀  ┃                   │   ┃ the moment that is looked at
//! │⠤⠤⠤⠔⠒⠊⠉⠉    ⠈⠒⠢┃⠤⠤⠤                 │
//! │180 deg                               │
//! │⠉⠉⠉⠉⠉⠉⠉⠒⢄      ┃                   │
//! │           ⠑⠒⠤⠤⣀⣀┃⣀                 │
//! │0                                    6│
//! └ ┃ R 2.31  0.812 e_t  -93 deg ────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Position, Rect};
use ratatui::style::Color;
use ratatui::text::{Line, Span};
use telemetry::jobs::run_up::{RunUpRequest, SpeedLeg, SpeedLegs, TrackedTurn};
use text::number::{neat, nice_ceiling, short};

use super::panel::{Panel, PanelCommand, PanelRequest};
use super::wheel_times;
use crate::axis::PlotAxis;
use crate::drawing::{framed, write, write_beside_lines, write_free, write_right};
use crate::input::Mouse;
use crate::plot::{Plot, Window};
use crate::theme;
use crate::view::View;

/// The part of a plot's width from dot to dot of a dotted line, about.
const APART: f64 = 1.0 / 60.0;

/// The mass whose first order is looked at, counted from 0: the one with the first control bearing unless another is chosen.
pub(super) fn mass_of(chosen: Option<usize>, view: &View<'_>) -> usize {
    chosen.unwrap_or_else(|| view.data.bearing_mass()).min(view.data.masses().saturating_sub(1))
}

/// What is known of the runs of a mass; nothing before the first steps.
pub(super) fn legs_of(mass: usize, view: &View<'_>) -> Option<std::sync::Arc<SpeedLegs>> {
    if view.data.kept.is_empty() {
        return None;
    }
    view.jobs.run_up(&RunUpRequest::of(&view.data.kept, mass, view.data.seconds))
}

/// What a title says of the strokes.
pub(super) fn strokes() -> [Span<'static>; 2] {
    [Span::styled(" ─ up", theme::loud(theme::FORWARD)), Span::styled(" ┄ down ", theme::loud(theme::BACKWARD))]
}

/// A leg's points: a line while the speed rises, dots while it falls. Where `breaks` says so the line ends and begins anew.
pub(super) fn stroke(
    leg: &SpeedLeg,
    place: impl Fn(&TrackedTurn) -> [f64; 2],
    breaks: impl Fn(&TrackedTurn, &TrackedTurn) -> bool,
    window: Window,
    plot: &mut Plot,
) {
    if leg.is_upward {
        for pair in leg.turns.chunk_by(|a, b| !breaks(a, b)) {
            plot.path(pair.iter().map(&place), theme::FORWARD);
        }
        return;
    }
    let [wide, high] = [window.x, window.y].map(|[low, high]| high - low);
    let mut since = f64::INFINITY;
    let mut before = None::<[f64; 2]>;
    for [x, y] in leg.turns.iter().map(place) {
        if let Some([from_x, from_y]) = before {
            since += ((x - from_x) / wide).hypot((y - from_y) / high);
        }
        before = Some([x, y]);
        if since >= APART {
            plot.dot(x, y, theme::BACKWARD);
            since = 0.0;
        }
    }
}

/// What is told of a turn, with a sign before it.
pub(super) fn told(turn: &TrackedTurn, view: &View<'_>) -> String {
    let units = view.data.units();
    let size = units.length.told(turn.first_order.norm(), 4);
    format!(" ┃ {}  {size}  {:.0} deg ", units.speed_told(turn.speed), turn.first_order.arg().to_degrees())
}

/// The place in the history of the step that is looked at.
pub(super) fn place_in_view(view: &View<'_>) -> Option<u64> {
    view.data.now.map(|now| view.data.track.index_of(now))
}

/// The panel: a click looks at the moment when the machine passed that speed, the wheel changes the scale of the amplitude.
#[derive(Debug, Default)]
pub(crate) struct RunUp {
    mass: Option<usize>,
    /// Speeds, as they stand on the axis.
    along: PlotAxis,
    /// Amplitudes, as they stand on the axis.
    value: PlotAxis,
    /// What was last shown of speeds and amplitudes, and where: the amplitude and the phase.
    shown: Option<(Window, [Rect; 2])>,
}

/// Where a run-up may go and how fast, as it is typed, in the units of the rotor: somewhat past the present speed, in a minute or so.
fn example(view: &View<'_>) -> String {
    let units = view.data.units();
    if units.scales.is_none() {
        return "6 0.01".to_owned();
    }
    let present = view.data.settings.as_ref().map_or(0.0, |settings| units.speed.factor * settings.speed);
    let to = nice_ceiling(1.2 * present.max(1000.0));
    format!("{}rpm {}rpm/s", neat(to), neat(nice_ceiling(to / 60.0)))
}

impl Panel for RunUp {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        let mass = mass_of(self.mass, view);
        let mut title = Line::from(format!(" run-up  mass {}", mass + 1));
        title.spans.extend(strokes());
        let inner = framed(title, area, buffer);
        self.shown = None;
        let Some(legs) = legs_of(mass, view).filter(|_| inner.height > 2) else { return };
        if legs.legs.iter().all(|leg| leg.turns.is_empty()) {
            let told = format!("no run-up yet: `:run-up {}`", example(view));
            write(buffer, inner, inner.left(), inner.top(), &told, theme::quiet());
            return;
        }
        draw(view, &legs, self, (area, inner), buffer);
    }

    fn mouse(&mut self, view: &View<'_>, _area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        if let Mouse::Wheel(notches) = mouse {
            self.value.zoom(wheel_times(notches), None);
            return None;
        }
        let (window, [upper, lower]) = self.shown?;
        let legs = legs_of(mass_of(self.mass, view), view)?;
        let plot = Plot::new(upper, window);
        // On the amplitude the nearest point is meant, as a speed may be passed twice; below, the last time it was.
        let far = |turn: &TrackedTurn| {
            let (x, y) = plot.cell(turn.speed, turn.first_order.norm())?;
            let high = if upper.contains(at) { 2.0 * (f64::from(y) - f64::from(at.y)) } else { 0.0 };
            Some((f64::from(x) - f64::from(at.x)).hypot(high))
        };
        if !(upper.contains(at) || lower.contains(at)) {
            return None;
        }
        let known = legs.turns().filter_map(|turn| Some((far(turn)?, turn.place)));
        let (_, place) = known.min_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
        Some(PanelRequest::LookAtStep(place))
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        match command {
            PanelCommand::Value(scalings) => Some(self.value.take(*scalings.first()?, None)),
            PanelCommand::Along(scaling, _) => Some(self.along.take(*scaling, None)),
            PanelCommand::Mass(mass) => {
                self.mass = *mass;
                Some(Ok(()))
            }
            _ => None,
        }
    }
}

fn draw(view: &View<'_>, legs: &SpeedLegs, panel: &mut RunUp, (frame, area): (Rect, Rect), buffer: &mut Buffer) {
    let units = view.data.units();
    let plotted = Rect { height: area.height - 1, ..area };
    let share = if plotted.height < 6 {
        [Constraint::Fill(1), Constraint::Length(0)]
    } else {
        [Constraint::Fill(3), Constraint::Fill(2)]
    };
    let [upper, lower] = Layout::vertical(share).areas(plotted);
    let fastest = legs.turns().map(|turn| turn.speed).fold(0.0, f64::max);
    let most = legs.highest().map_or(0.0, |turn| turn.first_order.norm());
    let factors = [units.speed.factor, units.length.factor];
    let [slow, fast] = panel.along.over([0.0, nice_ceiling(1.02 * fastest * factors[0])]).map(|end| end / factors[0]);
    let [low, high] = panel.value.over([0.0, nice_ceiling(1.05 * most * factors[1])]).map(|end| end / factors[1]);
    let window = Window { x: [slow, fast], y: [low, high] };
    panel.shown = Some((window, [upper, lower]));
    let here = place_in_view(view).and_then(|place| legs.at(place));

    let mut plot = Plot::new(upper, window);
    plot.line([slow, 0.0], [fast, 0.0], theme::GRID);
    for leg in &legs.legs {
        stroke(leg, |turn| [turn.speed, turn.first_order.norm()], |_, _| false, window, &mut plot);
    }
    let phases = Window { x: [slow, fast], y: [-180.0, 180.0] };
    let degrees = |turn: &TrackedTurn| turn.first_order.arg().to_degrees();
    let mut phase_plot = Plot::new(lower, phases);
    phase_plot.line([slow, 0.0], [fast, 0.0], theme::GRID);
    for leg in &legs.legs {
        let jumps = |a: &TrackedTurn, b: &TrackedTurn| (degrees(a) - degrees(b)).abs() > 180.0;
        stroke(leg, |turn| [turn.speed, degrees(turn)], jumps, phases, &mut phase_plot);
    }
    if let Some(here) = here {
        plot.line([here.speed, low], [here.speed, high], theme::CURSOR);
        phase_plot.line([here.speed, -180.0], [here.speed, 180.0], theme::CURSOR);
    }
    plot.paint(buffer);
    phase_plot.paint(buffer);

    let scale = format!("{}{} {}", panel.value.sign(), short(high * factors[1], 2), units.length.name);
    write_free(buffer, upper, upper.left(), upper.top(), &scale, theme::quiet());
    if let Some(peak) = legs.highest() {
        let size = units.length.told(peak.first_order.norm(), 4);
        let text = format!("peak {size} at {}", units.speed_told(peak.speed));
        write_beside_lines(buffer, upper, &text, theme::quiet());
    }
    write_free(buffer, lower, lower.left(), lower.top(), "180 deg", theme::quiet());
    let foot = Rect { y: plotted.bottom(), height: 1, ..area };
    let ends = [slow, fast].map(|speed| units.speed(speed));
    write(buffer, foot, foot.left(), foot.y, &format!("{}{}", panel.along.sign(), ends[0]), theme::quiet());
    let unit = if units.scales.is_some() { " rpm" } else { "" };
    write_right(buffer, foot, foot.y, &format!("{}{unit}", ends[1]), theme::quiet());
    mark(buffer, &plot, here, |turn| [turn.speed, turn.first_order.norm()], theme::CURSOR);
    if let Some(here) = here {
        let edge = Rect { width: frame.width.saturating_sub(2), ..frame };
        let foot = frame.bottom().saturating_sub(1);
        write(buffer, edge, frame.x + 1, foot, &told(here, view), theme::loud(theme::CURSOR));
    }
}

/// A sign on the turn that is looked at.
pub(super) fn mark(
    buffer: &mut Buffer,
    plot: &Plot,
    turn: Option<&TrackedTurn>,
    place: impl Fn(&TrackedTurn) -> [f64; 2],
    color: Color,
) {
    let at = turn.map(place).and_then(|[x, y]| plot.cell(x, y));
    if let Some((x, y)) = at {
        write(buffer, buffer.area, x, y, "◉", theme::loud(color));
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::time::Instant;

    use rotor::C64;
    use wire::{Channel, Point};

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::frame_data::FrameData;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    /// The steady response of a mass on a damped spring to unbalance, its critical speed at R = 1, up from 0.2 to 2.2 and down again.
    pub(crate) fn run() -> FrameData {
        let now = Instant::now();
        let mut feed = Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        let mut angle = 0.0;
        for seq in 0..40_000_u64 {
            let tau = seq as f64 * 0.01;
            let speed = if tau < 200.0 { 0.2 + tau / 100.0 } else { 4.2 - tau / 100.0 };
            let response = C64::from(speed * speed) / C64::new(1.0 - speed * speed, 0.2 * speed);
            let q = response * C64::cis(angle);
            let v = q * C64::new(0.0, speed);
            let state = tests::state(3, seq).with(Channel::Speed, 0, speed).with(Channel::Angle, 0, angle);
            angle += speed * 0.01;
            feed.push_step(&state.with_point(0, Point { y: q.re, z: q.im, vy: v.re, vz: v.im }), now);
        }
        feed.frame_data(&ViewTime::LIVE, now)
    }

    #[test]
    fn the_critical_speed_stands_out_and_the_phase_turns_there() {
        let data = run();
        let frame = drawn(70, 20, |area, buffer| RunUp::default().draw(&view(&data), area, buffer));
        // The largest amplitude of a damped spring, 1 / (2 zeta sqrt(1 - zeta^2)) at 1 / sqrt(1 - 2 zeta^2), with zeta = 0.1.
        let expected = 1.0 / (0.2 * 0.99_f64.sqrt());
        let peak: f64 = frame.split("peak ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        // A turn is read as a whole, over which the speed changes by a third of the peak's width: it is that much lower.
        assert!((0.95..1.0).contains(&(peak / expected)), "{peak} {expected}\n{frame}");
        assert!(frame.contains("at R 1.0") && frame.contains("─ up") && frame.contains('◉'), "{frame}");
        // What tells the peak lies on no line, however narrow the plot is.
        for width in [34, 40, 50, 70] {
            let frame = drawn(width, 20, |area, buffer| RunUp::default().draw(&view(&data), area, buffer));
            let Some(row) = frame.lines().find(|line| line.contains("peak ")) else { continue };
            let (before, after) = row.split_once("peak ").unwrap();
            let after =
                after.split_once(" at R ").unwrap().1.trim_start_matches(|c: char| c == '.' || c.is_ascii_digit());
            assert!(before.ends_with([' ', '│']) && after.starts_with([' ', '│']), "{frame}");
        }
        insta::assert_snapshot!("run_up", frame);
    }

    #[test]
    fn a_click_looks_at_the_moment_of_that_speed() {
        let data = run();
        let view = view(&data);
        let (mut panel, area) = (RunUp::default(), Rect::new(0, 0, 70, 20));
        panel.draw(&view, area, &mut Buffer::empty(area));
        let (_, [_, lower]) = panel.shown.unwrap();
        let asked = panel.mouse(&view, area, Mouse::Click, Position::new(lower.x + lower.width / 2, lower.y + 1));
        let Some(PanelRequest::LookAtStep(place)) = asked else { panic!("{asked:?}") };
        let speed = data.kept.speed((place - data.kept.index_of(0)) as usize);
        let (window, _) = panel.shown.unwrap();
        assert!((speed - 0.5 * (window.x[0] + window.x[1])).abs() < 0.1 && place > 20_000, "{place} {speed}");
    }

    #[test]
    fn without_a_run_it_says_how_to_begin_one() {
        let data = tests::frame_data();
        let frame = drawn(60, 8, |area, buffer| RunUp::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("no run-up yet: `:run-up 6 0.01`"), "{frame}");
    }
}
