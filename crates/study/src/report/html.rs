//! The page as HTML that needs nothing beside it: the figures are in it, as SVG.

use super::Report;
use super::page::{Block, blocks};
use plot::{escaped, svg};

const STYLE: &str = "body{max-width:70rem;margin:2rem auto;padding:0 1rem;font:16px/1.5 system-ui,sans-serif;color:#222}\
    h1,h2,h3{line-height:1.2}h2{margin-top:2.5em}figure{margin:2em 0}svg{max-width:100%;height:auto;border:1px solid #ddd}\
    table{border-collapse:collapse;font-size:.86rem;display:block;overflow-x:auto}\
    th,td{border:1px solid #ccc;padding:.3em .5em;text-align:left;vertical-align:top}th{background:#f3f3f3}\
    figcaption{max-width:50rem}";

impl Report {
    /// The page as one HTML file.
    #[must_use]
    pub fn html(&self) -> String {
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width\">\n<title>The NASA report again</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        );
        for block in blocks(self) {
            match block {
                Block::Heading(level, words) => {
                    out.push_str(&format!("<h{level}>{}</h{level}>\n", escaped(&words)));
                }
                Block::Paragraph(words) => out.push_str(&format!("<p>{}</p>\n", escaped(&words))),
                Block::Table(header, rows) => {
                    out.push_str("<table>\n<tr>");
                    header.iter().for_each(|cell| out.push_str(&format!("<th>{}</th>", escaped(cell))));
                    out.push_str("</tr>\n");
                    for row in rows {
                        out.push_str("<tr>");
                        row.iter().for_each(|cell| out.push_str(&format!("<td>{}</td>", escaped(cell))));
                        out.push_str("</tr>\n");
                    }
                    out.push_str("</table>\n");
                }
                Block::Figure(figure) => {
                    let (caption, agreement) = (escaped(figure.caption), escaped(figure.agreement));
                    let stem = figure.stem();
                    out.push_str(&format!(
                        "<figure id=\"{stem}\">\n{}<figcaption><strong>Fig. {}.</strong> {caption}<br><em>Agreement.</em> \
                         {agreement}</figcaption>\n</figure>\n",
                        svg(&figure.chart.scene(), &stem, figure.title),
                        figure.number,
                    ));
                }
            }
        }
        out + "</body>\n</html>\n"
    }
}
