//! A gain search from the console: for the present structure, at the present speed or over a range, beside the live loop.
//!
//! It runs on a thread of its own with one core fewer than there are, so that the screen keeps moving, and touches nothing:
//! what it finds is a proposal, whole settings that a person looks at before they are applied.

mod goal;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use rotor::{Feedback, FeedbackError, Rotor, Settings};
use tuner::{Family, FamilyError, Options, Problem, ProblemError, Progress, Schedule, Stop, Structure, tune};

use crate::comparison::GainEffects;
use crate::units::ScreenUnits;

pub use goal::{GoalError, SearchGoal};

/// Why there is no search.
#[derive(Debug, thiserror::Error)]
pub enum SearchError {
    /// Speeds or clearances that make no family of conditions.
    #[error(transparent)]
    Family(#[from] FamilyError),
    /// Feedback whose gains cannot be searched.
    #[error(transparent)]
    Feedback(#[from] FeedbackError),
    /// Limits that make no problem.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// No thread to be had.
    #[error("no thread for the search: {0}")]
    Thread(#[source] std::io::Error),
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundGains {
    /// The settings as they were when the search began.
    pub before: Settings,
    /// The same with the gains that were found.
    pub settings: Settings,
    /// The smallest damping ratio over all that was asked for.
    pub min_damping: f64,
    /// The speed where that is, if the search has it there.
    pub worst_speed: Option<f64>,
    /// Whether it is proven for every condition.
    pub proven: bool,
    /// Whether it was stopped before its end.
    pub stopped: bool,
    /// What of the limits of margins they do not keep, in words.
    pub unmet: Vec<String>,
    /// What the gains in force do, and those that were found.
    pub effects: Box<[GainEffects; 2]>,
}

#[derive(Debug, Default)]
struct Slot {
    progress: Option<Progress>,
    ended: Option<Result<FoundGains, ProblemError>>,
}

/// A search under way. Dropping it ends it.
#[derive(Debug)]
pub struct GainSearch {
    goal: SearchGoal,
    stop: Arc<AtomicBool>,
    slot: Arc<Mutex<Slot>>,
    thread: Option<JoinHandle<()>>,
}

impl GainSearch {
    /// Begins a search from `settings` for `rotor`.
    ///
    /// # Errors
    /// A goal that makes no sense for this rotor, or no thread to be had.
    pub fn begin(rotor: &Rotor, settings: &Settings, goal: SearchGoal) -> Result<Self, SearchError> {
        let problem = problem(rotor, &settings.feedback, &goal)?;
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let mut options = Options::for_problem(&problem);
        options.threads = Some(cores.saturating_sub(1).max(1));
        // The present gains are a start too: what is found is never worse than what there is.
        options.first = vec![problem.structure.variables_of(&settings.feedback)];
        options.starts += 1;
        let (stop, slot) = (Arc::new(AtomicBool::new(false)), Arc::new(Mutex::new(Slot::default())));
        let (flag, place, settings) = (stop.clone(), slot.clone(), settings.clone());
        let (rotor, speeds, limits) = (Arc::new(rotor.clone()), [goal.from, goal.to], goal.clone());
        let fill = move |change: &dyn Fn(&mut Slot)| change(&mut place.lock().unwrap_or_else(PoisonError::into_inner));
        let work = move || {
            let say = |progress: &Progress| fill(&|slot| slot.progress = Some(progress.clone()));
            let tuned = tune(&problem, &options, &say, Stop::when(&flag));
            let found = tuned.map(|tuned| {
                let settings_found = Settings { feedback: tuned.feedback, ..settings.clone() };
                let [now, mut new] = [&settings, &settings_found]
                    .map(|settings| GainEffects::of(&rotor, settings, speeds, Stop::when(&flag)));
                let worst = new.settle(tuned.worst.value, limits.robust);
                let is_worst = worst == tuned.worst.value;
                FoundGains {
                    before: settings.clone(),
                    settings: settings_found,
                    min_damping: worst,
                    worst_speed: is_worst.then_some(tuned.worst.point[0]),
                    proven: is_worst && tuned.worst.proven,
                    effects: Box::new([now, new]),
                    stopped: tuned.interrupted,
                    unmet: limits.unmet(tuned.margins.as_ref()),
                }
            });
            fill(&|slot| slot.ended = Some(found.clone()));
        };
        let thread = std::thread::Builder::new().name("search".into()).spawn(work);
        let thread = thread.map_err(SearchError::Thread)?;
        Ok(Self { goal, stop, slot, thread: Some(thread) })
    }

    /// What it is for.
    #[must_use]
    pub fn goal(&self) -> &SearchGoal {
        &self.goal
    }

    /// How it goes, in words for the status line.
    #[must_use]
    pub fn words(&self, units: &ScreenUnits) -> String {
        let progress = self.slot.lock().unwrap_or_else(PoisonError::into_inner).progress.clone();
        let what = self.goal.words(units);
        let Some(Progress { done, starts, best, .. }) = progress else { return format!("searching {what}") };
        format!("searching {what}: {done} of {starts}, best {best:.4}")
    }

    /// Asks it to end with the best so far.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// What came of it, once.
    pub fn ended(&self) -> Option<Result<FoundGains, ProblemError>> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).ended.take()
    }
}

impl Drop for GainSearch {
    fn drop(&mut self) {
        self.stop();
        if let Some(thread) = self.thread.take() {
            // It looks at the flag between steps of a climb: a matter of milliseconds.
            let _ = thread.join();
        }
    }
}

/// The question: the bearing and signals of the present feedback, their gains constant and no larger than the search's own
/// bound, or than what they are now.
fn problem(rotor: &Rotor, feedback: &Feedback, goal: &SearchGoal) -> Result<Problem, SearchError> {
    let mut family = Family::new(rotor, goal.from, goal.to)?;
    if goal.robust {
        family.any_deadband(true)?;
    }
    let structure = Structure::new(rotor, feedback, Schedule::Fixed)?;
    let own = structure.variables_of(feedback);
    let bound = own.iter().map(|gain| gain.abs()).fold(structure.default_bound(), f64::max);
    let mut problem = Problem::new(family, structure, bound);
    (problem.max_sensitivity, problem.min_delay) = (goal.max_sensitivity, goal.min_delay);
    problem.check()?;
    Ok(problem)
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use rotor::{ClosedLoop, builtin};
    use tuner::LoopMargins;

    use super::*;

    fn bench() -> (Rotor, Settings) {
        let rotor = builtin::rotor("three-mass").unwrap();
        let settings = Settings::new(&rotor, 6.0, builtin::feedback(&rotor, "composite").unwrap());
        (rotor, settings)
    }

    fn result(search: &GainSearch) -> Result<FoundGains, ProblemError> {
        let begun = Instant::now();
        loop {
            if let Some(ended) = search.ended() {
                return ended;
            }
            assert!(begun.elapsed() < Duration::from_secs(300), "{}", search.words(&ScreenUnits::DIMENSIONLESS));
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    #[test]
    fn finds_better_gains_for_the_present_structure() {
        let (rotor, settings) = bench();
        let goal = SearchGoal { from: 6.0, to: 6.0, ..SearchGoal::default() };
        let found = result(&GainSearch::begin(&rotor, &settings, goal).unwrap()).unwrap();
        assert!(found.min_damping > 0.0291 && found.proven && !found.stopped, "{found:?}");
        assert_eq!(found.worst_speed, Some(6.0));
        let damping = |feedback: &Feedback| {
            let poles = rotor::poles(&ClosedLoop::new(&rotor, feedback, 6.0, &[])).unwrap();
            rotor::damping_ratio(poles[0])
        };
        assert!((damping(&found.settings.feedback) - found.min_damping).abs() < 1e-9);
        assert!(damping(&settings.feedback) < found.min_damping);
        assert_eq!(
            Settings { feedback: settings.feedback.clone(), ..found.settings },
            settings,
            "nothing else changes"
        );
    }

    #[test]
    fn a_search_by_default_is_from_rest_to_past_the_present_speed_and_what_it_finds_holds_there() {
        // The search of one speed offered gains that held 2.226 to 2.901 in place of gains that held 0 to 7.07.
        let (rotor, mut settings) = bench();
        settings.speed = 2.5;
        let goal = SearchGoal::read("full", &settings, &ScreenUnits::DIMENSIONLESS).unwrap();
        assert_eq!((goal.from, goal.to), (0.0, 2.8));
        let found = result(&GainSearch::begin(&rotor, &settings, goal).unwrap()).unwrap();
        let [now, new] = &*found.effects;
        assert!(new.min_damping > now.min_damping && new.stable[0][0] == 0.0 && new.stable[0][1] >= 2.8, "{found:?}");
        assert_eq!(now.stable[0][0], 0.0);
    }

    #[test]
    fn an_offer_for_shafts_speaks_of_the_modes_that_the_verdict_speaks_of() {
        let rotor = builtin::rotor("rig").unwrap();
        let settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "own").unwrap());
        let goal = SearchGoal { from: 2.5, to: 2.5, ..SearchGoal::default() };
        let search = GainSearch::begin(&rotor, &settings, goal).unwrap();
        search.stop();
        let found = result(&search).unwrap();
        let [now, new] = &*found.effects;
        // The verdict of a bench, and what it would be.
        let verdict = |settings: &Settings| machine::counted_damping(&rotor, settings, 2.5).unwrap();
        assert!((now.min_damping - verdict(&settings)).abs() < 1e-9, "{} {}", now.min_damping, verdict(&settings));
        assert!((found.min_damping - verdict(&found.settings)).abs() < 1e-6, "{found:?}");
        assert_eq!(new.min_damping, found.min_damping);
    }

    #[test]
    fn limits_of_margins_are_asked_for_and_what_is_not_kept_is_told() {
        let (rotor, settings) = bench();
        let goal =
            SearchGoal::read("6..6.1 sensitivity=1.5 delay=0.2", &settings, &ScreenUnits::DIMENSIONLESS).unwrap();
        let asked = problem(&rotor, &settings.feedback, &goal).unwrap();
        assert_eq!((asked.max_sensitivity, asked.min_delay), (Some(1.5), Some(0.2)));
        let told = |sensitivity: f64, delay: Option<f64>| {
            let found = LoopMargins { sensitivity: (sensitivity, 1.0), delay: delay.map(|delay| (delay, 2.0)) };
            goal.unmet(Some(&[(found.clone(), vec![]), (found, vec![])]))
        };
        assert_eq!(
            told(3.0, Some(0.05)),
            ["a sensitivity of 3.0000, NOT 1.5", "a delay margin of 0.0500 tau, NOT 0.2"]
        );
        assert!(told(1.5, Some(0.2)).is_empty() && told(1.2, None).is_empty());
    }

    #[test]
    fn a_search_that_is_stopped_gives_what_it_has() {
        let (rotor, settings) = bench();
        let goal = SearchGoal::read("0..6 robust", &settings, &ScreenUnits::DIMENSIONLESS).unwrap();
        let search = GainSearch::begin(&rotor, &settings, goal).unwrap();
        search.stop();
        assert!(result(&search).unwrap().stopped);
        drop(search);
    }

    #[test]
    fn val_wishes_for_a_rotor_in_si_units_are_typed_and_told_in_rpm() {
        let units = ScreenUnits::of(Some(crate::test_support::SI), rotor::ControlMasses::default());
        let (_, mut settings) = bench();
        (settings.speed, settings.deadband) = (2.5, vec![0.0; 3]);
        let goal = SearchGoal::read("0..19098.593171027442", &settings, &units).unwrap();
        // 1000 rad/s are 9549.3 rpm.
        assert!((goal.to - 2.0).abs() < 1e-12, "{goal:?}");
        assert_eq!(goal.words(&units), "over 0..19099 rpm");
        let hertz = SearchGoal::read("0..318.3098861837907Hz delay=1ms", &settings, &units).unwrap();
        assert!((hertz.to - 2.0).abs() < 1e-12 && (hertz.min_delay.unwrap() - 1.0).abs() < 1e-12, "{hertz:?}");
        assert_eq!(SearchGoal::read("", &settings, &units).unwrap().words(&units), "over 0..26738 rpm");
    }

    #[test]
    fn wishes_are_read_or_refused() {
        let units = ScreenUnits::DIMENSIONLESS;
        let (_, mut settings) = bench();
        (settings.speed, settings.deadband) = (5.0, vec![1.0; 3]);
        let clearances = settings.clone();
        settings.deadband.fill(0.0);
        let goal = |words| SearchGoal::read(words, &settings, &units);
        assert_eq!(goal("").unwrap().words(&units), "over R 0..5.5");
        // Where a clearance is set, gains that hold for the full stiffness alone are no answer unless asked for.
        let with_clearance = |words| SearchGoal::read(words, &clearances, &units).unwrap().words(&units);
        assert_eq!(with_clearance(""), "over R 0..5.5, any deadband");
        assert_eq!(with_clearance("0..6 full"), "over R 0..6");
        let limits = goal("0..6 sensitivity=1.5 delay=0.1").unwrap();
        assert_eq!((limits.max_sensitivity, limits.min_delay), (Some(1.5), Some(0.1)));
        assert_eq!(limits.words(&units), "over R 0..6, |S| to 1.5, delay from 0.1 tau");
        for wrong in ["sensitivity=1", "sensitivity=", "delay=0", "delay=1 delay=2", "gain=3", "sensitivity=inf"] {
            assert!(goal(wrong).unwrap_err().to_string().contains("sensitivity=NUMBER above 1"), "{wrong}");
        }
        assert!(goal("robust full").unwrap_err().to_string().contains("once"));
        assert_eq!(goal("0..6").unwrap().words(&units), "over R 0..6");
        assert_eq!(goal("robust 0..6.5").unwrap().words(&units), "over R 0..6.5, any deadband");
        let refused = goal("0..50Hz").unwrap_err().to_string();
        assert!(refused.contains("the rotor is not one in SI units"), "{refused}");
        for wrong in ["6..0", "fast", "0..", "-1..3", "0..inf"] {
            assert!(goal(wrong).unwrap_err().to_string().contains("expected a range of speeds"), "{wrong}");
        }
    }
}
