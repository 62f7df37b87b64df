//! From what a bench sends to what is put on tape: steps into batches, losses noticed by their numbers, runs kept apart.
//!
//! It holds no more than [`Gatherer::MOST_ROWS`] steps. While the writer is further behind than that, new steps are let
//! go; the gap in the numbers is then noticed like any other and stands in the recording.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use wire::{BenchStatus, Event, Moment, Step};

use crate::batch::Batch;
use crate::event::{Remark, What};
use crate::sink::Item;
use crate::snapshot::Snapshot;

/// Gathers what a bench sends.
#[derive(Debug)]
pub(crate) struct Gatherer {
    run_id: Option<u64>,
    /// The first bench status of the run has come, and what is gathered can go on tape.
    begun: bool,
    batch: Batch,
    opened: Instant,
    last: Option<Moment>,
    /// The number of the first step that was heard, of whichever run.
    first: Option<u64>,
    /// In the order in which it goes on tape.
    out: VecDeque<Item>,
    /// Of a run that has not begun: it follows the head.
    held: VecDeque<Item>,
    /// Steps in both.
    rows_out: usize,
    /// Of a run of which no step has been heard yet.
    bench_status: Option<Box<BenchStatus>>,
    events: Vec<Event>,
    /// Snapshots that follow the steps being gathered.
    snapshots: Vec<(u64, Snapshot)>,
    lost: u64,
}

impl Gatherer {
    /// Steps in a batch, at most.
    pub(crate) const BATCH_ROWS: usize = 4096;
    /// How long a step waits for others.
    pub(crate) const BATCH_AGE: Duration = Duration::from_millis(500);
    /// Steps held for a writer that is behind: some 50 MB for three masses.
    pub(crate) const MOST_ROWS: usize = 1 << 18;

    pub(crate) fn new() -> Self {
        Self {
            run_id: None,
            begun: false,
            batch: Batch::default(),
            opened: Instant::now(),
            last: None,
            first: None,
            out: VecDeque::new(),
            held: VecDeque::new(),
            rows_out: 0,
            bench_status: None,
            events: Vec::new(),
            snapshots: Vec::new(),
            lost: 0,
        }
    }

    /// Steps that were sent, as their numbers tell, and that have not been gathered.
    pub(crate) fn lost(&self) -> u64 {
        self.lost
    }

    /// The number of the first step that was heard, of the first run.
    pub(crate) fn first(&self) -> Option<u64> {
        self.first
    }

    /// Which run is heard.
    pub(crate) fn run_id(&self) -> Option<u64> {
        self.run_id
    }

    /// Takes in one step.
    pub(crate) fn state(&mut self, state: &impl Step, now: Instant) {
        if self.run_id != Some(state.run_id()) {
            self.begin_run(state);
        }
        if self.rows_out + self.batch.len() >= Self::MOST_ROWS {
            return;
        }
        if let Some(last) = self.last {
            if state.seq() <= last.seq {
                return;
            }
            let missing = state.seq() - last.seq - 1;
            if missing > 0 {
                self.close_batch();
                self.lost += missing;
                let at = Moment::from(state);
                self.push(Item::Remark(Remark { at, what: What::Lost(missing) }));
            }
        }
        if self.batch.is_empty() {
            self.opened = now;
        }
        self.batch.push(state);
        self.first.get_or_insert(state.seq());
        self.last = Some(state.into());
        self.begin_tape();
        if self.batch.len() >= Self::BATCH_ROWS {
            self.close_batch();
        }
    }

    /// Takes in the latest bench status.
    pub(crate) fn bench_status(&mut self, bench_status: Box<BenchStatus>) {
        if self.begun && self.run_id == Some(bench_status.run_id) {
            self.out.push_back(Item::BenchStatus(bench_status, self.last.unwrap_or_default()));
        } else {
            self.bench_status = Some(bench_status);
            self.begin_tape();
        }
    }

    /// Takes in an event.
    pub(crate) fn event(&mut self, event: &Event) {
        if self.begun && self.run_id == Some(event.run_id) {
            // What happened stands in the file before the steps that it made.
            self.close_batch();
            self.out.push_back(Item::Event(Box::new(event.clone())));
        } else {
            self.events.push(event.clone());
        }
    }

