//! A page of headings, paragraphs, tables and charts, written as Markdown or as one HTML file that needs nothing beside it. What
//! stands on a page is the business of whoever makes it: the report's, and that of what standards ask.

use plot::{Chart, escaped, svg};

const STYLE: &str = "body{max-width:70rem;margin:2rem auto;padding:0 1rem;font:16px/1.5 system-ui,sans-serif;color:#222}\
    h1,h2,h3{line-height:1.2}h2{margin-top:2.5em}figure{margin:2em 0}svg{max-width:100%;height:auto;border:1px solid #ddd}\
    table{border-collapse:collapse;font-size:.86rem;display:block;overflow-x:auto}\
    th,td{border:1px solid #ccc;padding:.3em .5em;text-align:left;vertical-align:top}th{background:#f3f3f3}\
    figcaption{max-width:50rem}.passed{color:#176b3a}.failed{color:#a11;font-weight:bold}";

/// A page.
pub(crate) struct Page<'a> {
    /// What a browser calls it.
    pub title: &'a str,
    /// What stands on it, from the top.
    pub blocks: Vec<Block<'a>>,
}

/// A part of a page.
pub(crate) enum Block<'a> {
    /// A heading: its level from 1, and its words.
    Heading(u8, String),
    /// A paragraph.
    Paragraph(String),
    /// A table: its headings, and its rows.
    Table(Vec<&'a str>, Vec<TableRow>),
    /// A chart.
    Figure(Figure<'a>),
}

/// A row of a table.
pub(crate) struct TableRow {
    /// As many cells as there are headings.
    pub cells: Vec<String>,
    /// Whether what it tells is as it should be, where that is judged.
    pub passed: Option<bool>,
}

impl TableRow {
    /// A row that is not judged.
    pub(crate) fn plain(cells: Vec<String>) -> Self {
        Self { cells, passed: None }
    }
}

/// A chart with its words.
pub(crate) struct Figure<'a> {
    /// Names it within the page.
    pub id: String,
    /// What it is, in a few words.
    pub title: &'a str,
    /// The chart.
    pub chart: &'a Chart,
    /// What is said below it; a chart without stands in HTML alone.
    pub caption: Option<Caption<'a>>,
}

/// What is said below a chart.
pub(crate) struct Caption<'a> {
    /// How others refer to it: `Fig. 3.4`.
    pub label: String,
    /// What is to be seen.
    pub words: &'a str,
    /// A remark, and the word that leads it.
    pub remark: (&'a str, &'a str),
}

impl Page<'_> {
    /// The page as one HTML file, its charts in it as SVG.
    pub(crate) fn html(&self) -> String {
        let title = escaped(self.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        );
        for block in &self.blocks {
            out.push_str(&match block {
                Block::Heading(level, words) => format!("<h{level}>{}</h{level}>\n", escaped(words)),
                Block::Paragraph(words) => format!("<p>{}</p>\n", escaped(words)),
                Block::Table(header, rows) => html_table(header, rows),
                Block::Figure(figure) => figure.html(),
            });
        }
        out + "</body>\n</html>\n"
    }

    /// The page as Markdown. With `files`, each chart with a caption shows its file in the folder `figures` beside the page and
    /// links to its data; without, captions stand alone.
    pub(crate) fn markdown(&self, files: bool) -> String {
        let blocks = self.blocks.iter().map(|block| match block {
            Block::Heading(level, words) => format!("{} {words}\n", "#".repeat((*level).into())),
            Block::Paragraph(words) => format!("{words}\n"),
            Block::Table(header, rows) => markdown_table(header, rows),
            Block::Figure(figure) => figure.markdown(files),
        });
        blocks.filter(|block| !block.is_empty()).collect::<Vec<_>>().join("\n")
    }
}

fn html_table(header: &[&str], rows: &[TableRow]) -> String {
    let cells = |name: &str, cells: &mut dyn Iterator<Item = &str>| -> String {
        cells.map(|cell| format!("<{name}>{}</{name}>", escaped(cell))).collect()
    };
    let row = |row: &TableRow| {
        let class = match row.passed {
            Some(true) => " class=\"passed\"",
            Some(false) => " class=\"failed\"",
            None => "",
        };
        format!("<tr{class}>{}</tr>\n", cells("td", &mut row.cells.iter().map(String::as_str)))
    };
    let body: String = rows.iter().map(row).collect();
    format!("<table>\n<tr>{}</tr>\n{body}</table>\n", cells("th", &mut header.iter().copied()))
}

fn markdown_table(header: &[&str], rows: &[TableRow]) -> String {
    // A bar would end the cell.
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        cells.fold("|".to_owned(), |line, cell| format!("{line} {} |", cell.replace('|', "\\|"))) + "\n"
    };
    let body: String = rows.iter().map(|row| line(&mut row.cells.iter().map(String::as_str))).collect();
    line(&mut header.iter().copied()) + &line(&mut header.iter().map(|_| "---")) + &body
}

impl Figure<'_> {
    fn html(&self) -> String {
        let Self { id, title, chart, caption } = self;
        let caption = caption.as_ref().map_or_else(String::new, |Caption { label, words, remark: (lead, remark) }| {
            let [words, remark] = [words, remark].map(|text| escaped(text));
            format!("<figcaption><strong>{label}.</strong> {words}<br><em>{lead}.</em> {remark}</figcaption>\n")
        });
        format!("<figure id=\"{id}\">\n{}{caption}</figure>\n", svg(&chart.scene(), id, title))
    }

    fn markdown(&self, files: bool) -> String {
        let Self { id, title, caption, .. } = self;
        let Some(Caption { label, words, remark: (lead, remark) }) = caption else { return String::new() };
        let [picture, links] = if files {
            [
                format!("![{title}](figures/{id}.svg)\n\n"),
                format!("\n[PNG](figures/{id}.png) · [data](data/{id}.csv)\n"),
            ]
        } else {
            Default::default()
        };
        format!("### {label}: {title}\n\n{picture}{words}\n\n*{lead}.* {remark}\n{links}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_have_every_word_and_mark_what_is_theirs() {
        let rows = vec![
            TableRow { cells: vec!["a | b".into(), "1 < 2".into()], passed: Some(true) },
            TableRow { cells: vec!["c".into(), "2".into()], passed: Some(false) },
        ];
        let blocks = vec![
            Block::Heading(1, "A & B".into()),
            Block::Paragraph("Words.".into()),
            Block::Table(vec!["what", "found"], rows),
        ];
        let page = Page { title: "A & B", blocks };
        assert_eq!(
            page.markdown(false),
            "# A & B\n\nWords.\n\n| what | found |\n| --- | --- |\n| a \\| b | 1 < 2 |\n| c | 2 |\n"
        );
        let html = page.html();
        for part in [
            "<title>A &amp; B</title>",
            "<h1>A &amp; B</h1>\n<p>Words.</p>\n",
            "<tr class=\"passed\"><td>a | b</td><td>1 &lt; 2</td></tr>",
            "<tr class=\"failed\">",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
    }
}
