//! How large the motion gets of machines whose parameters are drawn at random: each simulated from rest with its clearances and limits, as a
//! cell of a map is, side by side where the loop is ideal.

use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use machine::{Program, default_step};
use variation::{Distribution, Model, Parameter, Range, values};

use crate::many::{Ended, many};
use crate::map::MapError;
use crate::run::{Extent, Plan, RunError, Settle};

/// The motion of machines whose parameters are drawn from `ranges`, those drawn as numbers `which`, in this order: the machines of
/// [`variation::samples()`] with the same seed. A run that has not settled after `longest`, in `tau`, is told as it is then. `done` is called
/// after each, from any thread.
///
/// # Errors
/// A machine that cannot be, one that cannot be stepped, or `stop`.
pub fn motions(
    model: &Model,
    ranges: &[Range],
    (distribution, seed): (Distribution, u64),
    which: std::ops::Range<u64>,
    longest: f64,
    stop: &AtomicBool,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Extent>, MapError> {
    let count = (which.end - which.start) as usize;
    let found: Vec<OnceLock<Extent>> = (0..count).map(|_| OnceLock::new()).collect();
    let plan = |k: usize| -> Result<Option<Plan>, MapError> {
        let drawn = values(ranges, distribution, seed, which.start + k as u64);
        let changes: Vec<(&Parameter, f64)> = ranges.iter().map(|range| &range.parameter).zip(drawn).collect();
        let Model { rotor, settings, .. } = model.with(&changes)?;
        let dtau = default_step(&rotor, &settings)?;
        let program = Program::in_substeps(&rotor, &settings, dtau, 1)?;
        let settle = Settle::DetectAndStop;
        Ok(Some(Plan { program, start: None, impulses: vec![], dtau, duration: longest, settle }))
    };
    let take = |k: usize, _: &Plan, ended: Ended| -> Result<(), MapError> {
        let _ = found[k].set(ended.extent);
        done();
        Ok(())
    };
    match many(count, &plan, &take, stop) {
        Err(MapError::Run(RunError::Interrupted)) => return Err(MapError::Interrupted),
        made => made?,
    }
    Ok(found.into_iter().filter_map(OnceLock::into_inner).collect())
}

#[cfg(test)]
mod tests {
    use rotor::{Settings, builtin};

    use super::*;
    use crate::run::extent;

    #[test]
    fn each_is_to_the_last_bit_what_a_run_by_itself_is() {
        let rotor = builtin::rotor("three-mass").expect("built in");
        let mut settings = Settings::new(&rotor, 2.5, builtin::feedback(&rotor, "composite").expect("built in"));
        settings.deadband.fill(0.5);
        let model = Model::new(rotor, settings);
        let range = |name: &str, from, to| Range { parameter: model.parameter(name).expect("there"), from, to };
        let ranges = [range("damping.1", 0.2, 0.3), range("unbalance.2", 0.5, 1.5), range("deadband.1", 0.0, 1.0)];
        let of = (Distribution::Normal, 7);
        let never = AtomicBool::new(false);
        let found = motions(&model, &ranges, of, 0..20, 300.0, &never, &|| ()).expect("machines");
        assert_eq!(found.len(), 20);
        for (k, found) in found.iter().enumerate() {
            let drawn = values(&ranges, of.0, of.1, k as u64);
            let changes: Vec<_> = ranges.iter().map(|range| &range.parameter).zip(drawn).collect();
            let machine = model.with(&changes).expect("in range");
            let clearances = &machine.settings.deadband;
            let feedback = &machine.settings.feedback;
            let plan = Plan::steady(&machine.rotor, feedback, 2.5, clearances, 300.0, Settle::DetectAndStop);
            assert_eq!(*found, extent(&plan.expect("steps"), &never).expect("ends"), "{k}");
        }
        let orbits = |k: usize| found[k].max_displacement;
        assert!((1..20).any(|k| orbits(k) != orbits(0)));
        let again = motions(&model, &ranges, of, 0..20, 300.0, &never, &|| ()).expect("machines");
        assert_eq!(again, found);
    }
}
