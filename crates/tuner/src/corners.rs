//! Frequencies of filters that are searched beside the gains: which there are, and what a loop changes by with each.
//!
//! A corner is positive and may span decades, so its variable is its logarithm, counted from the middle of its range: `v` stands for
//! `sqrt(from to) e^v`. Corners are the same at every speed.
//!
//! A filter that moves, `F`, is a factor of what the gains behind it answer. So a loop has, with `G_k` the answer of gain `k` without
//! the filters that move,
//!
//! ```text
//! L = sum_k w_k G_k,   w_k = g_k prod_f F_f,   dw_k / dg_k = prod_f F_f,   dw_k / dv = g_k (dF / dv) prod_(others) F
//! ```
//!
//! and a pole, which knows a filter only by its value there, moves by `d ln F / dv` times `sum_k g_k ds / dg_k`.

use std::borrow::Cow;
use std::ops::Range;

use control::Corners;
use rotor::{C64, Feedback, Filter};
use units::Dimension;

use crate::Structure;

/// By default a corner may move so many times up and down.
const FAR: f64 = 4.0;

/// A frequency of a filter that may be searched, and between what.
#[derive(Clone, Debug, PartialEq)]
pub struct Corner {
    /// What it is called: `filter.1.corner` of a filter of the bearing, `signal.2.filter.1.zero` of one of a signal; where there are
    /// several bearings that of its own first, `left.filter.1.corner`. Everything is counted from 1.
    pub name: String,
    /// What it is in the template, in radians per `tau`.
    pub own: f64,
    /// The least that it may be; above 0.
    pub from: f64,
    /// The most; above the least.
    pub to: f64,
    /// What it measures: a frequency, or a rate.
    pub dimension: Dimension,
    filter: Place,
    /// Which of the numbers of its filter.
    number: usize,
}

/// Where a filter stands: its bearing, of a signal that, and its place in the row. Later ones are taken out first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    bearing: usize,
    signal: Option<usize>,
    filter: usize,
}

impl Place {
    fn row(self, feedback: &mut Feedback) -> &mut Vec<Filter> {
        let bearing = &mut feedback.bearings[self.bearing];
        match self.signal {
            Some(signal) => &mut bearing.signals[signal].filters,
            None => &mut bearing.filters,
        }
    }
}

impl Corner {
    /// Every one that the filters of `feedback` have, a fourth to four times what it is, bearing by bearing, those of signals first.
    #[must_use]
    pub fn all(feedback: &Feedback) -> Vec<Self> {
        let mut made = Vec::new();
        for (b, bearing) in feedback.bearings.iter().enumerate() {
            let label = if feedback.bearings.len() > 1 { format!("{}.", feedback.label(b)) } else { String::new() };
            let of_signals = bearing.signals.iter().enumerate().map(|(k, signal)| (Some(k), &signal.filters));
            for (signal, row) in of_signals.chain([(None, &bearing.filters)]) {
                let of = signal.map_or_else(String::new, |k| format!("signal.{}.", k + 1));
                for (filter, own) in row.iter().enumerate() {
                    let corners = Corners::of(own);
                    let each = corners.names().into_iter().zip(corners.values()).enumerate();
                    made.extend(each.map(|(number, (name, own))| Self {
                        name: format!("{label}{of}filter.{}.{name}", filter + 1),
                        own,
                        from: own / FAR,
                        to: own * FAR,
                        dimension: corners.dimension(),
                        filter: Place { bearing: b, signal, filter },
                        number,
                    }));
                }
            }
        }
        made
    }

    /// The same between these.
    #[must_use]
    pub fn within(self, from: f64, to: f64) -> Self {
        Self { from, to, ..self }
    }

    /// Whether it has room to move.
    pub(crate) fn is_sound(&self) -> bool {
        self.from > 0.0 && self.from < self.to && self.to.is_finite()
    }

    /// How far its variable may go either way.
    fn reach(&self) -> f64 {
        0.5 * (self.to / self.from).ln()
    }

    fn middle(&self) -> f64 {
        self.from.sqrt() * self.to.sqrt()
    }

    fn value(&self, variable: f64) -> f64 {
        match self.reach() {
            // An end of the range is that end, to the last bit.
            reach if variable >= reach => self.to,
            reach if variable <= -reach => self.from,
            _ => (self.middle() * variable.exp()).clamp(self.from, self.to),
        }
    }

