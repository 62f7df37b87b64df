//! A search whose starts are shared out among shards of a sweep: what each of them climbs, and the end of it all.

use std::path::Path;
use std::time::Instant;

use study::sweep::Task;
use tuner::{Placement, Stop};

use super::question::Asked;
use super::{TuneArgs, answer};
use crate::failure::Failure;
use crate::interrupt;
use crate::output::Format;
use crate::place::Force;

/// The starts of a search as rows, for a sweep.
///
/// # Errors
/// A question that makes no sense, or that is more than one search.
pub(crate) fn task(args: &TuneArgs) -> Result<Task, Failure> {
    let wrong = |why: &str| Err(Failure::Usage(why.to_owned()));
    if args.format.json || args.format.csv || args.out.is_some() || args.plot.is_some() || args.write_unstable {
        return wrong(
            "--json, --csv, --out, --plot and --write-unstable are of no use in a sweep: its shards are the result",
        );
    }
    if args.track.is_some() || args.pareto.is_some() || !args.criteria.is_empty() {
        return wrong("--track, --pareto and --criteria are several searches: a sweep cuts the starts of one");
    }
    let asked = Asked::of(args)?;
    let choices = asked.choices();
    let [(bearing, sensors)] = &choices[..] else {
        return wrong("any: a search for every choice of places; a sweep cuts the starts of one. Name the places");
    };
    let problem = asked.problem(*bearing, sensors);
    let options = args.options(&problem);
    Ok(Task::Starts { problem: Box::new(problem), options })
}

/// Finishes a search of which every start has been climbed: `values` are what they ended with, by start. Prints and writes what
/// `whirl tune` with all of them would.
///
/// # Errors
/// As `whirl tune` has them.
pub(crate) fn finish(
    mut args: TuneArgs,
    values: &[f64],
    out: &Path,
    (force, format): (Force, Format),
) -> Result<(), Failure> {
    (args.out, args.force, args.format) = (Some(out.to_owned()), force, format);
    force.check(out)?;
    let (asked, begun, flag) = (Asked::of(&args)?, Instant::now(), interrupt::flag()?);
    let (bearing, sensors) = asked.choices().swap_remove(0);
    let problem = asked.problem(bearing, &sensors);
    let tuned = tuner::finish(&problem, &args.options(&problem), values, Stop::when(&flag))?;
    answer::tell(&args, &asked, &[Placement { bearing, sensors, tuned }], begun, &flag)
}
