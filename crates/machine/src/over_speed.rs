//! Poles of any machine over speed: which is which from one speed to the next, and where one crosses the limit of stability.
//!
//! An ideal loop has ways of its own in crate `rotor`, with certificates. This is for all others: roots are matched by
//! nearness, with as many speeds in between as it takes for every match to be beyond doubt. Roots of a sampled loop are
//! matched as `z`, which does not jump where a frequency passes half the sampling rate.

use rotor::{
    C64, Characteristic, CharacteristicRoot, CriticalSpeed, LinearForm, OperatingPoint, Plant, Rotor, Settings,
    Stability, Threshold, Whirl,
};

use crate::poles::PolesError;

/// A match is beyond doubt if the next root is so many times as far.
const BEYOND_DOUBT: f64 = 3.0;
/// Roots nearer than this part of their size coincide but for rounding, a multiple one's being the cube root of the last place.
const COINCIDENT: f64 = 1e-5;
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
    roots: Vec<CharacteristicRoot>,
}

impl Over<'_> {
    fn at(&self, speed: f64) -> Result<Node, PolesError> {
        let form = LinearForm::of(&self.plant, &self.settings.feedback, &OperatingPoint::at(speed))?;
        Ok(Node { speed, roots: Characteristic::of(&form)?.roots()? })
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

    /// Where `value` of the root that is `start` at `a` and `end` at `b` changes sign.
    fn crossing(
        &self,
        a: &Node,
        b: &Node,
        [start, end]: [CharacteristicRoot; 2],
        value: impl Fn(f64, C64) -> f64,
    ) -> Result<(f64, CharacteristicRoot), PolesError> {
        let (mut low, mut high) = ((a.speed, start), (b.speed, end));
        let (mut at_low, mut at_high) = (value(low.0, start.pole), value(high.0, end.pole));
        let whole = high.0 - low.0;
        let mut most = 0.5 * whole;
        for _ in 0..HALVINGS {
            let (middle, half) = (0.5 * (low.0 + high.0), 0.5 * (high.0 - low.0));
            if middle <= low.0 || middle >= high.0 {
                break;
            }
            // Where the chord meets zero, a little nearer to the middle so that either end moves, and never so far from it that halving
            // would have been ahead (ITP; Oliveira and Takahashi, 2020): the speed of the secant with the certainty of halving.
            let chord = (low.0 * at_high - high.0 * at_low) / (at_high - at_low);
            let aside = middle - chord;
            let nearer = chord + aside.signum() * aside.abs().min(0.2 / whole * (2.0 * half).powi(2));
            most *= 0.5;
            let room = (4.0 * most - half).max(0.0);
            let speed = middle + (nearer - middle).clamp(-room, room);
            let speed = if speed.is_finite() && low.0 < speed && speed < high.0 { speed } else { middle };
            let part = (speed - low.0) / (high.0 - low.0);
            let expected = low.1.root * (1.0 - part) + high.1.root * part;
            let node = self.at(speed)?;
            let Some(here) = node
                .roots
                .into_iter()
                .min_by(|x, y| (x.root - expected).norm_sqr().total_cmp(&(y.root - expected).norm_sqr()))
            else {
                break;
            };
            let at_here = value(speed, here.pole);
            if (at_here > 0.0) == (at_low > 0.0) {
                (low, at_low) = ((speed, here), at_here);
            } else {
                (high, at_high) = ((speed, here), at_here);
            }
        }
        Ok((0.5 * (low.0 + high.0), high.1))
    }
}

/// Pairs roots by nearness, and whether every pair is beyond doubt.
fn matches(a: &[CharacteristicRoot], b: &[CharacteristicRoot]) -> (Vec<Option<usize>>, bool) {
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
        // How near any other comes to either of the two. Those that coincide with one of them, as the poles of equal sensors do, may
        // change places with it.
        let same = |p: &CharacteristicRoot, q: &CharacteristicRoot| {
            (p.root - q.root).norm() <= COINCIDENT * p.root.norm().max(q.root.norm())
        };
        let is_rival = |x: usize, y: usize| match (x == i, y == k) {
            (true, false) => !same(&b[y], &b[k]),
            (false, true) => !same(&a[x], &a[i]),
            _ => false,
        };
        let rival = pairs.iter().find(|(_, x, y)| is_rival(*x, *y)).map_or(f64::INFINITY, |(apart, ..)| *apart);
        sure &= apart * BEYOND_DOUBT <= rival;
    }
    (to, sure)
}

fn over<'a>(rotor: &Rotor, settings: &'a Settings, from: f64, to: f64) -> Over<'a> {
    Over { plant: Plant::of(rotor), settings, nearest: NEAREST * (to - from) }
}