    fn variable(&self, value: f64) -> f64 {
        (value.clamp(self.from, self.to) / self.middle()).ln().clamp(-self.reach(), self.reach())
    }
}

/// A filter with a corner that moves.
#[derive(Clone, Debug, PartialEq)]
struct Moving {
    at: Place,
    form: Corners,
    own: Vec<f64>,
    /// Which of its numbers is which corner.
    moved: Vec<(usize, usize)>,
    /// The gains in front of it.
    gains: Range<usize>,
}

/// The corners that are searched.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Searched {
    corners: Vec<Corner>,
    filters: Vec<Moving>,
}

impl Searched {
    /// `corners` of the filters of `template`.
    pub(crate) fn new(template: &Feedback, corners: Vec<Corner>) -> Self {
        let mut filters: Vec<Moving> = Vec::new();
        for (k, corner) in corners.iter().enumerate() {
            let known = filters.iter().position(|moving| moving.at == corner.filter);
            let at = known.unwrap_or_else(|| {
                filters.push(Moving::of(template, corner.filter));
                filters.len() - 1
            });
            filters[at].moved.push((corner.number, k));
        }
        Self { corners, filters }
    }

    /// How far each variable may go either way.
    fn reach(&self) -> impl Iterator<Item = f64> + '_ {
        self.corners.iter().map(Corner::reach)
    }

    /// Every number of every filter that moves.
    fn values(&self, variables: &[f64]) -> Vec<Vec<f64>> {
        let of = |moving: &Moving| {
            let mut values = moving.own.clone();
            moving.moved.iter().for_each(|(number, k)| values[*number] = self.corners[*k].value(variables[*k]));
            values
        };
        self.filters.iter().map(of).collect()
    }
}

impl Moving {
    fn of(template: &Feedback, at: Place) -> Self {
        let form = Corners::of(&at.row(&mut template.clone())[at.filter]);
        let before: usize = template.bearings[..at.bearing].iter().map(|bearing| bearing.signals.len()).sum();
        let signals = match at.signal {
            Some(signal) => before + signal..before + signal + 1,
            None => before..before + template.bearings[at.bearing].signals.len(),
        };
        Self { at, own: form.values(), form, moved: Vec::new(), gains: 4 * signals.start..4 * signals.end }
    }
}

impl Structure {
    /// The same with these corners of its filters searched too, out of [`Corner::all`] of its template.
    #[must_use]
    pub fn with_corners(mut self, corners: Vec<Corner>) -> Self {
        self.searched = Searched::new(&self.template, corners);
        self
    }

    /// The corners that are searched.
    #[must_use]
    pub fn corners(&self) -> &[Corner] {
        &self.searched.corners
    }

    /// What they are with the variables `variables`, in radians per `tau`.
    #[must_use]
    pub fn corner_values(&self, variables: &[f64]) -> Vec<f64> {
        let own = &variables[self.gain_variables()..];
        self.corners().iter().zip(own).map(|(corner, variable)| corner.value(*variable)).collect()
    }

    /// The variables that corners have in the template, or are nearest to it.
    pub(crate) fn own_corners(&self) -> impl Iterator<Item = f64> + '_ {
        self.corners().iter().map(|corner| corner.variable(corner.own))
    }

    /// The same in `feedback`.
    pub(crate) fn corners_in(&self, feedback: &Feedback) -> Vec<f64> {
        let known = Corner::all(feedback);
        let own = |corner: &Corner| {
            let same = known.iter().find(|other| (other.filter, other.number) == (corner.filter, corner.number));
            corner.variable(same.map_or(corner.own, |other| other.own))
        };
        self.corners().iter().map(own).collect()
    }

    /// The largest magnitude of each variable where that of gains is `bound`.
    #[must_use]
    pub fn reach(&self, bound: f64) -> Vec<f64> {
        std::iter::repeat_n(bound, self.gain_variables()).chain(self.searched.reach()).collect()
    }

    /// Puts the filters that move where `variables` has them.
    pub(crate) fn put_filters(&self, variables: &[f64], feedback: &mut Feedback) {
        let values = self.searched.values(&variables[self.gain_variables()..]);
        for (moving, values) in self.searched.filters.iter().zip(values) {
            moving.at.row(feedback)[moving.at.filter] = moving.form.filter(&values);
        }
    }

    /// Takes them out.
    pub(crate) fn take_filters(&self, feedback: &mut Feedback) {
        let mut places: Vec<Place> = self.searched.filters.iter().map(|moving| moving.at).collect();
        places.sort_unstable();
        for place in places.into_iter().rev() {
            place.row(feedback).remove(place.filter);
        }
    }
}

