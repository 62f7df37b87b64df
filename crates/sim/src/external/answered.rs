//! Which readings a controller outside has answered.

/// Readings of which it is known whether they were answered: more than a loop can be late by.
const REMEMBERED: usize = 1 << 17;

/// Which of the latest readings were answered.
pub(super) struct Answered(Box<[u64]>);

impl Default for Answered {
    fn default() -> Self {
        Self(vec![0; REMEMBERED / 64].into())
    }
}

impl Answered {
    fn place(number: u64) -> (usize, u64) {
        let at = number as usize % REMEMBERED;
        (at / 64, 1 << (at % 64))
    }

    pub(super) fn has(&self, number: u64) -> bool {
        let (word, bit) = Self::place(number);
        self.0[word] & bit != 0
    }

    pub(super) fn set(&mut self, number: u64, answered: bool) {
        let (word, bit) = Self::place(number);
        if answered {
            self.0[word] |= bit;
        } else {
            self.0[word] &= !bit;
        }
    }
}
