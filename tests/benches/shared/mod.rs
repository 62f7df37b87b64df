//! What the measurements share.

use std::fs;

use promises::Root;

/// The screen of the promises.
pub(crate) const SIZE: (u16, u16) = (200, 60);

/// What `whirl status --json` tells of the one bench under a root.
pub(crate) fn status(root: &Root) -> serde_json::Value {
    root.run(&["status", "--json"]).json()["benches"][0].take()
}

/// The value that this share of the others does not exceed.
pub(crate) fn percentile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}

/// The value in the middle.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    percentile(values, 0.5)
}

/// The machine, in a line.
pub(crate) fn machine() -> String {
    let cpus = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpus.lines().find_map(|line| line.strip_prefix("model name")).unwrap_or(": unknown processor");
    let count = std::thread::available_parallelism().map_or(0, std::num::NonZero::get);
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split_whitespace().next().unwrap_or("?").to_owned();
    format!("{count} cores, {}; load average {load} at the end", model.trim_start_matches([' ', '\t', ':']))
}
