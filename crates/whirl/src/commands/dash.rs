//! `whirl dash`: a dashboard on a running simulation.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::attach::{self, BenchArgs};
use crate::commands::config;
use crate::failure::Failure;
use crate::folders;
use crate::layouts;
use crate::place::Force;
use crate::recordings::Recordings;

/// Options of `whirl dash`.
#[derive(Debug, clap::Args)]
pub(crate) struct DashArgs {
    #[command(flatten)]
    bench: BenchArgs,
    #[command(flatten)]
    screen: ScreenArgs,
    /// Take a picture of the screen, SVG or plain text, instead of showing it
    #[arg(long, value_name = "FILE.svg|FILE.txt", group = "written")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    /// The size of that screen in cells
    #[arg(long, value_name = "WxH", default_value = "120x40", value_parser = size, requires = "picture")]
    size: (u16, u16),
    /// Seconds to listen before the picture is taken
    #[arg(long, value_name = "SECONDS", default_value = "5", value_parser = clap::value_parser!(u32).range(1..=3600), requires = "picture")]
    after: u32,
    /// Keys to press before it is taken: letters, names in brackets as <enter> or <ctrl-r>, and <3s> to wait
    #[arg(long, value_name = "KEYS", default_value = "", hide_default_value = true, requires = "picture")]
    press: dashboard::KeyPresses,
}

/// Reads `120x40`.
fn size(typed: &str) -> Result<(u16, u16), String> {
    let parsed = typed.split_once('x').and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    let in_range = |(width, height): &(u16, u16)| (1..=1000).contains(width) && (1..=1000).contains(height);
    parsed.filter(in_range).ok_or_else(|| format!("found '{typed}', expected WIDTHxHEIGHT, each from 1 to 1000"))
}

/// How the dashboard shall be, for every command that shows one.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ScreenArgs {
    /// Megabytes that the steps kept for looking back may take
    #[arg(long, value_name = "MB", default_value = "145", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    history: u32,
    /// The layout to start with: a name (`whirl layout list`), or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    layout: Option<String>,
    /// Colours: default (the terminal's own sixteen), full, contrast or colour-blind
    #[arg(long, value_name = "NAME")]
    theme: Option<dashboard::ThemeName>,
    /// Show nothing but ASCII, whatever the locale says
    #[arg(long)]
    ascii: bool,
    /// Frames a second at most; fewer where the line to the terminal is slow
    #[arg(long, value_name = "N", default_value = "30", value_parser = clap::value_parser!(u32).range(1..=60))]
    fps: u32,
    /// Only look: change nothing
    #[arg(long)]
    read_only: bool,
    /// Begin with the machine locked against keys: ctrl-l unlocks it
    #[arg(long, conflicts_with = "read_only")]
    locked: bool,
}

impl ScreenArgs {
    /// As the dashboard takes it.
    ///
    /// # Errors
    /// A configuration that is wrong, or a layout that is wrong or not there.
    pub(crate) fn options(&self) -> Result<dashboard::Options, Failure> {
        self.options_with(None)
    }

    /// The same with another layout than the first where nobody has said which.
    ///
    /// # Errors
    /// As [`ScreenArgs::options`].
    pub(crate) fn options_with(&self, layout: Option<&str>) -> Result<dashboard::Options, Failure> {
        let config = config::read()?;
        let theme = self.theme.or(config.theme).unwrap_or_default();
        let appearance = dashboard::AppearanceOptions { theme, ascii: self.ascii || config.ascii };
        let (layouts, layout) = layouts::choose(self.layout.as_deref().or(layout).or(config.layout.as_deref()))?;
        Ok(dashboard::Options {
            history: self.history as usize * 1_000_000,
            layouts,
            layout,
            appearance,
            limits: config.limits,
            on_alarm: config.on_alarm,
            bell: config.bell,
            keys: config.keys,
            presets: folders::presets(),
            commands: folders::commands(),
            pictures: std::env::current_dir().ok(),
            fps: self.fps,
            read_only: self.read_only,
            locked: self.locked,
        })
    }
}

impl From<dashboard::DashboardError> for Failure {
    fn from(error: dashboard::DashboardError) -> Self {
        match error {
            dashboard::DashboardError::NoTerminal => Self::Usage(error.to_string()),
            dashboard::DashboardError::Terminal(_)
            | dashboard::DashboardError::Recording(_)
            | dashboard::DashboardError::Panicked => Self::Work(error.to_string()),
        }
    }
}

/// A signal that ended the dashboard is told by the exit code.
pub(crate) fn ended(how: dashboard::Ended) -> Result<(), Failure> {
    match how {
        dashboard::Ended::Quit => Ok(()),
        dashboard::Ended::Interrupted => Err(Failure::Interrupted),
    }
}

/// Shows the bench until told to quit; the simulation goes on.
///
/// # Errors
/// No such bench, or no terminal.
pub(crate) fn run(args: &DashArgs) -> Result<(), Failure> {
    let is_text = |file: &PathBuf| file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("txt"));
    if args.screen.theme.is_some() && args.picture.as_ref().is_some_and(is_text) {
        return Err(Failure::Usage(
            "--theme: a picture in plain text has no colours; one that ends in .svg has".into(),
        ));
    }
    let bench = args.bench.name()?;
    let options = args.screen.options()?;
    args.picture.as_ref().map_or(Ok(()), |file| args.force.check(file))?;
    let carrier = attach::dashboard_carrier()?;
    // A bench that is not there is said at once; one that goes away later is waited for.
    drop(attach::listen(&carrier, &bench)?);
    if let Some(file) = &args.picture {
        return picture(args, file, carrier, &bench, &options);
    }
    let mut recorder = Recordings::of(bench.clone());
    let shown = dashboard::run(carrier, &bench, None, Some(&mut recorder), &options);
    let recorded = recorder.finish();
    ended(shown?)?;
    recorded
}

/// Takes a picture of what the dashboard shows.
fn picture<C: wire::Carrier>(
    args: &DashArgs,
    file: &Path,
    carrier: C,
    bench: &wire::BenchName,
    options: &dashboard::Options,
) -> Result<(), Failure> {
    let kind = file.extension().and_then(|kind| kind.to_str());
    let Some(kind @ ("svg" | "txt")) = kind else {
        let found = file.display();
        return Err(Failure::Usage(format!("--picture {found}: expected a file that ends in .svg or .txt")));
    };
    let after = Duration::from_secs(args.after.into());
    let still = dashboard::take_screenshot(carrier, bench, options, args.size, after, &args.press)?;
    let still = still.ok_or_else(|| Failure::Bench(format!("bench '{bench}' sent nothing in {} s", args.after)))?;
    let content = if kind == "svg" { still.svg } else { still.text };
    args.force.write(file, content)
}
