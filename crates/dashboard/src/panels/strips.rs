//! Strips of chosen series over the window of time, with what they are under the cursor.
//!
//! ```text
//! ┌ last 41 tau  mass 1 2 3 ────────┐
//! │y ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀   ±5 │   one strip a word of `:strips`; "=" before a scale that stands still
//! │z ⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈     ±5 │
//! │u ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀   ±1 │   with a cursor, its values there
//! └ 4.1 s ───────-2──────-1─────────┘   seconds before the end; a strip of three rows or fewer shows how far its lines reach within a turn
//! ```

mod labels;
mod lines;

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Margin, Position, Rect};
use ratatui::text::{Line, Span};

use super::panel::{Panel, PanelCommand, PanelRequest};
use super::{look_at, wheel_times};
use crate::axis::{PlotAxis, Scaling};
use crate::drawing::{framed, write, write_right};
use crate::input::Mouse;
use crate::series::{Strip, Trace};
use crate::theme;
use crate::ticks;
use crate::view::View;
use lines::draw_strip;
use text::number::short;

/// What strips show if neither a person nor the layout says otherwise.
const USUAL: &str = "y z u";

/// The strips: a click looks at a moment, the wheel shows more or less time.
pub(crate) struct Strips {
    usual: Vec<Strip>,
    /// What the layout wants to be shown.
    of_layout: Option<Vec<Strip>>,
    /// What a person wants to be shown.
    chosen: Option<Vec<Strip>>,
    /// The scale of every strip that has ever been shown, by its name.
    scales: Vec<(String, PlotAxis)>,
    /// The mass that a person looks at, counted from 0; that with the control bearing if there is none.
    mass: Option<usize>,
}

impl Default for Strips {
    fn default() -> Self {
        let usual = Strip::read_all(USUAL).unwrap_or_default();
        Self { usual, of_layout: None, chosen: None, scales: Vec::new(), mass: None }
    }
}

impl Strips {
    fn shown(&self) -> &[Strip] {
        self.chosen.as_ref().or(self.of_layout.as_ref()).unwrap_or(&self.usual)
    }

    /// The scale of a strip.
    fn scale(&mut self, name: &str) -> &mut PlotAxis {
        let at = self.scales.iter().position(|(of, _)| of == name).unwrap_or(self.scales.len());
        if at == self.scales.len() {
            self.scales.push((name.to_owned(), PlotAxis::default()));
        }
        &mut self.scales[at].1
    }

    /// Scales the strip `name`, or all that are shown.
    fn rescale(&mut self, name: Option<&str>, scaling: Scaling) -> Option<Result<(), String>> {
        let shown: Vec<String> = self.shown().iter().map(|strip| strip.name.clone()).collect();
        let meant = |strip: &&String| name.is_none_or(|name| name == **strip);
        let done = shown.iter().filter(meant).map(|strip| self.scale(strip).take(scaling, None));
        done.reduce(Result::and)
    }
}

impl Panel for Strips {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, self, area, buffer);
    }

    fn mouse(&mut self, view: &View<'_>, area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        match mouse {
            Mouse::Wheel(notches) => Some(PanelRequest::ZoomTime(wheel_times(notches))),
            Mouse::Click | Mouse::Drag(_) => {
                let inner = area.inner(Margin::new(1, 1));
                look_at(view.data, &view.data.window, inner, at)
            }
        }
    }

    fn told_at(&self, view: &View<'_>, area: Rect, at: Position) -> Option<String> {
        let (data, inner) = (view.data, area.inner(Margin::new(1, 1)));
        let window = &data.window;
        if !inner.contains(at) || window.is_empty() {
            return None;
        }
        let along = (f64::from(at.x - inner.x) + 0.5) / f64::from(inner.width);
        let step = window.start + (along * window.len() as f64) as usize;
        let rows = Layout::vertical(vec![Constraint::Fill(1); usize::from(inner.height).min(self.shown().len())]);
        let row = rows.split(inner).iter().position(|row| row.contains(at))?;
        let strip = self.shown().get(row)?;
        let unit = strip.unit(&data.units());
        let value = |trace: &Trace| Some(format!("{} {}", trace.label, unit.short(trace.value(data, step)?, 5)));
        let values: Vec<String> = strip.traces(data.track.layout()).iter().filter_map(value).collect();
        let ago = (window.end - 1 - step) as f64 * data.seconds;
        let (ago, moment) = (short(-ago, 4), data.units().moment_told(data.track.tau(step), 6));
        Some(format!("{ago} s  {moment}  {} {}", values.join("  "), unit.name))
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        match command {
            PanelCommand::Value(scalings) => self.rescale(None, *scalings.first()?),
            PanelCommand::Strip(name, scalings) => self.rescale(Some(name), *scalings.first()?),
            PanelCommand::Strips(strips) => {
                self.chosen = strips.map(<[Strip]>::to_vec);
                Some(Ok(()))
            }
            PanelCommand::Mass(mass) => {
                self.mass = *mass;
                Some(Ok(()))
            }
            PanelCommand::StripsOfLayout(strips) => {
                if self.of_layout.as_deref() != *strips {
                    self.of_layout = strips.map(<[Strip]>::to_vec);
                }
                Some(Ok(()))
            }
            _ => None,
        }
    }
}

