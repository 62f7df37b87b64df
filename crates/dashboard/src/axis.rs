//! The scale of one axis of a plot: it follows what is shown until a person fixes it.
//!
//! An axis counts in the units that stand on the screen, so that what is typed is what is then read there.

/// The narrowest and the widest range that an axis can be fixed at.
const WIDTHS: [f64; 2] = [1e-12, 1e15];

/// What is asked of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scaling {
    /// Follow what is shown.
    Auto,
    /// Stand still, with so many times as much in view.
    Times(f64),
    /// Stand still at this range.
    Fix([f64; 2]),
}

/// One axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PlotAxis {
    fixed: Option<[f64; 2]>,
    /// What it last showed: where a zoom begins.
    shown: Option<[f64; 2]>,
}

impl PlotAxis {
    /// The range to show, where `auto` would show everything.
    pub(crate) fn over(&mut self, auto: [f64; 2]) -> [f64; 2] {
        let shown = self.fixed.unwrap_or(auto);
        self.shown = Some(shown);
        shown
    }

    /// The same for an axis that is alike on both sides of zero: how far it reaches.
    pub(crate) fn reach(&mut self, auto: f64) -> f64 {
        let [low, high] = self.over([-auto, auto]);
        low.abs().max(high.abs())
    }

    /// Whether it stands still.
    pub(crate) fn is_fixed(&self) -> bool {
        self.fixed.is_some()
    }

    /// What it last showed, once it has shown something.
    pub(crate) fn shown(&self) -> Option<[f64; 2]> {
        self.shown
    }

    /// Does what is asked; what is pointed at stays where it is on the screen, if anything is.
    ///
    /// # Errors
    /// In words: no range that can be drawn.
    pub(crate) fn take(&mut self, scaling: Scaling, about: Option<f64>) -> Result<(), String> {
        match scaling {
            Scaling::Auto => self.fixed = None,
            Scaling::Times(times) => self.zoom(times, about),
            Scaling::Fix(range) => self.fix(range)?,
        }
        Ok(())
    }

    /// Lets it stand still at a range.
    ///
    /// # Errors
    /// In words: no range that can be drawn.
    pub(crate) fn fix(&mut self, range: [f64; 2]) -> Result<(), String> {
        let [low, high] = range;
        // Not a number is no width either.
        if !(WIDTHS[0]..=WIDTHS[1]).contains(&(high - low)) {
            return Err(format!("{low}..{high}: expected LOW..HIGH, the low end first"));
        }
        (self.fixed, self.shown) = (Some(range), Some(range));
        Ok(())
    }

    /// Shows `times` as much, and stands still there. What stays where it is on the screen is `about` if that is in view,
    /// else zero, else the middle.
    pub(crate) fn zoom(&mut self, times: f64, about: Option<f64>) {
        let Some([low, high]) = self.shown else { return };
        let in_view = |at: &f64| (low..=high).contains(at);
        let still = about.filter(in_view).or(Some(0.0).filter(in_view)).unwrap_or(0.5 * (low + high));
        // As far as it can go and no further.
        let _ = self.fix([still + (low - still) * times, still + (high - still) * times]);
    }

    /// The word that tells that it stands still; nothing while it does not.
    pub(crate) fn word(&self) -> &'static str {
        if self.is_fixed() { " fixed" } else { "" }
    }

    /// The same in one sign, for a label.
    pub(crate) fn sign(&self) -> &'static str {
        if self.is_fixed() { "=" } else { "" }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn an_axis_follows_until_it_is_fixed_and_again_when_it_is_released() {
        let mut axis = PlotAxis::default();
        axis.zoom(0.5, None);
        assert!(!axis.is_fixed(), "nothing was shown yet that could be halved");
        assert_eq!((axis.over([-4.0, 4.0]), axis.word()), ([-4.0, 4.0], ""));
        axis.zoom(0.5, None);
        assert_eq!((axis.over([-9.0, 9.0]), axis.word(), axis.reach(9.0)), ([-2.0, 2.0], " fixed", 2.0));
        axis.take(Scaling::Auto, None).unwrap();
        assert_eq!((axis.over([0.0, 8.0]), axis.sign()), ([0.0, 8.0], ""));
        axis.zoom(0.5, None);
        assert_eq!(axis.over([0.0, 8.0]), [0.0, 4.0], "zero stays");
        axis.fix([2.0, 6.0]).unwrap();
        axis.zoom(0.5, Some(3.0));
        assert_eq!(axis.shown(), Some([2.5, 4.5]), "what is pointed at stays");
        axis.zoom(2.0, Some(77.0));
        assert_eq!(axis.shown(), Some([1.5, 5.5]), "the middle stays");
        for range in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
            assert!(axis.fix(range).is_err(), "{range:?}");
        }
        assert_eq!(axis.shown(), Some([1.5, 5.5]));
    }

    proptest! {
        /// However it is zoomed, a range that can be drawn stays, and back is where it was.
        #[test]
        fn zooming_leaves_a_range_and_goes_back(
            low in -1e3..1e3_f64, width in 1e-3..1e3_f64, times in prop::collection::vec(1e-3..1e3_f64, 0..20),
        ) {
            let mut axis = PlotAxis::default();
            axis.over([low, low + width]);
            for times in &times {
                axis.zoom(*times, None);
                let [low, high] = axis.over([0.0, 1.0]);
                prop_assert!(low < high && low.is_finite() && high.is_finite());
            }
            let mut once = PlotAxis::default();
            once.over([low, low + width]);
            once.zoom(0.5, None);
            once.zoom(2.0, None);
            let [a, b] = once.over([0.0, 1.0]);
            prop_assert!((a - low).abs() < 1e-9 && (b - low - width).abs() < 1e-9);
        }
    }
}
