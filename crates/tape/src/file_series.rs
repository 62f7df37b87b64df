//! Files that belong together: the row that a split or a rolling recording has become.
//!
//! A part tells at its end in which file the recording goes on, and names are numbered; so any part leads to all others.
//! Where one is missing the row goes on behind it. Steps of different runs have the same numbers: they stay apart.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use crate::batch::Batch;
use crate::contents::{Contents, Decoder, Stretch};
use crate::error::TapeError;
use crate::event::What;
use crate::session::Source;
use crate::snapshot::{Snapshot, SnapshotPlace};

/// Numbers of parts are smaller than this: what is larger is a time of day.
const MOST_PARTS: u32 = 100_000;

/// Files that are kept open.
const MOST_OPEN: usize = 64;

/// One file, open for reading.
pub(crate) struct OpenFile {
    path: PathBuf,
    contents: Contents,
    decoder: Box<dyn Decoder>,
}

/// Files that a recorder wrote one after the other, as if they were one.
pub(crate) struct FileSeries {
    pub(crate) paths: Vec<PathBuf>,
    pub(crate) contents: Contents,
    pub(crate) decoder: Box<dyn Decoder>,
}

impl OpenFile {
    pub(crate) fn open(path: &Path) -> Result<Self, TapeError> {
        #[cfg(feature = "rerun")]
        {
            let (contents, decoder) = crate::rrd::open(path)?;
            Ok(Self { path: path.to_owned(), contents, decoder: Box::new(decoder) })
        }
        #[cfg(not(feature = "rerun"))]
        {
            let _ = path;
            Err(TapeError::NoRerun)
        }
    }

    fn name(&self) -> String {
        name(&self.path)
    }

    fn run(&self) -> u64 {
        self.contents.session.run_id
    }

    /// The name of the file in which the recording goes on.
    fn next(&self) -> Option<String> {
        self.contents.remarks.iter().rev().find_map(|remark| match &remark.what {
            What::Continues(next) => Some(next.clone()),
            _ => None,
        })
    }

    /// The file `path`, if it is there and of the same run.
    fn fellow(&self, path: &Path) -> Fellow {
        if !path.exists() {
            return Fellow::Missing;
        }
        // The head tells whose it is: another run's steps need not be read.
        match run_of(path) {
            Some(run) if run == self.run() => {
                Self::open(path).map_or(Fellow::Missing, |part| Fellow::Part(Box::new(part)))
            }
            Some(_) => Fellow::Stranger,
            None => Fellow::Missing,
        }
    }
}

enum Fellow {
    Part(Box<OpenFile>),
    /// It is of another run.
    Stranger,
    /// It is not there, or cannot be read.
    Missing,
}

fn run_of(path: &Path) -> Option<u64> {
    #[cfg(feature = "rerun")]
    return crate::rrd::run_of(path);
    #[cfg(not(feature = "rerun"))]
    {
        let _ = path;
        None
    }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// `s-3.rrd` as `s` and 3.
fn numbered(name: &str) -> Option<(&str, u32)> {
    let (stem, number) = name.strip_suffix(".rrd")?.rsplit_once('-')?;
    let number = (!number.starts_with('0')).then(|| number.parse::<u32>().ok())??;
    (number < MOST_PARTS).then_some((stem, number))
}

/// The parts of `stem` that are in a folder, ascending in number. The first may have none.
fn there(folder: &Path, stem: &str) -> Vec<(u32, PathBuf)> {
    let entries = std::fs::read_dir(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    let mut found: Vec<(u32, PathBuf)> = (entries.into_iter().flatten().flatten())
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            let number = match numbered(&name) {
                Some((other, number)) if other == stem => number,
                _ if name.strip_suffix(".rrd") == Some(stem) => 1,
                _ => return None,
            };
            Some((number, folder.join(name)))
        })
        .collect();
    found.sort();
    found
}

/// The parts of a recording `path` that are in its folder, itself not among them.
pub(crate) fn parts_of(path: &Path) -> Vec<PathBuf> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let found = there(path.parent().unwrap_or(Path::new("")), &stem);
    found.into_iter().map(|(_, part)| part).filter(|part| part.file_name() != path.file_name()).collect()
}

