//! Critical speeds that a motion at a changing speed shows: peaks of its first order over each leg, beside those of the steady
//! response.

use std::sync::atomic::{AtomicBool, Ordering};

use rotor::circular::{self, Orbit};
use rotor::{Rotor, Settings};
use spectrum::{PER_TURN, Revolution};

use super::peaks::{ResonancePeak, peaks};

/// A beat is so many times as narrow as the critical speed whose passage it tells of.
const SHARPER: f64 = 2.0;
/// Peaks that are not so many turns wide are ripple.
const NARROW_TURNS: usize = 2;
/// Speeds at which the steady response is looked at over a leg.
const STEADY_POINTS: usize = 400;
/// The same to the half-power width of a peak, over twice that: a parabola is within 1e-6 of the height of a resonance then, and straight
/// lines between them within 1e-4 of its width.
const POINTS_A_WIDTH: f64 = 80.0;
/// No more than these, where a sharp peak lies on the flank of a wide one.
const MOST_POINTS: f64 = 2000.0;

/// A critical speed: a peak of the first order at a station.
#[derive(Clone, Debug, PartialEq)]
pub struct Critical {
    /// On which leg of the profile, counted from 0.
    pub leg: usize,
    /// At which station, counted from 0.
    pub station: usize,
    /// Where, how high and how sharp.
    pub peak: ResonancePeak,
    /// The peak of the steady response at this station that is nearest to it, if it is the nearest to that one too.
    pub steady: Option<ResonancePeak>,
}

/// What the speed does over a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Course {
    /// It stays as it is.
    Rests,
    /// It changes as it is told to.
    Given,
    /// It changes as a torque makes it, which whirl may hold back.
    Driven,
}

/// A leg that was gone through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passed {
    /// When it ended.
    pub(super) until: f64,
    /// The speeds at which it began and ended.
    pub(super) speed: [f64; 2],
    pub(super) course: Course,
}

/// What was read over a whole motion: times, speeds, and of every station the first order and the rest; one reading in so many.
#[derive(Clone, Debug, Default)]
pub(super) struct Readings {
    tau: Vec<f64>,
    speed: Vec<f64>,
    first: Vec<Vec<f64>>,
    rest: Vec<Vec<f64>>,
    /// One reading in so many of those that there are is kept.
    pub(super) every: u64,
}

impl Readings {
    pub(super) fn new(stations: usize, every: u64) -> Self {
        let each = vec![Vec::new(); stations];
        Self { tau: Vec::new(), speed: Vec::new(), first: each.clone(), rest: each, every }
    }

    pub(super) fn len(&self) -> usize {
        self.tau.len()
    }

    pub(super) fn push(&mut self, turn: &Revolution) {
        self.tau.push(turn.tau);
        self.speed.push(turn.speed);
        self.first.iter_mut().zip(&turn.first_order).for_each(|(to, first)| to.push(first.norm()));
        self.rest.iter_mut().zip(&turn.rest).for_each(|(to, rest)| to.push(*rest));
    }

    /// Keeps every other one, and from now on half as many.
    pub(super) fn thin(&mut self) {
        let columns = [&mut self.tau, &mut self.speed].into_iter().chain(&mut self.first).chain(&mut self.rest);
        for column in columns {
            let mut place = 0;
            column.retain(|_| {
                place += 1;
                place % 2 == 1
            });
        }
        self.every *= 2;
    }

    /// Those whose middle lies within a time, the speed rising if `reversed` says that it falls.
    fn part(&self, from: f64, until: f64, reversed: bool) -> Self {
        let range = self.tau.partition_point(|tau| *tau <= from)..self.tau.partition_point(|tau| *tau <= until);
        let cut = |column: &Vec<f64>| {
            let mut part = column[range.clone()].to_vec();
            if reversed {
                part.reverse();
            }
            part
        };
        Self {
            tau: cut(&self.tau),
            speed: cut(&self.speed),
            first: self.first.iter().map(cut).collect(),
            rest: self.rest.iter().map(cut).collect(),
            every: self.every,
        }
    }

