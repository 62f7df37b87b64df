//! The report as files. They are all made in a temporary folder inside the target and then moved to their names, so that
//! whoever interrupts it finds no half-written file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use rayon::prelude::*;

use super::{Figure, Report, ReportError, Watch};
use crate::plot::{png, svg};

/// Folders in the target.
const FOLDERS: [&str; 2] = ["figures", "data"];
/// Files of a figure, each counted as a step by [`folder`].
pub const FILES_PER_FIGURE: usize = 3;
/// Files beside those of the figures: the two pages, and the table of numbers.
pub const PAGES: usize = 3;

/// Writes the pages `index.html` and `report.md`, `data/numbers.csv`, and for every figure `figures/*.svg`,
/// `figures/*.png` and `data/*.csv` into `target`, which is made if it is not there. Files of other names are left alone.
/// `watch` is told of every file; gives how many there are.
///
/// # Errors
/// A folder or file that cannot be written, or a request to stop.
pub fn folder(report: &Report, target: &Path, watch: &Watch<'_>) -> Result<usize, ReportError> {
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
        if watch.stop.load(Ordering::Relaxed) {
            return Err(ReportError::Interrupted);
        }
        fs::write(part.path().join(name), content).map_err(at(&target.join(name)))?;
        (watch.done)();
        Ok(PathBuf::from(name))
    };
    let mut files: Vec<PathBuf> = report
        .figures
        .par_iter()
        .with_max_len(1)
        .map(|figure| figure_files(figure, &put))
        .collect::<Result<Vec<_>, ReportError>>()?
        .concat();
    files.push(put("data/numbers.csv", report.numbers_csv().as_bytes())?);
    files.push(put("report.md", report.markdown(true).as_bytes())?);
    files.push(put("index.html", report.html().as_bytes())?);

    for folder in FOLDERS {
        fs::create_dir_all(target.join(folder)).map_err(at(&target.join(folder)))?;
    }
    for file in &files {
        fs::rename(part.path().join(file), target.join(file)).map_err(at(&target.join(file)))?;
    }
    Ok(files.len())
}

/// Writes the page alone, as Markdown without pictures, under another name first.
///
/// # Errors
/// A file that cannot be written.
pub fn page(report: &Report, target: &Path) -> Result<(), ReportError> {
    let failed = |error| ReportError::Write { path: target.to_owned(), error };
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // A new file has the rights of any new file, not those of a secret.
    let part = tempfile::Builder::new()
        .prefix(".whirl-")
        .suffix(".part")
        .make_in(folder, |path| fs::File::options().write(true).create_new(true).open(path))
        .map_err(failed)?;
    fs::write(part.path(), report.markdown(false)).map_err(failed)?;
    part.persist(target).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Puts a file of that name and content into the folder of parts.
type Put<'a> = dyn Fn(&str, &[u8]) -> Result<PathBuf, ReportError> + Sync + 'a;

fn figure_files(figure: &Figure, put: &Put<'_>) -> Result<Vec<PathBuf>, ReportError> {
    let (stem, scene) = (figure.stem(), figure.chart.scene());
    Ok(vec![
        put(&format!("figures/{stem}.svg"), svg(&scene, figure.title).as_bytes())?,
        put(&format!("figures/{stem}.png"), &png(&scene)?)?,
        put(&format!("data/{stem}.csv"), figure.data.csv().as_bytes())?,
    ])
}
