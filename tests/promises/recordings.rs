//! Recordings: `record`, `up --record`, `run --out FILE.rrd`, `info`, `export`. Without the cargo feature `rerun`, how to
//! get them; with it, that they keep every step.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

#[cfg(feature = "rerun")]
mod parts;
#[cfg(feature = "rerun")]
mod recorder;
#[cfg(feature = "rerun")]
mod snapshots;
#[cfg(feature = "rerun")]
mod viewer;

use promises::run;

#[cfg(not(feature = "rerun"))]
#[test]
fn a_build_without_recordings_says_how_to_get_them() {
    for arguments in [
        &["record", "x.rrd"][..],
        &["info", "x.rrd", "--json"],
        &["export", "x.rrd", "--csv"],
        &["run", "jeffcott", "--speed", "1", "--duration", "5", "--out", "x.rrd"],
        &["runup", "jeffcott", "--to", "2", "--rate", "0.1", "--out", "x.rrd"],
        &["up", "--record", "x.rrd"],
    ] {
        let ran = run(arguments);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{arguments:?}: {ran:?}");
        assert!(ran.stderr.contains("cargo build --release --features rerun"), "{arguments:?}: {ran:?}");
    }
}

#[cfg(feature = "rerun")]
mod with {
    use std::path::Path;
    use std::process::Command;
    use std::time::Duration;

    use promises::{Root, Screen};
    use rustix::process::{Pid, Signal, kill_process};
    use serde_json::Value;
    use tape::Recording;
    use wire::Step;

    use super::recorder::{Recorder, configure, info, steps, text, wait};
    use super::run;

    #[test]
    fn every_step_and_every_change_is_in_the_file_bit_for_bit() {
        let root = Root::new();
        let path = root.path().join("s.rrd");
        configure(&root, "[alarms]\norbit = [0.001, 0.002]\n");
        let simulation = root.simulate(&["three-mass", "--rate", "5000"]);
        let recorder = Recorder::start(&root, &path, &[]);
        let tail = root.run(&["tail", "--count", "4000", "--json"]);
        assert_eq!(root.run(&["set", "kd=0.125", "--why", "to see"]).code, Some(0));
        assert_eq!(root.run(&["note", "here it begins"]).code, Some(0));
        assert_eq!(root.run(&["set", "trip=0.001", "--force"]).code, Some(0));
        wait("the trip", || root.run(&["status", "--json"]).json()["benches"][0]["tripped"] == true);
        let status = root.run(&["status", "--json"]).json();
        let told = &status["benches"][0]["recording"];
        assert_eq!((&told["state"], &told["lost"]), (&"recording".into(), &0.into()), "{told}");
        let ran = recorder.end();
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{ran:?}");
        assert!(ran.stdout.contains("0 lost; asked to stop"), "{ran:?}");
        drop(simulation);

        let recorded = steps(&path);
        let mut compared = 0;
        for line in tail.stdout.lines() {
            let line: Value = serde_json::from_str(line).unwrap();
            let state = &recorded[&line["seq"].as_u64().unwrap()];
            let [y, z] = state.force_delivered();
            let mut pairs = vec![("tau", state.tau(), &line["tau"]), ("speed", state.speed(), &line["speed"])];
            pairs.extend([("uy", y, &line["force"]["y"]), ("uz", z, &line["force"]["z"])]);
            for (point, told) in state.points().zip(line["masses"].as_array().unwrap()) {
                let of = [("y", point.y), ("z", point.z), ("vy", point.vy), ("vz", point.vz)];
                pairs.extend(of.map(|(name, value)| (name, value, &told[name])));
            }
            for (name, value, told) in pairs {
                assert_eq!(value.to_bits(), told.as_f64().unwrap().to_bits(), "{name} of step {}", state.seq());
            }
            compared += 1;
        }
        assert_eq!(compared, 4000);

        let recording = Recording::open(&path).unwrap();
        // A busy machine may make the simulation late: that is an event of its own.
        let events: Vec<_> = recording.events().iter().filter(|e| e.happening.name() != "late").collect();
        let happened: Vec<&str> = events.iter().map(|e| e.happening.name()).collect();
        assert_eq!(happened, ["started", "settings", "note", "settings", "tripped"]);
        let changed = events[1];
        assert_eq!((changed.why.as_str(), changed.revision), ("to see", 2));
        let revision = recording.settings_at(changed.at.seq).unwrap();
        assert_eq!(revision.settings.feedback.bearings[0].signals[0].gains[0].at(0.0), 0.125);
        assert_eq!(recorded[&changed.at.seq].revision(), 2, "from that step on");
        assert_eq!(recorded[&(changed.at.seq - 1)].revision(), 1);
        let info = info(&path);
        assert_eq!((&info["lost"], &info["settings_changes"]), (&0.into(), &2.into()), "{info}");
        assert_eq!(info["trips"][0]["revision"], 3, "{info}");
        // Alarms, by the user's own limits, at the step whose value it was.
        let alarms = info["alarms"].as_array().unwrap();
        let orbit = alarms.iter().find(|alarm| alarm["watch"] == "orbit").unwrap_or_else(|| panic!("{info}"));
        let radius = |step: &Value| {
            let state = &recorded[&step.as_u64().unwrap()];
            state.largest_radius()
        };
        assert!(radius(&orbit["from"]["step"]) > 0.001, "{orbit}");
        assert_eq!((&orbit["level"], &info["alarm_limits"]["orbit"][0]), (&"alarm".into(), &0.001.into()), "{info}");
        assert!(info["max_force"]["value"].is_f64() && info["min_damping"]["value"].is_f64());
    }

