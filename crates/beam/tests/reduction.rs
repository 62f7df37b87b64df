//! What is lost with few coordinates.

mod magnets;

use beam::{C64, Drawing, FullModel, Lost, MAX_COORDINATES, Reduced, ReductionError, import_ross, lost};
use magnets::Plant;
use serde_json::Value;

const OVERHUNG: &str = include_str!("cases/overhung_gyroscopic.toml");
const MAGNETS: &str = include_str!("cases/amb_lead.toml");

fn rotor(text: &str) -> (Drawing, FullModel) {
    let (drawing, _) = import_ross(text, false).expect("a rotor");
    let full = drawing.full();
    (drawing, full)
}

fn compared(text: &str, coordinates: usize, speeds: &[f64], up_to: f64) -> (Reduced, Lost) {
    let (drawing, full) = rotor(text);
    let reduced = full.reduce(&drawing, coordinates).expect("a reduction");
    let lost = lost(&full, &reduced, speeds, up_to).expect("poles");
    (reduced, lost)
}

/// Every rotor of the cases at every speed of theirs.
#[test]
fn sixteen_coordinates_keep_every_pole_of_the_cases_to_four_digits() {
    for (name, text, speeds, up_to) in [
        ("isotropic", include_str!("cases/isotropic.toml"), [0.0, 100.0, 400.0, 1000.0], 3000.0),
        ("overhung", OVERHUNG, [0.0, 200.0, 500.0, 1000.0], 3000.0),
        ("seal", include_str!("cases/overhung_gyroscopic_seal.toml"), [0.0, 200.0, 500.0, 1000.0], 3000.0),
        ("Friswell 5.9.1", include_str!("cases/friswell_5_9_1.toml"), [0.0, 100.0, 418.88, 1000.0], 3000.0),
        ("Friswell 5.9.5", include_str!("cases/friswell_5_9_5.toml"), [0.0, 100.0, 418.88, 1000.0], 3000.0),
        ("magnets", MAGNETS, [0.0, 300.0, 1200.0, 3000.0], 10_000.0),
    ] {
        let (reduced, lost) = compared(text, MAX_COORDINATES, &speeds, up_to);
        assert!(lost.poles.len() > 25, "{name}: {}", lost.poles.len());
        assert!(lost.worst_frequency() < 1e-4, "{name}: {}", lost.worst_frequency());
        assert!(lost.worst_damping() < 1e-4, "{name}: {}", lost.worst_damping());
        assert!(reduced.condition < 1e5, "{name}: {}", reduced.condition);
    }
}

#[test]
fn fewer_coordinates_lose_more_and_it_is_said() {
    let worst = |coordinates| compared(OVERHUNG, coordinates, &[0.0, 1000.0], 3000.0).1.worst_frequency();
    let losses = [4, 6, 8, 10].map(worst);
    assert!(losses.windows(2).all(|pair| pair[1] < 0.5 * pair[0]), "{losses:?}");
    assert!(losses[0] > 0.1 && losses[2] < 1e-4, "{losses:?}");
}

#[test]
fn as_few_coordinates_as_will_do_are_found() {
    let (drawing, full) = rotor(MAGNETS);
    let speeds = [0.0, 1200.0];
    let (reduced, lost) = full.reduce_within(&drawing, &speeds, 5000.0, 1e-3).expect("a reduction");
    assert!(lost.worst_frequency() <= 1e-3 && reduced.coordinates() < 12, "{}", reduced.coordinates());
    let fewer = full.reduce(&drawing, reduced.coordinates() - 1).expect("a reduction");
    assert!(beam::lost(&full, &fewer, &speeds, 5000.0).expect("poles").worst_frequency() > 1e-3);
    // What cannot be had is not claimed.
    let (reduced, lost) = full.reduce_within(&drawing, &speeds, 1e6, 1e-3).expect("a reduction");
    assert!(reduced.coordinates() == 16 && lost.worst_frequency() > 1e-3);
}

#[test]
fn as_many_coordinates_as_there_are_lose_nothing() {
    let (reduced, lost) = compared(include_str!("cases/isotropic.toml"), 16, &[0.0, 1000.0], 1e6);
    assert_eq!(reduced.coordinates(), 14, "two a node");
    assert_eq!(lost.poles.len(), 2 * 28);
    assert!(lost.worst_frequency() < 1e-8, "{}", lost.worst_frequency());
}

/// Coordinate `i` is the displacement of its place, at any place of the shaft.
#[test]
fn coordinates_are_displacements() {
    let (drawing, full) = rotor(MAGNETS);
    for coordinates in [4, 8, 16] {
        let reduced = full.reduce(&drawing, coordinates).expect("a reduction");
        assert!(reduced.stations.is_sorted_by(|a, b| a.position < b.position));
        for (i, place) in reduced.stations.iter().enumerate() {
            let Some(station) = place.station else { panic!("{place:?}: this rotor has stations enough") };
            let row = reduced.displacement(full.station_nodes[station]);
            for (k, entry) in row.iter().enumerate() {
                assert!((entry - f64::from(i == k)).abs() < 1e-9, "{}: {row}", place.name);
            }
        }
        // What carries the rotor and where it is measured is among them.
        for magnetic in &drawing.magnetics {
            assert!(reduced.stations.iter().any(|place| place.station == Some(magnetic.station)));
        }
    }
}

