//! Layout and configuration files: what is accepted can be shown at every size, and is the same when it is read again.

use dashboard::{Config, LAYOUTS, Layout};

use crate::machine::complains;
use crate::{harness, mutation};

/// Texts of each kind: some seconds of an unoptimised build.
const CASES: u32 = 1000;

fn layout_file(text: &str) {
    match Layout::read("made-up", text) {
        Err(problems) => complains(text, &problems),
        Ok(layout) => {
            let sizes = layout.sizes();
            let (width, height) = *sizes.last().expect("a layout has a screen");
            assert!(width <= 60 && height <= 16, "the last screen needs {width} x {height}");
            let others = [(60, 16), (80, 24), (200, 60), (1, 1), (0, 0), (999, 999)];
            for (width, height) in sizes.iter().copied().chain(others) {
                let panels = layout.panels(width, height);
                assert!(width < 60 || height < 16 || !panels.is_empty(), "nothing at {width} x {height}");
            }
            assert_eq!(Layout::read("made-up", text).as_ref(), Ok(&layout));
        }
    }
}

fn config_file(text: &str) {
    match Config::read(text) {
        Err(problems) => complains(text, &problems),
        Ok(config) => {
            for watch in alarms::Watch::ALL {
                let limits = config.limits.pair(watch);
                assert!(limits.is_none_or(|pair| pair.iter().all(|limit| limit.is_finite())), "{watch}: {limits:?}");
            }
            assert_eq!(Config::read(text).as_ref(), Ok(&config));
        }
    }
}

#[test]
fn no_layout_file_is_stumbled_over() {
    let seeds = LAYOUTS.iter().map(|(_, text)| (*text).to_owned()).collect();
    harness::run("layout", CASES, &mutation::mutated(seeds), layout_file);
}

#[test]
fn no_configuration_file_is_stumbled_over() {
    // As it is printed, and with every line in force.
    let bare =
        |line: &str| line.strip_prefix("# ").filter(|rest| rest.contains(" = ")).unwrap_or(line).to_owned() + "\n";
    let in_force = Config::defaults().lines().map(bare).collect();
    let mine = "layout = \"operator\"\ntheme = \"full\"\nascii = true\n\
                [keys]\nx = \"nudge 5\"\n\"ctrl-x\" = \"layout whirl\"\nf5 = \"\"\n\
                [alarms]\nbell = true\norbit = [2, 3.5]\nlosses = \"off\"\ndamping = [0.05, 0.01]\n";
    let seeds = vec![Config::defaults(), in_force, mine.to_owned()];
    harness::run("configuration", CASES, &mutation::mutated(seeds), config_file);
}
