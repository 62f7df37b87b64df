//! The numbers and statements of chapter IV.

use rotor::{C64, Whirl};

use super::compare::{Comparison, Printed, claim, number, sure, under};
use super::criteria::{ABOUT, MAINLY, ORDER_OF_MAGNITUDE, nearly_the_same};
use super::evidence::Evidence;
use super::numbers::stays;
use super::{ReportError, motion::Record, numbers_search};

const BUILT_IN_REACH: &str = "With the built-in gains, whose first threshold is 7.07.";
const BUILT_IN: &str = "With the built-in gains; the report's are lost.";

/// The shape of the mode nearest to its threshold, as real amplitudes: `scale` is the mass that is set to 1.
fn shape_at(e: &Evidence, speed: f64, scale: usize) -> Result<Vec<f64>, ReportError> {
    let modes = Evidence::modes(&e.three_mass, &e.three_mass_off, speed)?.modes;
    let crossing = modes.iter().min_by(|a, b| a.pole.re.abs().total_cmp(&b.pole.re.abs()));
    let shape: Vec<C64> = crossing.map(|mode| mode.shape.clone()).unwrap_or_default();
    // Rounding must not show as a minus before zero.
    Ok(shape.iter().map(|p| (p / shape[scale]).re).map(|x| if x.abs() < 5e-4 { 0.0 } else { x }).collect())
}

/// The largest radii of a record, with the digits that are sure.
fn amplitudes(record: &Record) -> String {
    let widest = radii(record).iter().copied().fold(0.0, f64::max);
    radii(record).iter().map(|r| sure(*r, record.off() * widest)).collect::<Vec<_>>().join(", ")
}

/// Numbers, separated by commas.
fn list(values: &[f64], decimals: usize) -> String {
    values.iter().map(|v| format!("{v:.decimals$}")).collect::<Vec<_>>().join(", ")
}

/// The highest of a force curve's maxima below `to`, and its place.
fn summit(speeds: &[f64], forces: &[f64], to: f64) -> (f64, f64) {
    let within = speeds.iter().zip(forces).filter(|(s, _)| **s <= to);
    within.fold((0.0, 0.0), |best, (s, f)| if *f > best.1 { (*s, *f) } else { best })
}

/// The parts of the orbit's largest radius at each mass.
fn radii(record: &Record) -> &[f64] {
    &record.outcome.max_displacement
}

