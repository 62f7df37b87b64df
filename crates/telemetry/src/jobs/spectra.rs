//! Full spectra of the steps before a moment, and rows of them for waterfalls.

use std::ops::Range;

use rotor::C64;
use spectrum::{Peak, Spectrum, SpectrumError, Welch, welch};

use crate::history::Track;

/// Steps that a spectrum looks back at most: 65 s at 1000 steps a second.
const MOST: usize = 1 << 16;
/// Steps that it looks back if no more are in view.
const USUAL: usize = 1 << 14;
/// Steps of a row of a waterfall.
const ROW: usize = 1 << 12;
/// How far the time between two steps may differ from that between others, as a share of it.
const EVEN: f64 = 1e-6;

/// What is asked of an orbit: its spectrum over the steps up to a place.
#[derive(Clone, Debug)]
pub struct SpectrumRequest {
    track: Track,
    mass: usize,
    /// Place in the history after the last step.
    end: u64,
    /// Steps to look back.
    back: usize,
}

impl PartialEq for SpectrumRequest {
    /// Places are never used twice: the same places hold the same steps.
    fn eq(&self, other: &Self) -> bool {
        (self.mass, self.end, self.back) == (other.mass, other.end, other.back)
    }
}

impl SpectrumRequest {
    /// The orbit of `mass` up to step `now` of `track`, over `view` steps or what is usual. The end moves on in strides,
    /// ten a second if steps are `seconds` apart, so that it is not asked anew for every frame.
    pub fn until(track: &Track, mass: usize, now: usize, view: usize, seconds: f64) -> Self {
        let stride = if seconds > 0.0 { (0.1 / seconds).clamp(1.0, 1e6) as u64 } else { 1 };
        let after = track.index_of(now) + 1;
        // The first steps are shown as they come.
        let end = (after / stride * stride).max(track.index_of(0));
        let back = view.clamp(USUAL, MOST).next_power_of_two().min(MOST);
        Self { track: track.clone(), mass, end: if end == track.index_of(0) { after } else { end }, back }
    }

    /// The steps to look at: as many as are evenly spaced in time. And the time between them.
    fn even(&self, over: Range<usize>) -> (Range<usize>, f64) {
        let track = &self.track;
        if over.len() < 2 {
            return (over, 0.0);
        }
        let apart = track.tau(over.end - 1) - track.tau(over.end - 2);
        let mut start = over.end - 1;
        while start > over.start && ((track.tau(start) - track.tau(start - 1)) - apart).abs() <= EVEN * apart {
            start -= 1;
        }
        (start..over.end, apart)
    }

    fn samples(&self, steps: Range<usize>) -> Vec<C64> {
        steps
            .map(|step| {
                let [y, z] = self.track.displacement(step, self.mass);
                C64::new(y, z)
            })
            .collect()
    }

    fn index_of_end(&self) -> usize {
        (self.end - self.track.index_of(0)) as usize
    }
}

/// The spectrum of an orbit, and its highest lines.
#[derive(Clone, Debug)]
pub struct OrbitSpectrum {
    /// Density over frequency, or why there is none.
    pub spectrum: Result<Spectrum, SpectrumError>,
    /// Its highest lines.
    pub peaks: Vec<Peak>,
    /// How long it looks back, in units of `tau`.
    pub tau: f64,
}

impl OrbitSpectrum {
    /// Welch's estimate from three half overlapping segments or more: a compromise between telling lines apart and being
    /// up to date.
    pub fn of(orbit: &SpectrumRequest) -> Self {
        let end = orbit.index_of_end();
        let (steps, apart) = orbit.even(end.saturating_sub(orbit.back)..end);
        let tau = steps.len() as f64 * apart;
        let segment = if steps.is_empty() { 0 } else { 1 << (steps.len() / 2).max(1).ilog2() };
        let speed = steps.clone().last().map_or(0.0, |last| orbit.track.speed(last));
        let spectrum = welch(&orbit.samples(steps), apart, segment);
        let peaks = spectrum.as_ref().map_or_else(|_| Vec::new(), |spectrum| spectrum.peaks(speed));
        Self { spectrum, peaks, tau }
    }
}

/// What the rows of a waterfall are sorted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaterfallOrder {
    /// The moment of their last step.
    Time,
    /// The mean spin speed of their steps.
    Speed,
}

