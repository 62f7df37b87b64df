//! What the dashboard records: its session, and what it has kept from before.

use promises::{Root, Screen};
use tape::Recording;
use wire::Step;

use super::recorder::{info, text};

#[test]
fn a_session_of_the_dashboard_is_recorded_from_its_start_to_its_end() {
    let root = Root::new();
    let path = root.path().join("s.rrd");
    let mut screen = Screen::start(root.path(), &["up", "three-mass", "--record", text(&path)], (120, 40));
    screen.wait_words("RUNNING");
    // A key that comes before the settings are known changes nothing.
    screen.wait_words("rev 1");
    screen.press_for("l", "rev 2");
    screen.press("q");
    screen.ended();
    let told = info(&path);
    assert_eq!((&told["lost"], &told["settings_changes"]), (&0.into(), &1.into()), "{told}");
    let recording = Recording::open(&path).unwrap();
    assert_eq!(recording.events().last().unwrap().happening.name(), "ended");
    assert_eq!(recording.span().unwrap().first.seq, 0, "from the very start");
}

#[test]
fn what_the_dashboard_has_kept_goes_before_a_recording_step_by_step() {
    let root = Root::new();
    let simulation = root.simulate(&["rig", "--speed", "3000"]);
    let mut screen = Screen::start_in(root.path(), root.path(), &["dash"], (120, 40));
    screen.wait_words("RUNNING");
    assert_eq!(root.run(&["set", "left.kd=21000w0^2", "--why", "stiffer"]).code, Some(0));
    screen.wait_words("rev 2");
    screen.press_for(":record last 10min\r", "steps from before");
    screen.press_for("r", "the recording ends");
    screen.wait_words(" lost; asked to stop");
    screen.press("q");
    assert!(screen.ended().success());
    assert_eq!(simulation.end().code, Some(0));
    let mut files: Vec<_> = std::fs::read_dir(root.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "rrd"));
    files.sort();
    assert_eq!(files.len(), 2, "{files:?}");
    // Given either, readers take both: the change that was made before, and no gap.
    let mut all = Vec::new();
    for file in &files {
        let mut recording = Recording::open(file).unwrap();
        // The dashboard came later than the simulation, and a part is read without the other; nothing else is said.
        let notices = recording.notices();
        let known = ["the recorder came later than the simulation", "is not among these"];
        let is_known = |notice: &String| known.iter().any(|words| notice.contains(words));
        assert!(recording.gaps().is_empty() && notices.iter().all(is_known), "{notices:?}");
        let told = info(file);
        assert_eq!((&told["lost"], &told["settings_changes"]), (&0.into(), &1.into()), "{told}");
        recording.steps(0..u64::MAX, &mut all).unwrap();
    }
    // Each file has its own steps; together every step once, with the revision that was in force.
    all.sort_by_key(Step::seq);
    assert!(all.windows(2).all(|pair| pair[1].seq() == pair[0].seq() + 1));
    let mut revisions: Vec<u64> = all.iter().map(Step::revision).collect();
    revisions.dedup();
    assert_eq!(revisions, [1, 2], "of {} steps", all.len());
}