/// Parts that are missing, in words.
fn missing(stem: &str, from: u32, to: u32) -> String {
    let name = |number: u32| format!("{stem}-{number}.rrd");
    match to - from {
        0 => format!("{} is not there", name(from)),
        _ => format!("{} to {} are not there", name(from), name(to)),
    }
}

impl FileSeries {
    /// The whole row to which the file `path` belongs: that file alone, if it is no part of one.
    ///
    /// # Errors
    /// It cannot be read, and neither is it the name of a rolling recording of which only parts are left.
    pub(crate) fn of(path: &Path) -> Result<Self, TapeError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let given = match OpenFile::open(path) {
            Err(error) if !path.exists() => {
                // A rolling recording has its name only when it has ended.
                let name = name(path);
                let parts = name.strip_suffix(".rrd").map(|stem| there(folder, stem)).unwrap_or_default();
                let Some((_, first)) = parts.first() else { return Err(error) };
                OpenFile::open(first)?
            }
            opened => opened?,
        };
        let (mut later, mut earlier) = (Vec::new(), Vec::new());
        let mut row = VecDeque::from([given]);
        if row[0].contents.session.source == Source::Live {
            while let Some(part) = row.back().and_then(|last| after(last, folder, &mut later)) {
                row.push_back(part);
            }
            while let Some(part) = row.front().and_then(|first| before(first, folder, &mut earlier)) {
                row.push_front(part);
            }
        }
        // In the order of the parts, from whichever we came.
        earlier.reverse();
        earlier.extend(later);
        Self::joined(row.into(), earlier)
    }

    /// These files as one, in the order of their steps.
    ///
    /// # Errors
    /// One cannot be read, they are of different runs, or have steps in common.
    pub(crate) fn of_all(paths: &[PathBuf]) -> Result<Self, TapeError> {
        let mut parts: Vec<OpenFile> = paths.iter().map(|path| OpenFile::open(path)).collect::<Result<_, _>>()?;
        if parts.len() > 1 {
            let first = parts.first().map(|part| (name(&part.path), part.run()));
            for part in &parts {
                let problem = match &first {
                    _ if part.contents.session.source == Source::Offline => {
                        "is a run without a bench, which has no parts: take it by itself".to_owned()
                    }
                    Some((other, run)) if *run != part.run() => {
                        format!("is of another run than '{other}': take each by itself")
                    }
                    _ => continue,
                };
                return Err(TapeError::not_ours(&part.path, problem));
            }
        }
        parts.sort_by_key(|part| part.contents.stretches.first().map(|stretch| stretch.first.seq));
        let names: Vec<String> = parts.iter().map(OpenFile::name).collect();
        let lacking = parts.iter().filter_map(OpenFile::next).filter(|next| !names.contains(next));
        let notices = lacking.map(|next| format!("{next} is not among these")).collect();
        Self::joined(parts, notices)
    }

    fn joined(parts: Vec<OpenFile>, more: Vec<String>) -> Result<Self, TapeError> {
        let names: Vec<String> = parts.iter().map(OpenFile::name).collect();
        let paths: Vec<PathBuf> = parts.iter().map(|part| part.path.clone()).collect();
        let mut decoders = Vec::with_capacity(parts.len());
        let mut whole: Option<Contents> = None;
        for (number, mut part) in parts.into_iter().enumerate() {
            if number >= MOST_OPEN {
                part.decoder.close();
            }
            decoders.push(part.decoder);
            let contents = &mut part.contents;
            contents.damage.iter_mut().for_each(|damage| damage.file.clone_from(&names[number]));
            contents.stretches.iter_mut().for_each(|stretch| stretch.part = number);
            contents.snapshots.iter_mut().for_each(|place| place.part = number);
            if names.len() > 1 {
                let name = &names[number];
                contents.notices.iter_mut().for_each(|notice| *notice = format!("{name}: {notice}"));
                // That a part begins and ends is news only where the row does.
                contents.remarks.retain(|remark| match &remark.what {
                    What::Begins => number == 0,
                    What::Continues(next) => !names.contains(next),
                    _ => true,
                });
            }
            match &mut whole {
                None => whole = Some(part.contents),
                Some(whole) => whole.append(part.contents),
            }
        }
        // There is one part at least.
        let mut contents = whole.ok_or_else(|| TapeError::not_ours(Path::new(""), "expected a file"))?;
        contents.notices.extend(more);
        contents.stretches.sort_by_key(|stretch| stretch.first.seq);
        for pair in contents.stretches.windows(2) {
            if pair[1].first.seq <= pair[0].last.seq && pair[1].part != pair[0].part {
                let (step, other) = (pair[1].first.seq, &names[pair[0].part]);
                let problem = format!("has step {step}, which '{other}' has too: expected parts of one recording");
                return Err(TapeError::not_ours(&paths[pair[1].part], problem));
            }
        }
        Ok(Self { paths, contents, decoder: Box::new(Parts(decoders)) })
    }
}

