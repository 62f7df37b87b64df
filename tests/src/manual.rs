//! The manual: man pages, shell completions and the reference part of the book, made from the command line itself and the tables of the program.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use clap_complete::Shell;
use clap_mangen::roff::{Roff, bold, roman};

/// Writes `man/*.1`, `man/whirl-keys.7`, `completions/*` and the made pages of `book/src` into `folder`.
///
/// # Errors
/// It cannot be written.
pub fn write(folder: &Path) -> io::Result<()> {
    let (man, completions) = (folder.join("man"), folder.join("completions"));
    fs::create_dir_all(&man)?;
    fs::create_dir_all(&completions)?;
    let book = folder.join("book/src");
    fs::create_dir_all(&book)?;
    crate::reference::write(&book)?;
    clap_mangen::generate_to(whirl::command(), &man)?;
    fs::write(man.join("whirl-keys.7"), keys())?;
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
        clap_complete::generate_to(shell, &mut whirl::command(), "whirl", &completions)?;
    }
    // The front page leads to what is not a command.
    let front = man.join("whirl.1");
    let mut front = fs::OpenOptions::new().append(true).open(front)?;
    front.write_all(see_also().as_bytes())
}

/// The page of the dashboard's keys and commands.
fn keys() -> String {
    let mut page = Roff::new();
    page.control("TH", ["whirl-keys", "7"]);
    page.control("SH", ["NAME"]);
    page.text([roman("whirl-keys - keys and commands of the dashboard")]);
    page.control("SH", ["KEYS"]);
    page.text([roman("[keys] in the configuration file binds others: whirl config defaults prints it.")]);
    rows(&mut page, dashboard::manual_keys());
    page.control("SH", ["COMMANDS"]);
    page.text([roman("Typed after a colon; tab completes them. Settings can be typed alone: speed 3, kd=0.1.")]);
    rows(&mut page, dashboard::manual_commands());
    page.control("SH", ["SEE ALSO"]);
    page.text([bold("whirl"), roman("(1), "), bold("whirl-dash"), roman("(1), "), bold("whirl-config"), roman("(1)")]);
    page.to_roff()
}

fn rows(page: &mut Roff, rows: Vec<(String, &str)>) {
    for (name, meaning) in rows {
        page.control("TP", []);
        page.text([bold(name)]);
        page.text([roman(meaning)]);
    }
}

fn see_also() -> String {
    let mut page = Roff::new();
    page.control("SH", ["EXIT STATUS"]);
    for (code, meaning) in whirl::EXIT_CODES {
        page.control("TP", []);
        page.text([bold(code.to_string())]);
        page.text([roman(*meaning)]);
    }
    page.control("SH", ["ENVIRONMENT"]);
    for (name, meaning) in whirl::ENVIRONMENT {
        page.control("TP", []);
        page.text([bold(*name)]);
        page.text([roman(*meaning)]);
    }
    page.control("SH", ["FILES"]);
    page.text([bold("whirl config path"), roman(" prints where the configuration, layouts, gains and commands are.")]);
    page.control("SH", ["SEE ALSO"]);
    page.text([bold("whirl-keys"), roman("(7)")]);
    page.to_roff()
}
