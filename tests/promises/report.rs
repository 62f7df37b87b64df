//! `whirl report`: all of its files or none, and nobody else's.

use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use promises::{run, whirl};

/// Files below `folder`, hidden ones too.
fn count(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| if entry.path().is_dir() { count(&entry.path()) } else { 1 }).sum()
}

#[test]
fn writes_every_figure_and_the_page_and_leaves_other_files_alone() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/report");
    std::fs::create_dir_all(&out).unwrap();
    std::fs::write(out.join("mine.txt"), "mine").unwrap();
    std::fs::write(out.join("index.html"), "old").unwrap();
    let refused = run(&["report", "--out", out.to_str().unwrap()]);
    assert!(refused.code == Some(2) && refused.stderr.contains("index.html' is already there"), "{refused:?}");
    let document = run(&["report", "--out", out.to_str().unwrap(), "--force", "--json"]).json();
    let figures = document["figures"].as_array().unwrap();
    assert_eq!(figures.len(), 32);
    for figure in figures {
        let stem = figure["stem"].as_str().unwrap();
        for file in [format!("figures/{stem}.svg"), format!("figures/{stem}.png"), format!("data/{stem}.csv")] {
            assert!(std::fs::metadata(out.join(&file)).unwrap().len() > 500, "{file}");
        }
    }
    assert_eq!(document["files"], count(&out) - 1);
    assert_eq!(std::fs::read_to_string(out.join("mine.txt")).unwrap(), "mine");
    assert!(std::fs::read_to_string(out.join("index.html")).unwrap().contains("Fig. 4.26"));
    let threshold = &document["numbers"][0];
    assert_eq!((threshold["report"].as_str(), threshold["agreement"].as_str()), (Some("2.2"), Some("every_digit")));
    assert!((threshold["ours"].as_f64().unwrap() - 2.209_975).abs() < 5e-7);
}

#[test]
fn an_interrupted_report_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let mut report = whirl().args(["report", "--out", out.to_str().unwrap()]).stdout(Stdio::null()).spawn().unwrap();
    // The folder is made once signals are handled.
    let began = Instant::now();
    while !out.is_dir() && began.elapsed() < Duration::from_secs(30) {
        std::thread::sleep(Duration::from_millis(2));
    }
    let pid = rustix::process::Pid::from_child(&report);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
    assert_eq!(report.wait().unwrap().code(), Some(130));
    assert_eq!(count(&out), 0);
}

#[test]
fn a_folder_that_cannot_be_made_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").unwrap();
    let inside = file.join("report");
    for (option, path, why) in [
        ("--out", file.to_str().unwrap(), "this folder cannot be made"),
        ("--out", inside.to_str().unwrap(), "this folder cannot be made"),
        ("--page", folder.path().to_str().unwrap(), "is a directory"),
        ("--page", inside.to_str().unwrap(), "there is no folder"),
    ] {
        let ran = run(&["report", option, path]);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{ran:?}");
        assert!(ran.stderr.contains(why), "{ran:?}");
    }
    assert_eq!(run(&["report"]).code, Some(2));
    assert_eq!(count(folder.path()), 1);
}
