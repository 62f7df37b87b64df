//! The blocks of a page of Markdown.

/// A block of a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Block {
    /// A heading, by its depth.
    Heading(usize, String),
    /// Text that is wrapped.
    Paragraph(String),
    /// An item of a list: how far it is moved in, the sign before it, and its text.
    Item(usize, String, String),
    /// Lines that stay as they are.
    Verbatim(Vec<String>),
    /// Rows of cells, the heading first.
    Table(Vec<Vec<String>>),
}

/// The blocks of a page, in order.
pub(crate) fn blocks(markdown: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut lines = markdown.lines().peekable();
    // Whether the next line goes on with the last block.
    let mut goes_on = false;
    while let Some(line) = lines.next() {
        let trimmed = line.trim_start();
        let indent = line.len() - trimmed.len();
        if trimmed.is_empty() || trimmed.starts_with("<!--") {
            goes_on = false;
        } else if trimmed.starts_with("```") {
            let inside = lines.by_ref().take_while(|line| !line.trim_start().starts_with("```"));
            blocks.push(Block::Verbatim(inside.map(str::to_owned).collect()));
            goes_on = false;
        } else if let Some(title) =
            trimmed.trim_start_matches('#').strip_prefix(' ').filter(|_| trimmed.starts_with('#'))
        {
            let depth = trimmed.len() - trimmed.trim_start_matches('#').len();
            blocks.push(Block::Heading(depth, title.trim().to_owned()));
            goes_on = false;
        } else if trimmed.starts_with('|') {
            let mut rows = vec![cells(trimmed)];
            while let Some(row) = lines.next_if(|line| line.trim_start().starts_with('|')) {
                rows.push(cells(row.trim()));
            }
            rows.retain(|row| !row.iter().all(|cell| !cell.is_empty() && cell.chars().all(|c| "-: ".contains(c))));
            blocks.push(Block::Table(rows));
            goes_on = false;
        } else if let Some((sign, text)) = item(trimmed) {
            blocks.push(Block::Item(indent, sign.to_owned(), text.to_owned()));
            goes_on = true;
        } else {
            match blocks.last_mut().filter(|_| goes_on) {
                Some(Block::Paragraph(text) | Block::Item(_, _, text)) => {
                    text.push(' ');
                    text.push_str(trimmed);
                }
                _ => blocks.push(Block::Paragraph(trimmed.to_owned())),
            }
            goes_on = true;
        }
    }
    blocks
}

/// The sign and the text of an item of a list.
fn item(line: &str) -> Option<(&str, &str)> {
    let (sign, text) = line.split_once(' ')?;
    let is_number = sign.strip_suffix('.').is_some_and(|n| !n.is_empty() && n.chars().all(|c| c.is_ascii_digit()));
    (is_number || sign == "*" || sign == "-").then_some((sign, text))
}

/// The cells of a row: what is between bars that are not escaped.
fn cells(row: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut is_escaped = false;
    for c in row.trim().trim_start_matches('|').chars() {
        match cells.last_mut() {
            Some(cell) if c != '|' || is_escaped => cell.push(c),
            _ => cells.push(String::new()),
        }
        is_escaped = c == '\\' && !is_escaped;
    }
    // Behind the last bar there is nothing.
    if cells.len() > 1 && cells.last().is_some_and(|cell| cell.trim().is_empty()) {
        cells.pop();
    }
    cells.into_iter().map(|cell| cell.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_comes_apart_into_its_blocks() {
        let page = "<!-- made -->\n# Title\n\nOne\ntwo.\n* first\n  goes on\n* second\n\n1. third\n\n| a | b |\n|---|---:|\n| `x \\| y` | |\n\n```sh\n# no heading\n\n```\nEnd\n";
        let text = str::to_owned;
        assert_eq!(
            blocks(page),
            [
                Block::Heading(1, text("Title")),
                Block::Paragraph(text("One two.")),
                Block::Item(0, text("*"), text("first goes on")),
                Block::Item(0, text("*"), text("second")),
                Block::Item(0, text("1."), text("third")),
                Block::Table(vec![vec![text("a"), text("b")], vec![text("`x \\| y`"), text("")]]),
                Block::Verbatim(vec![text("# no heading"), text("")]),
                Block::Paragraph(text("End")),
            ]
        );
    }
}
