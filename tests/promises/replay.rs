//! `whirl replay`, and the key that records. Without the cargo feature `rerun`, how to get them.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

#[cfg(not(feature = "rerun"))]
#[test]
fn a_build_without_recordings_says_so_to_the_player_and_to_the_key() {
    use promises::{Root, Screen, run};

    let ran = run(&["replay", "x.rrd"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
    assert!(ran.stderr.contains("cargo build --release --features rerun"), "{ran:?}");
    let root = Root::new();
    let mut screen = Screen::start(root.path(), &[], (160, 30));
    screen.wait_words("RUNNING");
    screen.press_for("r", "cargo build --release --features rerun");
    screen.press("q");
    assert!(screen.ended().success());
}

#[cfg(feature = "rerun")]
mod with {
    use std::path::Path;

    use promises::{Root, Screen, run};

    /// The whole number or fraction that follows `label` on the screen.
    fn number_after(text: &str, label: &str) -> Option<f64> {
        let rest = &text[text.find(label)? + label.len()..];
        let number: String =
            rest.trim_start().chars().take_while(|c| c.is_ascii_digit() || "+-.e".contains(*c)).collect();
        number.parse().ok()
    }

    /// The step that the player stands at.
    fn step(text: &str) -> Option<u64> {
        number_after(text.lines().next()?, "step ").map(|step| step as u64)
    }

    /// A recording of a run of three masses that is struck at tau = 100, 20 000 steps.
    fn recording(folder: &Path) -> String {
        let file = folder.join("s.rrd").to_str().unwrap().to_owned();
        let ran = run(&[
            "run",
            "three-mass",
            "--feedback",
            "composite",
            "--speed",
            "2.5",
            "--deadband",
            "1",
            "--duration",
            "200",
            "--settle",
            "150",
            "--dtau",
            "0.01",
            "--impulse",
            "mass=1,vy=-2.5,at=100",
            "--out",
            &file,
        ]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        file
    }

    #[test]
    fn a_recording_is_played_sought_through_and_run_on_from() {
        let root = Root::new();
        let file = recording(root.path());
        let mut screen = Screen::start(root.path(), &["replay", &file], (200, 50));
        screen.wait_words("REPLAY");
        screen.wait_words("s.rrd");
        let first = screen.wait("a step", step);
        // Play, faster, and pause.
        screen.press(" ");
        screen.wait("it moves on", |text| step(text).filter(|step| *step > first + 50));
        screen.press_for(")", "1.5x");
        screen.press_for(" ", "■");
        // To the end, a step back, to a time that is typed, to the impulse.
        screen.press("\x1b[F");
        let last = screen.wait("the end", |text| step(text).filter(|step| *step >= 19_998));
        screen.press("<");
        screen.wait("a step back", |text| step(text).filter(|step| *step == last - 1));
        screen.press("g50\r");
        screen
            .wait("tau 50", |text| number_after(text.lines().next()?, "tau ").filter(|tau| (tau - 50.0).abs() < 0.02));
        // The list of events names the impulse all the time: what is new is where we stand.
        screen.press("n");
        screen.wait("tau 100", |text| {
            number_after(text.lines().next()?, "tau ").filter(|tau| (tau - 100.0).abs() < 0.03)
        });
        // What if there had been no control from here on?
        screen.press_for("0", "WHAT IF from tau 100");
        screen.press("]");
        screen.wait("it is unstable", |text| number_after(text, "min damping ").filter(|damping| *damping < 0.0));
        screen.press("\x1b");
        screen.wait("it is dropped", |text| (!text.lines().next()?.contains("WHAT IF")).then_some(()));
        screen.press("q");
        assert!(screen.ended().success());
    }

    #[test]
    fn a_key_records_the_bench_and_ends_that() {
        let root = Root::new();
        let simulation = root.simulate(&["three-mass"]);
        let mut screen = Screen::start_in(root.path(), root.path(), &["dash"], (200, 40));
        screen.wait_words("RUNNING");
        screen.press_for("r", "● REC 0");
        let status = root.run(&["status", "--json"]).json();
        let path = status["benches"][0]["recording"]["path"].as_str().unwrap().to_owned();
        assert!(path.ends_with(".rrd") && path.contains("default-"), "{path}");
        screen.press("r");
        screen.wait("it has ended", |text| (!text.contains("● REC") && text.contains("0 lost")).then_some(()));
        let file = root.path().join(Path::new(&path).file_name().unwrap());
        let info = run(&["info", file.to_str().unwrap(), "--json"]).json();
        assert!(info.is_object());
        screen.press("q");
        assert!(screen.ended().success());
        assert_eq!(simulation.end().code, Some(0));
    }

    /// A recorder that cannot record says why in the dashboard, which goes on.
    #[test]
    fn a_recorder_that_cannot_start_says_why_in_the_dashboard() {
        let root = Root::new();
        let simulation = root.simulate(&["three-mass"]);
        let folder = root.path().join("here");
        std::fs::create_dir(&folder).unwrap();
        let mut screen = Screen::start_in(&folder, root.path(), &["dash"], (200, 40));
        screen.wait_words("RUNNING");
        // A configuration that has gone wrong since.
        let config = root.path().join("config/whirl");
        std::fs::create_dir_all(&config).unwrap();
        std::fs::write(config.join("config.toml"), "[alarms]\norbit = [5, 3]\n").unwrap();
        screen.press_for("r", "the recording failed");
        screen.wait_words("config.toml:2:9");
        std::fs::remove_file(config.join("config.toml")).unwrap();
        // The folder has gone.
        std::fs::remove_dir(&folder).unwrap();
        screen.press_for("r", "cannot be made: No such file or directory");
        screen.press("q");
        assert_eq!(screen.ended().exit_code(), 2, "a recording that was asked for has failed");
        assert_eq!(simulation.end().code, Some(0));
    }

    #[test]
    fn what_is_no_recording_is_said() {
        let root = Root::new();
        let file = root.path().join("x.rrd");
        std::fs::write(&file, "not a recording").unwrap();
        for path in [file.to_str().unwrap(), "/nowhere/y.rrd"] {
            let ran = run(&["replay", path]);
            assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
            assert!(ran.stderr.contains(path), "{ran:?}");
        }
    }
}
