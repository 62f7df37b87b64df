//! `whirl config`: where the configuration is, what it says, and what holds without one.

use dashboard::Config;

use crate::catalog::{self, FileError};
use crate::failure::Failure;
use crate::folders;
use crate::output::print_text;

/// Options of `whirl config`.
#[derive(Debug, clap::Args)]
pub(crate) struct ConfigArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Print the paths of the configuration file, your layouts, your gains and the commands you typed
    Path,
    /// Check the configuration file and print it
    Show,
    /// Print what holds without a file, as a file to change
    Defaults,
}

/// Carries out `whirl config path`, `show` or `defaults`.
///
/// # Errors
/// A configuration that is wrong, or output that cannot be written.
pub(crate) fn run(args: &ConfigArgs) -> Result<(), Failure> {
    match args.action {
        Action::Path => {
            let paths = [
                ("configuration", folders::config_file()),
                ("layouts", crate::layouts::folder()),
                ("gains", folders::presets()),
                ("commands", folders::commands()),
            ];
            let line = |(what, path): (&str, Option<std::path::PathBuf>)| {
                let path =
                    path.map_or_else(|| "none: this user has no home".to_owned(), |path| path.display().to_string());
                format!("{what:<14} {path}\n")
            };
            print_text(&paths.into_iter().map(line).collect::<String>())
        }
        Action::Show => {
            read()?;
            match file() {
                Some(path) => print_text(&catalog::text(&path)?),
                None => print_text("# There is no configuration file: the defaults hold (`whirl config defaults`).\n"),
            }
        }
        Action::Defaults => print_text(&Config::defaults()),
    }
}

/// The configuration file, if there is one.
fn file() -> Option<String> {
    folders::config_file().filter(|path| path.exists()).map(|path| path.to_string_lossy().into_owned())
}

/// The configuration in force: what the file says, or the defaults.
///
/// # Errors
/// A file that cannot be read or is wrong.
pub(crate) fn read() -> Result<Config, Failure> {
    let Some(path) = file() else { return Ok(Config::default()) };
    let text = catalog::text(&path)?;
    Ok(Config::read(&text).map_err(|faults| FileError::wrong(&path, &text, faults))?)
}
