//! What was simulated by the simulation itself is played, from memory.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use alarms::{Alarms, Level, Limit, Limits, Sampler, Turn, Watch};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use rotor::{C64, Key, Settings, Spectrum, builtin};
use wire::message::{Analysis, Flags, Trip};
use wire::{
    BenchName, BenchStatus, Carrier, Change, Channel, Commander, Event, Glance, Happening, Listener, Memory, Moment,
    State, Step,
};

use super::*;
use crate::clerk::Edit;
use crate::feed::Feed;
use crate::hands::OutsideError;
use crate::layout::built_in;
use crate::looks::still::text;
use crate::panels::registry::Panels;
use crate::replay::player::{Repeat, SPEEDS};
use crate::screen;
use crate::view::View;
use crate::view_time::ViewTime;

/// A session in memory.
#[derive(Clone)]
pub(crate) struct Session {
    bench_status: Box<BenchStatus>,
    pub(crate) states: Vec<State>,
    events: Vec<Event>,
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

impl Past for Session {
    fn name(&self) -> String {
        "memory".into()
    }

    fn span(&self) -> Option<[Moment; 2]> {
        Some([Self::moment(self.states.first()?), Self::moment(self.states.last()?)])
    }

    fn visit(&mut self, range: std::ops::Range<u64>, each: &mut dyn FnMut(&State)) -> Result<(), OutsideError> {
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
        let spectrum = Spectrum::of(&event.settings.get().clone().closed_loop(&rotor)).unwrap();
        bench_status.analysis = Analysis { count: 6, min_damping: spectrum.min_damping(), ..Analysis::default() };
        for (place, mode) in bench_status.analysis.poles.iter_mut().zip(&spectrum.modes) {
            *place = [mode.pole.re, mode.pole.im];
        }
        let mut trips = self.events.iter().rev().filter(|event| matches!(event.kind, 5 | 6));
        bench_status.trip = trips.find(|event| event.seq <= seq).map_or_else(Trip::default, |event| event.trip);
        bench_status
    }

    fn changes(&self) -> Vec<u64> {
        self.events.iter().filter(|event| matches!(event.kind, 1 | 2)).map(|event| event.seq).collect()
    }

    fn events(&self) -> Vec<PastEvent> {
        let alarm = |turn: Turn| PastEvent {
            at: turn.at,
            what: PastWhat::Alarm(turn),
            who: "recorder".into(),
            why: String::new(),
        };
        let told = |event: &Event| PastEvent {
            at: event.into(),
            what: PastWhat::Happening(event.happening().unwrap()),
            who: event.who.as_str().into(),
            why: event.why.as_str().into(),
        };
        let mut events: Vec<_> = self.events.iter().map(told).chain(self.turns().into_iter().map(alarm)).collect();
        events.sort_by_key(|event| event.at.seq);
        events
    }

