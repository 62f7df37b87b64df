//! Goes from message to message through a file of which anything may be wrong: says where and what, and goes on behind it.
//!
//! ```text
//! file    = stream, or several, one put behind the other
//! stream  = header, messages, end        (12 bytes; kind and length before each; a table, and where it is)
//! ```
//!
//! What is at a place is believed if it fits what is around it: a length if something begins where it ends, a message if
//! its checksum fits. Where nothing does, the bytes are searched for the next thing that is proven to be one
//! ([`super::resync`]). In a file without checksums whoever decodes a message has to judge it.

use std::fs::File;
use std::io;

use super::frame::{self, FOOTER, HEADER, Kind, STREAM_HEADER};
use super::seal::{self, Seal};
use super::window::{BLOCK, Window};
use crate::damage::{Damage, DamageKind};

/// Fewer zeros in a row than this may be anything.
const FEWEST_ZEROS: u64 = 32;

/// What has been met.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Met {
    /// A stream begins; perhaps without its header, if that is damaged.
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
        /// Whether it has a checksum, which fits.
        sealed: bool,
    },
}

/// What can be at a place, as far as its first bytes and its length tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sight {
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

/// Whether the messages of a stream have checksums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seals {
    /// None has been met.
    Unknown,
    /// As before there were any.
    Absent,
    /// They have, and this is the number that the next one should have.
    Next(u32),
}

/// A walk through a file.
pub(crate) struct Walk<'a> {
    pub(super) window: Window<'a>,
    at: u64,
    /// Whether we are behind the beginning of a stream and before its end.
    pub(super) in_stream: bool,
    /// Its header; empty if that is damaged.
    pub(super) stream_header: Vec<u8>,
    stream_at: u64,
    pub(super) seals: Seals,
    /// Whether every message met had a checksum.
    pub(crate) sealed: bool,
    pub(crate) damage: Vec<Damage>,
    /// Whether the rows in bytes without checksum can be decoded.
    decodes: fn(&[u8]) -> bool,
    /// How many bytes may still be looked at to find out whether they are a message.
    pub(super) patience: u64,
}

impl<'a> Walk<'a> {
    /// From the beginning of a file of that length. `decodes` says whether the rows can be decoded of a message
    /// without checksum, behind which nothing is as it should be.
    pub(crate) fn new(file: &'a File, length: u64, decodes: fn(&[u8]) -> bool) -> Self {
        Self {
            window: Window::new(file, length),
            at: 0,
            in_stream: false,
            stream_header: Vec::new(),
            stream_at: 0,
            seals: Seals::Unknown,
            sealed: true,
            damage: Vec::new(),
            decodes,
            patience: super::resync::patience(length),
        }
    }

    /// The header of the stream that we are in.
    #[cfg(feature = "rerun")]
    pub(crate) fn stream_header(&self) -> &[u8] {
        &self.stream_header
    }

    fn length(&self) -> u64 {
        self.window.length()
    }

