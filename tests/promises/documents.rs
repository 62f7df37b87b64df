//! Every command in the documents does what it says: each block of commands of README.md and its kind is run, line by line
//! and in order, as its reader would.
//!
//! The word behind the three backticks says what a block is ([`fence`]); [`reader`] is who types the lines.

mod fence;
mod five_minutes;
mod reader;

use std::collections::BTreeSet;
use std::fs;

use fence::{Block, Fence, fences};
use promises::paper::{paper, top};
use reader::Reader;

/// A test a document: one reader, one folder, one root of shared memory for all its blocks.
macro_rules! documents {
    ($($name:ident: $path:literal),* $(,)?) => {
        const TRIED: &[&str] = &[$($path),*];
        $(
            #[test]
            fn $name() {
                follow($path);
            }
        )*
    };
}

documents! {
    commands_of_the_readme: "README.md",
    commands_of_introduction: "docs/book/src/introduction.md",
    commands_of_tutorial: "docs/book/src/tutorial.md",
    commands_of_bring_a_rotor: "docs/book/src/bring-a-rotor.md",
    commands_of_import_a_rotor: "docs/book/src/import-a-rotor.md",
    commands_of_tune_for_deadband: "docs/book/src/tune-for-deadband.md",
    commands_of_add_a_delay: "docs/book/src/add-a-delay.md",
    commands_of_pass_a_critical_speed: "docs/book/src/pass-a-critical-speed.md",
    commands_of_after_a_trip: "docs/book/src/after-a-trip.md",
    commands_of_write_a_controller: "docs/book/src/write-a-controller.md",
    commands_of_sweep_on_a_cluster: "docs/book/src/sweep-on-a-cluster.md",
    commands_of_coming_from: "docs/book/src/coming-from.md",
    commands_of_console: "docs/book/src/console.md",
    commands_of_bench: "docs/book/src/bench.md",
    commands_of_recordings: "docs/book/src/recordings.md",
    commands_of_join: "docs/book/src/join.md",
    commands_of_files: "docs/book/src/files.md",
    commands_of_loop: "docs/book/src/loop.md",
    commands_of_analysis: "docs/book/src/analysis.md",
    commands_of_search: "docs/book/src/search.md",
    commands_of_protocol: "docs/book/src/protocol.md",
    commands_of_circular_whirl: "docs/book/src/circular-whirl.md",
    commands_of_the_sample_recordings: "recordings/README.md",
}

/// The pages of the book, and their order.
const BOOK: &str = "docs/book/src";
const SUMMARY: &str = "docs/book/src/SUMMARY.md";

/// Blocks that no test runs, of all documents. Each says why.
const NOT_RUN: usize = 11;

fn follow(path: &str) {
    let mut reader = Reader::new();
    let (mut run, mut left_to_the_feature, mut is_left) = (0, 0, false);
    for Fence { line, block, text } in fences(path) {
        let place = format!("{path}:{line}");
        match block {
            Block::Commands => {
                run += reader.types(&place, &text);
                is_left = false;
            }
            Block::Recordings if cfg!(feature = "rerun") => run += reader.types(&place, &text),
            Block::Recordings => {
                left_to_the_feature += 1;
                is_left = true;
            }
            // Of a command that was not run nothing was seen.
            Block::Printed if is_left => {}
            Block::Printed => reader.has_seen(&place, &text),
            Block::File(name) => reader.writes(&name, &text),
            Block::NotRun(_) | Block::Other => {}
        }
    }
    assert!(run > 0 || left_to_the_feature > 0, "{path} has no commands");
    reader.leaves();
}

#[test]
fn every_document_with_commands_is_tried_and_what_is_not_run_says_why() {
    let documents = documents();
    assert!(documents.len() > 10, "{documents:?}");
    let mut not_run = 0;
    for document in &documents {
        let blocks: Vec<Block> = fences(document).into_iter().map(|fence| fence.block).collect();
        let has_commands = blocks.iter().any(|block| matches!(block, Block::Commands | Block::Recordings));
        assert_eq!(has_commands, TRIED.contains(&&**document), "{document}: has commands, and is tried");
        for block in blocks {
            if let Block::NotRun(why) = block {
                assert!(why.len() > 10, "{document}: a block that is not run says why");
                not_run += 1;
            }
        }
    }
    assert_eq!(not_run, NOT_RUN, "blocks that are not run");
}

