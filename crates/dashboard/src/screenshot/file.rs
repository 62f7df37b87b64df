//! Pictures of the screen in files, which replace nothing.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use crate::screenshot::image::Screenshot;

/// Keeps a picture in `folder`: as `name`, which ends in `.svg` or `.txt`, or as both under the name of the bench and the
/// present time. Returns where.
///
/// # Errors
/// In words: another kind of file, one that is there already, or one that cannot be written.
pub(crate) fn keep(screenshot: &Screenshot, folder: &Path, bench: &str, name: &str) -> Result<String, String> {
    if name.is_empty() {
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
        // A recording is named by its file.
        let bench: String = bench.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
        let stem = folder.join(format!("{bench}-{}", stamp(seconds)));
        let [svg, txt] = ["svg", "txt"].map(|kind| stem.with_added_extension(kind));
        write(&svg, &screenshot.svg)?;
        write(&txt, &screenshot.text)?;
        return Ok(format!("{} and .txt", svg.display()));
    }
    let file = folder.join(name);
    let content = match file.extension().and_then(|kind| kind.to_str()) {
        Some("svg") => &screenshot.svg,
        Some("txt") => &screenshot.text,
        _ => return Err(format!("'{name}': expected a file that ends in .svg or .txt")),
    };
    write(&file, content)?;
    Ok(file.display().to_string())
}

fn write(file: &PathBuf, content: &str) -> Result<(), String> {
    let written = OpenOptions::new().write(true).create_new(true).open(file);
    let written = written.and_then(|mut open| {
        let done = open.write_all(content.as_bytes()).and_then(|()| open.sync_all());
        if done.is_err() {
            // No half of a picture.
            let _ = std::fs::remove_file(file);
        }
        done
    });
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => format!("{} is there already: nothing is overwritten", file.display()),
        _ => format!("{}: cannot be written: {error}", file.display()),
    })
}

/// `20261122-160509` of so many seconds since 1970, in UTC. The only civil date of the program: jiff for these lines would cost 4 s of
/// processor time to build (0.2.46, without time zones).
#[must_use]
pub fn stamp(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    // Years that begin in March, so that the leap day is the last: the usual way through the Gregorian calendar.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * march + 2) / 5 + 1;
    let month = if march < 10 { march + 3 } else { march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year:04}{month:02}{day:02}-{:02}{:02}{:02}", rest / 3600, rest / 60 % 60, rest % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_kept_and_replace_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let screenshot = Screenshot { text: "a\n".into(), svg: "<svg/>".into() };
        let keep = |name: &str| keep(&screenshot, folder.path(), "a/be", name);
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(keep("a.txt").unwrap().ends_with("a.txt") && read("a.txt") == "a\n");
        assert!(keep("a.svg").is_ok() && read("a.svg") == "<svg/>");
        assert!(keep("a.svg").unwrap_err().ends_with("a.svg is there already: nothing is overwritten"));
        assert_eq!(keep("a.png"), Err("'a.png': expected a file that ends in .svg or .txt".into()));
        assert!(keep("none/a.svg").unwrap_err().contains("cannot be written"));
        let told = keep("").unwrap();
        assert!(told.contains("/a-be-20") && told.ends_with(".svg and .txt"), "{told}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
    }

    #[test]
    fn stamps_are_dates() {
        // As `date -u -d @N +%Y%m%d-%H%M%S` gives them.
        for (seconds, text) in [
            (0, "19700101-000000"),
            (951_782_399, "20000228-235959"),
            (951_782_400, "20000229-000000"),
            (1_709_251_199, "20240229-235959"),
            (1_795_363_509, "20261122-160509"),
            (4_107_542_400, "21000301-000000"),
        ] {
            assert_eq!(stamp(seconds), text);
        }
    }
}
