//! A recording in memory, of what the simulation itself has done.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use alarms::{Alarms, LevelChange, Limit, Limits, Sampler, Watch};
use rotor::{C64, Modes, Settings, builtin};
use wire::message::{Analysis, Trip};
use wire::{
    BenchName, BenchStatus, Carrier, Change, Channel, Commander, Event, Glance, Happening, Listener, Memory, Moment,
    State, Step,
};

use crate::edits::Edit;
use crate::feed::Feed;
use crate::processes::OpaqueError;
use crate::replay::{Player, RecordedEvent, RecordedKind, RecordingSource, ReplayError};
use crate::view_time::ViewTime;

/// A session in memory.
#[derive(Clone)]
pub struct Session {
    /// The bench status that it began with.
    pub bench_status: Box<BenchStatus>,
    /// Its steps, in order.
    pub states: Vec<State>,
    /// What happened, in order.
    pub events: Vec<Event>,
}

impl Session {
    fn in_force(&self, seq: u64) -> &Event {
        let mut newest_first = self.events.iter().rev().filter(|event| matches!(event.kind, 1 | 2));
        newest_first.find(|event| event.seq <= seq).unwrap_or(&self.events[0])
    }

    fn moment(state: &State) -> Moment {
        state.into()
    }
}

impl RecordingSource for Session {
    fn name(&self) -> String {
        "memory".into()
    }

    fn span(&self) -> Option<[Moment; 2]> {
        Some([Self::moment(self.states.first()?), Self::moment(self.states.last()?)])
    }

    fn visit(&mut self, range: std::ops::Range<u64>, each: &mut dyn FnMut(&State)) -> Result<(), OpaqueError> {
        let from = self.states.partition_point(|state| state.seq() < range.start);
        self.states[from..].iter().take_while(|state| state.seq() < range.end).for_each(each);
        Ok(())
    }

    fn bench_status_at(&mut self, seq: u64) -> Box<BenchStatus> {
        let event = self.in_force(seq);
        let mut bench_status = self.bench_status.clone();
        bench_status.settings = event.settings.clone();
        bench_status.substeps = event.substeps;
        bench_status.revision = event.revision;
        let rotor = bench_status.rotor().unwrap();
        let linear = Modes::of(&event.settings.get().clone().closed_loop(&rotor)).unwrap();
        bench_status.analysis = Analysis { count: 6, min_damping: linear.min_damping(), ..Analysis::default() };
        for (place, mode) in bench_status.analysis.poles.iter_mut().zip(&linear.modes) {
            *place = [mode.pole.re, mode.pole.im];
        }
        let mut trips = self.events.iter().rev().filter(|event| matches!(event.kind, 5 | 6));
        bench_status.trip = trips.find(|event| event.seq <= seq).map_or_else(Trip::default, |event| event.trip);
        bench_status
    }

    fn changes(&self) -> Vec<u64> {
        self.events.iter().filter(|event| matches!(event.kind, 1 | 2)).map(|event| event.seq).collect()
    }

    fn events(&self) -> Vec<RecordedEvent> {
        let alarm = |turn: LevelChange| RecordedEvent {
            at: turn.at,
            what: RecordedKind::Alarm(turn),
            who: "recorder".into(),
            why: String::new(),
        };
        let told = |event: &Event| RecordedEvent {
            at: event.into(),
            what: RecordedKind::Happening(event.happening().unwrap()),
            who: event.who.as_str().into(),
            why: event.why.as_str().into(),
        };
        let mut events: Vec<_> = self.events.iter().map(told).chain(self.turns().into_iter().map(alarm)).collect();
        events.sort_by_key(|event| event.at.seq);
        events
    }

    /// As a recorder judges, only more often, and on a clock by which what comes back has done so for long at the second look.
    fn turns(&self) -> Vec<LevelChange> {
        let (mut sampler, mut alarms) = (Sampler::default(), Alarms::new(limits()));
        let slowly = |state: &State| state.with_word(Channel::WallNs, state.seq() * 200_000_000);
        let mut turns = Vec::new();
        for stretch in self.states.chunks(50) {
            stretch.iter().for_each(|state| sampler.hear(&slowly(state)));
            turns.extend(alarms.read(&sampler.take()));
        }
        turns
    }

