//! Recordings with snapshots: whatever a loop holds, what if nothing had been changed is what happened to the last bit.

use std::ops::Range;

use alarms::{LevelChange, Limits};
use machine::{Excitation, Machine, Multisine, Pace, Program, StateWords};
use rotor::file::{read_feedback, write_feedback};
use rotor::{C64, Rotor, Settings, builtin};
use wire::message::Flags;
use wire::{BenchStatus, Channel, Happening, Moment, Point, SettingsDocument, State, Step, StepLayout};

use crate::processes::OpaqueError;

use super::{Player, RecordedEvent, RecordedKind, RecordingSource};
use crate::edits::Edit;
use crate::feed::Feed;
use crate::view_time::ViewTime;

const DTAU: f64 = 0.01;
const STEPS: u64 = 1000;
/// Steps from one snapshot to the next, beside those where something was done.
const BETWEEN: u64 = 90;

/// What is done to the machine before a step.
#[derive(Clone)]
enum Done {
    Settings(Settings),
    Impulse(usize, C64),
    Restart,
    Excite(Option<Multisine>),
    /// The excitation is over by itself, or by what else is done at this step.
    ExcitationOver,
}

/// A machine that was stepped as a bench steps it, and written down.
#[derive(Clone)]
struct Recorded {
    rotor: Rotor,
    revisions: Vec<(u64, Settings, u32)>,
    states: Vec<State>,
    events: Vec<RecordedEvent>,
    snapshots: Vec<(u64, Vec<u64>)>,
}

fn state(machine: &Machine, seq: u64, revision: usize) -> State {
    let sample = machine.sample();
    let pair = |z: C64| [z.re, z.im];
    let mut state = State::new(StepLayout::new(sample.displacement.len()));
    let mut row = state.row_mut();
    row.set_word(Channel::Seq, seq);
    row.set_word(Channel::WallNs, seq * 1_000_000);
    row.set_word(Channel::Revision, revision as u64);
    row.set_flags(Flags::contact(sample.contact));
    row.set(Channel::Tau, 0, sample.tau);
    row.set(Channel::Angle, 0, sample.angle);
    row.set(Channel::Speed, 0, sample.speed);
    row.set_pair([Channel::CommandY, Channel::CommandZ], 0, pair(sample.outputs[0].commanded));
    row.set_pair([Channel::ForceY, Channel::ForceZ], 0, pair(sample.outputs[0].delivered));
    for (mass, (p, v)) in sample.displacement.iter().zip(sample.velocity).enumerate() {
        row.set_point(mass, Point { y: p.re, z: p.im, vy: v.re, vz: v.im });
    }
    state
}

/// Changed, struck, sped up, struck, restarted, struck.
fn recorded(settings: &Settings) -> Recorded {
    let rotor = builtin::rotor("three-mass").unwrap();
    let mut settings = settings.clone();
    let mut script = vec![];
    settings.assign("kd", "-0.6").unwrap();
    script.push((150, Done::Settings(settings.clone())));
    script.push((227, Done::Impulse(1, C64::new(1.0, -0.5))));
    settings.speed = 3.0;
    script.push((350, Done::Settings(settings.clone())));
    script.push((460, Done::Impulse(0, C64::new(1.0, -0.5))));
    script.push((665, Done::Restart));
    script.push((702, Done::Impulse(2, C64::new(-0.5, 0.3))));
    let mut begun = settings.clone();
    begun.speed = 2.5;
    begun.assign("kd", "-0.39").unwrap();
    run(rotor, begun, &script)
}

fn run(rotor: Rotor, begun: Settings, script: &[(u64, Done)]) -> Recorded {
    let pace = Pace { dtau: DTAU, rate_hz: 1000.0 };
    let compile = |settings: &Settings, from: f64| Program::compile(&rotor, settings, [from; 2], pace).unwrap();
    let program = compile(&begun, begun.speed);
    let mut revisions = vec![(0, begun, program.substeps())];
    let mut machine = Machine::new(program);
    let (mut states, mut events, mut snapshots) = (Vec::new(), Vec::new(), Vec::new());
    for seq in 0..STEPS {
        let at = Moment { seq, tau: machine.tau(), wall_ns: seq * 1_000_000 };
        let mut changed = seq.is_multiple_of(BETWEEN);
        for (_, done) in script.iter().filter(|(at, _)| *at == seq) {
            changed = true;
            let happening = match done {
                Done::Settings(settings) => {
                    let program = compile(settings, machine.sample().speed);
                    revisions.push((seq, settings.clone(), program.substeps()));
                    machine.load(&mut Box::new(program));
                    Happening::Settings
                }
                Done::Impulse(mass, velocity) => {
                    machine.kick(*mass, *velocity);
                    Happening::Impulse { mass: *mass, velocity: *velocity }
                }
                Done::Restart => {
                    machine.restart();
                    Happening::Restarted
                }
                Done::Excite(Some(multisine)) => {
                    machine.excite(0, &mut Some(Box::new(Excitation::of(multisine).unwrap())));
                    Happening::Excited(multisine.clone())
                }
                Done::Excite(None) => {
                    machine.excite(0, &mut None);
                    Happening::ExcitationOver
                }
                Done::ExcitationOver => Happening::ExcitationOver,
            };
            let what = RecordedKind::Happening(happening);
            events.push(RecordedEvent { at, what, who: "test".into(), why: String::new() });
        }
        if changed {
            let mut words = StateWords::default();
            machine.save(&mut words);
            snapshots.push((seq, words.as_slice().to_vec()));
        }
        assert_eq!(machine.step(), None);
        states.push(state(&machine, seq, revisions.len()));
    }
    Recorded { rotor, revisions, states, events, snapshots }
}

