//! Bytes of a file by their place.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

/// Read at once.
pub(super) const BLOCK: u64 = 1 << 20;

/// A file, of which a block at a time is at hand.
pub(super) struct Window<'a> {
    file: &'a File,
    length: u64,
    block: Vec<u8>,
    block_at: u64,
}

impl<'a> Window<'a> {
    pub(super) fn new(file: &'a File, length: u64) -> Self {
        Self { file, length, block: Vec::new(), block_at: 0 }
    }

    /// Of the file.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// The part of the block that is at hand.
    fn at_hand(&self, at: u64, length: u64) -> Option<&[u8]> {
        let from = usize::try_from(at.checked_sub(self.block_at)?).ok()?;
        self.block.get(from..from.checked_add(usize::try_from(length).ok()?)?)
    }

    /// As many bytes from `at` on; the block moves there if they are not at hand.
    ///
    /// # Errors
    /// They are not all there, or cannot be read.
    pub(super) fn bytes(&mut self, at: u64, length: u64) -> io::Result<&[u8]> {
        if self.at_hand(at, length).is_none() {
            let wanted = length.max(BLOCK).min(self.length.saturating_sub(at));
            self.block.resize(usize::try_from(wanted).unwrap_or_default(), 0);
            self.block_at = at;
            if let Err(error) = self.file.read_exact_at(&mut self.block, at) {
                self.block.clear();
                return Err(error);
            }
        }
        self.at_hand(at, length).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
    }

    /// A few bytes from `at` on, wherever that is: the block stays. `None` if they are not all there.
    pub(super) fn few<const N: usize>(&self, at: u64) -> io::Result<Option<[u8; N]>> {
        let length = N as u64;
        if at.checked_add(length).is_none_or(|end| end > self.length) {
            return Ok(None);
        }
        let mut few = [0; N];
        match self.at_hand(at, length) {
            Some(bytes) => few.copy_from_slice(bytes),
            None => self.file.read_exact_at(&mut few, at)?,
        }
        Ok(Some(few))
    }
}