/// Poles over speed, and where they meet lines of the Campbell diagram.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Campbell {
    /// Every pole as a branch.
    pub branches: Vec<BranchOverSpeed>,
    /// Where `|Im|` of a branch is a multiple of the speed, by order and rising speed.
    pub critical_speeds: Vec<CriticalSpeed>,
}

/// Every pole of `rotor` under `settings` as a branch over `speeds`, which rise.
///
/// # Errors
/// A loop that does not fit, or poles that cannot be had.
pub fn trace(rotor: &Rotor, settings: &Settings, speeds: &[f64]) -> Result<Vec<BranchOverSpeed>, PolesError> {
    Ok(campbell(rotor, settings, speeds, &[])?.branches)
}

/// The same, with critical speeds: where `|Im|` of a branch is `order` times the speed, for each of `orders`. A branch that
/// crosses a line and comes back between two neighbours of `speeds` is not seen to.
///
/// # Errors
/// A loop that does not fit, or poles that cannot be had.
pub fn campbell(rotor: &Rotor, settings: &Settings, speeds: &[f64], orders: &[f64]) -> Result<Campbell, PolesError> {
    let (Some(first), Some(last)) = (speeds.first(), speeds.last()) else { return Ok(Campbell::default()) };
    let over = over(rotor, settings, *first, *last);
    let mut node = over.at(*first)?;
    let mut branches: Vec<BranchOverSpeed> = node.roots.iter().map(|root| vec![Some(root.pole)]).collect();
    let mut critical = Vec::new();
    // Which branch each root of the node that the walk is at belongs to.
    let mut owner: Vec<usize> = (0..branches.len()).collect();
    for (at, speed) in speeds.iter().enumerate().skip(1) {
        let next = over.at(*speed)?;
        branches.iter_mut().for_each(|branch| branch.push(None));
        over.walk(&node, &next, &mut |a, b, to| {
            let mut owners = vec![usize::MAX; b.roots.len()];
            for (i, k) in to.iter().enumerate().filter_map(|(i, k)| Some((i, (*k)?))) {
                owners[k] = owner[i];
                critical.extend(over.on_lines(a, b, [a.roots[i], b.roots[k]], owner[i], orders)?);
            }
            for owner in owners.iter_mut().filter(|owner| **owner == usize::MAX) {
                *owner = branches.len();
                branches.push(vec![None; at + 1]);
            }
            owner = owners;
            Ok(())
        })?;
        next.roots.iter().zip(&owner).for_each(|(root, owner)| branches[*owner][at] = Some(root.pole));
        node = next;
    }
    // What came and went between two speeds is on none of them.
    let seen: Vec<usize> = (0..branches.len()).filter(|k| branches[*k].iter().any(Option::is_some)).collect();
    critical.retain_mut(|c: &mut CriticalSpeed| seen.binary_search(&c.branch).map(|place| c.branch = place).is_ok());
    let branches = seen.into_iter().map(|k| std::mem::take(&mut branches[k])).collect();
    let place = |c: &CriticalSpeed| orders.iter().position(|order| *order == c.order);
    critical.sort_by(|a, b| place(a).cmp(&place(b)).then(a.speed.total_cmp(&b.speed)));
    Ok(Campbell { branches, critical_speeds: critical })
}

impl Over<'_> {
    /// Where the branch that is `ends` at `a` and `b` meets lines of the Campbell diagram between them.
    fn on_lines(
        &self,
        a: &Node,
        b: &Node,
        ends: [CharacteristicRoot; 2],
        branch: usize,
        orders: &[f64],
    ) -> Result<Vec<CriticalSpeed>, PolesError> {
        let mut met = Vec::new();
        for &order in orders {
            let beyond = |speed: f64, pole: C64| pole.im.abs() - order * speed;
            if (beyond(a.speed, ends[0].pole) > 0.0) == (beyond(b.speed, ends[1].pole) > 0.0) {
                continue;
            }
            let (speed, root) = self.crossing(a, b, ends, beyond)?;
            let pole = root.pole;
            // What does not whirl meets a line at rest only, where nothing is synchronous.
            if pole.im.abs() > 1e-9 * (1.0 + pole.norm()) {
                met.push(CriticalSpeed { branch, order, speed, pole, whirl: whirl_of(pole) });
            }
        }
        Ok(met)
    }
}

fn whirl_of(pole: C64) -> Whirl {
    if pole.im >= 0.0 { Whirl::Forward } else { Whirl::Backward }
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
                    let (speed, root) = over.crossing(a, b, [start, end], |_, pole| pole.re)?;
                    found.push(Threshold {
                        speed,
                        frequency: root.pole.im.abs(),
                        whirl: whirl_of(root.pole),
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
