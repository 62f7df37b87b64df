//! What a rotor of shaft elements is as a plant: its matrices in the scales of the rotor, and what holds it apart from them.

use beam::{FullModel, Place, Reduced, Spring};
use nalgebra::{DMatrix, DVector, RowDVector};
use units::Scales;

use crate::C64;
use crate::plant::{Contact, Direction, Matrices, Plant, Station, Tabulated};
use crate::{BeamError, RotorError};

/// How exactly few coordinates make a motion as a whole, which is among the shapes that they are made of.
const SAME_MOTION: f64 = 1e-6;

/// Speeds in rad/s with stiffness and damping at each, SI.
type OverSpeed = Vec<(f64, C64, C64)>;

/// What holds a rotor to the ground or to pedestals, apart by how it is computed.
pub(super) struct Holds {
    /// Constant and without play: what reads the displacement, stiffness and damping, SI.
    constant: Vec<(Direction, C64, C64)>,
    /// Over speed: the same with the speeds.
    tabulated: Vec<(Direction, OverSpeed)>,
    /// With play: place, stiffness, clearance, whether it is a touchdown bearing.
    contacts: Vec<(usize, f64, f64, bool)>,
}

impl Holds {
    pub(super) fn of(full: &FullModel, at: impl Fn(&Spring) -> (Direction, Option<usize>)) -> Result<Self, RotorError> {
        let mut holds = Self { constant: vec![], tabulated: vec![], contacts: vec![] };
        for spring in &full.springs {
            let (row, place) = at(spring);
            let has_play = spring.clearance > 0.0;
            if has_play {
                let place = place.ok_or(BeamError::NotSimulated { station: spring.station + 1 })?;
                if holds.contacts.iter().any(|(taken, ..)| *taken == place) {
                    return Err(BeamError::TwoContacts { station: spring.station + 1 }.into());
                }
                let stiffness = spring.stiffness.at(0.0);
                if spring.stiffness.values().any(|value| value != stiffness) {
                    return Err(BeamError::TabulatedContact { station: spring.station + 1 }.into());
                }
                holds.contacts.push((place, stiffness, spring.clearance, spring.is_touchdown()));
            }
            if spring.is_touchdown() {
                continue;
            }
            // Within its play only the direct stiffness is missing.
            let stiffness = |speed: f64| match (spring.stiffness_at(speed), has_play) {
                (whole, false) => whole,
                (whole, true) => C64::new(0.0, whole.im),
            };
            match speeds_of(spring) {
                speeds if speeds.is_empty() => {
                    holds.constant.push((row, stiffness(0.0), spring.damping_at(0.0)));
                }
                speeds => {
                    let rows = speeds.into_iter().map(|w| (w, stiffness(w), spring.damping_at(w))).collect();
                    holds.tabulated.push((row, rows));
                }
            }
        }
        Ok(holds)
    }
}

/// The speeds at which a coefficient of a spring has a corner; none of one that is constant.
fn speeds_of(spring: &Spring) -> Vec<f64> {
    let coefficients = [&spring.stiffness, &spring.damping, &spring.cross_stiffness, &spring.cross_damping];
    let mut speeds: Vec<f64> = coefficients.into_iter().flat_map(|coefficient| coefficient.speeds()).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    speeds
}

/// The places of a plant, what acts on each, and the unbalance of its coordinates.
pub(super) struct Places {
    pub(super) stations: Vec<Station>,
    pub(super) columns: Vec<Direction>,
    pub(super) unbalance: Vec<C64>,
}

/// The plant of a reduced rotor, and the clearance of each place in `e_t`.
pub(super) fn plant_of(full: &FullModel, reduced: &Reduced, scales: &Scales) -> Result<(Plant, Vec<f64>), RotorError> {
    let n = reduced.coordinates();
    let direction = |row: RowDVector<f64>| {
        // A place that is a coordinate is so exactly.
        let own = |k: usize| (row[k] - 1.0).abs() < 1e-9;
        let others = |k: usize| (0..n).all(|i| i == k || row[i].abs() < 1e-9);
        match (0..n).find(|&k| own(k) && others(k)) {
            Some(k) => Direction::Unit(k),
            None => Direction::Dense(row.iter().map(|x| C64::from(*x)).collect()),
        }
    };
    let row = |node: usize| direction(reduced.displacement(node));
    let place = |spring: &Spring| reduced.stations.iter().position(|place| place.station == Some(spring.station));
    let holds = Holds::of(full, |spring| (direction(reduced.stretch(spring)), place(spring)))?;
    let stations = (reduced.stations.iter().enumerate())
        .map(|(k, place)| Station { name: place.told(), row: Direction::Unit(k) })
        .collect();
    let columns = (0..n).map(Direction::Unit).collect();
    let unbalance = unbalance_of(full, scales, n, row);
    let free = free_motions(full, reduced);
    matrices(
        [&reduced.mass, &reduced.damping, &reduced.gyroscopic],
        [&reduced.stiffness, &reduced.cross_stiffness, &reduced.internal],
        scales,
        holds,
        Places { stations, columns, unbalance },
    )
    .map(|(plant, clearances)| (plant.free_in(free), clearances))
}