    /// Critical speeds leg by leg, rising in speed; `settings` are those of a leg.
    pub(super) fn criticals<'s>(
        &self,
        rotor: &Rotor,
        legs: &[Passed],
        settings: &dyn Fn(usize) -> Option<&'s Settings>,
        stop: &AtomicBool,
    ) -> Vec<Critical> {
        let mut criticals: Vec<Critical> = Vec::new();
        // A whirl of its own ripples the first order from turn to turn: narrower than some turns, or less than the rest, is no
        // critical speed.
        let narrow = NARROW_TURNS * PER_TURN / self.every as usize;
        let mut from = f64::NEG_INFINITY;
        for (leg, Passed { until, speed, course }) in legs.iter().enumerate() {
            let is_down = speed[0] > speed[1];
            let begins = std::mem::replace(&mut from, *until);
            // What is read after the end belongs to the last leg.
            let until = if leg + 1 == legs.len() { f64::INFINITY } else { *until };
            if *course == Course::Rests || speed[0] == speed[1] {
                continue;
            }
            let readings = self.part(begins, until, is_down);
            // A drive that whirl holds back goes to and fro: there are no heights over speed.
            if *course == Course::Driven && !readings.speed.is_sorted() {
                continue;
            }
            let mut moved: Vec<Vec<ResonancePeak>> =
                readings.first.iter().map(|height| peaks(&readings.speed, height)).collect();
            for (found, rest) in moved.iter_mut().zip(&readings.rest) {
                found.retain(|peak| peak.width > narrow && rest[peak.at] < peak.height);
            }
            // Nothing to set the steady response beside.
            if moved.iter().all(Vec::is_empty) {
                continue;
            }
            let steady = settings(leg).map_or(Vec::new(), |settings| steady_peaks(rotor, settings, *speed, stop));
            let first = criticals.len();
            for (station, mut found) in moved.into_iter().enumerate() {
                let steady = steady.get(station).map_or(&[][..], |peaks| peaks);
                drop_beats(&mut found, steady, is_down);
                for peak in &found {
                    // Each is the other's nearest.
                    let mine = nearest(steady, peak).filter(|s| nearest(&found, s).is_some_and(|p| p.at == peak.at));
                    criticals.push(Critical { leg, station, peak: *peak, steady: mine.copied() });
                }
            }
            if let Some(settings) = settings(leg) {
                refine(rotor, settings, is_down, &mut criticals[first..], stop);
            }
            criticals[first..].sort_by(|a, b| a.peak.speed.total_cmp(&b.peak.speed));
        }
        criticals
    }
}

/// Drops peaks that are the beat of a critical speed passed: no steady peak is theirs, and they are lower and much sharper than one before
/// them on the way.
fn drop_beats(found: &mut Vec<ResonancePeak>, steady: &[ResonancePeak], downward: bool) {
    let all = found.clone();
    let has_steady = |peak: &ResonancePeak| {
        nearest(steady, peak).and_then(|s| nearest(&all, s)).is_some_and(|mine| mine.at == peak.at)
    };
    let is_before = |a: &ResonancePeak, b: &ResonancePeak| if downward { a.speed > b.speed } else { a.speed < b.speed };
    let width = |peak: &ResonancePeak| peak.width as f64;
    found.retain(|peak| {
        has_steady(peak)
            || !all.iter().any(|other| {
                is_before(other, peak) && other.height > peak.height && width(other) > SHARPER * width(peak)
            })
    });
}

/// The one of `peaks` whose speed is nearest to that of `peak`.
fn nearest<'p>(peaks: &'p [ResonancePeak], peak: &ResonancePeak) -> Option<&'p ResonancePeak> {
    let distance = |p: &&ResonancePeak| (p.speed - peak.speed).abs();
    peaks.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Peaks of the steady response between two speeds, per station: along the stable orbits that lie nearest to each other in the
