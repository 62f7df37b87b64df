//! A rotor given as matrices by another program, in place of a shaft.

mod csv;
mod market;
mod names;
mod npz;

use nalgebra::{Cholesky, DMatrix};

use crate::MAX_ROWS;
use crate::check::is_name;

pub(crate) use names::Names;

/// The matrices of a rotor in any real coordinates that are the same for both planes, as `p` and `psi` are:
/// `M p'' + (C - j w G) p' + (K - j Kc) p`. Nothing that depends on speed, and no bearings that the drawing lists beside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrices {
    /// `M`, symmetric and positive definite.
    pub mass: DMatrix<f64>,
    /// `C`.
    pub damping: DMatrix<f64>,
    /// `G`, symmetric.
    pub gyroscopic: DMatrix<f64>,
    /// `K`, symmetric.
    pub stiffness: DMatrix<f64>,
    /// `Kc`.
    pub cross_stiffness: DMatrix<f64>,
    /// Which coordinates are displacements of stations in m, from left to right, counted from 0.
    pub stations: Vec<usize>,
    /// Where those stations are, in m.
    pub positions: Vec<f64>,
    /// What all coordinates are called; empty where they have no names.
    pub names: Vec<String>,
}

/// What the matrices are called in a drawing, and in files of matrices.
pub(crate) const NAMES: [(&str, &str); 5] =
    [("mass", "M"), ("damping", "C"), ("gyroscopic", "G"), ("stiffness", "K"), ("cross_stiffness", "Kc")];

impl Matrices {
    /// Those of [`read_matrices`] by their names, `M C G K Kc` or the long ones; what is not among them is zero. `stations` and `positions`
    /// are the fields of those names.
    ///
    /// # Errors
    /// A name that is none of these, or no `M`.
    pub fn of(
        named: Vec<(String, DMatrix<f64>)>,
        stations: Vec<usize>,
        positions: Vec<f64>,
    ) -> Result<Self, MatrixError> {
        let mut made = Self { stations, positions, ..Self::default() };
        for (name, matrix) in named {
            let Some(place) = made.named(&name) else {
                return Err(MatrixError::new("the archive", format!("a matrix '{name}'"), "M, C, G, K or Kc"));
            };
            *place = matrix;
        }
        let size = made.mass.nrows();
        if size == 0 {
            return Err(MatrixError::new("the archive", "no M", "the matrix of masses"));
        }
        for (name, _) in NAMES {
            if let Some(place) = made.named(name).filter(|matrix| matrix.is_empty()) {
                *place = DMatrix::zeros(size, size);
            }
        }
        Ok(made)
    }

    /// The matrix of a name of [`NAMES`].
    pub(crate) fn named(&mut self, name: &str) -> Option<&mut DMatrix<f64>> {
        Some(match name {
            "mass" | "M" => &mut self.mass,
            "damping" | "C" => &mut self.damping,
            "gyroscopic" | "G" => &mut self.gyroscopic,
            "stiffness" | "K" => &mut self.stiffness,
            "cross_stiffness" | "Kc" => &mut self.cross_stiffness,
            _ => return None,
        })
    }