    fn limits(&self) -> Option<Limits> {
        Some(limits())
    }

    fn missing(&self) -> Vec<std::ops::Range<u64>> {
        let gaps = self.states.windows(2).map(|pair| pair[0].seq() + 1..pair[1].seq());
        gaps.filter(|gap| !gap.is_empty()).collect()
    }

    fn notices(&self) -> Vec<String> {
        let missing: u64 = self.missing().iter().map(|gap| gap.end - gap.start).sum();
        if missing > 0 { vec![format!("{missing} steps are missing")] } else { Vec::new() }
    }

    fn at_tau(&mut self, tau: f64) -> Result<u64, OpaqueError> {
        let found = self.states.iter().rev().find(|state| state.tau() <= tau);
        found.or(self.states.first()).map(|state| state.seq()).ok_or_else(|| OpaqueError::new("empty"))
    }
}

/// What the session is held against.
fn limits() -> Limits {
    Limits::none().having(Watch::Orbit, Limit::above(2.4, 2.5))
}

struct StopAtEnd<'a>(&'a AtomicBool);

impl Drop for StopAtEnd<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A session of a real simulation: changed, struck, sped up, restarted, tripped, restarted again.
fn simulated(dtau: f64) -> Session {
    let rotor = builtin::rotor("three-mass").unwrap();
    let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").unwrap());
    settings.deadband.fill(1.0);
    let carrier = Memory::default();
    let options = sim::Options { bench: BenchName::default(), rate_hz: 2000.0, dtau, ..sim::Options::default() };
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let begun = settings.clone();
        let simulation = scope.spawn(|| sim::run(&carrier, &rotor, begun, &options, &stop, || ()));
        // A failed assertion must end the simulation too, or the scope would wait for it for ever.
        let _stop = StopAtEnd(&stop);
        let start = Instant::now();
        let mut listener = loop {
            match carrier.listen(&options.bench) {
                Ok(listener) => break listener,
                Err(error) => assert!(start.elapsed() < Duration::from_secs(10), "{error}"),
            }
        };
        let mut commander = carrier.command(&options.bench).unwrap();
        let (mut states, mut events, mut bench_status) = (Vec::new(), Vec::new(), None);
        let mut wait_for = |count: usize| {
            let target = states.len() + count;
            while states.len() < target {
                listener.drain(|state| states.push(State::of(&state))).unwrap();
                listener.events(|event| events.push(event.clone())).unwrap();
                bench_status = listener.bench_status().unwrap().or(bench_status.take());
                assert!(start.elapsed() < Duration::from_secs(60), "{} steps only", states.len());
                thread::sleep(Duration::from_millis(1));
            }
        };
        let mut ask = |change: Change| {
            let answer = commander.ask(&change.request("test", "to see").unwrap(), Duration::from_secs(10)).unwrap();
            assert!(answer.is_accepted(), "{:?}", answer.reason);
        };
        let mut revision = 0;
        let mut set = |ask: &mut dyn FnMut(Change), settings: &Settings| {
            revision += 1;
            ask(Change::Settings { base_revision: revision, settings: settings.clone() });
        };
        let kick = |mass| Change::Impulse { mass, velocity: C64::new(1.0, -0.5) };
        wait_for(150);
        settings.assign("kd", "-0.6").unwrap();
        set(&mut ask, &settings);
        wait_for(77);
        ask(kick(1));
        wait_for(123);
        settings.speed = 3.0;
        set(&mut ask, &settings);
        wait_for(111);
        ask(Change::Note { text: "now it is faster".into() });
        ask(kick(0));
        wait_for(205);
        ask(Change::Restart);
        wait_for(100);
        settings.feedback = settings.feedback.off();
        settings.trip = 3.0;
        set(&mut ask, &settings);
        ask(kick(2));
        wait_for(900);
        ask(Change::Restart);
        wait_for(200);
        stop.store(true, Ordering::Relaxed);
        simulation.join().unwrap().unwrap();
        listener.drain(|state| states.push(State::of(&state))).unwrap();
        listener.events(|event| events.push(event.clone())).unwrap();
        events.retain(|event| !matches!(event.happening(), Some(Happening::Late { .. })));
        Session { bench_status: bench_status.unwrap(), states, events }
    })
}

