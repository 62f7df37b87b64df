//! Amplitude and phase over speed, run-up and coast-down in different strokes, beside the steady response.

use plot::{Axis, Chart, Color, Look, Series};
use study::runup::{RunUp, RunUpPlan};

use crate::units::CommandUnits;

/// Colours of the masses, in turn.
const COLORS: [Color; 5] = [Color::BLUE, Color::VERMILLION, Color::GREEN, Color::PURPLE, Color::BLACK];

/// Speeds, and the radius of every mass at each.
type Response = (Vec<f64>, Vec<Vec<f64>>);

/// The two charts.
pub(super) fn charts(plan: &RunUpPlan, found: &RunUp, steady: Option<&Response>, units: CommandUnits) -> [Chart; 2] {
    let masses = plan.rotor.len();
    let [low, high] = plan.profile.speeds();
    let axis = |label: &str, to: f64| Axis::new(label, units.speed(low), to);
    let mut amplitude: Vec<Series> = Vec::new();
    let mut phase: Vec<Series> = Vec::new();
    for k in 0..masses {
        let color = COLORS[k % COLORS.len()];
        for (look, way, is_up) in [(Look::Solid, "", true), (Look::Dashed, ", down", false)] {
            // A stretch of the other way breaks the line.
            let mut points = Vec::new();
            let mut angles = Vec::new();
            let mut before = plan.profile.from;
            let mut last = 0.0;
            for point in &found.points {
                let turn = &point.turn;
                let mine = if turn.speed == before { is_up } else { (turn.speed > before) == is_up };
                before = turn.speed;
                let (first, at) = (turn.first_order[k], units.speed(turn.speed));
                let angle = first.arg().to_degrees();
                let cut = (at, f64::NAN);
                points.push(if mine { (at, units.length(first.norm())) } else { cut });
                // From -180 to 180 degrees is no way to go.
                if (angle - last).abs() > 180.0 {
                    angles.push(cut);
                }
                angles.push(if mine { (at, angle) } else { cut });
                last = angle;
            }
            if points.iter().any(|point| point.1.is_finite()) {
                let name = if masses > 1 { format!("mass {}{way}", k + 1) } else { format!("first order{way}") };
                amplitude.push(Series::new(&name, look, color, points));
                phase.push(Series::new("", look, color, angles));
            }
        }
        if let Some((speeds, heights)) = steady {
            let points = speeds.iter().zip(&heights[k]).map(|(s, h)| (units.speed(*s), units.length(*h))).collect();
            let name = if k == 0 { "steady" } else { "" };
            amplitude.push(Series::new(name, Look::Dotted, color, points));
        }
    }
    let ends = amplitude.iter().flat_map(|series| &series.points).map(|point| point.1).filter(|y| y.is_finite());
    let top = 1.08 * ends.fold(f64::MIN_POSITIVE, f64::max);
    let speed = units.pick("Spin speed R", "Spin speed (rpm)");
    let title = format!("{}: first order over speed", plan.rotor.name());
    let chart = |title: String, y: Axis, series| Chart {
        title,
        x: axis(speed, units.speed(high)),
        y,
        equal: false,
        series,
        notes: vec![],
    };
    [
        chart(title, Axis::new(units.pick("Amplitude (e_t)", "Amplitude (m)"), 0.0, top), amplitude),
        chart("phase against the unbalance".into(), Axis::new("Phase (degrees)", -180.0, 180.0), phase),
    ]
}
