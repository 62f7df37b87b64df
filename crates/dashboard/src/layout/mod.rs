//! Layouts: which panel where. A layout is a file that reads like the screen:
//!
//! ```toml
//! about = "what it is for"
//! [[screen]]                    # the first screen that fits the terminal is shown
//! columns = "3 1 =28"           # shares of the width; =28 is exactly 28 cells. Absent: all alike
//! rows = "2 =4"
//! strips = "y z u"              # what the strips show, a word each; absent: that
//! picture = """
//! poles   orbits  settings
//! damping strips  settings
//! """
//! ```
//!
//! A block of equal words is one panel; `.` stays empty. The last screen must fit on 60 x 16.

mod read;

use ratatui::layout::{Constraint, Layout as Split, Rect};
use text::Faults;

use crate::panels::registry::PANELS;
use crate::series::Strip;

/// The smallest screen that the panels fit on.
pub(crate) const SMALLEST: (u16, u16) = (60, 16);

/// Names and files of the built-in layouts, in the order of their digits.
pub const BUILT_IN: [(&str, &str); 8] = [
    ("overview", include_str!("../../../../layouts/overview.toml")),
    ("operator", include_str!("../../../../layouts/operator.toml")),
    ("tuning", include_str!("../../../../layouts/tuning.toml")),
    ("whirl", include_str!("../../../../layouts/whirl.toml")),
    ("replay", include_str!("../../../../layouts/replay.toml")),
    ("diagnosis", include_str!("../../../../layouts/diagnosis.toml")),
    ("loop", include_str!("../../../../layouts/loop.toml")),
    ("runup", include_str!("../../../../layouts/runup.toml")),
];

/// Which panel where, for terminals of different sizes.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    name: String,
    about: String,
    screens: Vec<Screen>,
}

/// One arrangement.
#[derive(Clone, Debug, PartialEq)]
struct Screen {
    columns: Vec<Size>,
    rows: Vec<Size>,
    places: Vec<Place>,
    /// What its strips show, if it says so.
    strips: Option<Vec<Strip>>,
}

/// How wide a column or how high a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Size {
    /// So many parts of what is left.
    Share(u16),
    /// So many cells.
    Cells(u16),
}

/// A panel, by its row in the table of panels, over the cells of the picture `left..right` by `top..bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    kind: usize,
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

/// The built-in layouts.
///
/// # Panics
/// Never: a test reads them all.
#[must_use]
pub fn built_in() -> Vec<Layout> {
    let read = |(name, text)| Layout::read(name, text).expect("the built-in layouts are whole");
    BUILT_IN.into_iter().map(read).collect()
}

impl Layout {
    /// The layout called `name` whose file holds `text`.
    ///
    /// # Errors
    /// All that is wrong with it, by line and column.
    pub fn read(name: &str, text: &str) -> Result<Self, Faults> {
        read::read(name, text)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it is for.
    #[must_use]
    pub fn about(&self) -> &str {
        &self.about
    }

    /// The panels on a terminal of this size.
    #[must_use]
    pub fn panels(&self, width: u16, height: u16) -> Vec<&'static str> {
        let area = Rect::new(0, 0, width, height.saturating_sub(2));
        self.places(area).into_iter().map(|(kind, _)| PANELS[kind].name).collect()
    }

    /// The smallest terminal, two lines at the edges included, on which each of its screens is shown, the first screen first.
    #[must_use]
    pub fn sizes(&self) -> Vec<(u16, u16)> {
        self.screens.iter().map(Screen::least).map(|(width, height)| (width, height + 2)).collect()
    }

    /// Every panel, by its row in the table of panels, and its area: those of the first screen that fits, or of the last.
    pub(crate) fn places(&self, area: Rect) -> Vec<(usize, Rect)> {
        self.screen(area).map_or_else(Vec::new, |(_, placed)| placed)
    }

    /// The same, and what the strips of that screen show, if it says so.
    pub(crate) fn places_and_strips(&self, area: Rect) -> (Vec<(usize, Rect)>, Option<&[Strip]>) {
        let (screen, placed) = self.screen(area).unzip();
        (placed.unwrap_or_default(), screen.and_then(|screen| screen.strips.as_deref()))
    }

    /// The first screen that fits, or the last, with its panels.
    fn screen(&self, area: Rect) -> Option<(&Screen, Vec<(usize, Rect)>)> {
        let mut found = None;
        for screen in &self.screens {
            let placed = screen.place(area);
            let is_enough = screen.has_cells(area) && fits(&placed);
            found = Some((screen, placed));
            if is_enough {
                break;
            }
        }
        found
    }
}

/// Whether every panel has the room that it needs.
fn fits(placed: &[(usize, Rect)]) -> bool {
    placed.iter().all(|(kind, area)| {
        let (width, height) = PANELS[*kind].least;
        area.width >= width && area.height >= height
    })
}

/// Whether so many cells are enough for all of these sizes.
fn enough(sizes: &[Size], cells: u16) -> bool {
    let least = |size: &Size| match *size {
        Size::Share(_) => 1,
        Size::Cells(cells) => u32::from(cells),
    };
    sizes.iter().map(least).sum::<u32>() <= u32::from(cells)
}

impl Screen {
    /// Whether there are the cells that it asks for, and one for every share: what is shared out of too few comes out one way or another.
    fn has_cells(&self, area: Rect) -> bool {
        enough(&self.columns, area.width) && enough(&self.rows, area.height)
    }

    fn place(&self, area: Rect) -> Vec<(usize, Rect)> {
        let along = |sizes: &[Size]| -> Vec<Constraint> {
            let constraint = |size: &Size| match *size {
                Size::Share(share) => Constraint::Fill(share),
                Size::Cells(cells) => Constraint::Length(cells),
            };
            sizes.iter().map(constraint).collect()
        };
        let columns = Split::horizontal(along(&self.columns)).split(area);
        let rows = Split::vertical(along(&self.rows)).split(area);
        let whole = |place: &Place| {
            let (left, right) = (columns[place.left].left(), columns[place.right - 1].right());
            let (top, bottom) = (rows[place.top].top(), rows[place.bottom - 1].bottom());
            (place.kind, Rect::new(left, top, right.saturating_sub(left), bottom.saturating_sub(top)))
        };
        self.places.iter().map(whole).collect()
    }

    /// The smallest area in which every panel has the room that it needs; what no area can hold needs the largest there is.
    fn least(&self) -> (u16, u16) {
        const MOST: u16 = 1000;
        // More room never makes a panel smaller, so width and height can be looked for one after the other.
        let search = |fit: &dyn Fn(u16) -> bool| {
            let (mut too_small, mut enough) = (0, MOST);
            while enough - too_small > 1 {
                let middle = too_small + (enough - too_small) / 2;
                if fit(middle) {
                    enough = middle;
                } else {
                    too_small = middle;
                }
            }
            enough
        };
        let wide = |width| {
            let placed = self.place(Rect::new(0, 0, width, MOST));
            enough(&self.columns, width) && placed.iter().all(|(kind, area)| area.width >= PANELS[*kind].least.0)
        };
        let high = |height| {
            let placed = self.place(Rect::new(0, 0, MOST, height));
            enough(&self.rows, height) && placed.iter().all(|(kind, area)| area.height >= PANELS[*kind].least.1)
        };
        (search(&wide), search(&high))
    }
}

#[cfg(test)]
mod tests;
