//! A figure, and the line of a chapter's table that makes it.

use super::evidence::Evidence;
use super::{Data, ReportError};
use plot::Chart;

/// One figure of the report, made again.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its number in the report, such as `3.4`.
    pub number: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// What is to be seen, in our own words.
    pub caption: &'static str,
    /// How far it can agree with the report's.
    pub agreement: &'static str,
    /// The picture.
    pub chart: Chart,
    /// What is in the picture.
    pub data: Data,
}

impl Figure {
    /// The name of its files without the ending, such as `fig-3.04`, so that names sort as the figures do.
    #[must_use]
    pub fn stem(&self) -> String {
        match self.number.split_once('.') {
            Some((chapter, place)) => format!("fig-{chapter}.{place:0>2}"),
            None => format!("fig-{}", self.number),
        }
    }
}

/// What makes a picture and its data from all that was computed; the words are the picture's title.
pub(super) type Maker = fn(&Evidence, &str) -> Result<(Chart, Data), ReportError>;

/// One line of the table of figures.
pub(super) struct Entry {
    pub number: &'static str,
    pub title: &'static str,
    pub caption: &'static str,
    pub agreement: &'static str,
    pub make: Maker,
}
