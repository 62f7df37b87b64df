//! The figures of chapter IV: three masses on a flexible shaft, one bearing, one composite signal.

use super::evidence::Evidence;
use super::figure::Entry;
use super::motion::Record;
use super::pole_chart::View;
use super::{Data, ReportError, force_chart, orbit_chart, pole_chart, shape_chart, spectrum_chart};
use plot::Chart;

/// What keeps every figure of the controlled rotor from being the report's own.
const GAINS: &str = "Qualitative: the report's gains and weights are lost with its page. Ours are the built-in `composite` \
    gains on the weights 1, 1, 0, which do the same job (stable to about R = 7.1).";

const SECTION: &str = "Qualitative: which parts the report enlarged is lost with its pictures, so the sections are ours, \
    as are the gains (see Fig. 4.12).";

const FORCE: &str = "Qualitative, and not in all of it. The force is larger at R = 6 than at R = 3 and grows with clearance there; at R \
    = 6 the widest takes fourteen times as much as none, as the report says, but six times as much as g = 1. With our gains g = 0 peaks just above R = 1, not just below, \
    and again near R = 2.3; and g = 1 has a self-excited whirl below R = 2 that is much larger than that peak, which the \
    report does not mention. Force in units of m_1 ω₀² e_t: times Rm_1 = 0.25 in K_t e_t; the report does not say which it \
    took.";

const FREE_END: &str = "Qualitative, with other gains than the report's (see Fig. 4.12). The report finds the controlled end \
    much quieter than the others; with our gains it is quieter than the centre mass only.";

/// How many of [`FIGURES`] are of the rotor without control.
pub(super) const UNCONTROLLED: usize = 4;

/// Chapter IV, but for gains that follow the speed: see `chapter4_tracked`.
pub(super) const FIGURES: [Entry; 19] = [
    Entry {
        number: "4.2",
        title: "Three masses without control: poles, 0 ≤ R ≤ 5",
        caption: "All modes as the rotor spins up. Three forward modes cross into growth one after the other: bounce, \
            pitch, and bending; their backward twins only gain damping.",
        agreement: "The three thresholds agree to the printed digits. Branches are told apart by sense of whirl, which \
            the report's plot cannot.",
        make: uncontrolled,
    },
    Entry {
        number: "4.3",
        title: "Three masses: orbit of the mode unstable from R = 1.775 (bounce)",
        caption: "All three masses whirl in step, the middle one widest: the shaft moves almost as a rigid body.",
        agreement: "The order and kind of the modes agree. The report prints no amplitudes; ours are scaled to a largest \
            of 1.",
        make: |e, title| shape(e, title, 0),
    },
    Entry {
        number: "4.4",
        title: "Three masses: orbit of the mode unstable from R = 4.101 (pitch)",
        caption: "The ends whirl half a turn apart and the middle mass stays where it is, which is why a bearing there \
            cannot reach this mode.",
        agreement: "The order and kind of the modes agree. The report prints no amplitudes; ours are scaled to a largest \
            of 1.",
        make: |e, title| shape(e, title, 1),
    },
    Entry {
        number: "4.5",
        title: "Three masses: orbit of the mode unstable from R = 4.65 (bending)",
        caption: "The ends whirl together and the middle against them: the shaft bends.",
        agreement: "The order and kind of the modes agree. The report prints no amplitudes; ours are scaled to a largest \
            of 1.",
        make: |e, title| shape(e, title, 2),
    },
    Entry {
        number: "4.12",
        title: "Three masses, constant gains: poles, 0 ≤ R ≤ 8",
        caption: "The composite gains held at one value over all speeds. Every mode is damped until about R = 7.1, \
            where two forward modes cross, at 7.07 and 7.09; the third follows at 7.66.",
        agreement: GAINS,
        make: controlled,
    },
    Entry {
        number: "4.13",
        title: "Three masses, constant gains: section A, the bounce mode",
        caption: "The slow forward branch creeps towards the axis and crosses it at R = 7.09; at rest its \
            backward twin (mirrored, dotted) has hardly any damping to spare.",
        agreement: SECTION,
        make: |e, title| section(e, title, [-0.55, 0.08], [0.5, 1.02], &[0.0, 2.0, 4.0, 6.0, 8.0]),
    },
    Entry {
        number: "4.14",
        title: "Three masses, constant gains: section B, pitch and bending",
        caption: "The two fast forward branches come from different damping at rest and end beside each other near the \
            axis.",
        agreement: SECTION,
        make: |e, title| section(e, title, [-0.68, 0.14], [1.65, 2.4], &[0.0, 4.0, 8.0]),
    },
    Entry {
        number: "4.15",
        title: "Three masses, constant gains: section C, the crossing",
        caption: "Section B at the threshold: first one of the two fast modes crosses near R = 7.07, the other near R \
            = 7.66.",
        agreement: SECTION,
        make: |e, title| section(e, title, [-0.06, 0.06], [2.16, 2.34], &[5.0, 7.0, 8.0]),
    },
    Entry {
        number: "4.16",
        title: "Three masses, constant gains: largest steady force over speed",
        caption: "What the bearing must deliver in the steady state or the limit cycle reached from rest, for three \
            clearances at both ends; decades, because the widest clearance takes so much more. Points that had not settled by τ = \
            2000 are left out.",
        agreement: FORCE,
        make: forces,
    },
    Entry {
        number: "4.17",
        title: "Three masses, constant gains: mass 1, R = 2, g = 1",
        caption: "The end mass with the control bearing, at a moderate speed: once settled, a circle at the spin \
            speed.",
        agreement: GAINS,
        make: |e, title| orbit(&e.slow, title, 0),
    },
    Entry {
        number: "4.18",
        title: "Three masses, constant gains: mass 2, R = 2, g = 1",
        caption: "The centre mass, which carries the unbalance and no bearing.",
        agreement: GAINS,
        make: |e, title| orbit(&e.slow, title, 1),
    },
    Entry {
        number: "4.19",
        title: "Three masses, constant gains: mass 3, R = 2, g = 1",
        caption: "The free end mass: the same synchronous circle, nearly four times as wide as at the controlled end.",
        agreement: GAINS,
        make: |e, title| orbit(&e.slow, title, 2),
    },
    Entry {
        number: "4.20",
        title: "Three masses, constant gains: mass 1, R = 6, g = 1",
        caption: "The controlled end at more than three times the uncontrolled threshold: a self-excited whirl far slower than \
            the spin carries the unbalance's ripple.",
        agreement: GAINS,
        make: |e, title| orbit(&e.fast, title, 0),
    },
    Entry {
        number: "4.21",
        title: "Three masses, constant gains: mass 2, R = 6, g = 1",
        caption: "The centre mass: the ripple at the spin speed on top of the slow whirl.",
        agreement: GAINS,
        make: |e, title| orbit(&e.fast, title, 1),
    },
    Entry {
        number: "4.22",
        title: "Three masses, constant gains: mass 3, R = 6, g = 1",
        caption: "The free end: the slow whirl alone, nearly.",
        agreement: FREE_END,
        make: |e, title| orbit(&e.fast, title, 2),
    },
    Entry {
        number: "4.23",
        title: "Three masses, constant gains: spectrum of mass 1, R = 6, g = 1",
        caption: "Full spectrum of Fig. 4.20: the motion is almost all subsynchronous, forward, at about an eighth of \
            the spin; the line at the spin is some orders of magnitude below.",
        agreement: GAINS,
        make: |e, title| Ok((spectrum_chart::chart(&e.fast, title, 2)?, spectrum_chart::data(&e.fast)?)),
    },
    Entry {
        number: "4.24",
        title: "Three masses, constant gains: mass 1, R = 6, g = 10",
        caption: "A clearance ten times as wide, and a slow whirl nearly ten times as wide: the orbit presses far beyond the \
            clearance (dashed).",
        agreement: GAINS,
        make: |e, title| orbit(&e.loose, title, 0),
    },
    Entry {
        number: "4.25",
        title: "Three masses, constant gains: mass 2, R = 6, g = 10",
        caption: "The centre mass follows in the same slow whirl; what the unbalance does hardly shows.",
        agreement: GAINS,
        make: |e, title| orbit(&e.loose, title, 1),
    },
    Entry {
        number: "4.26",
        title: "Three masses, constant gains: mass 3, R = 6, g = 10",
        caption: "The free end, in the same slow whirl.",
        agreement: GAINS,
        make: |e, title| orbit(&e.loose, title, 2),
    },
];