/// What is asked for a waterfall.
#[derive(Clone, Debug, PartialEq)]
pub struct WaterfallRequest {
    /// The steps of the last row.
    pub orbit: SpectrumRequest,
    /// What the rows are sorted by.
    pub over: WaterfallOrder,
    /// How many rows.
    pub rows: usize,
    /// Steps from row to row.
    pub hop: usize,
    /// The highest frequency shown.
    pub reach: f64,
}

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub struct WaterfallRow {
    /// Place in the history after its last step.
    pub end: u64,
    /// Mean spin speed.
    pub speed: f64,
    /// Density from `-reach` to `reach`, in bins of equal width.
    pub density: Vec<f64>,
}

/// Rows of spectra: oldest first, or slowest first.
#[derive(Clone, Debug)]
pub struct Waterfall {
    /// The rows.
    pub rows: Vec<WaterfallRow>,
    /// The speeds that rows over speed stand for: one more than rows asked for.
    pub edges: Vec<f64>,
    /// Steps without a restart or a loss up to the end of what was asked for: a row needs [`WaterfallRow::STEPS`].
    pub longest: usize,
}

impl WaterfallRow {
    /// The steps that a row is made of.
    pub const STEPS: usize = ROW;
}

impl Waterfall {
    /// Computes the rows: some milliseconds for sixty.
    pub fn of(fall: &WaterfallRequest) -> Self {
        let ends = Self::ends(fall);
        let end = fall.orbit.index_of_end();
        let longest = fall.orbit.even(end.saturating_sub(ROW)..end).0.len();
        let mut welch = Welch::new(ROW);
        match fall.over {
            WaterfallOrder::Time => Self {
                rows: ends.iter().filter_map(|end| row(fall, *end, &mut welch)).collect(),
                edges: vec![],
                longest,
            },
            WaterfallOrder::Speed => {
                let speeds: Vec<f64> = ends.iter().map(|end| mean_speed(fall, *end)).collect();
                let [low, high] = speeds
                    .iter()
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], speed| [low.min(*speed), high.max(*speed)]);
                let share = (high - low).max(1e-9) / fall.rows.max(1) as f64;
                let edges: Vec<f64> = (0..=fall.rows).map(|at| low + share * at as f64).collect();
                let newest = |at: usize| {
                    let here = |speed: f64| (((speed - low) / share) as usize).min(fall.rows - 1) == at;
                    let end = ends.iter().zip(&speeds).rev().find(|(_, speed)| here(**speed))?;
                    row(fall, *end.0, &mut welch)
                };
                Self { rows: (0..fall.rows).filter_map(newest).collect(), edges, longest }
            }
        }
    }

    /// Where rows end, by index in the track, oldest first. On places that stay while time goes on.
    fn ends(fall: &WaterfallRequest) -> Vec<usize> {
        let (first, hop) = (fall.orbit.track.index_of(0), fall.hop.max(1) as u64);
        let newest = fall.orbit.end / hop;
        let count = match fall.over {
            WaterfallOrder::Time => fall.rows as u64,
            // Speeds may come back: many more than rows are looked at.
            WaterfallOrder::Speed => u64::MAX,
        };
        let oldest = newest.saturating_sub(count.saturating_sub(1)).max((first + ROW as u64).div_ceil(hop));
        (oldest..=newest).map(|at| (at * hop).saturating_sub(first) as usize).filter(|end| *end >= ROW).collect()
    }
}

fn mean_speed(fall: &WaterfallRequest, end: usize) -> f64 {
    let track = &fall.orbit.track;
    0.5 * (track.speed(end - ROW) + track.speed(end - 1))
}

