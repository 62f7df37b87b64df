//! Speed in motion: run-ups offline, and profiles that a live bench follows.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use promises::{Root, Screen, run};

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_run_up_tells_its_points_and_its_critical_speeds() {
    let ran = ["runup", "three-mass", "--feedback", "individual", "--from", "0", "--to", "6", "--rate", "0.01"];
    let document = run(&[&ran[..], &["--json"]].concat()).json();
    let points = document["points"].as_array().unwrap();
    let last = points.last().unwrap();
    assert!(number(&last["speed"]) > 5.9 && (number(&last["tau"]) - 600.0).abs() < 5.0, "{last}");
    assert_eq!(last["first_order"].as_array().unwrap().len(), 3);
    assert!(points.windows(2).all(|pair| number(&pair[0]["speed"]) < number(&pair[1]["speed"])));
    let criticals = document["criticals"].as_array().unwrap();
    let mass_1 = criticals.iter().find(|c| c["station"] == 1).unwrap();
    // Later than the steady one, as run-ups are.
    assert!(number(&mass_1["speed"]) > number(&mass_1["steady"]["speed"]), "{mass_1}");
    let [low, high] = [0, 1].map(|side| number(&mass_1["half_power"][side]));
    assert!((number(&mass_1["speed"]) / (high - low) - number(&mass_1["amplification"])).abs() < 1e-9);
    let csv = run(&[&ran[..], &["--csv"]].concat()).stdout;
    assert!(csv.starts_with("tau,speed,force,amplitude1,phase1,radius1,rest1,subsynchronous1,"), "{csv}");
    assert_eq!(csv.lines().count(), points.len() + 1);
}

#[test]
fn a_run_up_is_drawn_and_a_trip_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let bode = folder.path().join("bode.svg");
    let out = bode.to_str().unwrap();
    let ran = ["runup", "jeffcott", "--feedback", "off", "--from", "0", "--to", "2", "--rate", "0.002", "--out", out];
    assert_eq!(run(&ran).code, Some(0));
    let drawn = std::fs::read_to_string(&bode).unwrap();
    assert!(drawn.contains("Phase (degrees)") && drawn.contains("steady"), "{}", &drawn[..400]);
    // Nothing is overwritten.
    assert_eq!(run(&ran).code, Some(2));
    let tripped = run(&["runup", "three-mass", "--to", "6", "--rate", "0.02", "--set", "trip=50"]);
    assert_eq!(tripped.code, Some(1));
    assert!(tripped.stderr.contains("tripped at") && tripped.stderr.contains("past the limit of 50"), "{tripped:?}");
}

#[test]
fn what_is_no_run_up_is_refused_with_line_and_leg() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("up.toml");
    let file = path.to_str().unwrap();
    for (text, told) in [
        ("[[leg]]\nto = 6\nrate = 0\n", "up.toml:3:8: [[leg]] 1: rate = 0: expected"),
        (
            "[[leg]]\nto = 6\nrate = 1\n[[leg]]\nto = 6\nrate = 1\n",
            "up.toml:5:6: [[leg]] 2: to = 6: expected another speed",
        ),
        ("[[leg]]\ndwell = -1\n", "up.toml:2:9: [[leg]] 1: dwell = -1: expected"),
        ("[[leg]]\nto = 6\nrates = 1\n", "did you mean 'rate'?"),
    ] {
        std::fs::write(&path, text).unwrap();
        for command in [&["runup", "three-mass", "--profile", file][..], &["sim", "three-mass", "--profile", file]] {
            let refused = Root::new().run(command);
            assert_eq!(refused.code, Some(2), "{refused:?}");
            assert!(refused.stderr.contains(told), "{told}: {refused:?}");
        }
    }
    // Too fast for the steps that there is time for: the second leg leads there.
    std::fs::write(&path, "[[leg]]\nto = 2\nrate = 1\n[[leg]]\nto = 900\nrate = 1\n").unwrap();
    let refused = Root::new().run(&["sim", "three-mass", "--profile", file, "--rate", "20000", "--dtau", "0.1"]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.stderr.contains("leg 2 (line 4): dtau = 0.1 is too long for the spin"), "{refused:?}");
    let refused = Root::new().run(&["run", "three-mass", "--profile", file, "--dtau", "0.02"]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.stderr.contains("leg 2 (line 4): dtau = 0.02 is too long for the spin"), "{refused:?}");
    for (arguments, told) in [
        (&["--to", "3", "--rate", "-1"][..], "rate = -1: expected"),
        (&["--from", "3", "--to", "3", "--rate", "1"], "expected two speeds"),
        (&["--to", "3"], "--rate"),
        (&["--to", "3", "--rate", "1", "--set", "speed=1"], "'speed=1' does nothing"),
        (&["--to", "3", "--rate", "1", "--set", "ramp=0.1"], "'ramp=0.1' does nothing"),
    ] {
        let refused = run(&[&["runup", "three-mass"][..], arguments].concat());
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.stderr.contains(told), "{refused:?}");
    }
}

