//! Shaft elements and discs, entry by entry, beside ROSS.

use beam::{Disc, Drawing, FullModel, Material, Section, Shear, Sketch};
use nalgebra::DMatrix;
use serde_json::Value;

/// Steel as ROSS has it.
fn steel() -> Material {
    Material { name: "steel".into(), density: 7810.0, youngs_modulus: 211e9, shear_modulus: 81.2e9 }
}

fn model(section: Section, discs: Vec<Disc>) -> FullModel {
    let sketch =
        Sketch { name: "one".into(), materials: vec![steel()], sections: vec![section], discs, ..Sketch::default() };
    Drawing::new(sketch).expect("a drawing").full()
}

fn cases() -> Value {
    serde_json::from_str(include_str!("cases/element_matrices.json")).expect("JSON")
}

/// A matrix of ROSS in `x y alpha beta` of each end, as its xx and xy blocks in `x, beta` and `y, -alpha`. Fails where it is not
/// radially symmetric.
fn complex(matrix: &Value) -> [DMatrix<f64>; 2] {
    let entry = |row: usize, column: usize| matrix[row][column].as_f64().expect("a number");
    let x = |i: usize| (4 * (i / 2) + [0, 3][i % 2], 1.0);
    let y = |i: usize| (4 * (i / 2) + [1, 2][i % 2], [1.0, -1.0][i % 2]);
    let block = |rows: &dyn Fn(usize) -> (usize, f64), columns: &dyn Fn(usize) -> (usize, f64)| {
        DMatrix::from_fn(4, 4, |i, k| {
            let ((row, a), (column, b)) = (rows(i), columns(k));
            a * b * entry(row, column)
        })
    };
    let (xx, xy, yx, yy) = (block(&x, &x), block(&x, &y), block(&y, &x), block(&y, &y));
    let size = xx.amax().max(xy.amax());
    assert!((&xx - &yy).amax() <= 1e-12 * size && (&xy + &yx).amax() <= 1e-12 * size, "radially symmetric");
    [xx, xy]
}

fn compare(name: &str, what: &str, ours: &DMatrix<f64>, theirs: &DMatrix<f64>) {
    let size = theirs.amax();
    for row in 0..4 {
        for column in 0..4 {
            let (a, b) = (ours[(row, column)], theirs[(row, column)]);
            // Entry by entry; one that is 0 is beside the largest.
            let near = (a - b).abs() <= 1e-10 * b.abs() || (b.abs() < 1e-12 * size && a.abs() <= 1e-12 * size);
            assert!(near, "{name} {what}[{row}, {column}]: {a} is not {b}");
        }
    }
}

/// Hutchinson, "Shear coefficients for Timoshenko beam theory" (2001): `6 (1 + nu)^2 / (7 + 12 nu + 4 nu^2)` of a round section, from the
/// stiffness of an element so short that it only shears. ROSS has `1 + nu` once.
#[test]
fn val_the_shear_coefficient_of_hutchinson_is_that_of_his_paper() {
    let (length, outer, material) = (1e-3, 0.1, steel());
    let area = std::f64::consts::PI / 4.0 * outer * outer;
    let nu = material.poisson();
    let paper = 6.0 * (1.0 + nu).powi(2) / (7.0 + 12.0 * nu + 4.0 * nu * nu);
    for (shear, expected) in [(Shear::Hutchinson, paper), (Shear::HutchinsonOfRoss, paper / (1.0 + nu))] {
        let model = model(Section { shear, ..Section::cylinder(length, outer) }, vec![]);
        let found = model.stiffness[(0, 0)] * length / (material.shear_modulus * area);
        assert!((found - expected).abs() < 1e-3 * expected, "{found} {expected}");
    }
}

#[test]
fn val_the_matrices_of_a_shaft_element_are_those_of_ross() {
    let cases = cases();
    let solid = Section::cylinder(0.25, 0.05);
    let elements = [
        ("solid", solid.clone()),
        ("hollow", Section::tube(0.25, 0.05, 0.03)),
        ("tapered", Section { outer_right: 0.08, inner_right: 0.02, ..Section::tube(0.25, 0.05, 0.01) }),
        ("euler", Section { shear: Shear::Rigid, rotary_inertia: false, ..solid.clone() }),
        ("hutchinson", Section { shear: Shear::HutchinsonOfRoss, ..solid.clone() }),
        ("axial", Section { axial_force: 5e4, ..solid.clone() }),
        ("torque", Section { torque: 2000.0, ..solid.clone() }),
        ("damped", Section { mass_damping: 2.5, stiffness_damping: 1e-5, ..solid }),
    ];
    for (name, section) in elements {
        let case = &cases[name];
        let model = model(section, vec![]);
        let [mass, _] = complex(&case["M"]);
        let [stiffness, cross] = complex(&case["K"]);
        let [damping, _] = complex(&case["C"]);
        let [_, gyroscopic] = complex(&case["G"]);
        compare(name, "M", &model.mass, &mass);
        compare(name, "K", &model.stiffness, &stiffness);
        compare(name, "Kc", &model.cross_stiffness, &cross);
        compare(name, "C", &model.damping, &damping);
        compare(name, "G", &model.gyroscopic, &gyroscopic);
    }
}

#[test]
fn val_a_disc_is_that_of_ross() {
    let case = &cases()["disk"];
    let number = |key: &str| case[key].as_f64().expect("a number");
    let disc = Disc { station: 1, mass: number("m"), polar_inertia: number("Ip"), diametral_inertia: number("Id") };
    let [with, without] = [vec![disc], vec![]].map(|discs| model(Section::cylinder(0.25, 0.05), discs));
    let added = &with.mass - &without.mass;
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-14 * with.mass.amax(), "{found}");
    near(added[(2, 2)], number("m"));
    near(added[(3, 3)], number("Id"));
    near((&with.gyroscopic - &without.gyroscopic)[(3, 3)], number("Ip"));
    assert_eq!(added.iter().filter(|entry| **entry != 0.0).count(), 2);

    // Its size as ROSS's example has it: 280 mm over 50 mm, 70 mm wide.
    let shaped = Disc::of_shape(1, 0.28, 0.05, 0.07, 7810.0);
    for (found, key) in [(shaped.mass, "m"), (shaped.polar_inertia, "Ip"), (shaped.diametral_inertia, "Id")] {
        assert!((found / number(key) - 1.0).abs() < 1e-12, "{key}: {found}");
    }
}