    /// As a recorder judges, only more often.
    fn turns(&self) -> Vec<Turn> {
        let (mut sampler, mut alarms) = (Sampler::default(), Alarms::new(limits()));
        let mut turns = Vec::new();
        for stretch in self.states.chunks(50) {
            stretch.iter().for_each(|state| sampler.hear(state));
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

    fn at_tau(&mut self, tau: f64) -> Result<u64, OutsideError> {
        let found = self.states.iter().rev().find(|state| state.tau() <= tau);
        found.or(self.states.first()).map(|state| state.seq()).ok_or_else(|| OutsideError::new("empty"))
    }
}

/// What the session is held against.
fn limits() -> Limits {
    Limits::none().having(Watch::Orbit, Limit::above(2.4, 2.5))
}

fn key(name: &str) -> Key {
    name.parse().unwrap()
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
    let options = sim::Options { bench: BenchName::default(), rate_hz: 2000.0, dtau, profile: None };
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
pub(crate) fn session() -> Session {
    static SESSION: OnceLock<Session> = OnceLock::new();
    SESSION.get_or_init(|| whole(0.01)).clone()
}

/// Whole from the first step on: a machine that was too busy to hear every step tries again.
fn whole(dtau: f64) -> Session {
    let is_whole = |session: &Session| session.states[0].seq() == 0 && session.missing().is_empty();
    (0..20).map(|_| simulated(dtau)).find(is_whole).expect("a session without a gap")
}

/// A player with what it fills.
struct Stage {
    player: Player,
    feed: Feed,
    time: ViewTime,
}

impl Stage {
    fn of(session: &Session) -> Self {
        let (mut feed, mut time) = (Feed::new(""), ViewTime::LIVE);
        let player = Player::new(Box::new(session.clone()), &mut feed, &mut time).unwrap();
        Self { player, feed, time }
    }

    fn go(&mut self, seq: u64) -> &mut Self {
        self.player.go(seq, &mut self.feed, &mut self.time).unwrap();
        self
    }

    fn edit(&mut self, edit: &Edit) -> Result<String, String> {
        self.player.edit(edit, &mut self.feed, &mut self.time)
    }

    fn play(&mut self, steps: f64) {
        self.player.play(steps, &mut self.feed, &mut self.time).unwrap();
    }

    /// What is on the screen.
    fn frame(&self, width: u16, height: u16) -> String {
        self.frame_of("overview", width, height)
    }

    fn frame_of(&self, layout: &str, width: u16, height: u16) -> String {
        let area = Rect::new(0, 0, width, height);
        let mut buffer = Buffer::empty(area);
        let mut picture = self.feed.picture(&self.time, Instant::now());
        self.player.finish(&mut picture);
        let view = View {
            time: &self.time,
            alarms: self.player.alarms(),
            what_if: self.player.what_if(),
            replay: Some(self.player.shown(&picture)),
            ..crate::view::tests::view(&picture)
        };
        let layouts = built_in();
        let layout = layouts.iter().find(|there| there.name() == layout).unwrap();
        screen::draw(&view, layout, &mut Panels::new(), area, &mut buffer);
        text(&buffer)
    }
}

#[test]
fn stepping_and_playing_and_going_there_show_the_same() {
    let session = session();
    let frame = |arrive: &dyn Fn(&mut Stage)| {
        let mut stage = Stage::of(&session);
        arrive(&mut stage);
        (stage.player.seq(), stage.frame(160, 50))
    };
    for (from, steps) in [(20, 300), (500, 1), (900, 333), (1700, 64), (1000, 800)] {
        let stepped = frame(&|stage| {
            stage.go(from);
            (0..steps).for_each(|_| stage.player.step(1, &mut stage.feed, &mut stage.time).unwrap());
        });
        assert_eq!(stepped.0, from + steps);
        let played = frame(&|stage| {
            stage.go(from);
            (0..4 * steps).for_each(|_| stage.play(0.25));
        });
        let gone = frame(&|stage| {
            stage.go(from + steps);
        });
        assert_eq!(stepped, played);
        assert_eq!(stepped, gone);
    }
}

#[test]
fn playing_takes_the_time_it_took_and_ends_at_the_end() {
    let session = session();
    let mut stage = Stage::of(&session);
    let now = Instant::now();
    stage.player.toggle(&mut stage.feed, &mut stage.time, now).unwrap();
    let tick = |stage: &mut Stage, ms| {
        let shows = stage.player.tick(&mut stage.feed, &mut stage.time, now + Duration::from_millis(ms)).unwrap();
        (shows, stage.player.seq())
    };
    assert_eq!(tick(&mut stage, 100), (true, 200));
    (0..20).for_each(|_| stage.player.change_speed(1));
    assert_eq!(stage.player.speed(), SPEEDS[SPEEDS.len() - 1]);
    (0..99).for_each(|_| stage.player.change_speed(-1));
    assert_eq!((stage.player.speed(), tick(&mut stage, 200)), (0.1, (true, 220)));
    (0..99).for_each(|_| stage.player.change_speed(1));
    let last = session.states[session.states.len() - 1].seq();
    assert_eq!((tick(&mut stage, 2000), stage.player.is_playing()), ((true, last), false));
    assert_eq!(tick(&mut stage, 9000), (false, last));
    // From there it begins again.
    stage.player.toggle(&mut stage.feed, &mut stage.time, now).unwrap();
    assert_eq!((stage.player.seq(), stage.player.is_playing()), (0, true));
}

#[test]
fn a_loop_is_not_left() {
    let session = session();
    let mut stage = Stage::of(&session);
    stage.go(400);
    stage.player.mark_loop();
    stage.go(300);
    stage.player.mark_loop();
    assert_eq!(stage.player.repeat, Repeat::Over(300, 400));
    let mut seen = Vec::new();
    for at in 0..500 {
        stage.play(0.5 + f64::from(at % 37) * 1.7);
        seen.push(stage.player.seq());
    }
    assert!(seen.iter().all(|seq| (300..=400).contains(seq)), "{seen:?}");
    assert!(seen.windows(2).filter(|pair| pair[1] < pair[0]).count() > 10);
    assert_eq!(stage.player.mark_loop(), "no loop");
    // A loop that ends with the recording turns there.
    let last = session.states[session.states.len() - 1].seq();
    stage.go(last - 50);
    stage.player.mark_loop();
    stage.go(last);
    stage.player.mark_loop();
    (0..50).for_each(|_| stage.play(7.3));
    assert!((last - 50..=last).contains(&stage.player.seq()));
}

#[test]
fn what_if_nothing_had_been_changed_is_what_happened_to_the_last_bit() {
    repeats(&session());
}

#[test]
fn what_if_is_exact_too_where_steps_were_made_of_substeps() {
    let session = whole(0.2);
    let made: Vec<u32> = session.events.iter().filter(|event| event.kind <= 2).map(|event| event.substeps).collect();
    assert!(made.iter().all(|substeps| *substeps > 1) && made.iter().any(|n| *n != made[0]), "{made:?}");
    repeats(&session);
}

#[test]
fn what_if_refuses_what_the_bench_would() {
    let mut stage = Stage::of(&session());
    stage.go(300);
    let refused = stage.edit(&Edit::Nudge(key("cd"), 999_000.0)).unwrap_err();
    assert!(refused.contains("is too long for the mode at"), "{refused}");
    stage.edit(&Edit::Nudge(key("kd"), 0.25)).unwrap();
    let refused = stage.edit(&Edit::Nudge(key("cd"), 999_000.0)).unwrap_err();
    assert!(refused.contains("at 2000 steps a second there is time for"), "{refused}");
}

fn repeats(session: &Session) {
    let last = session.states[session.states.len() - 1].seq();
    let tripped = session.states.iter().find(|state| state.flags().has(Flags::TRIPPED)).expect("a trip").seq();
    for from in [0, 1, 149, 150, 151, 200, 333, 480, 700, 703, 810, tripped - 1, tripped, tripped + 5, last - 100] {
        let mut stage = Stage::of(session);
        stage.go(from);
        stage.edit(&Edit::Nudge(key("kd"), 0.25)).unwrap();
        stage.edit(&Edit::Undo).unwrap();
        stage.go(last);
        let branch = stage.player.branch.as_ref().unwrap();
        for state in session.states.iter().filter(|state| state.seq() >= from) {
            for (mass, point) in state.points().enumerate() {
                let beside = branch.place(state.seq(), mass).map(|place| place.map(f64::to_bits));
                let happened = Some([point.y.to_bits(), point.z.to_bits()]);
                assert_eq!(beside, happened, "mass {mass} at step {} from {from} on", state.seq());
            }
            let force = branch.force(state.seq()).map(|force| force.map(f64::to_bits));
            assert_eq!(force, Some(state.force_delivered().map(f64::to_bits)), "step {} from {from} on", state.seq());
        }
    }
}

#[test]
fn a_recording_that_begins_late_is_run_on_from_up_to_rounding() {
    let mut session = session();
    session.states.retain(|state| state.seq() >= 60);
    let mut stage = Stage::of(&session);
    stage.go(100);
    stage.edit(&Edit::Set(vec![(key("speed"), 2.5)])).unwrap();
    stage.go(300);
    let branch = stage.player.branch.as_ref().unwrap();
    let there = session.states.iter().find(|state| state.seq() == 300).unwrap();
    let [y, z] = branch.place(300, 1).unwrap();
    assert!((y - there.point(1).y).abs() < 1e-12 && (z - there.point(1).z).abs() < 1e-12);
}

#[test]
fn other_gains_are_run_on_beside_what_happened_until_they_are_dropped() {
    let session = session();
    let mut stage = Stage::of(&session);
    stage.go(100);
    assert!(stage.edit(&Edit::Undo).is_err() && stage.player.branch.is_none());
    assert!(stage.edit(&Edit::Set(vec![(key("speed"), -1.0)])).is_err() && stage.player.branch.is_none());
    stage.edit(&Edit::Off).unwrap();
    stage.edit(&Edit::Set(vec![(key("trip"), 1.5)])).unwrap();
    stage.go(330);
    let frame = stage.frame(200, 50);
    assert!(frame.contains("WHAT IF from tau 1.0100: min damping -0."), "{frame}");
    assert!(frame.contains("TRIPS") && frame.contains('◆'), "{frame}");
    let branch = stage.player.branch.as_ref().unwrap();
    let there = &session.states[330];
    assert_ne!(branch.place(330, 0), Some([there.point(0).y, there.point(0).z]));
    assert_eq!(branch.place(99, 0), None);
    // What is edited is what is run on with; what was changed later in the recording is changed here too.
    assert_eq!(stage.feed.settings().unwrap().trip, 1.5);
    stage.go(500);
    assert_eq!(stage.feed.settings().unwrap().speed, 3.0);
    // An edit at what was before it moves it there.
    stage.go(50);
    stage.edit(&Edit::Nudge(key("trip"), 1.0)).unwrap();
    assert_eq!(stage.player.branch.as_ref().unwrap().from(), 50);
    assert_eq!(stage.feed.settings().unwrap().trip, 2.5);
    stage.edit(&Edit::Nudge(key("kd"), 0.5)).unwrap();
    assert_eq!(stage.feed.settings().unwrap().get(key("kd")).unwrap(), 0.5, "0 is where control was off");
    assert!(stage.player.drop_branch(&mut stage.feed, &mut stage.time).unwrap());
    assert!(!stage.frame(200, 50).contains("WHAT IF"));
    assert_eq!(stage.feed.settings().unwrap().trip, 1000.0);
}

/// Alarms stand as the recorder saw them at the moment, in their panel, on the line of time and among the events.
#[test]
fn what_was_alarmed_then_is_alarmed_there() {
    let session = session();
    let turns = session.turns();
    let rise = turns.iter().find(|turn| turn.level == Level::Alarm).expect("an orbit past its limit");
    let there = &session.states[rise.at.seq as usize];
    let radius = there.largest_radius();
    assert_eq!((radius, rise.watch), (rise.value, Watch::Orbit));
    let mut stage = Stage::of(&session);
    let operator = |stage: &Stage| stage.frame_of("operator", 200, 60);
    stage.go(rise.at.seq - 1);
    assert!(!operator(&stage).contains("!! ALARM"), "{}", operator(&stage));
    stage.go(rise.at.seq);
    let frame = operator(&stage);
    assert!(frame.lines().next().unwrap().trim_end().ends_with("!! ALARM orbit"), "{frame}");
    let events = stage.frame_of("replay", 200, 60);
    assert!(events.contains("!! alarm: orbit"), "{events}");
    let row = frame
        .lines()
        .find(|line| line.contains("orbit ") && line.contains("2.5000"))
        .unwrap_or_else(|| panic!("{frame}"));
    assert!(row.contains("!! ALARM"), "{frame}");
    // Back again: it has not happened yet.
    stage.go(rise.at.seq - 1);
    assert!(!operator(&stage).contains("!! ALARM"));
    let ended = turns.iter().find(|turn| !turn.rises() && turn.at.seq > rise.at.seq).expect("it comes back");
    stage.go(ended.at.seq);
    assert!(!operator(&stage).lines().next().unwrap().contains("ALARM"));
    stage.go(rise.at.seq - 1);
    let told = stage.player.go_to_event(1, &mut stage.feed, &mut stage.time).unwrap();
    assert_eq!((stage.player.seq(), told.contains("alarm: orbit")), (rise.at.seq, true), "{told}");
}

/// Poles, damping and damping over speed of the machine beside stand beside those of the recorded one.
#[test]
fn the_poles_of_what_if_stand_beside_those_that_were() {
    let session = session();
    let mut stage = Stage::of(&session);
    stage.go(100);
    let ghosts = |stage: &Stage| stage.frame_of("replay", 200, 60).matches('◇').count();
    let before = ghosts(&stage);
    stage.edit(&Edit::Off).unwrap();
    let off = stage.player.what_if().unwrap().clone();
    assert!(off.is_unstable() && off.poles.len() == 6);
    let frame = stage.frame_of("replay", 200, 60);
    // Ghosts among the poles and at the foot of the second curve; the damping of both.
    assert!(ghosts(&stage) >= before + 6, "{frame}");
    assert!(
        frame.contains(&format!("WHAT IF from tau 1.0100: min damping {:.4} beside 0.0", off.min_damping)),
        "{frame}"
    );
    let overview = stage.frame(200, 50);
    assert!(overview.contains(&format!("what if {:.4} UNSTABLE", off.min_damping)), "{overview}");
    let over_speed = stage.frame_of("tuning", 200, 60);
    assert!(over_speed.contains(&format!("? {:.4} UNSTABLE", off.min_damping)), "{over_speed}");
    stage.player.drop_branch(&mut stage.feed, &mut stage.time).unwrap();
    assert_eq!(ghosts(&stage), before);
}

/// The session's machine at rest for two million steps, made as they are asked for.
struct Long(Session);

impl Past for Long {
    fn name(&self) -> String {
        "long".into()
    }

    fn span(&self) -> Option<[Moment; 2]> {
        Some([0, 1_999_999].map(|seq| Moment { seq, ..Moment::default() }))
    }

    fn visit(&mut self, range: std::ops::Range<u64>, each: &mut dyn FnMut(&State)) -> Result<(), OutsideError> {
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

    fn events(&self) -> Vec<PastEvent> {
        Vec::new()
    }

    fn turns(&self) -> Vec<Turn> {
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

    fn at_tau(&mut self, _: f64) -> Result<u64, OutsideError> {
        Ok(0)
    }
}

/// However far it is, the machine beside arrives, says how far it has come, and remembers no more than it must. Where it has
/// been and is gone to again, it is what it was.
#[test]
fn a_long_way_is_gone_in_stages_and_what_is_forgotten_is_run_anew() {
    let (mut feed, mut time) = (Feed::with_bound("", 60_000_000), ViewTime::LIVE);
    let player = Player::new(Box::new(Long(session())), &mut feed, &mut time).unwrap();
    let mut stage = Stage { player, feed, time };
    let operator = stage.frame_of("operator", 200, 60);
    assert!(operator.contains("recorded without alarms"), "nobody judged it: {operator}");
    stage.edit(&Edit::Nudge(key("kd"), 0.25)).unwrap();
    let arrive = |stage: &mut Stage, seq: u64| {
        stage.go(seq);
        let mut stages = 0;
        while stage.player.tick(&mut stage.feed, &mut stage.time, Instant::now()).unwrap() {
            stages += 1;
        }
        let branch = stage.player.branch.as_ref().unwrap();
        let bits = |back: u64| branch.place(seq - back, 2).map(|place| place.map(f64::to_bits));
        let known: Vec<_> = [0, 1, 999, 9999].map(bits).into_iter().collect();
        assert!(known.iter().all(Option::is_some), "{seq}: {known:?}");
        (known, stages)
    };
    let near = arrive(&mut stage, 150_000).0;
    stage.go(1_900_000);
    let frame = stage.frame(200, 50);
    assert!(frame.contains("WHAT IF from tau 0.0100: running on, 18 % of the way"), "{frame}");
    let (far, stages) = arrive(&mut stage, 1_900_000);
    assert!(stages > 5, "{stages}");
    assert!(stage.frame(200, 50).contains("beside"));
    assert_eq!(stage.player.branch.as_ref().unwrap().place(150_000, 2), None, "forgotten");
    let (again, stages) = arrive(&mut stage, 150_000);
    assert_eq!((again, stages), (near, 0), "run anew from not far before");
    let (again, stages) = arrive(&mut stage, 1_900_000);
    assert!(again == far && stages < 4, "{stages}");
}

#[test]
fn events_are_gone_to_in_order_and_back() {
    let session = session();
    let mut stage = Stage::of(&session);
    let mut words = Vec::new();
    while let Ok(told) = stage.player.go_to_event(1, &mut stage.feed, &mut stage.time) {
        words.push((stage.player.seq(), told));
    }
    let at = |text: &str| words.iter().position(|(_, told)| told.contains(text)).unwrap_or_else(|| panic!("{words:?}"));
    assert!(at("note: now it is faster by test (to see)") < at("restarted from rest"));
    let trip = session.events.iter().find(|event| event.kind == 6).unwrap();
    assert!(words.iter().any(|(seq, told)| *seq == trip.seq && told.contains("tripped: orbit of mass")));
    let mut back = Vec::new();
    while stage.player.go_to_event(-1, &mut stage.feed, &mut stage.time).is_ok() {
        back.push(stage.player.seq());
    }
    assert!(back.windows(2).all(|pair| pair[1] < pair[0]) && back.len() + 1 >= words.len());
    stage.player.go_to_tau(1.0, &mut stage.feed, &mut stage.time).unwrap();
    let tau = session.states[stage.player.seq() as usize].tau();
    assert!(tau <= 1.0 && tau > 0.98, "{tau}");
    // A trip is shown as it was then.
    stage.go(trip.seq);
    assert!(stage.frame(200, 50).contains("TRIPPED: orbit of mass"));
    stage.go(trip.seq - 1);
    assert!(!stage.frame(200, 50).contains("TRIPPED"));
}

#[test]
fn what_is_missing_is_passed_over_and_said() {
    let mut session = session();
    session.states.retain(|state| !(200..600).contains(&state.seq()) && state.seq() != 700);
    let mut stage = Stage::of(&session);
    stage.go(190);
    (0..15).for_each(|_| stage.play(1.0));
    assert_eq!(stage.player.seq(), 605);
    let frame = stage.frame(200, 50);
    assert!(frame.contains("401 steps are missing") && frame.contains('░'), "{frame}");
    stage.go(300);
    assert_eq!(stage.feed.picture(&stage.time, Instant::now()).now.map(|_| ()), Some(()));
    for seq in [199, 200, 599, 600, 699, 700, 701] {
        let place = stage.go(seq).player.loaded.place_of(seq).unwrap();
        let there = stage.player.loaded.seq_of(place);
        let before = session.states.iter().rev().find(|state| state.seq() <= seq).unwrap();
        assert_eq!(there, before.seq());
    }
}

#[test]
fn an_empty_recording_is_refused_and_every_small_screen_is_drawn() {
    let session = session();
    let empty = Session { states: Vec::new(), ..session.clone() };
    let refused = Player::new(Box::new(empty), &mut Feed::new(""), &mut ViewTime::LIVE.clone()).err();
    assert_eq!(refused.as_deref(), Some("there are no steps in it"));
    let mut stage = Stage::of(&session);
    stage.go(300);
    stage.edit(&Edit::Off).unwrap();
    stage.go(500);
    for (width, height) in [(0, 0), (3, 2), (60, 16), (60, 17), (80, 24), (61, 200), (500, 10)] {
        stage.frame(width, height);
    }
    // One step is a recording too.
    let one = Session { states: session.states[7..8].to_vec(), ..session };
    let mut stage = Stage::of(&one);
    stage.play(5.0);
    assert_eq!(stage.player.seq(), 7);
    stage.frame(80, 24);
}

/// Everything that a long recording is made of, in little memory: jumps forget, and going on adds.
#[test]
fn a_recording_longer_than_what_is_kept_is_played_all_the_same() {
    let session = session();
    let mut long = session.clone();
    long.events.truncate(1);
    long.states = (0..60_000_u64)
        .map(|seq| {
            let tau = (seq + 1) as f64 * 0.01;
            let state = session.states[0].with_word(Channel::Seq, seq).with_word(Channel::Revision, 1);
            let state =
                state.with(Channel::Tau, 0, tau).with(Channel::Angle, 0, 2.5 * tau).with(Channel::Speed, 0, 2.5);
            state.with(Channel::Y, 0, seq as f64)
        })
        .collect();
    let (mut feed, mut time) = (Feed::with_bound("", 6_000_000), ViewTime::LIVE);
    let mut player = Player::new(Box::new(long), &mut feed, &mut time).unwrap();
    for seq in [0, 59_999, 30_000, 29_000, 31_000, 12, 45_678] {
        player.go(seq, &mut feed, &mut time).unwrap();
        let picture = feed.picture(&time, Instant::now());
        assert_eq!(picture.now.map(|now| picture.track.place(now, 0)[0]), Some(seq as f64));
    }
    for _ in 0..100 {
        player.play(143.0, &mut feed, &mut time).unwrap();
        let picture = feed.picture(&time, Instant::now());
        assert_eq!(picture.now.map(|now| picture.track.place(now, 0)[0]), Some(player.seq() as f64));
    }
    let kept = feed.history().places();
    assert!(kept.end - kept.start <= feed.history().room_for(3) + 2048, "{kept:?}");
}