#[test]
fn a_live_bench_follows_a_profile_until_its_speed_is_set() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("up.toml");
    std::fs::write(&path, "from = 1.0\n[[leg]]\nto = 3.0\nrate = 0.001\n[[leg]]\ndwell = 1e6\n").unwrap();
    let root = Root::new();
    let file = path.to_str().unwrap();
    let _simulation = root.simulate(&["three-mass", "--feedback", "individual", "--profile", file]);
    let speeds = |count: &str| -> Vec<(f64, f64)> {
        let told = root.run(&["tail", "--json", "--count", count]).stdout;
        let step = |line: &str| serde_json::from_str::<serde_json::Value>(line).unwrap();
        told.lines().map(step).map(|step| (number(&step["tau"]), number(&step["speed"]))).collect()
    };
    let on_the_way = |steps: &[(f64, f64)]| {
        assert!(!steps.is_empty());
        steps.iter().all(|(tau, speed)| (speed - (1.0 + 0.001 * tau)).abs() < 1e-9)
    };
    assert!(on_the_way(&speeds("200")));
    // How far it has got is told to whoever asks, at once or later.
    let leg = || root.run(&["status", "--json"]).json()["benches"][0]["leg"].clone();
    assert_eq!(leg(), serde_json::json!([1, 2]));
    assert!(root.run(&["status"]).stdout.contains("leg 1 of 2 of its profile"));
    // Gains do not take it off its way.
    assert_eq!(root.run(&["set", "kd.1=3.9"]).code, Some(0));
    assert!(on_the_way(&speeds("200")));
    assert_eq!(root.run(&["set", "speed=1.5", "ramp=off"]).code, Some(0));
    assert!(speeds("50").iter().all(|(_, speed)| *speed == 1.5));
    assert!(leg().is_null(), "it has left its profile");
    // Both are on the record.
    let (mut count, mut events) = (0, String::new());
    // On a busy machine it is also told how late the simulation was, any number of times.
    while count != 5 + events.matches("\"event\":\"late\"").count() {
        count = 5 + events.matches("\"event\":\"late\"").count();
        events = root.run(&["tail", "--events", "--count", &count.to_string(), "--json"]).stdout;
    }
    for told in ["the speed follows a profile: from 1 to 3 at 0.001, for 1000000", "the speed leaves its profile"] {
        assert!(events.contains(told), "{events}");
    }
}

/// The first event of a bench that tells of something, which it does already: among those before it are any number that tell how late the
/// simulation was.
fn event_that_tells(root: &Root, told: &str) -> serde_json::Value {
    for count in 1..=64 {
        let events = root.run(&["tail", "--events", "--count", &count.to_string(), "--json"]).stdout;
        if let Some(line) = events.lines().find(|line| line.contains(told)) {
            return serde_json::from_str(line).unwrap();
        }
    }
    panic!("no event tells '{told}'");
}

