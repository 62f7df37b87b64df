//! Bearings on pedestals, and couplings between two shafts: beside ROSS, and what is refused.

use beam::{C64, Coupling, Drawing, FullModel, Material, Pedestal, Section, Sketch, import_ross, lost, read, write};
use serde_json::Value;

const PEDESTAL: &str = include_str!("cases/pedestal.toml");
const COUPLING: &str = include_str!("cases/coupling.toml");

fn rotor(text: &str) -> (Drawing, FullModel) {
    let (drawing, _) = import_ross(text, false).unwrap_or_else(|faults| panic!("{faults}"));
    let full = drawing.full();
    (drawing, full)
}

fn refused(text: &str) -> String {
    import_ross(text, false).expect_err("refused").to_string()
}

/// How far the eigenvalues at a speed are from those that ROSS has, at most, in parts of their size.
fn off(ours: &[C64], theirs: &Value) -> f64 {
    let mut left: Vec<C64> = ours.iter().flat_map(|&pole| [pole, pole.conj()]).collect();
    let mut worst = 0.0_f64;
    for pair in theirs.as_array().expect("a list") {
        let [re, im] = [0, 1].map(|part| pair[part].as_f64().expect("a number"));
        let distance = |pole: &C64| (pole - C64::new(re, im)).norm();
        let nearest = (0..left.len()).min_by(|&a, &b| distance(&left[a]).total_cmp(&distance(&left[b])));
        let pole = left.swap_remove(nearest.expect("one is left"));
        worst = worst.max(distance(&pole) / re.hypot(im));
    }
    worst
}

#[test]
fn val_rotors_on_pedestals_and_with_couplings_are_those_of_ross() {
    let expected: Value = serde_json::from_str(include_str!("cases/linked_eigenvalues.json")).expect("JSON");
    for (name, text, coordinates) in [("pedestal", PEDESTAL, 7 * 2 + 2), ("coupling", COUPLING, 8 * 2)] {
        let (drawing, full) = rotor(text);
        assert_eq!(full.mass.nrows(), coordinates);
        let reduced = full.reduce(&drawing, 16).expect("a reduction");
        for (speed, theirs) in expected[name].as_object().expect("speeds") {
            let speed: f64 = speed.parse().expect("a speed");
            let ours = full.eigenvalues(speed).expect("eigenvalues");
            assert!(off(&ours, theirs) < 1e-8, "{name} at {speed} rad/s: {:e}", off(&ours, theirs));
        }
        let lost = lost(&full, &reduced, &[0.0, 600.0], 1500.0).expect("poles");
        assert!(lost.worst_frequency() < 1e-4, "{name}: {lost:?}");
        assert_eq!(read(&write(&drawing), "other").expect("a drawing"), drawing, "{name}");
    }
}

#[test]
fn pedestals_are_coordinates_of_their_own_however_few_there_are() {
    let (drawing, full) = rotor(PEDESTAL);
    assert_eq!((drawing.pedestals.len(), drawing.stations()), (2, 7));
    assert_eq!((drawing.bearings[0].pedestal, drawing.bearings[1].pedestal), (Some(0), Some(1)));
    assert_eq!(drawing.pedestals[1], Pedestal { mass: 23.0, stiffness: 2e7, damping: 500.0, cross_stiffness: 0.0 });
    assert_eq!(full.pedestals.iter().map(|place| place.position).collect::<Vec<_>>(), [0.0, 1.5]);
    for coordinates in [3, 6, 10] {
        let reduced = full.reduce(&drawing, coordinates).expect("a reduction");
        let pedestals = reduced.stations.iter().filter(|place| place.pedestal.is_some()).count();
        assert_eq!((reduced.coordinates(), pedestals), (coordinates, 2));
        for place in &reduced.stations {
            let own = full.row(place) * &reduced.shape;
            let others = own.iter().filter(|part| part.abs() < 1e-9).count();
            assert!(own.amax() - 1.0 < 1e-9 && others == coordinates - 1, "{place:?}: {own}");
        }
    }
    // A pedestal that is far stiffer than its bearing is the ground.
    let mut sketch = drawing.clone().into_sketch();
    sketch.pedestals.iter_mut().for_each(|pedestal| pedestal.stiffness = 1e14);
    let stiff = Drawing::new(sketch.clone()).expect("a drawing").full().eigenvalues(300.0).expect("poles");
    sketch.pedestals.clear();
    sketch.bearings.iter_mut().for_each(|bearing| bearing.pedestal = None);
    let ground = Drawing::new(sketch).expect("a drawing").full().eigenvalues(300.0).expect("poles");
    for (a, b) in stiff.iter().zip(&ground).take(8) {
        assert!((a - b).norm() < 1e-5 * b.norm(), "{a} {b}");
    }
}