fn draw(view: &View<'_>, strips: &mut Strips, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let window = data.window.clone();
    let dtau = data.bench_status.as_ref().map_or(0.0, |bench_status| bench_status.dtau);
    let lasts = data.units().time_told(window.len() as f64 * dtau, 3);
    let which = if view.time.is_live() { "last " } else { "" };
    let mut title = vec![Span::raw(format!(" {which}{lasts} "))];
    let shown = strips.shown().to_vec();
    if shown.iter().any(Strip::is_of_every_mass) {
        title.push(Span::raw(" mass "));
        let masses = data.masses().min(theme::TRACES.len());
        title.extend((0..masses).map(|mass| Span::styled(format!("{} ", mass + 1), theme::loud(theme::TRACES[mass]))));
    }
    let inner = framed(Line::from(title), area, buffer);
    if window.is_empty() {
        return;
    }
    if area.height > 1 {
        let label = format!(" {} s ", short(window.len() as f64 * data.seconds, 3));
        let edge = Rect { width: area.width.saturating_sub(2), ..area };
        write(buffer, edge, area.left() + 1, area.bottom() - 1, &label, theme::quiet());
    }
    // What has no row of its own is left out, and said to be.
    let room = usize::from(inner.height).min(shown.len());
    if room < shown.len() && room > 0 {
        let edge = Rect { width: area.width.saturating_sub(1), ..area };
        write_right(
            buffer,
            edge,
            area.bottom() - 1,
            &format!(" {} more ▼ ", shown.len() - room),
            theme::loud(theme::CURSOR),
        );
    }
    let rows = Layout::vertical(vec![Constraint::Fill(1); room]).split(inner);
    let on_top = strips.mass.unwrap_or_else(|| data.bearing_mass());
    let units = data.units();
    for (strip, row) in shown.iter().zip(rows.iter()) {
        let unit = strip.unit(&units);
        draw_strip(strip, unit, strips.scale(&strip.name), view, (on_top, area, *row), buffer);
    }
    // Seconds before the end of what is shown.
    let seconds = window.len() as f64 * data.seconds;
    let column = |at: f64| {
        let along = 1.0 + at / seconds;
        (0.0..1.0).contains(&along).then(|| inner.x + (along * f64::from(inner.width)) as u16)
    };
    ticks::level(area, [-seconds, 0.0], column, buffer);
}

#[cfg(test)]
mod tests {
    use wire::Step;

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    #[test]
    fn y_z_and_control_each_have_a_strip() {
        let data = tests::frame_data();
        let frame = drawn(60, 11, |area, buffer| Strips::default().draw(&view(&data), area, buffer));
        for sign in ["│y", "│z", "│u", "last 30.0 tau"] {
            assert!(frame.contains(sign), "{sign}:\n{frame}");
        }
        insta::assert_snapshot!("strips", frame);
    }

