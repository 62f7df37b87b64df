//! How large the motion of samples gets, each simulated with its clearances and limits.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use serde_json::{Map, Value, json};
use study::force::LONGEST;
use study::run::{Extent, Settled};
use variation::{Distribution, Model, Range, Share};

use super::unsure::QUANTILES;
use crate::catalog::Machine;
use crate::failure::Failure;
use crate::output::rounded;

/// A size of a motion, as scripts have it and as it is shown.
struct Size<'a> {
    name: &'static str,
    of: &'a dyn Fn(&Extent) -> f64,
    shown: &'a dyn Fn(f64) -> f64,
    unit: &'static str,
}

/// How large the motion of every sample gets.
///
/// # Errors
/// A machine that cannot be, or cannot be stepped.
pub(super) fn simulated(
    machine: &Machine,
    model: &Model,
    ranges: &[Range],
    drawn: (Distribution, u64),
    count: u64,
) -> Result<(Value, String), Failure> {
    let (done, watched) = (AtomicU64::new(0), std::io::stderr().is_terminal());
    let report = || {
        let count_done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if watched && (count_done % 64 == 0 || count_done == count) {
            let end = if count_done == count { "\r\x1b[K" } else { "" };
            let _ = std::io::Write::write_fmt(
                &mut std::io::stderr(),
                format_args!("\r{count_done} of {count} samples simulated{end}"),
            );
        }
    };
    let never = AtomicBool::new(false);
    let found = study::scatter::motions(model, ranges, drawn, 0..count, LONGEST, &never, &report)?;
    let share = |of: &dyn Fn(&Extent) -> bool| Share::of(found.iter().filter(|one| of(one)).count() as u64, count);
    let bounded = share(&|one| one.diverged_at.is_none());
    let settled = share(&|one| one.diverged_at.is_none() && one.settled != Settled::No);
    let [low, high] = bounded.interval.map(|end| rounded(100.0 * end));
    let mut text = format!(
        "\nsimulated from rest: {} % stay within bounds (95 %: {low} to {high} %), {} % have settled after {LONGEST} tau\n",
        rounded(100.0 * bounded.share),
        rounded(100.0 * settled.share)
    );
    let mut fields = json!({
        "bounded_share": bounded.share, "bounded_interval": bounded.interval, "settled_share": settled.share,
    });
    let units = machine.units();
    let force = |force: f64| units.force(force, machine.bearing_mass());
    let orbit = |orbit: f64| units.length(orbit);
    let each = [
        Size { name: "orbit", of: &|one| one.max_displacement, shown: &orbit, unit: units.length_unit() },
        Size { name: "force", of: &|one| one.max_force, shown: &force, unit: units.force_unit() },
    ];
    for Size { name, of, shown, unit } in each {
        // What left all bounds is larger than all others.
        let size = |one: &Extent| if one.diverged_at.is_none() { of(one) } else { f64::INFINITY };
        let mut sizes: Vec<f64> = found.iter().map(size).collect();
        sizes.sort_by(f64::total_cmp);
        let quantile = |name: &str| variation::quantile(&sizes, name.parse().unwrap_or(0.5));
        let quantiles: Map<String, Value> =
            QUANTILES.iter().map(|name| ((*name).to_owned(), json!(quantile(name)))).collect();
        fields[name] = Value::Object(quantiles);
        if QUANTILES.iter().any(|name| quantile(name).is_infinite()) {
            fields[format!("{name}_null")] = json!("the motion left all bounds");
        }
        let told = |name: &&str| match quantile(name) {
            size if size.is_finite() => format!("{name}: {}", rounded(shown(size))),
            _ => format!("{name}: out of bounds"),
        };
        let each: Vec<String> = QUANTILES.iter().map(told).collect();
        let _ = writeln!(text, "quantiles of the largest {name}, {unit}  {}", each.join("  "));
    }
    Ok((fields, text))
}
