//! The one table of panels: layouts know panels by the names in it. Long, and in one place: a row a panel, and the
//! tests that draw every row of it.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use super::alarms::AlarmList;
use super::campbell::Campbell;
use super::damping::Damping;
use super::damping_over_speed::DampingOverSpeed;
use super::events::Events;
use super::force::Force;
use super::force_budget::ForceBudget;
use super::modes::Modes;
use super::nyquist::Nyquist;
use super::orbits::Orbits;
use super::panel::{Panel, PanelCommand, PanelRequest};
use super::polar::Polar;
use super::poles::Poles;
use super::run_up::RunUp;
use super::sensitivity::SensitivityCurve;
use super::strips::Strips;
use super::{damping_map, margins, raw, settings, spectrum, waterfall};
use crate::input::Mouse;
use crate::selection::ReadoutMove;
use crate::selection::SelectedItem;
use crate::view::View;

/// One row of the table.
pub(crate) struct PanelKind {
    /// As layouts name it.
    pub(crate) name: &'static str,
    /// What it shows, in a few words.
    pub(crate) meaning: &'static str,
    /// The smallest width and height, with its frame, at which it is of use.
    pub(crate) least: (u16, u16),
    /// Whether it is a plot: it can be chosen, and has a scale.
    pub(crate) is_plot: bool,
    /// Whether it is of a machine in motion: dim while that has tripped or is gone.
    pub(crate) is_of_motion: bool,
    /// Makes one.
    pub(crate) make: fn() -> Box<dyn Panel>,
}

/// Every panel.
pub(crate) const PANELS: &[PanelKind] = &[
    PanelKind {
        name: "poles",
        meaning: "poles in the complex plane",
        least: (20, 7),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<Poles>::default(),
    },
    PanelKind {
        name: "damping",
        meaning: "the minimum damping, large, and what it has been",
        least: (18, 5),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<Damping>::default(),
    },
    PanelKind {
        name: "orbits",
        meaning: "an orbit of every mass",
        least: (18, 7),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<Orbits>::default(),
    },
    PanelKind {
        name: "strips",
        meaning: "y, z and control over time",
        least: (18, 4),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<Strips>::default(),
    },
    PanelKind {
        name: "settings",
        meaning: "speed, gains, deadbands and limits, to be changed",
        least: (20, 5),
        is_plot: false,
        is_of_motion: false,
        make: || Box::new(settings::SettingsPanel),
    },
    PanelKind {
        name: "force",
        meaning: "the control force, now and at most",
        least: (18, 4),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<Force>::default(),
    },
    PanelKind {
        name: "force-budget",
        meaning: "the control force by component, by signal and by gain",
        least: (24, 5),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<ForceBudget>::default(),
    },
    PanelKind {
        name: "damping-over-speed",
        meaning: "how far the gains in force carry: minimum damping over speed",
        least: (28, 6),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<DampingOverSpeed>::default(),
    },
    PanelKind {
        name: "map",
        meaning: "minimum damping around the settings in force, over the speed and the selected setting",
        least: (24, 6),
        is_plot: false,
        is_of_motion: true,
        make: || Box::<damping_map::DampingMapPanel>::default(),
    },
    PanelKind {
        name: "campbell",
        meaning: "frequencies of all modes over speed, and the critical speeds",
        least: (28, 6),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<Campbell>::default(),
    },
    PanelKind {
        name: "nyquist",
        meaning: "the opened loop's gain around -1, with circles of constant sensitivity",
        least: (20, 8),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<Nyquist>::default(),
    },
    PanelKind {
        name: "sensitivity",
        meaning: "the loop's sensitivity over frequency, with the zones of ISO 14839-3",
        least: (24, 6),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<SensitivityCurve>::default(),
    },
    PanelKind {
        name: "margins",
        meaning: "delay, gain and phase margins and the peak of the sensitivity, large where there is room",
        least: (26, 5),
        is_plot: false,
        is_of_motion: true,
        make: || Box::new(margins::draw),
    },
    PanelKind {
        name: "modes",
        meaning: "every mode: damping, frequency, sense of whirl and shape, the least damped first",
        least: (40, 4),
        is_plot: false,
        is_of_motion: true,
        make: || Box::<Modes>::default(),
    },
    PanelKind {
        name: "spectrum",
        meaning: "full spectrum of one mass, forward and backward",
        least: (28, 6),
        is_plot: true,
        is_of_motion: true,
        make: || Box::new(spectrum::panel()),
    },
    PanelKind {
        name: "waterfall",
        meaning: "its spectra over time",
        least: (24, 6),
        is_plot: true,
        is_of_motion: true,
        make: || Box::new(waterfall::over_time()),
    },
    PanelKind {
        name: "waterfall-over-speed",
        meaning: "its spectra over the speeds that were run through",
        least: (24, 6),
        is_plot: true,
        is_of_motion: true,
        make: || Box::new(waterfall::over_speed()),
    },
    PanelKind {
        name: "run-up",
        meaning: "amplitude and phase of what turns with the spin, over speed, as a run-up or a coast-down goes on",
        least: (28, 8),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<RunUp>::default(),
    },
    PanelKind {
        name: "polar",
        meaning: "the same as a polar plot: a circle about each critical speed",
        least: (18, 7),
        is_plot: true,
        is_of_motion: true,
        make: || Box::<Polar>::default(),
    },
    PanelKind {
        name: "alarms",
        meaning: "what is watched, its limits, and what has been past them",
        least: (30, 4),
        is_plot: false,
        is_of_motion: false,
        make: || Box::<AlarmList>::default(),
    },
    PanelKind {
        name: "events",
        meaning: "what happened: who changed what and why, trips, notes",
        least: (30, 3),
        is_plot: false,
        is_of_motion: false,
        make: || Box::<Events>::default(),
    },
    PanelKind {
        name: "raw",
        meaning: "every number of one step",
        least: (40, 5),
        is_plot: false,
        is_of_motion: true,
        make: || Box::<raw::Raw>::default(),
    },
];

