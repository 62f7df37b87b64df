//! What the request thread tells of a controller outside: that it has come to act, that it was lost, and what of its commands was amiss.

use std::time::{Duration, Instant};

use wire::Happening;

use super::RequestThread;
use crate::external::ExternalCounts;
use crate::log::When;

/// How long to be silent after words about commands that were amiss.
const PAUSE: Duration = Duration::from_secs(10);

/// What was told last, and when of what is told seldom.
#[derive(Debug, Default)]
pub(super) struct ExternalReports {
    last: ExternalCounts,
    amiss_at: Option<Instant>,
    amiss: [u64; 3],
}

impl ExternalReports {
    /// What is new about a controller that has counted so far, in words.
    fn news(&mut self, counts: ExternalCounts, now: Instant) -> Vec<String> {
        let mut words = Vec::new();
        let before = std::mem::replace(&mut self.last, counts);
        let (took_over, lost) = (counts.took_over - before.took_over, counts.lost - before.lost);
        if lost > 0 {
            words.push(match lost {
                1 => "the controller outside was lost: the law of the bench acts".to_owned(),
                _ => format!("the controller outside was lost {lost} times: the law of the bench acted"),
            });
        }
        if took_over > 0 && counts.acting {
            words.push("a controller outside acts".to_owned());
        }
        let amiss = [counts.late, counts.missed, counts.refused];
        if amiss != self.amiss && self.amiss_at.is_none_or(|at| now - at >= PAUSE) {
            let [late, missed, refused] = [0, 1, 2].map(|k: usize| amiss[k] - self.amiss[k]);
            let told = [(late, "late"), (missed, "missed"), (refused, "not finite and not taken")];
            let told: Vec<String> =
                told.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
            words.push(format!("commands from outside: {}", told.join(", ")));
            (self.amiss, self.amiss_at) = (amiss, Some(now));
        }
        words
    }
}

impl RequestThread<'_> {
    /// Notes what is new about a controller outside.
    pub(super) fn watch_controller(&mut self) {
        let counts = self.exchange.counters.external.now();
        for words in self.controller.news(counts, Instant::now()) {
            self.log.note(&Happening::Note(words), When::now(self.exchange), &self.bench_status);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_amiss_is_told_at_once_and_then_seldom_and_no_count_is_lost() {
        let (start, mut told) = (Instant::now(), ExternalReports::default());
        let at = |tenths: u64| start + Duration::from_millis(100 * tenths);
        assert_eq!(told.news(ExternalCounts::default(), at(0)), Vec::<String>::new());
        let acting = ExternalCounts { taken: 9, took_over: 1, acting: true, ..ExternalCounts::default() };
        assert_eq!(told.news(acting, at(1)), ["a controller outside acts"]);
        let late = ExternalCounts { late: 2, ..acting };
        assert_eq!(told.news(late, at(2)), ["commands from outside: 2 late"]);
        let worse = ExternalCounts { late: 3, missed: 5, refused: 1, ..acting };
        assert_eq!(told.news(worse, at(3)), Vec::<String>::new());
        let words = told.news(ExternalCounts { lost: 1, acting: false, ..worse }, at(103));
        assert_eq!(
            words,
            [
                "the controller outside was lost: the law of the bench acts",
                "commands from outside: 1 late, 5 missed, 1 not finite and not taken"
            ]
        );
    }
}
