//! Maps against what they are made of: poles one at a time, margins, single runs from the same start, and exact limit cycles.

use std::sync::atomic::AtomicBool;

use rotor::{C64, ClosedLoop, Mass, Rotor, Settings, builtin, circular, damping_ratio, poles};
use study::map::{Map, MapAxis, MapError, MapKey, MapPlan, MapQuantity, map};
use variation::Model;

fn model(rotor: &Rotor, feedback: &str, speed: f64, deadband: f64) -> Model {
    let mut settings = Settings::new(rotor, speed, builtin::feedback(rotor, feedback).expect("built in"));
    settings.deadband.fill(deadband);
    Model::new(rotor.clone(), settings)
}

fn three_mass() -> Rotor {
    builtin::rotor("three-mass").expect("built in")
}

fn axis(model: &Model, name: &str, from: f64, to: f64, count: usize) -> MapAxis {
    let last = (count - 1) as f64;
    let values = (0..count).map(|k| from + (to - from) * k as f64 / last).collect();
    MapAxis { key: MapKey::of(model, name).expect("a key"), values }
}

fn mapped(plan: &MapPlan) -> Map {
    map(plan, &AtomicBool::new(false), &|_, _| ()).expect("a map")
}

#[test]
fn val_cells_are_poles_one_at_a_time_and_the_boundary_is_where_damping_is_zero() {
    let rotor = three_mass();
    let model = model(&rotor, "composite", 6.0, 0.0);
    let (x, y) = (axis(&model, "speed", 0.0, 8.0, 33), axis(&model, "kd", -1.5, 1.0, 21));
    let plan = MapPlan { model, x, y, quantity: MapQuantity::Damping, longest: 1.0 };
    let found = mapped(&plan);
    let damping = |speed: f64, kd: f64| {
        let mut settings = Settings::new(&rotor, speed, builtin::feedback(&rotor, "composite").expect("built in"));
        settings.set("kd".parse().expect("a key"), kd).expect("in range");
        let least = poles(&ClosedLoop::new(&rotor, &settings.feedback, speed, &[])).expect("poles");
        least.iter().map(|pole| damping_ratio(*pole)).fold(f64::INFINITY, f64::min)
    };
    for (i, x) in plan.x.values.iter().enumerate().step_by(5) {
        for (k, y) in plan.y.values.iter().enumerate().step_by(3) {
            assert!((found.values[i][k] - damping(*x, *y)).abs() < 1e-13, "{x} {y}");
        }
    }
    let points: Vec<&[f64; 2]> = found.boundary.iter().flatten().collect();
    assert!(points.len() > 20, "{}", points.len());
    assert!(points.iter().all(|[x, y]| damping(*x, *y).abs() < 1e-8), "{points:?}");
    // The thresholds of the gains as they are.
    let own = MapPlan { y: axis(&plan.model, "gain", 0.999, 1.001, 3), ..plan.clone() };
    let crossing = mapped(&own).boundary.concat().into_iter().find(|[_, gain]| (gain - 1.0).abs() < 1e-12);
    let settings = &own.model.settings;
    let expected = machine::thresholds(&rotor, settings, 0.0, 8.0).expect("thresholds");
    let [speed, _] = crossing.expect("it turns unstable");
    assert!(expected.iter().any(|of| (of.speed - speed).abs() < 1e-7), "{speed} {expected:?}");
}

#[test]
fn val_margins_and_stability_are_those_of_single_machines() {
    let rotor = three_mass();
    let model = model(&rotor, "composite", 6.0, 0.0);
    let (x, y) = (axis(&model, "delay", 0.0, 0.2, 5), axis(&model, "damping.1", 0.1, 0.4, 4));
    let plan = MapPlan { model, x, y, quantity: MapQuantity::Delay, longest: 1.0 };
    let delays = mapped(&plan);
    let stable = mapped(&MapPlan { quantity: MapQuantity::Stability, ..plan.clone() });
    let peaks = mapped(&MapPlan { quantity: MapQuantity::Sensitivity, ..plan.clone() });
    let damping = plan.model.parameter("damping.1").expect("a parameter");
    for (i, delay) in plan.x.values.iter().enumerate() {
        for (k, value) in plan.y.values.iter().enumerate() {
            let mut other = plan.model.with(&[(&damping, *value)]).expect("allowed");
            other.settings.feedback.set_delay(*delay);
            match machine::margins(&other.rotor, &other.settings, 6.0) {
                Ok(margins) => {
                    assert_eq!(stable.values[i][k], 1.0);
                    assert_eq!(delays.values[i][k], margins.margins.delay.expect("one").delay);
                    assert_eq!(peaks.values[i][k], margins.margins.sensitivity().amplitude);
                }
                Err(_) => {
                    assert!(stable.values[i][k] == 0.0 && delays.values[i][k].is_nan() && peaks.values[i][k].is_nan());
                }
            }
        }
    }
    assert!(
        delays.values.iter().flatten().any(|v| v.is_nan()) && delays.values.iter().flatten().any(|v| v.is_finite())
    );
}

