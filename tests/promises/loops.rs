//! A loop that is not ideal: its poles, its thresholds, its runs, and a live bench under it.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use promises::{Root, run};

#[test]
fn val_a_delay_changes_poles_as_physics_says_and_says_what_is_counted() {
    let document =
        run(&["poles", "three-mass", "--feedback", "composite", "--set", "delay=0.02", "--speed", "6", "--json"])
            .json();
    assert!((document["min_damping"].as_f64().unwrap() - 0.009_767_6).abs() < 1e-7, "{document}");
    assert_eq!(document["count_right_of"], -100.0);
    // The delay margin is 0.112792: on either side of it.
    for (delay, stable) in [("0.1127", true), ("0.1129", false)] {
        let set = format!("delay={delay}");
        let document =
            run(&["poles", "three-mass", "--feedback", "composite", "--set", &set, "--speed", "6", "--json"]).json();
        assert_eq!(document["stable"], stable, "{delay}");
    }
}

#[test]
fn a_sampled_loop_has_poles_z_and_thresholds_of_its_own() {
    let set = ["--feedback", "composite", "--set", "sample=0.05", "--set", "delay=0.03"];
    let poles = run(&[&["poles", "three-mass", "--speed", "6", "--json"][..], &set].concat()).json();
    let (mode, z) = (&poles["modes"][0], &poles["modes"][0]["z"]);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    // |z| = exp(re h).
    assert!((number(&z["re"]).hypot(number(&z["im"])) - (number(&mode["re"]) * 0.05).exp()).abs() < 1e-12);
    let found = run(&[&["thresholds", "three-mass", "--over", "0..8", "--json"][..], &set].concat()).json();
    let ideal = run(&["thresholds", "three-mass", "--over", "0..8", "--json", "--feedback", "composite"]).json();
    let first = |document: &serde_json::Value| number(&document["thresholds"][0]["speed"]);
    assert!(first(&found) < first(&ideal), "{found} {ideal}");
    // On either side of it.
    for (speed, stable) in [(first(&found) - 1e-6, true), (first(&found) + 1e-6, false)] {
        let at = format!("{speed}");
        let poles = run(&[&["poles", "three-mass", "--speed", &at, "--json"][..], &set].concat()).json();
        assert_eq!(poles["stable"], stable, "{speed}");
    }
}

#[test]
fn a_run_says_how_often_the_actuator_was_at_its_limit() {
    let ran = |limit: &str| {
        let set = format!("limit={limit}");
        let line = ["run", "three-mass", "--feedback", "individual", "--set", &set, "--speed", "6", "--deadband", "1"];
        run(&[&line[..], &["--duration", "100", "--json"]].concat()).json()
    };
    let limited = ran("20");
    assert!(limited["max_force"].as_f64().unwrap() <= 20.0 * (1.0 + 1e-9), "{limited}");
    assert!(limited["saturated_steps"].as_u64().unwrap() > 0 && limited["saturated_share"].as_f64().unwrap() < 1.0);
    assert_eq!(ran("off")["saturated_steps"], 0);
}

#[test]
fn response_cycles_and_the_campbell_diagram_take_the_loop() {
    let three_mass = ["three-mass", "--feedback", "composite", "--json"];
    let of = |command: &[&str], set: &[&str]| run(&[command, &three_mass, set].concat()).json();
    let late = ["--set", "delay=0.1", "--set", "lag=0.02"];
    for command in [["response", "--over", "1..3", "--points", "3"], ["cycles", "--over", "1..3", "--points", "3"]] {
        let command = [&command[..], &["--deadband", "1"]].concat();
        let (ideal, late) = (of(&command, &[]), of(&command, &late));
        assert_eq!(late["points"].as_array().map(Vec::len), Some(3), "{late}");
        assert_ne!(ideal["points"], late["points"], "the loop has a say");
    }
    let campbell = |set: &[&str]| {
        let document = of(&["trace", "--over", "0..7", "--points", "15", "--campbell"], set);
        let of_order = |order: f64| {
            let all = document["campbell"]["critical_speeds"].as_array().expect("a list").clone();
            // The pole of the lag decays at once, and turns a little: that is not what is compared.
            let met = all.into_iter().filter(|c| c["order"] == order && c["damping"].as_f64().unwrap() < 0.999);
            met.map(|c| (c["speed"].as_f64().unwrap(), c["im"].as_f64().unwrap())).collect::<Vec<_>>()
        };
        [of_order(0.5), of_order(1.0)]
    };
    // Next to no lag: every critical speed of the ideal loop is there, and those of the lag are far beyond.
    let (ideal, near) = (campbell(&[]), campbell(&["--set", "lag=0.000001"]));
    for (ideal, near) in ideal.iter().zip(&near) {
        assert_eq!(ideal.len(), near.len(), "{ideal:?} {near:?}");
        assert!(ideal.iter().zip(near).all(|(a, b)| (a.0 - b.0).abs() < 1e-4), "{ideal:?} {near:?}");
    }
    let late = campbell(&["--set", "delay=0.05"]);
    assert!(late[1].iter().all(|(speed, im)| (im.abs() - speed).abs() < 1e-9 * speed), "{late:?}");
    assert!(!late[1].is_empty() && late[1] != ideal[1]);
}

