//! Everything that can become of a file, done to the small recording of the repository: with checksums, and without, as it
//! was written before there were any.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::Path;

use super::frame::{FOOTER, HEADER, STREAM_HEADER};
use super::{Met, Walk, put};
use crate::damage::{Damage, DamageKind};

/// A byte in so many is changed, one after the other; `DAMAGE_EVERY=1` for all of them.
const EVERY: usize = 1499;

fn every() -> usize {
    std::env::var("DAMAGE_EVERY").ok().and_then(|every| every.parse().ok()).unwrap_or(EVERY)
}

/// A file, and what is done to it.
struct Patient {
    whole: Vec<u8>,
    folder: tempfile::TempDir,
}

/// What a walk has found.
#[derive(Debug, PartialEq)]
struct Found {
    streams: usize,
    messages: Vec<Vec<u8>>,
    damage: Vec<Damage>,
    sealed: bool,
}

impl Found {
    fn kinds(&self) -> Vec<DamageKind> {
        self.damage.iter().map(|damage| damage.kind).collect()
    }
}

fn walk(file: &File) -> Found {
    let mut walk = Walk::new(file, file.metadata().unwrap().len(), |_| true);
    let (mut streams, mut messages) = (0, Vec::new());
    while let Some(met) = walk.next().unwrap() {
        match met {
            Met::Stream { .. } => streams += 1,
            Met::Message { bytes, .. } => messages.push(bytes),
        }
    }
    Found { streams, messages, damage: walk.damage, sealed: walk.sealed }
}

impl Patient {
    fn of(whole: Vec<u8>) -> Self {
        Self { whole, folder: tempfile::tempdir().unwrap() }
    }

    /// As it was written before there were checksums.
    fn old() -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../recordings/run-up.rrd");
        Self::of(std::fs::read(path).unwrap())
    }

    /// The same with checksums.
    fn new() -> Self {
        let old = Self::old();
        let stream_header = &old.whole[..STREAM_HEADER as usize];
        let mut new = stream_header.to_vec();
        for (number, mut message) in (0..).zip(old.found().messages) {
            put(&mut message, number, stream_header);
            new.extend(message);
        }
        // The end as it was, at its new place.
        let footer = old.whole.len() - FOOTER as usize;
        let length = u64::from_le_bytes(old.whole[footer + 8..footer + 16].try_into().unwrap());
        new.extend(&old.whole[footer - (length + HEADER) as usize..]);
        let (footer, table) = (new.len() - FOOTER as usize, new.len() as u64 - FOOTER - length);
        new[footer..footer + 8].copy_from_slice(&table.to_le_bytes());
        Self::of(new)
    }

    fn with(&self, content: &[u8]) -> Found {
        let path = self.folder.path().join("a.rrd");
        std::fs::write(&path, content).unwrap();
        walk(&File::open(path).unwrap())
    }

    fn found(&self) -> Found {
        self.with(&self.whole)
    }

    /// Changes bytes one after the other, each into another than it was.
    fn with_every_byte_changed(&self, mut judge: impl FnMut(usize, u8, Found)) {
        let path = self.folder.path().join("changed.rrd");
        std::fs::write(&path, &self.whole).unwrap();
        let file = File::options().read(true).write(true).open(path).unwrap();
        let mut random = fastrand::Rng::with_seed(7);
        let (head, step) = (0..64, every());
        for at in head.chain((64 + step / 2..self.whole.len()).step_by(step)) {
            let changed = self.whole[at] ^ random.u8(1..);
            file.write_all_at(&[changed], at as u64).unwrap();
            judge(at, changed, walk(&file));
            file.write_all_at(&self.whole[at..=at], at as u64).unwrap();
        }
    }
}

#[test]
fn a_whole_file_is_whole() {
    for (patient, sealed) in [(Patient::old(), false), (Patient::new(), true)] {
        let found = patient.found();
        assert_eq!((found.streams, found.sealed, found.damage), (1, sealed, vec![]));
        assert!(found.messages.len() > 50);
    }
}

/// Most of them were read as if nothing had happened, and some were panics.
#[test]
fn regress_every_changed_byte_is_noticed_and_costs_the_message_that_it_is_in() {
    let patient = Patient::new();
    let messages = patient.found().messages;
    patient.with_every_byte_changed(|at, changed, found| {
        assert!(!found.damage.is_empty(), "byte {at} set to {changed}");
        let lost = messages.iter().filter(|message| !found.messages.contains(message)).count();
        // That of a stream's header costs the first one, which vouches for it.
        assert!(lost <= 1, "byte {at} set to {changed}: {lost} messages, {:?}", found.damage);
        assert!(found.messages.iter().all(|message| messages.contains(message)), "byte {at} set to {changed}");
        let (first, last) = (&found.damage[0], found.damage.last().unwrap());
        let place = first.byte..=last.byte + last.bytes;
        assert!(place.contains(&(at as u64)) || at < STREAM_HEADER as usize, "byte {at}: {:?}", found.damage);
    });
}

