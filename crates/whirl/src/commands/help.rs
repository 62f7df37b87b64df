//! `whirl help`: the pages of the book, and what `--help` tells of a command.

use std::io::{IsTerminal, stdout};

use clap::error::ErrorKind;
use manual::Look;

use crate::failure::Failure;
use crate::output::{has_colours, padded, print_text};

/// Lines of a page are no longer than this on a wider terminal: longer ones are hard to read.
const WIDEST: usize = 110;
/// How wide a page is that no terminal shows.
const PIPED: usize = 80;

/// Options of `whirl help`.
#[derive(Debug, clap::Args)]
pub(crate) struct HelpArgs {
    /// A page of the book (`whirl help` lists them), or a command
    #[arg(value_name = "TOPIC")]
    topic: Vec<String>,
}

/// Prints a page, the help of a command, or what there is.
///
/// # Errors
/// Neither a page nor a command, or output that cannot be written.
pub(crate) fn run(args: &HelpArgs) -> Result<(), Failure> {
    if args.topic.is_empty() {
        return print_text(&(of_command(&[]).unwrap_or_default() + "\n" + &listed()));
    }
    if let Some(help) = of_command(&args.topic) {
        return print_text(&help);
    }
    let topic = args.topic.join(" ");
    let page = manual::page(&topic).map_err(|error| {
        let program = crate::command();
        let commands: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
        let near = error.near.or_else(|| text::nearest(&topic, &commands));
        let meant = near.map_or_else(String::new, |near| format!("; did you mean '{near}'?"));
        Failure::Usage(format!("no page and no command '{topic}': expected one of these{meant}\n\n{}", listed()))
    })?;
    let is_terminal = stdout().is_terminal();
    let wide = terminal_size::terminal_size().map(|(width, _)| usize::from(width.0)).filter(|_| is_terminal);
    let look = if has_colours() { Look::Styled } else { Look::Plain };
    print_text(&page.show(wide.map_or(PIPED, |wide| wide.min(WIDEST)), look))
}

/// What `--help` of a command prints, by the very same way; of the program if no words are given.
fn of_command(words: &[String]) -> Option<String> {
    let program = crate::command();
    words.iter().try_fold(&program, |command, word| command.find_subcommand(word))?;
    let line = ["whirl"].into_iter().chain(words.iter().map(String::as_str)).chain(["--help"]);
    let shown =
        crate::command().try_get_matches_from(line).err().filter(|shown| shown.kind() == ErrorKind::DisplayHelp)?;
    let help = shown.render();
    Some(if has_colours() { help.ansi().to_string() } else { help.to_string() })
}

/// The pages, part by part.
fn listed() -> String {
    let wide = manual::topics().map(str::len).max().unwrap_or(0);
    let mut out = String::from("Pages of the book, for `whirl help TOPIC`:\n");
    for part in manual::parts() {
        if !part.title.is_empty() {
            out += &format!("\n{}\n", part.title);
        }
        for page in part.pages {
            out += &format!("  {}  {}\n", padded(page.topic, wide), page.title);
        }
    }
    out
}