#[test]
fn val_orbits_are_those_of_single_runs_and_of_exact_cycles() {
    // Balanced, past its threshold at rest in the clearance: it whirls on one exact limit cycle.
    let jeffcott = builtin::rotor("jeffcott").expect("built in");
    let mass = Mass { unbalance: 0.0, ..jeffcott.masses()[0] };
    let rotor = Rotor::new("balanced", vec![mass], vec![]).expect("valid");
    let settings =
        Settings { deadband: vec![1.0], ..Settings::new(&rotor, 1.6, builtin::feedback(&rotor, "off").expect("any")) };
    let model = Model::new(rotor.clone(), settings);
    let (x, y) = (axis(&model, "speed", 1.4, 2.0, 4), axis(&model, "start.1.vy", 0.1, 4.0, 3));
    let plan = MapPlan { model, x, y, quantity: MapQuantity::Orbit, longest: 2000.0 };
    let found = mapped(&plan);
    let exact = circular::cycles(&rotor, &plan.model.settings.feedback, &[1.0], &plan.x.values).expect("cycles");
    for (column, orbits) in found.values.iter().zip(&exact.orbits) {
        let radius = orbits.iter().map(|orbit| orbit.largest_radius()).fold(0.0, f64::max);
        assert!(column.iter().all(|value| (value / radius - 1.0).abs() < 1e-3), "{column:?} {radius}");
    }
    let cycles = mapped(&MapPlan {
        quantity: MapQuantity::Cycle,
        y: axis(&plan.model, "deadband", 1.0, 2.0, 2),
        ..plan.clone()
    });
    for (column, own) in cycles.values.iter().zip(&found.values) {
        assert!((column[0] / own[0] - 1.0).abs() < 1e-3 && (column[1] / column[0] - 2.0).abs() < 1e-9, "{column:?}");
    }
}

#[test]
fn val_impulses_lead_from_the_orbit_that_it_is_on_to_orbits_that_are_exact() {
    // Lightly damped: in its clearance, or pressed against the bearing, two orbits at one speed.
    let mass = Mass { damping: 0.05, cross_damping: 0.0, ..builtin::rotor("jeffcott").expect("built in").masses()[0] };
    let rotor = Rotor::new("rub", vec![mass], vec![]).expect("valid");
    let off = builtin::feedback(&rotor, "off").expect("any");
    let settings = Settings { deadband: vec![3.0], ..Settings::new(&rotor, 0.7, off) };
    let model = Model::new(rotor.clone(), settings);
    let (x, y) = (axis(&model, "impulse.1.vy", -4.0, 4.0, 5), axis(&model, "impulse.1.vz", -4.0, 4.0, 5));
    let plan = MapPlan { model: model.clone(), x, y, quantity: MapQuantity::Orbit, longest: 2000.0 };
    let found = mapped(&plan);
    let exact = plan.references(&|| false).expect("orbits").expect("one machine");
    let stable: Vec<f64> = exact
        .iter()
        .filter(|orbit| orbit.stability == Some(rotor::Stability::Stable))
        .map(|orbit| orbit.value)
        .collect();
    let near = |value: f64| stable.iter().position(|exact| (value / exact - 1.0).abs() < 1e-3);
    let led: Vec<usize> = found
        .values
        .iter()
        .flatten()
        .map(|value| near(*value).unwrap_or_else(|| panic!("{value} {exact:?}")))
        .collect();
    assert!(led.contains(&0) && led.contains(&1), "{exact:?} {led:?}");
    // Without a blow it stays where it is, and each cell is the run that has that blow.
    let rest = axis(&model, "start.1.y", 0.0, 1.0, 2);
    let alone = mapped(&MapPlan { x: rest, ..plan.clone() });
    assert_eq!(alone.values[0][2].to_bits(), found.values[2][2].to_bits(), "from rest, and struck by nothing");
    for cell in [0, 7, 24] {
        let [x, y] = plan.place(cell);
        let single = plan.at(x, y, &AtomicBool::new(false)).expect("a value");
        assert_eq!(single.to_bits(), found.values[(cell / 5) as usize][(cell % 5) as usize].to_bits());
    }
}

