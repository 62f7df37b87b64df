//! Long tables as files, row by row: CSV, or Parquet with the cargo feature `parquet`. A file is written under another name
//! beside its place and renamed when it is whole, so that an interruption leaves no half-written one.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

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
pub enum Kind {
    /// Doubles.
    Double,
    /// Whole numbers of 32 bits.
    Int,
    /// Whole numbers of 64 bits.
    Long,
}

/// A new file beside `target`, to be given that name once it is whole. It has the rights of any new file, not those of a
/// secret, and is removed when dropped.
///
/// # Errors
/// The folder does not exist or cannot be written.
pub fn beside(target: &Path) -> io::Result<NamedTempFile> {
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    tempfile::Builder::new()
        .prefix(".whirl-")
        .suffix(".part")
        .make_in(folder, |path| File::options().read(true).write(true).create_new(true).open(path))
}

/// A table being written. The columns of doubles come first.
pub struct Table {
    target: PathBuf,
    sink: Sink,
}

enum Sink {
    Csv(BufWriter<NamedTempFile>),
    #[cfg(feature = "parquet")]
    Parquet(Box<columnar::Columns>),
}

impl Table {
    /// Opens a file beside `target`; it takes its name in [`Table::finish`]. `wholes` are the columns after the doubles.
    ///
    /// # Errors
    /// The folder does not exist or cannot be written, or the form is not built in.
    pub fn create(target: &Path, form: Form, doubles: &[String], wholes: &[(&str, Kind)]) -> io::Result<Self> {
        let file = beside(target)?;
        let sink = match form {
            Form::Csv => {
                let mut out = BufWriter::with_capacity(1 << 16, file);
                let names: Vec<&str> = doubles.iter().map(String::as_str).chain(wholes.iter().map(|w| w.0)).collect();
                writeln!(out, "{}", names.join(","))?;
                Sink::Csv(out)
            }
            #[cfg(feature = "parquet")]
            Form::Parquet => Sink::Parquet(Box::new(columnar::Columns::create(file, doubles, wholes)?)),
            #[cfg(not(feature = "parquet"))]
            Form::Parquet => return Err(io::Error::new(io::ErrorKind::Unsupported, FormError::NoParquet)),
        };
        Ok(Self { target: target.to_owned(), sink })
    }

    /// Adds a row: as many numbers as there are columns.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn row(&mut self, doubles: &[f64], wholes: &[u64]) -> io::Result<()> {
        match &mut self.sink {
            Sink::Csv(out) => {
                let mut comma = "";
                for value in doubles {
                    write!(out, "{comma}{value}")?;
                    comma = ",";
                }
                for value in wholes {
                    write!(out, "{comma}{value}")?;
                    comma = ",";
                }
                writeln!(out)
            }
            #[cfg(feature = "parquet")]
            Sink::Parquet(columns) => columns.push(doubles, wholes),
        }
    }

    /// Completes the file and gives it its name, in place of any file of that name.
    ///
    /// # Errors
    /// The rest cannot be written, or the name cannot be taken.
    pub fn finish(self) -> io::Result<()> {
        let file = match self.sink {
            Sink::Csv(out) => out.into_inner().map_err(io::IntoInnerError::into_error)?,
            #[cfg(feature = "parquet")]
            Sink::Parquet(columns) => columns.finish()?,
        };
        file.as_file().sync_all()?;
        file.persist(&self.target).map_err(|failed| failed.error)?;
        Ok(())
    }
}

#[cfg(feature = "parquet")]
mod columnar;