    #[test]
    fn a_run_up_on_file_tells_its_legs_its_critical_speeds_and_its_trip() {
        let root = Root::new();
        let path = root.path().join("up.rrd");
        let legs = root.path().join("legs.toml");
        std::fs::write(&legs, "[[leg]]\nto = 3\nrate = 0.01\n[[leg]]\ndwell = 40\n[[leg]]\nto = 0.5\nrate = 0.02\n")
            .unwrap();
        let machine = ["runup", "three-mass", "--feedback", "individual"];
        let out = ["--profile", text(&legs), "--out", text(&path), "--json"];
        let ran = run(&[&machine[..], &out].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let (found, told) = (ran.json(), info(&path));
        assert_eq!(told["legs"].as_array().unwrap().len(), 3, "{}", told["legs"]);
        for (leg, expected) in told["legs"].as_array().unwrap().iter().zip(found["legs"].as_array().unwrap()) {
            for (name, near) in [("tau", 0.1), ("speed", 2e-3)] {
                for end in 0..2 {
                    let [a, b] = [leg, expected].map(|leg| leg[name][end].as_f64().unwrap());
                    assert!((a - b).abs() < near, "{leg} {expected}");
                }
            }
        }
        let [told, found] = [&told, &found].map(|document| document["criticals"].as_array().unwrap().clone());
        assert!(told.len() >= 3 && told.len() == found.len(), "{told:?} {found:?}");
        for (told, found) in told.iter().zip(&found) {
            assert_eq!((&told["leg"], &told["station"]), (&found["leg"], &found["station"]), "{told} {found}");
            let [a, b] = [told, found].map(|of| of["speed"].as_f64().unwrap());
            assert!((a - b).abs() < 1e-6, "{told} {found}");
        }
        let words = run(&["info", text(&path)]).stdout;
        for word in ["leg 1", "0 to R = 3", "leg 2", "at R = 3", "critical", "amplification"] {
            assert!(words.contains(word), "{word}: {words}");
        }
        // Every step is there, and the machine with all that it held.
        assert_eq!(run(&["export", text(&path), "--csv"]).code, Some(0));
        assert!(info(&path)["snapshots"].as_u64().unwrap() > 10);
        // One that trips ends there.
        let tripped = root.path().join("tripped.rrd");
        let off = ["runup", "three-mass", "--feedback", "off", "--to", "5", "--rate", "0.005", "--out", text(&tripped)];
        let ran = run(&off);
        assert_eq!(ran.code, Some(1), "{ran:?}");
        let told = info(&tripped);
        assert_eq!(told["trips"].as_array().unwrap().len(), 1, "{told}");
        // A name of no known kind.
        let ran = run(&["runup", "jeffcott", "--to", "2", "--rate", "0.1", "--out", "x.txt"]);
        assert!(ran.code == Some(2) && ran.stderr.contains("ends in .svg, .png or .rrd"), "{ran:?}");
        // And opens as any recording does.
        let mut screen = Screen::start(root.path(), &["replay", text(&path)], (120, 40));
        screen.wait_words("REPLAY");
        screen.press_for("g100\r", "tau 100");
        screen.press("q");
        assert!(screen.ended().success());
    }

    #[test]
    fn a_table_of_it_has_every_digit() {
        let root = Root::new();
        let path = root.path().join("r.rrd");
        let out = ["run", "three-mass", "--speed", "2", "--duration", "20", "--dtau", "0.01"];
        let ran = run(&[&out[..], &["--impulse", "mass=2,vy=0.5,at=5", "--out", text(&path)]].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let csv = run(&["export", text(&path), "--csv", "--from", "4", "--to", "6", "--every", "10"]);
        assert_eq!((csv.code, csv.stderr.as_str()), (Some(0), ""), "{csv:?}");
        let table = std::fs::read_to_string(path.with_extension("csv")).unwrap();
        let recorded = steps(&path);
        let mut lines = table.lines();
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        let (step, y2) =
            (names.iter().position(|n| *n == "step").unwrap(), names.iter().position(|n| *n == "y2").unwrap());
        let mut rows = 0;
        for line in lines {
            let fields: Vec<&str> = line.split(',').collect();
            let state = &recorded[&fields[step].parse().unwrap()];
            assert!((4.0..=6.0).contains(&state.tau()) && state.seq().is_multiple_of(10));
            assert_eq!(fields[y2].parse::<f64>().unwrap().to_bits(), state.point(1).y.to_bits());
            rows += 1;
        }
        assert!((19..=21).contains(&rows), "{rows}");
        let parquet = run(&["export", text(&path), "--parquet"]);
        assert_eq!(parquet.code, Some(0), "{parquet:?}");
        assert!(std::fs::read(path.with_extension("parquet")).unwrap().starts_with(b"PAR1"));

        // The recording of a run holds what its table holds.
        let direct = path.with_file_name("d.csv");
        assert_eq!(
            run(&[&out[..], &["--impulse", "mass=2,vy=0.5,at=5", "--out", text(&direct)]].concat()).code,
            Some(0)
        );
        let direct = std::fs::read_to_string(direct).unwrap();
        assert_eq!(direct.lines().count() - 1, recorded.len());
        for (line, state) in direct.lines().skip(1).zip(recorded.values()) {
            let fields: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
            assert_eq!((fields[0], fields[5], fields[13]), (state.tau(), state.point(1).y, state.force_delivered()[0]));
        }
        let event = &Recording::open(&path).unwrap().events()[0].clone();
        assert_eq!((event.happening.name(), event.at.tau), ("impulse", 5.0));
        let kicked = recorded[&event.at.seq].point(1).vy - recorded[&(event.at.seq - 1)].point(1).vy;
        assert!((kicked - 0.5).abs() < 1e-12, "the impulse shows from its step on: {kicked}");
    }

    /// A damaged file is read before and behind the damage, and every command says what is lost.
    #[test]
    fn a_damaged_recording_is_read_and_told_by_every_command() {
        let root = Root::new();
        let path = root.path().join("r.rrd");
        let out = ["run", "three-mass", "--speed", "2", "--duration", "200", "--dtau", "0.01", "--out", text(&path)];
        assert_eq!(run(&out).code, Some(0));
        let (whole, rows) = (info(&path), steps(&path).len());
        assert_eq!((&whole["checksums"], &whole["damage"]), (&true.into(), &Value::Array(vec![])), "{whole}");
        let mut bytes = std::fs::read(&path).unwrap();
        let place = bytes.len() / 2;
        bytes[place] ^= 1;
        bytes.push(b'x');
        std::fs::write(&path, bytes).unwrap();
        let told = info(&path);
        let damage = told["damage"].as_array().unwrap();
        let kinds: Vec<&Value> = damage.iter().map(|damage| &damage["kind"]).collect();
        assert_eq!(kinds, ["checksum", "foreign"], "{told}");
        let (byte, length) = (damage[0]["byte"].as_u64().unwrap(), damage[0]["bytes"].as_u64().unwrap());
        assert!((byte..byte + length).contains(&(place as u64)), "{told}");
        // Half of the bytes are drawings, of which nothing is read.
        let lost = damage[0]["steps"]["count"].as_u64().unwrap_or_default();
        assert_eq!((told["steps"].as_u64(), &told["lost"]), (Some(rows as u64 - lost), &lost.into()), "{told}");
        let exported = run(&["export", text(&path), "--csv", "--json"]);
        assert_eq!((exported.code, &exported.json()["damage"]), (Some(0), &told["damage"]), "{exported:?}");
        assert_eq!(exported.json()["rows"], told["steps"]);
        assert!(exported.stderr.contains(&format!("damaged at byte {byte}")), "{exported:?}");
        let words = run(&["info", text(&path)]);
        assert!(words.stdout.contains(&format!("damaged at byte {byte}")), "{words:?}");
        let mut screen = Screen::start(root.path(), &["replay", text(&path)], (200, 40));
        screen.wait_words("REPLAY");
        screen.wait_words("damaged at byte");
        screen.press("q");
        assert!(screen.ended().success());
    }

    /// Bytes of the sample that made `info`, `export` and `replay` panic, or end for want of 1e15 bytes.
    #[test]
    fn regress_bytes_that_panicked_or_aborted_are_damage_at_their_place() {
        let root = Root::new();
        let path = root.path().join("run-up.rrd");
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("../recordings/run-up.rrd");
        for (place, changed) in [(306_670, 29), (203_945, 91), (87_687, 2)] {
            let mut bytes = std::fs::read(&sample).unwrap();
            bytes[place] = changed;
            std::fs::write(&path, bytes).unwrap();
            let told = info(&path);
            assert_eq!(told["damage"][0]["kind"], "unreadable", "{told}");
            let exported = run(&["export", text(&path), "--csv", "--json", "--force"]);
            assert_eq!((exported.code, &exported.json()["damage"]), (Some(0), &told["damage"]), "{exported:?}");
            let mut screen = Screen::start(root.path(), &["replay", text(&path)], (160, 40));
            screen.wait_words("REPLAY");
            screen.wait_words("damaged at byte");
            screen.press("q");
            assert!(screen.ended().success());
        }
    }

    #[test]
    fn a_recorder_that_is_killed_leaves_what_it_wrote_a_hundred_times() {
        let root = Root::new();
        let _simulation = root.simulate(&["three-mass", "--rate", "10000"]);
        let mut unreadable = 0;
        // Random enough, and the same in every run.
        let mut random = 0x2545_f491_4f6c_dd1d_u64;
        for kill in 0..100 {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let path = root.path().join(format!("k{kill}.rrd"));
            let recorder = Recorder::start(&root, &path, &[]);
            // One in four may be killed before its head is whole; the rest have as long as they need for it.
            if kill % 4 != 0 {
                wait("a whole head", || Recording::open(&path).is_ok());
            }
            std::thread::sleep(Duration::from_micros(random % 900_000 / if kill % 5 == 0 { 1 } else { 10 }));
            let status = root.run(&["status", "--json"]).json();
            recorder.kill();
            // What it has told to be written is on disk, whenever it is killed; it tells nothing of what is on its way.
            let told = status["benches"][0]["recording"]["steps"].as_u64().unwrap_or(0);
            match Recording::open(&path) {
                Ok(mut recording) => {
                    assert!(recording.notices().iter().any(|n| n.contains("killed")), "{:?}", recording.notices());
                    assert_eq!(recording.gaps(), []);
                    let Some(span) = recording.span() else { continue };
                    let mut all = Vec::new();
                    recording.steps(0..u64::MAX, &mut all).unwrap();
                    assert_eq!(all.len() as u64, span.last.seq - span.first.seq + 1);
                    assert!(all.len() as u64 >= told, "{} of {told} steps are on disk", all.len());
                }
                // Killed before even the head was whole.
                Err(error) => {
                    assert!(
                        error.to_string().contains("nothing of whirl's")
                            || error.to_string().contains("No such file")
                            || error.to_string().contains("too short"),
                        "{error}"
                    );
                    unreadable += 1;
                }
            }
            let _ = std::fs::remove_file(&path);
        }
        assert!(unreadable <= 25, "whose head was seen can be read: {unreadable}");
        // The next recorder finds the bench free.
        let path = root.path().join("last.rrd");
        let recorder = Recorder::start(&root, &path, &[]);
        wait("a first stretch", || path.metadata().is_ok_and(|found| found.len() > 100_000));
        assert_eq!(recorder.end().code, Some(0));
        let ran = run(&["info", text(&path)]);
        assert!(ran.code == Some(0) && ran.stdout.contains("0 lost"), "{ran:?}");
    }

    #[test]
    fn places_that_are_taken_missing_or_full_are_said_at_once() {
        let root = Root::new();
        let _simulation = root.simulate(&["jeffcott"]);
        let taken = root.path().join("taken.rrd");
        std::fs::write(&taken, "mine").unwrap();
        let record = |path: &Path, options: &[&str]| root.run(&[&["record", text(path)], options].concat());
        for (path, options, code, why) in [
            (taken.clone(), &[][..], 2, "is already there"),
            (root.path().join("no/s.rrd"), &[], 2, "No such file or directory"),
            (root.path().join("s.mcap"), &[], 2, "ends in .rrd"),
            (root.path().join("s.rrd"), &["--bench", "b"], 3, "no bench 'b' is running"),
            (root.path().join("s.rrd"), &["--pretrigger", "100h"], 2, "too many to hold in memory"),
            (root.path().join("s.rrd"), &["--keep", "10m"], 2, "expected a duration"),
            (root.path().join("s.rrd"), &["--min-free", "900000GB"], 1, "to be kept free"),
        ] {
            let ran = record(&path, options);
            assert_eq!(ran.code, Some(code), "{options:?}: {ran:?}");
            assert!(ran.stderr.contains(why), "{options:?}: {ran:?}");
        }
        assert_eq!(std::fs::read(&taken).unwrap(), b"mine");

        let config = configure(&root, "[alarms]\norbit = [5, 3]\n");
        let ran = record(&root.path().join("s.rrd"), &[]);
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stderr.contains("config.toml:2:9: orbit = [5, 3]: expected the alarm at or above"), "{ran:?}");
        std::fs::remove_file(config).unwrap();

        let first = root.path().join("first.rrd");
        let recorder = Recorder::start(&root, &first, &[]);
        let second = record(&root.path().join("second.rrd"), &[]);
        assert_eq!(second.code, Some(3), "one recorder a bench: {second:?}");
        // Deleted under its hands: it must not write into nothing.
        std::fs::remove_file(&first).unwrap();
        let ran = recorder.wait();
        assert_eq!(ran.code, Some(1), "{ran:?}");
        assert!(ran.stderr.contains("has been deleted"), "{ran:?}");
    }

    #[test]
    fn a_full_disk_ends_the_recording_at_once_and_leaves_it_readable() {
        let root = Root::new();
        let _simulation = root.simulate(&["three-mass", "--rate", "10000"]);
        let path = root.path().join("s.rrd");
        // A limit on the size of files stands for a disk that is full: the same refusal in the middle of a write.
        let mut command = Command::new("sh");
        let limited = "trap '' XFSZ; ulimit -f 4000; exec \"$0\" record \"$1\" --as-child";
        command.args(["-c", limited]).arg(promises::program()).arg(&path).env("WHIRL_ROOT", root.path());
        let ran = Recorder::of(&mut command).wait();
        assert_eq!(ran.code, Some(1), "{ran:?}");
        assert!(ran.stderr.contains("cannot go on writing") && ran.stderr.contains("stays readable"), "{ran:?}");
        let mut recording = Recording::open(&path).unwrap();
        assert!(recording.rows() > 1000 && recording.gaps().is_empty());
        assert_eq!(recording.notices().len(), 2, "not cut, only ended: {:?}", recording.notices());
        let mut all = Vec::new();
        recording.steps(0..u64::MAX, &mut all).unwrap();
        assert_eq!(all.len() as u64, recording.rows());
    }

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

    #[test]
    fn a_recording_ends_with_the_simulation_and_with_a_signal() {
        let root = Root::new();
        for ends_by_signal in [false, true] {
            let simulation = root.simulate(&["jeffcott"]);
            let path = root.path().join(format!("{ends_by_signal}.rrd"));
            let recorder = Recorder::start(&root, &path, &[]);
            wait("a first stretch", || path.metadata().is_ok_and(|found| found.len() > 30_000));
            let ran = if ends_by_signal {
                kill_process(Pid::from_raw(recorder.child.id() as i32).unwrap(), Signal::INT).unwrap();
                recorder.wait()
            } else {
                assert_eq!(simulation.end().code, Some(0));
                recorder.wait()
            };
            assert_eq!(ran.code, Some(0), "{ran:?}");
            let why = if ends_by_signal { "asked to stop" } else { "the simulation ended" };
            assert!(ran.stdout.contains(why), "{ran:?}");
            assert!(!Recording::open(&path).unwrap().notices().iter().any(|n| n.contains("killed")));
        }
    }
}
