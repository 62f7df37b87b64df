//! Poles and damping over speed for one set of gains, deadband neglected: what the damping panel and the trace among the
//! poles are drawn from.

use std::sync::Arc;

use machine::CountedModes;
use rotor::{C64, Feedback, Rotor, Settings};

use crate::history::Era;

/// Speeds that are looked at: two for each column of dots of a panel 100 wide.
const POINTS: usize = 400;
/// Bisections that locate a change of stability where the exact method gives up: each to 2e-7 of a step of the range.
const BISECTIONS: usize = 12;
/// The least range of speeds shown, in units of `w0`: the rotors of the report lose their stability within.
const LEAST_TOP: f64 = 8.0;

/// What is asked: everything that the answer depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct PoleTraceRequest {
    /// The rotor.
    pub rotor: Arc<Rotor>,
    /// The gains, which may depend on speed.
    pub feedback: Feedback,
    /// The highest speed, in units of `w0`.
    pub top: f64,
}

impl PoleTraceRequest {
    /// What to ask at a present `speed`. The range follows the speed only in steps, so that it rarely asks anew.
    pub fn at(rotor: Arc<Rotor>, feedback: Feedback, speed: f64) -> Self {
        let top = text::number::nice_ceiling(1.25 * speed.max(0.0)).max(LEAST_TOP);
        Self { rotor, feedback, top }
    }

    /// What to ask about settings in force; nothing as long as the rotor is not known.
    pub fn of(era: &Era) -> Option<Self> {
        let Settings { feedback, speed, .. } = &era.settings;
        Some(Self::at(era.rotor.clone()?, feedback.clone(), *speed))
    }

    fn settings(&self) -> Settings {
        Settings::new(&self.rotor, 0.0, self.feedback.clone())
    }

    fn min_damping(&self, speed: f64) -> f64 {
        machine::counted_damping(&self.rotor, &self.settings(), speed).unwrap_or(f64::NAN)
    }

    /// Poles as branches over speeds, and the smallest damping at each.
    fn trace(&self, speeds: &[f64]) -> Option<(Vec<Vec<C64>>, Vec<f64>)> {
        if rotor::ClosedLoop::describes(&self.rotor, &self.feedback) {
            let trace = rotor::trace(&self.rotor, &self.feedback, speeds).ok()?;
            let min_damping = trace.min_damping();
            return Some((trace.branches.into_iter().map(|b| b.poles).collect(), min_damping));
        }
        let branches = machine::trace(&self.rotor, &self.settings(), speeds).ok()?;
        let damping = |at: usize| {
            let poles = || branches.iter().filter_map(|b| b[at]);
            CountedModes::at(&self.rotor, speeds[at], poles()).min_damping(poles())
        };
        let min_damping = (0..speeds.len()).map(damping).collect();
        // A branch that a delay keeps out of sight at some speed is not drawn; its damping counts all the same.
        Some((branches.into_iter().filter_map(|b| b.into_iter().collect()).collect(), min_damping))
    }

    fn thresholds(&self) -> Option<Vec<f64>> {
        let found = if rotor::ClosedLoop::describes(&self.rotor, &self.feedback) {
            rotor::thresholds(&self.rotor, &self.feedback, 0.0, self.top).ok()?
        } else {
            machine::thresholds(&self.rotor, &self.settings(), 0.0, self.top).ok()?
        };
        Some(found.into_iter().map(|threshold| threshold.speed).collect())
    }
}

/// Poles and damping over speed.
#[derive(Clone, Debug)]
pub struct PoleTrace {
    request: PoleTraceRequest,
    /// The speeds, rising from 0, in units of `w0`.
    pub speeds: Vec<f64>,
    /// Continuous branches of poles over the speeds; empty where modes cannot be told apart.
    pub branches: Vec<Vec<C64>>,
    /// The smallest damping ratio at each speed, of the modes that count there; not a number where there is none.
    pub min_damping: Vec<f64>,
    /// Every range of speeds, `[from, to]` and rising, in which all modes decay.
    pub stable: Vec<[f64; 2]>,
}

