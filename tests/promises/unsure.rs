//! A machine that is not quite what is thought: slopes, boxes, samples.

use promises::run;
use serde_json::Value;

const MARGIN: [&str; 6] = ["margin", "three-mass", "--feedback", "individual", "--speed", "6"];

fn margin(rest: &[&str]) -> Value {
    run(&[&MARGIN, rest, &["--json"]].concat()).json()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn slopes_are_ranked_and_have_every_margin() {
    let document = margin(&["--sensitivities"]);
    let slopes = document["sensitivities"].as_array().expect("a list");
    assert!(slopes.len() > 30, "{}", slopes.len());
    // As in 50 digits: `tests/reference/sensitivities.py`.
    assert_eq!(slopes[0]["parameter"], "mass.2");
    assert!((number(&slopes[0]["min_damping"]) + 0.763_962_523_754_808_7).abs() < 1e-10, "{}", slopes[0]);
    let effect = |of: &Value| (number(&of["value"]) * number(&of["min_damping"])).abs();
    let effects: Vec<f64> = slopes.iter().map(effect).filter(|effect| *effect > 0.0).collect();
    assert!(effects.windows(2).all(|pair| pair[0] >= pair[1]), "{effects:?}");
    for name in ["delay", "gain_down", "phase", "sensitivity", "complementary", "force"] {
        assert!(slopes[0]["margins"][name].is_f64(), "{name}: {}", slopes[0]);
    }
    assert_eq!(slopes[0]["margins"]["gain_up"], Value::Null, "there is no such margin");
    let rows = run(&[&MARGIN[..], &["--sensitivities", "--csv"]].concat()).stdout;
    assert!(rows.starts_with("parameter,value,damping per unit"), "{rows}");
}

#[test]
fn a_box_is_proven_where_that_can_be_and_samples_lie_in_it() {
    let vary = ["--vary", "mass.2=10%", "--vary", "shaft.1=0.45..0.55"];
    let rest = [&vary[..], &["--samples", "2000", "--seed", "5"]].concat();
    let document = margin(&rest);
    let worst = &document["box"];
    assert_eq!(worst["proven"], true, "{worst}");
    assert!(number(&worst["worst_damping"]) > 0.0 && number(&worst["at"]["mass.2"]) == 0.55, "{worst}");
    let samples = &document["samples"];
    assert!(number(&samples["quantiles"]["0.01"]) >= number(&worst["worst_damping"]) - 1e-3, "{samples}");
    assert_eq!((&samples["count"], &samples["seed"], number(&samples["stable_share"])), (&2000.into(), &5.into(), 1.0));
    assert!(number(&samples["interval"][0]) > 0.99 && samples["interval"][1] == 1.0);
    assert_eq!(margin(&rest), document, "the same seed, the same answer");
    // Late, there is no proof.
    let late = margin(&[&vary[..], &["--set", "delay=0.02"]].concat());
    assert_eq!(late["box"]["proven"], false);
    assert!(late["box"]["not_proven"].as_str().expect("words").contains("the worst that was found"));
    // All of the rotor: what is named by itself has its own range.
    let wide = margin(&["--box", "10%", "--vary", "mass.2=1%"]);
    assert_eq!(wide["box"]["over"].as_object().expect("ranges").len(), 11);
    assert_eq!(wide["box"]["over"]["mass.2"][1], 0.505);
}

#[test]
fn regress_a_box_of_a_drawing_moves_together_what_cannot_move_alone() {
    let of = |rest: &[&str]| run(&[&["margin", "rig", "--speed", "6000"][..], rest, &["--json"]].concat()).json();
    let document = of(&["--box", "10%", "--samples", "50"]);
    let worst = &document["box"];
    let members = ["disc.1.mass", "disc.1.polar_inertia", "disc.1.diametral_inertia"];
    assert_eq!(worst["together"]["disc.1.inertia"], Value::from(members.to_vec()), "{worst}");
    assert_eq!(worst["over"]["material.1.moduli"], Value::from(vec![0.9, 1.1]));
    assert!(worst["over"].get("material.1.youngs_modulus").is_none() && worst["over"].get("disc.1.mass").is_none());
    let least = number(&document["samples"]["quantiles"]["0.01"]);
    assert!(number(&worst["worst_damping"]) < least && worst["proven"] == false, "{worst} {least}");
    // What is named by itself is all that moves of its part.
    let named = of(&["--box", "10%", "--vary", "disc.1.mass=2%"]);
    let over = &named["box"]["over"];
    assert!(over.get("disc.1.inertia").is_none() && over.get("disc.2.inertia").is_some(), "{over}");
    assert!(over.get("disc.1.mass").is_some(), "{over}");
}

#[test]
fn what_cannot_vary_is_refused_with_the_reason() {
    for (rest, words) in [
        (&["--vary", "colour=1..2"][..], "no parameter 'colour': there are speed"),
        (&["--vary", "damping.2=10%"], "'damping.2' is 0: a part of it is nothing; give a range"),
        (&["--vary", "limit=10%"], "'limit' is off; give a range"),
        (&["--vary", "deadband=0..1"], "plays no part in damping"),
        (&["--vary", "damping.1=-1..1"], "expected a finite number, not negative"),
        (&["--vary", "mass.1=10%", "--vary", "mass.1=5%"], "mass.1 is given twice"),
        (&["--vary", "mass.1=2..1"], "expected KEY=A..B with A below B, or KEY=P%"),
        (&["--vary", "factor.1=0.5..2"], "factor.1 = 2: expected a number from 0 to 1"),
        (&["--box", "0%"], "expected a part in per cent above 0 and below 100"),
        (&["--samples", "10"], "required arguments were not provided"),
        (&["--box", "10%", "--samples", "0"], "0"),
        (&["--box", "10%", "--tolerance", "0"], "--tolerance 0: expected a finite number above 0"),
    ] {
        let ran = run(&[&MARGIN[..], rest].concat());
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{rest:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{rest:?}: {}", ran.stderr);
    }
    let ran = run(&["margin", "three-mass", "--feedback", "individual", "--over", "0..6", "--box", "10%"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("cannot be used with"), "{}", ran.stderr);
}

#[test]
fn samples_are_simulated_with_their_clearances() {
    let ask = |seed: &str| {
        let clearance =
            ["margin", "three-mass", "--feedback", "composite", "--speed", "2.5", "--vary", "deadband.1=0..1"];
        let rest = ["--vary", "unbalance.2=0.5..1.5", "--samples", "40", "--simulate", "--seed", seed, "--json"];
        run(&[&clearance[..], &rest].concat()).json()
    };
    let (once, again, other) = (ask("1"), ask("1"), ask("2"));
    let simulated = &once["samples"]["simulated"];
    assert!(*simulated == again["samples"]["simulated"] && *simulated != other["samples"]["simulated"]);
    // Neither plays a part in damping: there is no box, and every sample is as well damped as the machine.
    assert!(once.get("box").is_none() && once["samples"]["quantiles"]["0.01"] == once["samples"]["quantiles"]["0.99"]);
    assert_eq!(simulated["bounded_share"], 1.0);
    let quantile = |of: &str, part: &str| simulated[of][part].as_f64().expect("a number");
    for of in ["orbit", "force"] {
        assert!(0.0 < quantile(of, "0.05") && quantile(of, "0.05") < quantile(of, "0.95"), "{simulated}");
    }
    let refused =
        run(&["margin", "three-mass", "--feedback", "composite", "--speed", "2.5", "--vary", "deadband.1=0..1"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("--simulate"), "{}", refused.stderr);
}
