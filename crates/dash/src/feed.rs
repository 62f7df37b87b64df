//! What has been heard from the simulation: a bounded history, and the picture of it that one frame is drawn from.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rotor::{Rotor, Settings};
use wire::message::{Flags, Trip};
use wire::{Bulletin, State};

/// Steps kept: 32 s at 1000 steps a second, and at most 9.4 MB (16 masses).
const STEPS_KEPT: usize = 32_768;
/// Steps in a picture: enough for a dozen turns at the default step.
const STEPS_SHOWN: usize = 8192;
/// Minimum damping is kept for two minutes of bulletins.
const DAMPING_KEPT: usize = 1200;

/// Columns of a step before those of its masses: `tau`, `angle`, `u_y`, `u_z`.
const HEAD: usize = 4;

/// Steps as rows of numbers, oldest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Track {
    masses: usize,
    rows: Vec<f64>,
}

impl Track {
    fn width(&self) -> usize {
        HEAD + 2 * self.masses
    }

    /// How many steps there are.
    pub(crate) fn len(&self) -> usize {
        if self.rows.is_empty() { 0 } else { self.rows.len() / self.width() }
    }

    fn row(&self, step: usize) -> &[f64] {
        &self.rows[step * self.width()..(step + 1) * self.width()]
    }

    /// Spin angle at step `step`, in radians.
    pub(crate) fn angle(&self, step: usize) -> f64 {
        self.row(step)[1]
    }

    /// Control `[y, z]` at step `step`.
    pub(crate) fn force(&self, step: usize) -> [f64; 2] {
        [self.row(step)[2], self.row(step)[3]]
    }

    /// Displacement `[y, z]` of a mass at step `step`.
    pub(crate) fn place(&self, step: usize, mass: usize) -> [f64; 2] {
        let row = &self.row(step)[HEAD + 2 * mass..];
        [row[0], row[1]]
    }
}

/// How things stand between us and the simulation.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Contact {
    /// No bench of that name yet, or a reason why we cannot attach.
    Waiting(String),
    /// States arrive.
    Live,
    /// The process lives but sends nothing.
    Stalled,
    /// The process has ended.
    Gone,
}

/// All that has been heard, in bounded memory. The reader thread writes it, the drawing thread takes pictures.
#[derive(Debug)]
pub(crate) struct Feed {
    masses: usize,
    rows: VecDeque<f64>,
    run_id: u64,
    last_seq: u64,
    lost: u64,
    heard: Option<Instant>,
    tripped: bool,
    peak_force: f64,
    revision: u64,
    pace: Pace,
    rotor: Option<Arc<Rotor>>,
    bulletin: Option<Arc<Bulletin>>,
    damping: VecDeque<f64>,
    contact: Contact,
    changes: u64,
}

impl Feed {
    pub(crate) fn new(why: &str) -> Self {
        Self {
            masses: 0,
            rows: VecDeque::new(),
            run_id: 0,
            last_seq: 0,
            lost: 0,
            heard: None,
            tripped: false,
            peak_force: 0.0,
            revision: 0,
            pace: Pace::default(),
            rotor: None,
            bulletin: None,
            damping: VecDeque::new(),
            contact: Contact::Waiting(why.to_owned()),
            changes: 0,
        }
    }

    /// Takes in one state. A new run clears the track; a gap in the numbers is a loss.
    pub(crate) fn hear(&mut self, state: &State, now: Instant) {
        let masses = state.points().len();
        if state.run_id != self.run_id || masses != self.masses {
            *self = Self { bulletin: self.bulletin.take(), rotor: self.rotor.take(), ..Self::new("") };
            self.run_id = state.run_id;
            self.masses = masses;
        } else {
            self.lost += state.seq.saturating_sub(self.last_seq + 1);
        }
        self.last_seq = state.seq;
        self.heard = Some(now);
        self.pace.count(now);
        self.contact = Contact::Live;
        self.changes += 1;
        let tripped = state.flags.has(Flags::TRIPPED);
        // A machine that is held would push what tripped it out of the picture.
        if tripped && self.tripped {
            return;
        }
        let restarted = self.tripped && !tripped;
        if restarted || state.revision != self.revision {
            self.peak_force = 0.0;
        }
        self.tripped = tripped;
        self.revision = state.revision;
        let [u_y, u_z] = state.force_delivered;
        self.peak_force = self.peak_force.max(u_y.hypot(u_z));
        let width = HEAD + 2 * masses;
        if self.rows.len() >= STEPS_KEPT * width {
            self.rows.drain(..width);
        }
        self.rows.extend([state.tau, state.angle, u_y, u_z]);
        self.rows.extend(state.points().iter().flat_map(|point| [point.y, point.z]));
    }