impl PoleTrace {
    /// Computes the answer: some milliseconds for three masses.
    pub fn of(request: &PoleTraceRequest) -> Self {
        let speeds: Vec<f64> = (0..POINTS).map(|i| request.top * i as f64 / (POINTS - 1) as f64).collect();
        let each = || speeds.iter().map(|speed| request.min_damping(*speed)).collect();
        let (branches, min_damping) = request.trace(&speeds).unwrap_or_else(|| (Vec::new(), each()));
        let stable = stable_ranges(request, &speeds, &min_damping);
        Self { request: request.clone(), speeds, branches, min_damping, stable }
    }

    /// The highest speed.
    pub fn top(&self) -> f64 {
        self.request.top
    }

    /// The smallest damping ratio at any speed in the range, exactly.
    pub fn min_damping_at(&self, speed: f64) -> f64 {
        self.request.min_damping(speed)
    }

    /// The same, between the speeds that were looked at: good enough for a dot.
    pub fn min_damping_near(&self, speed: f64) -> f64 {
        let at = speed / self.top() * (self.speeds.len() - 1) as f64;
        let from = (at.max(0.0) as usize).min(self.speeds.len() - 2);
        let (low, high) = (self.min_damping[from], self.min_damping[from + 1]);
        low + (high - low) * (at - from as f64)
    }

    /// Whether all modes decay at `speed`.
    #[cfg(test)]
    fn is_stable(&self, speed: f64) -> bool {
        self.stable.iter().any(|[from, to]| (*from..=*to).contains(&speed))
    }
}

/// The ranges in which the rotor is stable, between changes of stability.
fn stable_ranges(request: &PoleTraceRequest, speeds: &[f64], min_damping: &[f64]) -> Vec<[f64; 2]> {
    let mut edges = request.thresholds().unwrap_or_default();
    // What no threshold marks: where a mode comes to rest on zero, and all where the exact method gave up.
    edges.extend(sign_changes(request, speeds, min_damping, &edges));
    edges.extend([0.0, request.top]);
    edges.sort_by(f64::total_cmp);
    let mut ranges: Vec<[f64; 2]> = Vec::new();
    for pair in edges.windows(2).filter(|pair| pair[0] < pair[1]) {
        if request.min_damping(0.5 * (pair[0] + pair[1])) > 0.0 {
            match ranges.last_mut() {
                // A mode became stable while all others were: the range goes on.
                Some(last) if last[1] == pair[0] => last[1] = pair[1],
                _ => ranges.push([pair[0], pair[1]]),
            }
        }
    }
    ranges
}

