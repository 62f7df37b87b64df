//! Changes of settings: taken at a step, refused whole, followed by as fine a step as they need.

use rotor::{C64, Settings};
use wire::{Change, Event, Happening, Step};

use crate::support::beside;

#[test]
fn a_change_of_settings_is_answered_with_the_step_that_took_it() {
    beside("composite", 1000.0, |bench, mut settings| {
        bench.wait("steps before the change", |_, states| (states.len() >= 5).then_some(()));
        settings.speed = 3.0;
        let answer = bench.ask(&Change::Settings { base_revision: 1, settings: settings.clone() });
        assert_eq!((answer.is_accepted(), answer.revision), (true, 2));
        let first = bench.wait("the new speed", |_, states| states.iter().position(|s| s.speed() == 3.0));
        let (before, after) = (bench.states[first - 1], bench.states[first]);
        assert_eq!((after.seq(), after.revision(), before.revision()), (answer.applied_at_step, 2, 1));
        let bench_status = bench.wait("its poles", |b, _| (b.analysis.revision == 2).then(|| Box::new(b.clone())));
        assert_eq!(bench_status.settings.get().clone(), settings);
        assert_eq!(bench_status.changed_by.as_str(), "test");
        // Based on a revision that is no longer in force: refused, and told why.
        let answer = bench.ask(&Change::Settings { base_revision: 1, settings });
        assert_eq!((answer.is_accepted(), answer.outdated, answer.revision), (false, 1, 2));
        assert!(answer.reason.as_str().contains("changed meanwhile by test"), "{:?}", answer.reason);
    });
}

#[test]
fn what_is_wrong_is_refused_whole() {
    beside("composite", 1000.0, |bench, settings| {
        let mut refused = |change: &Change, why: &str| {
            let answer = bench.ask(change);
            assert!(!answer.is_accepted() && answer.reason.as_str().contains(why), "{:?}", answer.reason);
            assert_eq!((answer.revision, answer.outdated), (1, 0));
        };
        let bad = Settings { speed: f64::NAN, ..settings.clone() };
        refused(&Change::Settings { base_revision: 1, settings: bad }, "speed = NaN: expected a number from 0 to 1000");
        let short = Settings { deadband: vec![0.0; 2], ..settings };
        refused(&Change::Settings { base_revision: 1, settings: short }, "2 deadbands for 3 masses");
        refused(&Change::Impulse { mass: 3, velocity: C64::new(1.0, 0.0) }, "no mass 4: there are 3");
        refused(&Change::Impulse { mass: 0, velocity: C64::new(f64::NAN, 0.0) }, "must be finite");
    });
}

#[test]
fn settings_that_are_in_force_already_make_no_new_revision() {
    beside("composite", 1000.0, |bench, mut settings| {
        let same = bench.ask(&Change::Settings { base_revision: 1, settings: settings.clone() });
        assert_eq!((same.is_accepted(), same.revision, same.applied_at_step), (true, 1, 0));
        settings.speed = 3.0;
        let change = Change::Settings { base_revision: 1, settings: settings.clone() };
        let (first, again) = (bench.ask(&change), bench.ask(&Change::Settings { base_revision: 2, settings }));
        assert_eq!(again, first, "it is in force from the step that took it");
        // What is told of both is the one change.
        let told = bench.events(2);
        assert_eq!((told[1].happening(), told[1].revision), (Some(Happening::Settings), 2));
        // Somebody who has not seen it yet is told to look again, even if it is what he wants.
        assert_eq!(bench.ask(&change).outdated, 1);
    });
}

#[test]
fn stiff_settings_are_stepped_finer_and_what_cannot_be_followed_is_refused_to_any_client() {
    beside("composite", 1000.0, |bench, settings| {
        let change = |revision, key: &str, value: &str| {
            let mut settings = settings.clone();
            settings.assign(key, value).unwrap();
            Change::Settings { base_revision: revision, settings }
        };
        let answer = bench.ask(&change(1, "kd", "90000"));
        assert!(answer.is_accepted() && answer.substeps[0] > 10 && answer.substeps[1] == 1, "{answer:?}");
        let told = bench.wait("substeps", |b, _| (b.revision == 2).then_some(b.substeps));
        assert_eq!(told, answer.substeps[0]);
        let refused = bench.ask(&change(2, "cd", "1000000"));
        assert!(!refused.is_accepted() && refused.outdated == 0);
        let reason = refused.reason.as_str();
        assert!(reason.contains("is too long for the mode at") && reason.ends_with("would do"), "{reason}");
        let slower = bench.ask(&change(2, "kd", "-0.5"));
        assert!(slower.is_accepted() && slower.substeps == [1, told], "{slower:?}");
        // Whatever else happens meanwhile: stiff gains may trip the machine.
        let substeps = |events: Vec<Event>| -> Vec<u32> {
            events.iter().filter(|event| event.kind == 2).map(|event| event.substeps).collect()
        };
        let substeps = (3..).map(|count| substeps(bench.events(count))).find(|told| told.len() == 2).unwrap();
        assert_eq!(substeps, [told, 1]);
    });
}

/// A gain that is stiff about R = 2 alone: a machine that is below it and was sent beyond comes through it, wherever else it is sent then.
#[test]
fn a_machine_on_its_way_is_stepped_as_fine_as_what_lies_between() {
    beside("composite", 1000.0, |bench, settings| {
        let mut settings = settings.clone();
        settings.ramp = 0.005;
        let gain = settings.feedback.first_mut().signals[0].gain_mut(rotor::GainKind::Kd);
        *gain = rotor::Gain::Table(vec![(1.9, gain.at(0.0)), (2.0, 90000.0), (2.1, gain.at(0.0))]);
        let mut ask = |revision, speed| {
            settings.speed = speed;
            bench.ask(&Change::Settings { base_revision: revision, settings: settings.clone() })
        };
        let through = ask(1, 1.5);
        assert!(through.is_accepted() && through.substeps[0] > 10, "{through:?}");
        // It is still above R = 2, though what is in force ends below.
        let back = ask(2, 1.4);
        assert!(back.is_accepted() && back.substeps[0] == through.substeps[0], "{back:?}");
    });
}
