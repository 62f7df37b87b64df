//! What keys do on a recording: the loop's side of the player.

use std::time::Instant;

use super::App;
use crate::actions::Action;
use crate::view::Message;
use telemetry::feed::Feed;
use telemetry::reader::lock;
use telemetry::replay::{Player, ReplayError};
use telemetry::view_time::ViewTime;

impl App<'_> {
    /// The same on a recording, which has filled the feed and stands at `time`.
    pub(crate) fn playing(mut self, player: Player, time: ViewTime) -> Self {
        let notices = player.notices();
        if !notices.is_empty() {
            self.tell(Message::Bad(notices.join("; ")));
        }
        Self { player: Some(player), time, ..self }
    }

    /// Has the player do something to the feed and the time; says what comes of it.
    pub(super) fn play<T>(
        &mut self,
        what: impl FnOnce(&mut Player, &mut Feed, &mut ViewTime) -> Result<T, ReplayError>,
    ) -> Option<T> {
        let player = self.player.as_mut()?;
        let done = what(player, &mut lock(&self.feed), &mut self.time);
        done.map_err(|why| self.tell(Message::Bad(why.to_string()))).ok()
    }

    /// An action on a recording. Returns whether it was one that means something else there than on a bench.
    pub(super) fn act_on_recording(&mut self, action: &Action) -> bool {
        if self.player.is_none() {
            if matches!(action, Action::Pace(_) | Action::Event(_) | Action::Loop | Action::GoTo(_) | Action::End(_)) {
                self.tell(Message::Bad("only a recording can be played: `whirl replay FILE.rrd`".into()));
                return true;
            }
            return false;
        }
        let now = Instant::now();
        let told = match *action {
            Action::Pause => self.play(|player, feed, time| player.toggle(feed, time, now)).map(|()| None),
            Action::Seek(by) => self.play(|player, feed, time| player.seek(by, feed, time)).map(|()| None),
            Action::Step(by) => self.play(|player, feed, time| player.step(by, feed, time)).map(|()| None),
            Action::Event(by) => self.play(|player, feed, time| player.go_to_event(by, feed, time)).map(Some),
            Action::End(last) => {
                self.play(|player, feed, time| player.go(player.ends()[usize::from(last)], feed, time)).map(|()| None)
            }
            Action::Loop => self.play(|player, _, _| Ok(player.mark_loop())).map(|words| Some(words.to_owned())),
            Action::Pace(by) => self.play(|player, _, _| {
                player.change_speed(by);
                Ok(Some(format!("{} times as fast as it was", player.speed())))
            }),
            Action::GoTo(tau) => self.play(|player, feed, time| player.go_to_tau(tau, feed, time)).map(|_| None),
            Action::Escape => {
                let dropped = self.play(|player, feed, time| player.drop_branch(feed, time));
                if dropped == Some(false) {
                    self.filter.clear();
                }
                dropped.map(|dropped| dropped.then(|| "what if dropped".to_owned()))
            }
            _ => return false,
        };
        if let Some(Some(words)) = told {
            self.tell(Message::Good(words));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use crossbeam::channel;
    use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

    use super::*;
    use crate::options::Options;
    use telemetry::jobs::Jobs;
    use telemetry::replay::RecordingSource as _;
    use telemetry::test_support::session;
    use wire::Step;

    /// A dashboard on a recording after some keys.
    fn played(keys: &[KeyCode]) -> App<'static> {
        let (mut feed, mut time) = (Feed::new(""), ViewTime::LIVE);
        let player = Player::new(Box::new(session()), &mut feed, &mut time).unwrap();
        let (edits, taken) = channel::bounded(8);
        let feed = Arc::new(Mutex::new(feed));
        let mut app = App::new("memory".into(), feed, edits, None, Jobs::inline(), Arc::default(), &Options::default())
            .playing(player, time);
        for code in keys {
            app.press(KeyEvent::new(*code, KeyModifiers::NONE));
        }
        assert!(taken.is_empty(), "nothing is sent to anybody");
        app
    }

    /// Presses keys on a recording; returns where that leads, what is said, and whether there is something beside.
    fn pressed(keys: &[KeyCode]) -> (u64, bool, Message) {
        let mut app = played(keys);
        let shown = app.with_view(|view, _, _| view.what_if.is_some());
        let player = app.player.as_ref().unwrap();
        assert_eq!(shown, player.has_branch(), "what it means is shown as long as it is there");
        (player.seq(), player.has_branch(), app.message.0.clone())
    }

    #[test]
    fn esc_drops_what_is_beside_first_and_then_the_filter() {
        let keys = [Char('/'), Char('k'), Enter, Char('0'), Esc];
        let app = played(&keys);
        assert!(!app.player.as_ref().unwrap().has_branch());
        assert_eq!(app.filter, "k");
        assert_eq!(played(&[&keys[..], &[Esc]].concat()).filter, "");
    }

    #[test]
    fn settings_are_held_and_swapped_on_a_recording_too() {
        let app = played(&[Char('B'), KeyCode::Right, Char('b')]);
        let (held, now) = (app.held.clone().unwrap(), app.settings().unwrap());
        assert_ne!(held, now);
        assert_eq!(held.speed, now.speed + 0.05, "they have changed places");
    }

    use KeyCode::{Backspace, Char, End, Enter, Esc, Home};

    #[test]
    fn keys_move_through_a_recording() {
        assert_eq!(pressed(&[Char('>'), Char('>'), Char('<')]).0, 1);
        // A second is 2000 steps; ten are more than there are.
        let (last, ..) = pressed(&[Char('}')]);
        assert_eq!((pressed(&[Char(']')]).0, pressed(&[End]).0), (last.min(2000), last));
        assert_eq!(pressed(&[End, Home]).0, 0);
        assert_eq!(pressed(&[End, Char('[')]).0, last.saturating_sub(2000));
        // Event by event as far as the first change of settings.
        let mut steps: Vec<u64> = session().events().iter().map(|event| event.at.seq).filter(|seq| *seq > 0).collect();
        steps.dedup();
        let changed = session().changes()[1];
        let count = steps.iter().position(|seq| *seq == changed).unwrap() + 1;
        let (there, _, told) = pressed(&vec![Char('n'); count]);
        assert_eq!(there, changed);
        assert!(matches!(&told, Message::Good(words) if words.contains("settings changed by test")), "{told:?}");
        let (first, ..) = pressed(&[Char('n')]);
        assert_eq!((first, pressed(&[Char('n'), Char('n'), Char('N')]).0), (steps[0], first));
        assert!(matches!(pressed(&[Char('N')]).2, Message::Bad(words) if words == "no event before this"));
    }

    #[test]
    fn a_moment_that_is_clicked_at_is_where_the_player_goes_on_from() {
        let (mut feed, mut time) = (Feed::new(""), ViewTime::LIVE);
        let player = Player::new(Box::new(session()), &mut feed, &mut time).unwrap();
        let (edits, _taken) = channel::bounded(8);
        let feed = Arc::new(Mutex::new(feed));
        let mut app = App::new("memory".into(), feed, edits, None, Jobs::inline(), Arc::default(), &Options::default())
            .playing(player, time);
        let first = lock(&app.feed).history().kept().start;
        app.look_at(first + 100);
        assert_eq!(app.player.as_ref().unwrap().seq(), 100);
        app.press(KeyEvent::new(Char('>'), KeyModifiers::NONE));
        assert_eq!(app.player.as_ref().unwrap().seq(), 101);
        let tau = session().states[57].tau();
        app.look_when(0, tau);
        let stands = app.player.as_ref().unwrap().seq();
        assert!((session().states[stands as usize].tau() - tau).abs() < 0.0101);
    }

    #[test]
    fn a_time_is_typed_and_gone_to() {
        // tau rises by 0.01 a step, from 0.01 on; the last stretch that reaches 0.5 is that after the last restart.
        let (there, ..) = pressed(&[Char('g'), Char('0'), Char('.'), Char('5'), Char('7'), Backspace, Enter]);
        let session = session();
        assert!((session.states[there as usize].tau() - 0.5).abs() < 0.0101);
        assert_eq!(pressed(&[Char('g'), Char('5'), Esc]).0, 0);
        assert!(
            matches!(pressed(&[Char('g'), Char('-'), Enter]).2, Message::Bad(words) if words == "go '-': expected a number")
        );
        assert!(!pressed(&[Char('g'), Char('0'), Char('0')]).1, "0 is a digit there and turns nothing off");
    }

    #[test]
    fn the_keys_of_a_live_bench_ask_what_if() {
        for keys in [&[Char('0')][..], &[Char('i')], &[Char('R')], &[KeyCode::Right], &[Enter, Char('3'), Enter]] {
            let (_, beside, told) = pressed(keys);
            assert!(beside && matches!(&told, Message::Good(words) if words.starts_with("what if ")), "{told:?}");
            assert!(!pressed(&[keys, &[Esc]].concat()).1);
        }
        assert!(!pressed(&[Char('u')]).1);
    }
}
