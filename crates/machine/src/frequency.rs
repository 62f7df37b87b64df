//! Frequency responses of a machine at one speed, and its response to unbalance over speed: as many points as it takes for
//! the curve between them to be known.

use linear::peak::top;
use linear::{DelaySystem, LoopGain};
use nalgebra::{DMatrix, DVector};
use rotor::{C64, Characteristic, Direction, LinearForm, OperatingPoint, Plant, Rotor, Settings, Station};

use crate::forced::forced_response;
use crate::margins::{MachineLoop, MarginsError};

/// How far off the straight line between two points the middle may be, relative to its size.
const OFF: f64 = 0.005;
/// What is smaller than this part of the largest is not made finer: rounding has no curve.
const FAINT: f64 = 1e-6;
/// Decades below the end of a band in which there are points in any case.
const LOW_DECADES: i32 = 3;
/// The most halvings of a stretch.
const DEPTH: usize = 24;
/// Stretches that a range of speeds begins with.
const STRETCHES: usize = 32;

/// What is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransferFunction {
    /// The gain `L` of the loop, opened at the control bearing's command.
    Loop,
    /// `1 / (1 + L)`.
    Sensitivity,
    /// `L / (1 + L)`.
    Closed,
    /// Displacement at a station, counted from 0, per force at the control bearing beside that of the closed loop.
    Station(usize),
}

/// One frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyPoint {
    /// In radians per `tau`; negative for backward whirl.
    pub frequency: f64,
    /// The response.
    pub value: C64,
}

impl MachineLoop {
    /// A band of frequencies with everything in it that is lightly damped, and the crossings of its gain.
    #[must_use]
    pub fn band(&self) -> [f64; 2] {
        let n = self.form().coordinates;
        let plant = self.form().a.view((0, 0), (2 * n, 2 * n)).into_owned();
        let poles = rotor::eigenvalues(plant).unwrap_or_default();
        let far = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        let end = (4.0 * far).clamp(f64::MIN_POSITIVE, self.gain.beyond(1e-3));
        [-end, end]
    }

    /// The response over a band, with a point at every maximum of its amplitude; `None` of a station through a sampled loop,
    /// where a pure whirl does not stay one, and of a station that does not exist.
    ///
    /// # Errors
    /// Eigenvalues that cannot be had.
    pub fn response(
        &self,
        of: TransferFunction,
        [from, to]: [f64; 2],
    ) -> Result<Option<Vec<FrequencyPoint>>, MarginsError> {
        // Low frequencies too, for whoever looks at decades.
        let end = from.abs().max(to.abs());
        let low = (0..=4 * LOW_DECADES).map(|k| end * 10.0_f64.powf(-0.25 * f64::from(k)));
        let also: Vec<f64> = low.flat_map(|w| [w, -w]).chain([0.0]).collect();
        let mut at: Vec<f64> = self.gain.curve(from, to, &also).iter().map(|p| p.frequency).collect();
        let reach = match of {
            TransferFunction::Station(station) => match self.reach(station)? {
                Some(reach) => Some(reach),
                None => return Ok(None),
            },
            _ => None,
        };
        if reach.is_some() {
            let about = self.resonances()?.into_iter().flat_map(|pole| {
                [0.0, 0.3, 1.0, 3.0].into_iter().flat_map(move |n| [pole.im - n * pole.re, pole.im + n * pole.re])
            });
            at.extend(about.filter(|w| (from..=to).contains(w)));
            at.sort_by(f64::total_cmp);
            at.dedup();
        }
        let value = |frequency: f64| {
            let gain = self.gain.at(frequency);
            let value = match of {
                TransferFunction::Loop => gain.value,
                TransferFunction::Sensitivity => gain.sensitivity(),
                TransferFunction::Closed => gain.complementary(),
                TransferFunction::Station(_) => reach.as_ref().map_or(C64::ZERO, |reach| reach.at(frequency)),
            };
            FrequencyPoint { frequency, value }
        };
        let known: Vec<FrequencyPoint> = at.into_iter().map(value).collect();
        let sizes = known.iter().map(|p| p.value.norm()).filter(|size| size.is_finite());
        let floor = FAINT * sizes.fold(0.0, f64::max);
        let mut points: Vec<FrequencyPoint> = Vec::with_capacity(4 * known.len());
        for next in known {
            // What lies between the two next to an integrator's pole is rounding of infinities.
            let across = 1.5 * self.gain.quiet();
            let is_across = |last: &FrequencyPoint| last.frequency.abs().max(next.frequency.abs()) <= across;
            if let Some(last) = points.last().copied().filter(|last| !is_across(last)) {
                straighten(&value, last, next, (DEPTH, floor), &mut points);
            }
            points.push(next);
        }
        let size = |w: f64| value(w).value.norm_sqr();
        let tops: Vec<FrequencyPoint> = (points.windows(3))
            .filter(|p| {
                let [a, b, c] = [0, 1, 2].map(|k| p[k].value.norm_sqr());
                b > a && b >= c
            })
            .map(|p| value(top(p[0].frequency, p[2].frequency, size)))
            .collect();
        points.extend(tops);
        points.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        points.dedup_by(|a, b| a.frequency == b.frequency);
        Ok(Some(points))
    }

