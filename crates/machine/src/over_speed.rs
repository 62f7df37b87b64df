//! Poles of any machine over speed: which is which from one speed to the next, and where one crosses the limit of stability.
//!
//! An ideal loop has ways of its own in crate `rotor`, with certificates. This is for all others: roots are matched by
//! nearness, with as many speeds in between as it takes for every match to be beyond doubt. Roots of a sampled loop are
//! matched as `z`, which does not jump where a frequency passes half the sampling rate.

use rotor::{C64, OperatingPoint, Plant, Rotor, Settings, Stability, Threshold, Whirl};

use crate::linear_form::LinearForm;
use crate::poles::{Characteristic, PolesError, Root};

/// A match is beyond doubt if the next root is so many times as far.
const BEYOND_DOUBT: f64 = 3.0;
/// Speeds this near, relative to the range, are not told apart further.
const NEAREST: f64 = 1e-7;
/// Stretches that a search for thresholds begins with.
const STRETCHES: usize = 48;
/// Halvings of a stretch that holds a threshold: to the last place.
const HALVINGS: usize = 60;

/// A branch over speeds: its pole at each, `None` where it is left of the line up to which poles are found.
pub type BranchOverSpeed = Vec<Option<C64>>;

/// A machine whose speed is looked over.
struct Over<'a> {
    plant: Plant,
    settings: &'a Settings,
    nearest: f64,
}

/// The roots at one speed.
#[derive(Clone)]
struct Node {
    speed: f64,
    roots: Vec<Root>,
}

impl Over<'_> {
    fn at(&self, speed: f64) -> Result<Node, PolesError> {
        let form = LinearForm::of(&self.plant, &self.settings.feedback, &OperatingPoint::at(speed))?;
        Ok(Node { speed, roots: Characteristic::of(&form)?.roots()? })
    }

    /// For every root of `a`, which of `b` it becomes, `None` if it goes out of sight; speeds between are looked at as needed.
    fn follow(&self, a: &Node, b: &Node) -> Result<Vec<Option<usize>>, PolesError> {
        let (matched, sure) = matches(&a.roots, &b.roots);
        if sure || b.speed - a.speed <= self.nearest {
            return Ok(matched);
        }
        let middle = self.at(0.5 * (a.speed + b.speed))?;
        let (first, second) = (self.follow(a, &middle)?, self.follow(&middle, b)?);
        Ok(first.into_iter().map(|to| to.and_then(|k| second[k])).collect())
    }

    /// Reports every sure stretch between `a` and `b` with its matches, from left to right.
    fn walk(
        &self,
        a: &Node,
        b: &Node,
        see: &mut impl FnMut(&Node, &Node, &[Option<usize>]) -> Result<(), PolesError>,
    ) -> Result<(), PolesError> {
        let (matched, sure) = matches(&a.roots, &b.roots);
        if sure || b.speed - a.speed <= self.nearest {
            return see(a, b, &matched);
        }
        let middle = self.at(0.5 * (a.speed + b.speed))?;
        self.walk(a, &middle, see)?;
        self.walk(&middle, b, see)
    }

    /// Where the root that is `start` at `a` and `end` at `b` has no real part.
    fn crossing(&self, a: &Node, b: &Node, start: Root, end: Root) -> Result<(f64, Root), PolesError> {
        let (mut low, mut high) = ((a.speed, start), (b.speed, end));
        for _ in 0..HALVINGS {
            let speed = 0.5 * (low.0 + high.0);
            if speed <= low.0 || speed >= high.0 {
                break;
            }
            let expected = (low.1.root + high.1.root) * 0.5;
            let node = self.at(speed)?;
            let Some(here) = node
                .roots
                .into_iter()
                .min_by(|x, y| (x.root - expected).norm_sqr().total_cmp(&(y.root - expected).norm_sqr()))
            else {
                break;
            };
            if (here.pole.re > 0.0) == (low.1.pole.re > 0.0) { low = (speed, here) } else { high = (speed, here) }
        }
        Ok((0.5 * (low.0 + high.0), high.1))
    }
}

