//! Runs a check over many texts: shrinks what fails, stops what hangs, goes on as long as it may.

use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngSeed, TestError, TestRunner};
use rustix::time::{ClockId, clock_gettime};

/// The seed of the run that is always the same.
const SEED: u64 = 11;
/// What one text may take of a processor: a hundred times what the slowest does. Not time of the clock, which a busy
/// machine has less of.
const MOST_WORK: Duration = Duration::from_secs(60);
/// After so long on the clock nobody waits for an answer any more.
const HANGS: Duration = Duration::from_secs(900);

/// Checks `cases` texts of `texts`, and as many again, from other seeds, as there is time for.
///
/// # Panics
/// If `check` does, with the smallest text found that makes it.
pub(crate) fn run(kind: &str, cases: u32, texts: &impl Strategy<Value = String>, check: impl Fn(&str)) {
    let number = |name: &str| std::env::var(name).ok().and_then(|typed| typed.parse::<u64>().ok());
    let (budget, first) = (number("WHIRL_FUZZ_SECONDS"), number("WHIRL_FUZZ_SEED").unwrap_or(SEED));
    let (begun, watch) = (Instant::now(), Watch::begin(kind));
    for seed in first.. {
        let config = Config { cases, rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..Config::default() };
        let outcome = TestRunner::new(config).run(texts, |text| {
            watch.look_at(Some(&text));
            let before = work();
            check(&text);
            let spent = work().saturating_sub(before);
            watch.look_at(None);
            assert!(spent < MOST_WORK, "it takes {spent:?} of a processor");
            Ok(())
        });
        match outcome {
            Ok(()) => {}
            Err(TestError::Fail(why, text)) => panic!("{kind}, seed {seed}: {why}\n--- the file:\n{text}\n---"),
            Err(error) => panic!("{kind}, seed {seed}: {error}"),
        }
        if begun.elapsed() >= Duration::from_secs(budget.unwrap_or(0)) {
            return;
        }
    }
}

/// What this thread has had of a processor.
fn work() -> Duration {
    let spent = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(spent.tv_sec as u64, spent.tv_nsec as u32)
}

/// Ends the process with the text that it has hung on.
struct Watch(Arc<Mutex<Looked>>);

struct Looked {
    text: Option<(Instant, String)>,
    over: bool,
}

impl Watch {
    fn begin(kind: &str) -> Self {
        let (looked, kind) = (Arc::new(Mutex::new(Looked { text: None, over: false })), kind.to_owned());
        let watched = looked.clone();
        std::thread::spawn(move || {
            loop {
                std::thread::sleep(Duration::from_millis(500));
                let looked = watched.lock().unwrap_or_else(PoisonError::into_inner);
                match &looked.text {
                    _ if looked.over => return,
                    Some((since, text)) if since.elapsed() > HANGS => {
                        let _ = writeln!(std::io::stderr(), "{kind}: it hangs on\n---\n{text}\n---");
                        std::process::abort();
                    }
                    _ => {}
                }
            }
        });
        Self(looked)
    }

    fn look_at(&self, text: Option<&str>) {
        let text = text.map(|text| (Instant::now(), text.to_owned()));
        self.0.lock().unwrap_or_else(PoisonError::into_inner).text = text;
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).over = true;
    }
}
