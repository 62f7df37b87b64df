//! The line at the top: what is looked at, how it keeps its pace, and how things stand. The line at the foot: the last
//! message, or what the keys do.
//!
//! ```text
//!  RUNNING  default  three-mass  R 2.5  tau 412  1000/s  late 51/124 us  lost 0  age 3 ms
//! ```
//!
//! A machine too fast for one Runge-Kutta step a step has `34 substeps` behind its rate.

mod alarms_told;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};
use telemetry::history::StepQuantity;
use wire::Channel;

use crate::actions::ACTIONS;
use crate::drawing::write_line;
use crate::layers::Layer;
use crate::line_editor::LineEditor;
use crate::view::{Message, View};
use crate::{recorder_sign, theme};
use telemetry::connection::Connection;
use telemetry::frame_data::FrameData;
use telemetry::units::ScreenUnits;

use alarms_told::alarms_within;
pub(crate) use alarms_told::draw_alarms;

/// How things stand, in one word and its colour.
pub(crate) fn run_state(data: &FrameData, paused: bool) -> (&'static str, Color) {
    match data.connection {
        Connection::Waiting(_) => ("WAITING", theme::WARN),
        Connection::Gone => ("SIMULATION GONE", theme::BAD),
        Connection::Stalled => ("STALLED", theme::BAD),
        Connection::Live if data.tripped => ("TRIPPED", theme::BAD),
        Connection::Live if paused => ("PAUSED", theme::WARN),
        // Of a machine that runs the colour is that of its stability, as far as that is known.
        Connection::Live => ("RUNNING", data.poles().map_or(theme::CURSOR, |(least, _)| theme::verdict(least).0)),
    }
}

pub(crate) fn draw_top(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let (word, color) = run_state(data, !view.time.is_live());
    // Each with how soon it goes where there is no room for all: the largest first, whole. What is healthy goes before what tells how
    // the machine stands.
    let mut line = vec![(0, Span::styled(format!(" {word} "), theme::badge(color)))];
    let part = |soon: u8, text: String, style: Style| (soon, Span::styled(format!("  {text}"), style));
    let plain = Style::new();
    // A machine that stands still is first told why.
    if let Some(trip) = data.trip().filter(|_| data.connection == Connection::Live) {
        line.push(part(2, format!("{}: R restarts", data.units().trip(&trip)), theme::loud(theme::BAD)));
    }
    let starts = || ("● REC".to_owned(), " starting".to_owned(), theme::loud(theme::CURSOR));
    let told = data.recorder.as_deref().filter(|status| status.is_recording() || !data.recorder_starts);
    let sign = told.and_then(recorder_sign::of).or_else(|| data.recorder_starts.then(starts));
    if let Some((sign, told, style)) = sign {
        line.push(part(1, sign, style));
        // Behind its sign without the blanks between parts.
        if !told.is_empty() {
            line.push((5, Span::styled(told, style)));
        }
    }
    if let Connection::Waiting(why) = &data.connection {
        line.push(part(1, why.clone(), theme::loud(theme::WARN)));
    }
    if !view.time.is_live()
        && let Some(now) = data.now
    {
        let (ago, moment) = (data.ago().as_secs_f64(), data.units().moment_told(data.track.tau(now), 6));
        line.push(part(1, format!("-{ago:.3} s"), theme::loud(theme::WARN)));
        line.push(part(6, moment, theme::loud(theme::WARN)));
    }
    if view.read_only {
        line.push(part(4, "read-only".to_owned(), theme::loud(theme::CURSOR)));
    }
    if view.locked {
        line.push(part(4, "LOCKED".to_owned(), theme::loud(theme::CURSOR)));
    }
    line.push(part(6, view.bench.to_owned(), plain.bold()));
    if let (Some(bench_status), Some(settings)) = (&data.bench_status, &data.settings) {
        line.push(part(7, bench_status.rotor_name.as_str().to_owned(), plain));
        // Old recordings, and benches that have told no poles yet, know of no other speed.
        let told = data.era.as_ref().filter(|era| !era.poles.is_empty() && era.settings == *settings);
        let [leg, legs] = if view.time.is_live() { bench_status.leg } else { [0; 2] };
        // Whatever is set, after such a trip it comes to rest.
        let aim = if data.trip().is_some_and(|trip| trip.coasts()) { 0.0 } else { settings.speed };
        let is_there = |speed: f64| (speed - aim).abs() <= 1e-9 * settings.speed.abs();
        let on_its_way = told.map(|era| era.speed).filter(|speed| !is_there(*speed));
        // Nor is it where a speed goes that is on its way from there, as one that is looked back at may be.
        let rate = speed_rate(data);
        let leads_there = |now: f64| leg >= legs && rate.is_none_or(|rate| (aim - now) * rate >= 0.0);
        let speed = match data.units() {
            units @ ScreenUnits { scales: Some(_), .. } => match on_its_way {
                // The end of a profile is not where any leg but its last goes.
                Some(now) if !leads_there(now) => units.speed_told(now),
                Some(now) => format!("{} to {}", units.speed(now), units.speed_told(aim)),
                None => units.speed_told(aim),
            },
            units => match on_its_way {
                Some(now) if !leads_there(now) => format!("R {now:.3}"),
                Some(now) => format!("R {now:.3} to {}", units.value_digits(aim)),
                None => format!("R {}", units.value_digits(aim)),
            },
        };
        line.push(part(1, speed, plain));
        if let Some(now) = on_its_way
            && let Some(told) = rate_told(data, now)
        {
            line.push(part(5, told, plain));
        }
        if legs > 0 {
            line.push(part(5, format!("leg {leg} of {legs}"), plain));
        }
        line.push(part(9, format!("{:.0}/s", data.rate), plain));
        if bench_status.substeps > 1 {
            line.push(part(8, format!("{} substeps", bench_status.substeps), plain));
        }
        let health = &bench_status.health;
        let (p50, p99) = (health.lateness_p50_us, health.lateness_p99_us);
        line.push(part(10, format!("late {p50:.0}/{p99:.0} us"), plain));
        if health.missed > 0 {
            line.push(part(3, format!("missed {}", health.missed), theme::loud(theme::WARN)));
        }
        match data.lost {
            0 => line.push(part(11, "lost 0".to_owned(), plain)),
            lost => line.push(part(3, format!("lost {lost}"), theme::loud(theme::WARN))),
        }
    }
    if let Some(age) = data.age {
        if matches!(data.connection, Connection::Gone | Connection::Stalled) {
            line.push(part(1, format!("last step {:.1} s ago", age.as_secs_f64()), theme::loud(theme::BAD)));
        } else {
            line.push(part(12, format!("age {} ms", age.as_millis()), plain));
        }
    }
    // Alarms have their place whatever else is told, but their names make room for how the machine stands: other panels tell them.
    let needed: usize = line.iter().filter(|(soon, _)| *soon <= 1).map(|(_, part)| part.width()).sum();
    let alarms = alarms_within(view.alarms, usize::from(area.width).saturating_sub(needed));
    let told = (alarms.width() as u16).min(area.width);
    let room = area.width - told;
    write_line(buffer, Rect { width: room, ..area }, fitted(line, usize::from(room)));
    write_line(buffer, Rect { x: area.right() - told, width: told, ..area }, alarms);
}