#[test]
fn val_a_start_is_where_a_run_begins() {
    let rotor = three_mass();
    let mut model = model(&rotor, "composite", 2.0, 1.0);
    model.settings.feedback = model.settings.feedback.off();
    let (x, y) = (axis(&model, "start.2.y", 0.0, 3.0, 3), axis(&model, "start.1.vz", -2.0, 2.0, 3));
    let plan = MapPlan { model, x, y, quantity: MapQuantity::Force, longest: 60.0 };
    let found = mapped(&plan);
    assert!(found.values.iter().flatten().all(|force| *force == 0.0), "no control, no force");
    let orbits = mapped(&MapPlan { quantity: MapQuantity::Orbit, ..plan.clone() });
    for (i, y) in plan.x.values.iter().enumerate() {
        for (k, vz) in plan.y.values.iter().enumerate() {
            let settle = study::run::Settle::DetectAndStop;
            let settings = &plan.model.settings;
            let mut single =
                study::run::Plan::steady(&rotor, &settings.feedback, 2.0, &settings.deadband, 60.0, settle)
                    .expect("a plan");
            let (mut p, mut v) = (vec![C64::ZERO; 3], vec![C64::ZERO; 3]);
            (p[1], v[0]) = (C64::new(*y, 0.0), C64::new(0.0, *vz));
            single.start = Some([p, v]);
            let outcome = study::run::run(&single, &mut [], &AtomicBool::new(false)).expect("a run");
            let largest = outcome.max_displacement.iter().copied().fold(0.0, f64::max);
            assert!((orbits.values[i][k] - largest).abs() <= 1e-12 * largest, "{y} {vz}");
        }
    }
}

#[test]
fn cells_side_by_side_are_those_of_single_runs_to_the_last_bit() {
    let rotor = three_mass();
    let model = model(&rotor, "composite", 6.0, 0.0);
    // Orbits that settle, that beat, that have not settled yet, and that leave all bounds.
    let (x, y) = (axis(&model, "deadband", 0.0, 2.0, 3), axis(&model, "kd", -1.0, 5.0, 7));
    for quantity in [MapQuantity::Force, MapQuantity::Orbit] {
        let plan = MapPlan { model: model.clone(), x: x.clone(), y: y.clone(), quantity, longest: 400.0 };
        let found = mapped(&plan);
        let stop = AtomicBool::new(false);
        for cell in 0..plan.cells() {
            let [x, y] = plan.place(cell);
            let own = found.values[(cell / 7) as usize][(cell % 7) as usize];
            let alone = plan.at(x, y, &stop).expect("a value");
            assert_eq!(own.to_bits(), alone.to_bits(), "{own} {alone} at {x}, {y}");
        }
        let numbers = found.values.iter().flatten();
        assert!(numbers.clone().any(|value| value.is_finite()) && numbers.clone().any(|value| value.is_nan()));
    }
}

#[test]
fn forces_side_by_side_are_those_of_single_runs_to_the_last_bit() {
    let rotor = three_mass();
    let feedback = builtin::feedback(&rotor, "individual").expect("built in");
    let (speeds, stop) = ([0.0, 1.0, 2.5], AtomicBool::new(false));
    let clearances = vec![vec![0.0; 3], vec![1.0; 3]];
    let found = study::force::sweep(&rotor, &feedback, &speeds, &clearances, &stop, &|| ()).expect("forces");
    for (row, clearances) in found.iter().zip(&clearances) {
        for (point, speed) in row.iter().zip(speeds) {
            let alone = study::force::steady(&rotor, &feedback, speed, clearances, &stop).expect("a force");
            assert_eq!(*point, alone, "{speed} {clearances:?}");
        }
    }
}

#[test]
fn what_makes_no_map_is_refused() {
    let rotor = three_mass();
    let model = model(&rotor, "composite", 6.0, 0.0);
    let plan = |x: MapAxis, y: MapAxis, quantity| MapPlan { model: model.clone(), x, y, quantity, longest: 1.0 };
    let (kd, cd) = (axis(&model, "kd", 0.0, 1.0, 2), axis(&model, "cd", 0.0, 1.0, 2));
    let check = |plan: MapPlan| plan.check();
    assert!(check(plan(kd.clone(), cd.clone(), MapQuantity::Damping)).is_ok());
    assert!(
        matches!(check(plan(kd.clone(), kd.clone(), MapQuantity::Damping)), Err(MapError::Twice(key)) if key == "kd")
    );
    let start = axis(&model, "start.1.y", 0.0, 1.0, 2);
    assert!(matches!(check(plan(start, cd.clone(), MapQuantity::Damping)), Err(MapError::Nothing { .. })));
    let impulse = axis(&model, "impulse.1.vy", 0.0, 1.0, 2);
    assert!(matches!(check(plan(impulse, cd.clone(), MapQuantity::Cycle)), Err(MapError::Nothing { .. })));
    let long = MapAxis { values: vec![0.0; 1 << 23], ..kd.clone() };
    assert!(matches!(
        check(plan(long, axis(&model, "cd", 0.0, 1.0, 3), MapQuantity::Damping)),
        Err(MapError::Cells(25_165_824))
    ));
    let wrong = axis(&model, "damping.1", -1.0, 1.0, 3);
    assert!(matches!(check(plan(wrong, cd, MapQuantity::Damping)), Err(MapError::Machine(_))));
    assert!(MapKey::of(&model, "start.9.y").is_err() && MapKey::of(&model, "start.1.w").is_err());
    assert!(MapKey::of(&model, "impulse.9.vy").is_err() && MapKey::of(&model, "impulse.1.y").is_err());
}
