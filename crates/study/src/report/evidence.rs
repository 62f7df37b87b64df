//! Everything that the figures and the numbers are made of, computed once, on all cores.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use rotor::circular::{Circular, synchronous};
use rotor::{
    C64, ClosedLoop, CriticalSpeed, Feedback, Modes, Rotor, Threshold, Trace, builtin, critical_speeds, thresholds,
    trace,
};

use super::compare::sure;
use super::motion::{Case, Record, off};
use super::searched::{self, Searched};
use super::{Onlooker, ReportError};
use crate::force::{self, ForcePoint};
use crate::run::{Settle, Settled};

/// The clearances that the report compares.
pub(super) const DEADBANDS: [f64; 3] = [0.0, 1.0, 10.0];
/// The reconstructed impulse: a change of velocity along y, at rest, at the start.
pub(super) const IMPULSE: C64 = C64::new(-2.5, 0.0);
/// Points of a pole trace.
const TRACE: usize = 401;
/// Points of a force curve per unit of speed.
const PER_UNIT: usize = 10;

/// A force curve: the speeds, and at each clearance the steady forces.
pub(super) struct Forces {
    pub speeds: Vec<f64>,
    pub by_deadband: Vec<Vec<ForcePoint>>,
}

impl Forces {
    /// The force at one of the speeds.
    pub(super) fn at(&self, deadband: usize, speed: f64) -> f64 {
        let near = |s: &f64| (s - speed).abs() < 1e-9;
        let found = self.speeds.iter().position(near).map(|i| self.by_deadband[deadband][i].max_force);
        found.unwrap_or(f64::NAN)
    }

    /// The same with the digits that are sure.
    pub(super) fn shown(&self, deadband: usize, speed: f64) -> String {
        let near = |s: &f64| (s - speed).abs() < 1e-9;
        let point = self.speeds.iter().position(near).map(|i| &self.by_deadband[deadband][i]);
        point.map_or_else(String::new, |p| sure(p.max_force, off(p.settled) * p.max_force))
    }

    /// The forces at one clearance, not a number where the motion has not settled.
    pub(super) fn settled(&self, deadband: usize) -> impl Iterator<Item = f64> {
        let points = self.by_deadband[deadband].iter();
        points.map(|p| if p.diverged_at.is_none() && p.settled != Settled::No { p.max_force } else { f64::NAN })
    }
}

/// All that was computed.
pub(super) struct Evidence {
    pub jeffcott: Rotor,
    pub jeffcott_off: Feedback,
    pub three_mass: Rotor,
    pub three_mass_off: Feedback,
    pub jeffcott_trace: Trace,
    pub jeffcott_thresholds: Vec<Threshold>,
    pub jeffcott_criticals: Vec<CriticalSpeed>,
    /// The cancelling law over `0..=5`.
    pub cancel_trace: Trace,
    pub jeffcott_forces: Forces,
    /// The exact synchronous orbits behind them, per clearance, at whole speeds.
    pub jeffcott_exact: Vec<Circular>,
    pub three_mass_trace: Trace,
    pub three_mass_thresholds: Vec<Threshold>,
    pub three_mass_criticals: Vec<CriticalSpeed>,
    pub composite_trace: Trace,
    pub composite_thresholds: Vec<Threshold>,
    pub composite_forces: Forces,
    /// What the gain search finds.
    pub searched: Searched,
    /// Fig. 3.5.
    pub unstable: Record,
    /// Fig. 3.6.
    pub steady: Record,
    /// Figs. 3.8 to 3.10.
    pub impulses: Vec<Record>,
    /// Fig. 3.11: the last of these, continued.
    pub impulse_spectrum: Record,
    /// Figs. 4.17 to 4.19.
    pub slow: Record,
    /// Figs. 4.20 to 4.23.
    pub fast: Record,
    /// Figs. 4.24 to 4.26.
    pub loose: Record,
}

/// How many steps [`Evidence::gather`] counts.
pub(super) fn steps() -> usize {
    let points = |to: usize| DEADBANDS.len() * (PER_UNIT * to + 1);
    CASES + points(5) + points(6) + searched::STEPS
}

const CASES: usize = 9;

fn speeds(from: f64, to: f64, points: usize) -> Vec<f64> {
    (0..points).map(|i| from + (to - from) * i as f64 / (points - 1) as f64).collect()
}

