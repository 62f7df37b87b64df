//! The matrices of a whole drawing.

use nalgebra::DMatrix;

use crate::drawing::{Bearing, Drawing};
use crate::element::elements;
use crate::model::{FullModel, Inside, Place, Spring, SpringPart};
use crate::{Coefficient, Matrices};

impl Drawing {
    /// All elements, discs and masses assembled; bearings, seals and magnetic bearings listed beside.
    #[must_use]
    pub fn full(&self) -> FullModel {
        self.matrices.as_ref().map_or_else(|| self.of_elements(), |matrices| self.of_matrices(matrices))
    }

    fn of_elements(&self) -> FullModel {
        let nodes = self.elements() + 1;
        let zeros = || DMatrix::zeros(2 * nodes, 2 * nodes);
        let [mut mass, mut damping, mut gyroscopic] = [zeros(), zeros(), zeros()];
        let [mut stiffness, mut cross_stiffness, mut internal] = [zeros(), zeros(), zeros()];
        let mut places = vec![Place::station(0.0, 0)];
        let mut inside = Vec::new();
        let ends = self.station_positions();

        let mut node = 0;
        for (i, section) in self.sections.iter().enumerate() {
            for (k, element) in elements(section, &self.materials[section.material]).enumerate() {
                let from = ends[i] + section.length * k as f64 / section.elements as f64;
                // What is between the ends of a coupling has no place.
                let thirds: &[f64] = if section.coupling.is_none() { &[1.0 / 3.0, 2.0 / 3.0] } else { &[] };
                for &third in thirds {
                    let position = from + section.length / section.elements as f64 * third;
                    inside.push(Inside { node, position, row: element.shape.displacement(third) });
                }
                node += 1;
                let last = k + 1 == section.elements;
                let position = ends[i] + section.length * (k + 1) as f64 / section.elements as f64;
                places.push(if last { Place::station(ends[i + 1], i + 1) } else { Place::inner(position) });
            }
        }
        let node_of: Vec<usize> =
            places.iter().enumerate().filter(|(_, place)| place.station.is_some()).map(|(node, _)| node).collect();

        let layers = self.sections.iter().enumerate();
        let sleeves = self.sleeves.iter().map(|sleeve| (sleeve.section, &sleeve.layer));
        for (under, layer) in layers.chain(sleeves) {
            for (k, element) in elements(layer, &self.materials[layer.material]).enumerate() {
                let at = 2 * (node_of[under] + k);
                let add = |whole: &mut DMatrix<f64>, part| {
                    let mut there = whole.fixed_view_mut::<4, 4>(at, at);
                    there += part;
                };
                add(&mut mass, &element.mass);
                add(&mut damping, &element.damping);
                add(&mut gyroscopic, &element.gyroscopic);
                add(&mut stiffness, &element.stiffness);
                add(&mut cross_stiffness, &element.cross_stiffness);
                add(&mut internal, &element.internal);
            }
        }
        for disc in &self.discs {
            let p = 2 * node_of[disc.station];
            mass[(p, p)] += disc.mass;
            mass[(p + 1, p + 1)] += disc.diametral_inertia;
            gyroscopic[(p + 1, p + 1)] += disc.polar_inertia;
        }
        for point in &self.point_masses {
            let p = 2 * node_of[point.station];
            mass[(p, p)] += point.mass;
        }
        damping += &mass * self.mass_damping + &stiffness * self.stiffness_damping;
        for bearing in self.bearings.iter().chain(&self.seals) {
            let p = 2 * node_of[bearing.station];
            mass[(p, p)] += bearing.mass;
        }
        FullModel {
            mass,
            damping,
            gyroscopic,
            stiffness,
            cross_stiffness,
            internal,
            springs: self.springs(&node_of),
            displacements: (0..nodes).map(|node| 2 * node).collect(),
            nodes: places,
            station_nodes: node_of,
            inside,
            pedestals: Vec::new(),
            unbalances: self.unbalances.clone(),
            rotor_mass: self.mass(),
        }
        .on_pedestals(self)
    }

    /// The matrices of another program with the masses that the drawing adds.
    fn of_matrices(&self, matrices: &Matrices) -> FullModel {
        let mut mass = matrices.mass.clone();
        let points = self.point_masses.iter().map(|point| (point.station, point.mass));
        let bearings = self.bearings.iter().chain(&self.seals).map(|bearing| (bearing.station, bearing.mass));
        for (station, added) in points.chain(bearings) {
            let p = matrices.stations[station];
            mass[(p, p)] += added;
        }
        let size = mass.nrows();
        let station_nodes: Vec<usize> = (0..matrices.stations.len()).collect();
        let places = matrices.positions.iter().enumerate();
        FullModel {
            mass,
            damping: matrices.damping.clone(),
            gyroscopic: matrices.gyroscopic.clone(),
            stiffness: matrices.stiffness.clone(),
            cross_stiffness: matrices.cross_stiffness.clone(),
            internal: DMatrix::zeros(size, size),
            springs: self.springs(&station_nodes),
            displacements: matrices.stations.clone(),
            nodes: places.map(|(station, &position)| Place::of_coordinate(position, station, matrices)).collect(),
            station_nodes,
            inside: Vec::new(),
            pedestals: Vec::new(),
            unbalances: self.unbalances.clone(),
            rotor_mass: self.mass(),
        }
    }

    /// What is not in the matrices: bearings, seals, the pull of magnets, touchdown bearings.
    fn springs(&self, node: &[usize]) -> Vec<Spring> {
        let support = |part, bearing: &Bearing| Spring {
            part,
            station: bearing.station,
            node: node[bearing.station],
            stiffness: bearing.stiffness.clone(),
            damping: bearing.damping.clone(),
            cross_stiffness: bearing.cross_stiffness.clone(),
            cross_damping: bearing.cross_damping.clone(),
            clearance: bearing.clearance,
            pedestal: None,
        };
        let plain = |part, station: usize, stiffness: f64, clearance| {
            let bearing =
                Bearing { station, stiffness: Coefficient::Constant(stiffness), clearance, ..Bearing::default() };
            support(part, &bearing)
        };
        let bearings = self.bearings.iter().enumerate().map(|(i, b)| support(SpringPart::Bearing(i), b));
        let seals = self.seals.iter().enumerate().map(|(i, seal)| support(SpringPart::Seal(i), seal));
        let pulls = self.magnetics.iter().enumerate();
        let pulls = pulls.map(|(i, m)| plain(SpringPart::Magnetic(i), m.station, -m.negative_stiffness, 0.0));
        let touchdowns = self.magnetics.iter().enumerate().filter_map(|(i, m)| {
            let stiffness = m.touchdown_stiffness?;
            Some(plain(SpringPart::Touchdown(i), m.station, stiffness, m.clearance))
        });
        bearings.chain(seals).chain(pulls).chain(touchdowns).collect()
    }
}
