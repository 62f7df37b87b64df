//! Critical speeds that a motion at a changing speed shows: peaks of its first order over each leg, beside those of the steady
//! response.

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
/// The same about each of its peaks, over twice its half-power width: with eighty to a width a parabola is within 1e-6 of the height of a
/// resonance, and straight lines between them within 1e-4 of its width.
const PEAK_POINTS: usize = 160;

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
    ) -> Vec<Critical> {
        let mut criticals = Vec::new();
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
            let steady = settings(leg).map_or(Vec::new(), |settings| steady_peaks(rotor, settings, *speed));
            let first = criticals.len();
            for (station, height) in readings.first.iter().enumerate() {
                let mut found = peaks(&readings.speed, height);
                found.retain(|peak| peak.width > narrow && readings.rest[station][peak.at] < peak.height);
                let steady = steady.get(station).map_or(&[][..], |peaks| peaks);
                drop_beats(&mut found, steady, is_down);
                for peak in &found {
                    // Each is the other's nearest.
                    let mine = nearest(steady, peak).filter(|s| nearest(&found, s).is_some_and(|p| p.at == peak.at));
                    criticals.push(Critical { leg, station, peak: *peak, steady: mine.copied() });
                }
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
fn steady_peaks(rotor: &Rotor, settings: &Settings, [from, to]: [f64; 2]) -> Vec<Vec<ResonancePeak>> {
    let over = steady_grid(from.min(to), from.max(to));
    let Some((speeds, heights)) = followed(rotor, settings, over, from > to) else {
        return Vec::new();
    };
    let refined = |station: usize, peak: ResonancePeak| {
        let [Some(low), Some(high)] = peak.half_power else { return peak };
        let margin = 0.5 * (high - low);
        let closer = followed(rotor, settings, grid((low - margin).max(0.0), high + margin, PEAK_POINTS), from > to);
        let found = closer.map(|(speeds, heights)| peaks(&speeds, &heights[station]));
        let near = |p: &ResonancePeak| (p.speed - peak.speed).abs();
        found.and_then(|found| found.into_iter().min_by(|a, b| near(a).total_cmp(&near(b)))).unwrap_or(peak)
    };
    let all = heights.iter().enumerate();
    all.map(|(station, height)| peaks(&speeds, height).into_iter().map(|peak| refined(station, peak)).collect())
        .collect()
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
/// where no orbit is stable.
pub(super) fn followed(
    rotor: &Rotor,
    settings: &Settings,
    speeds: Vec<f64>,
    downward: bool,
) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let found = circular::synchronous(rotor, &settings.feedback, &settings.deadband, &speeds).ok()?;
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