/// Without a clearance the orbit passes 3 e_t on the way to the critical speed at R = 2.6, and nowhere before it.
#[test]
fn an_alarm_stops_a_run_up_from_the_console_as_configured() {
    for (response, told, below) in [("hold", "the speed is held", 4.0), ("coast-down", "the speed coasts down", 1.5)] {
        let root = Root::new();
        let folder = root.path().join("config/whirl");
        std::fs::create_dir_all(&folder).unwrap();
        let off = ["damping", "sensitivity", "force", "lateness", "losses"]
            .map(|name| format!("{name} = \"off\"\n"))
            .concat();
        let config = format!("[alarms]\n{off}orbit = [2.5, 3.0]\nrun-up = \"{response}\"\n");
        std::fs::write(folder.join("config.toml"), config).unwrap();
        let simulation = root.simulate(&["three-mass", "--deadband", "0", "--speed", "0.3"]);
        let mut screen = Screen::start(root.path(), &["dash"], (120, 40));
        // Without its settings nothing of it can be changed.
        screen.wait_words("rev 1 by start");
        screen.press(":run-up 4 0.05\r");
        screen.wait_words(&format!("{told}: alarm of orbit"));
        // Whoever reads the bench afterwards knows of it too: who, why, and what has changed.
        let event = event_that_tells(&root, told);
        assert_eq!(event["event"], "settings");
        assert!(event["who"].as_str().unwrap().starts_with("dash:"), "{event}");
        let speed = number(&event["settings"]["speed"]);
        assert_eq!(speed == 0.0, response == "coast-down", "{event}");
        let now = || number(&root.run(&["status", "--json"]).json()["benches"][0]["speed"]);
        let patience = std::time::Instant::now();
        while !(now() < below && (response == "coast-down" || now() == speed)) {
            assert!(patience.elapsed().as_secs() < 120, "{}", now());
        }
        // What an alarm did is undone like anything else.
        screen.press_for("u", "undone");
        screen.press("q");
        assert!(screen.ended().success());
        assert_eq!(simulation.end().code, Some(0));
    }
}

/// Without control the rotor is unstable above R = 1.78: it trips, and is stable on the way to rest.
#[test]
fn a_trip_lets_the_speed_coast_down_where_the_settings_say_so() {
    let root = Root::new();
    let machine = ["three-mass", "--feedback", "off", "--deadband", "0", "--trip", "5", "--coast-down", "0.5"];
    let simulation = root.simulate(&machine);
    let bench = || root.run(&["status", "--json"]).json()["benches"][0].clone();
    let wait = |what: &str, is_there: &dyn Fn(&serde_json::Value) -> bool| {
        let patience = std::time::Instant::now();
        loop {
            let bench = bench();
            if is_there(&bench) {
                return bench;
            }
            assert!(patience.elapsed().as_secs() < 120, "{what}: {bench}");
        }
    };
    let tripped = wait("a trip", &|bench| bench["tripped"] == true);
    let why = tripped["trip"].as_str().unwrap();
    assert!(why.ends_with("past the limit of 5 e_t, and the speed coasts down"), "{why}");
    let now = || root.run(&["tail", "--json", "--count", "1"]).json();
    let [first, then] = [now(), now()];
    assert!(number(&first["tau"]) < number(&then["tau"]), "time goes on: {first} {then}");
    assert!(number(&first["speed"]) > number(&then["speed"]) || number(&then["speed"]) == 0.0, "{first} {then}");
    for flag in ["tripped", "coasting"] {
        assert!(then["flags"].as_array().unwrap().contains(&flag.into()), "{then}");
    }
    wait("rest", &|bench| number(&bench["speed"]) == 0.0);
    // What is set is taken, and does not turn it: only a restart does.
    assert_eq!(root.run(&["set", "speed=1"]).code, Some(0));
    assert_eq!(number(&now()["speed"]), 0.0);
    assert_eq!(event_that_tells(&root, "past the limit of 5 e_t")["cause"], "coast-down");
    let mut screen = Screen::start(root.path(), &["dash"], (160, 40));
    screen.wait_words("and the speed coasts down");
    screen.press_for("R", "RUNNING");
    let again = wait("running", &|bench| bench["tripped"] == false);
    assert_eq!(number(&again["speed"]), 1.0, "below the threshold");
    screen.press("q");
    assert!(screen.ended().success());
    assert_eq!(simulation.end().code, Some(0));
}

