//! The report as files. They are all made in a temporary folder inside the target and then moved to their names, so that
//! whoever interrupts it finds no half-written file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use files::{Existing, FileError};
use rayon::prelude::*;

use super::{Figure, Onlooker, Report, ReportError};
use plot::{png, svg};

/// Folders in the target.
const FOLDERS: [&str; 2] = ["figures", "data"];
/// Files of a figure, each counted as a step by [`folder`].
pub const FILES_PER_FIGURE: usize = 3;
/// Files beside those of the figures: the two pages, and the table of numbers.
pub const PAGES: usize = FIXED.len();
/// Their names.
const FIXED: [&str; 3] = ["data/numbers.csv", "report.md", "index.html"];

/// Writes the pages `index.html` and `report.md`, `data/numbers.csv`, and for every figure `figures/*.svg`,
/// `figures/*.png` and `data/*.csv` into `target`, which is made if it is not there. Files of other names are left alone, and
/// so are those of these unless `existing` says otherwise. `onlooker` is told of every file; gives how many there are.
///
/// # Errors
/// A folder or file that cannot be written, a file that is there and is to be kept, or a request to stop.
pub fn folder(
    report: &Report,
    target: &Path,
    existing: Existing,
    onlooker: &Onlooker<'_>,
) -> Result<usize, ReportError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        move |error: io::Error| ReportError::Write { path, error }
    };
    fs::create_dir_all(target).map_err(at(target))?;
    // Inside the target, so that a move is a change of name.
    let part = tempfile::Builder::new().prefix(".whirl-").suffix(".part").tempdir_in(target).map_err(at(target))?;
    for folder in FOLDERS {
        fs::create_dir(part.path().join(folder)).map_err(at(&target.join(folder)))?;
    }
    let put = |name: &str, content: &[u8]| -> Result<PathBuf, ReportError> {
        if onlooker.stop.load(Ordering::Relaxed) {
            return Err(ReportError::Interrupted);
        }
        fs::write(part.path().join(name), content).map_err(at(&target.join(name)))?;
        (onlooker.done)();
        Ok(PathBuf::from(name))
    };
    let mut files: Vec<PathBuf> = report
        .figures
        .par_iter()
        .with_max_len(1)
        .map(|figure| figure_files(figure, &put))
        .collect::<Result<Vec<_>, ReportError>>()?
        .concat();
    files.push(put(FIXED[0], report.numbers_csv().as_bytes())?);
    files.push(put(FIXED[1], report.markdown(true).as_bytes())?);
    files.push(put(FIXED[2], report.html().as_bytes())?);

    for folder in FOLDERS {
        fs::create_dir_all(target.join(folder)).map_err(at(&target.join(folder)))?;
    }
    // All of them or none.
    for file in &files {
        check(&target.join(file), existing)?;
    }
    for file in &files {
        fs::rename(part.path().join(file), target.join(file)).map_err(at(&target.join(file)))?;
    }
    Ok(files.len())
}

/// Whether nothing of an earlier report is in the way in `target`, before there is a new one.
///
/// # Errors
/// A file is there and is to be kept.
pub fn check_folder(target: &Path, existing: Existing) -> Result<(), ReportError> {
    // What every report has, whichever figures.
    FIXED.iter().try_for_each(|file| check(&target.join(file), existing))
}

fn check(path: &Path, existing: Existing) -> Result<(), ReportError> {
    match files::check(path, existing) {
        // The folder of a file may be still to be made.
        Err(FileError::Unfit { .. }) | Ok(()) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// Writes the page alone, as Markdown without pictures.
///
/// # Errors
/// A file that cannot be written, or that is there and is to be kept.
pub fn page(report: &Report, target: &Path, existing: Existing) -> Result<(), ReportError> {
    Ok(files::write(target, report.markdown(false).as_bytes(), existing)?)
}

/// Puts a file of that name and content into the folder of parts.
type Put<'a> = dyn Fn(&str, &[u8]) -> Result<PathBuf, ReportError> + Sync + 'a;

fn figure_files(figure: &Figure, put: &Put<'_>) -> Result<Vec<PathBuf>, ReportError> {
    let stem = figure.stem();
    let picture = svg(&figure.chart.scene(), &stem, figure.title);
    Ok(vec![
        put(&format!("figures/{stem}.svg"), picture.as_bytes())?,
        put(&format!("figures/{stem}.png"), &png(&picture)?)?,
        put(&format!("data/{stem}.csv"), figure.data.csv().as_bytes())?,
    ])
}
