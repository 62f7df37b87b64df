//! Drawings as files: what is read, what is refused, and that what is written reads back.

use beam::{Also, Amount, Coefficient, Drawing, Shear, import_ross, read, read_and, write};

const RIG: &str = r#"name = "test rig"
units = "si"
reference_length = 1e-4
coordinates = 6

[material.steel]
density = 7810.0
youngs_modulus = 211e9
shear_modulus = 81.2e9

[material."light metal"]
density = 2700.0
youngs_modulus = 70e9
poisson = 0.33

[[section]]
length = 0.25
outer = 0.05
elements = 2
material = "steel"
internal_damping = 1e-6

[[section]]
length = 0.25
outer = 0.06
inner = 0.01
outer_right = 0.04
inner_right = 0.02
material = "light metal"
shear = "hutchinson"

[[sleeve]]
section = 1
outer = 0.08
inner = 0.05
material = "light metal"
shear = "none"
rotary_inertia = false
gyroscopic = false

[[disc]]
station = 2
mass = 32.6
polar_inertia = 0.356
diametral_inertia = 0.178

[[disc]]
station = 3
outer = 0.28
inner = 0.05
width = 0.07
material = "steel"

[[point_mass]]
station = 3
mass = 0.5

[[bearing]]
station = 1
stiffness = { speed = [0, 3000, 6000], value = [1e6, 1.5e6, 1.2e6] }
damping = 200.0
cross_stiffness = 1e4
clearance = 0.5e-3

[[seal]]
station = 3
cross_stiffness = 3e5
mass = 0.2

[[magnetic]]
name = "left"
station = 2
sensor = 1
force_per_current = 55.7
negative_stiffness = 1.29e5
clearance = 0.25e-3
touchdown_stiffness = 1e8
controller = { numerator = [2.0, 5600.0], denominator = [1e-4, 1] }

[[sensor]]
name = "middle"
station = 2

[[unbalance]]
station = 2
grade = "G2.5"
speed = 9000

[[unbalance]]
station = 3
gmm = 120.0
angle = 30.0

[[unbalance]]
station = 1
mass = 1e-3
radius = 0.05
"#;

#[test]
fn a_file_says_what_it_says() {
    let rig = read(RIG, "other").unwrap();
    assert_eq!((rig.name.as_str(), rig.stations(), rig.elements(), rig.coordinates), ("test rig", 3, 3, Some(6)));
    assert_eq!(rig.station_positions(), [0.0, 0.25, 0.5]);
    assert_eq!(rig.materials[1].name, "light metal");
    assert_eq!(rig.materials[1].shear_modulus, 70e9 / 2.66);
    assert_eq!((rig.sections[1].material, rig.sections[1].shear), (1, Shear::Hutchinson));
    let sleeve = &rig.sleeves[0].layer;
    assert_eq!((sleeve.length, sleeve.elements, sleeve.gyroscopic), (0.25, 2, false), "as the section under it");
    assert!((rig.discs[1].mass - 32.589_727).abs() < 1e-6, "{:?}", rig.discs[1]);
    assert_eq!(rig.bearings[0].stiffness.at(1500.0 * std::f64::consts::PI / 30.0), 1.25e6);
    assert_eq!(rig.seals[0].stiffness, Coefficient::ZERO);
    assert_eq!((rig.magnetics[0].station, rig.magnetics[0].sensor), (1, 0));
    assert_eq!(rig.magnetics[0].controller.as_ref().map(|c| c.numerator.clone()), Some(vec![2.0, 5600.0]));
    assert_eq!(rig.unbalances[0].amount, Amount::Grade { millimetres_per_second: 2.5, speed: Some(9000.0) });
    assert_eq!(rig.unbalances[2].amount, Amount::GramMillimetres(1e-3 * 0.05 * 1e6));

    // G2.5 at 9000 rpm, on the whole mass; 120 g mm at 30 degrees.
    let unbalance = rig.full().unbalance(0.0);
    let expected = 2.5e-3 / (9000.0 * std::f64::consts::PI / 30.0) * rig.mass();
    assert!((unbalance[1].re - expected).abs() < 1e-15 && unbalance[1].im == 0.0, "{unbalance:?}");
    assert!((unbalance[2].arg().to_degrees() - 30.0).abs() < 1e-9 && (unbalance[2].norm() - 1.2e-4).abs() < 1e-15);
}