/// The free motions of the rotor that its coordinates can make, in those.
fn free_motions(full: &FullModel, reduced: &Reduced) -> Vec<Vec<C64>> {
    let rows: Vec<RowDVector<f64>> = reduced.stations.iter().map(|place| full.row(place)).collect();
    let motions = full.free_motions().into_iter().filter_map(|motion| {
        let own = DVector::from_iterator(rows.len(), rows.iter().map(|row| (row * &motion)[0]));
        let is_kept = (&reduced.shape * &own - &motion).amax() <= SAME_MOTION * motion.amax();
        is_kept.then(|| complex(&own))
    });
    motions.collect()
}

pub(super) fn complex(vector: &DVector<f64>) -> Vec<C64> {
    vector.iter().map(|x| C64::from(*x)).collect()
}

/// Mass times eccentricity of every coordinate, in `M_t e_t`; grades without a speed are for `w0`.
pub(super) fn unbalance_of(
    full: &FullModel,
    scales: &Scales,
    order: usize,
    row: impl Fn(usize) -> Direction,
) -> Vec<C64> {
    let mut all = vec![C64::ZERO; order];
    for (node, amount) in full.station_nodes.iter().zip(full.unbalance(scales.w0)) {
        if amount != C64::ZERO {
            row(*node).add(amount / (scales.m_t * scales.e_t), &mut all);
        }
    }
    all
}

/// A plant of matrices in SI units, and the clearance of each place in `e_t`.
pub(super) fn matrices(
    [mass, damping, gyroscopic]: [&DMatrix<f64>; 3],
    [stiffness, cross, internal]: [&DMatrix<f64>; 3],
    scales: &Scales,
    holds: Holds,
    places: Places,
) -> Result<(Plant, Vec<f64>), RotorError> {
    let Scales { w0, k_t, m_t, e_t } = *scales;
    let (order, per_damping) = (mass.nrows(), m_t * w0);
    let mut d0 = damping.zip_map(internal, |c, cr| C64::from(-(c + cr) / per_damping));
    let d1 = gyroscopic.map(|g| C64::new(0.0, g / m_t));
    let mut s0 = stiffness.zip_map(cross, |k, kc| C64::new(-k / k_t, kc / k_t));
    let s1 = internal.map(|cr| C64::new(0.0, cr / per_damping));
    for (row, stiffness, damping) in &holds.constant {
        let row = row.dense(order);
        let square = &row * row.transpose();
        s0 -= &square * (stiffness / k_t);
        d0 -= square * (damping / per_damping);
    }
    let tabulated = holds.tabulated.into_iter().map(|(row, table)| Tabulated {
        column: row.clone(),
        row,
        table: table.into_iter().map(|(w, k, d)| (w / w0, [k / k_t, d / per_damping])).collect(),
    });
    let count = places.stations.len();
    let mut clearances = vec![0.0; count];
    let mut contacts: Vec<Contact> = (places.stations.iter().enumerate())
        .map(|(station, of)| Contact { station, column: of.row.clone(), stiffness: 0.0, is_touchdown: false })
        .collect();
    for (place, stiffness, clearance, is_touchdown) in holds.contacts {
        contacts[place] = Contact { stiffness: stiffness / k_t, is_touchdown, ..contacts[place].clone() };
        clearances[place] = clearance / e_t;
    }
    let plant = Plant::of_matrices(Matrices {
        mass: mass.map(|m| C64::from(m / m_t)),
        damping: [d0, d1],
        stiffness: [s0, s1],
        stations: places.stations,
        contacts,
        unbalance: places.unbalance,
        columns: places.columns,
        tabulated: tabulated.collect(),
    })?;
    Ok((plant, clearances))
}

/// What reads the displacement of a place of the full model.
pub(super) fn row_of(full: &FullModel, place: &Place) -> Direction {
    match place.station {
        Some(station) => Direction::Unit(full.displacements[full.station_nodes[station]]),
        None => Direction::Dense(full.row(place).iter().map(|x| C64::from(*x)).collect()),
    }
}
