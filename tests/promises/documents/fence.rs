//! The fenced blocks of a document, and what the word behind the backticks makes of each.

use promises::paper::paper;

/// One fenced block.
pub(super) struct Fence {
    /// The line of its first backticks, counted from 1.
    pub(super) line: usize,
    /// What it is.
    pub(super) block: Block,
    /// What is between the fences.
    pub(super) text: String,
}

/// What a block is.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Block {
    /// `sh`: commands, a line each.
    Commands,
    /// `sh recordings`: commands that need the cargo feature `rerun`.
    Recordings,
    /// `sh not-run: WHY`: commands that no test can run.
    NotRun(String),
    /// `text printed`: what the last command before it prints.
    Printed,
    /// `toml FILE` or `c FILE`: a file that commands after it name.
    File(String),
    /// `text`: anything else.
    Other,
}

/// The fenced blocks of a document, in order.
///
/// # Panics
/// If one is of no kind that is known: a block of commands must not slip through under another word.
pub(super) fn fences(path: &str) -> Vec<Fence> {
    let mut found: Vec<Fence> = Vec::new();
    let mut is_open = false;
    for (at, line) in paper(path).lines().enumerate() {
        let Some(info) = line.trim_start().strip_prefix("```") else {
            if let Some(fence) = found.last_mut().filter(|_| is_open) {
                fence.text += line;
                fence.text += "\n";
            }
            continue;
        };
        if !is_open {
            let block = block(info).unwrap_or_else(|| panic!("{path}:{}: unknown kind of block '{info}'", at + 1));
            found.push(Fence { line: at + 1, block, text: String::new() });
        }
        is_open = !is_open;
    }
    assert!(!is_open, "{path}: a block without an end");
    found
}

fn block(info: &str) -> Option<Block> {
    Some(match info {
        "sh" => Block::Commands,
        "sh recordings" => Block::Recordings,
        "text printed" => Block::Printed,
        "text" => Block::Other,
        _ => match info.split_once(' ') {
            Some(("sh", rest)) => Block::NotRun(rest.strip_prefix("not-run: ")?.to_owned()),
            Some(("toml" | "c", file)) => Block::File(file.to_owned()),
            _ => return None,
        },
    })
}

#[test]
fn a_block_of_an_unknown_kind_is_none() {
    assert_eq!(block("sh not-run: it opens a window"), Some(Block::NotRun("it opens a window".into())));
    assert_eq!(block("toml gains.toml"), Some(Block::File("gains.toml".into())));
    for unknown in ["", "bash", "console", "sh later", "toml"] {
        assert_eq!(block(unknown), None, "{unknown}");
    }
}
