//! Pole traces (Figs. 3.4, 4.2, 4.12 to 4.15): poles over speed in the complex plane.

use rotor::{C64, Trace};

use super::data::Data;
use plot::{Axis, Chart, Color, Look, Note, Series, Side};

/// What part of the plane is shown, and how.
pub(super) struct View<'a> {
    pub title: &'a str,
    pub re: [f64; 2],
    pub im: [f64; 2],
    /// Speeds with a dot on every branch.
    pub dots: &'static [f64],
    /// Speeds that are named, too.
    pub named: &'static [f64],
}

/// The chart of a trace.
pub(super) fn chart(trace: &Trace, view: &View<'_>) -> Chart {
    let mut series = Vec::new();
    let mut notes = Vec::new();
    let names = ["forward whirl", "backward whirl"];
    let mut listed = [false; 2];
    for branch in &trace.branches {
        let mirrored = branch.poles.iter().map(|p| point(p.conj())).collect();
        series.push(Series::new("", Look::Dotted, Color::GREY, mirrored));
    }
    if let Some(first) = series.first_mut() {
        first.name = "mirror images (real form)".into();
    }
    for branch in &trace.branches {
        for (from, to) in pieces(&branch.poles) {
            // Both drawn pieces end where the sense of whirl changes.
            let shown = &branch.poles[from..=to.min(branch.poles.len() - 1)];
            let backward = branch.poles[from].im < 0.0;
            let (look, color) = if backward { (Look::Dashed, Color::VERMILLION) } else { (Look::Solid, Color::BLUE) };
            let kind = usize::from(backward);
            // What is out of the picture is not explained below it.
            let seen = shown.iter().any(|p| within(p.re, view.re) && within(p.im, view.im));
            let name = if listed[kind] || !seen { "" } else { names[kind] };
            listed[kind] |= seen;
            let mut line = Series::new(name, look, color, shown.iter().map(|p| point(*p)).collect());
            let arrows = between(trace, view.dots).into_iter().filter(|i| (from..to).contains(i));
            line.arrows = arrows.map(|i| i - from).filter(|i| *i > 0).collect();
            series.push(line);
            let at = |speeds: &[f64]| -> Vec<(f64, (f64, f64))> {
                let places = speeds.iter().filter_map(|s| Some((*s, nearest(trace, *s)?)));
                let places = places.filter(|(_, i)| (from..to).contains(i));
                places.map(|(s, i)| (s, point(branch.poles[i]))).collect()
            };
            series.push(Series::new("", Look::Dots, color, at(view.dots).into_iter().map(|(_, p)| p).collect()));
            let side = if backward { Side::Below } else { Side::Above };
            notes.extend(at(view.named).into_iter().map(|(s, at)| Note { at, text: format!("R = {s}"), side }));
        }
    }
    let axis = vec![(0.0, view.im[0]), (0.0, view.im[1])];
    series.insert(0, Series::new("threshold of stability", Look::Solid, Color::BLACK, axis));
    Chart {
        title: view.title.to_owned(),
        x: Axis::new("Re λ, growth (per unit of τ = ω₀t)", view.re[0], view.re[1]),
        y: Axis::new("Im λ, whirl (rad per unit of τ)", view.im[0], view.im[1]),
        equal: false,
        series,
        notes,
    }
}

/// Every branch over speed.
pub(super) fn data(trace: &Trace) -> Data {
    let mut data = Data::new(&["speed"]);
    for k in 1..=trace.branches.len() {
        data.header.extend([format!("re{k}"), format!("im{k}")]);
    }
    for (i, speed) in trace.speeds.iter().enumerate() {
        let poles = trace.branches.iter().flat_map(|b| [b.poles[i].re, b.poles[i].im]);
        data.rows.push(std::iter::once(*speed).chain(poles).collect());
    }
    data
}

/// Stretches of one sense of whirl, each up to the index where the next begins.
fn pieces(poles: &[C64]) -> Vec<(usize, usize)> {
    let changes = (1..poles.len()).filter(|&i| (poles[i].im < 0.0) != (poles[i - 1].im < 0.0));
    let ends: Vec<usize> = changes.chain([poles.len()]).collect();
    let starts = std::iter::once(0).chain(ends.iter().copied());
    starts.zip(ends.iter().copied()).filter(|(from, to)| from < to).collect()
}

fn within(value: f64, [from, to]: [f64; 2]) -> bool {
    (from..=to).contains(&value)
}

fn point(pole: C64) -> (f64, f64) {
    (pole.re, pole.im)
}

/// The place of a speed, if the trace has it.
fn nearest(trace: &Trace, speed: f64) -> Option<usize> {
    let step = trace.speeds.get(1)? - trace.speeds.first()?;
    trace.speeds.iter().position(|s| (s - speed).abs() <= 0.5 * step)
}

/// Places half way between two dots.
fn between(trace: &Trace, dots: &[f64]) -> Vec<usize> {
    dots.windows(2).filter_map(|w| nearest(trace, 0.5 * (w[0] + w[1]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_branch_that_becomes_forward_is_drawn_as_forward_from_there_on() {
        let poles = [-0.2, -0.1, 0.1, 0.2, -0.1].map(|im| C64::new(0.0, im));
        assert_eq!(pieces(&poles), [(0, 2), (2, 4), (4, 5)]);
        assert_eq!(pieces(&poles[..2]), [(0, 2)]);
    }
}
