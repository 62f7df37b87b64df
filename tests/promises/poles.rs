//! `whirl poles`: the documented fields, and refusals that say what is wrong.

use promises::run;

#[test]
fn prints_one_json_document_with_the_promised_fields() {
    let document = run(&["poles", "jeffcott", "--speed", "0", "--json"]).json();
    assert_eq!(document["rotor"], "jeffcott");
    assert_eq!(document["speed"], 0.0);
    assert_eq!(document["stable"], true);
    assert!((document["min_damping"].as_f64().unwrap() - 0.496_714).abs() < 5e-7);
    let modes = document["modes"].as_array().unwrap();
    let mut whirls: Vec<_> = modes.iter().map(|m| m["whirl"].as_str().unwrap()).collect();
    whirls.sort_unstable();
    assert_eq!(whirls, ["backward", "forward"]);
    for mode in modes {
        for field in ["re", "im", "damping", "log_dec", "frequency"] {
            assert!(mode[field].is_f64(), "{field} of {mode}");
        }
        assert_eq!(mode["shape"].as_array().unwrap().len(), 1);
    }
}

#[test]
fn least_damped_mode_comes_first() {
    let document = run(&["poles", "three-mass", "--speed", "2.5", "--json"]).json();
    assert_eq!(document["stable"], false);
    assert_eq!(document["min_damping"], document["modes"][0]["damping"]);
    let damping: Vec<f64> =
        document["modes"].as_array().unwrap().iter().map(|m| m["damping"].as_f64().unwrap()).collect();
    assert_eq!(damping.len(), 6);
    assert!(damping.is_sorted(), "{damping:?}");
}

#[test]
fn bad_input_exits_2_and_says_what_was_expected() {
    for (arguments, complaint) in [
        (
            &["poles", "jefcott", "--speed", "0"][..],
            "whirl: no rotor 'jefcott': did you mean 'jeffcott'? built in are jeffcott, three-mass, rig; a path or a name that ends in .toml is a file\n",
        ),
        (
            &["poles", "jeffcott", "--speed", "0", "--feedback", "composite"],
            "whirl: no feedback 'composite' for jeffcott: built in are off, cancel; a path or a name that ends in .toml is a file\n",
        ),
        (&["poles", "--speed", "-1"], "whirl: speed = -1: expected a number from 0 to 1000\n"),
        (&["poles", "--speed", "nan"], "whirl: speed = NaN: expected a number from 0 to 1000\n"),
        (&["poles", "--speed", "1", "--deadband", "-2"], "whirl: deadband = -2: expected a number from 0 to 1000000\n"),
    ] {
        let ran = run(arguments);
        assert_eq!((ran.code, ran.stdout.as_str(), ran.stderr.as_str()), (Some(2), "", complaint), "{arguments:?}");
    }
}