impl RecordingSource for Recorded {
    fn name(&self) -> String {
        "recorded".into()
    }

    fn span(&self) -> Option<[Moment; 2]> {
        Some([self.states.first()?.into(), self.states.last()?.into()])
    }

    fn visit(&mut self, range: Range<u64>, each: &mut dyn FnMut(&State)) -> Result<(), OpaqueError> {
        self.states.iter().filter(|state| range.contains(&state.seq())).for_each(each);
        Ok(())
    }

    fn bench_status_at(&mut self, seq: u64) -> Box<BenchStatus> {
        let after = self.revisions.partition_point(|(from, ..)| *from <= seq);
        let (from, settings, substeps) = &self.revisions[after - 1];
        let mut bench_status = Box::<BenchStatus>::default();
        bench_status.set_rotor(&self.rotor);
        bench_status.settings = SettingsDocument::of(settings);
        (bench_status.revision, bench_status.applied_at_step, bench_status.substeps) = (after as u64, *from, *substeps);
        (bench_status.dtau, bench_status.rate_hz) = (DTAU, 1000.0);
        bench_status
    }

    fn changes(&self) -> Vec<u64> {
        self.revisions.iter().map(|(from, ..)| *from).collect()
    }

    fn events(&self) -> Vec<RecordedEvent> {
        self.events.clone()
    }

    fn turns(&self) -> Vec<LevelChange> {
        Vec::new()
    }

    fn limits(&self) -> Option<Limits> {
        None
    }

    fn missing(&self) -> Vec<Range<u64>> {
        Vec::new()
    }

    fn notices(&self) -> Vec<String> {
        Vec::new()
    }

    fn snapshot_before(&mut self, seq: u64) -> Result<Option<(u64, Vec<u64>)>, OpaqueError> {
        Ok(self.snapshots.iter().rfind(|(next, _)| *next <= seq).cloned())
    }

    fn at_tau(&mut self, _: f64) -> Result<u64, OpaqueError> {
        Ok(0)
    }
}

/// From which of these steps what is run on without a change is not what happened.
fn differs(past: &Recorded) -> Vec<u64> {
    let differs = |from: &u64| {
        let (mut feed, mut time) = (Feed::new(""), ViewTime::LIVE);
        let mut player = Player::new(Box::new(past.clone()), &mut feed, &mut time).unwrap();
        player.go(*from, &mut feed, &mut time).unwrap();
        player.edit(&Edit::Nudge("cd".parse().unwrap(), 0.25), &mut feed, &mut time).unwrap();
        player.edit(&Edit::Undo, &mut feed, &mut time).unwrap();
        player.go(STEPS - 1, &mut feed, &mut time).unwrap();
        let branch = player.branch.as_ref().unwrap();
        let is_other = |state: &State| {
            let seq = state.seq();
            let is_there = state.points().enumerate().all(|(mass, point)| {
                let bits = |place: [f64; 2]| place.map(f64::to_bits);
                branch.displacement(seq, mass).map(bits) == Some(bits([point.y, point.z]))
            });
            !(is_there && branch.force(seq, 0) == Some(state.force_delivered()))
        };
        past.states.iter().filter(|state| state.seq() >= *from).any(is_other)
    };
    [0, 1, 149, 150, 200, 351, 400, 480, 664, 665, 702, 850].into_iter().filter(differs).collect()
}

/// Parts of a loop: key and value.
type Parts<'a> = &'a [(&'a str, &'a str)];

/// The composite gains, with parts of the loop by their keys and filters as in a file.
fn with(parts: Parts<'_>, filter: &str) -> Settings {
    let rotor = builtin::rotor("three-mass").unwrap();
    let text = write_feedback(&builtin::feedback(&rotor, "composite").unwrap());
    let text = text.replacen("[[signal]]", &format!("[[signal]]\nfilter = [{filter}]"), 1);
    let mut settings = Settings::new(&rotor, 2.5, read_feedback(&text, Some(3)).unwrap());
    settings.deadband.fill(1.0);
    parts.iter().for_each(|(key, value)| settings.assign(key, value).unwrap());
    settings
}

