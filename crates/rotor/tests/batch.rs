//! A batch is as many trajectories as it has lanes, each to the last bit what its stepper makes of it, in registers of every width.

use proptest::prelude::*;
use rotor::batch::{BETWEEN_STARTS, Batch};
use rotor::{C64, ClosedLoop, Feedback, Mass, Peaks, Rotor, Signal, Stepper, stepper};

const WIDTHS: [usize; 3] = [1, 4, 8];
const LIMIT: f64 = 1e6;

fn numbers(count: usize, range: std::ops::Range<f64>) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(range, count)
}

/// A chain of `masses`, some of whose terms are not there.
fn closed_loop(masses: usize) -> impl Strategy<Value = (ClosedLoop, f64)> {
    let of = (numbers(masses * 9, 0.0..1.0), numbers(masses * 8, -1.0..1.0), 0..masses, 0.0..4.0, 0.002..0.03);
    of.prop_map(move |(positive, gains, bearing, speed, dtau)| {
        // Below a third a term is left out.
        let some = |number: f64| if number < 0.33 { 0.0 } else { number };
        let mass = |i: usize| {
            let of = &positive[9 * i..9 * i + 9];
            Mass {
                mass: 0.2 + of[0],
                damping: some(of[1]),
                cross_damping: some(of[2]) * 0.2,
                bearing_stiffness: some(of[3]),
                seal_stiffness: some(of[4]),
                unbalance: some(of[5]),
                ..Mass::default()
            }
        };
        let shafts = (1..masses).map(|i| 0.1 + positive[9 * i + 6]).collect();
        let rotor = Rotor::new("any", (0..masses).map(mass).collect(), shafts).expect("valid");
        let clearances: Vec<f64> = (0..masses).map(|i| some(positive[9 * i + 7]) * 2.0).collect();
        let signals = (0..masses).map(|i| {
            let gains = if positive[9 * i + 8] < 0.33 { [0.0; 4] } else { [0, 1, 2, 3].map(|k| gains[8 * i + k]) };
            Signal::composite(&(0..=i).map(|k| f64::from(u8::from(k == i))).collect::<Vec<f64>>(), gains)
        });
        let feedback = Feedback::new(bearing, signals.collect());
        (ClosedLoop::new(&rotor, &feedback, speed, &clearances), dtau)
    })
}

fn launches() -> impl Strategy<Value = Vec<(ClosedLoop, f64, Vec<f64>)>> {
    prop_oneof![Just(1_usize), Just(2), Just(3), Just(5)].prop_flat_map(|masses| {
        prop::collection::vec((closed_loop(masses), numbers(4 * masses, -2.0..2.0)), 8)
            .prop_map(|all| all.into_iter().map(|((of, dtau), start)| (of, dtau, start)).collect())
    })
}

fn start(of: &[f64]) -> [Vec<C64>; 2] {
    let all: Vec<C64> = of.chunks(2).map(|pair| C64::new(pair[0], pair[1])).collect();
    let (p, v) = all.split_at(all.len() / 2);
    [p.to_vec(), v.to_vec()]
}