const WHOLE: &[f64] = &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];

fn uncontrolled(evidence: &Evidence, title: &str) -> Result<(Chart, Data), ReportError> {
    let view = View { title, re: [-0.85, 0.4], im: [-2.7, 2.7], dots: &WHOLE[..6], named: &[0.0, 5.0] };
    Ok((pole_chart::chart(&evidence.three_mass_trace, &view), pole_chart::data(&evidence.three_mass_trace)))
}

fn controlled(evidence: &Evidence, title: &str) -> Result<(Chart, Data), ReportError> {
    let view = View { title, re: [-0.72, 0.14], im: [-2.7, 2.7], dots: WHOLE, named: &[0.0, 8.0] };
    Ok((pole_chart::chart(&evidence.composite_trace, &view), pole_chart::data(&evidence.composite_trace)))
}

fn section(
    evidence: &Evidence,
    title: &str,
    re: [f64; 2],
    im: [f64; 2],
    named: &'static [f64],
) -> Result<(Chart, Data), ReportError> {
    let view = View { title, re, im, dots: WHOLE, named };
    Ok((pole_chart::chart(&evidence.composite_trace, &view), pole_chart::data(&evidence.composite_trace)))
}

fn shape(evidence: &Evidence, title: &str, which: usize) -> Result<(Chart, Data), ReportError> {
    // At the speed that the report prints for it, the mode nearest to the threshold.
    let speed = [1.775, 4.101, 4.65][which];
    let modes = Evidence::modes(&evidence.three_mass, &evidence.three_mass_off, speed)?.modes;
    let crossing = modes.iter().min_by(|a, b| a.pole.re.abs().total_cmp(&b.pole.re.abs()));
    let mode = crossing.expect("a rotor has modes");
    Ok((shape_chart::chart(mode, title), shape_chart::data(mode)))
}

fn forces(evidence: &Evidence, title: &str) -> Result<(Chart, Data), ReportError> {
    let forces = &evidence.composite_forces;
    Ok((force_chart::chart(forces, title, true), force_chart::data(forces)))
}

/// The way from rest, and the last stretch of the run.
fn orbit(record: &Record, title: &str, mass: usize) -> Result<(Chart, Data), ReportError> {
    // Turns of the spin where the motion is synchronous, of the slow whirl where it is not.
    let stretch = if record.speed < 3.0 { 4.0 } else { 100.0 };
    let bearing = mass != 1;
    let chart = orbit_chart::chart(record, mass, title, Some(record.end() - stretch), bearing);
    Ok((chart, orbit_chart::data(record, mass)))
}