    /// Takes in one bulletin.
    pub(crate) fn read(&mut self, bulletin: Box<Bulletin>) {
        if self.bulletin.as_ref().is_none_or(|last| last.run_id != bulletin.run_id) {
            self.damping.clear();
            self.rotor = bulletin.rotor().ok().map(Arc::new);
        }
        if self.damping.len() == DAMPING_KEPT {
            self.damping.pop_front();
        }
        if bulletin.analysis.count > 0 {
            self.damping.push_back(bulletin.analysis.min_damping);
        }
        self.bulletin = Some(Arc::from(bulletin));
        self.changes += 1;
    }

    /// Notes how things stand; what has been heard stays.
    pub(crate) fn stand(&mut self, contact: Contact) {
        if self.contact != contact {
            self.contact = contact;
            self.changes += 1;
        }
    }

    /// When the last state came.
    pub(crate) fn heard(&self) -> Option<Instant> {
        self.heard
    }

    /// How things stand.
    pub(crate) fn contact(&self) -> &Contact {
        &self.contact
    }

    /// The settings in force, once they are known.
    pub(crate) fn settings(&self) -> Option<Settings> {
        self.bulletin.as_ref().map(|bulletin| bulletin.settings.unpack())
    }

    /// Rises with everything that is taken in: a picture of the same count shows nothing new.
    pub(crate) fn changes(&self) -> u64 {
        self.changes
    }

    /// A copy of what one frame shows.
    pub(crate) fn picture(&self, now: Instant) -> Picture {
        let width = HEAD + 2 * self.masses;
        let from = self.rows.len().saturating_sub(STEPS_SHOWN * width);
        Picture {
            track: Track { masses: self.masses, rows: self.rows.range(from..).copied().collect() },
            settings: self.settings(),
            rotor: self.rotor.clone(),
            bulletin: self.bulletin.clone(),
            damping: self.damping.iter().copied().collect(),
            lost: self.lost,
            rate: self.pace.rate(now),
            age: self.heard.map(|heard| now.saturating_duration_since(heard)),
            contact: self.contact.clone(),
            tripped: self.tripped,
            peak_force: self.peak_force,
        }
    }
}

/// What one frame is drawn from.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// The latest steps.
    pub(crate) track: Track,
    /// The settings in force, once they are known.
    pub(crate) settings: Option<Settings>,
    /// The rotor, once it is known.
    pub(crate) rotor: Option<Arc<Rotor>>,
    /// The latest bulletin.
    pub(crate) bulletin: Option<Arc<Bulletin>>,
    /// Minimum damping, ten values a second, oldest first.
    pub(crate) damping: Vec<f64>,
    /// Steps that were sent and did not reach us.
    pub(crate) lost: u64,
    /// Steps a second that reach us.
    pub(crate) rate: f64,
    /// Age of the latest step.
    pub(crate) age: Option<Duration>,
    /// How things stand.
    pub(crate) contact: Contact,
    /// Whether the machine has tripped.
    pub(crate) tripped: bool,
    /// The largest control since the settings last changed or the rotor restarted.
    pub(crate) peak_force: f64,
}

impl Picture {
    /// How many masses have been heard of.
    pub(crate) fn masses(&self) -> usize {
        self.track.masses
    }

    /// The minimum damping and the poles, least damped first, if they are known.
    pub(crate) fn poles(&self) -> Option<(f64, Vec<rotor::C64>)> {
        let analysis = &self.bulletin.as_ref()?.analysis;
        (analysis.count > 0).then(|| (analysis.min_damping, analysis.poles().collect()))
    }

    /// The trip, while there is one.
    pub(crate) fn trip(&self) -> Option<Trip> {
        self.bulletin.as_ref().map(|bulletin| bulletin.trip).filter(Trip::is_tripped)
    }
}

/// Steps a second, over the last second or so.
#[derive(Debug, Default)]
struct Pace {
    window: Option<(Instant, u32)>,
    rate: f64,
}

impl Pace {
    fn count(&mut self, now: Instant) {
        let (since, count) = *self.window.get_or_insert((now, 0));
        let elapsed = now.saturating_duration_since(since).as_secs_f64();
        if elapsed >= 1.0 {
            self.rate = f64::from(count) / elapsed;
            self.window = Some((now, 1));
        } else {
            self.window = Some((since, count + 1));
        }
    }