/// Its block about recordings named one file six times: run from top to bottom it destroyed the session it began with.
#[test]
fn regress_no_document_writes_a_file_twice() {
    let mut all = 0;
    for document in TRIED {
        let mut written = BTreeSet::new();
        for fence in fences(document) {
            if !matches!(fence.block, Block::Commands | Block::Recordings) {
                continue;
            }
            for line in fence.text.lines() {
                let words: Vec<&str> = reader::command(line).split_whitespace().collect();
                for pair in words.windows(2) {
                    if matches!(pair[0], "--out" | "--plot" | "--record" | "--picture" | "--page" | "record" | ">") {
                        assert!(written.insert(pair[1].to_owned()), "{document}: {} is written twice: {line}", pair[1]);
                    }
                }
                if words.get(1) == Some(&"export") {
                    let kind = if words.contains(&"--parquet") { "parquet" } else { "csv" };
                    assert!(written.insert(words[2].replace(".rrd", &format!(".{kind}"))), "{line}");
                    // The sample is there from the start.
                    let is_there = words[2].starts_with("recordings/") || written.contains(words[2]);
                    assert!(is_there, "nothing has written {}: {line}", words[2]);
                }
            }
        }
        all += written.len();
    }
    assert!(all > 15, "{all} files");
}

#[test]
fn the_readme_is_short_and_the_book_has_every_page_once() {
    let readme = paper("README.md");
    assert!(
        readme.len() <= 8192,
        "README.md has {} bytes: what is not for a first visit goes to the book",
        readme.len()
    );
    let listed: Vec<String> = links(&paper(SUMMARY)).into_iter().map(|page| format!("{BOOK}/{page}")).collect();
    let once: BTreeSet<String> = listed.iter().cloned().collect();
    assert_eq!(once.len(), listed.len(), "{SUMMARY} lists a page twice: {listed:?}");
    let mut there = documents();
    there.retain(|document| document.starts_with(BOOK) && document != SUMMARY);
    assert_eq!(once, there, "pages that {SUMMARY} lists, and those that are there");
    for page in &there {
        // Behind the comment that a page was made.
        let begins = paper(page).lines().find(|line| !line.is_empty() && !line.starts_with("<!--")).map(str::to_owned);
        assert!(begins.is_some_and(|line| line.starts_with("# ")), "{page} does not begin with its title");
    }
}

#[test]
fn every_link_of_the_documents_leads_somewhere() {
    let mut followed = 0;
    for document in &documents() {
        let folder = top().join(document).parent().expect("a document is in a folder").to_owned();
        for link in links(&paper(document)) {
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { top().join(document) } else { folder.join(file) };
            assert!(target.exists(), "{document}: nothing is at {link}");
            // The book is read without the repository.
            let leaves = document.starts_with(BOOK) && file.starts_with("..");
            assert!(!leaves, "{document}: {link} is not in the book");
            if !anchor.is_empty() {
                let target = fs::read_to_string(&target).expect("a text");
                assert!(anchors(&target).contains(anchor), "{document}: no heading for {link}");
            }
            followed += 1;
        }
    }
    assert!(followed > 50, "only {followed} links");
}

/// All documents, by their paths in the repository.
fn documents() -> BTreeSet<String> {
    let mut documents: BTreeSet<String> = BTreeSet::new();
    for folder in [".", BOOK, "recordings"] {
        for entry in fs::read_dir(top().join(folder)).expect("a folder").flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.ends_with(".md") {
                documents.insert(if folder == "." { name } else { format!("{folder}/{name}") });
            }
        }
    }
    documents
}

/// Where the links and pictures of a text lead to, but those to other places of the world.
fn links(text: &str) -> Vec<String> {
    let all = text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(link, _)| link);
    all.filter(|link| !link.contains("://") && !link.contains(char::is_whitespace)).map(str::to_owned).collect()
}

/// What a Markdown viewer calls the headings of a text.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let named = headings.map(|line| {
        let kept = line.trim_start_matches('#').trim().to_lowercase();
        kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-')).collect::<String>().replace(' ', "-")
    });
    named.collect()
}
