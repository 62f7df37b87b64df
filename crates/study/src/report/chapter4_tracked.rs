//! Figs. 4.7 to 4.11: gains that follow the speed, and the poles with them.

use rotor::GainKind;

use super::evidence::Evidence;
use super::figure::Entry;
use super::pole_chart::View;
use super::searched::{constant_gains, whole_speeds};
use super::{Data, ReportError, pole_chart};
use plot::{Axis, Chart, Color, Look, Series};

const TRACKED: &str = "Qualitative: the report's gains are lost with its picture. It followed one of several solutions with \
    Powell's method, from speed to speed, and calls what came out irregular. Ours weighs damping against changes of gain at \
    all speeds at once, and is smooth.";

const POLES: &str = "Qualitative, with other gains than the report's (see Fig. 4.7). It finds its poles erratic at lower \
    speeds; ours move evenly.";

/// They come between Figs. 4.5 and 4.12.
pub(super) const FIGURES: [Entry; 5] = [
    Entry {
        number: "4.7",
        title: "Three masses: gains that follow the speed, 0 ≤ R ≤ 8",
        caption: "The composite gains, searched at 41 speeds together: as much damping at each as can be had with gains that \
            change little from one to the next. Rings are the best for one speed alone, thin lines the built-in constant \
            gains. They agree from R = 3 on. At lower speeds the best lies elsewhere, and to get there fast would cost more than it brings.",
        agreement: TRACKED,
        make: gains,
    },
    Entry {
        number: "4.8",
        title: "Three masses, gains that follow the speed: poles, 0 ≤ R ≤ 8",
        caption: "In the frame of Fig. 4.12. Every mode is damped until about R = 7.5, where three forward modes reach the \
            threshold together: the slow one and both fast ones.",
        agreement: POLES,
        make: |e, title| Ok(poles(e, title, [-0.72, 0.14], [-2.7, 2.7], &[0.0, 8.0])),
    },
    Entry {
        number: "4.9",
        title: "Three masses, gains that follow the speed: section A, the slow modes",
        caption: "Slower than with constant gains: their negative direct stiffness takes most of the bearing's away. A pole \
            as near to the origin as this is well damped by its ratio and yet decays slowly.",
        agreement: "Qualitative: section and gains are ours. The section differs from that of Fig. 4.13, for the modes are \
            slower.",
        make: |e, title| Ok(poles(e, title, [-0.72, 0.08], [-0.3, 0.9], &[0.0, 2.0, 4.0, 6.0, 8.0])),
    },
    Entry {
        number: "4.10",
        title: "Three masses, gains that follow the speed: section B, pitch and bending",
        caption: "In the frame of Fig. 4.14. The two fast forward branches start apart and soon run side by side: the best \
            gains make them meet.",
        agreement: "Qualitative: section and gains are ours.",
        make: |e, title| Ok(poles(e, title, [-0.68, 0.14], [1.65, 2.4], &[0.0, 4.0, 8.0])),
    },
    Entry {
        number: "4.11",
        title: "Three masses, gains that follow the speed: section C, the crossing",
        caption: "In the frame of Fig. 4.15: the best gains make both fast modes coincide at each of the 41 speeds. Between \
            these, where gains are interpolated, they part a little and meet again.",
        agreement: "Qualitative: section and gains are ours.",
        make: |e, title| Ok(poles(e, title, [-0.06, 0.06], [2.16, 2.34], &[5.0, 7.0, 8.0])),
    },
];

fn poles(e: &Evidence, title: &str, re: [f64; 2], im: [f64; 2], named: &'static [f64]) -> (Chart, Data) {
    let dots = &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
    let trace = &e.searched.trace;
    (pole_chart::chart(trace, &View { title, re, im, dots, named }), pole_chart::data(trace))
}

fn gains(e: &Evidence, title: &str) -> Result<(Chart, Data), ReportError> {
    const LOOKS: [(Look, Color); 4] = [
        (Look::Solid, Color::BLUE),
        (Look::Dashed, Color::VERMILLION),
        (Look::Dotted, Color::GREEN),
        (Look::Solid, Color::PURPLE),
    ];
    let tracked = &e.searched.tracked;
    let constant = constant_gains(&e.three_mass);
    let mut series = Vec::new();
    for (i, (kind, (look, color))) in GainKind::ALL.into_iter().zip(LOOKS).enumerate() {
        let line = tracked.speeds.iter().zip(&tracked.gains).map(|(speed, gains)| (*speed, gains[i])).collect();
        series.push(Series::new(kind.name(), look, color, line));
        let rings = whole_speeds().zip(&e.searched.alone).map(|(speed, best)| (speed, best.gains[i])).collect();
        series.push(Series::new("", Look::Rings, color, rings));
        series.push(Series::new("", Look::Thin, color, vec![(0.0, constant[i]), (8.0, constant[i])]));
    }
    let mut data = Data::new(&["speed"]);
    data.header.extend(GainKind::ALL.map(|kind| kind.name().to_owned()));
    data.header.push("min_damping".into());
    for ((speed, gains), value) in tracked.speeds.iter().zip(&tracked.gains).zip(&tracked.values) {
        data.rows.push([&[*speed], &gains[..], &[*value]].concat());
    }
    let chart = Chart {
        title: title.to_owned(),
        x: Axis::new("Spin speed R (ω/ω₀)", 0.0, 8.0),
        y: Axis::new("Gain (dimensionless)", -2.2, 1.6),
        equal: false,
        series,
        notes: Vec::new(),
    };
    Ok((chart, data))
}