#[test]
fn what_cannot_take_the_loop_refuses_in_words() {
    for command in ["response", "cycles"] {
        let ran = run(&[command, "three-mass", "--feedback", "composite", "--set", "sample=0.02", "--over", "1..2"]);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{command}: {ran:?}");
        assert!(ran.stderr.contains("no orbit of a sampled loop is a circle"), "{ran:?}");
    }
    for (set, why) in [
        ("delay=-1", "delay = -1: expected a number"),
        ("delay=inf", "delay = inf: expected a number"),
        ("limit=0", "limit = 0: expected a number"),
        ("sample=soon", "sample = 'soon': expected a number, or off"),
    ] {
        let ran = run(&["poles", "--speed", "1", "--set", set]);
        assert_eq!(ran.code, Some(2), "{set}: {ran:?}");
        assert!(ran.stderr.contains(why), "{ran:?}");
    }
    let ran = run(&["run", "--speed", "1", "--duration", "5", "--set", "sample=0.001", "--dtau", "0.01"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("shorter than a step of 0.01"), "{ran:?}");
}

#[test]
fn a_live_bench_takes_a_delay_and_refuses_the_one_that_makes_it_unstable() {
    let root = Root::new();
    let _simulation =
        root.simulate(&["three-mass", "--feedback", "composite", "--speed", "6", "--deadband", "0", "--trip", "40"]);
    let set = |arguments: &[&str]| root.run(&[&["set", "--json"], arguments].concat());
    assert_eq!(set(&["delay=0.10"]).code, Some(0));
    let refused = set(&["delay=0.2"]);
    assert!(
        refused.code == Some(1) && refused.stderr.contains("it would make a stable machine unstable"),
        "{refused:?}"
    );
    assert_eq!(set(&["--force", "delay=0.2"]).code, Some(0));
    // It grows, and trips.
    let began = std::time::Instant::now();
    let tripped = || root.run(&["status", "--json"]).json()["benches"][0]["tripped"] == true;
    while !tripped() {
        assert!(began.elapsed() < promises::PATIENCE * 4, "it does not trip");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
}

#[test]
fn a_ramp_takes_the_speed_there_at_its_rate() {
    let root = Root::new();
    let _simulation = root.simulate(&["jeffcott", "--speed", "1"]);
    assert_eq!(root.run(&["set", "ramp=0.001"]).code, Some(0));
    assert_eq!(root.run(&["set", "speed=2"]).code, Some(0));
    let step = || -> (f64, f64) {
        let step: serde_json::Value =
            serde_json::from_str(root.run(&["tail", "--count", "1", "--json"]).stdout.trim()).unwrap();
        (step["tau"].as_f64().unwrap(), step["speed"].as_f64().unwrap())
    };
    // A hundred seconds it takes to get there: two looks are both on the way.
    let ((earlier, slow), (later, fast)) = (step(), step());
    assert!(1.0 < slow && slow < fast && fast < 2.0, "{slow} {fast}");
    assert!(((fast - slow) - 0.001 * (later - earlier)).abs() < 1e-9);
}
