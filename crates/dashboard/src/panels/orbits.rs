//! An orbit per mass, on one scale.
//!
//! ```text
//! ┌ orbits  ±5.0 e_t ───────────────┐   "fixed" beside the scale while it stands still
//! │   1 bearing       2         3   │
//! │    ⣀⠤⠤⣀        ⣀⠤⠤⠤⣀     ⣀⠤⠤⣀  │   the last few turns, the latest two in colour; ◉ now
//! │   ⡎ ⢀⡀ ⢱      ⡎  ●   ⢱   ⡎ ⢀⡀ ⢱ │   ● keyphasor: where the mass was, once a turn
//! │    ⠑⠤⠤⠊        ⠑⠤⠤⠤⠊     ⠑⠤⠤⠊  │   blue circle: clearance of the support bearing
//! │  0.62         2.71       1.9    │   distance from the centre under the cursor; y and z where there is room
//! └─────────────────────────────────┘
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;

use super::panel::Panel;
use crate::axis::PlotAxis;
use crate::drawing::{framed, write};
use crate::fit_text::longest;
use crate::plot::Plot;
use crate::theme;
use crate::view::View;
use telemetry::frame_data::FrameData;
use telemetry::history::{StepQuantity, Track};
use telemetry::replay::WhatIfRun;
use telemetry::units::Unit;
use text::number::{nice_ceiling, short};

/// Turns of the rotor that an orbit shows.
const TURNS: f64 = 8.0;
/// Turns that are drawn in colour.
const FRESH: f64 = 2.0;
/// Steps that an orbit shows at low speed, where that many turns take too long.
const MOST_STEPS: usize = 10_000;

/// The least width and height of a cell that is worth looking at, where there are more places than room.
const LEAST: [u16; 2] = [10, 5];

/// Width of a cell in which y and z have room beside the radius, and height of one in which they have room above it.
const ROOM_FOR_PLACE: u16 = 26;
const ROWS_FOR_PLACE: u16 = 12;

/// The orbits; the wheel changes their scale.
#[derive(Debug, Default)]
pub(crate) struct Orbits {
    scale: PlotAxis,
}

impl Panel for Orbits {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        draw(view, &mut self.scale, area, buffer);
    }

    fn scale(&mut self) -> Option<&mut PlotAxis> {
        Some(&mut self.scale)
    }
}

fn draw(view: &View<'_>, axis: &mut PlotAxis, area: Rect, buffer: &mut Buffer) {
    let data = view.data;
    let track = &data.track;
    let shown = shown_steps(track, data.now);
    let furthest = |mass| track.range(StepQuantity::radius(mass), shown.clone()).map_or(0.0, |[_, furthest]| furthest);
    let reach = (0..data.masses()).map(furthest).fold(0.0, f64::max);
    let beside = view.replay.as_ref().and_then(|replay| replay.beside);
    let other = |step| (0..data.masses()).filter_map(move |mass| beside?.displacement(step, mass)).map(radius);
    // A machine that runs away beside this one must not make a point of it.
    let reach = reach.max(shown.clone().flat_map(other).fold(0.0, f64::max).min(if reach > 0.0 {
        4.0 * reach
    } else {
        f64::MAX
    }));
    // A clearance much larger than the orbit would squeeze it to a point: it goes out of view then.
    let clearance = clearances(data).into_iter().flatten().fold(0.0, f64::max);
    let scale = nice_ceiling(1.02 * reach.max(if clearance < 4.0 * reach || reach == 0.0 { clearance } else { 0.0 }));
    let unit = data.units().length;
    let shown_scale = axis.reach(if unit.factor == 1.0 { scale } else { nice_ceiling(scale * unit.factor) });
    let scale = shown_scale / unit.factor;
    let within = Rect::new(0, 0, area.width.saturating_sub(2), area.height.saturating_sub(2));
    let chosen = chosen(data, room(within), furthest);
    let of =
        if chosen.len() < data.masses() { format!("  {} of {}", chosen.len(), data.masses()) } else { String::new() };
    let title = format!(" orbits{of}  ±{} {}{}  ◉ now ● once a turn ", short(shown_scale, 2), unit.name, axis.word());
    let inner = framed(Line::from(title), area, buffer);
    let turns = Turns::of(track, shown.clone());
    let cells = grid(inner, chosen.len());
    for (mass, cell) in chosen.into_iter().zip(cells) {
        draw_one(data, beside, mass, &turns, (scale, unit), cell, buffer);
    }
}

