//! Strips of y, z and control over the latest steps.
//!
//! ```text
//! ┌ last 41 tau  1 2 3 ─────────────┐
//! │y ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀   ±5 │
//! │z ⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈⠢⠤⠊⠈     ±5 │
//! │u ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀  ⡠⠤⡀   ±1 │
//! └─────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Color;
use ratatui::text::{Line, Span};

use super::{framed, write, write_right};
use crate::feed::Picture;
use crate::plot::{Plot, Window, nice_ceiling, short};
use crate::theme;

/// Steps that the strips show.
const STEPS: usize = 4096;

/// One line of a strip: its colour, and its value at a step.
type Trace<'a> = (Color, Box<dyn Fn(usize) -> f64 + 'a>);

pub(crate) fn draw(picture: &Picture, area: Rect, buffer: &mut Buffer) {
    let track = &picture.track;
    let end = track.len();
    let start = end.saturating_sub(STEPS);
    // A strip of more masses than colours would be a tangle: the first few stand for all.
    let masses = picture.masses().min(theme::TRACES.len());
    let dtau = picture.bulletin.as_ref().map_or(0.0, |bulletin| bulletin.dtau);
    let mut title = vec![Span::raw(format!(" last {} tau  mass ", short((end - start) as f64 * dtau, 3)))];
    title.extend((0..masses).map(|mass| Span::styled(format!("{} ", mass + 1), theme::loud(theme::TRACES[mass]))));
    let inner = framed(Line::from(title), area, buffer);
    if start == end {
        return;
    }
    let of_masses = |axis: usize| -> Vec<Trace<'_>> {
        let trace = |mass| -> Trace<'_> { (theme::TRACES[mass], Box::new(move |step| track.place(step, mass)[axis])) };
        (0..masses).map(trace).collect()
    };
    let force: Vec<Trace<'_>> = vec![
        (theme::BACKWARD, Box::new(|step| track.force(step)[1])),
        (theme::FORCE, Box::new(|step| track.force(step)[0])),
    ];
    let rows = Layout::vertical([Constraint::Fill(1); 3]).split(inner);
    for ((name, traces), row) in [("y", of_masses(0)), ("z", of_masses(1)), ("u", force)].into_iter().zip(rows.iter()) {
        strip(name, &traces, start..end, *row, buffer);
    }
}

fn strip(name: &str, traces: &[Trace<'_>], steps: std::ops::Range<usize>, area: Rect, buffer: &mut Buffer) {
    let columns = usize::from(area.width) * 2;
    if columns == 0 {
        return;
    }
    // Every column of dots shows the range of its steps, so that no peak falls between two columns.
    let per_column = steps.len().div_ceil(columns).max(1);
    let ranges: Vec<(Color, Vec<[f64; 2]>)> = traces
        .iter()
        .map(|(color, value)| {
            let columns = steps.clone().step_by(per_column).map(|from| {
                let values = (from..(from + per_column).min(steps.end)).map(value);
                values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
            });
            (*color, columns.collect())
        })
        .collect();
    let reach =
        ranges.iter().flat_map(|(_, columns)| columns).fold(0.0, |reach: f64, [low, high]| reach.max(-low).max(*high));
    let scale = nice_ceiling(reach);
    let mut plot = Plot::new(area, Window { x: [0.0, columns as f64], y: [-scale, scale] });
    plot.line([0.0, 0.0], [columns as f64, 0.0], theme::GRID);
    for (color, columns) in &ranges {
        for (at, [low, high]) in columns.iter().enumerate() {
            let x = at as f64 + 0.5;
            plot.line([x, *low], [x, *high], *color);
            if let Some([next, _]) = columns.get(at + 1) {
                plot.line([x, *high], [x + 1.0, *next], *color);
            }
        }
    }
    plot.paint(buffer);
    write(buffer, area, area.left(), area.top(), name, theme::quiet());
    write_right(buffer, area, area.top(), &format!("±{}", short(scale, 1)), theme::quiet());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::tests;
    use crate::panels::tests::drawn;

    #[test]
    fn y_z_and_control_each_have_a_strip() {
        let picture = tests::picture();
        let frame = drawn(60, 11, |area, buffer| draw(&picture, area, buffer));
        for sign in ["│y", "│z", "│u", "last 30.0 tau"] {
            assert!(frame.contains(sign), "{sign}:\n{frame}");
        }
        insta::assert_snapshot!("strips", frame);
    }

    #[test]
    fn a_peak_of_one_step_is_seen() {
        let now = std::time::Instant::now();
        let mut feed = crate::feed::Feed::new("");
        for seq in 0..4000 {
            let mut state = tests::state(1, seq);
            state.masses[0].y = if seq == 2222 { 4.9 } else { 0.0 };
            feed.hear(&state, now);
        }
        let picture = feed.picture(now);
        let frame = drawn(40, 14, |area, buffer| draw(&picture, area, buffer));
        assert!(frame.contains("±5"), "{frame}");
    }
}
