//! Many runs at once: those of chains under ideal loops at steady speeds go side by side in the lanes of [`rotor::batch`], on all cores, each
//! to its own end, and the next takes its place; the others go one by one. What comes out of a run is the same to the last bit either way.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;
use rotor::batch::{Batch, Extremes};
use rotor::{C64, ClosedLoop};

use crate::run::{Extent, Plan, RunError, Settle, extent, kept, orbit_limit, window_of};
use crate::settle::{Detector, Settled, Stretch};

/// Samples between two looks at whether to stop.
const UNINTERRUPTED: u64 = 1 << 14;

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ended {
    pub(crate) extent: Extent,
    /// Its last sample, where the run was in a batch.
    pub(crate) last: Option<Last>,
}

/// The last sample of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Last {
    /// Steps that it took, and how long each was.
    pub(crate) steps: u64,
    pub(crate) dtau: f64,
    pub(crate) displacement: Vec<C64>,
    pub(crate) velocity: Vec<C64>,
}

/// Runs `count` plans and hands each, as it ends, to `take` with its number, from any thread. `plan` makes them; a number that it makes
/// no plan of is left out.
///
/// # Errors
/// The first thing that a plan, a run or `take` fails with, or `stop`.
pub(crate) fn many<E: From<RunError> + Send>(
    count: usize,
    plan: &(dyn Fn(usize) -> Result<Option<Plan>, E> + Sync),
    take: &(dyn Fn(usize, &Plan, Ended) -> Result<(), E> + Sync),
    stop: &AtomicBool,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let worker = |_| {
        let done = work(count, &next, plan, take, [stop, &failed]);
        if done.is_err() {
            failed.store(true, Ordering::Relaxed);
        }
        done
    };
    (0..rayon::current_num_threads()).into_par_iter().with_max_len(1).map(worker).collect::<Result<(), E>>()
}

/// Takes plans until there are no more.
fn work<E: From<RunError>>(
    count: usize,
    next: &AtomicUsize,
    plan: &(dyn Fn(usize) -> Result<Option<Plan>, E> + Sync),
    take: &(dyn Fn(usize, &Plan, Ended) -> Result<(), E> + Sync),
    [stop, failed]: [&AtomicBool; 2],
) -> Result<(), E> {
    let mut side_by_side: Option<SideBySide> = None;
    let mut waiting: Option<(usize, Plan)> = None;
    let mut is_over = false;
    loop {
        if stop.load(Ordering::Relaxed) {
            return Err(RunError::Interrupted.into());
        }
        if failed.load(Ordering::Relaxed) {
            // Another thread says why.
            return Ok(());
        }
        // Lanes that are free get a run, where runs can begin.
        while !is_over && side_by_side.as_ref().is_none_or(SideBySide::has_room) {
            let (index, plan) = match waiting.take() {
                Some(waiting) => waiting,
                None => {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    is_over = index >= count;
                    match if is_over { None } else { plan(index)? } {
                        Some(plan) => (index, plan),
                        None => continue,
                    }
                }
            };
            let Some(closed_loop) = batched(&plan) else {
                let found = extent(&plan, stop)?;
                take(index, &plan, Ended { extent: found, last: None })?;
                continue;
            };
            let masses = closed_loop.masses();
            match &mut side_by_side {
                Some(lanes) if lanes.masses == masses => lanes.start(index, plan),
                Some(lanes) if !lanes.is_idle() => {
                    // Another number of masses waits for those to end.
                    waiting = Some((index, plan));
                    break;
                }
                _ => side_by_side.insert(SideBySide::new(masses)).start(index, plan),
            }
        }
        let Some(lanes) = side_by_side.as_mut().filter(|lanes| !lanes.is_idle()) else {
            if is_over && waiting.is_none() {
                return Ok(());
            }
            continue;
        };
        for (index, plan, ended) in lanes.advance(is_over) {
            take(index, &plan, ended)?;
        }
    }
}

/// The equations of a run that can be in a batch.
fn batched(plan: &Plan) -> Option<&ClosedLoop> {
    let steps = plan.duration / plan.dtau;
    let is_short = steps.is_finite() && steps <= crate::run::MOST_STEPS && plan.duration > 0.0;
    plan.program.steady_loop().filter(|_| plan.impulses.is_empty() && is_short)
}

/// Runs in the lanes of a batch.
struct SideBySide {
    masses: usize,
    batch: Batch,
    lanes: Vec<Option<Lane>>,
}

/// A run in a lane.
struct Lane {
    index: usize,
    plan: Plan,
    dtau: f64,
    /// The number of its last sample.
    last: u64,
    /// Samples taken.
    taken: u64,
    /// Samples taken since its extremes were.
    kept: u64,
    /// The number of the sample after which something happens.
    event: u64,
    window: f64,
    /// Where the present window began.
    from: f64,
    detector: Detector,
}

impl SideBySide {
    fn new(masses: usize) -> Self {
        let batch = Batch::new(masses);
        let lanes = (0..batch.lanes()).map(|_| None).collect();
        Self { masses, batch, lanes }
    }

    fn is_idle(&self) -> bool {
        self.lanes.iter().all(Option::is_none)
    }

    /// Whether a run can begin now.
    fn has_room(&self) -> bool {
        self.is_idle() || self.batch.until_start() == 0 && self.lanes.iter().any(Option::is_none)
    }