/// How many orbits of the least size that tells something have room.
fn room(area: Rect) -> usize {
    usize::from(area.width / LEAST[0]) * usize::from(area.height / LEAST[1])
}

/// The places whose orbits are drawn, from left to right. Of a chain all masses; of a shaft as many places as there is `room` for: those
/// that carry control bearings, those that are sensed, those that touch something, and the rest by how far they go.
fn chosen(data: &FrameData, room: usize, furthest: impl Fn(usize) -> f64) -> Vec<usize> {
    let all: Vec<usize> = (0..data.masses()).collect();
    let shaft = data.era.as_ref().and_then(|era| Some((era, era.rotor.as_ref().filter(|rotor| !rotor.is_chain())?)));
    let Some((era, rotor)) = shaft.filter(|_| all.len() > room) else { return all };
    let bearings = &era.settings.feedback.bearings;
    let rank = |place: usize| match place {
        _ if bearings.iter().any(|bearing| bearing.station == place) => 0,
        _ if bearings.iter().any(|bearing| bearing.senses(place)) => 1,
        _ if rotor.has_contact(place) => 2,
        _ => 3,
    };
    let mut ranked: Vec<(i32, f64, usize)> =
        all.into_iter().map(|place| (rank(place), -furthest(place), place)).collect();
    ranked.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut chosen: Vec<usize> = ranked.into_iter().take(room.max(1)).map(|(.., place)| place).collect();
    chosen.sort_unstable();
    chosen
}

fn draw_one(
    data: &FrameData,
    beside: Option<WhatIfRun<'_>>,
    mass: usize,
    turns: &Turns,
    (scale, unit): (f64, Unit),
    cell: Rect,
    buffer: &mut Buffer,
) {
    let track = &data.track;
    let window = Plot::round(cell, scale);
    let mut plot = Plot::new(cell, window);
    plot.line([window.x[0], 0.0], [window.x[1], 0.0], theme::GRID);
    plot.line([0.0, window.y[0]], [0.0, window.y[1]], theme::GRID);
    if let Some(clearance) = clearances(data).get(mass).copied().flatten() {
        plot.circle(clearance, theme::CLEARANCE);
    }
    let color = theme::TRACES[mass % theme::TRACES.len()];
    // What is older than a turn or two fades, so that the eye finds where the mass goes.
    let Turns { shown, fresh, begun } = turns;
    plot.path(track.displacements(shown.start..*fresh, mass), theme::GRID);
    plot.path(track.displacements(fresh.saturating_sub(1).max(shown.start)..shown.end, mass), color);
    let turns: Vec<[f64; 2]> = begun.iter().map(|step| track.displacement(*step, mass)).collect();
    let others: Vec<_> = shown.clone().filter_map(|step| beside?.displacement(step, mass)).collect();
    others.windows(2).for_each(|pair| plot.line(pair[0], pair[1], theme::CANDIDATE));
    plot.paint(buffer);
    let mut mark = |[y, z]: [f64; 2], sign, color| {
        if let Some((column, row)) = plot.cell(y, z) {
            write(buffer, cell, column, row, sign, theme::loud(color));
        }
    };
    if let Some((last, earlier)) = turns.split_last() {
        earlier.iter().for_each(|place| mark(*place, "•", theme::KEYPHASOR));
        mark(*last, "●", theme::KEYPHASOR);
    }
    if let Some(now) = shown.clone().last() {
        mark(track.displacement(now, mass), "◉", color);
    }
    if let Some(place) = others.last() {
        mark(*place, "◆", theme::CANDIDATE);
    }
    let mut bearings = data.era.iter().flat_map(|era| &era.settings.feedback.bearings);
    let carries = bearings.any(|bearing| bearing.station == mass);
    let place = data.era.as_ref().and_then(|era| era.rotor.as_ref()?.beam().map(|beam| beam.place_name(mass)));
    // Beside its number, if half of the cell has room for it.
    let place =
        place.map(|name| format!(" {name}")).filter(|name| name.chars().count() + 4 <= usize::from(cell.width / 2));
    let name = format!("{}{}{}", mass + 1, place.unwrap_or_default(), if carries { " ⊕" } else { "" });
    // What is told of one mass must not touch what is told of the next.
    let cell = Rect { width: cell.width.saturating_sub(1), ..cell };
    let behind = write(buffer, cell, cell.left(), cell.top(), &name, theme::loud(color)) + 1;
    if let Some(last) = shown.clone().last() {
        let [y, z] = track.displacement(last, mass);
        let told = |value| unit.short(value, 3);
        // In fewer digits where there is no room for more: one that is rounded is still the same number.
        let size = |room: u16| {
            let ways = [3, 2, 1].map(|digits| unit.short(radius([y, z]), digits));
            longest(&ways.each_ref().map(String::as_str), usize::from(room))
        };
        let mut line = |from_below: u16, x: u16, text: &str| {
            write(buffer, cell, x, cell.bottom().saturating_sub(from_below), &format!("{text} "), theme::quiet());
        };
        match (cell.width + 1, cell.height) {
            (_, ..=3) => {
                let x = behind.max(cell.left() + 4);
                write(buffer, cell, x, cell.top(), &size(cell.right().saturating_sub(x)), theme::quiet());
            }
            (ROOM_FOR_PLACE.., _) => {
                line(1, cell.left(), &format!("{}  y {}  z {}", told(radius([y, z])), told(y), told(z)));
            }
            (_, ROWS_FOR_PLACE..) => {
                line(3, cell.left(), &format!("y {}", told(y)));
                line(2, cell.left(), &format!("z {}", told(z)));
                line(1, cell.left(), &size(cell.width));
            }
            _ => line(1, cell.left(), &size(cell.width)),
        }
    }
}

