//! What is told of what happens: changes, trips, excitations.

use rotor::{C64, Settings};
use wire::message::Flags;
use wire::{Answer, Change, Event, Happening, Listener, Step};

use crate::support::beside;

#[test]
fn an_unstable_rotor_trips_holds_and_restarts() {
    let summary = beside("off", 20_000.0, |bench, mut settings| {
        settings.trip = 5.0;
        assert!(bench.ask(&Change::Settings { base_revision: 1, settings }).is_accepted());
        bench.ask(&Change::Impulse { mass: 1, velocity: C64::new(1.0, 0.0) });
        let trip = bench.wait("the trip", |b, _| b.trip.is_tripped().then_some(b.trip));
        assert_eq!((trip.cause, trip.limit), (1, 5.0));
        let at = bench.states.iter().position(|s| s.flags().has(Flags::TRIPPED)).unwrap();
        assert_eq!(bench.states[at].seq(), trip.step);
        let held = bench.states[at];
        assert!(held.points().any(|p| p.radius() > 5.0));
        let later = bench.wait("held steps", |_, states| states.get(at + 100).copied());
        assert!(later.numbers().eq(held.numbers()));
        let answer = bench.ask(&Change::Restart);
        assert!(answer.is_accepted());
        bench.wait("running again", |b, _| (!b.trip.is_tripped()).then_some(()));
        let again = bench
            .wait("motion from rest", |_, states| states.iter().find(|s| s.seq() == answer.applied_at_step).copied());
        assert_eq!((again.tau(), again.flags().has(Flags::TRIPPED)), (0.01, false));
    });
    assert!(!summary.trip.is_tripped() || summary.trip.cause == 1);
}

#[test]
fn what_happens_is_told_in_order_with_who_and_why_and_the_settings_after_it() {
    beside("composite", 1000.0, |bench, settings| {
        let faster = Settings { speed: 3.0, ..settings.clone() };
        let changed = bench.ask(&Change::Settings { base_revision: 1, settings: faster.clone() });
        let bad = Settings { speed: -1.0, ..settings.clone() };
        assert!(!bench.ask(&Change::Settings { base_revision: 2, settings: bad }).is_accepted());
        let outdated = bench.ask(&Change::Settings { base_revision: 1, settings: settings.clone() });
        assert_eq!(outdated.outdated, 1);
        let kick = Change::Impulse { mass: 2, velocity: C64::new(0.5, -0.25) };
        let kicked = bench.ask(&kick);
        let noted = bench.ask(&Change::Note { text: "here it begins".into() });
        assert!(!bench.ask(&Change::Note { text: "  ".into() }).is_accepted());
        let restarted = bench.ask(&Change::Restart);
        let told = bench.events(7);
        let happened: Vec<_> = told.iter().map(|event| event.happening().unwrap()).collect();
        let reason = "speed = -1: expected a number from 0 to 1000".to_owned();
        assert_eq!(
            happened,
            [
                Happening::Started,
                Happening::Settings,
                Happening::Refused { asked: "settings", reason },
                Happening::Impulse { mass: 2, velocity: C64::new(0.5, -0.25) },
                Happening::Note("here it begins".into()),
                Happening::Refused { asked: "note", reason: "a note must say something".into() },
                Happening::Restarted,
            ]
        );
        // Numbers without a gap, over all events.
        assert_eq!(
            bench.events.iter().map(|e| e.number).collect::<Vec<_>>(),
            (1..=bench.events.len() as u64).collect::<Vec<_>>()
        );
        assert_eq!((told[0].who.as_str(), told[0].seq, told[0].tau, told[0].revision), ("sim", 0, 0.0, 1));
        assert!(told[1..].iter().all(|e| e.who.as_str() == "test" && e.why.as_str() == "to see"));
        // Steps and times are those of the answers, and times those of the step before.
        bench.wait("the restart", |_, states| states.iter().find(|s| s.seq() == restarted.applied_at_step).map(drop));
        for (event, answer) in [(1, changed), (3, kicked), (4, noted), (6, restarted)] {
            assert_eq!((told[event].seq, told[event].tau), (answer.applied_at_step, answer.tau));
            let before = bench.states.iter().find(|s| s.seq() + 1 == answer.applied_at_step);
            assert!(event == 6 || before.is_none_or(|before| before.tau() == answer.tau), "{before:?}, {answer:?}");
        }
        assert_eq!(restarted.tau, 0.0);
        assert_eq!(told[0].settings.get().clone(), settings);
        assert!(told[1..].iter().all(|event| event.settings.get().clone() == faster && event.revision == 2));
        assert!(told.windows(2).all(|pair| pair[1].wall_ns >= pair[0].wall_ns && pair[1].seq >= pair[0].seq));
    });
}