    #[test]
    fn the_cursor_reads_what_was_and_losses_are_marked() {
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        (0..2000).chain(2100..4000).for_each(|seq| feed.push_step(&tests::state(3, seq), now));
        let mut time = ViewTime::LIVE;
        time.look_at(1000, &feed.history().kept(), feed.step_seconds());
        let data = feed.frame_data(&time, now);
        let seen = View { time: &time, ..view(&data) };
        let frame = drawn(60, 11, |area, buffer| Strips::default().draw(&seen, area, buffer));
        let at = tests::state(3, 1000);
        for value in [at.point(0).y, at.point(2).z, at.force_delivered()[0]] {
            assert!(frame.contains(&short(value, 4)), "{value}:\n{frame}");
        }
        insta::assert_snapshot!("strips_with_cursor", frame);
    }

    #[test]
    fn the_force_of_each_control_bearing_is_told_in_newtons_of_its_own() {
        let data = tests::frame_data_of_two_bearings();
        let strip = Strip::read("force+bearing.force.2").unwrap();
        let traces = strip.traces(data.track.layout());
        let unit = strip.unit(&data.units());
        let told: Vec<String> = traces.iter().map(|trace| unit.told(trace.value(&data, 99).unwrap(), 4)).collect();
        assert_eq!(told, ["54.00 N", "108.0 N"]);
        let ranges: Vec<f64> =
            traces.iter().map(|trace| trace.range(&data, 0..100).unwrap()[1] * unit.factor).collect();
        assert!((ranges[0] - 54.0).abs() < 1e-9 && (ranges[1] - 108.0).abs() < 1e-9, "{ranges:?}");
    }

    #[test]
    fn chosen_strips_have_their_names_their_values_under_the_cursor_and_their_units() {
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        (0..4000).for_each(|seq| feed.push_step(&tests::state(3, seq), now));
        let mut time = ViewTime::LIVE;
        time.look_at(1000, &feed.history().kept(), feed.step_seconds());
        let data = feed.frame_data(&time, now);
        let seen = View { time: &time, ..view(&data) };
        let chosen = Strip::read_all("radius.2 y.1+z.1 force damping speed").unwrap();
        let mut strips = Strips::default();
        strips.command(&PanelCommand::Strips(Some(&chosen)));
        strips.command(&PanelCommand::Strip("speed", &[Scaling::Fix([2.0, 3.0])]));
        let strips = std::cell::RefCell::new(strips);
        let frame = drawn(90, 22, |area, buffer| strips.borrow_mut().draw(&seen, area, buffer));
        let [y, z] = data.track.displacement(1000, 0).map(|part| short(part, 4));
        let damping = short(data.era.as_ref().unwrap().min_damping, 4);
        for words in [
            "radius.2 2.500 ",
            &format!("y.1 {y} z.1 {z} "),
            "force 0.800 ",
            &format!("damping {damping} "),
            "speed 2.500 ",
            "0 to 3 e_t│",
            "±1.5 e_t│",
            "=2 to 3 R│",
        ] {
            assert!(frame.contains(words), "{words}:\n{frame}");
        }
        insta::assert_snapshot!("strips_chosen", frame);
    }

    #[test]
    fn the_mass_that_is_looked_at_lies_on_top() {
        let data = tests::frame_data();
        let top_of = |mass: Option<usize>| {
            let mut strips = Strips::default();
            strips.command(&PanelCommand::Mass(mass));
            let area = Rect::new(0, 0, 40, 14);
            let mut buffer = Buffer::empty(area);
            strips.draw(&view(&data), area, &mut buffer);
            // How many cells of the strip of y are in the colour of each mass.
            let cells = |color| buffer.content[40..5 * 40].iter().filter(|cell| cell.fg == color).count();
            theme::TRACES.map(cells)
        };
        let [bearing, second, third] = [None, Some(1), Some(2)].map(top_of);
        assert!(
            second[1] > bearing[1] && third[2] > bearing[2] && bearing[0] > second[0],
            "{bearing:?} {second:?} {third:?}"
        );
    }

    #[test]
    fn a_peak_of_one_step_is_seen() {
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        for seq in 0..4000 {
            let y = if seq == 2222 { 4.9 } else { 0.0 };
            feed.push_step(&tests::state(1, seq).with(wire::Channel::Y, 0, y), now);
        }
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let frame = drawn(40, 14, |area, buffer| Strips::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("±5"), "{frame}");
    }
}