#[test]
fn what_is_written_reads_back_to_the_last_bit() {
    let rig = read(RIG, "other").unwrap();
    let written = write(&rig);
    assert_eq!(read(&written, "other").unwrap(), rig, "{written}");
    assert_eq!(write(&read(&written, "other").unwrap()), written);
    for text in [
        include_str!("cases/amb_lead.toml"),
        include_str!("cases/overhung_gyroscopic_seal.toml"),
        include_str!("cases/isotropic.toml"),
        include_str!("cases/friswell_5_9_5.toml"),
    ] {
        let (imported, _) = import_ross(text, false).unwrap();
        let written = write(&imported);
        assert_eq!(read(&written, "other").unwrap(), imported, "{written}");
    }
}

#[test]
fn what_somebody_else_reads_is_no_fault() {
    let text = format!("{RIG}\n[loop]\nrate = 5.0\n").replace("name = \"left\"", "name = \"left\"\nsignal = 7");
    assert!(read(&text, "rig").is_err(), "nobody reads it");
    let also = Also { file: &["loop"], magnetic: &["signal"], ..Also::default() };
    let (rig, rate) = read_and(&text, "rig", also, |reader, file, drawing| {
        assert_eq!(drawing.magnetics.len(), 1);
        let table = reader.table(file, "loop").expect("[loop]");
        reader.number(table, "rate", text::Domain::Positive)
    })
    .unwrap();
    assert_eq!((rig.stations(), rate), (3, Some(5.0)));
    let wrong = read_and(&text, "rig", also, |reader, file, _| {
        let table = reader.table(file, "loop").expect("[loop]");
        reader.only(table, &["speed"]);
    });
    assert!(wrong.unwrap_err().to_string().contains("unknown key 'rate': expected speed"));
}

#[test]
fn only_drawings_are_drawings() {
    let is = |text: &str| beam::is_drawing(&text::Reader::parse(text).expect("TOML").1);
    assert!(is(RIG) && is("[plant]\nmatrices = 'a.npz'"));
    assert!(!is("[[mass]]\nmass = 1.0") && !is("bearing = 1"));
}

