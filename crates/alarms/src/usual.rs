//! Limits that follow the machine until somebody says what it bears: of what its settings tell of clearances, trip and actuator.
//!
//! They are no promise of anybody: an orbit of several clearances is whirl that the deadband lets grow, and ISO 14839-2 lets no machine run
//! for long beyond 0.4 of the clearance that is not to be bridged, nor at all beyond 0.5; here that clearance is where the machine trips.

use rotor::{ControlMasses, MAX_BEARINGS, Settings};

/// Warning and alarm of the orbit, in the largest clearance of a support bearing that is no touchdown bearing: the zones of ISO 14839-2 are
/// shares of a clearance that must not be bridged; a deadband is bridged whenever the bearing carries, and this is how far beyond it.
const CLEARANCES: [f64; 2] = [5.0, 10.0];
/// The same in parts of the least clearance of a touchdown bearing, and of the trip's limit: where zones B and C of ISO 14839-2 end.
const SHARES: [f64; 2] = [0.4, 0.5];
/// Warning and alarm of the force, in parts of the actuator's limit.
const ACTUATOR: [f64; 2] = [0.8, 0.95];

/// Warning and alarm of the largest orbit, in `e_t`; none where neither clearance nor trip is set. `touchdown` are the coordinates with a
/// touchdown bearing: the largest orbit anywhere is held against the least of their clearances.
pub(crate) fn orbit(settings: &Settings, touchdown: &[usize]) -> Option<[f64; 2]> {
    let clearances = |is_touchdown: bool| {
        let all = settings.deadband.iter().copied().enumerate();
        all.filter(move |(k, clearance)| *clearance > 0.0 && touchdown.contains(k) == is_touchdown).map(|(_, g)| g)
    };
    let of_supports =
        clearances(false).max_by(f64::total_cmp).map(|clearance| CLEARANCES.map(|times| times * clearance));
    let unbridged = clearances(true).chain(Some(settings.trip).filter(|trip| trip.is_finite()));
    let of_unbridged = unbridged.min_by(f64::total_cmp).map(|clearance| SHARES.map(|share| share * clearance));
    [of_supports, of_unbridged].into_iter().flatten().min_by(|a, b| a[0].total_cmp(&b[0]))
}

