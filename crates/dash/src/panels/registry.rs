//! The one table of panels: layouts know panels by the names in it.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use super::modes::Modes;
use super::{
    alarms, damping, damping_over_speed, events, force, force_budget, orbits, poles, raw, settings, spectrum, strips,
    waterfall,
};
use crate::actions::Action;
use crate::screen::View;

/// A part of the screen. It owns its state and draws its own frame.
pub(crate) trait Panel {
    /// Draws it; any area must do.
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer);

    /// Moves its list, if it is one, by so many rows.
    fn scroll(&mut self, _rows: isize) {}

    /// What the mouse at a position of its area asks for.
    fn mouse(&mut self, _view: &View<'_>, _area: Rect, mouse: Mouse, _at: Position) -> Option<Intent> {
        if let Mouse::Wheel(notches) = mouse {
            self.scroll(3 * notches as isize);
        }
        None
    }
}

/// What the mouse does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mouse {
    /// The left button goes down.
    Click,
    /// The mouse moves so many cells to the right with the left button down.
    Drag(i32),
    /// The wheel turns so many notches towards us.
    Wheel(i32),
}

/// What a panel asks of the dashboard.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Intent {
    /// Select this row of the settings.
    Row(usize),
    /// Look at the step of this place in the history.
    Look(u64),
    /// The same as a key.
    Do(Action),
}

/// A panel without a state of its own is just its drawing.
impl<F: FnMut(&View<'_>, Rect, &mut Buffer)> Panel for F {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        self(view, area, buffer);
    }
}

/// One row of the table.
pub(crate) struct Kind {
    /// As layouts name it.
    pub(crate) name: &'static str,
    /// What it shows, in a few words.
    pub(crate) meaning: &'static str,
    /// The smallest width and height, with its frame, at which it is of use.
    pub(crate) least: (u16, u16),
    /// Makes one.
    pub(crate) make: fn() -> Box<dyn Panel>,
}

/// Every panel.
pub(crate) const KINDS: &[Kind] = &[
    Kind { name: "poles", meaning: "poles in the complex plane", least: (20, 7), make: || Box::new(poles::draw) },
    Kind {
        name: "damping",
        meaning: "the minimum damping, large, and what it has been",
        least: (18, 5),
        make: || Box::new(damping::draw),
    },
    Kind { name: "orbits", meaning: "an orbit of every mass", least: (18, 7), make: || Box::new(orbits::draw) },
    Kind { name: "strips", meaning: "y, z and control over time", least: (18, 4), make: || Box::new(strips::Strips) },
    Kind {
        name: "settings",
        meaning: "speed, gains, deadbands and limits, to be changed",
        least: (20, 5),
        make: || Box::new(settings::SettingsPanel),
    },
    Kind {
        name: "force",
        meaning: "the control force, now and at most",
        least: (18, 4),
        make: || Box::new(force::draw),
    },
    Kind {
        name: "force-budget",
        meaning: "the control force by component, by signal and by gain",
        least: (24, 5),
        make: || Box::new(force_budget::draw),
    },
    Kind {
        name: "damping-over-speed",
        meaning: "how far the gains in force carry: minimum damping over speed",
        least: (28, 6),
        make: || Box::new(damping_over_speed::draw),
    },
    Kind {
        name: "modes",
        meaning: "every mode: damping, frequency, sense of whirl and shape, the least damped first",
        least: (40, 4),
        make: || Box::<Modes>::default(),
    },
    Kind {
        name: "spectrum",
        meaning: "full spectrum of the mass with the control bearing, forward and backward",
        least: (28, 6),
        make: || Box::new(spectrum::draw),
    },
    Kind {
        name: "waterfall",
        meaning: "its spectra over time",
        least: (24, 6),
        make: || Box::new(waterfall::draw_over_time),
    },
    Kind {
        name: "waterfall-over-speed",
        meaning: "its spectra over the speeds that were run through",
        least: (24, 6),
        make: || Box::new(waterfall::draw_over_speed),
    },
    Kind {
        name: "alarms",
        meaning: "what is watched, its limits, and what has been past them",
        least: (30, 4),
        make: || Box::<alarms::AlarmList>::default(),
    },
    Kind {
        name: "events",
        meaning: "what happened: who changed what and why, trips, notes",
        least: (30, 3),
        make: || Box::<events::Events>::default(),
    },
    Kind { name: "raw", meaning: "every number of one step", least: (40, 5), make: || Box::<raw::Raw>::default() },
];

/// Name, meaning, and smallest width and height of every panel.
pub fn panels() -> impl ExactSizeIterator<Item = (&'static str, &'static str, (u16, u16))> {
    KINDS.iter().map(|kind| (kind.name, kind.meaning, kind.least))
}

/// The panels of one dashboard, made when they are first shown and kept, with what they remember, while others are.
pub(crate) struct Panels(Vec<Option<Box<dyn Panel>>>);

impl Panels {
    /// None has been shown yet.
    pub(crate) fn new() -> Self {
        Self(KINDS.iter().map(|_| None).collect())
    }

    /// What the mouse over the panel in row `kind` of the table asks for.
    pub(crate) fn mouse(
        &mut self,
        kind: usize,
        view: &View<'_>,
        area: Rect,
        mouse: Mouse,
        at: Position,
    ) -> Option<Intent> {
        self.0[kind].get_or_insert_with(KINDS[kind].make).mouse(view, area, mouse, at)
    }

    /// Moves the list of the panel in row `kind` of the table, if it is one.
    pub(crate) fn scroll(&mut self, kind: usize, rows: isize) {
        self.0[kind].get_or_insert_with(KINDS[kind].make).scroll(rows);
    }

    /// Draws the panel in row `kind` of the table.
    pub(crate) fn draw(&mut self, kind: usize, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        self.0[kind].get_or_insert_with(KINDS[kind].make).draw(view, area, buffer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::tests;
    use crate::panels::tests::drawn;
    use crate::screen::tests::view;

    #[test]
    fn regress_a_bulletin_of_another_machine_than_the_steps_breaks_no_panel() {
        let now = std::time::Instant::now();
        for (steps_of, bulletin_of, feedback) in [(1, "three-mass", "individual"), (3, "jeffcott", "cancel")] {
            let mut feed = crate::feed::Feed::new("");
            (0..300).for_each(|seq| feed.hear(&tests::state(steps_of, seq), now));
            feed.read(tests::bulletin(bulletin_of, feedback));
            let picture = feed.picture(&crate::view_time::ViewTime::LIVE, now);
            let mut panels = Panels::new();
            for kind in 0..KINDS.len() {
                let area = Rect::new(0, 0, 80, 30);
                panels.draw(kind, &view(&picture), area, &mut Buffer::empty(area));
            }
        }
    }

    #[test]
    fn every_panel_draws_at_its_smallest_size_and_at_every_other() {
        let picture = tests::picture();
        for (at, kind) in KINDS.iter().enumerate() {
            let (width, height) = kind.least;
            let panels = std::cell::RefCell::new(Panels::new());
            let frame =
                drawn(width, height, |area, buffer| panels.borrow_mut().draw(at, &view(&picture), area, buffer));
            assert!(frame.starts_with('┌'), "{}:\n{frame}", kind.name);
            assert!(KINDS[..at].iter().all(|other| other.name != kind.name), "{} twice", kind.name);
            assert!(kind.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", kind.name);
        }
    }
}