    /// Displacement at a station per force at the control bearing, every loop closed; `None` of a station that does not exist, and of a
    /// sampled loop.
    fn reach(&self, station: usize) -> Result<Option<Reach>, MarginsError> {
        let (n, plant) = (self.form().coordinates, self.plant());
        let (Some(row), Some(column)) = (plant.stations().get(station), plant.column(self.station())) else {
            return Ok(None);
        };
        let mut force = DVector::zeros(self.form().a.nrows());
        force.rows_mut(n, n).copy_from(&column.dense(n));
        self.reaching(&row.row, &force)
    }

    /// Poles of the closed loop, about which its responses change; with a delay those that are no echoes of it.
    fn resonances(&self) -> Result<Vec<C64>, MarginsError> {
        Ok(Characteristic::of(self.form())?.roots()?.iter().map(|root| root.pole).collect())
    }

    /// What a push on the states, a column, does to a row of the displacements, every loop closed; `None` of a sampled loop.
    pub(crate) fn reaching(&self, row: &Direction, push: &DVector<C64>) -> Result<Option<Reach>, MarginsError> {
        let form = self.form();
        let Some([a, b, c]) = form.continuous() else { return Ok(None) };
        let (n, loops) = (form.coordinates, b.ncols());
        let b = b.insert_column(loops, C64::ZERO);
        let c = c.insert_row(loops, C64::ZERO);
        let (mut b, mut c) = (b, c);
        b.view_mut((0, loops), (push.len(), 1)).copy_from(push);
        c.view_mut((loops, 0), (1, n)).copy_from(&row.dense(n).transpose());
        let mut each = LoopGain::each(&DelaySystem::new(a, b, c, form.delay)?)?;
        Ok(Some(Reach { joined: each.remove(loops), delay: form.delay }))
    }
}

/// What a push does to a displacement, through a machine whose loops are closed.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    /// The loops, and the push and the displacement as if they were one more.
    joined: LoopGain,
    delay: f64,
}

impl Reach {
    /// `p + q S r`: directly, and by way of the commands.
    pub(crate) fn at(&self, frequency: f64) -> C64 {
        let gains = self.joined.matrix(frequency).gain;
        let loops = gains.nrows() - 1;
        let late = (-C64::new(0.0, frequency) * self.delay).exp();
        let commands = DMatrix::identity(loops, loops) + gains.view((0, 0), (loops, loops));
        let Some(s) = commands.try_inverse() else { return C64::new(f64::NAN, f64::NAN) };
        // What is pushed and what is read is not late; signs of gains are turned.
        let (pushed, read) = (gains.view((0, loops), (loops, 1)), gains.view((loops, 0), (1, loops)));
        (gains[(loops, loops)] * -1.0 + (read * s * pushed)[0]) / late
    }
}

/// Points between two, until the middle of each stretch is on the line.
fn straighten(
    value: &impl Fn(f64) -> FrequencyPoint,
    a: FrequencyPoint,
    b: FrequencyPoint,
    (depth, floor): (usize, f64),
    points: &mut Vec<FrequencyPoint>,
) {
    let middle = value(0.5 * (a.frequency + b.frequency));
    let apart = (middle.value - (a.value + b.value) * 0.5).norm();
    if depth > 0 && apart > OFF * middle.value.norm() + floor {
        straighten(value, a, middle, (depth - 1, floor), points);
        points.push(middle);
        straighten(value, middle, b, (depth - 1, floor), points);
    }
}

