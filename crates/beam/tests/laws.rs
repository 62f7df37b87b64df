//! Laws that hold for every drawing.

use beam::{Bearing, C64, Disc, Drawing, FullModel, Material, PointMass, Section, Shear, Sketch, Sleeve};
use nalgebra::{Cholesky, DVector};
use proptest::prelude::*;

fn section() -> impl Strategy<Value = Section> {
    let shear =
        prop_oneof![Just(Shear::Cowper), Just(Shear::Hutchinson), Just(Shear::HutchinsonOfRoss), Just(Shear::Rigid)];
    let sizes = (0.05..0.4_f64, 0.02..0.1_f64, 0.02..0.1_f64, 0.0..0.9_f64, 0.0..0.9_f64);
    (sizes, 1..4_usize, shear, 0..2_usize).prop_map(
        |((length, outer, right, bore, bore_right), elements, shear, material)| Section {
            outer_right: right,
            inner_right: right * bore_right,
            elements,
            shear,
            material,
            ..Section::tube(length, outer, outer * bore)
        },
    )
}

/// A rotor without damping and without anything that drives it.
fn conservative() -> impl Strategy<Value = Sketch> {
    let discs = prop::collection::vec((0..100_usize, 0.1..30.0_f64, 0.01..0.5_f64, 0.5..1.9_f64), 0..3);
    // At both ends: a rotor that can move freely has a double pole at 0, which rounding splits by its square root.
    let bearings = (1e5..1e8_f64, 1e5..1e8_f64);
    let sections = prop::collection::vec(section(), 1..5);
    (sections, discs, bearings, 0..100_usize, 0.1..3.0_f64, any::<bool>()).prop_map(
        |(sections, discs, bearings, at, mass, sleeved)| {
            let stations = sections.len() + 1;
            let material = |name: &str, density, youngs_modulus| Material {
                name: name.into(),
                density,
                youngs_modulus,
                shear_modulus: youngs_modulus / 2.6,
            };
            let first = &sections[0];
            let (outer, outer_right) = (1.3 * first.outer, 1.3 * first.outer_right);
            let layer =
                Section { outer, outer_right, inner: first.outer, inner_right: first.outer_right, ..first.clone() };
            Sketch {
                name: "any".into(),
                materials: vec![material("steel", 7810.0, 211e9), material("titanium", 4430.0, 114e9)],
                sleeves: if sleeved { vec![Sleeve { section: 0, layer }] } else { vec![] },
                discs: discs
                    .into_iter()
                    .map(|(at, mass, inertia, ratio)| Disc {
                        station: at % stations,
                        mass,
                        diametral_inertia: inertia,
                        polar_inertia: ratio * inertia,
                    })
                    .collect(),
                point_masses: vec![PointMass { station: at % stations, mass }],
                bearings: [(0, bearings.0), (stations - 1, bearings.1)]
                    .map(|(station, k)| Bearing { station, stiffness: k.into(), ..Bearing::default() })
                    .into(),
                sections,
                ..Sketch::default()
            }
        },
    )
}

/// The same with damping of every kind that knows no direction of spin.
fn damped() -> impl Strategy<Value = Sketch> {
    (conservative(), 0.0..5.0_f64, 0.0..1e-5_f64, 0.0..1e-5_f64, 0.0..1e3_f64).prop_map(
        |(mut sketch, mass, stiffness, internal, bearing)| {
            sketch.mass_damping = mass;
            for section in &mut sketch.sections {
                section.stiffness_damping = stiffness;
                section.internal_damping = internal;
            }
            sketch.bearings.iter_mut().for_each(|it| it.damping = bearing.into());
            sketch
        },
    )
}

fn drawing(sketch: Sketch) -> Drawing {
    Drawing::new(sketch).expect("a drawing")
}

fn mirrored(mut sketch: Sketch) -> Sketch {
    let last = sketch.sections.len();
    let turned = |section: &Section| Section {
        outer: section.outer_right,
        outer_right: section.outer,
        inner: section.inner_right,
        inner_right: section.inner,
        ..section.clone()
    };
    sketch.sections = sketch.sections.iter().rev().map(turned).collect();
    for sleeve in &mut sketch.sleeves {
        *sleeve = Sleeve { section: last - 1 - sleeve.section, layer: turned(&sleeve.layer) };
    }
    sketch.discs.iter_mut().for_each(|disc| disc.station = last - disc.station);
    sketch.point_masses.iter_mut().for_each(|point| point.station = last - point.station);
    sketch.bearings.iter_mut().for_each(|bearing| bearing.station = last - bearing.station);
    sketch
}

