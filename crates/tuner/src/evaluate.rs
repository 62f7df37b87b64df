//! The worth of every mode at every condition for given gains, and its slope in each gain.

use std::cell::RefCell;

use linear::DelaySystem;
use rotor::{C64, Characteristic, MAX_MASSES, Quadratic};

use crate::Problem;
use crate::around::{self, Around};
use crate::delay;
use crate::force::Synchronous;
use crate::limits::Sought;
use crate::opened::Opened;
use crate::stop::Stop;

/// Price of a violated constraint, in worth per unit: above any multiplier that one has in practice.
pub(crate) const EXCESS: f64 = 10.0;

/// A condition with its equations of motion at hand.
#[derive(Clone, Debug)]
pub(crate) struct Operating {
    /// Where it is in the family.
    pub(crate) point: Vec<f64>,
    speed: f64,
    delay: f64,
    /// Control off, where the loop is gains and a delay at one bearing of a chain.
    open: Option<Quadratic>,
    /// Where it is more.
    around: Option<Box<Around>>,
    /// Where a force limit is to be kept.
    pub(crate) synchronous: Option<Synchronous>,
    /// Where margins are to be kept.
    pub(crate) opened: Option<Box<Opened>>,
}

impl Operating {
    /// The condition at `point` of the problem's family.
    pub(crate) fn at(problem: &Problem, point: &[f64]) -> Self {
        let open = problem.structure.is_plain().then(|| problem.family.open(point));
        let synchronous = problem.force_limit.map(|_| Synchronous::new(problem, point));
        let around = Around::at(problem, point).map(Box::new);
        let opened = Opened::at(problem, point).map(Box::new);
        Self { point: point.to_vec(), speed: point[0], delay: problem.delay(point), open, around, synchronous, opened }
    }

    /// The loop closed, with its poles; with a delay those of [`delay::poles`], of which `near` may be near.
    fn close(&self, problem: &Problem, gains: &[f64], near: &[C64]) -> Option<(Closed, Vec<C64>)> {
        if let Some(around) = &self.around {
            let closed = around.close(&problem.structure.gains_at(gains, self.speed))?;
            let (poles, line) = around::poles(&closed, near)?;
            return Some((Closed::Around(Box::new(closed), line), poles));
        }
        let open = self.open.as_ref()?;
        let row = problem.structure.row(gains, self.speed);
        if self.delay > 0.0 {
            let system = delay::late(open, &row, self.delay).ok()?;
            let found = delay::poles(&system, near).ok().filter(|found| !found.roots.is_empty())?;
            return Some((Closed::Late(Box::new(system), found.right_of), found.roots));
        }
        let mut closed = open.clone();
        closed.control(&row);
        let poles = closed.poles().ok()?;
        Some((Closed::AtOnce(closed), poles))
    }
}

/// A closed loop.
#[derive(Clone, Debug)]
enum Closed {
    AtOnce(Quadratic),
    /// With a delay, and the line right of which every pole was counted.
    Late(Box<DelaySystem>, f64),
    /// Through filters, lags or samples, and with a delay that line.
    Around(Box<Characteristic>, Option<f64>),
}

/// One mode at one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reading {
    /// Which condition.
    pub(crate) condition: usize,
    /// Its pole.
    pub(crate) pole: C64,
    /// What it is worth.
    pub(crate) value: f64,
}

/// Gains under judgement at a list of conditions.
#[derive(Debug)]
pub(crate) struct Evaluator<'p> {
    pub(crate) problem: &'p Problem,
    pub(crate) conditions: Vec<Operating>,
    /// Every mode of every condition for the gains last evaluated.
    pub(crate) readings: Vec<Reading>,
    /// One a condition; stale where it was not evaluated.
    closed: Vec<Option<Closed>>,
    /// Likewise, the poles: near those of the next gains, which is where loops with delay are looked for first.
    before: Vec<Vec<C64>>,
    /// How many eigenvalue problems were solved.
    pub(crate) evaluations: u64,
    /// One a condition: where its margins may fall short, for the gains that they were sought for last.
    pub(crate) sought: RefCell<Vec<Option<Sought>>>,
    sensitivities: Vec<C64>,
    /// Gains that these are to stay near, and the price of the square of the distance.
    pub(crate) tether: Option<(Vec<f64>, f64)>,
    /// Once it is set nothing is evaluated any more: whatever climbs comes to its end at once.
    stop: Stop<'p>,
}

