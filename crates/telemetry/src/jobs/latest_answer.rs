//! A worker for questions that follow each other faster than they can be answered: the newest wins, what came between is
//! dropped, and who asks never waits.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A function, computed elsewhere, and its newest answer.
#[derive(Debug)]
pub struct LatestAnswer<Q, A> {
    place: Arc<Place<Q, A>>,
    work: fn(&Q) -> A,
    thread: Option<JoinHandle<()>>,
}

/// Where questions and answers meet.
#[derive(Debug)]
struct Place<Q, A> {
    slots: Mutex<Slots<Q, A>>,
    news: Condvar,
    answered: Condvar,
}

#[derive(Debug)]
struct Slots<Q, A> {
    /// The newest question ever asked.
    asked: Option<Q>,
    /// Whether it still waits.
    waits: bool,
    /// The newest answer, and to what.
    answer: Option<(Q, Arc<A>)>,
    closed: bool,
}

impl<Q, A> Place<Q, A> {
    fn slots(&self) -> MutexGuard<'_, Slots<Q, A>> {
        self.slots.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<Q: Clone + PartialEq, A> LatestAnswer<Q, A> {
    /// Answers on the thread that asks.
    pub fn inline(work: fn(&Q) -> A) -> Self {
        let slots = Slots { asked: None, waits: false, answer: None, closed: false };
        Self {
            place: Arc::new(Place { slots: Mutex::new(slots), news: Condvar::new(), answered: Condvar::new() }),
            work,
            thread: None,
        }
    }

    /// The newest answer there is, if there is any; the question is set to work unless it is the last one again.
    pub fn ask(&self, question: &Q) -> Option<Arc<A>> {
        let mut slots = self.place.slots();
        if slots.asked.as_ref() != Some(question) {
            slots.asked = Some(question.clone());
            if self.thread.is_some() {
                slots.waits = true;
                self.place.news.notify_one();
            } else {
                slots.answer = Some((question.clone(), Arc::new((self.work)(question))));
            }
        }
        slots.answer.as_ref().map(|(_, answer)| answer.clone())
    }

    /// The answer to this very question, if it comes within `patience`; else it is still being worked on.
    pub fn ask_for(&self, question: &Q, patience: Duration) -> Option<Arc<A>> {
        self.ask(question);
        let deadline = Instant::now() + patience;
        let mut slots = self.place.slots();
        loop {
            if let Some((_, answer)) = slots.answer.as_ref().filter(|(of, _)| of == question) {
                return Some(answer.clone());
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return None;
            }
            slots = self.place.answered.wait_timeout(slots, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl<Q: Clone + Send + 'static, A: Send + Sync + 'static> LatestAnswer<Q, A> {
    /// Answers on a thread of its own, which calls `wake` after each answer and ends when this is dropped.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn spawn(name: &str, work: fn(&Q) -> A, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let slots = Slots { asked: None, waits: false, answer: None, closed: false };
        let place = Arc::new(Place { slots: Mutex::new(slots), news: Condvar::new(), answered: Condvar::new() });
        let there = place.clone();
        let thread = std::thread::Builder::new().name(name.into()).spawn(move || {
            while let Some(question) = next(&there) {
                let answer = Arc::new(work(&question));
                there.slots().answer = Some((question, answer));
                there.answered.notify_all();
                wake();
            }
        })?;
        Ok(Self { place, work, thread: Some(thread) })
    }
}

/// The newest question that waits; `None` when no more will come.
fn next<Q: Clone, A>(place: &Place<Q, A>) -> Option<Q> {
    let mut slots = place.slots();
    loop {
        if slots.closed {
            return None;
        }
        if slots.waits {
            slots.waits = false;
            return slots.asked.clone();
        }
        slots = place.news.wait(slots).unwrap_or_else(PoisonError::into_inner);
    }
}

impl<Q, A> Drop for LatestAnswer<Q, A> {
    fn drop(&mut self) {
        self.place.slots().closed = true;
        self.place.news.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic in it has been reported already.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use crossbeam::channel::{self, Receiver, Sender};

    use super::*;

    /// A question that is answered when the test lets it be.
    #[derive(Clone, Debug)]
    struct Gated(u32, Sender<u32>, Receiver<()>);

    impl PartialEq for Gated {
        fn eq(&self, other: &Self) -> bool {
            self.0 == other.0
        }
    }

    fn work(Gated(number, begun, gate): &Gated) -> u32 {
        begun.send(*number).unwrap();
        gate.recv().unwrap();
        *number
    }

    #[test]
    fn the_newest_question_wins_and_asking_never_waits() {
        let (begun, begins) = channel::unbounded();
        let (open, gate) = channel::unbounded();
        let (woke, wakes) = channel::unbounded();
        let question = |number| Gated(number, begun.clone(), gate.clone());
        let latest = LatestAnswer::spawn("test", work, move || woke.send(()).unwrap()).unwrap();
        assert_eq!(latest.ask(&question(1)), None);
        assert_eq!(begins.recv(), Ok(1));
        for number in 2..=9 {
            assert_eq!(latest.ask(&question(number)), None, "the first is still at work");
        }
        open.send(()).unwrap();
        wakes.recv().unwrap();
        assert_eq!(begins.recv(), Ok(9), "2 to 8 were overtaken");
        assert_eq!(latest.ask(&question(9)).as_deref(), Some(&1), "the newest answer there is");
        assert_eq!(latest.ask_for(&question(9), Duration::from_millis(1)), None, "that is of another question");
        open.send(()).unwrap();
        assert_eq!(latest.ask_for(&question(9), Duration::from_secs(60)).as_deref(), Some(&9));
        wakes.recv().unwrap();
        assert_eq!(latest.ask(&question(9)).as_deref(), Some(&9));
        drop(latest);
        assert!(begins.try_recv().is_err(), "asking again sets nothing to work");
    }

    #[test]
    fn inline_answers_at_once_and_once() {
        let latest = LatestAnswer::inline(|number: &u32| number * 2);
        assert_eq!(latest.ask(&3).as_deref(), Some(&6));
        let (first, second) = (latest.ask(&4).unwrap(), latest.ask(&4).unwrap());
        assert!(Arc::ptr_eq(&first, &second));
    }
}
