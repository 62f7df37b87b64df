//! Corners of filters that move with the gains.

use promises::run;

use super::{folder, number, text};

/// Gains behind filters that are in the wrong place.
const SHAPED: &str = "bearing = 1\nfilter = [{ kind = \"lowpass\", corner = 12.0, order = 2 }]\n\
    [[signal]]\ndisplacement = [1, 1, 0]\nvelocity = [1, 1, 0]\nkd = -0.5879\ncd = 0.4948\nkc = -0.4847\ncc = 0.6483\n\
    filter = [{ kind = \"lead\", zero = 6.0, pole = 9.0 }]\n";

#[test]
fn corners_of_filters_move_within_their_ranges_and_stand_in_the_file() {
    let folder = folder();
    let (file, out) = (folder.path().join("shaped.toml"), folder.path().join("moved.toml"));
    std::fs::write(&file, SHAPED).expect("written");
    let ask = ["tune", "three-mass", "--speed", "4", "--feedback", text(&file), "--starts", "2", "--json"];
    let fixed = run(&ask).json();
    assert!(fixed.get("corners").is_none(), "{fixed}");
    let moved = ["--corners", "all", "--corners", "zero=2..8", "--max-sensitivity", "4", "--out", text(&out)];
    let document = run(&[&ask[..], &moved[..]].concat()).json();
    assert!(number(&document, "min_damping") > number(&fixed, "min_damping"), "{document}");
    let corners = document["corners"].as_array().expect("a list");
    let named: Vec<&str> = corners.iter().map(|corner| corner["corner"].as_str().expect("a name")).collect();
    assert_eq!(named, ["signal.1.filter.1.zero", "signal.1.filter.1.pole", "filter.1.corner"]);
    let of = |k: usize, field: &str| number(&corners[k], field);
    assert_eq!([of(0, "before"), of(0, "from"), of(0, "to"), of(1, "to")], [6.0, 2.0, 8.0, 36.0]);
    assert!((0..3).all(|k| (of(k, "from")..=of(k, "to")).contains(&of(k, "value"))), "{document}");
    assert_eq!(document["feedback"]["filter"][0]["corner"], corners[2]["value"]);
    // What is written is what was found: the machine has that damping and that sensitivity.
    let poles = run(&["poles", "three-mass", "--speed", "4", "--feedback", text(&out), "--json"]).json();
    assert!((number(&poles, "min_damping") - number(&document, "min_damping")).abs() < 1e-6, "{poles}");
    let margins = run(&["margin", "three-mass", "--speed", "4", "--feedback", text(&out), "--json"]).json();
    let peak = margins["sensitivity"]["peak"].as_f64().expect("a number");
    assert!(peak <= 4.0 * 1.001, "{peak}");
    assert!((peak - number(&document["sensitivity"], "peak")).abs() < 1e-4 * peak, "{peak} {document}");
    let table = run(&[&ask[..8], &["--corners", "filter.1.corner=50%", "--csv"]].concat());
    assert!(table.stdout.contains("\nfilter.1,corner,,6"), "{table:?}");
}

#[test]
fn the_corners_of_a_law_in_a_drawing_are_told_in_hertz() {
    let folder = folder();
    let out = folder.path().join("moved.toml");
    let ask = ["tune", "rig", "--speed", "6000", "--starts", "1", "--out", text(&out)];
    let found = run(&[&ask[..], &["--corners", "zero.2=20..90"]].concat());
    assert_eq!(found.code, Some(0), "{found:?}");
    assert!(found.stdout.contains("corners in Hz"), "{}", found.stdout);
    let row = found.stdout.lines().find(|line| line.contains("left.signal.1.filter.1")).expect("a row");
    let hertz: f64 = row.split_whitespace().last().expect("a value").parse().expect("a number");
    assert!((20.0..=90.0).contains(&hertz) && row.contains("zero.2"), "{row}");
    assert_eq!(run(&["margin", "rig", "--speed", "6000", "--feedback", text(&out)]).code, Some(0));
}

#[test]
fn corners_that_are_not_there_or_cannot_move_are_refused() {
    let folder = folder();
    let file = folder.path().join("shaped.toml");
    std::fs::write(&file, SHAPED).expect("written");
    for (options, why) in [
        (
            &["--corners", "all"][..],
            "the loop that is searched has no filters: give one that has, with --feedback FILE",
        ),
        (
            &["--feedback", text(&file), "--corners", "right"],
            "no corner 'right': that law of three-mass has signal.1.filter.1.zero, ",
        ),
        (&["--feedback", text(&file), "--corners", "zero=0..3"], "KEY=A..B above 0"),
        (&["--feedback", text(&file), "--corners", "zero=3"], "KEY=A..B above 0"),
        (&["--feedback", text(&file), "--corners", ""], "expected all or a corner"),
    ] {
        let refused = run(&[&["tune", "three-mass", "--speed", "4"], options].concat());
        assert!(refused.code == Some(2) && refused.stderr.contains(why), "{options:?}: {refused:?}");
        assert_eq!(refused.stdout, "");
    }
    let track = ["tune", "three-mass", "--over", "0..4", "--track", "3", "--corners", "all"];
    assert!(run(&track).stderr.contains("cannot be used with"));
}
