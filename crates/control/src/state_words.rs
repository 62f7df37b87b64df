//! What a loop or a machine holds, as plain words: saved bit by bit, so that what is restored goes on to the last bit.

use crate::C64;

/// A row of 64-bit words, written at its end and read from its front.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StateWords {
    words: Vec<u64>,
    read: usize,
}

impl StateWords {
    /// Words that were written before.
    #[must_use]
    pub fn from_saved(words: Vec<u64>) -> Self {
        Self { words, read: 0 }
    }

    /// None yet, and room for so many without allocating.
    #[must_use]
    pub fn with_room(room: usize) -> Self {
        Self { words: Vec::with_capacity(room), read: 0 }
    }

    /// How many there is room for without allocating.
    #[must_use]
    pub fn room(&self) -> usize {
        self.words.capacity()
    }

    /// All of them.
    #[must_use]
    pub fn as_slice(&self) -> &[u64] {
        &self.words
    }

    /// Forgets what was written, but keeps its room.
    pub fn clear(&mut self) {
        self.words.clear();
        self.read = 0;
    }

    /// Adds a word.
    pub fn put(&mut self, word: u64) {
        self.words.push(word);
    }

    /// Adds a number.
    pub fn put_f64(&mut self, number: f64) {
        self.put(number.to_bits());
    }

    /// Adds a complex number.
    pub fn put_c64(&mut self, number: C64) {
        self.put_f64(number.re);
        self.put_f64(number.im);
    }

    /// The next word; `None` at the end.
    pub fn take(&mut self) -> Option<u64> {
        let word = self.words.get(self.read).copied()?;
        self.read += 1;
        Some(word)
    }

    /// The next number.
    pub fn take_f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_bits)
    }

    /// The next complex number.
    pub fn take_c64(&mut self) -> Option<C64> {
        Some(C64::new(self.take_f64()?, self.take_f64()?))
    }

    /// Whether everything was read.
    #[must_use]
    pub fn is_at_end(&self) -> bool {
        self.read == self.words.len()
    }
}