/// Pairs roots by nearness, and whether every pair is beyond doubt.
fn matches(a: &[Root], b: &[Root]) -> (Vec<Option<usize>>, bool) {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::with_capacity(a.len() * b.len());
    for (i, from) in a.iter().enumerate() {
        pairs.extend(b.iter().enumerate().map(|(k, to)| ((from.root - to.root).norm(), i, k)));
    }
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    let (mut to, mut taken) = (vec![None; a.len()], vec![false; b.len()]);
    let mut sure = a.len() == b.len();
    for &(apart, i, k) in &pairs {
        if to[i].is_some() || taken[k] {
            continue;
        }
        (to[i], taken[k]) = (Some(k), true);
        // How near any other comes to either of the two.
        let rival = pairs.iter().find(|(_, x, y)| (*x == i) != (*y == k)).map_or(f64::INFINITY, |(apart, ..)| *apart);
        sure &= apart * BEYOND_DOUBT <= rival;
    }
    (to, sure)
}

fn over<'a>(rotor: &Rotor, settings: &'a Settings, from: f64, to: f64) -> Over<'a> {
    Over { plant: Plant::of(rotor), settings, nearest: NEAREST * (to - from) }
}

/// Every pole of `rotor` under `settings` as a branch over `speeds`, which rise.
///
/// # Errors
/// A loop that does not fit, or poles that cannot be had.
pub fn trace(rotor: &Rotor, settings: &Settings, speeds: &[f64]) -> Result<Vec<BranchOverSpeed>, PolesError> {
    let (Some(first), Some(last)) = (speeds.first(), speeds.last()) else { return Ok(vec![]) };
    let over = over(rotor, settings, *first, *last);
    let mut node = over.at(*first)?;
    let mut branches: Vec<BranchOverSpeed> = node.roots.iter().map(|root| vec![Some(root.pole)]).collect();
    // Which branch each root of `node` belongs to.
    let mut owner: Vec<usize> = (0..branches.len()).collect();
    for (at, speed) in speeds.iter().enumerate().skip(1) {
        let next = over.at(*speed)?;
        let to = over.follow(&node, &next)?;
        let mut owners = vec![usize::MAX; next.roots.len()];
        to.iter().zip(&owner).filter_map(|(to, owner)| Some(((*to)?, *owner))).for_each(|(k, owner)| owners[k] = owner);
        for owner in owners.iter_mut().filter(|owner| **owner == usize::MAX) {
            *owner = branches.len();
            branches.push(vec![None; at]);
        }
        branches.iter_mut().for_each(|branch| branch.push(None));
        next.roots.iter().zip(&owners).for_each(|(root, owner)| branches[*owner][at] = Some(root.pole));
        (node, owner) = (next, owners);
    }
    Ok(branches)
}

/// Every change of stability of `rotor` under `settings` over `from..=to`, rising in speed.
///
/// # Errors
/// A loop that does not fit, or poles that cannot be had.
pub fn thresholds(rotor: &Rotor, settings: &Settings, from: f64, to: f64) -> Result<Vec<Threshold>, PolesError> {
    let over = over(rotor, settings, from, to);
    let mut found = Vec::new();
    let mut node = over.at(from)?;
    for stretch in 1..=STRETCHES {
        let next = over.at(from + (to - from) * stretch as f64 / STRETCHES as f64)?;
        over.walk(&node, &next, &mut |a, b, matched| {
            for (start, end) in a.roots.iter().zip(matched).filter_map(|(root, k)| Some((*root, b.roots[(*k)?]))) {
                let rises = end.pole.re > start.pole.re;
                let crosses = (start.pole.re > 0.0) != (end.pole.re > 0.0) && start.pole.re != end.pole.re;
                if crosses {
                    let (speed, root) = over.crossing(a, b, start, end)?;
                    found.push(Threshold {
                        speed,
                        frequency: root.pole.im.abs(),
                        whirl: if root.pole.im >= 0.0 { Whirl::Forward } else { Whirl::Backward },
                        becomes: if rises { Stability::Unstable } else { Stability::Stable },
                    });
                }
            }
            Ok(())
        })?;
        node = next;
    }
    found.sort_by(|a, b| a.speed.total_cmp(&b.speed));
    Ok(found)
}