#[test]
fn a_file_without_checksums_is_gone_through_whatever_is_changed_in_it() {
    let patient = Patient::old();
    let messages = patient.found().messages.len();
    patient.with_every_byte_changed(|at, changed, found| {
        assert!(found.messages.len() + 2 >= messages, "byte {at} set to {changed}: {:?}", found.damage);
    });
}

#[test]
fn what_is_cut_off_or_filled_with_zeros_is_read_up_to_there_and_told() {
    let patient = Patient::new();
    let whole = patient.found();
    let mut ends = vec![STREAM_HEADER as usize];
    ends.extend(whole.messages.iter().scan(STREAM_HEADER as usize, |at, message| {
        *at += message.len();
        Some(*at)
    }));
    let cuts = (1..40).map(|i| i * patient.whole.len() / 40 + i).chain(ends.iter().copied());
    for cut in cuts {
        let there = ends.iter().filter(|end| **end <= cut).count() - 1;
        let found = patient.with(&patient.whole[..cut]);
        assert_eq!(found.messages.len(), there, "{cut}");
        // At a message's end nothing tells; there is no end then.
        assert_eq!(found.damage.is_empty(), ends.contains(&cut), "{cut}: {:?}", found.damage);
        assert!(
            found.kinds().iter().all(|kind| matches!(kind, DamageKind::Cut | DamageKind::End | DamageKind::Zeros)),
            "{found:?}"
        );

        let mut filled = patient.whole[..cut].to_vec();
        filled.resize(cut + 5000, 0);
        let found = patient.with(&filled);
        assert_eq!((found.messages.len(), found.kinds().last()), (there, Some(&DamageKind::Zeros)), "{cut}");
        assert_eq!(found.damage.last().map(|damage| damage.byte + damage.bytes), Some(filled.len() as u64));
    }
}

#[test]
fn bytes_behind_the_end_and_between_messages_are_told() {
    for patient in [Patient::old(), Patient::new()] {
        let whole = patient.found();
        for tail in [&b"\0"[..], b"x", &[7; 40], b"RRF2"] {
            let found = patient.with(&[&patient.whole[..], tail].concat());
            assert_eq!((&found.messages, found.damage.len()), (&whole.messages, 1), "{tail:?}");
            assert_eq!((found.damage[0].byte, found.damage[0].bytes), (patient.whole.len() as u64, tail.len() as u64));
        }
        let between = STREAM_HEADER as usize + whole.messages[..7].iter().map(Vec::len).sum::<usize>();
        let (before, after) = patient.whole.split_at(between);
        let found = patient.with(&[before, &[0xa5; 333], after].concat());
        assert!(found.messages.len() + 1 >= whole.messages.len(), "{:?}", found.damage);
        assert!(found.damage.iter().any(|damage| damage.kind == DamageKind::Foreign), "{:?}", found.damage);
    }
}

#[test]
fn a_message_that_was_taken_out_is_missed() {
    let patient = Patient::new();
    let whole = patient.found();
    let at = STREAM_HEADER as usize + whole.messages[..7].iter().map(Vec::len).sum::<usize>();
    let found = patient.with(&[&patient.whole[..at], &patient.whole[at + whole.messages[7].len()..]].concat());
    assert_eq!(found.messages.len(), whole.messages.len() - 1);
    assert_eq!((found.kinds()[0], found.damage[0].byte), (DamageKind::Missing, at as u64));
}

#[test]
fn files_that_are_put_behind_one_another_are_streams_of_their_own() {
    let (old, new) = (Patient::old(), Patient::new());
    let count = old.found().messages.len();
    for (first, second) in [(&old, &new), (&new, &old), (&new, &new)] {
        let found = first.with(&[&first.whole[..], &second.whole[..]].concat());
        assert_eq!((found.streams, found.messages.len(), found.damage), (2, 2 * count, vec![]));
        // Behind one that was cut off too.
        let cut = first.whole.len() / 2;
        let found = first.with(&[&first.whole[..cut], &second.whole[..]].concat());
        assert!(found.streams == 2 && found.messages.len() > count + count / 4, "{:?}", found.damage);
        assert!(!found.damage.is_empty());
    }
}

#[test]
fn what_is_no_recording_has_nothing_in_it() {
    let patient = Patient::of(vec![]);
    for content in [&b""[..], b"tau,y1\n1.0,2.0\n", b"RRF2", &[0; 100_000], &[0xff; 5000]] {
        let found = patient.with(content);
        assert_eq!((found.streams, found.messages.len()), (0, 0));
    }
}