#[test]
fn what_if_is_exact_with_whatever_the_loop_holds() {
    let lowpass = r#"{ kind = "lowpass", corner = 60.0, order = 3 }"#;
    let filters = r#"{ kind = "lowpass", corner = 60.0, order = 2 }, { kind = "notch", frequency = 9.0, width = 0.2 }"#;
    let every = [
        ("sensor_lag", "0.01"),
        ("noise", "0.001"),
        ("seed", "7"),
        ("quantum", "0.0005"),
        ("delay", "0.012"),
        ("lag", "0.01"),
        ("limit", "5"),
        ("slew", "50"),
    ];
    let sampled = [&every[..], &[("sample", "0.025")]].concat();
    let cases: [(&str, Parts<'_>, &str); 13] = [
        ("ideal", &[], ""),
        ("sensor lag", &[("sensor_lag", "0.02")], ""),
        ("noise", &[("noise", "0.01")], ""),
        ("quantum", &[("quantum", "0.01")], ""),
        ("sampling", &[("sample", "0.033")], ""),
        ("delay", &[("delay", "0.034")], ""),
        ("lag", &[("lag", "0.03")], ""),
        ("lag of second order", &[("lag", "0.03"), ("lag_damping", "0.7")], ""),
        ("force limit", &[("limit", "0.3")], ""),
        ("slew limit", &[("slew", "0.8")], ""),
        ("filters", &[], filters),
        ("everything continuous", &every, lowpass),
        ("everything sampled", &sampled, filters),
    ];
    for (what, parts, filter) in cases {
        for ramp in ["off", "0.4"] {
            let mut settings = with(parts, filter);
            settings.assign("ramp", ramp).unwrap();
            let past = recorded(&settings);
            assert_eq!(differs(&past), [0_u64; 0], "{what}, ramp {ramp}: from these steps on");
        }
    }
}

/// Excited, over by itself; excited, ended by hand; excited, ended by a change; excited, ended by a restart.
fn excited(begun: &Settings) -> Recorded {
    let multisine = |duration| Multisine {
        seed: 1,
        period: 3.0,
        lines: [1, 9],
        tones: 9,
        away_from: 2.5,
        amplitude: 0.01,
        duration,
    };
    let mut settings = begun.clone();
    settings.assign("kd", "-0.6").unwrap();
    let script = vec![
        (120, Done::Excite(Some(multisine(1.0)))),
        (220, Done::ExcitationOver),
        (305, Done::Excite(Some(multisine(9.0)))),
        (377, Done::Excite(None)),
        (410, Done::Excite(Some(multisine(9.0)))),
        (482, Done::Settings(settings)),
        (482, Done::ExcitationOver),
        (600, Done::Excite(Some(multisine(9.0)))),
        (702, Done::Restart),
        (702, Done::ExcitationOver),
        (840, Done::Excite(Some(multisine(9.0)))),
    ];
    run(builtin::rotor("three-mass").unwrap(), begun.clone(), &script)
}

#[test]
fn what_if_is_exact_while_the_loop_is_excited() {
    for parts in [&[][..], &[("delay", "0.034")], &[("sample", "0.033"), ("noise", "0.01")]] {
        let past = excited(&with(parts, ""));
        assert_eq!(differs(&past), [0_u64; 0], "{parts:?}: from these steps on");
    }
}

#[test]
fn without_snapshots_what_if_begins_nowhere_within_an_excitation() {
    let mut past = excited(&with(&[], ""));
    past.snapshots.clear();
    for (seq, begins) in
        [(119, true), (120, false), (218, false), (219, true), (376, false), (481, false), (482, true), (999, false)]
    {
        let (mut feed, mut time) = (Feed::new(""), ViewTime::LIVE);
        let mut player = Player::new(Box::new(past.clone()), &mut feed, &mut time).unwrap();
        player.go(seq, &mut feed, &mut time).unwrap();
        let edited = player.edit(&Edit::Nudge("cd".parse().unwrap(), 0.25), &mut feed, &mut time);
        assert_eq!(edited.is_ok(), begins, "{seq}: {edited:?}");
        assert!(begins || edited.unwrap_err().to_string().contains("excited"), "{seq}");
    }
}

/// As before there were snapshots: where the loop holds nothing a step tells all, else it begins as if at rest.
#[test]
fn without_snapshots_what_if_begins_from_the_step() {
    for (parts, exact) in [(&[][..], true), (&[("delay", "0.034")][..], false)] {
        let mut past = recorded(&with(parts, ""));
        past.snapshots.clear();
        assert_eq!(differs(&past).is_empty(), exact);
    }
}

/// A snapshot that does not lead to the step that was recorded, or is none, is not begun from.
#[test]
fn a_snapshot_that_leads_elsewhere_is_left_alone() {
    let mut past = recorded(&with(&[], ""));
    let others = recorded(&with(&[("delay", "0.034")], "")).snapshots;
    let wrong = |number: usize, words: &[u64]| match number % 3 {
        0 => words[..words.len() / 2].to_vec(),
        1 => others[number].1.clone(),
        _ => words.iter().map(|word| word ^ 1).collect(),
    };
    for (number, (_, words)) in past.snapshots.iter_mut().enumerate() {
        *words = wrong(number, words);
    }
    assert_eq!(differs(&past), [0_u64; 0]);
}
