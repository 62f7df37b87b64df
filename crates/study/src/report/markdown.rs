//! The page as Markdown.

use super::Report;
use super::page::{Block, blocks};

impl Report {
    /// The page as Markdown. With `pictures`, each figure shows its file in the folder `figures` beside the page and links
    /// to its data; without, captions stand alone.
    #[must_use]
    pub fn markdown(&self, pictures: bool) -> String {
        let made = if pictures { "whirl report --out DIR" } else { "whirl report --page FILE" };
        let mut out = format!("<!-- Made by `{made}`: do not edit. -->\n");
        for block in blocks(self) {
            out.push('\n');
            match block {
                Block::Heading(level, words) => out.push_str(&format!("{} {words}\n", "#".repeat(level.into()))),
                Block::Paragraph(words) => out.push_str(&format!("{words}\n")),
                Block::Table(header, rows) => {
                    out.push_str(&line(header.iter().copied()));
                    out.push_str(&line(header.iter().map(|_| "---")));
                    for row in rows {
                        out.push_str(&line(row.iter().map(String::as_str)));
                    }
                }
                Block::Figure(figure) => {
                    let stem = figure.stem();
                    out.push_str(&format!("### Fig. {}: {}\n\n", figure.number, figure.title));
                    if pictures {
                        out.push_str(&format!("![{}](figures/{stem}.svg)\n\n", figure.title));
                    }
                    out.push_str(&format!("{}\n\n*Agreement.* {}\n", figure.caption, figure.agreement));
                    if pictures {
                        out.push_str(&format!("\n[PNG](figures/{stem}.png) · [data](data/{stem}.csv)\n"));
                    }
                }
            }
        }
        out
    }
}

fn line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    // A bar would end the cell.
    cells.fold("|".to_owned(), |line, cell| format!("{line} {} |", cell.replace('|', "\\|"))) + "\n"
}