/// Displacement, velocity, maxima of `|u|^2` and every `|p|^2` and sums of `|p|` of one trajectory after `steps`, kept from sample `from` on.
fn single(of: &ClosedLoop, dtau: f64, at: &[f64], steps: usize, from: usize) -> (Box<dyn Stepper>, Vec<f64>, Vec<f64>) {
    let mut stepper = stepper(of);
    let [p, v] = start(at);
    stepper.place(&p, &v);
    let (mut peaks, mut maxima, mut sums) =
        (Peaks::new(of.masses() + 1), vec![0.0; of.masses() + 1], vec![0.0; of.masses()]);
    for sample in 0..=steps {
        if sample > 0 {
            stepper.step(dtau);
        }
        if sample == from {
            maxima.fill(0.0);
            sums.fill(0.0);
        }
        let squares = stepper.motion().displacement.iter().map(|p| p.norm_sqr());
        let signals: Vec<f64> = std::iter::once(stepper.control().norm_sqr()).chain(squares).collect();
        peaks.push(&signals, &mut maxima);
        sums.iter_mut().zip(&signals[1..]).for_each(|(sum, square)| *sum += square.sqrt());
    }
    (stepper, maxima, sums)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_lane_is_a_trajectory_to_the_last_bit(all in launches(), steps in 40_usize..300, cut in 1_usize..40) {
        for width in WIDTHS {
            let mut batch = Batch::narrow(all[0].0.masses(), width);
            let lanes = batch.lanes();
            for (lane, (of, dtau, at)) in all.iter().take(lanes).enumerate() {
                let [p, v] = start(at);
                batch.start(lane, of, [&p, &v], *dtau, LIMIT);
            }
            // In two goes, with what was kept taken in between.
            prop_assert_eq!(batch.run(cut), cut);
            (0..lanes).for_each(|lane| { batch.take(lane); });
            prop_assert_eq!(batch.run(steps + 1 - cut), steps + 1 - cut);
            for (lane, (of, dtau, at)) in all.iter().take(lanes).enumerate() {
                let (stepper, maxima, sums) = single(of, *dtau, at, steps, cut);
                let [p, v] = batch.last(lane);
                prop_assert_eq!(stepper.motion().displacement, &p[..], "{} lanes", lanes);
                prop_assert_eq!(stepper.motion().velocity, &v[..]);
                let kept = batch.take(lane);
                prop_assert_eq!(&kept.maxima[..maxima.len()], &maxima[..]);
                prop_assert_eq!(&kept.radius_sums[..sums.len()], &sums[..]);
            }
        }
    }
}

#[test]
fn a_lane_that_is_not_bounded_is_told_before_its_sample_and_others_go_on() {
    let mass = |damping: f64| Mass { mass: 1.0, damping, bearing_stiffness: 0.8, unbalance: 1.0, ..Mass::default() };
    let of = |damping: f64| {
        let rotor = Rotor::new("one", vec![mass(damping)], vec![]).expect("valid");
        ClosedLoop::new(
            &rotor,
            &Feedback::new(0, vec![Signal::composite(&[1.0], [0.0, if damping > 0.0 { 0.0 } else { -3.0 }, 0.0, 0.0])]),
            2.0,
            &[0.5],
        )
    };
    let (stable, unstable) = (of(0.5), of(0.0));
    for width in WIDTHS.into_iter().filter(|width| *width > 1) {
        let mut batch = Batch::narrow(1, width);
        if batch.lanes() < 2 {
            continue;
        }
        batch.start(0, &stable, [&[], &[]], 0.01, LIMIT);
        batch.start(1, &unstable, [&[], &[]], 0.01, LIMIT);
        let ran = batch.run(4000);
        assert!(ran < 4000 && batch.is_bounded(0) && !batch.is_bounded(1));
        let mut alone = stepper(&unstable);
        (0..ran).for_each(|_| alone.step(0.01));
        assert!(alone.motion().displacement[0].norm() > LIMIT);
        let kept = batch.take(1).maxima[1].sqrt();
        assert!(kept <= LIMIT && kept > 0.9 * LIMIT, "{kept}");
        batch.stop(1);
        assert_eq!(batch.run(5000 - ran), 5000 - ran);
        // A lane that is free takes another, in step with nobody.
        assert_eq!(batch.run(batch.until_start()) % BETWEEN_STARTS, 5000_usize.next_multiple_of(BETWEEN_STARTS) - 5000);
        batch.start(1, &stable, [&[], &[]], 0.02, LIMIT);
        assert_eq!(batch.run(100), 100);
        let mut other = stepper(&stable);
        (0..99).for_each(|_| other.step(0.02));
        assert_eq!(batch.last(1)[0], other.motion().displacement);
    }
}