/// How fast the speed changes, if it does.
fn speed_rate(data: &FrameData) -> Option<f64> {
    let rate = data.track.value(StepQuantity::Of(Channel::SpeedRate, 0), data.now?);
    (rate != 0.0 && rate.is_finite()).then_some(rate)
}

/// How fast the speed changes, and how long it still does: that is known of a ramp, not of a decay, nor of a profile with legs to come.
fn rate_told(data: &FrameData, speed: f64) -> Option<String> {
    let (settings, bench_status) = (data.settings.as_ref()?, data.bench_status.as_ref()?);
    let rate = speed_rate(data)?;
    let unit = data.units().of_dimension(units::Dimension::SpeedRate);
    let told = format!("at {}", unit.told(rate, 3));
    let left = (settings.speed - speed) / rate / (bench_status.dtau * bench_status.rate_hz);
    let is_ramp = (rate.abs() - settings.ramp).abs() <= 1e-6 * settings.ramp;
    let is_known = is_ramp && !data.tripped && left.is_finite() && left >= 0.0;
    Some(if is_known { format!("{told}, {left:.0} s left") } else { told })
}

/// As many of the parts as have room: one that goes, goes whole.
fn fitted(mut parts: Vec<(u8, Span<'_>)>, room: usize) -> Line<'_> {
    let wide = |parts: &[(u8, Span<'_>)]| parts.iter().map(|(_, part)| part.width()).sum::<usize>();
    while parts.len() > 1 && wide(&parts) > room {
        let first = (0..parts.len()).max_by_key(|at| parts[*at].0).unwrap_or(0);
        // What has no room even by itself stays to be cut: a word of it is better than none.
        if parts.len() == 2 && parts[0].1.width() + 4 < room {
            break;
        }
        parts.remove(first);
    }
    Line::from(parts.into_iter().map(|(_, part)| part).collect::<Vec<_>>())
}

/// The line at the foot: what is being typed or asked, else the last message, else what the keys do.
pub(crate) fn draw_foot(view: &View<'_>, area: Rect, buffer: &mut Buffer) {
    let prompt = |sign: &str, line: &LineEditor| {
        let bold = Style::new().bold();
        let mut spans = vec![Span::styled(format!(" {sign}"), bold)];
        spans.extend(line.spans(bold));
        // What is wrong stands beside it, as far as there is room.
        if let Message::Bad(why) = view.message {
            spans.push(Span::styled(format!("   {why}"), theme::loud(theme::BAD)));
        }
        Line::from(spans)
    };
    let line = match view.layers.last() {
        Some(Layer::Command(text)) => prompt(":", text),
        Some(Layer::Filter(text)) => prompt("/", text),
        Some(Layer::AskUnstable(_, _, why)) => why.line(theme::BAD, "does it all the same", area.width.into()),
        Some(Layer::AskPreset(_, why)) => why.line(theme::WARN, "does it", area.width.into()),
        Some(Layer::AskFound(_, why)) => why.line(theme::CANDIDATE, "applies it", area.width.into()),
        _ => told(view, area.width),
    };
    write_line(buffer, area, line);
}

fn told<'a>(view: &'a View<'_>, width: u16) -> Line<'a> {
    match view.message {
        Message::Good(text) => Line::styled(format!(" {text}"), theme::loud(theme::CURSOR)),
        Message::Bad(text) => Line::styled(format!(" {text}"), theme::loud(theme::BAD)),
        Message::Hints => {
            // What has no room goes whole, from the end.
            let (mut spans, mut wide) = (Vec::new(), 0);
            for row in ACTIONS {
                for keys in row.keys {
                    let Some(hint) = keys.hint else { continue };
                    // The first of several ways to press it, both directions of it.
                    let shown = view.keymap.shown(row, keys);
                    let ways = if row.argument.is_empty() { 1 } else { 2 };
                    let key: Vec<&str> = shown.split(' ').take(if shown == "1 to 9" { 3 } else { ways }).collect();
                    if shown.is_empty() {
                        continue;
                    }
                    let keys = Span::styled(format!(" {} ", key.join(" ")), Style::new().bold());
                    let hint = Span::styled(format!("{hint} "), theme::quiet());
                    wide += keys.width() + hint.width();
                    if wide > usize::from(width) {
                        return Line::from(spans);
                    }
                    spans.extend([keys, hint]);
                }
            }
            Line::from(spans)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use alarms::Alarms;
    use wire::RecorderState;
    use wire::message::Trip;

    use super::*;
    use crate::drawing::tests::drawn;
    use crate::panels::alarms::tests::damping;
    use crate::view::tests::view;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    fn top(data: &FrameData, paused: bool) -> String {
        let mut time = ViewTime::LIVE;
        if paused {
            time.pause(&(0..3000));
        }
        drawn(120, 1, |area, buffer| draw_top(&View { time: &time, ..view(data) }, area, buffer))
    }

    #[test]
    fn a_running_bench_tells_its_pace() {
        let mut data = tests::frame_data();
        (data.rate, data.age) = (1000.2, Some(Duration::from_millis(3)));
        assert_eq!(
            top(&data, false),
            " RUNNING   default  three-mass  R 2.5  1000/s  late 50/120 us  lost 0  age 3 ms\n"
        );
        assert!(top(&data, true).starts_with(" PAUSED   -0.000 s  tau 29.9900  default "), "{}", top(&data, true));
    }

    #[test]
    fn a_recording_has_a_sign_with_time_size_and_losses() {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as u64;
        let mut status = wire::RecorderStatus { bytes: 3_440_000, lost: 2, ..wire::RecorderStatus::default() };
        (status.wall_ns, status.started_ns) = (now + 60_000_000_000, now - 12_000_000_000);
        let mut sign = |state, wall_ns: Option<u64>| {
            status.set_state(state);
            status.wall_ns = wall_ns.unwrap_or(status.wall_ns);
            let mut data = tests::frame_data();
            data.recorder = Some(Box::new(status));
            top(&data, false)
        };
        assert!(sign(RecorderState::Recording, None).contains("● REC 01:12 3.4 MB lost 2"));
        assert!(sign(RecorderState::Died, None).contains("REC DIED"));
        assert!(!sign(RecorderState::Stopped, None).contains("REC"));
        assert!(sign(RecorderState::Recording, Some(now - 9_500_000_000)).contains("● REC hangs for "));
        status.error = wire::Text::new("disk full");
        status.set_state(RecorderState::Failed);
        let mut data = tests::frame_data();
        data.recorder = Some(Box::new(status));
        assert!(top(&data, false).contains("REC FAILED: disk full"));
    }

    #[test]
    fn on_the_smallest_screen_state_offset_speed_recording_and_alarms_stay() {
        let mut data = tests::frame_data();
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as u64;
        let mut status = wire::RecorderStatus { bytes: 3_440_000, wall_ns: now, ..wire::RecorderStatus::default() };
        status.set_state(RecorderState::Recording);
        (data.recorder, data.behind, data.seconds) = (Some(Box::new(status)), 12_345, 1e-3);
        let mut alarms = Alarms::default();
        alarms.read(&damping(1, -0.3));
        alarms.read(&damping(2, -0.3).with(alarms::Watch::Saturation, 1.0).with(alarms::Watch::Orbit, 1e9));
        let mut time = ViewTime::LIVE;
        time.pause(&(0..3000));
        let seen = View { time: &time, alarms: &alarms, ..view(&data) };
        let frame = drawn(60, 1, |area, buffer| draw_top(&seen, area, buffer));
        for told in [" PAUSED ", "-12.345 s", "R 2.5", "● REC", "!!"] {
            assert!(frame.contains(told), "{told}: {frame}");
        }
    }

    #[test]
    fn what_runs_has_the_colour_of_its_stability() {
        let mut data = tests::frame_data();
        for (least, color) in [(0.3, theme::GOOD), (0.001, theme::WARN), (-0.1, theme::BAD)] {
            let era = std::sync::Arc::make_mut(data.era.as_mut().unwrap());
            era.min_damping = least;
            assert_eq!(run_state(&data, false), ("RUNNING", color));
        }
        data.era = None;
        assert_eq!(run_state(&data, false), ("RUNNING", theme::CURSOR));
    }

    #[test]
    fn death_stall_and_trip_are_told_first_and_in_words() {
        let mut data = tests::frame_data();
        data.age = Some(Duration::from_millis(1500));
        data.connection = Connection::Gone;
        assert!(top(&data, false).starts_with(" SIMULATION GONE "));
        assert!(top(&data, false).contains("last step 1.5 s ago"));
        data.connection = Connection::Stalled;
        assert!(top(&data, true).starts_with(" STALLED "));
        data.connection = Connection::Waiting("waiting for bench 'x'".into());
        assert!(top(&data, false).starts_with(" WAITING   waiting for bench 'x'"));
        data.connection = Connection::Live;
        data.tripped = true;
        let mut bench_status = tests::bench_status("three-mass", "off");
        bench_status.trip = Trip { cause: 1, mass: 2, step: 9, radius: 1000.5, limit: 1000.0 };
        data.bench_status = Some(std::sync::Arc::from(bench_status));
        let line = top(&data, false);
        assert!(
            line.starts_with(
                " TRIPPED   orbit of mass 2 reached 1000.5000 e_t, past the limit of 1000 e_t: R restarts"
            ),
            "{line}"
        );
    }

    #[test]
    fn alarms_are_told_at_the_right_edge_by_sign_and_word_until_they_are_acknowledged() {
        let data = tests::frame_data();
        let mut alarms = Alarms::default();
        let told = |alarms: &Alarms| {
            let frame = drawn(90, 1, |area, buffer| draw_top(&View { alarms, ..view(&data) }, area, buffer));
            frame.trim_end().to_owned()
        };
        alarms.read(&damping(1, 0.3));
        assert!(told(&alarms).ends_with("age 0 ms"), "{}", told(&alarms));
        alarms.read(&damping(2, -0.3));
        alarms.read(&damping(3, 0.3));
        assert!(told(&alarms).ends_with(" !! ALARM damping"), "{}", told(&alarms));
        alarms.acknowledge();
        assert!(told(&alarms).ends_with("age 0 ms"), "{}", told(&alarms));
        alarms.read(&damping(4, 0.01));
        assert!(told(&alarms).ends_with(" ! WARNING damping"), "{}", told(&alarms));
        // The speed is never cut for their names.
        let frame = drawn(32, 1, |area, buffer| draw_top(&View { alarms: &alarms, ..view(&data) }, area, buffer));
        assert!(frame.contains("RUNNING   R 2.5 ") && frame.trim_end().ends_with(" ! WARNING 1"), "{frame}");
    }

    #[test]
    fn the_foot_hints_at_the_keys_or_tells_the_last_message() {
        let data = tests::frame_data();
        let hints = drawn(120, 1, |area, buffer| draw_foot(&view(&data), area, buffer));
        assert!(hints.contains("? help") && hints.contains("q quit") && hints.contains("left right nudge"), "{hints}");
        let bad = Message::Bad("speed = -1: expected a number from 0 to 1000".into());
        let told = drawn(60, 1, |area, buffer| draw_foot(&View { message: &bad, ..view(&data) }, area, buffer));
        assert_eq!(told, " speed = -1: expected a number from 0 to 1000\n");
    }
}