/// The part that follows.
fn after(last: &OpenFile, folder: &Path, notices: &mut Vec<String>) -> Option<OpenFile> {
    let next = last.next()?;
    match last.fellow(&folder.join(&next)) {
        Fellow::Part(part) => return Some(*part),
        Fellow::Stranger => {
            notices.push(format!("goes on in {next} with another run, which is a recording of its own"));
            return None;
        }
        Fellow::Missing => {}
    }
    let Some((stem, number)) = numbered(&next) else {
        notices.push(format!("{next} is not there"));
        return None;
    };
    let later = there(folder, stem).into_iter().filter(|(later, _)| *later > number);
    let found = later.into_iter().find_map(|(later, path)| match last.fellow(&path) {
        Fellow::Part(part) => Some((later, part)),
        _ => None,
    });
    notices.push(missing(stem, number, found.as_ref().map_or(number, |(later, _)| later - 1)));
    found.map(|(_, part)| *part)
}

/// The part before.
fn before(first: &OpenFile, folder: &Path, notices: &mut Vec<String>) -> Option<OpenFile> {
    let name = first.name();
    let (stem, number) = numbered(&name)?;
    let earlier = there(folder, stem).into_iter().rev().filter(|(earlier, _)| *earlier < number);
    for (earlier, path) in earlier {
        let Fellow::Part(part) = first.fellow(&path) else { continue };
        // What does not go on in a part after it is another recording of the same run.
        if part.next() != Some(format!("{stem}-{}.rrd", earlier + 1)) {
            return None;
        }
        if earlier + 1 < number {
            notices.push(missing(stem, earlier + 1, number - 1));
        }
        return Some(*part);
    }
    None
}

/// Decodes each stretch from its own file.
struct Parts(Vec<Box<dyn Decoder>>);

impl Decoder for Parts {
    fn decode(&mut self, stretch: &Stretch) -> Result<Batch, TapeError> {
        let lost = || TapeError::read(Path::new(""), "a stretch without a file");
        self.0.get_mut(stretch.part).ok_or_else(lost)?.decode(stretch)
    }

    fn snapshot(&mut self, place: &SnapshotPlace) -> Result<Snapshot, TapeError> {
        let lost = || TapeError::read(Path::new(""), "a snapshot without a file");
        self.0.get_mut(place.part).ok_or_else(lost)?.snapshot(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_parts_are_not_times_of_day() {
        for (name, is) in [
            ("s-3.rrd", Some(("s", 3))),
            ("a-b-12.rrd", Some(("a-b", 12))),
            ("s.rrd", None),
            ("s-02.rrd", None),
            ("s--1.rrd", Some(("s-", 1))),
            ("default-20261122-160509.rrd", None),
            ("default-20261122-160509-2.rrd", Some(("default-20261122-160509", 2))),
            ("s-2.csv", None),
        ] {
            assert_eq!(numbered(name), is, "{name}");
        }
        assert_eq!(missing("s", 2, 2), "s-2.rrd is not there");
        assert_eq!(missing("s", 2, 4), "s-2.rrd to s-4.rrd are not there");
    }

    #[test]
    fn the_parts_in_a_folder_are_found_in_order() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["s.rrd", "s-10.rrd", "s-2.rrd", "s-2.csv", "t-3.rrd", "s-x.rrd"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found: Vec<_> = there(folder.path(), "s").into_iter().map(|(number, path)| (number, name(&path))).collect();
        assert_eq!(found, [(1, "s.rrd".into()), (2, "s-2.rrd".into()), (10, "s-10.rrd".into())]);
    }
}
