//! `whirl dash --picture`: what the dashboard shows, as a file.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::fs;

use promises::Root;

#[test]
fn a_picture_shows_the_running_bench_as_text_and_as_svg() {
    let root = Root::new();
    let simulation = root.simulate(&["three-mass", "--bench", "a"]);
    let (text, svg) = (root.path().join("a.txt"), root.path().join("a.svg"));
    for (file, options) in [(&text, ["--ascii", "--layout=tuning"]), (&svg, ["--theme=full", "--layout=operator"])] {
        let file = file.to_str().unwrap();
        let of =
            ["dash", "--bench", "a", "--picture", file, "--size", "100x30", "--after", "1", options[0], options[1]];
        let ran = root.run(&of);
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{ran:?}");
    }
    let text = fs::read_to_string(text).unwrap();
    assert!(text.is_ascii() && text.lines().count() == 30, "{text}");
    for words in ["RUNNING", "three-mass", "damping over speed  stable 0 to 7.0", "settings  rev 1"] {
        assert!(text.contains(words), "{words}:\n{text}");
    }
    let svg = fs::read_to_string(svg).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.contains("minimum damping"));

    // Keys are pressed before it is taken, and what they ask for is done.
    let pressed = root.path().join("pressed.txt");
    let file = pressed.to_str().unwrap();
    let keys = ":speed 2.6<enter><1s>jjj<enter>-0.3";
    let ran = root.run(&["dash", "--bench", "a", "--picture", file, "--after", "1", "--press", keys]);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{ran:?}");
    let shown = fs::read_to_string(&pressed).unwrap();
    assert!(shown.contains("R 2.6") && shown.contains("-0.3_") && shown.contains("then 0."), "{shown}");
    assert_eq!(root.run(&["status", "--json"]).json()["benches"][0]["speed"], 2.6);
    let ran = root.run(&["dash", "--bench", "a", "--picture", file, "--press", "<nokey>"]);
    assert_eq!(ran.code, Some(2), "{ran:?}");

    let ran = root.run(&["dash", "--bench", "a", "--picture", "a.png"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("--picture a.png: expected a file that ends in .svg or .txt"), "{ran:?}");
    let ran = root.run(&["dash", "--bench", "a", "--picture", "a.svg", "--size", "0x30"]);
    assert_eq!(ran.code, Some(2));
    assert_eq!(simulation.end().code, Some(0));
    assert_eq!(root.run(&["dash", "--bench", "a", "--picture", "a.svg"]).code, Some(3), "no such bench any more");
}
