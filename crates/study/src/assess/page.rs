//! The assessment as a page: Markdown, or HTML that needs nothing beside it.

use super::Assessment;
use plot::{escaped, svg};

/// Said on every page.
pub const AID: &str = "An aid, not a certificate: limits are those commonly quoted of the standards named, not read from them, and can be changed.";

const STYLE: &str = "body{max-width:70rem;margin:2rem auto;padding:0 1rem;font:16px/1.5 system-ui,sans-serif;color:#222}\
    figure{margin:2em 0}svg{max-width:100%;height:auto;border:1px solid #ddd}table{border-collapse:collapse;font-size:.9rem}\
    th,td{border:1px solid #ccc;padding:.3em .5em;text-align:left;vertical-align:top}th{background:#f3f3f3}\
    .passed{color:#176b3a}.failed{color:#a11;font-weight:bold}";

/// A page's words, line by line, in the units of whoever reads it.
#[derive(Clone, Debug, Default)]
pub struct Words {
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
    /// The page as Markdown.
    #[must_use]
    pub fn markdown(&self, words: &Words) -> String {
        let mut out = format!("# {}\n", words.title);
        words.about.iter().map(String::as_str).chain([AID]).for_each(|line| out.push_str(&format!("\n{line}\n")));
        out.push('\n');
        out.push_str(&row(words.columns.iter().copied()));
        out.push_str(&row(words.columns.iter().map(|_| "---")));
        words.rows.iter().for_each(|cells| out.push_str(&row(cells.iter().map(String::as_str))));
        out
    }

    /// The page as one HTML file, its charts in it.
    #[must_use]
    pub fn html(&self, words: &Words) -> String {
        let title = escaped(&words.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
        );
        words
            .about
            .iter()
            .map(String::as_str)
            .chain([AID])
            .for_each(|line| out.push_str(&format!("<p>{}</p>\n", escaped(line))));
        out.push_str("<table>\n<tr>");
        words.columns.iter().for_each(|cell| out.push_str(&format!("<th>{}</th>", escaped(cell))));
        out.push_str("</tr>\n");
        for (line, cells) in self.lines.iter().zip(&words.rows) {
            let class = match line.passed {
                Some(true) => " class=\"passed\"",
                Some(false) => " class=\"failed\"",
                None => "",
            };
            out.push_str(&format!("<tr{class}>"));
            cells.iter().for_each(|cell| out.push_str(&format!("<td>{}</td>", escaped(cell))));
            out.push_str("</tr>\n");
        }
        out.push_str("</table>\n");
        for (k, chart) in self.charts.iter().enumerate() {
            let picture = svg(&chart.scene(), &format!("chart{k}"), &chart.title);
            out.push_str(&format!("<figure>\n{picture}</figure>\n"));
        }
        out + "</body>\n</html>\n"
    }
}

fn row<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    // A bar would end the cell.
    cells.fold("|".to_owned(), |line, cell| format!("{line} {} |", cell.replace('|', "\\|"))) + "\n"
}
