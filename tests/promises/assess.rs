//! `whirl assess`: a page of what standards ask, and refusals that say what is wrong.

use promises::run;
use serde_json::Value;

fn line<'a>(document: &'a Value, what: &str) -> &'a Value {
    let lines = document["lines"].as_array().expect("a list");
    lines.iter().find(|line| line["what"].as_str().is_some_and(|told| told.starts_with(what))).expect(what)
}

#[test]
fn every_line_says_what_was_found_asked_and_where() {
    let document = run(&["assess", "three-mass", "--feedback", "individual", "--over", "0..6", "--json"]).json();
    for line in document["lines"].as_array().expect("a list") {
        for field in ["what", "found", "asked", "unit", "passed", "where", "source"] {
            assert!(line.get(field).is_some(), "{field} of {line}");
        }
    }
    let sensitivity = line(&document, "sensitivity");
    assert!((sensitivity["found"].as_f64().expect("a number") - 1.19172).abs() < 1e-5, "{sensitivity}");
    assert_eq!((&sensitivity["note"], &sensitivity["passed"]), (&"zone A".into(), &true.into()));
    // The composite gains are alive, and not good enough.
    let document = run(&["assess", "three-mass", "--feedback", "composite", "--over", "0..6", "--json"]).json();
    assert_eq!(document["passed"], false);
    assert_eq!(line(&document, "sensitivity")["passed"], false);
}

#[test]
fn a_page_is_written_whole_with_its_charts_and_never_over_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("page.html");
    let args =
        ["assess", "three-mass", "--feedback", "individual", "--over", "0..6", "--out", page.to_str().expect("UTF-8")];
    assert_eq!(run(&args).code, Some(0));
    let html = std::fs::read_to_string(&page).expect("written");
    assert!(html.ends_with("</html>\n") && html.matches("<svg").count() == 4, "{}", html.matches("<svg").count());
    assert!(html.contains("An aid, not a certificate") && html.contains("zone A"));
    let refused = run(&args);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert_eq!(std::fs::read_to_string(&page).expect("still there"), html);
    let page = folder.path().join("page.md");
    let ran = run(&["assess", "three-mass", "--over", "0..1", "--out", page.to_str().expect("UTF-8")]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(std::fs::read_to_string(&page).expect("written").starts_with("# three-mass: what standards ask"));
}

#[test]
fn limits_are_a_file_that_is_printed_changed_and_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("limits.toml");
    let printed = run(&["assess", "--print-limits"]).stdout;
    let changed = printed.replace("sensitivity_zone_a = 3.0", "sensitivity_zone_a = 1.1");
    assert_ne!(printed, changed);
    std::fs::write(&file, changed).expect("written");
    let file = file.to_str().expect("UTF-8");
    let document =
        run(&["assess", "three-mass", "--feedback", "individual", "--over", "0..6", "--limits", file, "--json"]).json();
    let sensitivity = line(&document, "sensitivity");
    assert_eq!((&sensitivity["asked"], &sensitivity["passed"]), (&1.1.into(), &false.into()));
    assert!(sensitivity["source"].as_str().expect("words").starts_with("changed"), "{sensitivity}");
}

#[test]
fn what_cannot_be_assessed_is_refused_by_name() {
    for (more, words) in [
        (&["--grade", "G2.5"][..], "--grade: expected a rotor in SI units"),
        (&["--operating", "5..7"], "--operating 5..7: expected a range within --over 0..6"),
        (&["--cross-at", "4"], "--cross-at 4: expected a mass from 1 to 3"),
        (&["--clearance", "0"], "--clearance 0: expected a finite number above 0"),
        (&["--out", "page.pdf"], "'page.pdf': expected a page that ends in .html or .md"),
        (&["--limits", "nowhere.toml"], "nowhere.toml: no such file"),
    ] {
        let ran = run(&[&["assess", "three-mass", "--over", "0..6"], more].concat());
        assert_eq!(ran.code, Some(2), "{more:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{more:?}: {}", ran.stderr);
        assert!(ran.stdout.is_empty());
    }
}
