//! Where a machine has been, step after step, in bounded memory: the newest stay.

use std::collections::VecDeque;
use std::ops::Range;

/// Steps a block.
const BLOCK: usize = 4096;
/// Numbers that all of them may take: a million steps of three masses, 64 MB.
const MOST: usize = 8_000_000;

/// Rows of numbers, a row a step.
pub(super) struct Rows {
    width: usize,
    most: usize,
    /// The number of the first step that is kept.
    first: u64,
    blocks: VecDeque<Vec<f64>>,
}

impl Rows {
    /// None yet; the first to come is of step `first`, and has so many numbers.
    pub(super) fn new(width: usize, first: u64) -> Self {
        Self { width, most: (MOST / (BLOCK * width)).max(2), first, blocks: VecDeque::new() }
    }

    /// How many rows are kept in any case.
    pub(super) fn room(&self) -> u64 {
        ((self.most - 1) * BLOCK) as u64
    }

    /// The steps that are kept.
    pub(super) fn range(&self) -> Range<u64> {
        let full = self.blocks.len().saturating_sub(1) * BLOCK;
        let open = self.blocks.back().map_or(0, |block| block.len() / self.width);
        self.first..self.first + (full + open) as u64
    }

    /// Adds the row of the next step.
    pub(super) fn push(&mut self, row: impl Iterator<Item = f64>) {
        if self.blocks.back().is_none_or(|block| block.len() == BLOCK * self.width) {
            let mut block = if self.blocks.len() == self.most {
                self.first += BLOCK as u64;
                self.blocks.pop_front().unwrap_or_default()
            } else {
                Vec::with_capacity(BLOCK * self.width)
            };
            block.clear();
            self.blocks.push_back(block);
        }
        if let Some(block) = self.blocks.back_mut() {
            block.extend(row);
        }
    }

    /// The row of a step, if it is kept.
    pub(super) fn get(&self, seq: u64) -> Option<&[f64]> {
        let at = usize::try_from(seq.checked_sub(self.first)?).ok()?;
        let place = at % BLOCK * self.width;
        self.blocks.get(at / BLOCK)?.get(place..place + self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_rows_stay_and_are_found_by_their_steps() {
        let mut rows = Rows::new(1000, 7);
        let room = rows.room();
        assert_eq!((rows.range(), rows.get(7), room), (7..7, None, BLOCK as u64));
        for seq in 7..7 + 5 * room {
            rows.push((0..1000).map(|at| (seq + at) as f64));
            let kept = rows.range();
            assert_eq!(kept.end, seq + 1);
            assert!(kept.contains(&seq.saturating_sub(room - 1).max(7)), "{kept:?}");
        }
        let kept = rows.range();
        assert!(kept.start > 7 && rows.get(kept.start - 1).is_none() && rows.get(kept.end).is_none());
        assert!(
            kept.clone().all(|seq| rows.get(seq).is_some_and(|row| row.len() == 1000 && row[3] == (seq + 3) as f64))
        );
    }
}