/// Name, meaning, and smallest width and height of every panel.
pub fn panels() -> impl ExactSizeIterator<Item = (&'static str, &'static str, (u16, u16))> {
    PANELS.iter().map(|kind| (kind.name, kind.meaning, kind.least))
}

/// The names of the plots.
pub(crate) fn plots() -> impl Iterator<Item = &'static str> {
    PANELS.iter().filter(|kind| kind.is_plot).map(|kind| kind.name)
}

/// The rows that a panel has something for, with its frame, on a screen of this view; nothing of those that draw as much as there is room
/// for.
pub(crate) fn rows_needed(kind: usize, view: &View<'_>) -> Option<u16> {
    let list = |rows: usize| u16::try_from(rows + 2).unwrap_or(u16::MAX);
    match PANELS[kind].name {
        "settings" => {
            let settings = view.data.settings.as_ref()?;
            Some(list(settings::shown_rows(settings, view.data.rotor.as_deref(), view.filter, view.cursor.row).len()))
        }
        "alarms" => Some(list(1 + alarms::Watch::ALL.len() + in_steps(view.alarms.entries().count().max(1)))),
        "events" => Some(list(in_steps(view.data.events.len()))),
        _ => None,
    }
}

/// So that panels do not move with every entry of a list.
fn in_steps(rows: usize) -> usize {
    rows.next_multiple_of(4)
}

/// The panels of one dashboard, made when they are first shown and kept, with what they remember, while others are.
pub(crate) struct Panels(Vec<Option<Box<dyn Panel>>>);

impl Panels {
    /// None has been shown yet.
    pub(crate) fn new() -> Self {
        Self(PANELS.iter().map(|_| None).collect())
    }

    /// What the mouse over the panel in row `kind` of the table asks for.
    pub(crate) fn mouse(
        &mut self,
        kind: usize,
        view: &View<'_>,
        area: Rect,
        mouse: Mouse,
        at: Position,
    ) -> Option<PanelRequest> {
        self.0[kind].get_or_insert_with(PANELS[kind].make).mouse(view, area, mouse, at)
    }

    /// What the panel in row `kind` of the table tells of what the mouse is over.
    pub(crate) fn told_at(&self, kind: usize, view: &View<'_>, area: Rect, at: Position) -> Option<String> {
        self.0[kind].as_ref()?.told_at(view, area, at)
    }

    /// Moves the list of the panel in row `kind` of the table, if it is one.
    pub(crate) fn scroll(&mut self, kind: usize, rows: isize) {
        self.0[kind].get_or_insert_with(PANELS[kind].make).scroll(rows);
    }

    /// Commands the panel in row `kind` of the table.
    pub(crate) fn command(&mut self, kind: usize, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        self.0[kind].get_or_insert_with(PANELS[kind].make).command(command)
    }

    /// Commands every panel that it is a matter of; says what comes of it if it is one of any.
    pub(crate) fn command_any(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        (0..PANELS.len()).filter_map(|kind| self.command(kind, command)).reduce(Result::and)
    }