    fn start(&mut self, index: usize, plan: Plan) {
        let (Some(place), Some(closed_loop)) =
            (self.lanes.iter().position(Option::is_none), plan.program.steady_loop())
        else {
            return;
        };
        // Only of an idle batch: lanes at rest go on to where a run can begin.
        self.batch.run(self.batch.until_start());
        let (count, dtau) = plan.even_steps(plan.duration);
        let start = plan.start.as_ref().map_or([&[][..], &[][..]], |[p, v]| [p, v]);
        self.batch.start(place, closed_loop, start, dtau, orbit_limit(&plan));
        let mut lane = Lane {
            index,
            dtau,
            last: count as u64,
            taken: 0,
            kept: 0,
            event: 0,
            window: window_of(&plan),
            from: 0.0,
            detector: Detector::new(self.masses),
            plan,
        };
        lane.event = lane.next_event();
        self.lanes[place] = Some(lane);
    }

    /// Goes on to the next thing that happens in any lane. Returns the runs that have ended.
    fn advance(&mut self, is_over: bool) -> Vec<(usize, Plan, Ended)> {
        let running = || self.lanes.iter().flatten();
        let until_event = running().map(|lane| lane.event + 1 - lane.taken).min().unwrap_or(1);
        let has_room = !is_over && self.lanes.iter().any(Option::is_none);
        let until_start = if has_room { self.batch.until_start().max(1) as u64 } else { UNINTERRUPTED };
        let wanted = until_event.min(until_start).min(UNINTERRUPTED) as usize;
        let ran = self.batch.run(wanted);
        let mut ended = Vec::new();
        for (k, place) in self.lanes.iter_mut().enumerate() {
            let Some(lane) = place else { continue };
            lane.taken += ran as u64;
            lane.kept += ran as u64;
            let found = if ran < wanted && !self.batch.is_bounded(k) {
                Some(lane.diverged(&mut self.batch, k))
            } else if ran > 0 && lane.taken == lane.event + 1 {
                lane.happen(&mut self.batch, k)
            } else {
                None
            };
            if let Some(found) = found {
                self.batch.stop(k);
                ended.extend(place.take().map(|lane| (lane.index, lane.plan, found)));
            }
        }
        ended
    }
}

impl Lane {
    fn tau(&self, sample: u64) -> f64 {
        sample as f64 * self.dtau
    }

    /// Whether extremes are still to be kept from `from` on.
    fn waits(&self, from: f64) -> bool {
        self.from < from - 1e-9
    }

    /// The first sample from now on at which `tau` is at least `at`.
    fn first_at(&self, at: f64) -> u64 {
        let mut sample = ((at / self.dtau).floor() as u64).saturating_sub(1).max(self.taken);
        while self.tau(sample) < at {
            sample += 1;
        }
        sample
    }

    /// The sample after which something happens next: the end, a window's, or the moment from which extremes are kept.
    fn next_event(&self) -> u64 {
        let event = match self.plan.settle {
            Settle::From(from) if self.waits(from) => self.first_at(from - 1e-9).saturating_sub(1),
            Settle::From(_) => self.last,
            Settle::Detect | Settle::DetectAndStop => self.first_at(self.from + self.window),
        };
        event.max(self.taken).min(self.last)
    }

    /// What was kept since it was taken last.
    fn stretch(&mut self, batch: &mut Batch, place: usize) -> Stretch {
        let Extremes { maxima, radius_sums } = batch.take(place);
        let mut stretch = Stretch::new(self.from);
        stretch.maxima[0] = maxima[0];
        stretch.maxima[3..].copy_from_slice(&maxima[1..]);
        stretch.radius_sum = radius_sums;
        stretch.samples = std::mem::take(&mut self.kept);
        stretch
    }

    /// After the sample of an event; the end, if it is one.
    fn happen(&mut self, batch: &mut Batch, place: usize) -> Option<Ended> {
        let (sample, tau) = (self.event, self.tau(self.event));
        let mut is_settled = false;
        match self.plan.settle {
            Settle::From(from) if self.waits(from) => {
                // Nothing that was before counts.
                self.stretch(batch, place);
                batch.break_off(place);
                self.from = from;
            }
            Settle::From(_) => {}
            Settle::Detect | Settle::DetectAndStop => {
                if tau >= self.from + self.window {
                    let window = self.stretch(batch, place);
                    self.from = tau;
                    is_settled = self.detector.push(window) && self.plan.settle == Settle::DetectAndStop;
                }
            }
        }
        if is_settled || sample == self.last {
            return Some(self.end(batch, place, None, sample));
        }
        self.event = self.next_event();
        None
    }

    /// Before a sample that is not bounded.
    fn diverged(&mut self, batch: &mut Batch, place: usize) -> Ended {
        let tau = self.tau(self.taken);
        let is_detected = !matches!(self.plan.settle, Settle::From(_));
        if is_detected && tau >= self.from + self.window {
            let window = self.stretch(batch, place);
            self.from = tau;
            self.detector.push(window);
        }
        self.end(batch, place, Some(tau), self.taken)
    }

    fn end(&mut self, batch: &mut Batch, place: usize, diverged_at: Option<f64>, steps: u64) -> Ended {
        let never_kept = matches!(self.plan.settle, Settle::From(from) if self.waits(from));
        let stretch = self.stretch(batch, place);
        let stretch = if never_kept { Stretch::new(self.from) } else { stretch };
        let (settled, kept): (Settled, Stretch) =
            kept(self.plan.settle, &self.detector, stretch, diverged_at.is_some());
        let [displacement, velocity] = batch.last(place);
        Ended {
            extent: Extent::of(settled, diverged_at, &kept, self.masses()),
            last: Some(Last { steps, dtau: self.dtau, displacement, velocity }),
        }
    }

    fn masses(&self) -> usize {
        self.plan.program.order()
    }
}