/// The law at one speed with some variables: what the answer of every gain, the filters that move taken out, is multiplied by.
#[derive(Debug)]
pub(crate) struct Weights<'s> {
    searched: &'s Searched,
    speed: f64,
    period: f64,
    pub(crate) gains: Vec<f64>,
    plain: Vec<C64>,
    /// Numbers of the filters that move.
    values: Vec<Vec<f64>>,
}

impl<'s> Weights<'s> {
    pub(crate) fn of(structure: &'s Structure, variables: &[f64], speed: f64) -> Self {
        let gains = structure.gains_at(variables, speed);
        Self {
            searched: &structure.searched,
            speed,
            period: structure.period(),
            plain: gains.iter().map(|gain| C64::from(*gain)).collect(),
            gains,
            values: structure.searched.values(&variables[structure.gain_variables()..]),
        }
    }

    /// What the filters that move answer at `s`.
    fn responses(&self, s: C64) -> Vec<C64> {
        let each = self.searched.filters.iter().zip(&self.values);
        each.map(|(moving, values)| moving.form.response(values, s, self.speed, self.period)).collect()
    }

    /// `w_k` at `s`.
    pub(crate) fn at(&self, s: C64) -> Cow<'_, [C64]> {
        if self.searched.filters.is_empty() {
            return Cow::Borrowed(&self.plain);
        }
        let mut weights = self.plain.clone();
        for (moving, response) in self.searched.filters.iter().zip(self.responses(s)) {
            weights[moving.gains.clone()].iter_mut().for_each(|weight| *weight *= response);
        }
        Cow::Owned(weights)
    }

    /// Slopes at `s` in each gain and then in each corner, from those in each weight.
    pub(crate) fn chain(&self, s: C64, by_weight: &[C64]) -> Vec<C64> {
        let filters = &self.searched.filters;
        let responses = self.responses(s);
        // What stands behind gain k, but for filter `but`.
        let behind = |k: usize, but: Option<usize>| -> C64 {
            let each = filters.iter().zip(&responses).enumerate();
            each.filter(|(f, (moving, _))| moving.gains.contains(&k) && Some(*f) != but).map(|(_, (_, r))| r).product()
        };
        let mut made: Vec<C64> = by_weight.iter().enumerate().map(|(k, by)| by * behind(k, None)).collect();
        let first = made.len();
        made.resize(first + self.searched.corners.len(), C64::ZERO);
        for (f, (moving, values)) in filters.iter().zip(&self.values).enumerate() {
            let before: C64 = moving.gains.clone().map(|k| by_weight[k] * self.gains[k] * behind(k, Some(f))).sum();
            let slopes = moving.form.slopes(values, s, self.speed, self.period);
            moving.moved.iter().for_each(|(number, corner)| made[first + corner] = before * slopes[*number]);
        }
        made
    }

    /// What a pole moves by with each corner, from what it moves by with each gain.
    pub(crate) fn follow(&self, pole: C64, by_gain: &[C64]) -> Vec<C64> {
        let mut made = vec![C64::ZERO; self.searched.corners.len()];
        for (moving, values) in self.searched.filters.iter().zip(&self.values) {
            let through: C64 = moving.gains.clone().map(|k| by_gain[k] * self.gains[k]).sum();
            let response = moving.form.response(values, pole, self.speed, self.period);
            let slopes = moving.form.slopes(values, pole, self.speed, self.period);
            for (number, corner) in &moving.moved {
                let moved = through * (slopes[*number] / response);
                // A pole of a filter that no gain drives, or a root that its zero hides: no part of the machine's motion.
                made[*corner] = if moved.is_finite() { moved } else { C64::ZERO };
            }
        }
        made
    }
}
