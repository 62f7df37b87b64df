//! The NASA report again: the page that is committed is the one that is made.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use plot::{png, svg};
use study::report::{self, Onlooker, Report, Verdict};

fn made() -> &'static Report {
    static MADE: OnceLock<Report> = OnceLock::new();
    MADE.get_or_init(|| {
        let (stop, count) = (AtomicBool::new(false), AtomicUsize::new(0));
        let done = || {
            count.fetch_add(1, Ordering::Relaxed);
        };
        let made = report::make(&Onlooker { stop: &stop, done: &done }).expect("computes");
        assert_eq!(count.into_inner(), report::steps());
        made
    })
}

/// Words, and numbers with a unit of their last digit.
#[derive(Debug, PartialEq)]
enum Token {
    Text(String),
    Number(f64, f64),
}

fn tokens(line: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let is_number = first.is_ascii_digit();
        let end =
            rest.find(|c: char| (c.is_ascii_digit() || (is_number && c == '.')) != is_number).unwrap_or(rest.len());
        let part = &rest[..end];
        rest = &rest[end..];
        match part.trim_end_matches('.').parse::<f64>() {
            Ok(value) if is_number => {
                let decimals = part.trim_end_matches('.').split_once('.').map_or(0, |(_, d)| d.len());
                tokens.push(Token::Number(value, 10_f64.powi(-(decimals as i32))));
            }
            _ => tokens.push(Token::Text(part.to_owned())),
        }
    }
    tokens
}

/// The words must be the same; a number may differ by one in its last digit, for other processors round otherwise.
fn agrees(ours: &str, committed: &str) -> bool {
    let (ours, committed) = (tokens(ours), tokens(committed));
    ours.len() == committed.len()
        && ours.iter().zip(&committed).all(|pair| match pair {
            (Token::Number(a, unit), Token::Number(b, other)) => unit == other && (a - b).abs() <= 1.001 * unit,
            (a, b) => a == b,
        })
}

#[test]
fn the_committed_page_is_the_one_that_is_made() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/book/src/nasa-report.md");
    let committed = std::fs::read_to_string(path).expect("docs/book/src/nasa-report.md is committed");
    let page = made().markdown(false);
    for (i, (ours, committed)) in page.lines().zip(committed.lines()).enumerate() {
        assert!(
            agrees(ours, committed),
            "docs/book/src/nasa-report.md:{}: make it again with `cargo run --release -- report --page docs/book/src/nasa-report.md`\n made: {ours}\n \
             there: {committed}",
            i + 1
        );
    }
    assert_eq!(page.lines().count(), committed.lines().count());
}

#[test]
fn the_comparison_of_pages_sees_what_changes() {
    assert!(agrees("| 2.209975 | ≈ 3.", "| 2.209976 | ≈ 3."));
    assert!(!agrees("| 2.209975 |", "| 2.209977 |"));
    assert!(!agrees("| 2.209975 |", "| 2.21 |"));
    assert!(!agrees("| holds |", "| does not hold |"));
}

#[test]
fn val_printed_numbers_are_met_but_for_those_that_are_known_not_to_be() {
    let with = |verdict| -> Vec<&str> {
        made().comparisons.iter().filter(|c| c.verdict() == verdict).map(|c| c.quantity).collect()
    };
    assert_eq!(
        with(Verdict::Differs),
        ["eigenvalue 2, real part", "stable with gains optimised for each speed up to R"]
    );
    assert_eq!(with(Verdict::LastDigit), ["first critical speed without control", "first threshold, in the caption"]);
    assert_eq!(with(Verdict::Reconstructed).len(), 3);
    assert_eq!(
        with(Verdict::DoesNotHold),
        [
            "gains tracked over speed",
            "poles with them, at lower speeds",
            "the gains of R = 7.2, held constant",
            "gains that depend on speed, against constant ones",
            "reach of the control, % of the first threshold",
            "steady forces of Fig. 4.16: would the motion stay",
            "peak of the force for g = 0",
            "peak of the force for g = 1",
            "force for g = 10, against g = 0 and g = 1",
            "force for g = 0 and 1, against Fig. 3.7",
            "amplitudes at R = 6, g = 1",
            "amplitudes at R = 6, g = 10"
        ]
    );
    assert!(with(Verdict::EveryDigit).len() >= 12 && with(Verdict::Holds).len() >= 20);
}

#[test]
fn every_figure_is_there_with_axes_units_data_and_both_pictures() {
    let numbers: Vec<&str> = made().figures.iter().map(|f| f.number).collect();
    let chapter_3 = (4..=11).map(|i| format!("3.{i}"));
    let chapter_4 = (2..=5).chain(7..=26).map(|i| format!("4.{i}"));
    assert_eq!(numbers, chapter_3.chain(chapter_4).collect::<Vec<_>>());
    for figure in &made().figures {
        let picture = svg(&figure.chart.scene(), &figure.stem(), figure.title);
        assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"));
        assert!(!picture.contains("NaN") && !picture.contains("inf"), "{}", figure.number);
        assert!(picture.len() < 100_000, "{}: {} bytes", figure.number, picture.len());
        assert!(png(&picture).expect("draws").starts_with(b"\x89PNG"), "{}", figure.number);
        for axis in [&figure.chart.x, &figure.chart.y] {
            assert!(axis.label.contains('('), "{}: no unit in {}", figure.number, axis.label);
        }
        assert!(figure.data.rows.len() > 40, "{}", figure.number);
        assert!(figure.data.rows.iter().all(|row| row.len() == figure.data.header.len()), "{}", figure.number);
    }
}

#[test]
fn the_html_page_needs_nothing_beside_it() {
    let page = made().html();
    assert_eq!(page.matches("<svg").count(), made().figures.len());
    for outside in ["<img", "<script", "<link", "src=", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
}

#[test]
fn a_request_to_stop_is_heard() {
    let stop = AtomicBool::new(true);
    let stopped = report::make(&Onlooker { stop: &stop, done: &|| () });
    assert!(matches!(stopped, Err(report::ReportError::Interrupted)));
}