/// The clearance of every mass that has a support bearing and a deadband in it.
fn clearances(data: &FrameData) -> Vec<Option<f64>> {
    let Some((era, rotor)) = data.era.as_ref().and_then(|era| Some((era, era.rotor.as_ref()?))) else {
        return Vec::new();
    };
    let deadband = era.settings.deadband.iter().enumerate();
    deadband.map(|(place, g)| (rotor.has_contact(place) && *g > 0.0).then_some(*g)).collect()
}

/// Which turn of the rotor a spin angle belongs to.
fn turn(angle: f64) -> f64 {
    (angle / std::f64::consts::TAU).floor()
}

fn radius([y, z]: [f64; 2]) -> f64 {
    y.hypot(z)
}

/// The turns of the rotor over some steps.
struct Turns {
    shown: std::ops::Range<usize>,
    /// The first step of those that are drawn in colour.
    fresh: usize,
    /// Steps with which a turn began.
    begun: Vec<usize>,
}

impl Turns {
    fn of(track: &Track, shown: std::ops::Range<usize>) -> Self {
        let latest = shown.clone().last().map_or(0.0, |last| turn(track.angle(last)));
        let (mut fresh, mut begun) = (shown.end, Vec::new());
        let mut steps = shown.clone();
        let mut turned = steps.next().map_or(0.0, |first| turn(track.angle(first)));
        if turned > latest - FRESH {
            fresh = shown.start;
        }
        let mut next = (turned + 1.0) * std::f64::consts::TAU;
        for step in steps {
            let angle = track.angle(step);
            if angle >= next {
                turned = turn(angle);
                next = (turned + 1.0) * std::f64::consts::TAU;
                begun.push(step);
                if turned > latest - FRESH {
                    fresh = fresh.min(step);
                }
            }
        }
        Self { shown, fresh, begun }
    }
}

/// The steps of the last few turns before the one under the cursor, with that.
fn shown_steps(track: &Track, now: Option<usize>) -> std::ops::Range<usize> {
    let Some(last) = now else { return 0..0 };
    let most = (last + 1).saturating_sub(MOST_STEPS);
    let from = track.angle(last) - TURNS * std::f64::consts::TAU;
    // The angle rises with time, but falls to zero at a restart: what was before is another motion.
    let (mut start, mut angle) = (last, track.angle(last));
    while start > most {
        let earlier = track.angle(start - 1);
        if earlier > angle || earlier < from {
            break;
        }
        (start, angle) = (start - 1, earlier);
    }
    start..last + 1
}