#[test]
fn a_run_along_a_profile_ends_where_the_run_up_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("up.toml");
    std::fs::write(&path, "[[leg]]\nto = 2.0\nrate = 0.02\n[[leg]]\ndwell = 50\n").unwrap();
    let file = path.to_str().unwrap();
    let line = ["run", "three-mass", "--feedback", "individual", "--deadband", "1", "--profile", file];
    let ran = run(&[&line[..], &["--json"]].concat()).json();
    assert!((number(&ran["final"]["tau"]) - 150.0).abs() < 1e-9, "{ran}");
    // By then it is on the steady orbit of R = 2, but for what still decays.
    let steady = run(&[
        "run",
        "three-mass",
        "--feedback",
        "individual",
        "--deadband",
        "1",
        "--speed",
        "2",
        "--duration",
        "300",
        "--json",
    ])
    .json();
    let radius = |document: &serde_json::Value, mass: usize| {
        let mass = &document["final"]["masses"][mass];
        number(&mass["y"]).hypot(number(&mass["z"]))
    };
    for mass in 0..3 {
        assert!((radius(&ran, mass) / radius(&steady, mass) - 1.0).abs() < 0.02, "{ran} {steady}");
    }
    let refused = run(&[&line[..], &["--set", "speed=3"]].concat());
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("the speed follows --profile"), "{refused:?}");
}

#[test]
fn while_the_speed_is_on_its_way_damping_and_speed_are_those_of_the_moment() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("up.toml");
    std::fs::write(&path, "from = 2.0\n[[leg]]\nto = 6.0\nrate = 0.002\n").unwrap();
    let root = Root::new();
    let file = path.to_str().unwrap();
    let mut screen = promises::Screen::start(
        root.path(),
        &["up", "three-mass", "--feedback", "composite", "--profile", file],
        (160, 45),
    );
    // The header tells where it is and where it goes.
    screen.wait("the speed of the moment", |text| text.contains(" to 6").then_some(()));
    let bench = root.run(&["status", "--json"]).json()["benches"][0].clone();
    let (speed, damping) = (number(&bench["speed"]), number(&bench["min_damping"]));
    assert!(speed > 2.0 && speed < 5.0, "{bench}");
    let at = speed.to_string();
    let poles = run(&["poles", "three-mass", "--feedback", "composite", "--speed", &at, "--json"]).json();
    assert!((damping - number(&poles["min_damping"])).abs() < 1e-9, "{bench} {poles}");
    screen.press("q");
    assert!(screen.ended().success());
}

#[test]
fn on_its_way_down_a_change_that_is_unstable_where_the_machine_is_now_is_refused() {
    // At rest the rotor is stable without control; at R = 4, where it still is, it is not.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("down.toml");
    std::fs::write(&path, "from = 4.0\n[[leg]]\nto = 0.0\nrate = 0.0005\n").unwrap();
    let root = Root::new();
    let file = path.to_str().unwrap();
    let _simulation = root.simulate(&["three-mass", "--feedback", "individual", "--profile", file]);
    let refused = root.run(&["set", "feedback=off"]);
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(refused.stderr.contains("would make a stable machine unstable"), "{refused:?}");
    // And where another speed is set, it does not jump there.
    assert_eq!(root.run(&["set", "speed=5"]).code, Some(0));
    let line = root.run(&["tail", "--json", "--count", "1"]).stdout;
    let step: serde_json::Value = serde_json::from_str(line.lines().next().unwrap()).unwrap();
    assert!((number(&step["speed"]) - 4.0).abs() < 0.5, "{line}");
}
