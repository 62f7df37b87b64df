//! Long tables as files, row by row: CSV, or Parquet with the cargo feature `parquet`.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use files::{Draft, Existing, FileError};

use crate::csv::{Csv, Field};

/// In which form a table is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Comma-separated values, every digit.
    Csv,
    /// Apache Parquet. Only with the cargo feature `parquet`.
    Parquet,
}

/// Why a table cannot be written, as far as the name of its file tells.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FormError {
    /// An ending that means nothing here.
    #[error("'{}': expected a file name that ends in .csv or .parquet", .0.display())]
    Unknown(PathBuf),
    /// This build cannot write Parquet.
    #[error(
        "this whirl was built without Parquet: build it with `cargo build --release --features parquet`, or write .csv"
    )]
    NoParquet,
}

impl Form {
    /// What the ending of `path` asks for.
    ///
    /// # Errors
    /// An ending that is not known, or known and not built in.
    pub fn of(path: &Path) -> Result<Self, FormError> {
        match path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Self::Parquet.available(),
            _ => Err(FormError::Unknown(path.to_owned())),
        }
    }

    /// How its files end, and what it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }

    /// This form, if it is built in.
    ///
    /// # Errors
    /// It is not.
    pub fn available(self) -> Result<Self, FormError> {
        if self == Self::Parquet && !cfg!(feature = "parquet") { Err(FormError::NoParquet) } else { Ok(self) }
    }
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Doubles.
    Double,
    /// Whole numbers of 32 bits.
    Int,
    /// Whole numbers of 64 bits.
    Long,
}

/// A table being written. The columns of doubles come first.
pub struct Table {
    target: PathBuf,
    sink: Sink,
}

enum Sink {
    Csv(Box<Csv<Draft>>),
    #[cfg(feature = "parquet")]
    Parquet(Box<columnar::Columns>),
}

impl Table {
    /// Begins a file, which takes the name `target` in [`Table::finish`]. `wholes` are the columns after the doubles.
    ///
    /// # Errors
    /// No place for a file, one that is there and is to be kept, or a form that is not built in.
    pub fn create(
        target: &Path,
        form: Form,
        doubles: &[String],
        wholes: &[(&str, ColumnKind)],
        existing: Existing,
    ) -> Result<Self, FileError> {
        let draft = Draft::begin(target, existing)?;
        let begun = match form {
            Form::Csv => {
                let names = doubles.iter().map(String::as_str).chain(wholes.iter().map(|whole| whole.0));
                Csv::begin(draft, names).map(|csv| Sink::Csv(Box::new(csv)))
            }
            #[cfg(feature = "parquet")]
            Form::Parquet => columnar::Columns::create(draft, doubles, wholes).map(|c| Sink::Parquet(Box::new(c))),
            #[cfg(not(feature = "parquet"))]
            Form::Parquet => Err(io::Error::new(io::ErrorKind::Unsupported, FormError::NoParquet)),
        };
        let sink = begun.map_err(|error| FileError::Failed { path: target.to_owned(), error })?;
        Ok(Self { target: target.to_owned(), sink })
    }

    /// Adds a row: as many numbers as there are columns.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn row(&mut self, doubles: &[f64], wholes: &[u64]) -> io::Result<()> {
        match &mut self.sink {
            Sink::Csv(csv) => {
                let doubles = doubles.iter().map(|value| Field::Number(*value));
                csv.row(doubles.chain(wholes.iter().map(|value| Field::Count(*value))))
            }
            #[cfg(feature = "parquet")]
            Sink::Parquet(columns) => columns.push(doubles, wholes),
        }
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// The rest cannot be written, or somebody has taken the name meanwhile.
    pub fn finish(self) -> Result<(), FileError> {
        let Self { target, sink } = self;
        let draft = match sink {
            Sink::Csv(csv) => csv.finish(),
            #[cfg(feature = "parquet")]
            Sink::Parquet(columns) => columns.finish(),
        };
        draft.map_err(|error| FileError::Failed { path: target, error })?.finish()
    }
}

/// A column of numbers of a table that was written here.
///
/// # Errors
/// A file that cannot be read, a column that it has not, or a form that is not built in.
pub(crate) fn read_column(path: &Path, form: Form, name: &str) -> io::Result<Vec<f64>> {
    let broken = |why: String| io::Error::new(io::ErrorKind::InvalidData, format!("'{}': {why}", path.display()));
    match form {
        Form::Csv => {
            let mut reader = ::csv::Reader::from_path(path).map_err(|error| broken(error.to_string()))?;
            let head = reader.headers().map_err(|error| broken(error.to_string()))?;
            let at = head.iter().position(|own| own == name).ok_or_else(|| broken(format!("no column {name}")))?;
            let number = |record: Result<::csv::StringRecord, ::csv::Error>| {
                let record = record.map_err(|error| broken(error.to_string()))?;
                let cell = record.get(at).unwrap_or_default();
                cell.parse().map_err(|_| broken(format!("'{cell}' in column {name}: expected a number")))
            };
            reader.records().map(number).collect()
        }
        #[cfg(feature = "parquet")]
        Form::Parquet => columnar::read(path, name).map_err(|error| broken(error.to_string())),
        #[cfg(not(feature = "parquet"))]
        Form::Parquet => Err(broken(FormError::NoParquet.to_string())),
    }
}

/// How many rows a Parquet file has, as its footer says.
///
/// # Errors
/// A file that cannot be read, or a build without Parquet.
pub(crate) fn count_parquet_rows(path: &Path) -> io::Result<u64> {
    #[cfg(feature = "parquet")]
    return columnar::rows(path);
    #[cfg(not(feature = "parquet"))]
    Err(io::Error::new(io::ErrorKind::Unsupported, format!("{}: {}", path.display(), FormError::NoParquet)))
}

#[cfg(feature = "parquet")]
mod columnar;