/// Up to so many orbits stand in a row or in a column: a hole among few is read as one that is missing.
const IN_A_ROW: u16 = 3;

/// Divides an area into `count` cells, in the number of columns that makes the largest round plot.
fn grid(area: Rect, count: usize) -> Vec<Rect> {
    let count = count as u16;
    let side = |columns: u16| (area.width / columns).min(2 * (area.height / count.div_ceil(columns)));
    let Some(columns) = (1..=count)
        .filter(|columns| count > IN_A_ROW || count.is_multiple_of(*columns))
        .max_by_key(|columns| (side(*columns), *columns))
    else {
        return Vec::new();
    };
    let (width, height) = (area.width / columns, area.height / count.div_ceil(columns));
    (0..count)
        .map(|at| Rect::new(area.x + at % columns * width, area.y + at / columns * height, width, height))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::tests::drawn;
    use crate::view::tests::view;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    #[test]
    fn every_mass_has_its_orbit_on_one_scale() {
        let data = tests::frame_data();
        let frame = drawn(72, 14, |area, buffer| Orbits::default().draw(&view(&data), area, buffer));
        assert!(frame.contains("±4.0 e_t"), "{frame}");
        assert!(frame.contains("1 ⊕"), "{frame}");
        insta::assert_snapshot!("orbits", frame);
    }

    #[test]
    fn eight_turns_are_shown_and_a_restart_cuts_them() {
        let data = tests::frame_data();
        let shown = shown_steps(&data.track, data.now);
        // 8 turns at R = 2.5 and 0.01 a step.
        assert_eq!(shown.len(), (8.0 * std::f64::consts::TAU / 0.025).floor() as usize + 1);
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        (0..500).for_each(|seq| feed.push_step(&tests::state(3, seq), now));
        (500..600).for_each(|seq| {
            let fresh = tests::state(3, seq - 500);
            feed.push_step(&fresh.with_word(wire::Channel::Seq, seq), now);
        });
        let data = feed.frame_data(&ViewTime::LIVE, now);
        assert_eq!(shown_steps(&data.track, data.now), 500..600);
        assert_eq!(shown_steps(&data.track, Some(499)), 0..500, "the motion before, with the cursor there");
    }

    #[test]
    fn of_a_shaft_the_places_that_matter_are_chosen() {
        let rotor = rotor::builtin::rotor("rig").expect("built in");
        let feedback = rotor::builtin::feedback(&rotor, "own").expect("its own");
        let carriers: Vec<usize> = feedback.bearings.iter().map(|bearing| bearing.station).collect();
        let mut status = tests::bench_status("jeffcott", "off");
        status.set_rotor(&rotor);
        status.settings = wire::SettingsDocument::of(&rotor::Settings::new(&rotor, 1.0, feedback));
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        feed.push_bench_status(status);
        (0..200).for_each(|seq| feed.push_step(&tests::state(rotor.len(), seq), now));
        let data = feed.frame_data(&ViewTime::default(), now);
        let chosen = |room: usize| chosen(&data, room, |place| place as f64);
        assert_eq!(chosen(rotor.len()), (0..rotor.len()).collect::<Vec<_>>());
        assert_eq!(chosen(2), carriers);
        let mut three = carriers.clone();
        three.push(rotor.len() - 1);
        assert_eq!(chosen(3), three, "the largest comes next");
        assert_eq!(chosen(0).len(), 1);
        let frame = drawn(40, 12, |area, buffer| Orbits::default().draw(&view(&data), area, buffer));
        assert!(frame.contains(&format!("{} of 12", room(Rect::new(0, 0, 38, 10)))), "{frame}");
    }

    #[test]
    fn grids_fill_the_area_without_overlap() {
        for (width, height) in [(72, 14), (20, 40), (5, 5), (0, 0)] {
            for count in 1..=16 {
                let cells = grid(Rect::new(3, 2, width, height), count);
                assert_eq!(cells.len(), count);
                for (i, a) in cells.iter().enumerate() {
                    assert!(a.right() <= 3 + width && a.bottom() <= 2 + height);
                    assert!(cells[i + 1..].iter().all(|b| a.is_empty() || !a.intersects(*b)));
                }
            }
        }
    }
}
