//! The rotor in space: its line as it is bent now, the last turns of its places where they are along it, and the room they have.

use rerun::archetypes::{LineStrips3D, Points3D, ViewCoordinates};
use rerun::components::Radius;
use rerun::{AsComponents, Color};
use rotor::{C64, Rotor, ShaftLine};

use crate::schema;

/// How long the rotor is drawn, in times of the room that its places have: long enough to be a shaft, short enough for its whirl to be seen.
const LENGTH: f64 = 12.0;
/// The room of a rotor without clearances, in `e_t`.
const ROOM: f64 = 5.0;
/// Points of a place's orbit at most: two turns of the fastest that it does.
pub(super) const MOST_POINTS: usize = 80;

/// What it is drawn of. Across, everything is in `e_t`; along, nothing is to scale.
#[derive(Debug)]
pub(super) struct Shaft {
    line: ShaftLine,
    /// How far along it is drawn: the left end, and what a unit of its positions is.
    left: f64,
    unit: f64,
}

/// An entity and what is put there.
pub(super) type Drawn = (String, Box<dyn AsComponents>);

impl Shaft {
    pub(super) fn new(rotor: &Rotor) -> Self {
        let line = ShaftLine::of(rotor);
        let ends = [line.positions().first(), line.positions().last()].map(|at| at.copied().unwrap_or_default());
        let room = rotor.deadbands().into_iter().fold(0.0, f64::max);
        let length = LENGTH * if room > 0.0 { room } else { ROOM };
        let unit = if ends[1] > ends[0] { length / (ends[1] - ends[0]) } else { 0.0 };
        Self { line, left: ends[0], unit }
    }

    /// What does not change: which way is up, the axis, and where the places are.
    pub(super) fn still(&self) -> Vec<Drawn> {
        let axis: Vec<_> = self.line.positions().iter().map(|at| self.point(*at, C64::ZERO)).collect();
        let places: Vec<_> = self.line.places().iter().map(|at| self.point(*at, C64::ZERO)).collect();
        let axis = LineStrips3D::new([axis]).with_colors([GREY]).with_radii([Radius::new_ui_points(0.5)]);
        let places = Points3D::new(places).with_colors([GREY]).with_radii([Radius::new_ui_points(2.0)]);
        vec![
            (schema::SHAFT.into(), Box::new(ViewCoordinates::RIGHT_HAND_Z_UP())),
            (format!("{}/axis", schema::SHAFT), Box::new(axis)),
            (format!("{}/places", schema::SHAFT), Box::new(places)),
        ]
    }

    /// The line bent as it is when its places are so far out, and what these have drawn on the way there.
    pub(super) fn bent(&self, now: &[C64], orbits: &[Vec<C64>]) -> Vec<Drawn> {
        let (line, orbits) = (self.line(now), self.orbits(orbits));
        let line = LineStrips3D::new([line]).with_radii([Radius::new_ui_points(2.0)]);
        let orbits = LineStrips3D::new(orbits).with_radii([Radius::new_ui_points(1.0)]);
        vec![
            (format!("{}/line", schema::SHAFT), Box::new(line)),
            (format!("{}/orbits", schema::SHAFT), Box::new(orbits)),
        ]
    }

    /// The clearances as rings.
    pub(super) fn rings(&self, clearances: &[f64]) -> Drawn {
        let has_play =
            |(at, gap): (&f64, &f64)| (*gap > 0.0).then(|| super::scene::circle(*gap, |p| self.point(*at, p)));
        let rings = LineStrips3D::new(self.line.places().iter().zip(clearances).filter_map(has_play))
            .with_colors([Color::from_rgb(200, 150, 40)])
            .with_radii([Radius::new_ui_points(0.75)]);
        (format!("{}/clearances", schema::SHAFT), Box::new(rings))
    }

    fn line(&self, now: &[C64]) -> Vec<[f32; 3]> {
        let bent = self.line.deflection(now);
        self.line.positions().iter().zip(bent).map(|(at, p)| self.point(*at, p)).collect()
    }

    fn orbits(&self, orbits: &[Vec<C64>]) -> Vec<Vec<[f32; 3]>> {
        let along = self.line.places().iter().zip(orbits);
        along.map(|(at, orbit)| orbit.iter().map(|p| self.point(*at, *p)).collect()).collect()
    }

    fn point(&self, at: f64, p: C64) -> [f32; 3] {
        [((at - self.left) * self.unit) as f32, p.re as f32, p.im as f32]
    }
}

const GREY: Color = Color(rerun::datatypes::Rgba32(0x6e6e_6eff));

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    /// A shaft that is tilted as a whole is a straight line in space, through the newest point of the orbit of every place.
    #[test]
    fn a_tilted_shaft_is_a_straight_line_through_its_orbits() {
        for name in ["rig", "three-mass", "jeffcott"] {
            let shaft = Shaft::new(&builtin::rotor(name).expect("built in"));
            let tilted = |at: f64| C64::new(0.5 + 0.2 * at, -0.1 * at);
            let now: Vec<C64> = shaft.line.places().iter().map(|at| tilted(*at)).collect();
            let tracks: Vec<Vec<C64>> = now.iter().map(|p| vec![*p, C64::new(9.0, 9.0)]).collect();
            let (line, orbits) = (shaft.line(&now), shaft.orbits(&tracks));
            assert_eq!((line.len(), orbits.len()), (shaft.line.positions().len(), now.len()), "{name}");
            for (point, at) in line.iter().zip(shaft.line.positions()) {
                let expected = tilted(*at);
                let off = (f64::from(point[1]) - expected.re).abs().max((f64::from(point[2]) - expected.im).abs());
                assert!(off < 1e-5, "{name}: {point:?} at {at}, not {expected}");
            }
            for orbit in &orbits {
                let near = |of: &[f32; 3], point: &[f32; 3]| of.iter().zip(point).all(|(a, b)| (a - b).abs() < 1e-4);
                let is_on_line = |point| line.iter().any(|of| near(of, point));
                assert!(is_on_line(&orbit[0]) && !is_on_line(&orbit[1]), "{name}: {orbit:?}");
            }
            // From the left end to the right one, longer than wide.
            let ends = [line[0][0], line[line.len() - 1][0]];
            assert!(ends[0] == 0.0 && (line.len() == 1 || ends[1] > 10.0), "{name}: {ends:?}");
        }
    }
}
