//! What stands on the page of an assessment.

use super::Assessment;
use crate::page::{Block, Figure, Page, TableRow};

/// Said on every page.
pub const AID: &str = "An aid, not a certificate: limits are those commonly quoted of the standards named, not read from them, and can be changed.";

/// A page's words, line by line, in the units of whoever reads it.
#[derive(Clone, Debug, Default)]
pub struct PageWords {
    /// The heading.
    pub title: String,
    /// What was assessed, a paragraph each.
    pub about: Vec<String>,
    /// Headings of the columns.
    pub columns: Vec<&'static str>,
    /// One row a line, as many cells as there are columns.
    pub rows: Vec<Vec<String>>,
}

impl Assessment {
    /// The page as Markdown, without its charts.
    #[must_use]
    pub fn markdown(&self, words: &PageWords) -> String {
        self.page(words).markdown(false)
    }

    /// The page as one HTML file, its charts in it.
    #[must_use]
    pub fn html(&self, words: &PageWords) -> String {
        self.page(words).html()
    }

    fn page<'a>(&'a self, words: &'a PageWords) -> Page<'a> {
        let about = words.about.iter().map(String::as_str).chain([AID]);
        let rows = self.lines.iter().zip(&words.rows);
        let rows = rows.map(|(line, cells)| TableRow { cells: cells.clone(), passed: line.passed }).collect();
        let charts = self.charts.iter().enumerate().map(|(k, chart)| {
            Block::Figure(Figure { id: format!("chart{k}"), title: &chart.title, chart, caption: None })
        });
        let blocks = std::iter::once(Block::Heading(1, words.title.clone()))
            .chain(about.map(|line| Block::Paragraph(line.to_owned())))
            .chain([Block::Table(words.columns.clone(), rows)])
            .chain(charts);
        Page { title: &words.title, blocks: blocks.collect() }
    }
}