/// Warning and alarm of the control of each control bearing, as that of the first (`masses`), in `m_b w0^2 e_t`: parts of what its own
/// actuator can do; without a limit of that, what its gains make of an orbit at its own limits, all masses in phase with the spin `speed`:
///
/// ```text
/// |u| = sum_k |d_k + j R v_k| r
/// ```
///
/// with `d` and `v` the gains on displacement and velocity of each mass; gains before a filter are no stiffness and tell nothing. None where
/// nothing is fed back. `touchdown` as for [`orbit`].
pub(crate) fn forces(
    settings: &Settings,
    touchdown: &[usize],
    speed: f64,
    masses: &ControlMasses,
) -> [Option<[f64; 2]>; MAX_BEARINGS] {
    let mut all = [None; MAX_BEARINGS];
    for (k, (bearing, limits)) in settings.feedback.bearings.iter().zip(&mut all).enumerate() {
        let limit = bearing.parts.limit;
        let is_filtered =
            !bearing.filters.is_empty() || bearing.signals.iter().any(|signal| !signal.filters.is_empty());
        let of_gains = || {
            if is_filtered {
                return None;
            }
            let row = bearing.at(speed);
            let gains = row.displacement.iter().zip(&row.velocity);
            let stiffness: f64 = gains.map(|(d, v)| (d + rotor::J * speed * v).norm()).sum();
            Some(orbit(settings, touchdown)?.map(|radius| stiffness * radius))
        };
        let own = if limit.is_finite() { Some(ACTUATOR.map(|share| share * limit)) } else { of_gains() };
        let own = own.filter(|[warning, alarm]| *warning > 0.0 && alarm.is_finite());
        *limits = own.map(|pair| pair.map(|control| masses.as_of_first(k, control)));
    }
    all
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    /// What is usual of the first control bearing at 2.5.
    fn first(settings: &Settings) -> Option<[f64; 2]> {
        forces(settings, &[], 2.5, &ControlMasses::default())[0]
    }

    fn settings(feedback: &str) -> Settings {
        let rotor = builtin::rotor("three-mass").unwrap();
        Settings::new(&rotor, 2.5, builtin::feedback(&rotor, feedback).unwrap())
    }

    #[test]
    fn an_orbit_is_held_against_clearance_and_trip() {
        let mut settings = settings("composite");
        (settings.deadband, settings.trip) = (vec![1.0, 2.0, 0.5], 1000.0);
        assert_eq!(orbit(&settings, &[]), Some([10.0, 20.0]));
        settings.trip = 10.0;
        assert_eq!(orbit(&settings, &[]), Some([4.0, 5.0]), "what trips is nearer");
        // What catches the rotor is not to be touched: the least of such clearances counts, not the largest.
        settings.trip = 1000.0;
        assert_eq!(orbit(&settings, &[0, 1]), Some([0.4, 0.5]));
        assert_eq!(orbit(&settings, &[1]), Some([0.8, 1.0]));
        settings.deadband.fill(0.0);
        settings.trip = f64::INFINITY;
        assert_eq!((orbit(&settings, &[]), first(&settings)), (None, None));
    }

    #[test]
    fn a_force_is_held_against_the_actuator_or_what_the_gains_make_of_the_orbit() {
        let mut off = settings("off");
        assert_eq!(first(&off), None, "nothing is fed back");
        off.feedback.bearings[0].parts.limit = 2.0;
        assert_eq!(first(&off), Some([1.6, 1.9]));
        let mut composite = settings("composite");
        composite.deadband.fill(1.0);
        let [warning, alarm] = first(&composite).unwrap();
        // Every mass at the limit of the orbit and in phase: what the law itself makes of that.
        let row = composite.feedback.first().at(2.5);
        let radius = orbit(&composite, &[]).unwrap()[0];
        let gains = row.displacement.iter().zip(&row.velocity);
        let most: f64 = gains.map(|(d, v)| (d * radius + rotor::J * 2.5 * v * radius).norm()).sum();
        assert!((warning - most).abs() < 1e-12 * most && alarm == 2.0 * warning, "{warning} {alarm} {most}");
    }

    #[test]
    fn regress_a_rig_is_held_against_its_touchdown_bearings_and_not_against_gains_before_a_filter() {
        let rotor = builtin::rotor("rig").unwrap();
        let settings = Settings::new(&rotor, 1.0, builtin::feedback(&rotor, "own").unwrap());
        let touchdown: Vec<usize> = rotor.beam().unwrap().touchdown().collect();
        assert_eq!(touchdown.len(), 2);
        let clearance = settings.deadband[touchdown[0]];
        assert_eq!(orbit(&settings, &touchdown), Some([0.4 * clearance, 0.5 * clearance]));
        let masses = ControlMasses::of(&rotor, &settings.feedback);
        assert_eq!(forces(&settings, &touchdown, 1.0, &masses)[..2], [None, None]);
    }

    #[test]
    fn every_control_bearing_is_held_against_its_own_actuator() {
        let rotor = builtin::rotor("three-mass").unwrap();
        // 0.5 and 0.25 of the mass.
        let bearing = |station, limit| {
            let mut bearing = rotor::ControlBearing::new(station, vec![]);
            bearing.parts.limit = limit;
            bearing
        };
        let bearings = vec![bearing(1, 2.0), bearing(0, 10.0), bearing(2, f64::INFINITY)];
        let settings = Settings::new(&rotor, 0.0, rotor::Feedback { bearings });
        let masses = ControlMasses::of(&rotor, &settings.feedback);
        // 10 on half the mass is as large a force as 5.
        assert_eq!(forces(&settings, &[], 0.0, &masses)[..3], [Some([1.6, 1.9]), Some([4.0, 4.75]), None]);
    }
}