    /// All of them with their names.
    pub(crate) fn all(&self) -> [(&'static str, &DMatrix<f64>); 5] {
        let matrices = [&self.mass, &self.damping, &self.gyroscopic, &self.stiffness, &self.cross_stiffness];
        let mut names = NAMES.iter().map(|&(name, _)| name);
        matrices.map(|matrix| (names.next().unwrap_or_default(), matrix))
    }

    /// What is wrong with them: the key, what was found and what was expected.
    pub(crate) fn faults(&self) -> Vec<(&'static str, String, String)> {
        let size = self.mass.nrows();
        if size == 0 {
            return vec![("mass", "no matrix M of masses".into(), format!("one of 1 to {MAX_ROWS} rows and columns"))];
        }
        let mut faults = Vec::new();
        for (name, matrix) in self.all() {
            let (rows, columns) = matrix.shape();
            if rows != columns || rows != size || size > MAX_ROWS {
                let expected = format!("as many rows and columns as mass has, 1 to {MAX_ROWS}");
                faults.push((name, format!("{name} with {rows} rows and {columns} columns"), expected));
            } else if let Some((row, column)) = place(matrix, |entry, _| !entry.is_finite()) {
                let found = format!("{name}, row {}, column {}: {}", row + 1, column + 1, matrix[(row, column)]);
                faults.push((name, found, "a finite number".into()));
            } else if ["mass", "gyroscopic", "stiffness"].contains(&name) {
                let size = matrix.amax();
                if let Some((row, column)) = place(matrix, |entry, mirrored| (entry - mirrored).abs() > 1e-9 * size) {
                    let (one, other) = (matrix[(row, column)], matrix[(column, row)]);
                    let (row, column) = (row + 1, column + 1);
                    let found = format!("{name}, row {row}, column {column}: {one}, and mirrored {other}");
                    faults.push((name, found, "a symmetric matrix".into()));
                }
            }
        }
        if faults.is_empty() && Cholesky::new(self.mass.clone()).is_none() {
            faults.push(("mass", "mass that is not positive definite".into(), "a mass for every motion".into()));
        }
        if !self.names.is_empty() && self.names.len() != size {
            let expected = format!("{size}, one a coordinate, or none");
            faults.push(("names", format!("{} names", self.names.len()), expected));
        }
        for (i, name) in self.names.iter().enumerate() {
            if !is_name(name) || self.names[..i].contains(name) {
                let expected = "a name of its own for each coordinate, printable and of at most 64 bytes";
                faults.push(("names", format!("name {name:?}"), expected.into()));
            }
        }
        if self.stations.is_empty() || self.positions.len() != self.stations.len() {
            let found = format!("{} stations and {} positions", self.stations.len(), self.positions.len());
            faults.push(("stations", found, "a position for each, one at least".into()));
        }
        for (i, &row) in self.stations.iter().enumerate() {
            if row >= size || self.stations[..i].contains(&row) {
                let expected = format!("different coordinates, 1 to {size}");
                faults.push(("stations", format!("station {} at coordinate {}", i + 1, row + 1), expected));
            }
        }
        for pair in self.positions.windows(2) {
            if pair[1].partial_cmp(&pair[0]) != Some(std::cmp::Ordering::Greater) {
                let found = format!("position {} after {}", pair[1], pair[0]);
                faults.push(("positions", found, "rising positions, from left to right".into()));
            }
        }
        faults
    }

    /// What moves when all stations move together, in kg.
    pub(crate) fn whole_mass(&self) -> f64 {
        self.stations.iter().flat_map(|&i| self.stations.iter().map(move |&k| (i, k))).map(|at| self.mass[at]).sum()
    }
}

/// The first entry that `is` wrong beside the one mirrored at the diagonal.
fn place(matrix: &DMatrix<f64>, is: impl Fn(f64, f64) -> bool) -> Option<(usize, usize)> {
    let size = matrix.nrows();
    (0..size)
        .flat_map(|row| (0..size).map(move |column| (row, column)))
        .find(|&(row, column)| is(matrix[(row, column)], matrix[(column, row)]))
}

/// Matrices by their names, and names of their coordinates.
type NamedMatrices = (Vec<(String, DMatrix<f64>)>, Option<Names>);

/// What is wrong with a file of matrices.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {found}: expected {expected}")]
pub struct MatrixError {
    /// Where: a line, or a name in the archive.
    pub place: String,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

impl MatrixError {
    fn new(place: impl Into<String>, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { place: place.into(), found: found.into(), expected: expected.into() }
    }
}

/// The matrices of a file of any kind that is known by the end of its name: `.npz` and `.npy` of NumPy, `.mtx` of Matrix Market, `.csv` and
/// `.txt` with a row a line, perhaps with names of rows and columns. Each has the name that an archive gives it; alone in its file it has none.
///
/// # Errors
/// Files of other kinds, damaged ones, and matrices of more than [`MAX_ROWS`] rows.
///
/// ```
/// let read = beam::read_matrices("k.csv", b"2.0, -1.0\n-1.0, 2.0\n")?;
/// assert_eq!(read[0].1[(0, 1)], -1.0);
/// let error = beam::read_matrices("k.csv", b"2.0, -1.0\n-1.0\n").unwrap_err();
/// assert_eq!(error.to_string(), "line 2: a row of 1: expected 2 numbers, as in the row before");
/// # Ok::<(), beam::MatrixError>(())
/// ```
pub fn read_matrices(name: &str, bytes: &[u8]) -> Result<Vec<(String, DMatrix<f64>)>, MatrixError> {
    read_named(name, bytes).map(|(found, _)| found)
}

/// The matrices of a file with what it calls their coordinates.
pub(crate) fn read_named(name: &str, bytes: &[u8]) -> Result<NamedMatrices, MatrixError> {
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase();
    let text = || {
        std::str::from_utf8(bytes).map_err(|error| {
            let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
            MatrixError::new(format!("line {line}"), "bytes that are not UTF-8", "text")
        })
    };
    let found = match ending.as_str() {
        "npz" => (npz::archive(bytes)?, None),
        "npy" => (vec![(String::new(), npz::array(bytes, "the array")?)], None),
        "mtx" => (vec![(String::new(), market::matrix(text()?)?)], None),
        "csv" | "txt" => {
            let (matrix, names) = csv::matrix(text()?)?;
            (vec![(String::new(), matrix)], names)
        }
        _ => {
            return Err(MatrixError::new(
                "its name",
                format!("'{name}'"),
                "a name ending in .npz, .npy, .mtx, .csv or .txt",
            ));
        }
    };
    Ok(found)
}

/// A fault unless a matrix may have so many rows and columns.
fn check_size(place: &str, rows: usize, columns: usize) -> Result<(), MatrixError> {
    if (1..=MAX_ROWS).contains(&rows) && (1..=MAX_ROWS).contains(&columns) {
        return Ok(());
    }
    let found = format!("{rows} rows and {columns} columns");
    Err(MatrixError::new(
        place,
        found,
        format!("1 to {MAX_ROWS} of each: reduce the rotor in the program that it is from"),
    ))
}
