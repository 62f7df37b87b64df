//! Where a walk goes on behind damage. Anything may be among the bytes that are searched, copies of messages too, so
//! nothing is taken for one that is not proven to be; and the proofs cost no more than a few readings of the file,
//! however many bytes look like the beginning of something large.

use std::io;

use super::frame::{self, HEADER, Kind};
use super::seal::{self, Seal};
use super::walk::{Seals, Sight, Walk};
use super::window::BLOCK;

/// How many bytes may be looked at in proofs, in a file of that length: a message behind damage costs its own length.
pub(super) fn patience(length: u64) -> u64 {
    length.saturating_mul(8).saturating_add(1 << 26)
}

/// Messages about a recording and its layout are small.
const MOST_ABOUT: u64 = 1 << 16;

/// Whether 16 bytes may be the beginning of something: kinds are small numbers in eight bytes, and so are lengths.
fn may_begin(bytes: &[u8]) -> bool {
    match bytes {
        [b'R', b'R', b'F', b'2', ..] => true,
        [0..=3, 0, 0, 0, 0, 0, 0, 0, length @ .., 0, 0, 0, 0] => length.iter().any(|byte| *byte != 0),
        _ => false,
    }
}

impl Walk<'_> {
    /// The next place from `from` on where something begins, beyond doubt; the end of the file if nothing does.
    pub(super) fn search(&mut self, from: u64) -> io::Result<u64> {
        let end = self.window.length();
        let mut at = from;
        // The header of a stream is shorter than what is looked for, but there has to be something behind it.
        while at + HEADER <= end {
            let block = self.window.bytes(at, BLOCK.min(end - at))?;
            let windows = block.windows(HEADER as usize);
            let looked_at = windows.len() as u64;
            let places: Vec<u64> =
                (at..).zip(windows).filter(|(_, bytes)| may_begin(bytes)).map(|(place, _)| place).collect();
            for place in places {
                if self.is_one(place)? {
                    return Ok(place);
                }
            }
            at += looked_at;
        }
        Ok(end)
    }

    /// Whether there is a stream or a message at a place where neither had to be.
    pub(super) fn is_one(&mut self, at: u64) -> io::Result<bool> {
        let (kind, end) = match self.sight(at)? {
            Sight::Stream => return Ok(true),
            Sight::Nothing => return Ok(false),
            Sight::End { end } => return Ok(self.in_stream && self.may_take(end - at) && self.end_fits(at, end)?),
            Sight::Message { kind, end } => (kind, end),
        };
        if self.is_marked(end)? && self.may_take(end - at) {
            let bytes = self.window.bytes(at, end - at)?;
            if matches!(seal::check(bytes, &self.stream_header), Seal::Fits(_)) {
                return Ok(true);
            }
        }
        // All kinds of messages begin with their first field: whose they are.
        if matches!(self.seals, Seals::Next(_)) || self.window.few(at + HEADER)? != Some([0x0a]) {
            return Ok(false);
        }
        let is_likely = kind == Kind::Chunk || end - at < MOST_ABOUT;
        if !is_likely || !self.can_go_on(end)? || !self.may_take(end - at) {
            return Ok(false);
        }
        let bytes = self.window.bytes(at, end - at)?.to_vec();
        Ok(if kind == Kind::Chunk { self.is_message(&bytes) } else { frame::is_fields(&bytes[HEADER as usize..]) })
    }

    /// Whether so many bytes may still be looked at.
    fn may_take(&mut self, bytes: u64) -> bool {
        let left = self.patience.checked_sub(bytes);
        self.patience = left.unwrap_or(self.patience);
        left.is_some()
    }
}
