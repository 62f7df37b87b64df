//! The speed on its way: sent, and stopped by an alarm or a key.

use super::*;

#[test]
fn the_speed_is_sent_on_its_way() {
    let (mut app, taken) = dashboard(&Options::default());
    let set =
        |pairs: &[(&str, f64)]| Edit::Set(pairs.iter().map(|(key, value)| (key.parse().unwrap(), *value)).collect());
    // It spins at 2.5.
    for (line, speed, ramp) in [("run-up 2.5..6 0.01", 6.0, 0.01), ("run-up 0 0.02", 0.0, 0.02)] {
        command(&mut app, line);
        assert_eq!(taken.try_iter().collect::<Vec<_>>(), [set(&[("speed", speed), ("ramp", ramp)])]);
    }
    command(&mut app, "run-up 0..6 0.01");
    assert!(taken.is_empty());
}

#[test]
fn an_alarm_stops_a_run_up_as_configured() {
    use alarms::{Limits, Watch};
    use wire::Channel;
    let mut limits = Limits::none();
    limits.set(Watch::Orbit, Some([1e3, 2e3])).unwrap();
    let alarmed = |on_alarm, rate: f64, read_only| {
        let options = Options { on_alarm, limits: limits.clone(), read_only, ..Options::default() };
        let (mut app, taken) = dashboard(&options);
        let mut step = tests::state(3, 3000).with(Channel::Speed, 0, 2.75).with(Channel::SpeedRate, 0, rate);
        step = step.with(Channel::Y, 1, 1.5e3);
        lock(&app.feed).push_step(&step, Instant::now());
        app.watch_alarms();
        assert!(taken.is_empty(), "a warning stops nothing");
        let step = step.with_word(Channel::Seq, 3001).with(Channel::Y, 1, 3e3);
        lock(&app.feed).push_step(&step, Instant::now());
        app.watch_alarms();
        app.watch_alarms();
        let edits: Vec<Edit> = taken.try_iter().collect();
        let settings = app.settings().unwrap();
        edits
            .into_iter()
            .map(|edit| match edit {
                Edit::Become(change, why) => {
                    assert_eq!(change.0, settings);
                    ([change.1.speed, change.1.ramp], why)
                }
                other => panic!("{other:?}"),
            })
            .collect::<Vec<_>>()
    };
    let before = f64::INFINITY;
    assert_eq!(alarmed(OnAlarm::Hold, 0.01, false), [([2.75, before], "the speed is held: alarm of orbit".to_owned())]);
    let down = "the speed coasts down: alarm of orbit".to_owned();
    assert_eq!(alarmed(OnAlarm::CoastDown, 0.01, false), [([0.0, 0.01], down)]);
    // Nothing to stop, nobody to stop it, or not asked to.
    for (on_alarm, rate, read_only) in [
        (OnAlarm::Hold, 0.0, false),
        (OnAlarm::Hold, -0.01, false),
        (OnAlarm::Hold, 0.01, true),
        (OnAlarm::GoOn, 0.01, false),
    ] {
        assert_eq!(alarmed(on_alarm, rate, read_only), []);
    }
}

#[test]
fn a_key_sends_the_speed_to_rest_as_fast_as_it_rose() {
    use wire::Channel;
    for (rate, ramp) in [(0.01, 0.01), (-0.02, 0.02)] {
        let (mut app, taken) = dashboard(&Options::default());
        let step = tests::state(3, 3000).with(Channel::Speed, 0, 2.75).with(Channel::SpeedRate, 0, rate);
        lock(&app.feed).push_step(&step, Instant::now());
        press(&mut app, &[Char('V')]);
        let edits: Vec<Edit> = taken.try_iter().collect();
        let [Edit::Become(change, why)] = &edits[..] else { panic!("{edits:?}") };
        assert_eq!((change.1.speed, change.1.ramp, &**why), (0.0, ramp, "the speed goes to rest"));
    }
}