    /// What is next in the file; `None` at its end.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(crate) fn next(&mut self) -> io::Result<Option<Met>> {
        while self.at < self.length() {
            match self.sight(self.at)? {
                Sight::Stream => return self.stream().map(Some),
                Sight::Message { kind, end } if self.in_stream => {
                    if let Some(met) = self.message(kind, end)? {
                        return Ok(Some(met));
                    }
                }
                Sight::End { end } if self.in_stream && self.end(end)? => {}
                _ if self.in_stream => {
                    let next = self.search(self.at + 1)?;
                    self.pass_over(next)?;
                }
                _ => {
                    let next = self.search(self.at)?;
                    self.pass_over(next)?;
                    if next < self.length() && self.sight(next)? != Sight::Stream {
                        return Ok(Some(self.begin(next, Vec::new())));
                    }
                }
            }
        }
        Ok(None)
    }

    /// Begins the stream whose header is here.
    fn stream(&mut self) -> io::Result<Met> {
        let at = self.at;
        let header = self.window.bytes(at, STREAM_HEADER)?.to_vec();
        self.at += STREAM_HEADER;
        Ok(self.begin(at, header))
    }

    fn begin(&mut self, at: u64, header: Vec<u8>) -> Met {
        self.in_stream = true;
        self.stream_header = header;
        self.stream_at = at;
        self.seals = Seals::Unknown;
        Met::Stream { at }
    }

    /// What can be at a place.
    pub(super) fn sight(&self, at: u64) -> io::Result<Sight> {
        if self.window.few::<{ STREAM_HEADER as usize }>(at)?.is_some_and(|header| frame::is_stream(&header)) {
            return Ok(Sight::Stream);
        }
        let Some(header) = self.window.few::<{ HEADER as usize }>(at)? else { return Ok(Sight::Nothing) };
        let Some((kind, len)) = frame::header(&header) else { return Ok(Sight::Nothing) };
        let end = at.saturating_add(HEADER).saturating_add(len);
        if end > self.length() {
            return Ok(Sight::Nothing);
        }
        Ok(match kind {
            Kind::End if end + FOOTER <= self.length() => Sight::End { end: end + FOOTER },
            Kind::End => Sight::Nothing,
            kind => Sight::Message { kind, end },
        })
    }

    /// Whether something can begin where what is before it ends.
    pub(super) fn can_go_on(&self, at: u64) -> io::Result<bool> {
        Ok(at == self.length() || self.sight(at)? != Sight::Nothing)
    }

    /// Whether the message that ends at a place has the mark of a checksum.
    pub(super) fn is_marked(&self, end: u64) -> io::Result<bool> {
        let mark = self.window.few::<{ seal::BYTES }>(end.saturating_sub(seal::BYTES as u64))?;
        Ok(mark.is_some_and(|mark| seal::is_marked(&mark)))
    }

    /// Whether the message behind `end` has the mark of a checksum.
    fn is_next_marked(&self, end: u64) -> io::Result<bool> {
        match self.sight(end)? {
            Sight::Message { end, .. } => self.is_marked(end),
            _ => Ok(false),
        }
    }

    /// Takes the message that seems to be here; `None` if it is not what was written.
    fn message(&mut self, kind: Kind, end: u64) -> io::Result<Option<Met>> {
        let at = self.at;
        let bytes = self.window.bytes(at, end - at)?.to_vec();
        let may_lack = match (seal::check(&bytes, &self.stream_header), self.seals) {
            (Seal::Fits(number), _) => {
                self.count(at, number);
                self.at = end;
                return Ok(Some(Met::Message { at, kind, bytes, sealed: true }));
            }
            // What looks like the mark of a checksum is one by chance.
            (_, Seals::Absent) => true,
            (Seal::None, Seals::Unknown) => !self.is_next_marked(end)?,
            _ => false,
        };
        if may_lack && (self.can_go_on(end)? || self.is_message(&bytes)) {
            (self.seals, self.sealed) = (Seals::Absent, false);
            self.at = end;
            return Ok(Some(Met::Message { at, kind, bytes, sealed: false }));
        }
        let next = if self.surely_goes_on(end)? { end } else { self.search(at + 1)? };
        if next < end || !self.can_go_on(end)? {
            self.pass_over(next)?;
            return Ok(None);
        }
        self.damage.push(Damage::at(at, next - at, DamageKind::Checksum));
        self.at = next;
        // Which number it had is not to be known from it.
        if let Seals::Next(number) = self.seals {
            self.seals = Seals::Next(number.wrapping_add(1));
        }
        Ok(None)
    }

    /// Whether bytes without checksum are a message, by what is in them.
    pub(super) fn is_message(&self, bytes: &[u8]) -> bool {
        frame::is_fields(bytes.get(HEADER as usize..).unwrap_or_default()) && (self.decodes)(bytes)
    }

    /// Takes the number of a message whose checksum fits, and says if it is not the one that should be here.
    fn count(&mut self, at: u64, number: u32) {
        let expected = if let Seals::Next(expected) = self.seals { expected } else { 0 };
        // Told where the missing ones should be, unless it has been told what is there in their place.
        let told = self.damage.last().is_some_and(|damage| damage.byte + damage.bytes == at);
        if number < expected {
            self.damage.push(Damage::at(at, 0, DamageKind::Repeated));
        } else if number > expected && !told {
            self.damage.push(Damage::at(at, 0, DamageKind::Missing));
        }
        self.seals = Seals::Next(number.wrapping_add(1));
    }

    /// Whether there is something at a place behind damage, beyond doubt.
    fn surely_goes_on(&mut self, at: u64) -> io::Result<bool> {
        Ok(at == self.length() || self.is_one(at)?)
    }

    /// Passes over an end, and says if it is not what was written. Whether it is one at all.
    fn end(&mut self, end: u64) -> io::Result<bool> {
        let at = self.at;
        if !self.end_fits(at, end)? {
            if end < self.length() && self.sight(end)? != Sight::Stream {
                return Ok(false);
            }
            self.damage.push(Damage::at(at, end - at, DamageKind::End));
        }
        self.in_stream = false;
        self.stream_header.clear();
        self.seals = Seals::Unknown;
        self.at = end;
        Ok(true)
    }

    /// Whether what points at the table points at it, and its checksum fits.
    pub(super) fn end_fits(&mut self, at: u64, end: u64) -> io::Result<bool> {
        let (table, stream_at) = (at + HEADER, self.stream_at);
        let bytes = self.window.bytes(table, end - table)?;
        let (content, footer) = bytes.split_at(bytes.len() - FOOTER as usize);
        Ok(frame::footer_fits(footer, content, [table, table - stream_at]))
    }

    /// Says what the bytes up to `next` are that nothing is made of, if there are any.
    fn pass_over(&mut self, next: u64) -> io::Result<()> {
        let at = self.at;
        let zeros = self.zeros_before(at, next)?;
        let kind = match self.cut_kind(at)? {
            Some(kind) if next == self.length() => kind,
            _ if zeros < next && next == self.length() && self.in_stream => DamageKind::Cut,
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
            if let Some(last) = self.window.bytes(place, length)?.iter().rposition(|byte| *byte != 0) {
                zeros = place + last as u64 + 1;
            }
            place += length;
        }
        Ok(if zeros == from || to - zeros >= FEWEST_ZEROS { zeros } else { to })
    }

    /// What it is that begins here and would end beyond the end of the file, if anything does.
    fn cut_kind(&self, at: u64) -> io::Result<Option<DamageKind>> {
        if !self.in_stream {
            return Ok(None);
        }
        let Some(header) = self.window.few::<{ HEADER as usize }>(at)? else { return Ok(Some(DamageKind::Cut)) };
        let Some((kind, len)) = frame::header(&header) else { return Ok(None) };
        if kind == Kind::End {
            return Ok(Some(DamageKind::End));
        }
        Ok((len > self.length() - at - HEADER).then_some(DamageKind::Cut))
    }
}