    /// Takes in all of the machine of a run.
    pub(crate) fn snapshot(&mut self, run_id: u64, snapshot: Snapshot) {
        // Of a run that nobody hears the last will do.
        if self.run_id != Some(run_id) {
            self.snapshots.retain(|(other, _)| self.run_id == Some(*other));
        }
        self.snapshots.push((run_id, snapshot));
        if self.batch.is_empty() {
            self.put_snapshots();
        }
    }

    /// Takes in what the recorder itself has to say.
    pub(crate) fn remark(&mut self, remark: Remark) {
        self.push(Item::Remark(remark));
    }

    /// Closes the batch if its steps have waited long enough, or at once.
    pub(crate) fn flush(&mut self, now: Option<Instant>) {
        if now.is_none_or(|now| now.saturating_duration_since(self.opened) >= Self::BATCH_AGE) {
            self.close_batch();
        }
    }

    /// The next thing to put on tape.
    pub(crate) fn next(&mut self) -> Option<Item> {
        let item = self.out.pop_front()?;
        if let Item::Steps(batch) = &item {
            self.rows_out -= batch.len();
        }
        Some(item)
    }

    /// Takes back what could not be delivered yet.
    pub(crate) fn give_back(&mut self, item: Item) {
        if let Item::Steps(batch) = &item {
            self.rows_out += batch.len();
        }
        self.out.push_front(item);
    }

    fn begin_run(&mut self, state: &impl Step) {
        self.close_batch();
        // Steps of a run that ended before it had said what it is: nobody can make sense of them.
        self.rows_out -= self.held.drain(..).map(|item| rows(&item)).sum::<usize>();
        self.run_id = Some(state.run_id());
        self.begun = false;
        self.last = None;
        self.batch = Batch::new(state.layout());
    }

    /// Begins the tape of a run once both a step and a bench status of it have come.
    fn begin_tape(&mut self) {
        if self.begun {
            return;
        }
        let (Some(run_id), Some(last)) = (self.run_id, self.last) else { return };
        let Some(bench_status) = self.bench_status.take_if(|bench_status| bench_status.run_id == run_id) else {
            return;
        };
        self.out.push_back(Item::Run(bench_status, last));
        let (ours, others): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.events).into_iter().partition(|e| e.run_id == run_id);
        self.events = others;
        self.out.extend(ours.into_iter().map(|event| Item::Event(Box::new(event))));
        self.out.append(&mut self.held);
        self.begun = true;
    }

    fn close_batch(&mut self) {
        if self.batch.is_empty() {
            return;
        }
        let empty = Batch::new(self.batch.layout());
        let batch = std::mem::replace(&mut self.batch, empty);
        self.rows_out += batch.len();
        self.push(Item::Steps(batch));
        self.put_snapshots();
    }

    /// Puts the snapshots of this run behind its steps.
    fn put_snapshots(&mut self) {
        let at = self.last.unwrap_or_default();
        for (_, snapshot) in
            self.snapshots.extract_if(.., |(run_id, _)| self.run_id == Some(*run_id)).collect::<Vec<_>>()
        {
            let at = Moment { seq: snapshot.next, ..at };
            self.push(Item::Snapshot(snapshot, at));
        }
    }

    fn push(&mut self, item: Item) {
        if self.begun { self.out.push_back(item) } else { self.held.push_back(item) }
    }
}

fn rows(item: &Item) -> usize {
    if let Item::Steps(batch) = item { batch.len() } else { 0 }
}

#[cfg(test)]
mod tests {
    use wire::{Channel, State, StepLayout};

    use super::*;

    fn state(run_id: u64, seq: u64) -> State {
        let state = State::new(StepLayout::new(1)).with_word(Channel::RunId, run_id).with_word(Channel::Seq, seq);
        state.with(Channel::Tau, 0, seq as f64 / 100.0).with(Channel::Y, 0, seq as f64)
    }

    fn bench_status(run_id: u64) -> Box<BenchStatus> {
        Box::new(BenchStatus::from(wire::message::BenchStatusMessage {
            run_id,
            ..wire::message::BenchStatusMessage::default()
        }))
    }