/// Whether both are the same poles, as far as they are slow enough to mean anything.
fn same(a: &[C64], b: &[C64], within: f64) -> Result<(), TestCaseError> {
    prop_assert_eq!(a.len(), b.len());
    let mut left = b.to_vec();
    for pole in a.iter().filter(|pole| pole.norm() < 2e4) {
        let distance = |other: &C64| (other - pole).norm();
        let nearest =
            (0..left.len()).min_by(|&i, &k| distance(&left[i]).total_cmp(&distance(&left[k]))).expect("one left");
        let found = left.swap_remove(nearest);
        prop_assert!(distance(&found) <= within * (1.0 + pole.norm()), "{pole} and {found}");
    }
    Ok(())
}

fn rigid(full: &FullModel) -> [DVector<f64>; 2] {
    let along = DVector::from_fn(full.mass.nrows(), |i, _| f64::from(i % 2 == 0));
    let tilt = DVector::from_fn(full.mass.nrows(), |i, _| if i % 2 == 0 { full.nodes[i / 2].position } else { 1.0 });
    [along, tilt]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn masses_and_stiffnesses_are_symmetric_and_positive(sketch in damped()) {
        let full = drawing(sketch).full();
        for (name, matrix) in [("M", &full.mass), ("K", &full.stiffness), ("G", &full.gyroscopic), ("C", &full.damping), ("Cr", &full.internal)] {
            prop_assert!((matrix - matrix.transpose()).amax() <= 1e-12 * matrix.amax(), "{name}");
        }
        prop_assert!(Cholesky::new(full.mass.clone()).is_some());
        for matrix in [&full.stiffness, &full.gyroscopic, &full.internal] {
            // Of units of their own: compared after each coordinate has been scaled to 1.
            let scale = DVector::from_fn(matrix.nrows(), |i, _| matrix[(i, i)].sqrt().recip().min(1e12));
            let even = matrix.map_with_location(|i, k, entry| entry * scale[i] * scale[k]);
            prop_assert!(even.symmetric_eigenvalues().min() > -1e-10);
        }
    }

    #[test]
    fn rigid_motion_bends_nothing_and_moves_all_of_the_mass(sketch in conservative()) {
        let drawing = drawing(sketch);
        let full = drawing.full();
        let [along, tilt] = rigid(&full);
        for motion in [&along, &tilt] {
            prop_assert!((&full.stiffness * motion).amax() <= 1e-9 * full.stiffness.amax());
        }
        let mass = along.dot(&(&full.mass * &along));
        prop_assert!((mass / drawing.mass() - 1.0).abs() < 1e-12, "{mass} is not {}", drawing.mass());
        // Tilting of all slices together is the polar inertia: pi rho / 32 int (D^4 - d^4), and that of discs.
        let polar = tilt.dot(&(&full.gyroscopic * &tilt));
        let power = |left: f64, right: f64| (0..=4).map(|i| left.powi(i) * right.powi(4 - i)).sum::<f64>() / 5.0;
        let layers = drawing.sections.iter().chain(drawing.sleeves.iter().map(|sleeve| &sleeve.layer));
        let shaft: f64 = layers
            .map(|s| {
                let density = drawing.materials[s.material].density;
                let quartic = power(s.outer, s.outer_right) - power(s.inner, s.inner_right);
                std::f64::consts::PI / 32.0 * density * s.length * quartic
            })
            .sum();
        let expected = shaft + drawing.discs.iter().map(|disc| disc.polar_inertia).sum::<f64>();
        prop_assert!((polar / expected - 1.0).abs() < 1e-9, "{polar} is not {expected}");
    }

    #[test]
    fn a_conservative_rotor_neither_gains_nor_loses(sketch in conservative(), spin in -2000.0..2000.0_f64) {
        let poles = drawing(sketch).full().eigenvalues(spin).expect("eigenvalues");
        for pole in poles.iter().filter(|pole| pole.norm() < 2e4) {
            prop_assert!(pole.re.abs() <= 1e-7 * (1.0 + pole.norm()), "{pole}");
        }
    }

    #[test]
    fn a_rotor_turned_end_for_end_is_the_same(sketch in damped(), spin in 0.0..2000.0_f64) {
        let [one, other] = [sketch.clone(), mirrored(sketch)].map(|s| drawing(s).full().eigenvalues(spin).expect("eigenvalues"));
        same(&one, &other, 1e-6)?;
    }

    #[test]
    fn a_spin_the_other_way_exchanges_forward_and_backward(sketch in damped(), spin in 0.0..2000.0_f64) {
        let full = drawing(sketch).full();
        let there = full.eigenvalues(spin).expect("eigenvalues");
        let back: Vec<C64> = full.eigenvalues(-spin).expect("eigenvalues").iter().map(C64::conj).collect();
        same(&there, &back, 1e-6)?;
    }

    #[test]
    fn cutting_a_section_in_two_is_the_same_as_two_elements(outer in 0.02..0.1_f64, right in 0.02..0.1_f64, bore in 0.0..0.9_f64) {
        let section = Section { outer_right: right, inner_right: right * bore, ..Section::tube(0.3, outer, outer * bore) };
        let middle = 0.5 * (outer + right);
        let left = Section { length: 0.15, outer_right: middle, inner_right: middle * bore, ..section.clone() };
        let rest = Section { length: 0.15, outer: middle, inner: middle * bore, ..section.clone() };
        let steel = Material { name: "steel".into(), density: 7810.0, youngs_modulus: 211e9, shear_modulus: 81.2e9 };
        let full = |sections| drawing(Sketch { name: "cut".into(), materials: vec![steel.clone()], sections, ..Sketch::default() }).full();
        let (one, two) = (full(vec![Section { elements: 2, ..section }]), full(vec![left, rest]));
        prop_assert!((&one.stiffness - &two.stiffness).amax() <= 1e-11 * two.stiffness.amax());
        prop_assert!((&one.mass - &two.mass).amax() <= 1e-11 * two.mass.amax());
    }

    #[test]
    fn a_reduction_is_symmetric_and_keeps_the_slow_poles(sketch in damped(), spin in 0.0..1000.0_f64) {
        let drawing = drawing(sketch);
        let full = drawing.full();
        let reduced = full.reduce(&drawing, 16).expect("a reduction");
        prop_assert!(Cholesky::new(reduced.mass.clone()).is_some());
        prop_assert_eq!(&reduced.gyroscopic, &reduced.gyroscopic.transpose());
        let lost = beam::lost(&full, &reduced, &[spin], 2000.0).expect("poles");
        prop_assert!(lost.worst_frequency() < 1e-3, "{}", lost.worst_frequency());
    }
}

