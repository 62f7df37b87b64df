//! The key that records the bench.

use super::App;
use crate::view::Message;
use telemetry::processes::{RecorderNews, RecorderProcess};
use telemetry::reader::lock;

impl<'a> App<'a> {
    /// The same with somebody who can record.
    pub(crate) fn recording_with(self, recorder_process: Option<&'a mut dyn RecorderProcess>) -> Self {
        Self { recorder_process, ..self }
    }

    /// Starts a recording, or ends the one that was started here. With `past`, so many seconds of what is kept in memory go before it.
    pub(super) fn record(&mut self, past: Option<f64>) {
        let others = lock(&self.feed)
            .recorder()
            .filter(|status| status.is_recording())
            .map(|status| format!("recorded already by process {}, in {}", status.pid, status.path.as_str()));
        let told = match (&mut self.recorder_process, others) {
            (None, _) if self.player.is_some() => Message::Bad("what is played is recorded already".into()),
            (None, _) => {
                Message::Bad("nobody here can record: `whirl record FILE.rrd` does, from another terminal".into())
            }
            (Some(recorder_process), _) if recorder_process.is_running() && past.is_some() => {
                Message::Bad("a recording is under way: r ends it".into())
            }
            (Some(recorder_process), _) if recorder_process.is_running() => {
                recorder_process.stop();
                Message::Good("the recording ends: what has been heard is being written".into())
            }
            (_, Some(others)) => Message::Bad(others),
            (Some(recorder_process), None) => match recorder_process.start(past.is_some()) {
                Ok(file) => {
                    self.past_to_record = past;
                    Message::Good(format!("a recording starts in {file}"))
                }
                Err(why) => Message::Bad(why.to_string()),
            },
        };
        self.tell(told);
    }

