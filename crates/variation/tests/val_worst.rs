//! The worst of a box against every one of its corners, and against a grid where it is inside.

use rotor::{Settings, builtin};
use tuner::Stop;
use variation::{Model, Parameter, Range, worst};

fn model(feedback: &str, speed: f64) -> Model {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, feedback).expect("built in");
    let settings = Settings::new(&rotor, speed, feedback);
    Model::new(rotor, settings)
}

fn range(model: &Model, name: &str, from: f64, to: f64) -> Range {
    Range { parameter: model.parameter(name).expect("a parameter"), from, to }
}

fn about(model: &Model, parameter: Parameter, part: f64) -> Range {
    let value = model.value(&parameter);
    Range { from: value * (1.0 - part), to: value * (1.0 + part), parameter }
}

fn damping(model: &Model, ranges: &[Range], parts: &[f64]) -> f64 {
    let changes: Vec<(&Parameter, f64)> =
        ranges.iter().zip(parts).map(|(r, part)| (&r.parameter, r.at(*part))).collect();
    model.with(&changes).and_then(|machine| machine.min_damping()).expect("poles")
}

#[test]
fn val_the_worst_of_all_rotor_parameters_is_that_of_every_corner() {
    let model = model("individual", 6.0);
    let parameters = model.parameters().into_iter().filter(|of| of.is_of_rotor() && model.value(of) != 0.0);
    let ranges: Vec<Range> = parameters.map(|of| about(&model, of, 0.1)).collect();
    assert_eq!(ranges.len(), 11);
    let found = worst(&model, &ranges, 1e-3, 1, Stop::NEVER).expect("poles");
    let corner = |bits: u32| (0..11).map(|k| f64::from(bits >> k & 1)).collect::<Vec<f64>>();
    let least = (0..1 << 11).map(|bits| damping(&model, &ranges, &corner(bits))).fold(f64::INFINITY, f64::min);
    assert!(found.value <= least + 1e-12 && found.value > least - 1e-4, "{found:?} {least}");
    assert!(!found.proven && found.value < 0.0);
}

#[test]
fn val_a_proven_worst_is_below_a_fine_grid_and_within_its_tolerance() {
    let model = model("individual", 6.0);
    let ranges = [
        range(&model, "damping.1", 0.1, 0.4),
        range(&model, "shaft.1", 0.45, 0.55),
        range(&model, "factor.3", 0.0, 1.0),
    ];
    let found = worst(&model, &ranges, 1e-4, 1, Stop::NEVER).expect("poles");
    assert!(found.proven && found.boxes > 0, "{found:?}");
    let grid = || (0..=20).map(|k| f64::from(k) / 20.0);
    let points = grid().flat_map(|x| grid().flat_map(move |y| grid().map(move |z| [x, y, z])));
    let least = points.map(|parts| damping(&model, &ranges, &parts)).fold(f64::INFINITY, f64::min);
    assert!(found.value <= least + 1e-12 && least >= found.value - found.tolerance, "{found:?} {least}");
    let there: Vec<(&Parameter, f64)> = ranges.iter().map(|r| &r.parameter).zip(found.at.iter().copied()).collect();
    let value = model.with(&there).and_then(|machine| machine.min_damping()).expect("poles");
    assert!((value - found.value).abs() < 1e-12);
}

#[test]
fn val_a_worst_inside_a_range_is_found_and_said_to_be_no_proof_where_the_loop_is_late() {
    let mut late = model("composite", 2.5);
    late.settings.feedback.bearings[0].parts.delay = 0.02;
    // Damping of composite gains over speed and gain has its least inside.
    let ranges = [range(&late, "speed", 1.0, 5.0), range(&late, "kd", -0.8, 0.4)];
    let found = worst(&late, &ranges, 1e-3, 1, Stop::NEVER).expect("poles");
    let grid = || (0..=60).map(|k| f64::from(k) / 60.0);
    let least = grid().flat_map(|x| grid().map(move |y| [x, y])).map(|parts| damping(&late, &ranges, &parts));
    let least = least.fold(f64::INFINITY, f64::min);
    assert!(!found.proven && found.value <= least + 1e-9, "{found:?} {least}");
}

/// The blower of the book, whose numbers are few enough for every corner of a box to be looked at.
fn blower() -> Model {
    let page = include_str!("../../../docs/book/src/bring-a-rotor.md");
    let drawing = page.split("```toml blower.toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("there");
    let rotor = rotor::file::read_rotor(drawing, "blower").expect("it is in the book");
    let own = builtin::feedback(&rotor, "own").expect("it has a law");
    let settings = Settings::new(&rotor, 4.0, own);
    Model::new(rotor, settings)
}

#[test]
fn val_the_worst_of_a_drawing_is_that_of_every_corner_and_every_corner_can_be() {
    let model = blower();
    let ranges: Vec<Range> = model.unsure(&[]).into_iter().map(|of| about(&model, of, 0.2)).collect();
    let names: Vec<&str> = ranges.iter().map(|range| range.parameter.name()).collect();
    assert!(names.contains(&"disc.1.inertia") && names.contains(&"material.1.moduli"), "{names:?}");
    assert!(names.contains(&"material.1.density") && !names.contains(&"disc.1.mass"), "{names:?}");
    let count = ranges.len();
    assert!((5..11).contains(&count), "{names:?}");
    let corner = |bits: u32| (0..count).map(|k| f64::from(bits >> k & 1)).collect::<Vec<f64>>();
    let least = (0..1 << count).map(|bits| damping(&model, &ranges, &corner(bits))).fold(f64::INFINITY, f64::min);
    let found = worst(&model, &ranges, 1e-3, 1, Stop::NEVER).expect("poles");
    assert!(found.value <= least + 1e-12 && found.value > least - 0.05, "{found:?} {least}");
}

#[test]
fn what_moves_together_is_multiplied_by_one_factor_and_left_where_one_of_it_is_said() {
    let model = blower();
    let inertia = model.parameter("disc.1.inertia").expect("there is");
    let members = model.members(&inertia);
    assert_eq!(members.len(), 3);
    let heavier = model.with(&[(&inertia, 1.25)]).expect("can be");
    for member in &members {
        assert!((heavier.value(member) / model.value(member) - 1.25).abs() < 1e-12, "{member}");
    }
    let mass = model.parameter("disc.1.mass").expect("there is");
    let rest = model.unsure(&[&mass]);
    assert!(rest.iter().all(|of| !of.name().starts_with("disc.1.")), "{rest:?}");
    assert!(rest.iter().any(|of| of.name() == "material.1.moduli"));
    assert!(model.with(&[(&inertia, 0.0)]).is_err() && model.parameter("disc.9.inertia").is_err());
}