/// order in which the leg passes them. None where it cannot be had.
fn steady_peaks(
    rotor: &Rotor,
    settings: &Settings,
    [from, to]: [f64; 2],
    stop: &AtomicBool,
) -> Vec<Vec<ResonancePeak>> {
    let over = steady_grid(from.min(to), from.max(to));
    let Some((speeds, heights)) = followed(rotor, settings, over, from > to, stop) else {
        return Vec::new();
    };
    heights.iter().map(|height| peaks(&speeds, height)).collect()
}

/// Makes the steady peaks of critical speeds as sharp as they are: looked at anew, closely, over twice their half-power widths. Stations
/// peak at nearly the same speeds, and what lies together is looked at once.
fn refine(rotor: &Rotor, settings: &Settings, is_down: bool, criticals: &mut [Critical], stop: &AtomicBool) {
    struct Stretch {
        ends: [f64; 2],
        narrowest: f64,
        of: Vec<usize>,
    }
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut each: Vec<Stretch> = (criticals.iter().enumerate())
        .filter_map(|(k, critical)| {
            let [Some(low), Some(high)] = critical.steady?.half_power else { return None };
            let width = high - low;
            Some(Stretch { ends: [(low - 0.5 * width).max(0.0), high + 0.5 * width], narrowest: width, of: vec![k] })
        })
        .collect();
    each.sort_by(|a, b| a.ends[0].total_cmp(&b.ends[0]));
    for next in each {
        match stretches.last_mut() {
            Some(last) if next.ends[0] <= last.ends[1] => {
                last.ends[1] = last.ends[1].max(next.ends[1]);
                last.narrowest = last.narrowest.min(next.narrowest);
                last.of.extend(next.of);
            }
            _ => stretches.push(next),
        }
    }
    for Stretch { ends: [low, high], narrowest, of } in stretches {
        let count = (POINTS_A_WIDTH * (high - low) / narrowest).ceil().clamp(2.0, MOST_POINTS) as usize;
        let Some((speeds, heights)) = followed(rotor, settings, grid(low, high, count), is_down, stop) else {
            continue;
        };
        for k in of {
            let Critical { station, steady: Some(coarse), .. } = &criticals[k] else { continue };
            let found = peaks(&speeds, &heights[*station]);
            if let Some(sharp) = nearest(&found, coarse) {
                criticals[k].steady = Some(*sharp);
            }
        }
    }
}

/// Evenly spaced speeds, two at least.
fn grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect()
}

/// Evenly spaced speeds at which the steady response over a whole leg is looked at.
pub(super) fn steady_grid(low: f64, high: f64) -> Vec<f64> {
    grid(low, high, STEADY_POINTS)
}

/// Radii per station over rising `speeds`; `downward` says that the orbits are followed from the highest speed down. Not a number
/// where no orbit is stable. Nothing once `stop` is set.
pub(super) fn followed(
    rotor: &Rotor,
    settings: &Settings,
    speeds: Vec<f64>,
    downward: bool,
    stop: &AtomicBool,
) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let stop = || stop.load(Ordering::Relaxed);
    let found = circular::synchronous_orbits(rotor, &settings.feedback, &settings.deadband, &speeds, &stop).ok()?;
    let mut heights = vec![vec![f64::NAN; speeds.len()]; rotor.len()];
    let mut before: Option<Vec<f64>> = None;
    let mut order: Vec<usize> = (0..speeds.len()).collect();
    if downward {
        order.reverse();
    }
    for at in order {
        let stable = found.orbits[at].iter().filter(|orbit| orbit.is_stable()).map(Orbit::radii);
        let distance = |radii: &Vec<f64>| match &before {
            Some(before) => radii.iter().zip(before).map(|(a, b)| (a - b).powi(2)).sum::<f64>(),
            // The smallest comes first.
            None => 0.0,
        };
        let Some(radii) = stable.min_by(|a, b| distance(a).total_cmp(&distance(b))) else { continue };
        heights.iter_mut().zip(&radii).for_each(|(height, radius)| height[at] = *radius);
        before = Some(radii);
    }
    Some((speeds, heights))
}
