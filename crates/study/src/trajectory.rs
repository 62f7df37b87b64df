//! A run as a file: one row a sample. It is written under another name beside its place and renamed when it is whole, so
//! that an interrupted run leaves no half-written file.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use rotor::{C64, Motion};
use tempfile::NamedTempFile;

use crate::run::Observer;

/// In which form a trajectory is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Comma-separated values, every digit.
    Csv,
    /// Apache Parquet, columns of doubles. Only with the cargo feature `parquet`.
    Parquet,
}

/// Why a file cannot be written, as far as its name tells.
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
    /// Recordings are not made by runs yet.
    #[error("recording to .rrd is not built in yet: write .csv or .parquet")]
    NoRecording,
}

impl Form {
    /// What the ending of `path` asks for.
    ///
    /// # Errors
    /// An ending that is not known, or known and not built in.
    pub fn of(path: &Path) -> Result<Self, FormError> {
        match path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") if cfg!(feature = "parquet") => Ok(Self::Parquet),
            Some("parquet") => Err(FormError::NoParquet),
            Some("rrd") => Err(FormError::NoRecording),
            _ => Err(FormError::Unknown(path.to_owned())),
        }
    }
}

/// Names of the columns: `tau`, `y1 z1 vy1 vz1` and so on for every mass, `uy uz`, and `contact` (bit `k` for mass `k + 1`).
#[must_use]
pub fn columns(masses: usize) -> Vec<String> {
    let per_mass = (1..=masses).flat_map(|k| ["y", "z", "vy", "vz"].map(|name| format!("{name}{k}")));
    std::iter::once("tau".to_owned()).chain(per_mass).chain(["uy", "uz", "contact"].map(str::to_owned)).collect()
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

/// Writes one sample in every `stride`.
pub struct Writer {
    target: PathBuf,
    stride: u64,
    seen: u64,
    row: Vec<f64>,
    sink: Sink,
}

enum Sink {
    Csv(BufWriter<NamedTempFile>),
    #[cfg(feature = "parquet")]
    Parquet(Box<crate::trajectory::columnar::Columns>),
}

impl Writer {
    /// Opens a file beside `target`; it takes its name in [`Writer::finish`].
    ///
    /// # Errors
    /// The folder does not exist or cannot be written.
    pub fn create(target: &Path, form: Form, masses: usize, stride: u64) -> io::Result<Self> {
        let file = beside(target)?;
        let names = columns(masses);
        let sink = match form {
            Form::Csv => {
                let mut out = BufWriter::with_capacity(1 << 16, file);
                writeln!(out, "{}", names.join(","))?;
                Sink::Csv(out)
            }
            #[cfg(feature = "parquet")]
            Form::Parquet => Sink::Parquet(Box::new(columnar::Columns::create(file, &names)?)),
            #[cfg(not(feature = "parquet"))]
            Form::Parquet => return Err(io::Error::new(io::ErrorKind::Unsupported, FormError::NoParquet)),
        };
        Ok(Self { target: target.to_owned(), stride: stride.max(1), seen: 0, row: Vec::new(), sink })
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

impl Observer for Writer {
    fn sample(&mut self, motion: &Motion<'_>, control: C64, contact: u32) -> io::Result<()> {
        let wanted = self.seen.is_multiple_of(self.stride);
        self.seen += 1;
        if !wanted {
            return Ok(());
        }
        self.row.clear();
        self.row.push(motion.tau);
        for (p, v) in motion.displacement.iter().zip(motion.velocity) {
            self.row.extend([p.re, p.im, v.re, v.im]);
        }
        self.row.extend([control.re, control.im]);
        match &mut self.sink {
            Sink::Csv(out) => {
                for value in &self.row {
                    write!(out, "{value},")?;
                }
                writeln!(out, "{contact}")
            }
            #[cfg(feature = "parquet")]
            Sink::Parquet(columns) => columns.push(&self.row, contact),
        }
    }
}

#[cfg(feature = "parquet")]
mod columnar;