/// A rotor with two nodes only finds its coordinates inside the element.
#[test]
fn places_inside_elements_serve_where_stations_are_too_few() {
    let text = "units = 'si'\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\npoisson = 0.3\n\
                [[section]]\nlength = 0.6\nouter = 0.05\n[[bearing]]\nstation = 1\nstiffness = 1e6\n";
    let drawing = beam::read(text, "rod").expect("a drawing");
    let full = drawing.full();
    let reduced = full.reduce(&drawing, 16).expect("a reduction");
    let names: Vec<&str> = reduced.stations.iter().map(|place| place.name.as_str()).collect();
    assert_eq!(names, ["1", "0.2 m", "0.4 m", "2"]);
    let lost = lost(&full, &reduced, &[0.0, 500.0], 1e9).expect("poles");
    assert!(lost.worst_frequency() < 1e-8, "{lost:?}");
}

/// A compressor: stiff bearings near both ends, and many seals between, which hold it little and stand first in the file.
#[test]
fn stiff_bearings_among_many_seals_are_not_missed() {
    let mut text =
        "units = 'si'\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\npoisson = 0.3\n".to_owned();
    for i in 0..24 {
        text += &format!("[[section]]\nlength = 0.06\nouter = {}\n", 0.08 + 0.02 * f64::from(i % 2));
    }
    for station in [8, 10, 12, 14, 16, 18] {
        text += &format!("[[disc]]\nstation = {station}\nouter = 0.3\nwidth = 0.03\nmaterial = 'steel'\n");
        text += &format!("[[bearing]]\nstation = {station}\nstiffness = 1e5\ncross_stiffness = 1e5\ndamping = 300.0\n");
    }
    for station in [4, 22] {
        text += &format!("[[bearing]]\nstation = {station}\nstiffness = 1.2e8\ndamping = 1.9e5\n");
    }
    let drawing = beam::read(&text, "compressor").expect("a drawing");
    let full = drawing.full();
    for (coordinates, within) in [(8, 1e-3), (14, 1e-4), (16, 1e-5)] {
        let reduced = full.reduce(&drawing, coordinates).expect("a reduction");
        let worst = lost(&full, &reduced, &[0.0, 500.0, 1000.0], 3000.0).expect("poles").worst_frequency();
        assert!(worst < within, "{coordinates}: {worst}");
    }
}

#[test]
fn numbers_of_coordinates_that_cannot_be_are_refused() {
    let (drawing, full) = rotor(OVERHUNG);
    for coordinates in [0, 17] {
        assert_eq!(full.reduce(&drawing, coordinates).err(), Some(ReductionError::Coordinates(coordinates)));
    }
    let mut hollow = full.clone();
    hollow.mass *= -1.0;
    assert_eq!(hollow.reduce(&drawing, 8).err(), Some(ReductionError::Mass));
    hollow.mass[(0, 0)] = f64::NAN;
    assert_eq!(hollow.reduce(&drawing, 8).err(), Some(ReductionError::Mass));
}

fn case() -> Value {
    serde_json::from_str(include_str!("cases/amb_lead.json")).expect("JSON")
}

/// The poles of the case at each of its speeds, with all elements and with 16 coordinates, under its controller.
#[test]
fn val_the_poles_of_a_rotor_on_magnets_under_control_are_those_of_the_case() {
    let case = case();
    let (drawing, full) = rotor(MAGNETS);
    let force = case["ki"].as_f64().expect("ki");
    for magnetic in &drawing.magnetics {
        assert!((magnetic.force_per_current / force - 1.0).abs() < 1e-12);
        assert!((magnetic.negative_stiffness / -case["ks"].as_f64().expect("ks") - 1.0).abs() < 1e-12);
    }
    let reduced = full.reduce(&drawing, 16).expect("a reduction");
    let speeds = case["speeds"].as_object().expect("a table");
    let (mut compared, mut worst, mut worst_reduced) = (0, 0.0_f64, 0.0_f64);
    for (speed, of) in speeds {
        let speed: f64 = speed.parse().expect("a speed");
        let whole = Plant::full(&full, &drawing, speed).closed_loop(&case, force);
        let few = Plant::reduced(&reduced, &full, &drawing, speed).closed_loop(&case, force);
        for theirs in of["poles_5rad_to_1500Hz"].as_array().expect("a list") {
            let theirs = C64::new(theirs[0].as_f64().expect("re"), theirs[1].as_f64().expect("im"));
            let error = |poles: &[C64]| {
                let distance = poles.iter().map(|pole| (pole - theirs).norm()).fold(f64::INFINITY, f64::min);
                distance / theirs.norm()
            };
            worst = worst.max(error(&whole));
            worst_reduced = worst_reduced.max(error(&few));
            compared += 1;
        }
    }
    assert!(compared >= 60, "{compared}");
    // The case names its speeds in six digits.
    assert!(worst < 1e-5, "{worst:e}");
    assert!(worst_reduced < 1e-4, "{worst_reduced:e}");
}