impl Evidence {
    /// Computes everything.
    ///
    /// # Errors
    /// Eigenvalues that do not converge, or a request to stop.
    pub(super) fn gather(onlooker: &Onlooker<'_>) -> Result<Self, ReportError> {
        let built = |name: &str| builtin::rotor(name).expect("a built-in rotor");
        let (jeffcott, three_mass) = (built("jeffcott"), built("three-mass"));
        let law = |rotor: &Rotor, name: &str| builtin::feedback(rotor, name).expect("built-in feedback");
        let (jeffcott_off, cancel) = (law(&jeffcott, "off"), law(&jeffcott, "cancel"));
        let (three_mass_off, composite) = (law(&three_mass, "off"), law(&three_mass, "composite"));

        let mut records =
            records(&[&jeffcott, &three_mass], &[&jeffcott_off, &cancel, &composite], onlooker)?.into_iter();
        let mut next = || records.next().expect("as many records as cases");
        let (unstable, steady) = (next(), next());
        let impulses = (0..DEADBANDS.len()).map(|_| next()).collect();
        let (impulse_spectrum, slow, fast, loose) = (next(), next(), next(), next());

        let sweep = |rotor: &Rotor, feedback: &Feedback, to: usize| -> Result<Forces, ReportError> {
            let speeds = speeds(0.0, to as f64, PER_UNIT * to + 1);
            let clearances = DEADBANDS.map(|deadband| vec![deadband; rotor.len()]);
            let by_deadband = force::sweep(rotor, feedback, &speeds, &clearances, onlooker.stop, onlooker.done)?;
            Ok(Forces { speeds, by_deadband })
        };
        let jeffcott_forces = sweep(&jeffcott, &cancel, 5)?;
        let composite_forces = sweep(&three_mass, &composite, 6)?;
        let searched = Searched::gather(&three_mass, onlooker)?;
        let whole = speeds(1.0, 5.0, 5);
        let exact = |g: &f64| synchronous(&jeffcott, &cancel, &[*g], &whole);
        let (up_to_5, up_to_8) = (speeds(0.0, 5.0, TRACE), speeds(0.0, 8.0, TRACE));
        Ok(Self {
            jeffcott_trace: trace(&jeffcott, &jeffcott_off, &up_to_5)?,
            jeffcott_thresholds: thresholds(&jeffcott, &jeffcott_off, 0.0, 5.0)?,
            jeffcott_criticals: critical_speeds(&jeffcott, &jeffcott_off, 0.0, 5.0, &[1.0])?,
            cancel_trace: trace(&jeffcott, &cancel, &up_to_5)?,
            jeffcott_exact: DEADBANDS.iter().map(exact).collect::<Result<_, _>>()?,
            three_mass_trace: trace(&three_mass, &three_mass_off, &up_to_5)?,
            three_mass_thresholds: thresholds(&three_mass, &three_mass_off, 0.0, 6.0)?,
            three_mass_criticals: critical_speeds(&three_mass, &three_mass_off, 0.0, 6.0, &[1.0])?,
            composite_trace: trace(&three_mass, &composite, &up_to_8)?,
            composite_thresholds: thresholds(&three_mass, &composite, 0.0, 8.0)?,
            jeffcott,
            jeffcott_off,
            three_mass,
            three_mass_off,
            jeffcott_forces,
            composite_forces,
            searched,
            unstable,
            steady,
            impulses,
            impulse_spectrum,
            slow,
            fast,
            loose,
        })
    }

    /// The modes of a rotor at one speed.
    ///
    /// # Errors
    /// Eigenvalues that do not converge.
    pub(super) fn modes(rotor: &Rotor, feedback: &Feedback, speed: f64) -> Result<Modes, ReportError> {
        Ok(Modes::of(&ClosedLoop::new(rotor, feedback, speed, &[]))?)
    }
}

/// The simulations, in the order of the figures.
fn records(rotors: &[&Rotor; 2], laws: &[&Feedback; 3], onlooker: &Onlooker<'_>) -> Result<Vec<Record>, ReportError> {
    let [jeffcott, three_mass] = *rotors;
    let [off, cancel, composite] = *laws;
    let base = Case {
        rotor: jeffcott,
        feedback: cancel,
        speed: 5.0,
        deadband: 0.0,
        impulse: C64::ZERO,
        duration: 40.0,
        settle: Settle::From(0.0),
        keep_until: 40.0,
        keep_last: 0.0,
        spectrum: false,
    };
    let hit = |deadband| Case { deadband, impulse: IMPULSE, ..base };
    let long = Case { duration: 1200.0, settle: Settle::Detect, keep_last: 120.0, ..base };
    let three = |speed, deadband| Case { rotor: three_mass, feedback: composite, speed, deadband, ..long };
    let cases: [Case<'_>; CASES] = [
        Case { feedback: off, speed: 2.3, deadband: 1.0, duration: 60.0, keep_until: 60.0, ..base },
        base,
        hit(DEADBANDS[0]),
        hit(DEADBANDS[1]),
        hit(DEADBANDS[2]),
        Case { spectrum: true, settle: Settle::Detect, duration: 1200.0, ..hit(DEADBANDS[2]) },
        three(2.0, 1.0),
        Case { spectrum: true, ..three(6.0, 1.0) },
        three(6.0, 10.0),
    ];
    cases.par_iter().with_max_len(1).map(|case| run(case, onlooker.stop, onlooker.done)).collect()
}

fn run(case: &Case<'_>, stop: &AtomicBool, done: &(dyn Fn() + Sync)) -> Result<Record, ReportError> {
    if stop.load(Ordering::Relaxed) {
        return Err(ReportError::Interrupted);
    }
    let record = case.run(stop)?;
    done();
    Ok(record)
}
