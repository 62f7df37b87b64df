//! What the promises are tried with: messages that say who they are, and patience.

use std::thread;
use std::time::{Duration, Instant};

use rotor::{Settings, builtin};
use wire::{
    BenchName, BenchStatus, Channel, Happening, Listener, NewsSender, RowMut, SettingsDocument, Step, StepLayout,
};

/// A rotor of three masses.
pub(crate) const LAYOUT: StepLayout = StepLayout::new(3);

pub(crate) const PATIENCE: Duration = Duration::from_secs(5);

pub(crate) fn bench(name: &str) -> BenchName {
    name.parse().unwrap()
}

/// States numbered from `first` on.
pub(crate) fn number(first: u64) -> impl FnMut(usize, &mut RowMut<'_>) {
    move |place, row| {
        let seq = first + place as u64;
        row.set_word(Channel::Seq, seq);
        row.set(Channel::Tau, 0, seq as f64 * 0.5);
    }
}

/// All states that have arrived, by sequence number.
pub(crate) fn drained(listener: &mut impl Listener) -> Vec<u64> {
    let mut seen = Vec::new();
    listener
        .drain(|state| {
            assert_eq!(state.tau(), state.seq() as f64 * 0.5);
            seen.push(state.seq());
        })
        .unwrap();
    seen
}

/// Waits for something that must come.
pub(crate) fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < PATIENCE, "{what} did not come");
        thread::sleep(Duration::from_millis(1));
    }
}

/// All events that have arrived, by number.
pub(crate) fn events(listener: &mut impl Listener) -> Vec<u64> {
    let mut seen = Vec::new();
    listener
        .events(|event| {
            assert_eq!(event.happening(), Some(Happening::Note(format!("number {}", event.number))));
            assert_eq!((event.settings.get().speed, event.who.as_str()), (event.number as f64, "somebody"));
            seen.push(event.number);
        })
        .unwrap();
    seen
}

/// Event `number`, after which the speed is just that.
pub(crate) fn tell(sender: &mut impl NewsSender, number: u64) {
    let mut event = Happening::Note(format!("number {number}")).event();
    event.number = number;
    event.who = wire::Text::new("somebody");
    event.settings = settings(number as f64);
    sender.event(&event).unwrap();
}

pub(crate) fn settings(speed: f64) -> SettingsDocument {
    let rotor = builtin::rotor("jeffcott").unwrap();
    SettingsDocument::of(&Settings::new(&rotor, speed, builtin::feedback(&rotor, "cancel").unwrap()))
}

/// A bench status of the three-mass rotor.
pub(crate) fn bench_status(revision: u64) -> BenchStatus {
    let mut bench_status = BenchStatus::default();
    bench_status.set_rotor(&builtin::rotor("three-mass").unwrap());
    bench_status.settings = settings(revision as f64);
    bench_status.revision = revision;
    bench_status
}