/// The spectrum of the steps before `end`; none across a restart or a loss.
fn row(fall: &WaterfallRequest, end: usize, welch: &mut Welch) -> Option<WaterfallRow> {
    let orbit = &fall.orbit;
    let (steps, apart) = orbit.even(end - ROW..end);
    if steps.len() < ROW {
        return None;
    }
    let spectrum = welch.spectrum(&orbit.samples(steps), apart).ok()?;
    let within = |frequency: f64| frequency.abs() <= fall.reach;
    let density = spectrum.frequency.iter().zip(&spectrum.density).filter(|(f, _)| within(**f)).map(|(_, d)| *d);
    Some(WaterfallRow {
        end: orbit.track.index_of(0) + end as u64,
        speed: mean_speed(fall, end),
        density: density.collect(),
    })
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use wire::{Point, Step};

    use super::*;
    use crate::feed::Feed;
    use crate::frame_data::FrameData;
    use crate::test_support as tests;
    use crate::view_time::ViewTime;

    /// Steps with a forward line of radius 2 at 1X, a backward one of 0.5 at 0.5X, and the speed `speed(seq)`.
    fn frame_data(steps: u64, speed: impl Fn(u64) -> f64) -> FrameData {
        let now = Instant::now();
        let mut feed = Feed::new("");
        feed.push_bench_status(tests::bench_status("three-mass", "composite"));
        for seq in 0..steps {
            let state = tests::state(3, seq);
            let p = C64::from_polar(2.0, 2.5 * state.tau()) + C64::from_polar(0.5, -1.25 * state.tau());
            let state = state.with_point(0, Point { y: p.re, z: p.im, ..Point::default() });
            feed.push_step(&state.with(wire::Channel::Speed, 0, speed(seq)), now);
        }
        feed.frame_data(&ViewTime::LIVE, now)
    }

    fn spectrum(data: &FrameData) -> OrbitSpectrum {
        let orbit = SpectrumRequest::until(&data.track, 0, data.now.unwrap(), data.window.len(), data.seconds);
        OrbitSpectrum::of(&orbit)
    }

    #[test]
    fn lines_of_the_orbit_are_named_and_measured() {
        let found = spectrum(&frame_data(20_000, |_| 2.5));
        let named: Vec<(&str, f64)> = found.peaks.iter().take(2).map(|peak| (&*peak.name, peak.radius)).collect();
        assert_eq!([named[0].0, named[1].0], ["1X", "-0.5X"]);
        assert!((named[0].1 - 2.0).abs() < 0.01 && (named[1].1 - 0.5).abs() < 0.01, "{named:?}");
        assert!((found.tau - 163.84).abs() < 0.1, "{}", found.tau);
    }

    #[test]
    fn what_was_before_a_restart_is_another_motion() {
        let now = Instant::now();
        let mut feed = Feed::new("");
        (0..5000).for_each(|seq| feed.push_step(&tests::state(3, seq), now));
        (5000..6000)
            .for_each(|seq| feed.push_step(&tests::state(3, seq - 5000).with_word(wire::Channel::Seq, seq), now));
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let found = spectrum(&data);
        assert!((found.tau - 10.0).abs() < 0.2, "{}", found.tau);
        let few = |steps| spectrum(&self::frame_data(steps, |_| 2.5)).spectrum;
        assert_eq!(few(30), Err(SpectrumError::TooFew(30)));
        assert_eq!(few(1), Err(SpectrumError::TooFew(1)));
    }

    #[test]
    fn a_question_changes_ten_times_a_second() {
        let whole = frame_data(3000, |_| 2.5);
        let ask = |now| SpectrumRequest::until(&whole.track, 0, now, 4000, 1e-3);
        assert_eq!(ask(2000), ask(2050));
        assert_ne!(ask(2000), ask(2101));
        assert_ne!(ask(2000), SpectrumRequest::until(&whole.track, 1, 2000, 4000, 1e-3));
    }

    fn fall(data: &FrameData, over: WaterfallOrder, rows: usize) -> Waterfall {
        let orbit = SpectrumRequest::until(&data.track, 0, data.now.unwrap(), 0, data.seconds);
        Waterfall::of(&WaterfallRequest { orbit, over, rows, hop: 1000, reach: 6.0 })
    }

    #[test]
    fn rows_follow_each_other_in_time_on_places_that_stay() {
        let ends = |steps| {
            fall(&frame_data(steps, |_| 2.5), WaterfallOrder::Time, 8)
                .rows
                .iter()
                .map(|row| row.end)
                .collect::<Vec<_>>()
        };
        assert_eq!(ends(20_000), [13_000, 14_000, 15_000, 16_000, 17_000, 18_000, 19_000, 20_000]);
        assert_eq!(ends(20_400), ends(20_000));
        assert_eq!(ends(6000), [5000, 6000], "a row needs its steps");
        assert!(ends(100).is_empty());
    }

    #[test]
    fn rows_over_speed_are_the_newest_at_each() {
        // Up from 1 to 3 in twenty seconds, and down again in ten.
        let speed = |seq: u64| if seq < 20_000 { 1.0 + seq as f64 / 1e4 } else { 3.0 - (seq - 20_000) as f64 / 5e3 };
        let found = fall(&frame_data(30_000, speed), WaterfallOrder::Speed, 4);
        assert_eq!((found.rows.len(), found.edges.len()), (4, 5));
        assert!(found.rows.is_sorted_by(|a, b| a.speed < b.speed));
        assert!(found.rows.is_sorted_by(|a, b| a.end > b.end), "going down came last, and passed the slow ones last");
        let steady = fall(&frame_data(9000, |_| 2.5), WaterfallOrder::Speed, 4);
        assert_eq!(steady.rows.len(), 1);
    }
}
