//! The delay margin that a search tells, against a count of the closed loop's roots with that delay: none in the right half plane just
//! below it, and one just above.

use control::Feedback;
use rotor::{Characteristic, LinearForm, OperatingPoint, Plant, Rotor, builtin};
use tuner::{Family, Options, Problem, Schedule, Stop, Structure, evaluate, tune};

const R_OF_RPM: f64 = 4.264_49 / 12_000.0;

/// The blower of the book, whose fastest modes are far above what its search counts.
fn blower() -> (Rotor, Feedback) {
    let page = include_str!("../../../docs/book/src/bring-a-rotor.md");
    let drawing = page.split("```toml blower.toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("there");
    let rotor = rotor::file::read_rotor(drawing, "blower").expect("it is in the book");
    let own = builtin::feedback(&rotor, "own").expect("it has a law");
    (rotor, own)
}

fn problem(rotor: &Rotor, template: &Feedback, speed: f64) -> Problem {
    let structure = Structure::new(rotor, template, Schedule::Fixed).expect("fits");
    let bound = structure.default_bound();
    Problem::new(Family::new(rotor, speed, speed).expect("a range"), structure, bound)
}

/// Whether the machine is stable with more delay in every command.
fn is_stable(rotor: &Rotor, feedback: &Feedback, speed: f64, more: f64) -> bool {
    let mut late = feedback.clone();
    late.set_delay(feedback.delay() + more);
    let form = LinearForm::of(&Plant::of(rotor), &late, &OperatingPoint::at(speed)).expect("fits");
    Characteristic::of(&form).expect("finite").roots().expect("counted").iter().all(|root| root.pole.re < 0.0)
}

fn assert_margin(rotor: &Rotor, feedback: &Feedback, speed: f64, told: f64, about: &str) {
    assert!(is_stable(rotor, feedback, speed, 0.999 * told), "{about}: unstable below {told}");
    assert!(!is_stable(rotor, feedback, speed, 1.001 * told), "{about}: stable above {told}");
}

/// The search kept to the modes up to 300 Hz and did not see that a crossing at 2.7 kHz bears half of the delay that it told.
#[test]
fn val_regress_a_search_sees_the_delay_margin_of_modes_that_it_does_not_count() {
    let (rotor, own) = blower();
    let scales = rotor.scales().expect("in SI units");
    for (rpm, seconds) in [(12_000.0, 2.4e-4), (15_000.0, 2e-4)] {
        let speed = rpm * R_OF_RPM;
        let asked = Problem {
            below: Some(300.0 * std::f64::consts::TAU / scales.w0),
            max_sensitivity: Some(3.0),
            min_delay: Some(seconds * scales.w0),
            ..problem(&rotor, &own, speed)
        };
        let found = tune(&asked, &Options { starts: 1, ..Options::for_problem(&asked) }, &|_| (), Stop::NEVER);
        let found = found.expect("makes sense");
        let [_, (least, _)] = found.margins.expect("asked for");
        let told = least.delay.expect("some delay makes it unstable").0;
        assert_margin(&rotor, &found.feedback, speed, told, "the blower");
        assert!(told >= 0.999 * seconds * scales.w0, "{told} of {}", seconds * scales.w0);
    }
}

/// Gains at random about those of a law, of two drawings and of a chain under two control bearings.
#[test]
fn val_margins_told_of_any_gains_are_where_the_count_of_roots_changes() {
    let chain = builtin::rotor("three-mass").expect("built in");
    let mut both = Structure::individual(3, 0, &[0, 1]);
    both.bearings.extend(Structure::individual(3, 2, &[1, 2]).bearings);
    let rig = builtin::rotor("rig").expect("built in");
    let (blower, own) = blower();
    let own_of_rig = builtin::feedback(&rig, "own").expect("it has a law");
    let mut random = fastrand::Rng::with_seed(5);
    for (rotor, template, speed, wanted) in
        [(&blower, &own, 4.0, 25), (&rig, &own_of_rig, 3.0, 6), (&chain, &both, 2.0, 25)]
    {
        let asked = Problem { max_sensitivity: Some(2.0), ..problem(rotor, template, speed) };
        let options = Options { prove: false, ..Options::for_problem(&asked) };
        let mut seen = 0;
        for _ in 0..40 * wanted {
            let about =
                |own: f64| if own == 0.0 { 0.6 * (random.f64() - 0.5) } else { own * (0.3 + 2.0 * random.f64()) };
            let gains: Vec<f64> = asked.structure.own().into_iter().map(about).collect();
            let feedback = asked.structure.feedback(&gains);
            if !is_stable(rotor, &feedback, speed, 0.0) {
                continue;
            }
            let found = evaluate(&asked, &options, &gains, Stop::NEVER).expect("makes sense");
            let [_, (least, _)] = found.margins.expect("asked for");
            let Some((told, _)) = least.delay else { continue };
            assert_margin(rotor, &feedback, speed, told, &format!("{} with {gains:?}", rotor.name()));
            seen += 1;
            if seen == wanted {
                break;
            }
        }
        assert_eq!(seen, wanted, "{}", rotor.name());
    }
}
