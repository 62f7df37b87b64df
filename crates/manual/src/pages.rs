//! The pages, and the summary that orders them.

use crate::layout::{Look, show};

/// A table of pages by topic: the file names of the book, without their ending.
macro_rules! pages {
    ($($topic:literal),* $(,)?) => {
        const PAGES: &[(&str, &str)] =
            &[$(($topic, include_str!(concat!("../../../docs/book/src/", $topic, ".md")))),*];
    };
}

pages! {
    "introduction",
    "tutorial",
    "bring-a-rotor",
    "import-a-rotor",
    "tune-for-deadband",
    "add-a-delay",
    "pass-a-critical-speed",
    "after-a-trip",
    "write-a-controller",
    "sweep-on-a-cluster",
    "coming-from",
    "console",
    "bench",
    "recordings",
    "join",
    "files",
    "loop",
    "analysis",
    "search",
    "commands",
    "settings",
    "keys",
    "layouts",
    "alarms",
    "file-keys",
    "json",
    "exit-codes",
    "protocol",
    "model",
    "circular-whirl",
    "search-and-proof",
    "certainty",
    "nasa-report",
    "side-by-side",
    "gain-search",
    "measurements",
    "validation",
}

const SUMMARY: &str = include_str!("../../../docs/book/src/SUMMARY.md");

/// A page of the book.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Page {
    /// What it is asked for by.
    pub topic: &'static str,
    /// Its title in the summary.
    pub title: &'static str,
    /// Its Markdown.
    pub markdown: &'static str,
}

impl Page {
    /// It as text in lines of at most `width` cells, but for what must not be broken: lines of commands, of files and of output.
    #[must_use]
    pub fn show(&self, width: usize, look: Look) -> String {
        show(self.markdown, width, look)
    }
}

/// A part of the book.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BookPart {
    /// Its heading; empty before the first.
    pub title: &'static str,
    /// Its pages, in order.
    pub pages: Vec<Page>,
}

/// Why a page is not shown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no page '{topic}'{}", near.map_or_else(String::new, |near| format!(": did you mean '{near}'?")))]
pub struct NoPage {
    /// What was asked for.
    pub topic: String,
    /// What was probably meant.
    pub near: Option<&'static str>,
}

/// The parts of the book, as its summary has them.
#[must_use]
pub fn parts() -> Vec<BookPart> {
    let mut parts = vec![BookPart { title: "", pages: Vec::new() }];
    for line in SUMMARY.lines().map(str::trim) {
        // The heading of the summary itself is none of a part.
        if let Some(title) = line.strip_prefix("# ").filter(|title| *title != "Summary") {
            parts.push(BookPart { title, pages: Vec::new() });
        }
        let listed = line.trim_start_matches("- ").strip_prefix('[').and_then(|rest| rest.split_once("]("));
        let Some((title, file)) = listed else { continue };
        let found = PAGES.iter().find(|(topic, _)| file.trim_end_matches(')') == format!("{topic}.md"));
        if let (Some(&(topic, markdown)), Some(part)) = (found, parts.last_mut()) {
            part.pages.push(Page { topic, title, markdown });
        }
    }
    parts.retain(|part| !part.pages.is_empty());
    parts
}

/// The topics, in the order of the book.
pub fn topics() -> impl Iterator<Item = &'static str> {
    parts().into_iter().flat_map(|part| part.pages).map(|page| page.topic)
}

/// The page of a topic.
///
/// # Errors
/// There is none; the error says which was probably meant.
pub fn page(topic: &str) -> Result<Page, NoPage> {
    let all: Vec<Page> = parts().into_iter().flat_map(|part| part.pages).collect();
    let asked = topic.trim_end_matches(".md");
    all.iter().copied().find(|page| page.topic == asked).ok_or_else(|| {
        let topics: Vec<&str> = all.iter().map(|page| page.topic).collect();
        NoPage { topic: topic.to_owned(), near: text::nearest(asked, &topics) }
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_file_of_the_book_is_a_page_in_the_summary_and_in_the_table() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/book/src");
        let files = std::fs::read_dir(folder).expect("the book is there").flatten();
        let names = files.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let mut there: BTreeSet<String> = names.filter_map(|name| Some(name.strip_suffix(".md")?.to_owned())).collect();
        there.remove("SUMMARY");
        assert_eq!(topics().map(str::to_owned).collect::<BTreeSet<_>>(), there);
        assert_eq!(topics().count(), PAGES.len());
    }

    #[test]
    fn a_topic_that_is_none_names_the_one_that_was_meant() {
        assert_eq!(page("console.md"), page("console"));
        assert_eq!(page("recording").expect_err("none").near, Some("recordings"));
        assert_eq!(page("zebra").expect_err("none").to_string(), "no page 'zebra'");
    }
}
