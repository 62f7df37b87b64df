//! Every number that the report prints as a result, and every statement about its plots that can be put to the test.

use rotor::{C64, Rotor, Stability, Trace, Whirl};

use super::compare::{Comparison, Ours, Printed, claim, number, under};
use super::criteria::{NEARLY_LINEAR, NOT_DETECTABLE, SLIGHT};
use super::evidence::{Evidence, Forces};
use super::{ReportError, numbers4};

/// All of them, in the report's order.
///
/// # Errors
/// Eigenvalues that do not converge.
pub(super) fn all(evidence: &Evidence) -> Result<Vec<Comparison>, ReportError> {
    let mut rows = chapter3(evidence)?;
    rows.extend(numbers4::chapter4(evidence)?);
    Ok(rows)
}

/// The largest distance of any pole of a trace from the pole that its branch starts with.
fn wander(trace: &Trace) -> f64 {
    let branches = trace.branches.iter();
    branches.flat_map(|b| b.poles.iter().map(|p| (p - b.poles[0]).norm())).fold(0.0, f64::max)
}

/// How far the forces are from a straight line through their ends, as a part of the largest.
fn bend(speeds: &[f64], forces: &[f64]) -> f64 {
    let ([first, .., last], [low, .., high]) = (speeds, forces) else { return 0.0 };
    let line = |s: f64| low + (high - low) * (s - first) / (last - first);
    speeds.iter().zip(forces).map(|(s, f)| (f - line(*s)).abs()).fold(0.0, f64::max) / high
}

/// Whether every motion behind a force curve is settled and would outlive a small disturbance.
pub(super) fn stays(forces: &Forces) -> Ours {
    let all = || forces.by_deadband.iter().flatten();
    let count = |stability| all().filter(|p| p.stability.is_some_and(|j| j.stability == stability)).count();
    let [stable, marginal, unstable] = [Stability::Stable, Stability::Marginal, Stability::Unstable].map(count);
    let open = all().filter(|p| p.stability.is_none()).count();
    claim(
        stable == all().count(),
        format!(
            "of {} motions {stable} are stable, {marginal} marginal, {unstable} unstable; {open} had not settled",
            all().count()
        ),
    )
}

fn poles_of(rotor: &Rotor, evidence: &Evidence, speed: f64) -> Result<(Vec<C64>, f64), ReportError> {
    let spectrum = Evidence::modes(rotor, &evidence.jeffcott_off, speed)?;
    let of = |whirl| spectrum.modes.iter().filter(move |m| m.whirl() == whirl).map(|m| m.pole);
    Ok((of(Whirl::Forward).chain(of(Whirl::Backward)).collect(), spectrum.min_damping()))
}

