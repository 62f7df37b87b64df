//! The program under test: `whirl` itself, with the same `main`, and one thing more: SIGURG makes it panic, so that
//! what a panic leaves behind can be looked at.

use signal_hook::consts::SIGURG;
use signal_hook::iterator::Signals;

fn main() -> std::process::ExitCode {
    let mut signals = Signals::new([SIGURG]).expect("SIGURG can be handled");
    std::thread::spawn(move || {
        if signals.forever().next().is_some() {
            panic!("a test asked for this panic");
        }
    });
    whirl::main()
}
