//! Slopes against differences, and what modes and poles are worth against their definitions.

use proptest::prelude::*;

use super::*;
use crate::opened::Place;
use crate::{Family, FamilyAxis, FamilyQuantity, Schedule, Structure};

fn problem(delay: f64, individual: bool, around: impl Fn(&mut rotor::Feedback)) -> Problem {
    let rotor = rotor::builtin::rotor("three-mass").unwrap();
    let mut family = Family::new(&rotor, 0.0, 7.0).unwrap();
    family.any_deadband(true).unwrap();
    if delay > 0.0 {
        family.push(FamilyAxis { quantity: FamilyQuantity::Delay, from: delay, to: delay }).unwrap();
    }
    let mut template =
        if individual { Structure::individual(3, 0, &[0, 1]) } else { Structure::composite(3, 0, &[0, 1]) };
    around(&mut template);
    let structure = Structure::new(&rotor, &template, Schedule::table(0.0, 7.0, 3)).unwrap();
    Problem {
        force_limit: Some(2.0),
        max_sensitivity: Some(1.5),
        min_delay: Some(0.3),
        ..Problem::new(family, structure, 20.0)
    }
}

/// Slopes of poles and force are those of differences, with and without delay, for every gain at every knot.
fn slopes_agree(problem: &Problem, gains: &[f64], point: &[f64], h: f64) -> Result<(), TestCaseError> {
    let mut evaluator = Evaluator::new(problem, &[point.to_vec()]);
    evaluator.evaluate(gains);
    let readings = evaluator.readings.clone();
    let mut force_slope = vec![0.0; gains.len()];
    evaluator.relative_force(0, gains, &mut force_slope);
    let opened = evaluator.conditions[0].opened.as_ref().expect("margins are asked for");
    let places = opened.places(problem, gains, &[]).into_iter().map(|place| {
        let mut slope = vec![0.0; gains.len()];
        opened.slope(problem, gains, &place, &mut slope);
        (place, slope)
    });
    let places: Vec<(Place, Vec<f64>)> = places.collect();
    let slopes: Vec<Vec<C64>> = readings.iter().map(|r| evaluator.pole_slope(*r).to_vec()).collect();
    for i in 0..gains.len() {
        let shifted = |by: f64| {
            let mut there = gains.to_vec();
            there[i] += by;
            there
        };
        let mut poles_at = |by: f64| {
            evaluator.evaluate(&shifted(by));
            evaluator.readings.iter().map(|r| r.pole).collect::<Vec<_>>()
        };
        let (after, before) = (poles_at(h), poles_at(-h));
        for (reading, slope) in readings.iter().zip(&slopes) {
            let gap =
                readings.iter().filter(|r| r != &reading).map(|r| (r.pole - reading.pole).norm()).fold(1.0, f64::min);
            // Slopes change fast near a merger, and differences say little; of a shaft several slow poles lie close together.
            let is_crowded = !problem.structure.is_chain() && rotor::damping_ratio(reading.pole) > 0.9;
            if gap < 0.05 || reading.pole.norm() > 20.0 || is_crowded {
                continue;
            }
            let near = |poles: &[C64]| {
                poles
                    .iter()
                    .copied()
                    .min_by(|a, b| (a - reading.pole).norm().total_cmp(&(b - reading.pole).norm()))
                    .unwrap()
            };
            let difference = (near(&after) - near(&before)) / (2.0 * h);
            prop_assert!(
                (difference - slope[i]).norm() < 1e-3 * (1.0 + slope[i].norm() / gap),
                "{difference} {}",
                slope[i]
            );
        }
        // Margins: each place beside the same one a little further on.
        let near: Vec<C64> = places.iter().map(|(place, _)| C64::new(0.0, place.frequency)).collect();
        let opened = evaluator.conditions[0].opened.as_ref().expect("margins are asked for");
        let shifts = [h, -h, h / 4.0, -h / 4.0].map(|by| opened.places(problem, &shifted(by), &near));
        let same = |all: &[Place], place: &Place| {
            let alike = all.iter().filter(|o| (o.ask, o.bearing) == (place.ask, place.bearing)).copied();
            let distance = |p: &Place| (p.frequency - place.frequency).abs();
            alike.min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|found| distance(found) < 1e-2)
        };
        for (place, slope) in &places {
            let found = shifts.each_ref().map(|all| same(all, place));
            let [Some(after), Some(before), Some(soon), Some(just)] = found else {
                continue; // About to merge with another, or another.
            };
            if slope[i].abs() > 1e3 {
                continue;
            }
            let difference = (after.in_hand - before.in_hand) / (2.0 * h);
            // What a shorter step changes is what the bend of a sharp resonance, and rounding, do to a difference.
            let doubt = 2.0 * (difference - 2.0 * (soon.in_hand - just.in_hand) / h).abs();
            prop_assert!(
                (difference - slope[i]).abs() < 2e-3 * (1.0 + slope[i].abs()) + doubt,
                "{place:?}: {difference} {} {doubt}",
                slope[i]
            );
        }
        let force_difference = |h: f64| {
            let [after, before] = [h, -h].map(|by| evaluator.relative_force(0, &shifted(by), &mut []));
            (after - before) / (2.0 * h)
        };
        let difference = force_difference(h);
        let doubt = 2.0 * (difference - force_difference(h / 4.0)).abs();
        prop_assert!(
            (difference - force_slope[i]).abs() < 1e-4 * (1.0 + force_slope[i].abs()) + doubt,
            "{difference} {} {doubt}",
            force_slope[i]
        );
    }
    Ok(())
}