impl<'p> Evaluator<'p> {
    /// Nothing evaluated yet.
    pub(crate) fn new(problem: &'p Problem, points: &[Vec<f64>]) -> Self {
        let conditions = points.iter().map(|point| Operating::at(problem, point)).collect();
        Self {
            problem,
            conditions,
            readings: Vec::new(),
            closed: Vec::new(),
            before: Vec::new(),
            evaluations: 0,
            sought: RefCell::default(),
            sensitivities: vec![C64::ZERO; problem.structure.variables()],
            tether: None,
            stop: Stop::NEVER,
        }
    }

    /// The same until `stop` is set: then everything is worth `-inf`.
    pub(crate) fn until(self, stop: Stop<'p>) -> Self {
        Self { stop, ..self }
    }

    /// Takes a condition more.
    pub(crate) fn push(&mut self, point: &[f64]) {
        self.conditions.push(Operating::at(self.problem, point));
    }

    /// Judges `gains` at every condition and gives the worth of the worst mode; `-inf` if it cannot be had.
    pub(crate) fn evaluate(&mut self, gains: &[f64]) -> f64 {
        self.readings.clear();
        let mut worst = f64::INFINITY;
        for condition in 0..self.conditions.len() {
            let value = self.judge_at(condition, gains);
            if value == f64::NEG_INFINITY {
                self.readings.clear();
                return value;
            }
            worst = worst.min(value);
        }
        worst
    }

    /// The same for some conditions alone: there are no readings of the others then.
    pub(crate) fn judge_some(&mut self, conditions: &[usize], gains: &[f64]) -> bool {
        self.readings.clear();
        conditions.iter().all(|&condition| self.judge_at(condition, gains) > f64::NEG_INFINITY)
    }

    fn judge_at(&mut self, condition: usize, gains: &[f64]) -> f64 {
        if self.stop.is_set() {
            return f64::NEG_INFINITY;
        }
        let operating = &self.conditions[condition];
        self.evaluations += 1;
        let near = self.before.get(condition).map_or(&[][..], |before| before);
        let Some((closed, poles)) = operating.close(self.problem, gains, near) else { return f64::NEG_INFINITY };
        let mut worst = f64::INFINITY;
        for &pole in &poles {
            let value = self.problem.worth(pole);
            worst = worst.min(value);
            self.readings.push(Reading { condition, pole, value });
        }
        self.closed.resize(self.conditions.len(), None);
        if operating.delay > 0.0 {
            self.before.resize(self.conditions.len(), Vec::new());
            self.before[condition] = poles;
        }
        self.closed[condition] = Some(closed);
        worst
    }

    /// The slope of one reading of the gains last evaluated in each variable, into `out`.
    pub(crate) fn slope(&mut self, reading: Reading, out: &mut [f64]) {
        let [by_re, by_im] = self.problem.worth_slope(reading.pole);
        for (out, moved) in out.iter_mut().zip(self.pole_slope(reading)) {
            *out = by_re * moved.re + by_im * moved.im;
        }
    }

