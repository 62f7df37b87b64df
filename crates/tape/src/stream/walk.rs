//! Goes from message to message through a file of which anything may be wrong: says where and what, and goes on behind it.
//!
//! ```text
//! file    = stream, or several, one put behind the other
//! stream  = header, messages, end        (12 bytes; kind and length before each; a table, and where it is)
//! ```
//!
//! What is at a place is believed if it fits what is around it: a length if something begins where it ends, a message if
//! its checksum fits. Where nothing does the bytes are searched for the next thing that can be one. In a file without
//! checksums whoever decodes a message has to judge it.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

use super::frame::{self, FOOTER, HEADER, Kind, MOST_BYTES, STREAM_HEADER};
use super::seal::{self, Seal};
use crate::damage::{Damage, DamageKind};

/// Fewer zeros in a row than this may be anything.
const FEWEST_ZEROS: u64 = 32;
/// Read at once.
const BLOCK: u64 = 1 << 20;

/// What has been met.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Met {
    /// A stream begins.
    Stream {
        /// At which byte of the file.
        at: u64,
    },
    /// A message: kind, length and all.
    Message {
        /// At which byte of the file.
        at: u64,
        /// Of which kind.
        kind: Kind,
        bytes: Vec<u8>,
    },
}

/// What can be at a place, as far as its first bytes and its length tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sight {
    Stream,
    Message {
        kind: Kind,
        end: u64,
    },
    /// With the table and all.
    End {
        end: u64,
    },
    Nothing,
}

/// A walk through a file.
pub(crate) struct Walk<'a> {
    file: &'a File,
    length: u64,
    at: u64,
    block: Vec<u8>,
    block_at: u64,
    /// Of the stream that we are in; empty before the first.
    stream_header: Vec<u8>,
    stream_at: u64,
    /// The number that the next message should have, once one with a checksum has been met in this stream.
    next: Option<u32>,
    /// Whether every message met had a checksum.
    pub(crate) sealed: bool,
    pub(crate) damage: Vec<Damage>,
    /// Whether bytes without checksum are a message, by what is in it.
    decodes: fn(&[u8]) -> bool,
}

impl<'a> Walk<'a> {
    /// From the beginning of a file of that length. `decodes` says of bytes without checksum, behind which nothing is as it
    /// should be, whether they are a message.
    pub(crate) fn new(file: &'a File, length: u64, decodes: fn(&[u8]) -> bool) -> Self {
        Self {
            file,
            length,
            at: 0,
            block: Vec::new(),
            block_at: 0,
            stream_header: Vec::new(),
            stream_at: 0,
            next: None,
            sealed: true,
            damage: Vec::new(),
            decodes,
        }
    }

    /// The header of the stream that we are in.
    pub(crate) fn stream_header(&self) -> &[u8] {
        &self.stream_header
    }

    /// Where the stream begins that we are in.
    pub(crate) fn stream_at(&self) -> u64 {
        self.stream_at
    }

    /// Where we are.
    pub(crate) fn at(&self) -> u64 {
        self.at
    }

    fn bytes(&mut self, at: u64, length: u64) -> io::Result<&[u8]> {
        let end = at + length;
        if at < self.block_at || end > self.block_at + self.block.len() as u64 {
            let wanted = length.max(BLOCK).min(self.length.saturating_sub(at));
            self.block.resize(usize::try_from(wanted).unwrap_or_default(), 0);
            self.block_at = at;
            if let Err(error) = self.file.read_exact_at(&mut self.block, at) {
                self.block.clear();
                return Err(error);
            }
        }
        let from = (at - self.block_at) as usize;
        self.block.get(from..from + length as usize).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
    }

