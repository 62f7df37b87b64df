//! What the law asked for in the past, for as long as the delay lasts.
//!
//! Between two ends of steps the command is the cubic through its values and slopes there, which errs by the fourth power
//! of the step, like the integrator. A stretch has values of its own at both ends, so that a jump at a step stays a jump.

use crate::C64;
use crate::state_words::StateWords;

/// The command over one stretch of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) value: [C64; 2],
    pub(crate) slope: [C64; 2],
}

impl Stretch {
    /// The cubic of Hermite; beyond its ends too.
    pub(crate) fn at(&self, tau: f64) -> C64 {
        let width = self.to - self.from;
        if width <= 0.0 {
            return self.value[1];
        }
        let x = (tau - self.from) / width;
        let (x2, x3) = (x * x, x * x * x);
        self.value[0] * (2.0 * x3 - 3.0 * x2 + 1.0)
            + self.slope[0] * (width * (x3 - 2.0 * x2 + x))
            + self.value[1] * (3.0 * x2 - 2.0 * x3)
            + self.slope[1] * (width * (x3 - x2))
    }
}

/// The latest stretches, as many as the delay needs.
#[derive(Clone, Debug)]
pub(crate) struct DelayLine {
    ring: Vec<Stretch>,
    /// The place of the oldest.
    first: usize,
    count: usize,
    /// What was asked for before the oldest.
    before: C64,
}

impl DelayLine {
    /// Room for so many stretches.
    pub(crate) fn new(room: usize) -> Self {
        Self { ring: vec![Stretch::default(); room.max(1)], first: 0, count: 0, before: C64::ZERO }
    }

    /// Forgets everything: `value` was asked for ever.
    pub(crate) fn fill(&mut self, value: C64) {
        (self.first, self.count, self.before) = (0, 0, value);
    }

    fn get(&self, place: usize) -> &Stretch {
        &self.ring[(self.first + place) % self.ring.len()]
    }

    /// The latest stretch.
    pub(crate) fn last(&self) -> Option<&Stretch> {
        self.count.checked_sub(1).map(|last| self.get(last))
    }

    /// Adds the stretch that follows; the oldest makes room.
    pub(crate) fn push(&mut self, stretch: Stretch) {
        let room = self.ring.len();
        if self.count == room {
            self.before = self.ring[self.first].value[1];
            self.first = (self.first + 1) % room;
            self.count -= 1;
        }
        self.ring[(self.first + self.count) % room] = stretch;
        self.count += 1;
    }

    /// What was asked for at `tau`.
    pub(crate) fn at(&self, tau: f64) -> C64 {
        // The first stretch that ends at or after it.
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = (low + high) / 2;
            if self.get(middle).to < tau { low = middle + 1 } else { high = middle }
        }
        if low == self.count {
            return self.last().map_or(self.before, |last| last.value[1]);
        }
        let stretch = self.get(low);
        if tau < stretch.from {
            return if low == 0 { self.before } else { self.get(low - 1).value[1] };
        }
        stretch.at(tau)
    }

    /// Takes over what another line holds, as far as there is room.
    pub(crate) fn adopt(&mut self, other: &Self) {
        self.fill(other.before);
        (0..other.count).for_each(|place| self.push(*other.get(place)));
    }

    pub(crate) fn save(&self, words: &mut StateWords) {
        words.put(self.count as u64);
        words.put_c64(self.before);
        for place in 0..self.count {
            let Stretch { from, to, value, slope } = *self.get(place);
            [from, to].into_iter().for_each(|t| words.put_f64(t));
            value.into_iter().chain(slope).for_each(|z| words.put_c64(z));
        }
    }

    /// Words that it saves at most.
    pub(crate) fn words_at_most(&self) -> usize {
        3 + 10 * self.ring.len()
    }

    /// `None` if the words do not fit.
    pub(crate) fn restore(&mut self, words: &mut StateWords) -> Option<()> {
        let count = usize::try_from(words.take()?).ok().filter(|count| *count <= self.ring.len())?;
        let before = words.take_c64()?;
        self.fill(before);
        for _ in 0..count {
            let (from, to) = (words.take_f64()?, words.take_f64()?);
            let mut next = || words.take_c64();
            let stretch = Stretch { from, to, value: [next()?, next()?], slope: [next()?, next()?] };
            self.push(stretch);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic(t: f64) -> (C64, C64) {
        (C64::new(t * t * t - t, 2.0 * t * t), C64::new(3.0 * t * t - 1.0, 4.0 * t))
    }

    #[test]
    fn cubics_are_kept_exactly_and_the_oldest_is_forgotten() {
        let mut line = DelayLine::new(4);
        line.fill(C64::new(-1.0, 0.0));
        assert_eq!(line.at(5.0), C64::new(-1.0, 0.0));
        for k in 0..10 {
            let (from, to) = (0.1 * f64::from(k), 0.1 * f64::from(k + 1));
            let ((a, da), (b, db)) = (cubic(from), cubic(to));
            line.push(Stretch { from, to, value: [a, b], slope: [da, db] });
        }
        for tau in [0.61, 0.7, 0.83, 0.999] {
            assert!((line.at(tau) - cubic(tau).0).norm() < 1e-14, "at {tau}");
        }
        // Before what is kept, the value that the forgotten ended with.
        assert!((line.at(0.2) - cubic(0.6).0).norm() < 1e-14);
        let mut words = StateWords::default();
        line.save(&mut words);
        let mut again = DelayLine::new(4);
        again.restore(&mut words).expect("fits");
        assert_eq!((again.at(0.83), words.is_at_end()), (line.at(0.83), true));
    }

    #[test]
    fn a_jump_stays_a_jump() {
        let mut line = DelayLine::new(4);
        let step = |from: f64, value: f64| Stretch {
            from,
            to: from + 1.0,
            value: [C64::from(value); 2],
            slope: [C64::ZERO; 2],
        };
        line.push(step(0.0, 1.0));
        line.push(step(1.0, 5.0));
        assert_eq!((line.at(1.0).re, line.at(1.0 + 1e-12).re), (1.0, 5.0));
    }
}
