//! What the minimum damping does not say, in a few lines below it: what the clearances make of it, and how far the gains carry.
//!
//! ```text
//! but whirls at 112 e_t, 0.91 w0 forward   the largest limit cycle that the rotor would stay on; by the limits of the orbit's alarm
//! any deadband 0.0123 low                  the worst damping with any share of its stiffness left to each support bearing
//! stable 0 to 7.074, 4.574 away            the range of speeds around the present one, and how far its nearest end is
//! ```

use alarms::{Level, Watch};
use ratatui::style::Style;
use telemetry::damping_verdict::DampingVerdict;
use telemetry::history::Era;
use telemetry::jobs::{DeadbandRequest, LimitCycle, PoleTraceRequest};
use telemetry::units::ScreenUnits;
use text::number::short;

use super::damping_over_speed::stable_words;
use crate::fit_text::longest;
use crate::theme;
use crate::view::View;

/// The lines, the most important first, each as long as has room in so many cells.
pub(super) fn notes(view: &View<'_>, room: usize) -> Vec<(String, Style)> {
    let Some(era) = view.data.era.as_ref().filter(|era| !era.poles.is_empty()) else { return Vec::new() };
    let units = view.data.units();
    let mut notes = Vec::new();
    let found = DeadbandRequest::of(era).and_then(|question| view.jobs.deadband(&question));
    if let Some(found) = found {
        match &found.cycle {
            Ok(Some(cycle)) => notes.push(whirls(cycle, era, view, &units, room)),
            Ok(None) => {}
            Err(why) => {
                notes.push((longest(&[&format!("whirl unknown: {why}"), "whirl unknown"], room), theme::quiet()));
            }
        }
        notes.extend(found.worst.map(|worst| any_deadband(worst, room)));
    }
    notes.extend(range(era, view, &units, room));
    notes
}

/// A limit cycle; "but" where the centre is stable.
fn whirls(cycle: &LimitCycle, era: &Era, view: &View<'_>, units: &ScreenUnits, room: usize) -> (String, Style) {
    let level = match view.alarms.limits().of(Watch::Orbit) {
        Some(limit) if cycle.radius > limit.at(Level::Alarm) => Level::Alarm,
        _ => Level::Warning,
    };
    let but = if era.min_damping > 0.0 { "but " } else { "" };
    let radius = units.length.told(cycle.radius, 4);
    let sense = if cycle.frequency < 0.0 { "backward" } else { "forward" };
    let brief = format!("{but}whirls at {radius}");
    let full = format!("{brief}, {} {sense}", units.frequency.told(cycle.frequency.abs(), 3));
    (longest(&[&full, &brief, &format!("whirls {radius}"), &radius], room), theme::loud(theme::level_color(level)))
}

/// What the worst share of stiffness leaves: no alarm by itself, as no clearance holds a bearing at one share.
fn any_deadband(worst: f64, room: usize) -> (String, Style) {
    let (color, word) = match DampingVerdict::of(worst) {
        DampingVerdict::Stable => (theme::GOOD, "stable"),
        DampingVerdict::Low => (theme::WARN, "low"),
        DampingVerdict::Marginal | DampingVerdict::Unstable => (theme::WARN, "grows"),
    };
    let full = format!("any deadband {worst:.4} {word}");
    (
        longest(&[&full, &format!("any deadband {worst:.4}"), &format!("deadband {worst:.4}")], room),
        Style::new().fg(color),
    )
}

/// The range of speeds around the present one in which all modes decay, and how far its nearest end is.
fn range(era: &Era, view: &View<'_>, units: &ScreenUnits, room: usize) -> Option<(String, Style)> {
    let pole_trace = view.jobs.pole_trace(&PoleTraceRequest::of(era)?)?;
    let all = stable_words(&pole_trace, units);
    let here = pole_trace.stable.iter().find(|[from, to]| (*from..=*to).contains(&era.speed));
    let Some([from, to]) = here else {
        let color = if pole_trace.stable.is_empty() { theme::BAD } else { theme::WARN };
        return Some((longest(&[&all, &all.replace("stable ", "")], room), Style::new().fg(color)));
    };
    // What was computed ends somewhere: how far it goes on is not known.
    let ends = [(*from > 0.0).then_some(era.speed - from), (*to < pole_trace.top()).then_some(to - era.speed)];
    let away = ends.into_iter().flatten().reduce(f64::min).map(|away| match units.scales {
        Some(_) => format!("{} rpm away", units.speed(away)),
        None => format!("{} away", short(away, 4)),
    });
    let both = away.map_or_else(|| all.clone(), |away| format!("{all}, {away}"));
    Some((longest(&[&both, &both.replace("stable ", ""), &all, &all.replace("stable ", "")], room), theme::quiet()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::tests::view;
    use telemetry::feed::Feed;
    use telemetry::frame_data::FrameData;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    fn told(feedback: &str, speed: f64, deadband: f64, room: usize) -> Vec<String> {
        let mut bench_status = tests::bench_status("three-mass", feedback);
        let mut settings = bench_status.settings.get().clone();
        (settings.speed, bench_status.analysis.speed) = (speed, speed);
        settings.deadband.fill(deadband);
        bench_status.settings = wire::SettingsDocument::of(&settings);
        let mut feed = Feed::new("");
        feed.push_bench_status(bench_status);
        let data: FrameData = feed.frame_data(&ViewTime::LIVE, std::time::Instant::now());
        notes(&view(&data), room).into_iter().map(|(text, _)| text).collect()
    }

    #[test]
    fn what_the_clearances_make_of_a_stable_centre_is_told() {
        let composite = told("composite", 2.5, 1.0, 60);
        assert_eq!(
            composite,
            ["but whirls at 1.564 e_t, 0.09 w0 forward", "any deadband -1.0000 grows", "stable 0 to 7.074, 4.574 away"]
        );
        let individual = told("individual", 2.5, 1.0, 60);
        assert!(individual[0].starts_with("any deadband 0.0331 stable"), "{individual:?}");
        assert_eq!(told("composite", 2.5, 0.0, 60), ["stable 0 to 7.074, 4.574 away"], "no clearance, no whirl");
    }

    #[test]
    fn words_go_before_numbers() {
        assert_eq!(
            told("composite", 2.5, 1.0, 24),
            ["but whirls at 1.564 e_t", "any deadband -1.0000", "0 to 7.074, 4.574 away"]
        );
        assert_eq!(told("composite", 2.5, 1.0, 16), ["whirls 1.564 e_t", "deadband -1.0000", "0 to 7.074"]);
    }
}
