//! `whirl help`: the pages of the book in the terminal, and what commands take.

use promises::run;

#[test]
fn every_page_is_shown_plain_to_a_pipe() {
    let listed = run(&["help"]);
    assert_eq!((listed.code, listed.stderr.as_str()), (Some(0), ""));
    let topics: Vec<&str> = manual::topics().collect();
    assert!(topics.len() > 30, "{topics:?}");
    for topic in topics {
        assert!(listed.stdout.contains(&format!("\n  {topic} ")), "`whirl help` does not list {topic}");
        let shown = run(&["help", topic]);
        let begins = manual::page(topic).expect("it is listed").markdown;
        let title = begins.lines().find_map(|line| line.strip_prefix("# ")).expect("a title");
        assert_eq!(shown.code, Some(0), "{topic}");
        assert!(shown.stdout.starts_with(title) && !shown.stdout.contains('\x1b'), "{topic}: {}", shown.stdout);
    }
}

#[test]
fn help_of_a_command_is_that_of_the_command() {
    for words in [vec!["poles"], vec!["rotor", "import"], vec!["tune"], vec!["help"]] {
        let asked = run(&[&["help"], &words[..]].concat());
        let own = run(&[&words[..], &["--help"]].concat());
        assert_eq!((asked.code, asked.stdout), (Some(0), own.stdout), "{words:?}");
    }
}

#[test]
fn what_is_neither_lists_the_pages_and_says_what_was_meant() {
    for (typed, meant) in [("consol", Some("console")), ("pols", Some("poles")), ("zebra", None)] {
        let refused = run(&["help", typed]);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
        let expected = meant.map_or_else(String::new, |meant| format!("; did you mean '{meant}'?"));
        let begins = format!("whirl: no page and no command '{typed}': expected one of these{expected}\n");
        assert!(refused.stderr.starts_with(&begins) && refused.stderr.contains("nasa-report"), "{refused:?}");
    }
}
