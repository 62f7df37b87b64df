//! What a picture costs: laid out and written as SVG, and drawn from that as PNG.

use divan::{Bencher, black_box};
use plot::{Axis, Chart, Color, Look, Note, Series, Side, png, svg};

fn main() {
    divan::main();
}

/// A chart as crowded as they come: four lines of 2000 points, forty marks, words.
fn chart() -> Chart {
    let line = |k: u32| {
        let points = (0..2000).map(|i| f64::from(i) * 0.005).map(|x| (x, (x * f64::from(k)).sin())).collect();
        Series::new(
            &format!("line {k}"),
            if k.is_multiple_of(2) { Look::Solid } else { Look::Dashed },
            Color::BLUE,
            points,
        )
    };
    let marks = (0..40).map(|i| (0.25 * f64::from(i), 0.5)).collect();
    let mut series: Vec<Series> = (1..=4).map(line).collect();
    series.push(Series::new("marks", Look::Rings, Color::VERMILLION, marks));
    Chart {
        title: "A crowded chart".into(),
        x: Axis::new("speed R (-)", 0.0, 10.0),
        y: Axis::new("force (Kₜ eₜ)", -1.2, 1.2),
        equal: false,
        series,
        notes: vec![Note { at: (5.0, 0.0), text: "here".into(), side: Side::Right }],
    }
}

#[divan::bench]
fn as_svg(bencher: Bencher<'_, '_>) {
    let chart = chart();
    bencher.bench_local(|| svg(&black_box(&chart).scene(), "chart", &chart.title));
}

#[divan::bench]
fn as_png(bencher: Bencher<'_, '_>) {
    let chart = chart();
    let picture = svg(&chart.scene(), "chart", &chart.title);
    bencher.bench_local(|| png(black_box(&picture)));
}