    /// What comes out, as words.
    fn told(gatherer: &mut Gatherer) -> Vec<String> {
        gatherer.flush(None);
        std::iter::from_fn(|| gatherer.next())
            .map(|item| match item {
                Item::Run(bench_status, at) => format!("run {} at {}", bench_status.run_id, at.seq),
                Item::Steps(batch) => format!("{:?}", batch.seq),
                Item::Event(event) => format!("event {}", event.number),
                Item::BenchStatus(..) => "bench_status".to_owned(),
                Item::Remark(remark) => remark.text(),
                Item::Snapshot(snapshot, at) => format!("snapshot {} at {}", snapshot.next, at.seq),
            })
            .collect()
    }

    #[test]
    fn steps_wait_for_the_head_and_losses_stand_where_they_happened() {
        let mut gatherer = Gatherer::new();
        let now = Instant::now();
        gatherer.event(&Event::from(wire::EventMessage { run_id: 1, number: 4, ..wire::EventMessage::default() }));
        for seq in [5, 6, 9, 9, 10] {
            gatherer.state(&state(1, seq), now);
        }
        assert!(told(&mut gatherer).is_empty(), "no head yet");
        gatherer.bench_status(bench_status(1));
        gatherer.event(&Event::from(wire::EventMessage { run_id: 1, number: 5, ..wire::EventMessage::default() }));
        assert_eq!(told(&mut gatherer), ["run 1 at 10", "event 4", "[5, 6]", "2 steps lost", "[9, 10]", "event 5"]);
        assert_eq!(gatherer.lost(), 2);
    }

    #[test]
    fn a_new_run_waits_for_its_own_head_and_the_old_one_is_finished_first() {
        let mut gatherer = Gatherer::new();
        let now = Instant::now();
        gatherer.bench_status(bench_status(1));
        gatherer.state(&state(1, 7), now);
        gatherer.state(&state(2, 0), now);
        gatherer.event(&Event::from(wire::EventMessage { run_id: 2, number: 1, ..wire::EventMessage::default() }));
        assert_eq!(told(&mut gatherer), ["run 1 at 7", "[7]"]);
        gatherer.bench_status(bench_status(2));
        assert_eq!(told(&mut gatherer), ["run 2 at 0", "event 1", "[0]"]);
        assert_eq!(gatherer.lost(), 0, "another run is no loss");
    }

    #[test]
    fn a_writer_that_is_behind_costs_steps_and_not_memory() {
        let mut gatherer = Gatherer::new();
        let now = Instant::now();
        gatherer.bench_status(bench_status(1));
        let most = Gatherer::MOST_ROWS as u64;
        (0..most + 5).for_each(|seq| gatherer.state(&state(1, seq), now));
        let rows: usize = std::iter::from_fn(|| gatherer.next()).map(|item| rows(&item)).sum();
        assert_eq!((rows, gatherer.lost()), (Gatherer::MOST_ROWS, 0));
        gatherer.state(&state(1, most + 5), now);
        assert_eq!(
            (told(&mut gatherer), gatherer.lost()),
            (vec!["5 steps lost".to_owned(), format!("[{}]", most + 5)], 5)
        );
    }

    #[test]
    fn a_snapshot_follows_the_steps_that_were_being_gathered_and_one_of_another_run_waits() {
        let now = Instant::now();
        let step =
            |run, seq| State::new(StepLayout::new(1)).with_word(Channel::RunId, run).with_word(Channel::Seq, seq);
        let snapshot = |next| Snapshot { next, dtau: 0.01, words: vec![next] };
        let mut gatherer = Gatherer::new();
        gatherer.snapshot(1, snapshot(3));
        gatherer.state(&step(1, 5), now);
        gatherer.bench_status(bench_status(1));
        gatherer.snapshot(1, snapshot(6));
        gatherer.state(&step(1, 6), now);
        gatherer.snapshot(2, snapshot(0));
        gatherer.flush(None);
        gatherer.state(&step(2, 0), now);
        gatherer.bench_status(bench_status(2));
        gatherer.flush(None);
        assert_eq!(
            told(&mut gatherer),
            ["run 1 at 5", "[5, 6]", "snapshot 3 at 3", "snapshot 6 at 6", "run 2 at 0", "[0]", "snapshot 0 at 0"]
        );
    }
}