/// Loops of every kind.
fn around(feedback: &mut rotor::Feedback, kind: i32) {
    match kind {
        1 => feedback.bearings[0].parts.lag = 0.05,
        2 => feedback.bearings[0].signals[0].filters = vec![rotor::Filter::Lead { zero: 3.0, pole: 12.0 }],
        3 => feedback.bearings[0].parts.sample = 0.1,
        _ => (),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn slopes_are_those_of_differences(
        seed in prop::collection::vec(-2.0..2.0f64, 24),
        speed in 0.5..6.5f64,
        factors in (0.1..1.0f64, 0.1..1.0f64),
        delay in prop_oneof![Just(0.0), 0.01..0.3f64],
        individual in any::<bool>(),
        kind in 0..4,
    ) {
        let problem = problem(delay, individual, |feedback| around(feedback, kind));
        let gains = &seed[..problem.structure.variables()];
        let mut point = vec![speed, factors.0, factors.1];
        if delay > 0.0 {
            point.push(delay);
        }
        slopes_agree(&problem, gains, &point, 1e-6)?;
    }
}

/// A chain under two bearings, each reading both ends, the second through a filter.
fn two_bearings(lag: f64, delay: f64) -> Problem {
    let rotor = rotor::builtin::rotor("three-mass").unwrap();
    let mut template = Structure::individual(3, 0, &[0, 2]);
    let mut other = Structure::individual(3, 2, &[1, 2]).bearings.remove(0);
    other.signals[0].filters = vec![rotor::Filter::Lead { zero: 3.0, pole: 12.0 }];
    template.bearings.push(other);
    template.bearings[0].parts.lag = lag;
    template.set_delay(delay);
    let structure = Structure::new(&rotor, &template, Schedule::Linear { from: 0.0, to: 7.0 }).unwrap();
    let family = Family::new(&rotor, 0.0, 7.0).unwrap();
    let limits = Problem::new(family, structure, 20.0);
    Problem { force_limit: Some(2.0), max_sensitivity: Some(1.5), min_delay: Some(0.3), ..limits }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn slopes_through_several_bearings_are_those_of_differences(
        seed in prop::collection::vec(-1.0..1.0f64, 32),
        speed in 0.5..6.5f64,
        lag in prop_oneof![Just(0.0), Just(0.05)],
        delay in prop_oneof![Just(0.0), Just(0.1)],
    ) {
        slopes_agree(&two_bearings(lag, delay), &seed, &[speed], 1e-6)?;
    }

    #[test]
    fn slopes_of_a_shaft_on_magnetic_bearings_are_those_of_differences(
        seed in prop::collection::vec(-0.3..0.3f64, 8),
        speed in 0.5..6.0f64,
    ) {
        let rotor = rotor::builtin::rotor("rig").unwrap();
        let own = rotor::builtin::feedback(&rotor, "own").unwrap();
        let structure = Structure::new(&rotor, &own, Schedule::Fixed).unwrap();
        let gains: Vec<f64> = structure.own().iter().zip(&seed).map(|(own, by)| own + by).collect();
        let family = Family::new(&rotor, 0.0, 6.0).unwrap();
        let limits = Problem::new(family, structure, 4.0);
        let problem = Problem { force_limit: Some(2.0), max_sensitivity: Some(1.5), min_delay: Some(0.01), ..limits };
        // Its fastest poles are a million times as fast as its slowest: rounding is larger too.
        slopes_agree(&problem, &gains, &[speed], 1e-4)?;
    }
}

/// Past the frequency up to which modes count a mode is worth ever more, without a jump, and stability is stability everywhere.
#[test]
fn modes_past_the_limit_are_worth_more_but_never_what_they_are_not() {
    let rotor = rotor::builtin::rotor("rig").unwrap();
    let own = rotor::builtin::feedback(&rotor, "own").unwrap();
    let structure = Structure::new(&rotor, &own, Schedule::Fixed).unwrap();
    let problem = Problem::new(Family::new(&rotor, 0.0, 6.0).unwrap(), structure, 4.0);
    let below = problem.below.expect("a shaft's modes count up to somewhere");
    for part in [0.5, 1.0, 1.1, 1.3, 3.0] {
        for damping in [-0.01, 0.0, 0.01] {
            let pole = C64::from_polar(part * below, std::f64::consts::FRAC_PI_2 + f64::asin(damping));
            let (worth, plain) = (problem.worth(pole), problem.measure.of(pole));
            assert_eq!(worth > 0.0, plain > 0.0);
            assert!(worth >= plain && (part > 1.0 && damping > 0.0 || worth == plain), "{part} {damping}: {worth}");
            let h = 1e-7 * below;
            let slope = problem.worth_slope(crate::measure::Aspect::Ratio, pole);
            for (k, step) in [C64::from(h), C64::new(0.0, h)].into_iter().enumerate() {
                if part == 1.0 || damping == 0.0 {
                    continue; // A corner.
                }
                let difference = (problem.worth(pole + step) - problem.worth(pole - step)) / (2.0 * h);
                assert!(
                    (difference - slope[k]).abs() < 1e-4 * (1.0 + slope[k].abs()),
                    "{part}: {difference} {}",
                    slope[k]
                );
            }
        }
    }
}

/// Every pole that is evaluated solves the equation with the delay in it.
#[test]
fn val_poles_with_delay_solve_the_transcendental_equation() {
    let problem = problem(0.2, false, |_| ());
    let gains: Vec<f64> = (0..problem.structure.variables()).map(|i| 0.3 * (i as f64).cos()).collect();
    let point = [5.0, 1.0, 1.0, 0.2];
    let operating = Operating::at(&problem, &point);
    let row = problem.structure.row(&gains, 5.0);
    let (_, poles) = operating.close(&problem, &gains, &[]).unwrap();
    assert!(poles.len() >= 6, "{poles:?}");
    for s in poles {
        let late = (-s * 0.2).exp();
        let mut row = row;
        row.displacement.iter_mut().chain(&mut row.velocity).for_each(|gain| *gain *= late);
        let mut seen = operating.open.clone().expect("a plain chain");
        seen.control(&row);
        // det(s^2 I - s D - K) by cofactors.
        let q = |i: usize, j: usize| {
            let own = if i == j { s * s } else { C64::ZERO };
            own - seen.stiffness()[3 * i + j] - s * seen.damping()[3 * i + j]
        };
        let minor = |a: usize, b: usize| q(1, a) * q(2, b) - q(1, b) * q(2, a);
        let det = q(0, 0) * minor(1, 2) - q(0, 1) * minor(0, 2) + q(0, 2) * minor(0, 1);
        assert!(det.norm() < 1e-9 * (1.0 + s.norm()).powi(6), "{s} {det}");
    }
}

/// A chain under two bearings whose filters all move but one: of signals, of a sum, shared and not, with a zero on the axis.
fn moving(kind: i32) -> Problem {
    let rotor = rotor::builtin::rotor("three-mass").unwrap();
    let mut template = Structure::individual(3, 0, &[0, 1]);
    template.bearings.push(Structure::individual(3, 2, &[2]).bearings.remove(0));
    let transfer = rotor::Filter::Transfer { numerator: vec![0.5, 2.0, 0.3], denominator: vec![1.0, 6.0, 40.0] };
    template.bearings[0].signals[0].filters =
        vec![rotor::Filter::Lead { zero: 3.0, pole: 12.0 }, rotor::Filter::Lowpass { corner: 25.0, order: 3 }];
    template.bearings[0].signals[1].filters = vec![transfer];
    template.bearings[0].filters =
        vec![rotor::Filter::Notch { frequency: 2.1, width: 0.6 }, rotor::Filter::Lowpass { corner: 60.0, order: 1 }];
    template.bearings[1].filters = vec![
        rotor::Filter::SynchronousNotch { width: 0.3 },
        rotor::Filter::Integrator { rate: 0.2 },
        rotor::Filter::Derivative { corner: 15.0 },
    ];
    match kind {
        1 => template.bearings[0].parts.lag = 0.05,
        2 => template.set_delay(0.08),
        3 => template.bearings.iter_mut().for_each(|bearing| bearing.parts.sample = 0.1),
        _ => (),
    }
    let corners = crate::Corner::all(&template);
    assert_eq!(corners.len(), 12);
    // The first lead of the first bearing stays as it is.
    let corners = corners.into_iter().filter(|corner| !corner.name.starts_with("1.signal.1.filter.1.")).collect();
    let structure = Structure::new(&rotor, &template, Schedule::Fixed).unwrap();
    let structure = structure.with_corners(corners);
    let limits = Problem::new(Family::new(&rotor, 0.0, 7.0).unwrap(), structure, 20.0);
    Problem { force_limit: Some(2.0), max_sensitivity: Some(1.5), min_delay: Some(0.3), ..limits }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]
    #[test]
    fn slopes_in_corners_are_those_of_differences(
        seed in prop::collection::vec(-1.0..1.0f64, 12 + 10),
        speed in 0.5..6.5f64,
        kind in 0..4,
    ) {
        let problem = moving(kind);
        prop_assert_eq!(problem.structure.variables(), seed.len());
        slopes_agree(&problem, &seed, &[speed], 1e-6)?;
    }

    #[test]
    fn slopes_in_the_corners_of_a_shafts_own_law_are_those_of_differences(
        seed in prop::collection::vec(-0.3..0.3f64, 8 + 8),
        speed in 0.5..6.0f64,
    ) {
        let rotor = rotor::builtin::rotor("rig").unwrap();
        let own = rotor::builtin::feedback(&rotor, "own").unwrap();
        let structure = Structure::new(&rotor, &own, Schedule::Fixed).unwrap();
        let structure = structure.with_corners(crate::Corner::all(&own));
        let gains: Vec<f64> = structure.own().iter().zip(&seed).map(|(own, by)| own + by).collect();
        let limits = Problem::new(Family::new(&rotor, 0.0, 6.0).unwrap(), structure, 4.0);
        let problem = Problem { force_limit: Some(2.0), max_sensitivity: Some(1.5), min_delay: Some(0.01), ..limits };
        slopes_agree(&problem, &gains, &[speed], 1e-4)?;
    }
}
