//! Where log lines go, for whoever looks for a fault: nowhere, unless `WHIRL_LOG` asks for them.

use std::fs::OpenOptions;
use std::path::PathBuf;
use std::sync::Mutex;

use tracing_subscriber::EnvFilter;
use wire::Root;

use crate::failure::Failure;

/// The variable that asks for log lines, with a filter such as `debug` or `wire=debug,warn`.
const VARIABLE: &str = "WHIRL_LOG";

fn filter() -> Option<EnvFilter> {
    std::env::var(VARIABLE).ok().filter(|filter| !filter.is_empty()).map(EnvFilter::new)
}

/// Logs to stderr, for commands without a screen of their own.
pub(crate) fn to_stderr() {
    if let Some(filter) = filter() {
        tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).init();
    }
}

/// The log of dashboards.
pub(crate) fn file(root: &Root) -> PathBuf {
    root.path().join("dash.log")
}

/// Logs to `dash.log` in the root, for commands whose screen nobody may write on.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn to_file(root: &Root) -> Result<(), Failure> {
    let Some(filter) = filter() else { return Ok(()) };
    let path = file(root);
    let file = OpenOptions::new()
        .create(true)
        .append(true)
        .open(&path)
        .map_err(|error| Failure::Work(format!("{}: the log cannot be written: {error}", path.display())))?;
    tracing_subscriber::fmt().with_env_filter(filter).with_ansi(false).with_writer(Mutex::new(file)).init();
    Ok(())
}
