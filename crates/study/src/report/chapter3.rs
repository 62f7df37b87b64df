//! The figures of chapter III: one mass, and the law that cancels its seal.

use super::evidence::Evidence;
use super::figure::Entry;
use super::pole_chart::View;
use super::{Data, ReportError, force_chart, orbit_chart, pole_chart, spectrum_chart};
use plot::{Chart, Color, Look, Series};

const IMPULSE: &str = "A reconstruction: the report does not say how strong the impulse was, nor at which phase. \
    From rest, with v_y = -2.5 at τ = 0, the larger force component comes within 0.5 % of all three printed maxima.";

pub(super) const FIGURES: [Entry; 8] = [
    Entry {
        number: "3.4",
        title: "One mass without control: poles, 0 ≤ R ≤ 5",
        caption: "Both modes of the one-mass rotor as it spins up. They start equally damped; the seal then feeds the \
            forward mode, which crosses into growth near R = 2.21 whirling at half the spin, and calms the backward one.",
        agreement: "The threshold and the poles at R = 0 agree to the printed digits. The report's real form cannot tell \
            forward from backward: its plot holds our branches and their mirror images (dotted).",
        make: poles,
    },
    Entry {
        number: "3.5",
        title: "One mass without control: growing orbit, R = 2.3, g = 1",
        caption: "Just above the threshold. The clearance frees the mass near the centre only, so it cannot stop an orbit \
            that has left it: from rest the whirl grows without end.",
        agreement: "Qualitative: the report gives no numbers, nor the state it started from. Ours starts at rest and is \
            shown to τ = 60.",
        make: |e, title| orbit(&e.unstable, title),
    },
    Entry {
        number: "3.6",
        title: "One mass, cancelling control: orbit, R = 5, g = 0",
        caption: "With the cross-coupling cancelled (R0 = 0) the orbit of a linear rotor from rest settles within a few \
            turns on a circle about one unbalance radius wide, far above the uncontrolled threshold.",
        agreement: "Qualitative: the report prints no number on it. The final radius is checked by the exact synchronous orbit.",
        make: |e, title| orbit(&e.steady, title),
    },
    Entry {
        number: "3.7",
        title: "One mass, cancelling control: largest steady force over speed",
        caption: "What the bearing must deliver once transients have died, for three clearances. Lines are simulations, \
            rings the exact circular orbits. Force follows speed almost in proportion, and hardly minds the clearance.",
        agreement: "Qualitative as printed (a plot without numbers). Force in units of m ω₀² e, which for one mass is K_t e_t.",
        make: forces,
    },
    Entry {
        number: "3.8",
        title: "One mass, cancelling control: impulse, R = 5, g = 0",
        caption: "The linear rotor after a blow along y. It swings out and is back on its circle after a few turns.",
        agreement: IMPULSE,
        make: |e, title| orbit(&e.impulses[0], title),
    },
    Entry {
        number: "3.9",
        title: "One mass, cancelling control: impulse, R = 5, g = 1",
        caption: "The same blow with a clearance of one e_t: softer near the centre, so a little farther out, and a little \
            more force.",
        agreement: IMPULSE,
        make: |e, title| orbit(&e.impulses[1], title),
    },
    Entry {
        number: "3.10",
        title: "One mass, cancelling control: impulse, R = 5, g = 10",
        caption: "The same blow inside a wide clearance that the mass does not reach: only the seal holds it.",
        agreement: IMPULSE,
        make: |e, title| orbit(&e.impulses[2], title),
    },
    Entry {
        number: "3.11",
        title: "One mass, cancelling control: spectrum after Fig. 3.10",
        caption: "Two-sided power spectrum of the run of Fig. 3.10 continued until the blow is forgotten: one line at the \
            spin, nothing below it down to eight decades.",
        agreement: "Qualitative: the report's axes are lost. Ours is Welch's estimate under a Hann window, of the settled \
            part alone; within the transient a line at the rotor's own frequency would show.",
        make: |e, title| {
            let record = &e.impulse_spectrum;
            Ok((spectrum_chart::chart(record, title, 1)?, spectrum_chart::data(record)?))
        },
    },
];

fn poles(evidence: &Evidence, title: &str) -> Result<(Chart, Data), ReportError> {
    let view = View {
        title,
        re: [-1.6, 0.6],
        im: [-1.7, 1.7],
        dots: &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        named: &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
    };
    Ok((pole_chart::chart(&evidence.jeffcott_trace, &view), pole_chart::data(&evidence.jeffcott_trace)))
}

fn orbit(record: &super::motion::Record, title: &str) -> Result<(Chart, Data), ReportError> {
    let mut chart = orbit_chart::chart(record, 0, title, None, true);
    // What grows without end has no last turn to speak of.
    if record.speed > 3.0 {
        let turn = std::f64::consts::TAU / record.speed;
        let last = record.orbit(0, record.end() - 1.1 * turn, record.end());
        chart.series.push(Series::new("last turn", Look::Solid, Color::BLACK, last));
    }
    Ok((chart, orbit_chart::data(record, 0)))
}

fn forces(evidence: &Evidence, title: &str) -> Result<(Chart, Data), ReportError> {
    let mut chart = force_chart::chart(&evidence.jeffcott_forces, title, false);
    let exact = evidence.jeffcott_exact.iter().flat_map(|circular| &circular.orbits).flatten();
    let points = exact.filter(|orbit| orbit.is_stable()).map(|orbit| (orbit.speed, orbit.force)).collect();
    chart.series.push(Series::new("exact circular orbits", Look::Rings, Color::BLACK, points));
    Ok((chart, force_chart::data(&evidence.jeffcott_forces)))
}