    /// Says what has become of a recording. Returns whether there is news.
    pub(super) fn watch_recorder(&mut self) -> bool {
        let Some(recorder_process) = &mut self.recorder_process else { return false };
        // What is kept ends where the recording begins: up to there it may be still on its way to us.
        if let (Some(before), Some(seconds)) = (recorder_process.wants_past_before(), self.past_to_record)
            && let Some(past) = lock(&self.feed).past(seconds, before)
        {
            self.past_to_record = None;
            recorder_process.put_past(past);
        }
        let Some(news) = self.recorder_process.as_mut().and_then(|recorder_process| recorder_process.news()) else {
            return false;
        };
        self.tell(match news {
            RecorderNews::Records(file) => Message::Good(format!("records in {file}: r ends it")),
            RecorderNews::Past(Ok(words)) => Message::Good(words),
            RecorderNews::Past(Err(why)) => Message::Bad(format!("what is kept was not written: {why}")),
            RecorderNews::Ended(Ok(words)) => Message::Good(words),
            RecorderNews::Ended(Err(why)) => Message::Bad(format!("the recording failed: {why}")),
        });
        true
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use crossbeam::channel;
    use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
    use ratatui::buffer::Buffer;
    use ratatui::layout::Rect;
    use wire::{RecorderState, RecorderStatus, Text};

    use super::*;
    use crate::actions::Action;
    use crate::options::Options;
    use crate::screenshot::image::text;
    use telemetry::feed::Feed;
    use telemetry::past::Past;
    use telemetry::processes::OpaqueError;
    use wire::Step;

    #[derive(Default)]
    struct Writer {
        at_work: bool,
        /// It has not said yet that it records, and for so many looks it will not.
        silent: Option<u32>,
        asked: bool,
        refuses: bool,
        wants_past: bool,
        /// The numbers of the steps that were put before the recording.
        past: Vec<u64>,
    }

    impl RecorderProcess for Writer {
        fn start(&mut self, past: bool) -> Result<String, OpaqueError> {
            self.wants_past = past;
            if self.refuses {
                return Err(OpaqueError::new("recordings need another build"));
            }
            self.at_work = true;
            self.silent.get_or_insert(0);
            Ok("s.rrd".into())
        }

        fn wants_past_before(&self) -> Option<u64> {
            self.wants_past.then_some(40)
        }

        fn put_past(&mut self, past: Past) {
            self.wants_past = false;
            self.past = past.steps.states().map(|state| state.seq()).collect();
        }

        fn is_starting(&self) -> bool {
            self.at_work && self.silent.is_some()
        }

        fn stop(&mut self) {
            self.asked = true;
        }

        fn is_running(&self) -> bool {
            self.at_work
        }

        fn news(&mut self) -> Option<RecorderNews> {
            if let Some(left) = self.silent.filter(|_| self.at_work) {
                self.silent = left.checked_sub(1);
                return (left == 0).then(|| RecorderNews::Records("s.rrd".into()));
            }
            let ended = std::mem::take(&mut self.asked);
            self.at_work &= !ended;
            ended.then(|| RecorderNews::Ended(Ok("recorded s.rrd".into())))
        }
    }

    fn app<'a>(writer: &'a mut Writer, recorder: Option<RecorderStatus>) -> App<'a> {
        let mut feed = Feed::new("");
        feed.set_recorder(recorder.map(Box::new));
        let (edits, _taken) = channel::bounded(8);
        App::new(
            "default".into(),
            Arc::new(Mutex::new(feed)),
            edits,
            None,
            telemetry::jobs::Jobs::inline(),
            Arc::default(),
            &Options::default(),
        )
        .recording_with(Some(writer))
    }

    /// Presses `r` so many times, with a tick after each; returns what was said last before and after the tick.
    fn pressed(writer: &mut Writer, times: usize, recorder: Option<RecorderStatus>) -> (Message, Message) {
        let mut app = app(writer, recorder);
        let mut said = None;
        for _ in 0..times {
            app.press(KeyEvent::new(KeyCode::Char('r'), KeyModifiers::NONE));
            let before = app.message.0.clone();
            app.tick();
            said = Some((before, app.message.0.clone()));
        }
        said.unwrap()
    }

    #[test]
    fn a_key_starts_and_ends_a_recording() {
        let mut writer = Writer::default();
        assert_eq!(pressed(&mut writer, 1, None).1, Message::Good("records in s.rrd: r ends it".into()));
        assert!(writer.at_work);
        let mut writer = Writer::default();
        let (before, after) = pressed(&mut writer, 2, None);
        assert!(matches!(before, Message::Good(words) if words.starts_with("the recording ends")));
        assert_eq!(after, Message::Good("recorded s.rrd".into()));
        assert!(!writer.at_work);
    }

    #[test]
    fn what_is_kept_goes_before_a_recording_as_far_as_it_begins() {
        let mut writer = Writer::default();
        let mut app = app(&mut writer, None);
        let feed = app.feed.clone();
        let send = |steps: std::ops::Range<u64>| {
            let mut feed = lock(&feed);
            feed.push_bench_status(telemetry::test_support::bench_status("three-mass", "composite"));
            for seq in steps {
                feed.push_step(&telemetry::test_support::state(3, seq), std::time::Instant::now());
            }
        };
        send(0..30);
        app.act(Action::RecordLast(600.0));
        assert!(app.watch_recorder() && app.past_to_record.is_some(), "step 39 has not come");
        send(30..50);
        app.watch_recorder();
        assert!(app.past_to_record.is_none());
        app.act(Action::RecordLast(600.0));
        assert_eq!(app.message.0, Message::Bad("a recording is under way: r ends it".into()));
        assert_eq!(writer.past, (0..40).collect::<Vec<u64>>());
    }

    #[test]
    fn nobody_waits_for_a_recorder_and_a_sign_says_that_it_starts() {
        let mut writer = Writer { silent: Some(2), ..Writer::default() };
        let mut app = app(&mut writer, None);
        let frame = |app: &mut App<'_>| {
            let mut buffer = Buffer::empty(Rect::new(0, 0, 160, 24));
            app.render(buffer.area, &mut buffer);
            text(&buffer)
        };
        app.press(KeyEvent::new(KeyCode::Char('r'), KeyModifiers::NONE));
        assert_eq!(app.message.0, Message::Good("a recording starts in s.rrd".into()));
        for _ in 0..2 {
            assert!(frame(&mut app).lines().next().unwrap().contains("● REC starting"), "{}", frame(&mut app));
            assert!(!app.watch_recorder());
        }
        assert!(app.watch_recorder());
        assert_eq!(app.message.0, Message::Good("records in s.rrd: r ends it".into()));
        assert!(!frame(&mut app).contains("starting"));
    }

    #[test]
    fn what_stands_in_the_way_is_said() {
        let mut writer = Writer { refuses: true, ..Writer::default() };
        assert_eq!(pressed(&mut writer, 1, None).0, Message::Bad("recordings need another build".into()));
        let mut status = RecorderStatus { pid: 42, path: Text::new("/tmp/x.rrd"), ..RecorderStatus::default() };
        status.set_state(RecorderState::Recording);
        let mut writer = Writer::default();
        let told = pressed(&mut writer, 1, Some(status)).0;
        assert_eq!(told, Message::Bad("recorded already by process 42, in /tmp/x.rrd".into()));
        status.set_state(RecorderState::Died);
        assert!(matches!(pressed(&mut writer, 1, Some(status)).0, Message::Good(_)));
    }
}
