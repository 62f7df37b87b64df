//! Rotors given as matrices: the files of NumPy, SciPy and spreadsheets, and what is refused.

use beam::{
    Also, C64, Drawing, FullModel, Material, Matrices, Section, Sketch, lost, read, read_and, read_matrices, write,
};
use nalgebra::DMatrix;

fn case(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/tests/cases/matrices/{name}", env!("CARGO_MANIFEST_DIR"))).expect(name)
}

/// The tapered element whose matrices the cases have, as we make it.
fn tapered() -> FullModel {
    let steel = Material { name: "steel".into(), density: 7810.0, youngs_modulus: 211e9, shear_modulus: 81.2e9 };
    let section = Section { outer_right: 0.08, inner_right: 0.02, ..Section::tube(0.25, 0.05, 0.01) };
    let sketch = Sketch { name: "one".into(), materials: vec![steel], sections: vec![section], ..Sketch::default() };
    Drawing::new(sketch).expect("a drawing").full()
}

fn near(found: &DMatrix<f64>, expected: &DMatrix<f64>) -> bool {
    (found - expected).amax() <= 1e-10 * expected.amax()
}

fn one(name: &str) -> DMatrix<f64> {
    let mut found = read_matrices(name, &case(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(found.len(), 1);
    found.remove(0).1
}

#[test]
fn val_files_that_numpy_and_scipy_have_written_are_read() {
    let ours = tapered();
    for (name, names) in [("plain.npz", ["M", "K", "G"]), ("deflated.npz", ["mass", "stiffness", "gyroscopic"])] {
        let found = read_matrices(name, &case(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(found.len(), 3, "{name}: what has no name of ours is left out");
        for (key, expected) in names.into_iter().zip([&ours.mass, &ours.stiffness, &ours.gyroscopic]) {
            let (_, matrix) = found.iter().find(|(name, _)| name == key).expect(key);
            assert!(near(matrix, expected), "{name}, {key}: {matrix}");
        }
    }
    assert!(near(&one("mass.npy"), &ours.mass));
    assert!(near(&one("mass.mtx"), &ours.mass));
    assert!(near(&one("stiffness.mtx"), &ours.stiffness));
    assert!(near(&one("gyroscopic.csv"), &ours.gyroscopic) && near(&one("gyroscopic.txt"), &ours.gyroscopic));
    assert_eq!(one("whole.npy"), DMatrix::from_row_slice(2, 3, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]));
    let upper = ours.stiffness.upper_triangle() - DMatrix::from_diagonal(&ours.stiffness.diagonal());
    assert!(near(&one("skew.mtx"), &(&upper - upper.transpose())));
}

#[test]
fn what_is_no_matrix_is_refused_with_its_place() {
    let told = |name: &str, bytes: &[u8]| read_matrices(name, bytes).expect_err(name).to_string();
    let complex = told("complex.npy", &case("complex.npy"));
    assert_eq!(complex, "the array: numbers of kind '<c16': expected real ones: <f8, <f4, <i8 or <i4");
    assert!(told("m.xlsx", b"").starts_with("its name: 'm.xlsx': expected a name ending in"));
    assert_eq!(told("m.csv", b"1, 2\na, 3, 4\n"), "line 2: 'a': expected a finite number");
    assert_eq!(
        told("m.csv", b"a, 1, 2\n3, 4\n"),
        "line 2: '3': expected a name before the numbers, as in the rows before"
    );
    assert_eq!(
        told("m.csv", b"a, 1, 2\na, 3, 4\n"),
        "line 2: 'a' again: expected a name of its own for each coordinate"
    );
    assert_eq!(
        told("m.csv", b"x, y\nx, 1, 2\nz, 3, 4\n"),
        "line 3: a row 'z': expected 'y', as the columns have it in line 1"
    );
    assert_eq!(
        told("m.csv", b"x, y, z, u\n1, 2\n3, 4\n"),
        "line 1: 4 names: expected 2, one a column, or a title behind #"
    );
    assert_eq!(told("m.csv", b"1, 2\n3, x\n"), "line 2: 'x': expected a finite number");
    assert_eq!(told("m.csv", b"1, 2\n3, nan\n"), "line 2: 'nan': expected a finite number");
    assert!(told("m.csv", b"# nothing\n").contains("0 rows and 0 columns"));
    assert_eq!(told("m.csv", b"1\n\xff"), "line 2: bytes that are not UTF-8: expected text");
    let wide = "1 ".repeat(129);
    assert!(told("m.csv", wide.as_bytes()).starts_with("line 1: 1 rows and 129 columns: expected 1 to 128 of each"));

    let market = |body: &str| told("m.mtx", format!("%%MatrixMarket matrix {body}").as_bytes());
    assert!(
        market("coordinate complex general\n1 1 1\n1 1 1\n")
            .starts_with("line 1: '%%MatrixMarket matrix coordinate complex")
    );
    assert!(market("coordinate real hermitian\n1 1 1\n").starts_with("line 1: hermitian: expected general"));
    assert!(
        market("coordinate real general\n% a\n2 2 1\n3 1 1.0\n")
            .starts_with("line 4: '3 1 1.0': expected a row, a column")
    );
    assert_eq!(market("array real general\n2 1\n5.0\n"), "the file: 1 entries: expected 2, as its sizes say");
    assert_eq!(
        market("array real general\n1 1\n5.0\n6.0\n"),
        "line 4: '6.0': expected no more entries than the sizes say"
    );
    assert!(market("coordinate real symmetric\n2 3 0\n").contains("2 rows and 3 columns: expected as many of each"));

    // An archive with any one byte changed is told to be damaged, or is read the same where the byte means nothing.
    let whole = case("deflated.npz");
    let expected = read_matrices("a.npz", &whole).expect("matrices");
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x41;
        if let Ok(found) = read_matrices("a.npz", &damaged) {
            assert!(found.iter().all(|matrix| expected.contains(matrix)), "byte {at}");
        }
        drop(read_matrices("a.npz", &whole[..at]));
    }
}

#[test]
fn matrices_of_an_archive_are_a_rotor() {
    let named = read_matrices("plain.npz", &case("plain.npz")).expect("matrices");
    let matrices = Matrices::of(named.clone(), vec![0, 2], vec![0.0, 0.25]).expect("M");
    assert!(near(&matrices.gyroscopic, &tapered().gyroscopic));
    assert_eq!(matrices.damping, DMatrix::zeros(4, 4));
    let without = named.into_iter().filter(|(name, _)| name != "M").collect();
    let told = Matrices::of(without, vec![0], vec![0.0]).expect_err("no M").to_string();
    assert_eq!(told, "the archive: no M: expected the matrix of masses");
}

/// A rotor of elements written out as matrices, with what it stands on beside.
fn as_matrices(text: &str) -> (Drawing, Drawing) {
    let (drawing, _) = beam::import_ross(text, false).expect("a rotor");
    let full = drawing.full();
    let matrices = Matrices {
        mass: full.mass.clone(),
        damping: full.damping.clone(),
        gyroscopic: full.gyroscopic.clone(),
        stiffness: full.stiffness.clone(),
        cross_stiffness: full.cross_stiffness.clone(),
        stations: full.station_nodes.iter().map(|&node| full.displacements[node]).collect(),
        positions: drawing.station_positions(),
        names: vec![],
    };
    let sketch = Sketch {
        name: drawing.name.clone(),
        matrices: Some(matrices),
        bearings: drawing.bearings.clone(),
        seals: drawing.seals.clone(),
        ..Sketch::default()
    };
    (drawing, Drawing::new(sketch).expect("a drawing"))
}

#[test]
fn a_rotor_as_matrices_is_the_rotor_of_elements() {
    let (elements, matrices) = as_matrices(include_str!("cases/overhung_gyroscopic_seal.toml"));
    assert_eq!(
        (elements.stations(), elements.station_positions()),
        (matrices.stations(), matrices.station_positions())
    );
    assert!((matrices.mass() / elements.mass() - 1.0).abs() < 1e-12);
    let [one, other] = [&elements, &matrices].map(|drawing| drawing.full().eigenvalues(500.0).expect("poles"));
    assert_eq!(one, other);
    let mut unbalance = vec![C64::ZERO; 11];
    unbalance[10] = C64::from(1e-3);
    let [one, other] =
        [&elements, &matrices].map(|drawing| drawing.full().response_to(&unbalance, 90.0).expect("whirl"));
    assert_eq!(one, other);

    // Its coordinates are stations, for nothing is known of what is between.
    let full = matrices.full();
    let reduced = full.reduce(&matrices, 16).expect("a reduction");
    assert_eq!(reduced.coordinates(), 11);
    assert!(lost(&full, &reduced, &[0.0, 1000.0], 3000.0).expect("poles").worst_frequency() < 1e-4);

    let written = write(&matrices);
    assert_eq!(read(&written, "other").expect("a drawing"), matrices);
}

const FILES: &str = "name = 'elsewhere'\nunits = 'si'\n[plant]\nstations = [1, 3]\npositions = [0.0, 0.25]\n\
                     matrices = 'plain.npz'\n[[bearing]]\nstation = 1\nstiffness = 1e6\n[[bearing]]\nstation = 2\nstiffness = 1e6\n";

fn open(name: &str) -> Result<Vec<u8>, String> {
    if name == "none.npz" { Err("no such file: expected one".into()) } else { Ok(case(name)) }
}

fn with_files(text: &str) -> Result<Drawing, String> {
    let also = Also { open: Some(&open), ..Also::default() };
    read_and(text, "rotor", also, |_, _, _| ()).map(|(drawing, ())| drawing).map_err(|faults| faults.to_string())
}

#[test]
fn matrices_are_read_from_files_and_written_out() {
    let drawing = with_files(FILES).expect("a drawing");
    assert!(near(&drawing.full().stiffness, &tapered().stiffness));
    assert_eq!(read(&write(&drawing), "other").expect("a drawing"), drawing, "needs no file any more");
    let each = "{ mass = 'mass.npy', stiffness = 'stiffness.mtx', gyroscopic = 'gyroscopic.csv' }";
    let other = with_files(&FILES.replace("'plain.npz'", each)).expect("a drawing");
    assert!(near(&other.full().gyroscopic, &drawing.full().gyroscopic));
    assert_eq!(other.full().eigenvalues(300.0).expect("poles").len(), 8);
    assert_eq!(
        read(FILES, "rotor").expect_err("no files").to_string(),
        "6:12: matrices = 'plain.npz': expected matrices written out here, mass = [[..], ..]: no other file is opened"
    );
}

/// Names of coordinates in a header, before each row or both; numbers are the same whichever way.
#[test]
fn rows_and_columns_of_a_table_have_names() {
    let plain = read_matrices("m.csv", b"8, 1\n1, 12\n").expect("a matrix");
    let both: &[u8] = b"\"node\", left disc, right disc\nleft disc, 8, 1\nright disc, 1, 12\n";
    for bytes in [
        both,
        b",left disc,right disc\nleft disc,8,1\nright disc,1,12\n",
        b"left disc;right disc\n8;1\n1;12\n",
        b"left disc, 8, 1\n\"right disc\", 1, 12\n",
        b"masses in kg\n8 1\n1 12\n",
        b"a 8 1\nb 1 12\n",
    ] {
        assert_eq!(read_matrices("m.csv", bytes), Ok(plain.clone()), "{}", String::from_utf8_lossy(bytes));
    }

    let text = "name = 'named'\nunits = 'si'\n[plant]\nstations = ['left disc', 2]\npositions = [0.0, 0.3]\n\
                matrices = { mass = 'M.csv', stiffness = 'K.csv' }\n[[bearing]]\nstation = 1\nstiffness = 1e6\n";
    let read_with = |text: &str, stiffness: &'static str| {
        let open = |name: &str| Ok(if name == "M.csv" { both.to_vec() } else { stiffness.as_bytes().to_vec() });
        let also = Also { open: Some(&open), ..Also::default() };
        read_and(text, "rotor", also, |_, _, _| ()).map(|(drawing, ())| drawing).map_err(|faults| faults.to_string())
    };
    let rows = "left disc, 3e6, -2e6\nright disc, -2e6, 3e6\n";
    let drawing = read_with(text, rows).expect("a drawing");
    let matrices = drawing.matrices.as_ref().expect("matrices");
    assert_eq!((matrices.stations.as_slice(), &matrices.names[1]), (&[0, 1][..], &"right disc".to_owned()));
    assert_eq!(drawing.full().nodes.iter().map(beam::Place::told).collect::<Vec<_>>(), ["left disc", "right disc"]);
    assert_eq!(read(&write(&drawing), "other").expect("a drawing"), drawing, "names are written out");
    // A file without names has the order of the others.
    assert_eq!(read_with(text, "3e6, -2e6\n-2e6, 3e6\n").as_ref(), Ok(&drawing));
    for (stiffness, told) in [
        (
            "left disc, 3e6, -2e6\nright, -2e6, 3e6\n",
            "6:42: K.csv: line 2: 'right': expected 'right disc', as M.csv has it",
        ),
        (
            "right disc, left disc\n3e6, -2e6\n-2e6, 3e6\n",
            "6:42: K.csv: line 1: 'right disc': expected 'left disc', as M.csv has it",
        ),
    ] {
        assert_eq!(read_with(text, stiffness).expect_err(told), told);
    }
    let told = read_with(&text.replace("'left disc', 2", "'left', 2"), rows).expect_err("no such name");
    assert_eq!(
        told.lines().next(),
        Some("4:13: station 'left': expected a coordinate, 1 to 2, or its name: left disc, right disc")
    );
    let own = text.replace("positions", "names = ['left disc', 'b']\npositions");
    assert_eq!(
        read_with(&own, rows).expect_err("other names").lines().next(),
        Some("7:21: M.csv: line 1: 'right disc': expected 'b', as names = [..] has it")
    );
}

#[test]
fn what_is_wrong_with_a_plant_is_told_at_its_place() {
    let plant = "units = 'si'\n[plant]\nstations = [1]\nmass = [[2.0, 0.1], [0.1, 1.0]]\nstiffness = [[3.0, -1.0], [-1.0, 3.0]]\n";
    assert!(read(plant, "rotor").is_ok());
    for (from, to, told) in [
        (
            "[[3.0, -1.0], [-1.0",
            "[[3.0, -1.0], [-1.1",
            "5:13: stiffness, row 1, column 2: -1, and mirrored -1.1: expected a symmetric matrix",
        ),
        (
            "[[2.0, 0.1], [0.1, 1.0]]",
            "[[0.0, 1.0], [1.0, 0.0]]",
            "4:8: mass that is not positive definite: expected a mass for every motion",
        ),
        ("[0.1, 1.0]]", "[0.1, 1.0, 2]]", "4:8: mass, row 2, of 3 numbers: expected 2, as in the first row"),
        ("[0.1, 1.0]]", "[0.1, inf]]", "4:27: mass, row 2, column 2: inf: expected a finite number"),
        (
            "mass = [[2.0, 0.1], [0.1, 1.0]]",
            "mass = 2.0",
            "4:8: mass = 2.0: expected rows of finite numbers, [[..], ..]",
        ),
        (
            "stiffness = [[3.0, -1.0], [-1.0, 3.0]]",
            "stiffness = [[3.0]]",
            "5:13: stiffness with 1 rows and 1 columns: expected as many rows and columns as mass has, 1 to 128",
        ),
        ("stations = [1]", "stations = [3]", "3:13: station 3: expected a coordinate, 1 to 2"),
        (
            "stations = [1]",
            "stations = [2, 2]",
            "3:12: station 2 at coordinate 2: expected different coordinates, 1 to 2",
        ),
        (
            "stations = [1]",
            "stations = [1, 2]\npositions = [0.5, 0.5]",
            "4:13: position 0.5 after 0.5: expected rising positions, from left to right",
        ),
        (
            "stations = [1]",
            "stations = [1]\npositions = [0.5, 0.6]",
            "3:12: 1 stations and 2 positions: expected a position for each, one at least",
        ),
        (
            "stations = [1]\n",
            "",
            "2:1: [plant] without stations: expected stations = coordinates that are displacements of stations, from left to right, counted from 1",
        ),
        (
            "stations = [1]\n",
            "stations = [1]\nmatrices = 'a.npz'\n",
            "4:12: matrices = 'a.npz': expected either it or mass = [[..]], not both",
        ),
        (
            "units = 'si'\n",
            "units = 'si'\nmass_damping = 1.0\n",
            "2:16: mass_damping = 1: expected none beside [plant], which has a matrix of damping",
        ),
        (
            "units = 'si'\n",
            "units = 'si'\ncoordinates = 2\n",
            "2:15: coordinates = 2: expected 1 to 1, at most 16 and one a station",
        ),
        (
            "units = 'si'\n[plant]",
            "units = 'si'\n[[disc]]\nstation = 1\nmass = 1\npolar_inertia = 1\ndiametral_inertia = 1\n[plant]",
            "2:1: disc beside matrices: expected none beside [plant], whose matrices stand for the shaft and all discs",
        ),
    ] {
        assert!(plant.contains(from), "{from}");
        let found =
            read(&plant.replacen(from, to, 1), "rotor").map_or_else(|faults| faults.to_string(), |_| "nothing".into());
        assert!(found.lines().any(|line| line == told), "{from} -> {to}\n is {found}\nnot {told}");
    }
    assert_eq!(
        with_files(&FILES.replace("plain.npz", "none.npz")).expect_err("no file").lines().next(),
        Some("6:12: none.npz: no such file: expected one")
    );
    assert!(with_files(&FILES.replace("plain.npz", "mass.npy")).expect_err("no name").contains(
        "6:12: matrices = 'mass.npy': expected an archive with M, C, G, K and Kc: this holds one without a name"
    ));
}