fn chapter3(e: &Evidence) -> Result<Vec<Comparison>, ReportError> {
    let row = |quantity, place, printed, ours, note| Comparison { chapter: 3, quantity, place, printed, ours, note };
    let (at_rest, damping) = poles_of(&e.jeffcott, e, 0.0)?;
    let (_, at_critical) = poles_of(&e.jeffcott, e, 0.78)?;
    let threshold = e.jeffcott_thresholds.first().map_or((f64::NAN, f64::NAN), |t| (t.speed, t.frequency));
    let critical = e.jeffcott_criticals.iter().find(|c| c.whirl == Whirl::Backward).map_or(f64::NAN, |c| c.speed);
    let law = "below (3.44)";
    let wander = wander(&e.cancel_trace);
    let both = at_rest.iter().map(|p| rotor::damping_ratio(*p)).collect::<Vec<_>>();
    let at_end = e.unstable.outcome.last.displacement[0].norm();
    let [before, last] = [(40.0, 50.0), (50.0, 60.0)].map(|(from, to)| e.unstable.widest(0, from, to));

    let by_clearance: Vec<Vec<f64>> =
        e.jeffcott_forces.by_deadband.iter().map(|row| row.iter().map(|p| p.max_force).collect()).collect();
    let from_1 = e.jeffcott_forces.speeds.iter().position(|s| *s >= 1.0 - 1e-9).unwrap_or(0);
    let bends =
        by_clearance.iter().map(|f| bend(&e.jeffcott_forces.speeds[from_1..], &f[from_1..])).fold(0.0, f64::max);
    let exact = |g: usize| {
        let at_5 = e.jeffcott_exact[g].orbits.last().and_then(|orbits| orbits.iter().find(|o| o.is_stable()));
        at_5.map_or(f64::NAN, |orbit| orbit.force)
    };
    let [f0, f1, f10] = [0, 1, 2].map(exact);
    let apart = (0..3).map(|g| (exact(g) - e.jeffcott_forces.at(g, 5.0)).abs()).fold(0.0, f64::max);
    let below = e.impulse_spectrum.subsynchronous_part().unwrap_or(f64::NAN);
    let impulse =
        |i: usize| Ours::Reconstructed { value: e.impulses[i].outcome.max_force_component, decimals: 4, within: 0.005 };
    let reconstruction = "A reconstruction, see below; size and phase of the impulse are not printed.";

    Ok(vec![
        row(
            "threshold speed without control",
            "text before Fig. 3.4",
            Printed::Number("2.2"),
            number(threshold.0, 6),
            "",
        ),
        row("whirl frequency there", "text before Fig. 3.4", Printed::Number("1.1"), number(threshold.1, 6), ""),
        row(
            "whirl frequency over spin speed there",
            "text before Fig. 3.4",
            Printed::Claim("approximately one-half"),
            claim((threshold.1 / threshold.0 - 0.5).abs() < 0.01, format!("{:.4}", threshold.1 / threshold.0)),
            "Exactly one half: at the threshold λ = jω, and the imaginary part of its equation leaves 2 ζ ω = ζ R.",
        ),
        row(
            "with deadband g = 1 at R = 2.3",
            "Fig. 3.5",
            Printed::Claim("unstable"),
            claim(
                last > 1.1 * before,
                format!(
                    "from rest, radius {at_end:.2} at τ = 60; at most {last:.2} in the last ten τ, {before:.2} in the ten before"
                ),
            ),
            "",
        ),
        row("least damping at R = 0", "below (3.42)", Printed::Number("0.497"), number(damping, 6), ""),
        row(
            "both modes equally damped at R = 0",
            "below (3.42)",
            Printed::Claim("yes"),
            claim((both[0] - both[1]).abs() < 1e-12, format!("{:.6} and {:.6}", both[0], both[1])),
            "",
        ),
        row(
            "first critical speed without control",
            "below (3.42)",
            Printed::Number("0.78"),
            number(critical, 6),
            "Most likely where a whirl frequency meets the spin speed first: that of the backward mode. The report's real form does not \
             tell the two apart; unbalance drives forward modes only, and the forward one meets it at R = 1.",
        ),
        row("least damping at R = 0.78", "below (3.42)", Printed::Number("0.323"), number(at_critical, 6), ""),
        row(
            "gain in critical speed damping, %",
            "below (3.42)",
            Printed::Number("54"),
            number(100.0 * (damping / at_critical - 1.0), 3),
            "",
        ),
        row("eigenvalue 1, real part", law, Printed::Number("-0.55723"), number(at_rest[0].re, 6), ""),
        row("eigenvalue 1, imaginary part", law, Printed::Number("0.97366"), number(at_rest[0].im, 6), ""),
        row(
            "eigenvalue 2, real part",
            law,
            Printed::Number("-0.44272"),
            number(at_rest[1].re, 6),
            "A misprint: the two real parts must add up to -2 ζ = -1, and the printed ones do not.",
        ),
        row("eigenvalue 2, imaginary part", law, Printed::Number("0.77366"), number(at_rest[1].im.abs(), 6), ""),
        row(
            "cancelling law: eigenvalues over 0 ≤ R ≤ 5",
            law,
            Printed::Claim("those of R = 0 at any speed"),
            claim(wander < 1e-12, format!("they move by {}", under(wander, 1e-12))),
            "",
        ),
        row(
            "cancelling law: steady force over speed",
            "Fig. 3.7",
            Printed::Claim("nearly linear"),
            claim(
                bends < NEARLY_LINEAR,
                format!("1 ≤ R ≤ 5: off a straight line by at most {:.1} % of the largest", 100.0 * bends),
            ),
            "",
        ),
        row(
            "cancelling law: force at R = 5 for g = 0, 1, 10",
            "Fig. 3.7",
            Printed::Claim("variation slight, if not negligible"),
            claim(
                (f0 / f10 - 1.0).abs() < SLIGHT,
                format!("{f0:.6}, {f1:.6}, {f10:.6}: {:.1} % apart", 100.0 * (f0 / f10 - 1.0)),
            ),
            "Exact circular orbits.",
        ),
        row(
            "the same by simulation",
            "Fig. 3.7",
            Printed::Claim("(our own check)"),
            claim(apart < 1e-6, format!("simulated and exact forces at R = 5 are apart by {}", under(apart, 1e-6))),
            "",
        ),
        row(
            "steady forces of Fig. 3.7: would the motion stay",
            "Fig. 3.7",
            Printed::Claim("(our own check)"),
            stays(&e.jeffcott_forces),
            "Linear stability about every motion found: what starts from rest need not be stable.",
        ),
        row("largest force after an impulse, g = 0", "Fig. 3.8", Printed::Number("9.3777"), impulse(0), reconstruction),
        row("largest force after an impulse, g = 1", "Fig. 3.9", Printed::Number("9.7128"), impulse(1), reconstruction),
        row(
            "largest force after an impulse, g = 10",
            "Fig. 3.10",
            Printed::Number("11.3646"),
            impulse(2),
            reconstruction,
        ),
        row(
            "spectrum after an impulse, g = 10",
            "Fig. 3.11",
            Printed::Claim("synchronous; subsynchronous not detectable"),
            claim(below < NOT_DETECTABLE, format!("{} of the power is subsynchronous", under(below, NOT_DETECTABLE))),
            "Once the impulse is forgotten.",
        ),
    ])
}