/// One for all tests.
#[must_use]
pub fn session() -> Session {
    static SESSION: OnceLock<Session> = OnceLock::new();
    SESSION.get_or_init(|| whole(0.01)).clone()
}

/// A session of steps of `dtau`, whole from the first step on: a machine that was too busy to hear every step tries again.
#[must_use]
pub fn whole(dtau: f64) -> Session {
    let is_whole = |session: &Session| session.states[0].seq() == 0 && session.missing().is_empty();
    (0..20).map(|_| simulated(dtau)).find(is_whole).expect("a session without a gap")
}

/// The session's machine at rest for two million steps, made as they are asked for.
pub struct Long(Session);

impl Long {
    /// With the machine of `session`.
    #[must_use]
    pub fn new(session: Session) -> Self {
        Self(session)
    }
}

impl RecordingSource for Long {
    fn name(&self) -> String {
        "long".into()
    }

    fn span(&self) -> Option<[Moment; 2]> {
        Some([0, 1_999_999].map(|seq| Moment { seq, ..Moment::default() }))
    }

    fn visit(&mut self, range: std::ops::Range<u64>, each: &mut dyn FnMut(&State)) -> Result<(), OpaqueError> {
        let first = self.0.states[0];
        let made = |seq: u64| first.with_word(Channel::Seq, seq).with(Channel::Tau, 0, (seq + 1) as f64 * 0.01);
        (range.start..range.end.min(2_000_000)).for_each(|seq| each(&made(seq)));
        Ok(())
    }

    fn bench_status_at(&mut self, _: u64) -> Box<BenchStatus> {
        self.0.bench_status_at(0)
    }

    fn changes(&self) -> Vec<u64> {
        vec![0]
    }

    fn events(&self) -> Vec<RecordedEvent> {
        Vec::new()
    }

    fn turns(&self) -> Vec<LevelChange> {
        Vec::new()
    }

    fn limits(&self) -> Option<Limits> {
        None
    }

    fn missing(&self) -> Vec<std::ops::Range<u64>> {
        Vec::new()
    }

    fn notices(&self) -> Vec<String> {
        Vec::new()
    }

    fn at_tau(&mut self, _: f64) -> Result<u64, OpaqueError> {
        Ok(0)
    }
}

/// A player on a recording, with what it fills.
pub struct Stage {
    /// The player.
    pub player: Player,
    /// What it fills.
    pub feed: Feed,
    /// Where it stands.
    pub time: ViewTime,
}

impl Stage {
    /// At the beginning of `session`.
    ///
    /// # Panics
    /// It has no steps.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        let (mut feed, mut time) = (Feed::new(""), ViewTime::LIVE);
        let player = Player::new(Box::new(session.clone()), &mut feed, &mut time).unwrap();
        Self { player, feed, time }
    }

    /// Goes to a step.
    ///
    /// # Panics
    /// It cannot be read.
    pub fn go(&mut self, seq: u64) -> &mut Self {
        self.player.go(seq, &mut self.feed, &mut self.time).unwrap();
        self
    }

    /// Makes an edit.
    ///
    /// # Errors
    /// Why not.
    pub fn edit(&mut self, edit: &Edit) -> Result<String, ReplayError> {
        self.player.edit(edit, &mut self.feed, &mut self.time)
    }

    /// Plays so many steps.
    ///
    /// # Panics
    /// They cannot be read.
    pub fn play(&mut self, steps: f64) {
        self.player.play(steps, &mut self.feed, &mut self.time).unwrap();
    }
}