/// No file makes a reader stumble: one line or one word of a good one is changed at a time.
mod damaged {
    use super::*;

    fn changed(text: &str, line: usize, how: u8) -> String {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let at = line % lines.len();
        match how {
            0 => drop(lines.remove(at)),
            1 => lines[at] = lines[at].replacen('=', "= -", 1),
            2 => lines[at] = lines[at].replacen(char::is_numeric, "1e308", 1),
            3 => lines[at] = lines[at].replacen("= ", "= [] #", 1),
            4 => lines[at] = lines[at].replacen('n', "nan", 1),
            5 => lines[at] = lines[at].replacen("= ", "= nan #", 1),
            _ => lines.truncate(at),
        }
        lines.join("\n")
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn nothing_makes_an_import_stumble(line in 0..2000_usize, how in 0..7_u8, average in any::<bool>()) {
            for text in [include_str!("cases/overhung_gyroscopic_seal.toml"), include_str!("cases/rotor_example_ross31.toml")] {
                if let Ok((drawing, _)) = beam::import_ross(&changed(text, line, how), average) {
                    let text = beam::write(&drawing);
                    prop_assert_eq!(beam::read(&text, "any").map_err(|faults| TestCaseError::fail(faults.to_string()))?, drawing);
                }
            }
        }

        #[test]
        fn nothing_makes_the_reader_stumble(line in 0..200_usize, how in 0..7_u8) {
            let (drawing, _) = beam::import_ross(include_str!("cases/amb_lead.toml"), false).expect("a rotor");
            let text = changed(&beam::write(&drawing), line * 7, how);
            if let Ok(drawing) = beam::read(&text, "any") {
                // Numbers beyond reason are refused where they break something, not before.
                drop(drawing.full().reduce(&drawing, 8));
            }
        }
    }
}