/// Speeds at which the smallest damping begins or ends to be positive, between samples that have none of `known` between them.
fn sign_changes(request: &PoleTraceRequest, speeds: &[f64], min_damping: &[f64], known: &[f64]) -> Vec<f64> {
    let mut found = Vec::new();
    for (speed, damping) in speeds.windows(2).zip(min_damping.windows(2)) {
        let was = damping[0] > 0.0;
        let explained = known.iter().any(|edge| (speed[0]..=speed[1]).contains(edge));
        if was == (damping[1] > 0.0) || explained {
            continue;
        }
        let (mut low, mut high) = (speed[0], speed[1]);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if (request.min_damping(middle) > 0.0) == was {
                low = middle;
            } else {
                high = middle;
            }
        }
        found.push(0.5 * (low + high));
    }
    found
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rotor::builtin;

    use super::*;
    use crate::test_support::question;

    fn edges(rotor: &str, feedback: &str) -> Vec<[f64; 2]> {
        PoleTrace::of(&question(rotor, feedback, 2.5)).stable
    }

    fn assert_near(found: &[[f64; 2]], expected: &[[f64; 2]], within: f64) {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((a - b).abs() < within, "{found:?}, not {expected:?}");
        }
    }

    #[test]
    fn val_without_control_the_rotors_are_stable_up_to_the_reports_thresholds() {
        // Sections 3.3 and 4.3 of the report: 2.2 and 1.775; its exact values to six digits.
        assert_near(&edges("jeffcott", "off"), &[[0.0, 2.209_975]], 1e-6);
        assert_near(&edges("three-mass", "off"), &[[0.0, 1.775_522]], 1e-6);
        // Composite output with one constant set of gains: "about 7.2".
        let composite = edges("three-mass", "composite");
        assert!(composite.len() == 1 && composite[0][0] == 0.0 && (7.0..7.3).contains(&composite[0][1]));
        // The cancelling law keeps the poles of R = 0 at any speed.
        assert_eq!(edges("jeffcott", "cancel"), [[0.0, 8.0]]);
    }

    #[test]
    fn bisection_finds_what_the_exact_method_finds() {
        for (rotor, feedback) in [("jeffcott", "off"), ("three-mass", "off"), ("three-mass", "composite")] {
            let request = question(rotor, feedback, 2.5);
            let pole_trace = PoleTrace::of(&request);
            let found = sign_changes(&request, &pole_trace.speeds, &pole_trace.min_damping, &[]);
            let exact: Vec<f64> =
                pole_trace.stable.iter().flatten().copied().filter(|edge| *edge > 0.0 && *edge < 8.0).collect();
            assert_eq!(found.len(), exact.len(), "{rotor} {feedback}");
            for (a, b) in found.iter().zip(&exact) {
                assert!((a - b).abs() < 1e-5, "{a} and {b}");
            }
        }
    }

    #[test]
    fn a_stretch_on_which_a_mode_rests_on_zero_is_not_stable() {
        // Damped by its control alone, which fades: 0 from R = 2 to 4, and drives the whirl beyond.
        let mass = rotor::Mass { mass: 1.0, bearing_stiffness: 1.0, ..rotor::Mass::default() };
        let rotor = rotor::Rotor::new("held by its control", vec![mass], vec![]).unwrap();
        let mut signal = rotor::Signal::at_mass(0, 1, [0.0; 4]);
        let fades = |sign: f64| vec![(0.0, 0.2 * sign), (2.0, 0.0), (4.0, 0.0), (6.0, -0.2 * sign)];
        let stable = [1.0, -1.0].map(|sign| {
            signal.gains[1] = rotor::Gain::Table(fades(sign));
            let feedback = Feedback::new(0, vec![signal.clone()]);
            PoleTrace::of(&PoleTraceRequest::at(Arc::new(rotor.clone()), feedback, 1.0)).stable
        });
        // Whichever sign damps, it does so up to 2 and the other from 4 on.
        let [damps, drives] = if stable[0].first().is_some_and(|range| range[0] == 0.0) { [0, 1] } else { [1, 0] };
        assert_near(&stable[damps], &[[0.0, 2.0]], 1e-4);
        assert_near(&stable[drives], &[[4.0, 8.0]], 1e-4);
    }

    #[test]
    fn the_range_follows_the_speed_in_steps() {
        let top = |speed| question("jeffcott", "off", speed).top;
        assert_eq!([top(0.0), top(2.5), top(6.4)], [8.0; 3]);
        assert_eq!([top(6.5), top(8.0)], [10.0; 2]);
        assert!(top(100.0) >= 125.0);
        assert_eq!(top(f64::NAN), 8.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        /// Whatever the gains, the ranges are where the damping is positive, and the branches are the poles.
        #[test]
        fn ranges_and_branches_agree_with_the_poles(
            gains in prop::array::uniform4(-2.0..2.0),
            weights in prop::collection::vec(-1.0..1.0, 3),
            at in 0_usize..POINTS,
        ) {
            let rotor = builtin::rotor("three-mass").unwrap();
            let mut feedback = builtin::feedback(&rotor, "composite").unwrap();
            feedback.bearings[0].signals = vec![rotor::Signal::composite(&weights, gains)];
            let request = PoleTraceRequest::at(Arc::new(rotor), feedback, 1.0);
            let pole_trace = PoleTrace::of(&request);
            let speed = pole_trace.speeds[at];
            let damping = pole_trace.min_damping_at(speed);
            prop_assert!((damping - pole_trace.min_damping[at]).abs() < 1e-9);
            if damping.abs() > 1e-9 {
                prop_assert_eq!(pole_trace.is_stable(speed), damping > 0.0, "{} at {}", damping, speed);
            }
            let closed_loop = rotor::ClosedLoop::new(&request.rotor, &request.feedback, speed, &[]);
            let mut rest = rotor::poles(&closed_loop).unwrap();
            for branch in &pole_trace.branches {
                let near = rest.iter().position(|pole| (pole - branch[at]).norm() < 1e-7);
                prop_assert!(near.is_some(), "{} is no pole at {speed}", branch[at]);
                rest.swap_remove(near.unwrap());
            }
        }
    }
}