/// The response to unbalance at one speed.
#[derive(Clone, Debug, PartialEq)]
pub struct UnbalancePoint {
    /// The speed.
    pub speed: f64,
    /// Displacement of every station over `exp(j theta)`, in `e_t`.
    pub stations: Vec<C64>,
}

/// A speed at which a station's response to unbalance is largest among its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnbalancePeak {
    /// The station, counted from 0.
    pub station: usize,
    /// The speed.
    pub speed: f64,
    /// The amplitude there, in `e_t`.
    pub amplitude: f64,
}

/// The response to unbalance over speed.
#[derive(Clone, Debug, PartialEq)]
pub struct UnbalanceResponse {
    /// The curve, speeds rising.
    pub points: Vec<UnbalancePoint>,
    /// Where a station peaks.
    pub peaks: Vec<UnbalancePeak>,
}

/// The linear response of `rotor` under `settings` to its unbalance over `from..=to`, every bearing at its full stiffness, and
/// the speeds at which a station peaks; `None` of a sampled loop.
///
/// # Errors
/// A loop that does not fit.
pub fn unbalance_response(
    rotor: &Rotor,
    settings: &Settings,
    [from, to]: [f64; 2],
) -> Result<Option<UnbalanceResponse>, MarginsError> {
    let plant = Plant::of(rotor);
    if settings.feedback.sample() > 0.0 {
        return Ok(None);
    }
    let at = |speed: f64| -> Result<UnbalancePoint, MarginsError> {
        let form = LinearForm::of(&plant, &settings.feedback, &OperatingPoint::at(speed))?;
        let drive = DMatrix::from_fn(form.coordinates, 1, |k, _| plant.unbalance()[k] * speed * speed);
        let moved = forced_response(&form, speed, &drive);
        let moved = moved.unwrap_or_else(|| DMatrix::from_element(drive.nrows(), 1, C64::new(f64::NAN, f64::NAN)));
        let read = |station: &Station| station.row.read(moved.as_slice());
        Ok(UnbalancePoint { speed, stations: plant.stations().iter().map(read).collect() })
    };
    let mut points = vec![at(from)?];
    for k in 1..=STRETCHES {
        let next = at(from + (to - from) * k as f64 / STRETCHES as f64)?;
        let last = points.last().cloned().unwrap_or_else(|| next.clone());
        fill(&at, &last, &next, DEPTH, &mut points)?;
        points.push(next);
    }
    let mut peaks = Vec::new();
    for station in 0..plant.stations().len() {
        let size = |point: &UnbalancePoint| point.stations[station].norm();
        for three in points.windows(3) {
            if !(size(&three[1]) > size(&three[0]) && size(&three[1]) >= size(&three[2])) {
                continue;
            }
            // What fits at its neighbours fits here.
            let amplitude = |speed: f64| at(speed).map_or(f64::NAN, |point| size(&point));
            let top = at(top(three[0].speed, three[2].speed, amplitude))?;
            peaks.push(UnbalancePeak { station, speed: top.speed, amplitude: size(&top) });
        }
    }
    Ok(Some(UnbalanceResponse { points, peaks }))
}

/// Points between two, until the middle of each stretch is on the line.
fn fill(
    at: &impl Fn(f64) -> Result<UnbalancePoint, MarginsError>,
    a: &UnbalancePoint,
    b: &UnbalancePoint,
    depth: usize,
    points: &mut Vec<UnbalancePoint>,
) -> Result<(), MarginsError> {
    let middle = at(0.5 * (a.speed + b.speed))?;
    let is_off = |k: usize| {
        let apart = (middle.stations[k] - (a.stations[k] + b.stations[k]) * 0.5).norm();
        apart > OFF * middle.stations[k].norm() + 1e-6
    };
    if depth > 0 && (0..middle.stations.len()).any(is_off) {
        fill(at, a, &middle, depth - 1, points)?;
        points.push(middle.clone());
        fill(at, &middle, b, depth - 1, points)
    } else {
        points.push(middle);
        Ok(())
    }
}
