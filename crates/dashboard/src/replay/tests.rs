//! What a recording of a real simulation looks like on the screen.

use std::time::Instant;

use alarms::{Level, Watch};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use rotor::Key;
use telemetry::edits::Edit;
use telemetry::feed::Feed;
use telemetry::replay::{Player, RecordingSource};
use telemetry::test_support::{Long, Session, Stage, session};
use telemetry::view_time::ViewTime;
use wire::Step;

use crate::layout::built_in;
use crate::panels::registry::Panels;
use crate::screen;
use crate::screenshot::image::text;
use crate::view::View;

fn key(name: &str) -> Key {
    name.parse().unwrap()
}

/// What is on the screen.
trait Framed {
    fn frame(&self, width: u16, height: u16) -> String;
    fn frame_of(&self, layout: &str, width: u16, height: u16) -> String;
}

impl Framed for Stage {
    fn frame(&self, width: u16, height: u16) -> String {
        self.frame_of("overview", width, height)
    }

    fn frame_of(&self, layout: &str, width: u16, height: u16) -> String {
        let area = Rect::new(0, 0, width, height);
        let mut buffer = Buffer::empty(area);
        let mut data = self.feed.frame_data(&self.time, Instant::now());
        self.player.adapt(&mut data);
        let view = View {
            time: &self.time,
            alarms: self.player.alarms(),
            what_if: self.player.what_if(),
            replay: Some(self.player.status(&data)),
            ..crate::view::tests::view(&data)
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
fn what_is_run_on_beside_is_told_until_it_is_dropped() {
    let mut stage = Stage::of(&session());
    stage.go(100);
    stage.edit(&Edit::Off).unwrap();
    stage.edit(&Edit::Set(vec![(key("trip"), 1.5)])).unwrap();
    stage.go(330);
    let frame = stage.frame(200, 50);
    assert!(frame.contains("WHAT IF from tau 1.0100: min damping -0."), "{frame}");
    assert!(frame.contains("TRIPS") && frame.contains('◆'), "{frame}");
    assert!(stage.player.drop_branch(&mut stage.feed, &mut stage.time).unwrap());
    assert!(!stage.frame(200, 50).contains("WHAT IF"));
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
    let pole_trace = stage.frame_of("tuning", 200, 60);
    assert!(pole_trace.contains(&format!("? {:.4} UNSTABLE", off.min_damping)), "{pole_trace}");
    stage.player.drop_branch(&mut stage.feed, &mut stage.time).unwrap();
    assert_eq!(ghosts(&stage), before);
}

#[test]
fn a_trip_is_shown_as_it_was_then() {
    let session = session();
    let trip = session.events.iter().find(|event| event.kind == 6).unwrap();
    let mut stage = Stage::of(&session);
    stage.go(trip.seq);
    assert!(stage.frame(200, 50).contains("TRIPPED: orbit of mass"));
    stage.go(trip.seq - 1);
    assert!(!stage.frame(200, 50).contains("TRIPPED"));
}

#[test]
fn what_is_missing_is_said() {
    let mut session = session();
    session.states.retain(|state| !(200..600).contains(&state.seq()) && state.seq() != 700);
    let mut stage = Stage::of(&session);
    stage.go(605);
    let frame = stage.frame(200, 50);
    assert!(frame.contains("401 steps are missing") && frame.contains('░'), "{frame}");
}

#[test]
fn every_small_screen_is_drawn() {
    let session = session();
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

#[test]
fn a_machine_beside_that_lags_says_how_far_it_has_come() {
    let (mut feed, mut time) = (Feed::new(""), ViewTime::LIVE);
    let player = Player::new(Box::new(Long::new(session())), &mut feed, &mut time).unwrap();
    let mut stage = Stage { player, feed, time };
    let operator = stage.frame_of("operator", 200, 60);
    assert!(operator.contains("recorded without alarms"), "nobody judged it: {operator}");
    stage.edit(&Edit::Nudge(key("kd"), 0.25)).unwrap();
    stage.go(1_900_000);
    let frame = stage.frame(200, 50);
    assert!(frame.contains("WHAT IF from tau 0.0100: running on, "), "{frame}");
    while stage.player.tick(&mut stage.feed, &mut stage.time, Instant::now()).unwrap() {}
    assert!(stage.frame(200, 50).contains("beside"));
}
