//! The statements of chapter IV about its search for gains, put to ours.

use rotor::Stability;

use super::compare::{Comparison, Printed, claim, number};
use super::evidence::Evidence;

/// The speed at which tracked and constant gains are compared: inside the range of both, with control needed for every mode.
const BETWEEN: f64 = 6.0;

pub(super) fn rows(e: &Evidence) -> Vec<Comparison> {
    let row = |quantity, place, printed, ours, note| Comparison { chapter: 4, quantity, place, printed, ours, note };
    let s = &e.searched;
    let steepest = s.tracked.steepest();
    let edges = |becomes| s.at_edge_thresholds.iter().filter(move |t| t.becomes == becomes).map(|t| t.speed);
    // Several modes may be regained one after the other: the rotor is stable from the last of them on.
    let regained = edges(Stability::Stable).fold(0.0, f64::max);
    let lost = edges(Stability::Unstable).filter(|speed| *speed > regained).fold(f64::INFINITY, f64::min);
    let below = if regained > 0.0 { "; unstable below" } else { "" };
    let held = format!("stable from R = {regained:.2} to {lost:.2}{below}");
    let place = |speeds: &[f64]| speeds.iter().position(|s| (s - BETWEEN).abs() < 1e-9).unwrap_or(0);
    let tracked = s.tracked.values[place(&s.tracked.speeds)];
    let constant = e.composite_trace.min_damping()[place(&e.composite_trace.speeds)];
    vec![
        row(
            "stable with gains optimised for each speed up to R",
            "text before Fig. 4.7",
            Printed::Number("7.2"),
            number(s.reach_alone, 3),
            "Where the best least damping found at one speed falls to zero. Why the report's search ended earlier it \
             does not say.",
        ),
        row(
            "gains tracked over speed",
            "Fig. 4.7",
            Printed::Claim("irregular"),
            claim(
                steepest > 2.0,
                format!(
                    "no gain changes by more than {steepest:.2} per unit of R, at a cost in damping of at most {:.4}, \
                     {:.4} from R = 2 on",
                    s.given_up(0.0),
                    s.given_up(2.0)
                ),
            ),
            "A property of the method: each speed by itself, from its neighbour's gains, against all speeds together.",
        ),
        row(
            "poles with them, at lower speeds",
            "Fig. 4.8",
            Printed::Claim("somewhat erratic"),
            claim(s.fastest_pole() > 10.0, format!("no pole moves by more than {:.1} per unit of R", s.fastest_pole())),
            "As above.",
        ),
        row(
            "stable with one constant set of composite gains up to R",
            "text before Fig. 4.16",
            Printed::Number("7.2"),
            number(s.reach_constant, 3),
            "Where the best least damping found over all speeds from 0 falls to zero. The built-in gains, which are the best over \
             0 ≤ R ≤ 7 and so have something to spare there, reach 7.07.",
        ),
        row(
            "the gains of R = 7.2, held constant",
            "text before Fig. 4.12",
            Printed::Claim("stable over the same range"),
            claim(regained == 0.0, held),
            "The best gains found at 7.2 alone, which hold the rotor nowhere else. The report's must have been another local optimum.",
        ),
        row(
            "gains that depend on speed, against constant ones",
            "text after Fig. 4.7",
            Printed::Claim("little advantage"),
            claim(
                tracked < 1.5 * constant && s.reach_alone < s.reach_constant + 0.1,
                format!(
                    "at R = {BETWEEN} least damping {tracked:.4} against {constant:.4}; stable to {:.2} against {:.2}",
                    s.reach_alone, s.reach_constant
                ),
            ),
            "Against the built-in gains.",
        ),
    ]
}