pub(super) fn chapter4(e: &Evidence) -> Result<Vec<Comparison>, ReportError> {
    let row = |quantity, place, printed, ours, note| Comparison { chapter: 4, quantity, place, printed, ours, note };
    let threshold = |i: usize| e.three_mass_thresholds.get(i).map_or(f64::NAN, |t| t.speed);
    let frequency = |i: usize| e.three_mass_thresholds.get(i).map_or(f64::NAN, |t| t.frequency);
    let bounce = shape_at(e, threshold(0), 1)?;
    let pitch = shape_at(e, threshold(1), 2)?;
    let bending = shape_at(e, threshold(2), 0)?;
    let reach = e.composite_thresholds.first().map_or(f64::NAN, |t| t.speed);

    let forces = &e.composite_forces;
    // What has not settled is no steady force.
    let curve = |g: usize| forces.settled(g).collect::<Vec<_>>();
    let (peak_0, _) = summit(&forces.speeds, &curve(0), 2.0);
    let (peak_1, height_1) = summit(&forces.speeds, &curve(1), 2.0);
    let three = |speed: f64| (0..3).map(|g| forces.shown(g, speed)).collect::<Vec<_>>().join(", ");
    let rising = |g: usize| forces.at(g, 6.0) > forces.at(g, 3.0);
    let grows = forces.at(0, 6.0) < forces.at(1, 6.0) && forces.at(1, 6.0) < forces.at(2, 6.0);
    let against_3_7 = forces.at(2, 5.0) / e.jeffcott_forces.at(2, 5.0);
    let [over_0, over_1] = [0, 1].map(|g| forces.at(2, 6.0) / forces.at(g, 6.0));
    let [level_0, level_1] = [0, 1].map(|g| forces.at(g, 5.0) / e.jeffcott_forces.at(g, 5.0));
    let criticals = e.three_mass_criticals.iter().filter(|c| c.whirl == Whirl::Forward);
    let critical = criticals.map(|c| c.speed).fold(f64::INFINITY, f64::min);

    let uneven =
        |record: &Record| radii(record).iter().zip(&record.outcome.mean_radius).map(|(l, m)| l - m).fold(0.0, f64::max);
    let synchronous = |record: &Record| uneven(record) < 1e-6;
    let part = e.fast.subsynchronous_part().unwrap_or(f64::NAN);
    let line = e.fast.spectrum.as_ref().and_then(|(_, peaks)| peaks.first()).map_or(f64::NAN, |p| p.frequency);
    let quiet = |record: &Record| radii(record)[0] < radii(record)[1].min(radii(record)[2]);
    let wide = radii(&e.loose)[0] / radii(&e.fast)[0];

    let mut rows = vec![
        row(
            "first threshold without control",
            "text before Fig. 4.2",
            Printed::Number("1.78"),
            number(threshold(0), 6),
            "",
        ),
        row(
            "first threshold, in the caption",
            "Fig. 4.3",
            Printed::Number("1.775"),
            number(threshold(0), 6),
            "The caption cuts where the text rounds.",
        ),
        row("second threshold", "text before Fig. 4.2", Printed::Number("4.1"), number(threshold(1), 6), ""),
        row("second threshold, in the caption", "Fig. 4.4", Printed::Number("4.101"), number(threshold(1), 6), ""),
        row("third threshold", "text and Fig. 4.5", Printed::Number("4.65"), number(threshold(2), 6), ""),
        row(
            "whirl frequencies there",
            "Fig. 4.2",
            Printed::Claim("(a plot)"),
            claim(
                (0..3).all(|i| (frequency(i) / threshold(i) - 0.5).abs() < 1e-6),
                format!(
                    "{:.6}, {:.6}, {:.6}, against half the spin {:.6}, {:.6}, {:.6}",
                    frequency(0),
                    frequency(1),
                    frequency(2),
                    0.5 * threshold(0),
                    0.5 * threshold(1),
                    0.5 * threshold(2)
                ),
            ),
            "",
        ),
        row(
            "mode at the first threshold",
            "Fig. 4.3",
            Printed::Claim("(mainly) rigid bounce"),
            claim(bounce.iter().all(|x| *x > 0.5), format!("amplitudes {}", list(&bounce, 3))),
            "",
        ),
        row(
            "mode at the second",
            "Fig. 4.4",
            Printed::Claim("rigid pitch; centre at rest"),
            claim(pitch[1].abs() < 1e-3 && pitch[0] < -0.99, format!("amplitudes {}", list(&pitch, 3))),
            "",
        ),
        row(
            "mode at the third",
            "Fig. 4.5",
            Printed::Claim("flexible"),
            claim(bending[1] < 0.0 && bending[2] > 0.99, format!("amplitudes {}", list(&bending, 3))),
            "",
        ),
    ];
    rows.extend(numbers_search::rows(e));
    rows.extend([
        row(
            "increase of the first threshold, %",
            "Preface; summary of chapter IV",
            Printed::Claim("300; nearly 300"),
            claim(
                (100.0 * (reach / threshold(0) - 1.0) - 300.0).abs() < 10.0,
                format!("{:.1}", 100.0 * (reach / threshold(0) - 1.0)),
            ),
            BUILT_IN_REACH,
        ),
        row(
            "reach of the control, % of the first threshold",
            "chapter V",
            Printed::Claim("nearly 300 % of the original threshold"),
            claim(
                (100.0 * reach / threshold(0) - 300.0).abs() < 10.0,
                format!("{:.1} %; the report's own 7.2 / 1.775 is 406 %", 100.0 * reach / threshold(0)),
            ),
            "A slip of the report's: it is an increase by 300 %, as its preface and chapter IV have it, so 400 % of the original.",
        ),
        row(
            "steady forces of Fig. 4.16: would the motion stay",
            "Fig. 4.16",
            Printed::Claim("(our own check)"),
            stays(forces),
            "Linear stability about circular orbits, and a disturbance watched on those that beat. What has not settled after \
             τ = 2000 is left out of the figure.",
        ),
        row(
            "first critical speed",
            "text before Fig. 4.16",
            Printed::Claim("approximately R = 1"),
            claim((critical - 1.0).abs() < ABOUT, format!("{critical:.4}, forward and without control")),
            "",
        ),
        row(
            "peak of the force for g = 0",
            "Fig. 4.16",
            Printed::Claim("slightly below R = 1"),
            claim((0.7..1.0).contains(&peak_0), format!("at R = {peak_0:.1}, of tenths")),
            "With the built-in gains, which move the first critical speed; the report's are lost.",
        ),
        row(
            "peak of the force for g = 1",
            "Fig. 4.16",
            Printed::Claim("slight, slightly below R = 1"),
            claim(
                (0.7..1.0).contains(&peak_1) && height_1 < forces.at(1, 6.0) / 2.0,
                format!("largest below R = 2: {} at R = {peak_1:.1}, a self-excited whirl", sure(height_1, 1e-3 * height_1)),
            ),
            "With the built-in gains: their negative direct stiffness, with the bearing slack, makes the rotor whirl at low \
             speed. The report's gains, which are lost, must differ in this.",
        ),
        row(
            "force over speed and clearance",
            "Fig. 4.16, summary",
            Printed::Claim("increases with both"),
            claim(
                grows && (0..3).all(rising),
                format!("R = 3: {}; R = 6: {}, for g = 0, 1, 10", three(3.0), three(6.0)),
            ),
            "At these two speeds; at lower ones see the row above.",
        ),
        row(
            "force for g = 10, against Fig. 3.7",
            "text before Fig. 4.17",
            Printed::Claim("an order of magnitude greater"),
            claim(ORDER_OF_MAGNITUDE.contains(&against_3_7), format!("{against_3_7:.1} times at R = 5")),
            BUILT_IN,
        ),
        row(
            "force for g = 10, against g = 0 and g = 1",
            "Fig. 4.16",
            Printed::Claim("an order of magnitude greater"),
            claim(
                [over_0, over_1].iter().all(|over| ORDER_OF_MAGNITUDE.contains(over)),
                format!("{over_0:.1} and {over_1:.1} times at R = 6"),
            ),
            "Against g = 0 it is, against g = 1 less. With the built-in gains; the report's are lost.",
        ),
        row(
            "force for g = 0 and 1, against Fig. 3.7",
            "text before Fig. 4.17",
            Printed::Claim("nearly the same level"),
            claim(
                nearly_the_same(level_0) && nearly_the_same(level_1),
                format!(
                    "{level_0:.2} and {level_1:.2} times at R = 5, in ω₀² e_t; in K_t e_t {:.2} and {:.2}",
                    0.25 * level_0,
                    0.25 * level_1
                ),
            ),
            "In K_t e_t the force on mass 1 is a quarter of that in ω₀² e_t (Rm₁ = 0.25); the report does not say which it took. With \
             the built-in gains; the report's are lost.",
        ),
        row(
            "motion at R = 2, g = 1",
            "text before Fig. 4.17",
            Printed::Claim("mainly synchronous"),
            claim(
                synchronous(&e.slow),
                format!("once settled, every radius varies by {}", under(uneven(&e.slow), 1e-6)),
            ),
            BUILT_IN,
        ),
        row(
            "end mass at R = 6, g = 1",
            "Fig. 4.23",
            Printed::Claim("mainly subsynchronous"),
            claim(part > MAINLY, format!("{:.1} % of the power; peak at {line:.2} rad/τ", 100.0 * part)),
            "Typical gains of this structure peak near 0.76.",
        ),
        row(
            "orbit at R = 6, g = 10",
            "text before Fig. 4.24",
            Printed::Claim("high amplitude, subsynchronous"),
            claim(
                ORDER_OF_MAGNITUDE.contains(&wide) && e.loose.is_subsynchronous(),
                format!("{:.0} at mass 1, {wide:.1} times that of g = 1; it whirls slower than the spin", radii(&e.loose)[0]),
            ),
            BUILT_IN,
        ),
        row(
            "amplitudes at R = 2, g = 1",
            "text before Fig. 4.23",
            Printed::Claim("lowest at the controlled mass"),
            claim(quiet(&e.slow), amplitudes(&e.slow)),
            BUILT_IN,
        ),
        row(
            "amplitudes at R = 6, g = 1",
            "text before Fig. 4.23",
            Printed::Claim("lowest at the controlled mass"),
            claim(quiet(&e.fast), amplitudes(&e.fast)),
            "With the built-in gains the free end is quieter still. A property of the gains, which are lost.",
        ),
        row(
            "amplitudes at R = 6, g = 10",
            "text before Fig. 4.23",
            Printed::Claim("lowest at the controlled mass"),
            claim(quiet(&e.loose), amplitudes(&e.loose)),
            "As above.",
        ),
    ]);
    Ok(rows)
}