    /// Where the read-out of the panel in row `kind` of the table goes.
    pub(crate) fn read(&mut self, kind: usize, view: &View<'_>, read: ReadoutMove) -> Option<SelectedItem> {
        self.0[kind].get_or_insert_with(PANELS[kind].make).read(view, read)
    }

    /// Draws the panel in row `kind` of the table.
    pub(crate) fn draw(&mut self, kind: usize, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        self.0[kind].get_or_insert_with(PANELS[kind].make).draw(view, area, buffer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Scaling;
    use crate::drawing::tests::drawn;
    use crate::selection::Selection;
    use crate::series::Strip;
    use crate::view::tests::view;
    use telemetry::test_support as tests;
    use telemetry::view_time::ViewTime;

    #[test]
    fn regress_a_bench_status_of_another_machine_than_the_steps_breaks_no_panel() {
        let now = std::time::Instant::now();
        for (steps_of, bench_status_of, feedback) in [(1, "three-mass", "individual"), (3, "jeffcott", "cancel")] {
            let mut feed = telemetry::feed::Feed::new("");
            (0..300).for_each(|seq| feed.push_step(&tests::state(steps_of, seq), now));
            feed.push_bench_status(tests::bench_status(bench_status_of, feedback));
            let data = feed.frame_data(&ViewTime::LIVE, now);
            let mut panels = Panels::new();
            for kind in 0..PANELS.len() {
                let area = Rect::new(0, 0, 80, 30);
                panels.draw(kind, &view(&data), area, &mut Buffer::empty(area));
            }
        }
    }

    /// A machine that has run for a while: speed up and motion, changes, a note, losses and a trip that was put right.
    fn eventful(scales: Option<rotor::Scales>) -> (telemetry::feed::Feed, std::time::Instant) {
        let now = std::time::Instant::now();
        let mut feed = telemetry::feed::Feed::new("");
        let mut bench_status = tests::bench_status("three-mass", "composite");
        bench_status.scales = scales.map_or([0.0; 4], |s| [s.w0, s.k_t, s.m_t, s.e_t]);
        feed.push_bench_status(bench_status);
        let settings = tests::bench_status("three-mass", "composite").settings.get().clone();
        for seq in (0..17_000).filter(|seq| *seq % 4001 != 4000) {
            let state = tests::state(3, seq).with(wire::Channel::Vy, 1, 1.5);
            feed.push_step(&state.with_word(wire::Channel::WallNs, 50_000_000_000_000 + seq * 1_000_000), now);
        }
        let told = [
            wire::Happening::Started,
            wire::Happening::Note("here it hums".into()),
            wire::Happening::Tripped(wire::message::Trip { cause: 1, mass: 2, step: 9, radius: 1000.5, limit: 1000.0 }),
        ];
        for (number, happening) in (1..).zip(&told) {
            feed.push_event(&telemetry::test_support::event(number, happening, &settings));
        }
        (feed, now)
    }

    /// The sizes at which every panel is looked at, beside its smallest.
    const USUAL: (u16, u16) = (64, 16);
    const LARGE: (u16, u16) = (150, 44);

    #[test]
    fn every_panel_has_its_frame_at_its_smallest_at_a_usual_and_at_a_large_size() {
        let (feed, now) = eventful(None);
        let data = feed.frame_data(&ViewTime::LIVE, now);
        for (at, kind) in PANELS.iter().enumerate() {
            let panels = std::cell::RefCell::new(Panels::new());
            let frame_of = |(width, height): (u16, u16)| {
                // At every small size too, down to 0 x 0.
                drawn(width, height, |area, buffer| panels.borrow_mut().draw(at, &view(&data), area, buffer))
            };
            let frames = [kind.least, USUAL, LARGE].map(frame_of);
            for (frame, (width, height)) in frames.iter().zip([kind.least, USUAL, LARGE]) {
                let rows: Vec<&str> = frame.lines().collect();
                let is_framed = rows[0].starts_with('┌') && rows[usize::from(height) - 1].ends_with('┘');
                assert!(is_framed && rows[0].chars().count() == usize::from(width), "{}:\n{frame}", kind.name);
            }
            insta::assert_snapshot!(format!("panel_{}", kind.name), frames.join("\n"));
            assert!(PANELS[..at].iter().all(|other| other.name != kind.name), "{} twice", kind.name);
            assert!(kind.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", kind.name);
        }
    }

    #[test]
    fn a_rotor_in_si_units_is_shown_in_them_everywhere() {
        let (feed, now) = eventful(Some(telemetry::test_support::SI));
        let data = feed.frame_data(&ViewTime::LIVE, now);
        let mut panels = Panels::new();
        for (at, kind) in PANELS.iter().enumerate() {
            let area = Rect::new(0, 0, LARGE.0, LARGE.1);
            let mut buffer = Buffer::empty(area);
            panels.draw(at, &view(&data), area, &mut buffer);
            let frame = crate::screenshot::image::text(&buffer);
            // What the simulation says of a trip is its own words.
            for sign in ["e_t", "w0", " R "].into_iter().filter(|_| kind.name != "events") {
                assert!(!frame.contains(sign), "{} still says {sign}:\n{frame}", kind.name);
            }
            // 1.5 e_t of 5 um are 7.5 um; 0.8 of a quarter of 2 kg (1000/s)^2 5 um are 2 N; w0 is 159.15 Hz and 9549.3 rpm.
            let expected: &[&str] = match kind.name {
                "orbits" => &["±20 μm", "7.50"],
                "strips" => &["±20 μm", "±2 N"],
                "force" | "force-budget" => &[" N ", "2.0000"],
                "damping-over-speed" => &["23873 rpm"],
                "modes" => &["at 23873 rpm", "freq. Hz"],
                "spectrum" => &["μm²/Hz", "7.500 μm"],
                "raw" => &["23873.2 rpm", "μm/s"],
                "settings" => &["rpm", " μm ", " N/m ", " N s/m"],
                "poles" => &["1/s", "Hz"],
                _ => &[],
            };
            for words in expected {
                assert!(frame.contains(words), "{}: no '{words}':\n{frame}", kind.name);
            }
        }
    }

    /// Everything that a person can do to a plot leaves one that draws, at any size, now and in the past.
    #[test]
    fn no_wish_and_no_click_breaks_a_panel() {
        let (feed, now) = eventful(None);
        let mut past = ViewTime::LIVE;
        past.look_at(9000, &feed.history().kept(), feed.step_seconds());
        let strips = Strip::read_all("y.3 radius damping speed command vy.2").unwrap();
        let pole = feed.frame_data(&past, now).poles().unwrap().1[2];
        let selection = Selection { plot: Some(0), mode: Some(pole), frequency: Some(1.2), speed: Some(3.0) };
        for time in [ViewTime::LIVE, past] {
            let data = feed.frame_data(&time, now);
            let view = View { time: &time, selection: &selection, ..view(&data) };
            let mut panels = Panels::new();
            for (at, kind) in PANELS.iter().enumerate() {
                let fixes = [Scaling::Fix([1e-3, 2e-3]), Scaling::Fix([1e5, 1e6])];
                let appearance = [
                    PanelCommand::Value(&[Scaling::Times(1e-9)]),
                    PanelCommand::Value(&[Scaling::Times(1e9)]),
                    PanelCommand::Value(&fixes),
                    PanelCommand::Value(&[]),
                    PanelCommand::Along(Scaling::Times(0.01), &selection),
                    PanelCommand::Along(Scaling::Fix([-7.0, -6.0]), &selection),
                    PanelCommand::Along(Scaling::Fix([500.0, 600.0]), &selection),
                    PanelCommand::Mass(Some(2)),
                    PanelCommand::Strips(Some(&strips)),
                    PanelCommand::Strip("damping", &[Scaling::Times(0.5)]),
                ];
                for command in &appearance {
                    panels.command(at, command);
                    for (width, height) in [(0, 0), (1, 1), (7, 3), kind.least, USUAL, LARGE] {
                        let area = Rect::new(2, 1, width, height);
                        panels.draw(at, &view, area, &mut Buffer::empty(Rect::new(0, 0, 200, 60)));
                        for spot in [(2, 1), (4, 3), (width, height), (width / 2, height / 2)] {
                            panels.told_at(at, &view, area, Position::from(spot));
                        }
                        for mouse in [Mouse::Click, Mouse::Drag(1), Mouse::Wheel(3), Mouse::Wheel(-3)] {
                            for spot in [(2, 1), (4, 3), (width, height), (width / 2, height / 2)] {
                                panels.mouse(at, &view, area, mouse, Position::from(spot));
                            }
                        }
                        for read in
                            [ReadoutMove::Move(-1), ReadoutMove::Move(1), ReadoutMove::At(1.0), ReadoutMove::Off]
                        {
                            panels.read(at, &view, read);
                        }
                    }
                }
            }
        }
    }
}
