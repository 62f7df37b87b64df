//! What a person points at beside a moment of time. All panels show the same.

use rotor::C64;

/// What is pointed at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Selection {
    /// The plot whose scale keys change, by its row in the table of panels.
    pub(crate) plot: Option<usize>,
    /// The pole of a mode.
    pub(crate) mode: Option<C64>,
    /// A frequency of whirl, in units of `w0`; backward is negative.
    pub(crate) frequency: Option<f64>,
    /// A spin speed, in units of `w0`.
    pub(crate) speed: Option<f64>,
}

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SelectedItem {
    Mode(C64),
    Frequency(f64),
    Speed(f64),
}

impl Selection {
    /// Points at something; at the same again, at nothing of that kind.
    pub(crate) fn toggle(&mut self, item: SelectedItem) {
        let is_there = match item {
            SelectedItem::Mode(pole) => self.mode == Some(pole),
            SelectedItem::Frequency(frequency) => self.frequency == Some(frequency),
            SelectedItem::Speed(speed) => self.speed == Some(speed),
        };
        self.set(item, !is_there);
    }

    /// Points at something, or at nothing of that kind.
    pub(crate) fn set(&mut self, item: SelectedItem, at_it: bool) {
        match item {
            SelectedItem::Mode(pole) => self.mode = at_it.then_some(pole),
            SelectedItem::Frequency(frequency) => self.frequency = at_it.then_some(frequency),
            SelectedItem::Speed(speed) => self.speed = at_it.then_some(speed),
        }
    }

    /// Follows a mode to where its pole is now: to the nearest of `poles`.
    pub(crate) fn follow(&mut self, poles: &[C64]) {
        let Some(before) = self.mode else { return };
        let far = |pole: &&C64| (*pole - before).norm();
        if let Some(nearest) = poles.iter().min_by(|a, b| far(a).total_cmp(&far(b))) {
            self.mode = Some(*nearest);
        }
    }

    /// Points at nothing. Returns whether that is news.
    pub(crate) fn clear(&mut self) -> bool {
        std::mem::take(self) != Self::default()
    }
}

/// Where the read-out of a plot shall stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ReadoutMove {
    /// So many columns, or modes, further on.
    Move(i32),
    /// At a value as it stands on the axis.
    At(f64),
    /// Nowhere.
    Off,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_followed_and_the_same_again_is_nothing() {
        let mut selection = Selection::default();
        selection.toggle(SelectedItem::Mode(C64::new(-0.1, 2.0)));
        selection.follow(&[C64::new(-0.2, -2.0), C64::new(-0.15, 2.1)]);
        assert_eq!(selection.mode, Some(C64::new(-0.15, 2.1)));
        selection.follow(&[]);
        selection.toggle(SelectedItem::Mode(C64::new(-0.15, 2.1)));
        assert_eq!(selection.mode, None);
        selection.toggle(SelectedItem::Speed(2.0));
        selection.toggle(SelectedItem::Frequency(-1.0));
        assert_eq!((selection.speed, selection.frequency), (Some(2.0), Some(-1.0)));
        assert!(selection.clear() && !selection.clear());
    }
}
