//! The line of a rotor's axis: where along it something is, and how far it bends out there.

use nalgebra::DMatrix;

use crate::{C64, Rotor};

/// The axis of a rotor: of shaft elements the ends of all elements, of a chain its masses.
#[derive(Clone, Debug)]
pub struct ShaftLine {
    positions: Vec<f64>,
    places: Vec<f64>,
    /// Displacement of each position from that of the places; of a chain these are the same.
    shape: Option<DMatrix<f64>>,
}

impl ShaftLine {
    /// That of a rotor.
    #[must_use]
    pub fn of(rotor: &Rotor) -> Self {
        let Some(beam) = rotor.beam() else {
            let masses: Vec<f64> = (1..=rotor.len()).map(|mass| mass as f64).collect();
            return Self { positions: masses.clone(), places: masses, shape: None };
        };
        let (nodes, reduced) = (&beam.full().nodes, beam.reduced());
        let rows: Vec<_> = (0..nodes.len()).map(|node| reduced.displacement(node)).collect();
        Self {
            positions: nodes.iter().map(|node| node.position).collect(),
            places: beam.places().iter().map(|place| place.position).collect(),
            shape: Some(DMatrix::from_rows(&rows)),
        }
    }

    /// Where along the axis the line is known: metres from the left end; of a chain, whose masses have no distance, their numbers.
    #[must_use]
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Where the places are whose displacements a rotor tells, in the same.
    #[must_use]
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// How far the line is out at each of its positions, from the displacement of every place and in the same unit: as the shapes of the
    /// reduction have it. Empty unless there is one displacement a place.
    #[must_use]
    pub fn deflection(&self, places: &[C64]) -> Vec<C64> {
        if places.len() != self.places.len() {
            return Vec::new();
        }
        let Some(shape) = &self.shape else { return places.to_vec() };
        shape.row_iter().map(|row| row.iter().zip(places).map(|(part, p)| p * *part).sum()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;

    #[test]
    fn the_line_goes_through_the_places() {
        for name in ["three-mass", "rig"] {
            let rotor = builtin::rotor(name).expect("built in");
            let line = ShaftLine::of(&rotor);
            let places: Vec<C64> = (0..rotor.len()).map(|k| C64::new(1.0 + k as f64, 0.5 - k as f64)).collect();
            let bent = line.deflection(&places);
            assert_eq!(bent.len(), line.positions().len());
            for (at, place) in line.places().iter().zip(&places) {
                let node = line.positions().iter().position(|x| (x - at).abs() < 1e-9).expect("a node is there");
                assert!((bent[node] - place).norm() < 1e-6, "{name}: {} at {at}, not {place}", bent[node]);
            }
            assert!(line.deflection(&places[1..]).is_empty());
        }
    }

    /// A stiff motion of a free shaft is a straight line: what is lost by reduction is none of it.
    #[test]
    fn a_tilt_of_the_rig_is_a_straight_line() {
        let rotor = builtin::rotor("rig").expect("built in");
        let line = ShaftLine::of(&rotor);
        let tilted = |x: &f64| C64::new(0.3 - 0.2 * x, 0.1 * x);
        let places: Vec<C64> = line.places().iter().map(tilted).collect();
        for (x, p) in line.positions().iter().zip(line.deflection(&places)) {
            assert!((p - tilted(x)).norm() < 1e-6, "{p} at {x}");
        }
    }
}