/// A rotor that turns freely about the one bearing that it has keeps that motion when the bearing stands on a pedestal.
#[test]
fn a_rotor_on_one_pedestal_still_turns_freely_about_it() {
    let (drawing, _) = rotor(PEDESTAL);
    let mut sketch = drawing.into_sketch();
    sketch.bearings.truncate(1);
    sketch.pedestals.truncate(1);
    let full = Drawing::new(sketch.clone()).expect("a drawing").full();
    let free = full.free_motions();
    assert_eq!(free.len(), 1);
    let resisted = (&full.stiffness * &free[0]).amax() + free[0][0].abs() + free[0][full.mass.nrows() - 1].abs();
    assert!(resisted < 1e-6, "{resisted}");
    sketch.bearings[0].stiffness = 0.0.into();
    sketch.bearings[0].cross_stiffness = 0.0.into();
    assert_eq!(Drawing::new(sketch).expect("a drawing").full().free_motions().len(), 2);
}

#[test]
fn what_a_pedestal_cannot_be_is_refused_by_name() {
    for (from, to, told) in [
        ("n_link = 7", "n_link = 3", "n_link = 3: expected a node beyond the shaft, 7 or more, with a PointMass"),
        ("n_link = 7", "n_link = 9", "n_link = 9: expected a node beyond the shaft"),
        (
            "kxx = [ 40000000.0,]",
            "kxx = [ 4e7,]\nn_link = 8",
            "expected a PointMass, or a bearing between it and the ground",
        ),
        ("kxx = [ 40000000.0,]", "kxx = [ 1e7,]", "kxx = 10000000, kyy = 40000000: expected kyy = kxx"),
        ("my = 11.0", "my = 12.0", "mx = 11, my = 12: expected my = mx"),
        ("mxx = [ 0,]", "mxx = [ 2.0,]", "mxx = 1 beside n_link: expected 0"),
    ] {
        assert!(PEDESTAL.contains(from), "{from}");
        let found = refused(&PEDESTAL.replacen(from, to, 1));
        assert!(found.contains(told), "{from} -> {to}\n is {found}\nnot {told}");
    }
    let (drawing, _) = rotor(PEDESTAL);
    let text = write(&drawing);
    for (from, to, told) in [
        ("pedestal = 2", "pedestal = 3", "pedestal = 3"),
        ("pedestal = 2", "pedestal = 1", "pedestal 2: expected pedestal = 2 in a [[bearing]]: nothing stands on it"),
        ("pedestal = 2", "pedestal = 2\nclearance = 1e-4", "clearance = 0.0001: expected none beside pedestal"),
        ("mass = 23.0", "mass = 0", "mass = 0: expected a finite number greater than 0"),
        ("units = \"si\"", "units = \"si\"\ncoordinates = 2", "coordinates = 2: expected 3 to 16"),
    ] {
        assert!(text.contains(from), "{from} in {text}");
        let found = read(&text.replacen(from, to, 1), "a").expect_err(to).to_string();
        assert!(found.contains(told), "{from} -> {to}\n is {found}\nnot {told}");
    }
}

#[test]
fn couplings_weigh_as_discs_and_differ_in_no_direction() {
    let (drawing, full) = rotor(COUPLING);
    let coupling = Coupling { stiffness: 6e7, damping: 90.0, tilt_stiffness: 4e4, tilt_damping: 1.5 };
    assert_eq!(drawing.sections[3].coupling, Some(coupling));
    let [left, right] = [3, 4].map(|station| {
        let disc = drawing.discs.iter().find(|disc| disc.station == station).expect("a hub");
        [disc.mass, disc.diametral_inertia, disc.polar_inertia]
    });
    // ROSS takes half the polar inertia where no other is given.
    assert_eq!((left, right), ([3.5, 0.012, 0.02], [4.5, 0.015, 0.03]));
    let shift = |at: usize| full.nodes[at].position;
    assert_eq!((shift(3), shift(4)), (0.75, 0.9));
    let told = refused(&COUPLING.replacen("kt_x = 60000000.0", "kt_x = 5e7", 1));
    assert!(told.contains("kt_x = 50000000, kt_y = 60000000: expected kt_y = kt_x"), "{told}");
    let (averaged, notes) = import_ross(&COUPLING.replacen("kr_y = 40000.0", "kr_y = 5e4", 1), true).expect("a mean");
    assert_eq!(averaged.sections[3].coupling.as_ref().map(|of| of.tilt_stiffness), Some(4.5e4));
    assert!(notes.iter().any(|note| note.averaged && note.text.contains("kr_x = 40000, kr_y = 50000")), "{notes:?}");
    let told = refused(&COUPLING.replacen("n = 3\n", "n = 2\n", 1));
    assert!(told.contains("expected"), "{told}");

    let text = write(&drawing);
    let wrong = read(&text.replacen("coupling = {", "outer = 0.1\ncoupling = {", 1), "a").expect_err("a key too many");
    assert!(wrong.to_string().contains("outer"), "{wrong}");
    let wrong = read(&text.replacen("coupling = { stiffness = 6", "coupling = { stiffness = -6", 1), "a");
    assert!(wrong.expect_err("negative").to_string().contains("stiffness = -6"));
    let steel = Material { name: "steel".into(), density: 7810.0, youngs_modulus: 211e9, shear_modulus: 81.2e9 };
    let alone = Sketch {
        name: "alone".into(),
        materials: vec![steel],
        sections: vec![Section::coupling(0.1, Coupling::default())],
        ..Sketch::default()
    };
    assert!(Drawing::new(alone).expect_err("no shaft").to_string().contains("shaft on one side of a coupling"));
}
