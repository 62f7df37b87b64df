//! `whirl dash`: a dashboard on a running simulation.

use crate::attach::{self, BenchArgs};
use crate::failure::Failure;
use crate::layouts;

/// Options of `whirl dash`.
#[derive(Debug, clap::Args)]
pub(crate) struct DashArgs {
    #[command(flatten)]
    bench: BenchArgs,
    #[command(flatten)]
    screen: ScreenArgs,
}

/// How the dashboard shall be, for every command that shows one.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ScreenArgs {
    /// Megabytes that the steps kept for looking back may take
    #[arg(long, value_name = "MB", default_value = "128", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    history: u32,
    /// The layout to start with: a name (`whirl layout list`), or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    layout: Option<String>,
    /// Colours: default (the terminal's own sixteen), full, contrast or colour-blind
    #[arg(long, value_name = "NAME", default_value_t)]
    theme: dash::ThemeName,
    /// Show nothing but ASCII, whatever the locale says
    #[arg(long)]
    ascii: bool,
}

impl ScreenArgs {
    /// As the dashboard takes it.
    ///
    /// # Errors
    /// A layout that is not there or wrong.
    pub(crate) fn options(&self) -> Result<dash::Options, Failure> {
        let wishes = dash::Wishes { theme: self.theme, ascii: self.ascii };
        let (layouts, layout) = layouts::choose(self.layout.as_deref())?;
        Ok(dash::Options { history: self.history as usize * 1_000_000, layouts, layout, wishes })
    }
}

impl From<dash::DashError> for Failure {
    fn from(error: dash::DashError) -> Self {
        match error {
            dash::DashError::NoTerminal => Self::Usage(error.to_string()),
            dash::DashError::Terminal(_) | dash::DashError::Past(_) | dash::DashError::Panicked => {
                Self::Work(error.to_string())
            }
        }
    }
}

/// A signal that ended the dashboard is told by the exit code.
pub(crate) fn ended(how: dash::Ended) -> Result<(), Failure> {
    match how {
        dash::Ended::Quit => Ok(()),
        dash::Ended::Interrupted => Err(Failure::Interrupted),
    }
}

/// Shows the bench until told to quit; the simulation goes on.
///
/// # Errors
/// No such bench, or no terminal.
pub(crate) fn run(args: &DashArgs) -> Result<(), Failure> {
    let bench = args.bench.name()?;
    let options = args.screen.options()?;
    let carrier = attach::dashboard_carrier()?;
    // A bench that is not there is said at once; one that goes away later is waited for.
    drop(attach::listen(&carrier, &bench)?);
    ended(dash::run(carrier, &bench, None, None, &options)?)
}