#[test]
fn a_trip_is_told_with_its_cause_and_who_comes_late_hears_of_it() {
    let mut late = None;
    beside("off", 20_000.0, |bench, mut settings| {
        settings.trip = 5.0;
        bench.ask(&Change::Settings { base_revision: 1, settings });
        bench.ask(&Change::Impulse { mass: 1, velocity: C64::new(1.0, 0.0) });
        let trip = bench.wait("the trip", |b, _| b.trip.is_tripped().then_some(b.trip));
        let told = bench.events(4);
        assert_eq!(told[3].happening(), Some(Happening::Tripped(trip)));
        assert_eq!((told[3].who.as_str(), told[3].seq), ("sim", trip.step));
        let at = bench.wait("the step", |_, states| states.iter().find(|s| s.seq() == trip.step).copied());
        assert_eq!(told[3].tau, at.tau());
        // A note on a held machine has a step, and the time at which it is held.
        let noted = bench.ask(&Change::Note { text: "so that is how it goes".into() });
        assert!(noted.applied_at_step > trip.step && noted.tau == at.tau(), "{noted:?}");
        bench.events(5);
        let numbers = |events: &[Event]| events.iter().map(|event| event.number).collect::<Vec<_>>();
        let mut listener = bench.again();
        let mut heard = Vec::new();
        listener.events(|event| heard.push(event.clone())).unwrap();
        assert_eq!(numbers(&heard[..5]), numbers(&bench.events[..5]));
        late = Some(listener);
    });
    let mut last = None;
    late.unwrap().events(|event| last = event.happening()).unwrap();
    assert_eq!(last, Some(Happening::Ended));
}

#[test]
fn one_excitation_at_a_time_is_told_from_its_first_step_to_its_last() {
    beside("composite", 5000.0, |bench, settings| {
        let excite = |duration: f64, amplitude: f64| {
            let text = format!(
                "seed=1 period=5.0 lines=1..9 tones=9 away_from=2.5 amplitude={amplitude:?} duration={duration:?}"
            );
            Change::Excite(text.parse().unwrap())
        };
        let refused = |answer: Answer, why: &str| {
            assert!(!answer.is_accepted() && answer.reason.as_str().contains(why), "{}", answer.reason.as_str());
        };
        refused(bench.ask(&Change::EndExcitation), "nothing excites the loop");
        refused(bench.ask(&excite(1.0, 1e9)), "could trip the machine");
        refused(bench.ask(&excite(1.0, -1.0)), "amplitude = -1");
        // By itself.
        let begun = bench.ask(&excite(5.0, 1e-3));
        assert!(begun.is_accepted());
        let started = begun.applied_at_step;
        refused(bench.ask(&excite(5.0, 1e-3)), "excited already");
        let over = |event: &Event| event.happening() == Some(Happening::ExcitationOver);
        let told = bench.events(7);
        let [.., begins, _, ends] = &told[..] else { panic!("{told:?}") };
        assert!(matches!(begins.happening(), Some(Happening::Excited(_))) && begins.who.as_str() == "test");
        assert!(over(ends) && (ends.seq, ends.who.as_str()) == (started + 500, "sim"), "{ends:?}");
        // By whoever asked, and by a change.
        assert!(bench.ask(&excite(1000.0, 1e-3)).is_accepted());
        let ended = bench.ask(&Change::EndExcitation);
        assert!(bench.ask(&excite(1000.0, 1e-3)).is_accepted());
        let mut faster = settings;
        faster.assign("kd", "-0.5").unwrap();
        let changed = bench.ask(&Change::Settings { base_revision: 1, settings: faster });
        let told = bench.events(12);
        assert!(over(&told[8]) && told[8].seq == ended.applied_at_step && told[8].who.as_str() == "test");
        assert_eq!(told[10].happening(), Some(Happening::Settings));
        assert!(over(&told[11]) && told[11].seq == changed.applied_at_step, "{told:?}");
        assert!(bench.ask(&excite(1.0, 1e-3)).is_accepted(), "and another may begin");
    });
}