    /// What the pole of a reading of the gains last evaluated moves by with each variable.
    pub(crate) fn pole_slope(&mut self, reading: Reading) -> &[C64] {
        let Reading { condition, pole, .. } = reading;
        let operating = &self.conditions[condition];
        let structure = &self.problem.structure;
        if let (Some(around), Some(Some(Closed::Around(closed, _)))) = (&operating.around, self.closed.get(condition)) {
            let mut by_gain = vec![C64::ZERO; structure.gains()];
            around.slopes(closed, pole, &mut by_gain);
            structure.spread(operating.speed, &by_gain, C64::ZERO, &mut self.sensitivities);
            return &self.sensitivities;
        }
        let Some(open) = &operating.open else {
            self.sensitivities.fill(C64::ZERO);
            return &self.sensitivities;
        };
        let (n, bearing) = (open.masses(), structure.bearing());
        let mut right = [C64::ZERO; MAX_MASSES];
        // What the pole moves by for a unit of force on the bearing's mass, in the scale of `right`.
        let per_force = match self.closed.get(condition) {
            Some(Some(Closed::Late(system, _))) => match system.sensitivity(pole) {
                Some(at) => {
                    right[..n].copy_from_slice(&at.right.as_slice()[..n]);
                    // At a defective pole the slope is infinite: large and finite keeps a search going.
                    let give = if at.give.norm() < 1e-12 { C64::from(1e-12) } else { at.give };
                    -(-pole * operating.delay).exp() * at.left[n + bearing] / give
                }
                None => C64::ZERO,
            },
            other => {
                let closed = if let Some(Some(Closed::AtOnce(closed))) = other { closed } else { open };
                let (mut left, mut moved) = ([C64::ZERO; MAX_MASSES], [C64::ZERO; MAX_MASSES]);
                closed.vectors(pole, &mut right[..n], &mut left[..n]);
                closed.row_times_damping(&left[..n], &mut moved[..n]);
                // q (2 lambda I - D) p: what the equation of motion gives way by as the pole moves.
                let give: C64 = (0..n).map(|i| (left[i] * (pole * 2.0) - moved[i]) * right[i]).sum();
                let floor = 1e-12 * pole.norm().max(1e-12);
                -left[bearing] / if give.norm() < floor { C64::from(floor) } else { give }
            }
        };
        self.problem.structure.sensitivities(operating.speed, &right[..n], pole, &mut self.sensitivities);
        self.sensitivities.iter_mut().for_each(|s| *s *= per_force);
        &self.sensitivities
    }

    /// What counts when gains are compared: the worth of the worst mode, less the price of constraints that are violated.
    pub(crate) fn merit(&mut self, gains: &[f64]) -> f64 {
        let worst = self.evaluate(gains);
        let lacking =
            self.readings.iter().filter_map(|r| self.problem.measure.in_hand(r.pole)).map(|(value, _)| -value);
        let excess = self.largest_relative_force(gains) - 1.0;
        let short = excess.max(self.shortfall(gains)).max(0.0);
        worst - EXCESS * lacking.fold(short, f64::max) - self.pull(gains)
    }

    /// The price of the distance from where the tether holds.
    pub(crate) fn pull(&self, gains: &[f64]) -> f64 {
        let Some((at, price)) = &self.tether else { return 0.0 };
        price * gains.iter().zip(at).map(|(x, a)| (x - a) * (x - a)).sum::<f64>()
    }
}

/// The worst mode at one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Worst {
    /// What it is worth; `-inf` if the poles cannot all be had.
    pub(crate) value: f64,
    /// Its pole.
    pub(crate) pole: C64,
    /// With a delay: every pole right of this was counted.
    pub(crate) right_of: Option<f64>,
}

/// The worst mode at one condition, poles on the axis but for rounding told as on it: a marginal one is worth exactly 0.
pub(crate) fn worst_at(problem: &Problem, gains: &[f64], point: &[f64]) -> Worst {
    let nothing = Worst { value: f64::NEG_INFINITY, pole: C64::ZERO, right_of: None };
    if !problem.structure.is_plain() {
        // Put together once, not once per gain.
        let Some((poles, right_of)) = around::poles_of(problem, gains, point) else { return nothing };
        let (value, pole) = problem.worst(&poles);
        return Worst { value, pole, right_of };
    }
    let operating = Operating {
        point: Vec::new(),
        speed: point[0],
        delay: problem.delay(point),
        open: Some(problem.family.open(point)),
        around: None,
        synchronous: None,
        opened: None,
    };
    let Some((closed, mut poles)) = operating.close(problem, gains, &[]) else { return nothing };
    let row = problem.structure.row(gains, point[0]);
    let right_of = match closed {
        Closed::Around(_, line) => line,
        Closed::AtOnce(closed) => {
            closed.settle(&mut poles);
            None
        }
        Closed::Late(system, line) => {
            if let Some(mut at_once) = operating.open {
                at_once.control(&row);
                at_once.settle_by(&mut poles, &|pole| condition(&system, pole));
            }
            Some(line)
        }
    };
    let (value, pole) = problem.worst(&poles);
    Worst { value, pole, right_of }
}