/// The rig with one thing changed, and what is told of it.
#[test]
fn what_is_wrong_is_told_at_its_place() {
    let cases = [
        ("units = \"si\"\n", "", "1:1: no units: expected units = \"si\": a drawing has no others"),
        ("units = \"si\"", "units = \"mm\"", "2:9: units = \"mm\": expected \"si\""),
        ("name = \"test rig\"", "name = \"\"", "1:8: name = \"\": expected 1 to 64 bytes of printable text in quotes"),
        ("coordinates = 6", "coordinates = 17", "4:15: coordinates = 17: expected a number of coordinates, 1 to 16"),
        (
            "coordinates = 6",
            "coordinates = 9",
            "4:15: coordinates = 9: expected 1 to 8, at most 16 and two an end of an element",
        ),
        (
            "shear_modulus = 81.2e9",
            "",
            "6:1: [material.steel] without shear_modulus: expected shear_modulus = a finite number greater than 0",
        ),
        (
            "shear_modulus = 81.2e9",
            "shear_modulus = 60e9",
            "9:17: shear_modulus = 6e10 beside youngs_modulus = 2.11e11: expected 7.0333e10 to 1.0550e11: Poisson's ratio E / (2 G) - 1 \
             is 0.7583, outside 0 to 0.5 (a section that does not yield to shear has shear = \"none\")",
        ),
        (
            "polar_inertia = 0.356",
            "polar_inertia = 0.36",
            "44:17: polar_inertia = 0.36: expected at most 0.356, twice the diametral inertia, as a disc of no width has",
        ),
        (
            "polar_inertia = 0.356",
            "polar_inertia = -0.1",
            "44:17: polar_inertia = -0.1: expected a finite number, not negative",
        ),
        ("poisson = 0.33", "poisson = 0.7", "14:11: poisson = 0.7: expected a number from 0 to 0.5"),
        (
            "poisson = 0.33",
            "poisson = 0.33\nshear_modulus = 1e9",
            "14:11: poisson = 0.33: expected either shear_modulus or poisson: one follows from the other",
        ),
        (
            "length = 0.25\nouter = 0.05",
            "length = 0\nouter = 0.05",
            "17:10: length = 0: expected a finite number greater than 0",
        ),
        (
            "length = 0.25\nouter = 0.05",
            "outer = 0.05",
            "16:1: [[section]] 1 without length: expected length = a finite number greater than 0",
        ),
        ("inner = 0.01", "inner = 0.07", "26:9: inner = 0.07: expected less than the outer diameter there, 0.06"),
        (
            "inner_right = 0.02",
            "inner_right = 0.04",
            "28:15: inner_right = 0.04: expected less than the outer diameter there, 0.04",
        ),
        ("elements = 2", "elements = 0", "19:12: elements = 0: expected a number of elements, 1 to 256"),
        ("elements = 2", "elements = 256", "16:1: 257 elements: expected 1 to 256 elements in all sections together"),
        (
            "material = \"steel\"\ninternal",
            "material = \"stel\"\ninternal",
            "20:12: material = \"stel\": expected \"steel\" or \"light metal\"; did you mean \"steel\"?",
        ),
        (
            "material = \"steel\"\ninternal",
            "internal",
            "16:1: [[section]] 1 without material: expected material = one of steel, light metal",
        ),
        (
            "shear = \"hutchinson\"",
            "shear = 1",
            "30:9: shear = 1: expected one of cowper, hutchinson, hutchinson-ross, none",
        ),
        ("section = 1", "section = 3", "33:11: section = 3: expected a section of the shaft, 1 to 2"),
        ("rotary_inertia = false", "rotary_inertia = 0", "38:18: rotary_inertia = 0: expected true or false"),
        (
            "station = 2\nmass = 32.6",
            "station = 4\nmass = 32.6",
            "42:11: station = 4: expected a station of the shaft, 1 to 3",
        ),
        (
            "station = 2\nmass = 32.6",
            "mass = 32.6",
            "41:1: [[disc]] 1 without station: expected station = a station of the shaft, 1 to 3",
        ),
        (
            "diametral_inertia = 0.178",
            "width = 0.1",
            "41:1: [[disc]] 1 with mass and width: expected either mass, polar_inertia and diametral_inertia, or outer, inner, width \
             and material",
        ),
        ("width = 0.07", "", "47:1: [[disc]] 2 without width: expected width = a finite number greater than 0"),
        ("mass = 0.5", "mass = -0.5", "56:8: mass = -0.5: expected a finite number, not negative"),
        ("3000, 6000]", "6000, 3000]", "60:33: speed 3000 after 6000: expected rising speeds"),
        (
            "value = [1e6, 1.5e6, 1.2e6]",
            "value = [1e6, 1.5e6]",
            "60:13: stiffness with 3 speeds and 2 values: expected as many values as speeds, at least one",
        ),
        ("1.5e6, 1.2e6] }", "nan, 1.2e6] }", "60:54: value, entry 2: nan: expected a finite number"),
        (
            "damping = 200.0",
            "damping = \"hard\"",
            "61:11: damping = \"hard\": expected a finite number or { speed = [..], value = [..] }",
        ),
        (
            "clearance = 0.5e-3",
            "clearence = 1",
            "63:1: unknown key 'clearence': expected one of station, stiffness, damping, cross_stiffness, cross_damping, mass, clearance, pedestal; did you mean 'clearance'?",
        ),
        (
            "mass = 0.2",
            "clearance = 1e-3",
            "68:1: unknown key 'clearance': expected one of station, stiffness, damping, cross_stiffness, cross_damping, mass",
        ),
        ("sensor = 1", "sensor = 0", "73:10: sensor = 0: expected a station of the shaft, 1 to 3"),
        (
            "name = \"left\"",
            "name = \"1.left\"",
            "71:8: name = \"1.left\": expected letters, digits, '-' and '_', beginning with a letter, at most 64 of them: it begins keys \
             of settings",
        ),
        (
            "force_per_current = 55.7",
            "",
            "70:1: [[magnetic]] 1 without force_per_current: expected force_per_current = a finite number greater than 0",
        ),
        (
            "negative_stiffness = 1.29e5",
            "negative_stiffness = -1",
            "75:22: negative_stiffness = -1: expected a finite number, not negative",
        ),
        (
            "clearance = 0.25e-3",
            "",
            "77:23: touchdown_stiffness = 100000000: expected clearance = G with it, the play of the touchdown bearing",
        ),
        (
            "denominator = [1e-4, 1] }",
            "denominator = [1] }",
            "78:14: a controller of order 1 over 0: expected a numerator of no higher order than the denominator",
        ),
        (
            "denominator = [1e-4, 1] }",
            "denominator = [0, 1] }",
            "78:14: a controller: expected finite coefficients in falling powers of s, the first of each list not 0",
        ),
        (
            "controller = {",
            "controller = 1 # {",
            "78:14: controller = 1: expected { numerator = [..], denominator = [..] }, falling powers of s in 1/s, A/m",
        ),
        (
            "grade = \"G2.5\"",
            "grade = 2.5",
            "86:9: grade = 2.5: expected a balance grade of ISO 21940-11 in quotes, such as \"G2.5\"",
        ),
        (
            "grade = \"G2.5\"",
            "grade = \"Gx\"",
            "86:9: grade = \"Gx\": expected a balance grade of ISO 21940-11 in quotes, such as \"G2.5\"",
        ),
        (
            "grade = \"G2.5\"",
            "gmm = 1.0",
            "87:9: speed = 9000: expected grade = \"G2.5\" beside it: the speed is what a grade is for",
        ),
        (
            "gmm = 120.0",
            "",
            "89:1: [[unbalance]] 2 without an amount, or with several: expected one of gmm = U, or mass = M and radius = R, or grade = \
             \"G2.5\"",
        ),
        (
            "[[sensor]]",
            "[[sensors]]",
            "80:3: unknown key 'sensors': expected one of name, units, reference_length, coordinates, mass_damping, stiffness_damping, plant, material, section, sleeve, disc, point_mass, pedestal, bearing, seal, magnetic, sensor, unbalance; did you mean 'sensor'?",
        ),
    ];
    let mut wrong = Vec::new();
    for (from, to, told) in cases {
        assert!(RIG.contains(from), "{from}");
        let text = RIG.replacen(from, to, 1);
        let faults = read(&text, "rig").map_or_else(|faults| faults.to_string(), |_| "nothing".into());
        if faults != told {
            wrong.push(format!("{from} -> {to}\n  is {faults}\n not {told}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_drawing_needs_a_shaft_and_a_material() {
    let told = |text: &str| read(text, "rig").unwrap_err().to_string();
    assert_eq!(told("units = \"si\""), "1:1: no [[section]]: expected 1 to 256 elements in all sections together");
    assert_eq!(
        told("units = \"si\"\nsection = 1"),
        "2:11: section = 1: expected [[section]] and its keys on lines of their own\n\
         2:11: no [[section]]: expected 1 to 256 elements in all sections together"
    );
    assert_eq!(
        told("units = \"si\"\nmaterial = 1\n[[section]]\nlength = 1\nouter = 0.1"),
        "2:12: material = 1: expected [material.NAME] and its keys on lines of their own\n\
         3:1: no material: expected [material.NAME] with density, youngs_modulus and shear_modulus"
    );
}

#[test]
fn a_program_is_told_what_is_wrong_with_its_drawing() {
    let rig = read(RIG, "rig").unwrap();
    let told = |change: &dyn Fn(&mut beam::Sketch)| {
        let mut sketch = rig.clone().into_sketch();
        change(&mut sketch);
        Drawing::new(sketch).unwrap_err().to_string()
    };
    assert_eq!(
        told(&|sketch| sketch.sections[1].length = f64::NAN),
        "section 2: length = NaN: expected a finite number greater than 0"
    );
    assert_eq!(
        told(&|sketch| sketch.seals[0].clearance = 1e-3),
        "seal 1: clearance = 0.001: expected none: that of a bearing"
    );
    assert_eq!(
        told(&|sketch| sketch.sections[0].material = 2),
        "section 1: material 3 of 2: expected a material of the drawing"
    );
    assert_eq!(
        told(&|sketch| sketch.sleeves[0].layer.elements = 1),
        "sleeve 1: 0.25 m in 1 elements: expected 0.25 m in 2, as the section under it"
    );
    assert_eq!(
        told(&|sketch| sketch.magnetics.push(sketch.magnetics[0].clone())),
        "magnetic 2: name = \"left\" again: expected a name of its own"
    );
}