    /// What is next in the file; `None` at its end.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(crate) fn next(&mut self) -> io::Result<Option<Met>> {
        while self.at < self.length {
            let at = self.at;
            match self.sight(at)? {
                Sight::Stream => return self.stream().map(Some),
                Sight::Message { kind, end } => {
                    if let Some(met) = self.message(kind, end)? {
                        return Ok(Some(met));
                    }
                }
                Sight::End { end } if self.end(end)? => {}
                Sight::Nothing if at == 0 && self.is_headless()? => {
                    self.damage.push(Damage::at(0, STREAM_HEADER, DamageKind::Foreign));
                    return self.stream().map(Some);
                }
                Sight::End { .. } | Sight::Nothing => {
                    let next = self.search(at + 1)?;
                    self.pass_over(next)?;
                }
            }
        }
        Ok(None)
    }

    /// Begins the stream whose header is here.
    fn stream(&mut self) -> io::Result<Met> {
        let at = self.at;
        self.stream_header = self.bytes(at, STREAM_HEADER)?.to_vec();
        self.stream_at = at;
        self.next = None;
        self.at += STREAM_HEADER;
        Ok(Met::Stream { at })
    }

    /// Whether the file begins with a stream whose header alone is damaged.
    fn is_headless(&mut self) -> io::Result<bool> {
        if self.length < STREAM_HEADER + HEADER {
            return Ok(false);
        }
        self.stream_header = self.bytes(0, STREAM_HEADER)?.to_vec();
        let first = self.sight(STREAM_HEADER)?;
        let is_first = matches!(first, Sight::Message { kind: Kind::Store, .. });
        let is_one = is_first && self.is_message(STREAM_HEADER)?;
        self.stream_header.clear();
        Ok(is_one)
    }

    /// Whether what seems to be a message at a place is followed by something.
    fn is_message(&mut self, at: u64) -> io::Result<bool> {
        let Sight::Message { end, .. } = self.sight(at)? else { return Ok(false) };
        self.can_go_on(end)
    }

    /// What can be at a place.
    fn sight(&mut self, at: u64) -> io::Result<Sight> {
        let left = self.length - at;
        if left >= STREAM_HEADER {
            let header = self.bytes(at, STREAM_HEADER)?;
            if frame::is_stream(header) {
                return Ok(Sight::Stream);
            }
        }
        // Messages are within a stream.
        if left < HEADER || self.stream_header.is_empty() {
            return Ok(Sight::Nothing);
        }
        let Some((kind, len)) = frame::header(self.bytes(at, HEADER)?) else { return Ok(Sight::Nothing) };
        let end = at.saturating_add(HEADER).saturating_add(len);
        if len > MOST_BYTES || end > self.length {
            return Ok(Sight::Nothing);
        }
        Ok(match kind {
            // Sixteen zeros are no end: ours have a table, even of nothing.
            _ if len == 0 => Sight::Nothing,
            Kind::End if end + FOOTER <= self.length => Sight::End { end: end + FOOTER },
            Kind::End => Sight::Nothing,
            kind => Sight::Message { kind, end },
        })
    }

    fn is_sealed(&self) -> bool {
        self.next.is_some()
    }

    /// Whether messages of this stream have no checksums, as far as can be told at one without that ends at `end`.
    fn has_none(&mut self, end: u64) -> io::Result<bool> {
        let Sight::Message { end: next, .. } = self.sight(end)? else { return Ok(!self.is_sealed()) };
        let bytes = self.bytes(end, next - end)?.to_vec();
        Ok(!self.is_sealed() && seal::check(&bytes, &self.stream_header) == Seal::None)
    }

    /// Whether something can begin where what is before it ends.
    fn can_go_on(&mut self, at: u64) -> io::Result<bool> {
        Ok(at == self.length || self.sight(at)? != Sight::Nothing)
    }

    /// Takes the message that seems to be here; `None` if it is not what was written.
    fn message(&mut self, kind: Kind, end: u64) -> io::Result<Option<Met>> {
        let at = self.at;
        let bytes = self.bytes(at, end - at)?.to_vec();
        let seal = seal::check(&bytes, &self.stream_header);
        match seal {
            Seal::Fits(number) => {
                let expected = self.next.unwrap_or(0);
                if number != expected {
                    // Told where the missing ones should be, unless it has been told what is there in their place.
                    let told = self.damage.last().is_some_and(|damage| damage.byte + damage.bytes == at);
                    if !told {
                        self.damage.push(Damage::at(at, 0, DamageKind::Missing));
                    }
                }
                self.next = Some(number.wrapping_add(1));
            }
            Seal::None if self.has_none(end)? && (self.can_go_on(end)? || (self.decodes)(&bytes)) => {
                self.sealed = false
            }
            Seal::None | Seal::Broken => {
                let next = if self.surely_goes_on(end)? { end } else { self.search(at + 1)? };
                if next < end || !self.can_go_on(end)? {
                    self.pass_over(next)?;
                    return Ok(None);
                }
                self.damage.push(Damage::at(at, next - at, DamageKind::Checksum));
                self.at = next;
                // Which number it had is not to be known from it.
                self.next = self.next.map(|number| number.wrapping_add(1));
                return Ok(None);
            }
        }
        self.at = end;
        Ok(Some(Met::Message { at, kind, bytes }))
    }

    /// Whether there is something at a place behind damage, beyond doubt.
    fn surely_goes_on(&mut self, at: u64) -> io::Result<bool> {
        Ok(at == self.length || self.is_one(at)?)
    }

    /// Passes over an end, and says if it is not what was written. Whether it is one at all.
    fn end(&mut self, end: u64) -> io::Result<bool> {
        let at = self.at;
        if !self.end_fits(at, end)? {
            if end < self.length && self.sight(end)? != Sight::Stream {
                return Ok(false);
            }
            self.damage.push(Damage::at(at, end - at, DamageKind::End));
        }
        self.stream_header.clear();
        self.at = end;
        Ok(true)
    }

    /// Whether what points at the table points at it, and its checksum fits.
    fn end_fits(&mut self, at: u64, end: u64) -> io::Result<bool> {
        let (table, stream_at) = (at + HEADER, self.stream_at);
        let bytes = self.bytes(table, end - table)?;
        let (content, footer) = bytes.split_at(bytes.len() - FOOTER as usize);
        Ok(frame::footer_fits(footer, content, [table, table - stream_at]))
    }

    /// The next place from `from` on where something can begin; the end of the file if there is none.
    fn search(&mut self, from: u64) -> io::Result<u64> {
        let mut at = from;
        while at < self.length {
            let length = BLOCK.min(self.length - at);
            let block = self.bytes(at, length)?;
            // Kinds are small numbers in eight bytes, lengths are below four gigabytes.
            let may_be = |at: usize| match block.get(at..at + 16) {
                Some(b) => {
                    b[..4] == *b"RRF2" || (b[0] <= 3 && b[1..8] == [0; 7] && b[12..16] == [0; 4] && b[8..12] != [0; 4])
                }
                None => block[at..].starts_with(b"RRF2"),
            };
            let last = length.saturating_sub(HEADER) as usize + 1;
            let places: Vec<u64> = (0..last.max(1)).filter(|at| may_be(*at)).map(|place| at + place as u64).collect();
            for place in places {
                if self.is_one(place)? {
                    return Ok(place);
                }
            }
            if at + length == self.length {
                break;
            }
            at += last as u64;
        }
        Ok(self.length)
    }

    /// Whether there is a stream or a message at a place where neither had to be.
    fn is_one(&mut self, at: u64) -> io::Result<bool> {
        let end = match self.sight(at)? {
            Sight::Stream => return Ok(true),
            Sight::Nothing => return Ok(false),
            Sight::End { end } => return self.end_fits(at, end),
            Sight::Message { end, .. } => end,
        };
        if !self.can_go_on(end)? {
            return Ok(false);
        }
        let bytes = self.bytes(at, end - at)?.to_vec();
        Ok(match seal::check(&bytes, &self.stream_header) {
            Seal::Fits(_) => true,
            // All kinds of messages begin with their first field: whose they are.
            Seal::None => !self.is_sealed() && bytes.get(HEADER as usize) == Some(&0x0a),
            Seal::Broken => false,
        })
    }

    /// Says what the bytes up to `next` are that nothing is made of.
    fn pass_over(&mut self, next: u64) -> io::Result<()> {
        let at = self.at;
        let zeros = self.zeros_before(at, next)?;
        let kind = match self.cut_kind(at)? {
            Some(kind) if next == self.length => kind,
            _ if zeros < next && next == self.length && !self.stream_header.is_empty() => DamageKind::Cut,
            _ => DamageKind::Foreign,
        };
        if zeros > at {
            self.damage.push(Damage::at(at, zeros - at, kind));
        }
        if zeros < next {
            self.damage.push(Damage::at(zeros, next - zeros, DamageKind::Zeros));
        }
        self.at = next;
        Ok(())
    }

    /// Where the zeros begin that fill the bytes from `from` up to `to`, if there are enough of them to be no chance.
    fn zeros_before(&mut self, from: u64, to: u64) -> io::Result<u64> {
        let (mut place, mut zeros) = (from, from);
        while place < to {
            let length = BLOCK.min(to - place);
            if let Some(last) = self.bytes(place, length)?.iter().rposition(|byte| *byte != 0) {
                zeros = place + last as u64 + 1;
            }
            place += length;
        }
        Ok(if zeros == from || to - zeros >= FEWEST_ZEROS { zeros } else { to })
    }

    /// What it is that begins here and would end beyond the end of the file, if anything does.
    fn cut_kind(&mut self, at: u64) -> io::Result<Option<DamageKind>> {
        if self.stream_header.is_empty() {
            return Ok(None);
        }
        let left = self.length - at;
        if left < HEADER {
            return Ok(Some(DamageKind::Cut));
        }
        let Some((kind, len)) = frame::header(self.bytes(at, HEADER)?) else { return Ok(None) };
        if kind == Kind::End {
            return Ok(Some(DamageKind::End));
        }
        Ok((len <= MOST_BYTES && len > left - HEADER).then_some(DamageKind::Cut))
    }
}