/// The size of `q Q'(pole) p` with the vectors in norm 1: the state is displacement over velocity, and `q` is what the row
/// has for the velocities. 0, which is the worst, if the vectors cannot be had.
fn condition(system: &DelaySystem, pole: C64) -> f64 {
    let Some(at) = system.sensitivity(pole) else { return 0.0 };
    let n = at.right.len() / 2;
    let sizes = at.right.rows(0, n).norm() * at.left.rows(n, n).norm();
    if sizes > 0.0 { at.give.norm() / sizes } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::opened::Place;
    use crate::{Family, FamilyAxis, FamilyQuantity, Schedule, Structure};

    fn problem(delay: f64, individual: bool, around: impl Fn(&mut rotor::Feedback)) -> Problem {
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        let mut family = Family::new(&rotor, 0.0, 7.0).unwrap();
        family.any_deadband(true).unwrap();
        if delay > 0.0 {
            family.push(FamilyAxis { quantity: FamilyQuantity::Delay, from: delay, to: delay }).unwrap();
        }
        let mut template =
            if individual { Structure::individual(3, 0, &[0, 1]) } else { Structure::composite(3, 0, &[0, 1]) };
        around(&mut template);
        let structure = Structure::new(&rotor, &template, Schedule::table(0.0, 7.0, 3)).unwrap();
        Problem {
            force_limit: Some(2.0),
            max_sensitivity: Some(1.5),
            min_delay: Some(0.3),
            ..Problem::new(family, structure, 20.0)
        }
    }

    /// Slopes of poles and force are those of differences, with and without delay, for every gain at every knot.
    fn slopes_agree(problem: &Problem, gains: &[f64], point: &[f64], h: f64) -> Result<(), TestCaseError> {
        let mut evaluator = Evaluator::new(problem, &[point.to_vec()]);
        evaluator.evaluate(gains);
        let readings = evaluator.readings.clone();
        let mut force_slope = vec![0.0; gains.len()];
        evaluator.relative_force(0, gains, &mut force_slope);
        let opened = evaluator.conditions[0].opened.as_ref().expect("margins are asked for");
        let places = opened.places(problem, gains, &[]).into_iter().map(|place| {
            let mut slope = vec![0.0; gains.len()];
            opened.slope(problem, gains, &place, &mut slope);
            (place, slope)
        });
        let places: Vec<(Place, Vec<f64>)> = places.collect();
        let slopes: Vec<Vec<C64>> = readings.iter().map(|r| evaluator.pole_slope(*r).to_vec()).collect();
        for i in 0..gains.len() {
            let shifted = |by: f64| {
                let mut there = gains.to_vec();
                there[i] += by;
                there
            };
            let mut poles_at = |by: f64| {
                evaluator.evaluate(&shifted(by));
                evaluator.readings.iter().map(|r| r.pole).collect::<Vec<_>>()
            };
            let (after, before) = (poles_at(h), poles_at(-h));
            for (reading, slope) in readings.iter().zip(&slopes) {
                let gap = readings
                    .iter()
                    .filter(|r| r != &reading)
                    .map(|r| (r.pole - reading.pole).norm())
                    .fold(1.0, f64::min);
                if gap < 0.05 || reading.pole.norm() > 20.0 {
                    continue; // Slopes change fast near a merger, and differences say little.
                }
                let near = |poles: &[C64]| {
                    poles
                        .iter()
                        .copied()
                        .min_by(|a, b| (a - reading.pole).norm().total_cmp(&(b - reading.pole).norm()))
                        .unwrap()
                };
                let difference = (near(&after) - near(&before)) / (2.0 * h);
                prop_assert!(
                    (difference - slope[i]).norm() < 1e-3 * (1.0 + slope[i].norm() / gap),
                    "{difference} {}",
                    slope[i]
                );
            }
            // Margins: each place beside the same one a little further on.
            let near: Vec<f64> = places.iter().map(|(place, _)| place.frequency).collect();
            let opened = evaluator.conditions[0].opened.as_ref().expect("margins are asked for");
            let [after, before] = [h, -h].map(|by| opened.places(problem, &shifted(by), &near));
            let same = |all: &[Place], place: &Place| {
                let alike = all.iter().filter(|o| (o.ask, o.bearing) == (place.ask, place.bearing)).copied();
                let distance = |p: &Place| (p.frequency - place.frequency).abs();
                alike.min_by(|a, b| distance(a).total_cmp(&distance(b)))
            };
            for (place, slope) in &places {
                let (Some(after), Some(before)) = (same(&after, place), same(&before, place)) else { continue };
                let moved = |other: Place| (other.frequency - place.frequency).abs();
                if moved(after).max(moved(before)) > 1e-2 || slope[i].abs() > 1e3 {
                    continue; // About to merge with another, or another.
                }
                let difference = (after.in_hand - before.in_hand) / (2.0 * h);
                prop_assert!(
                    (difference - slope[i]).abs() < 2e-3 * (1.0 + slope[i].abs()),
                    "{place:?}: {difference} {}",
                    slope[i]
                );
            }
            let difference = (evaluator.relative_force(0, &shifted(h), &mut [])
                - evaluator.relative_force(0, &shifted(-h), &mut []))
                / (2.0 * h);
            prop_assert!(
                (difference - force_slope[i]).abs() < 1e-4 * (1.0 + force_slope[i].abs()),
                "{difference} {}",
                force_slope[i]
            );
        }
        Ok(())
    }

    /// Loops of every kind.
    fn around(feedback: &mut rotor::Feedback, kind: i32) {
        match kind {
            1 => feedback.bearings[0].parts.lag = 0.05,
            2 => feedback.bearings[0].signals[0].filters = vec![rotor::Filter::Lead { zero: 3.0, pole: 12.0 }],
            3 => feedback.bearings[0].parts.sample = 0.1,
            _ => (),
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn slopes_are_those_of_differences(
            seed in prop::collection::vec(-2.0..2.0f64, 24),
            speed in 0.5..6.5f64,
            factors in (0.1..1.0f64, 0.1..1.0f64),
            delay in prop_oneof![Just(0.0), 0.01..0.3f64],
            individual in any::<bool>(),
            kind in 0..4,
        ) {
            let problem = problem(delay, individual, |feedback| around(feedback, kind));
            let gains = &seed[..problem.structure.variables()];
            let mut point = vec![speed, factors.0, factors.1];
            if delay > 0.0 {
                point.push(delay);
            }
            slopes_agree(&problem, gains, &point, 1e-6)?;
        }
    }

    /// A chain under two bearings, each reading both ends, the second through a filter.
    fn two_bearings(lag: f64, delay: f64) -> Problem {
        let rotor = rotor::builtin::rotor("three-mass").unwrap();
        let mut template = Structure::individual(3, 0, &[0, 2]);
        let mut other = Structure::individual(3, 2, &[1, 2]).bearings.remove(0);
        other.signals[0].filters = vec![rotor::Filter::Lead { zero: 3.0, pole: 12.0 }];
        template.bearings.push(other);
        template.bearings[0].parts.lag = lag;
        template.set_delay(delay);
        let structure = Structure::new(&rotor, &template, Schedule::Linear { from: 0.0, to: 7.0 }).unwrap();
        let family = Family::new(&rotor, 0.0, 7.0).unwrap();
        let limits = Problem::new(family, structure, 20.0);
        Problem { force_limit: Some(2.0), max_sensitivity: Some(1.5), min_delay: Some(0.3), ..limits }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn slopes_through_several_bearings_are_those_of_differences(
            seed in prop::collection::vec(-1.0..1.0f64, 32),
            speed in 0.5..6.5f64,
            lag in prop_oneof![Just(0.0), Just(0.05)],
            delay in prop_oneof![Just(0.0), Just(0.1)],
        ) {
            slopes_agree(&two_bearings(lag, delay), &seed, &[speed], 1e-6)?;
        }

        #[test]
        fn slopes_of_a_shaft_on_magnetic_bearings_are_those_of_differences(
            seed in prop::collection::vec(-0.3..0.3f64, 8),
            speed in 0.5..6.0f64,
        ) {
            let rotor = rotor::builtin::rotor("rig").unwrap();
            let own = rotor::builtin::feedback(&rotor, "own").unwrap();
            let structure = Structure::new(&rotor, &own, Schedule::Fixed).unwrap();
            let gains: Vec<f64> = structure.own().iter().zip(&seed).map(|(own, by)| own + by).collect();
            let family = Family::new(&rotor, 0.0, 6.0).unwrap();
            let limits = Problem::new(family, structure, 4.0);
            let problem = Problem { force_limit: Some(2.0), max_sensitivity: Some(1.5), min_delay: Some(0.01), ..limits };
            // Its fastest poles are a million times as fast as its slowest: rounding is larger too.
            slopes_agree(&problem, &gains, &[speed], 1e-4)?;
        }
    }

    /// Past the frequency up to which modes count a mode is worth ever more, without a jump, and stability is stability everywhere.
    #[test]
    fn modes_past_the_limit_are_worth_more_but_never_what_they_are_not() {
        let rotor = rotor::builtin::rotor("rig").unwrap();
        let own = rotor::builtin::feedback(&rotor, "own").unwrap();
        let structure = Structure::new(&rotor, &own, Schedule::Fixed).unwrap();
        let problem = Problem::new(Family::new(&rotor, 0.0, 6.0).unwrap(), structure, 4.0);
        let below = problem.below.expect("a shaft's modes count up to somewhere");
        for part in [0.5, 1.0, 1.1, 1.3, 3.0] {
            for damping in [-0.01, 0.0, 0.01] {
                let pole = C64::from_polar(part * below, std::f64::consts::FRAC_PI_2 + f64::asin(damping));
                let (worth, plain) = (problem.worth(pole), problem.measure.of(pole));
                assert_eq!(worth > 0.0, plain > 0.0);
                assert!(worth >= plain && (part > 1.0 && damping > 0.0 || worth == plain), "{part} {damping}: {worth}");
                let h = 1e-7 * below;
                let slope = problem.worth_slope(pole);
                for (k, step) in [C64::from(h), C64::new(0.0, h)].into_iter().enumerate() {
                    if part == 1.0 || damping == 0.0 {
                        continue; // A corner.
                    }
                    let difference = (problem.worth(pole + step) - problem.worth(pole - step)) / (2.0 * h);
                    assert!(
                        (difference - slope[k]).abs() < 1e-4 * (1.0 + slope[k].abs()),
                        "{part}: {difference} {}",
                        slope[k]
                    );
                }
            }
        }
    }

    /// Every pole that is evaluated solves the equation with the delay in it.
    #[test]
    fn val_poles_with_delay_solve_the_transcendental_equation() {
        let problem = problem(0.2, false, |_| ());
        let gains: Vec<f64> = (0..problem.structure.variables()).map(|i| 0.3 * (i as f64).cos()).collect();
        let point = [5.0, 1.0, 1.0, 0.2];
        let operating = Operating::at(&problem, &point);
        let row = problem.structure.row(&gains, 5.0);
        let (_, poles) = operating.close(&problem, &gains, &[]).unwrap();
        assert!(poles.len() >= 6, "{poles:?}");
        for s in poles {
            let late = (-s * 0.2).exp();
            let mut row = row;
            row.displacement.iter_mut().chain(&mut row.velocity).for_each(|gain| *gain *= late);
            let mut seen = operating.open.clone().expect("a plain chain");
            seen.control(&row);
            // det(s^2 I - s D - K) by cofactors.
            let q = |i: usize, j: usize| {
                let own = if i == j { s * s } else { C64::ZERO };
                own - seen.stiffness()[3 * i + j] - s * seen.damping()[3 * i + j]
            };
            let minor = |a: usize, b: usize| q(1, a) * q(2, b) - q(1, b) * q(2, a);
            let det = q(0, 0) * minor(1, 2) - q(0, 1) * minor(0, 2) + q(0, 2) * minor(0, 1);
            assert!(det.norm() < 1e-9 * (1.0 + s.norm()).powi(6), "{s} {det}");
        }
    }
}