    fn rate(&self, now: Instant) -> f64 {
        match self.window {
            Some((since, _)) if now.saturating_duration_since(since).as_secs_f64() < 2.0 => self.rate,
            _ => 0.0,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use rotor::{Spectrum, builtin};
    use wire::SettingsMessage;
    use wire::message::{Analysis, Point};

    use super::*;

    /// A bulletin of a built-in rotor at speed 2.5.
    pub(crate) fn bulletin(rotor_name: &str, feedback: &str) -> Box<Bulletin> {
        let rotor = builtin::rotor(rotor_name).unwrap();
        let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).unwrap());
        settings.deadband.fill(1.0);
        let spectrum = Spectrum::of(&settings.closed_loop(&rotor)).unwrap();
        let mut analysis = Analysis {
            revision: 1,
            count: spectrum.modes.len() as u32,
            min_damping: spectrum.min_damping(),
            ..Analysis::default()
        };
        for (place, mode) in analysis.poles.iter_mut().zip(&spectrum.modes) {
            *place = [mode.pole.re, mode.pole.im];
        }
        let mut bulletin = Box::new(Bulletin {
            run_id: 7,
            pid: 1234,
            rate_hz: 1000.0,
            dtau: 0.01,
            revision: 1,
            settings: SettingsMessage::pack(&settings).unwrap(),
            analysis,
            ..Bulletin::default()
        });
        bulletin.set_rotor(&rotor);
        bulletin.health.lateness_p50_us = 50.0;
        bulletin.health.lateness_p99_us = 120.0;
        bulletin
    }

    /// State number `seq` of masses that whirl on circles of radius 1.5, 2.5, 3.5 ... at half the spin speed.
    pub(crate) fn state(masses: usize, seq: u64) -> State {
        let tau = seq as f64 * 0.01;
        let mut state = State {
            run_id: 7,
            seq,
            tau,
            angle: 2.5 * tau,
            speed: 2.5,
            revision: 1,
            count: masses as u32,
            force_delivered: [0.8 * (1.25 * tau).cos(), 0.8 * (1.25 * tau).sin()],
            ..State::default()
        };
        for (i, place) in state.masses[..masses].iter_mut().enumerate() {
            let radius = 1.5 + i as f64;
            *place = Point { y: radius * (1.25 * tau).cos(), z: radius * (1.25 * tau).sin(), vy: 0.0, vz: 0.0 };
        }
        state
    }

    /// A picture of the three-mass rotor after 3000 steps of regular whirl.
    pub(crate) fn picture() -> Picture {
        let now = Instant::now();
        let mut feed = Feed::new("");
        feed.read(bulletin("three-mass", "composite"));
        (0..3000).for_each(|seq| feed.hear(&state(3, seq), now));
        feed.picture(now)
    }

    #[test]
    fn history_is_bounded_and_keeps_the_latest() {
        let now = Instant::now();
        let mut feed = Feed::new("");
        (0..STEPS_KEPT as u64 + 100).for_each(|seq| feed.hear(&state(3, seq), now));
        assert_eq!(feed.rows.len(), STEPS_KEPT * 10);
        let picture = feed.picture(now);
        assert_eq!((picture.track.len(), picture.lost), (STEPS_SHOWN, 0));
        let last = state(3, STEPS_KEPT as u64 + 99);
        assert_eq!(picture.track.angle(STEPS_SHOWN - 1), last.angle);
        assert_eq!(picture.track.place(STEPS_SHOWN - 1, 2), [last.masses[2].y, last.masses[2].z]);
    }

    #[test]
    fn gaps_are_losses_and_a_new_run_starts_clean() {
        let now = Instant::now();
        let mut feed = Feed::new("");
        [0, 1, 5, 6].into_iter().for_each(|seq| feed.hear(&state(1, seq), now));
        assert_eq!(feed.picture(now).lost, 3);
        feed.hear(&State { run_id: 8, ..state(3, 0) }, now);
        let picture = feed.picture(now);
        assert_eq!((picture.lost, picture.track.len(), picture.masses()), (0, 1, 3));
    }

    #[test]
    fn a_held_machine_keeps_the_picture_of_what_tripped_it() {
        let now = Instant::now();
        let mut feed = Feed::new("");
        (0..10).for_each(|seq| feed.hear(&state(1, seq), now));
        let held = |seq| State { flags: Flags::TRIPPED, ..state(1, seq) };
        (10..500).for_each(|seq| feed.hear(&held(seq), now));
        let picture = feed.picture(now);
        assert_eq!((picture.track.len(), picture.tripped, picture.lost), (11, true, 0));
        feed.hear(&state(1, 500), now);
        assert_eq!(feed.picture(now).track.len(), 12);
    }

    #[test]
    fn the_peak_force_starts_anew_with_every_change() {
        let now = Instant::now();
        let mut feed = Feed::new("");
        let with = |seq, force, revision| State { force_delivered: [force, 0.0], revision, ..state(1, seq) };
        feed.hear(&with(0, 5.0, 1), now);
        feed.hear(&with(1, 1.0, 1), now);
        assert_eq!(feed.picture(now).peak_force, 5.0);
        feed.hear(&with(2, 2.0, 2), now);
        assert_eq!(feed.picture(now).peak_force, 2.0);
    }
}
