//! What is recorded for the eye: orbits as thinned curves with their clearances, the rotor in space, poles as points, settings as series
//! and as text. All of it could be made again from the exact data; none of it is read back.

use std::f64::consts::TAU;

use rerun::archetypes::{LineStrips2D, Points2D, Scalars, SeriesLines, TextDocument};
use rerun::components::InterpolationMode::StepAfter;
use rerun::components::Radius;
use rerun::log::{Chunk, ChunkError};
use rerun::{AsComponents, Color, TimePoint};
use rotor::file::write_feedback;
use rotor::{C64, Rotor, Settings};
use wire::Channel;

use super::chunks;
use super::shaft::{self, Shaft};
use crate::batch::Batch;
use crate::schema;
use crate::session::Revision;

type Chunks = Vec<Result<Chunk, ChunkError>>;

/// Points of a curve per turn of the fastest mode or spin: round to the eye.
const POINTS_A_TURN: f64 = 40.0;
/// No curve has more points than this, and a batch with fewer steps may wait for its curves.
const MOST_POINTS: usize = 1000;
/// How far apart curves are then: each is a message for every mass.
const CURVES_APART_NS: u64 = 900_000_000;

/// Entity of the series of all settings.
pub(super) fn values_path() -> String {
    format!("{}/values", schema::SETTINGS)
}

/// Entity of a mass's orbit.
pub(super) fn orbit_path(mass: usize) -> String {
    format!("{}/mass{}", schema::ORBITS, mass + 1)
}

/// Draws what the data mean.
#[derive(Debug)]
pub(super) struct Scene {
    masses: usize,
    /// Of the fastest mode or spin under the settings in force, radians per unit of tau.
    fastest: f64,
    /// The names that the series of settings have been given.
    named: Vec<String>,
    /// The clearances whose circles and rings have been drawn.
    drawn: Vec<f64>,
    /// When the last curves were drawn.
    curved_ns: u64,
    shaft: Shaft,
}

impl Scene {
    pub(super) fn new(rotor: &Rotor) -> Self {
        let shaft = Shaft::new(rotor);
        Self { masses: rotor.len(), fastest: 1.0, named: Vec::new(), drawn: Vec::new(), curved_ns: 0, shaft }
    }

    /// What does not change.
    pub(super) fn still(&self) -> Chunks {
        let still = |entity: String, what: &dyn AsComponents| row(&entity, TimePoint::STATIC, what);
        let line = SeriesLines::new().with_names(["minimum damping ratio"]).with_interpolation_mode(StepAfter);
        let shaft = self.shaft.still().into_iter().map(|(entity, what)| still(entity, what.as_ref()));
        shaft.chain([still(format!("{}/min_damping", schema::POLES), &line)]).collect()
    }

    /// The orbits of all masses during a batch, one curve each, and the rotor in space at its end; none if the last ones are younger than a
    /// second.
    pub(super) fn curves(&mut self, batch: &Batch) -> Chunks {
        let Some((_, last)) = batch.span() else { return Vec::new() };
        if last.wall_ns.saturating_sub(self.curved_ns) < CURVES_APART_NS && batch.len() < MOST_POINTS {
            return Vec::new();
        }
        self.curved_ns = last.wall_ns;
        let stride = self.stride(batch);
        let curve = |mass: usize| {
            let (y, z) = (batch.column(Channel::Y, mass), batch.column(Channel::Z, mass));
            // From the end backwards, so that the curve ends where the rotor is.
            let rows = (0..batch.len()).rev().step_by(stride).take(MOST_POINTS);
            let points: Vec<[f32; 2]> = rows.map(|row| upright(y[row], z[row])).collect();
            let strip = LineStrips2D::new([points]).with_radii([Radius::new_ui_points(1.0)]);
            row(&orbit_path(mass), chunks::timepoint(last), &strip)
        };
        let mut chunks: Chunks = (0..self.masses).map(curve).collect();
        let orbit = |mass: usize| {
            let (y, z) = (batch.column(Channel::Y, mass), batch.column(Channel::Z, mass));
            let rows = (0..batch.len()).rev().step_by(stride).take(shaft::MOST_POINTS);
            rows.map(|row| C64::new(y[row], z[row])).collect::<Vec<_>>()
        };
        let orbits: Vec<Vec<C64>> = (0..self.masses).map(orbit).collect();
        let now: Vec<C64> = orbits.iter().filter_map(|orbit| orbit.first().copied()).collect();
        let drawn = self.shaft.bent(&now, &orbits);
        chunks.extend(drawn.iter().map(|(entity, what)| row(entity, chunks::timepoint(last), what.as_ref())));
        chunks
    }

    /// Every how many steps a curve needs a point.
    fn stride(&self, batch: &Batch) -> usize {
        let tau = batch.column(Channel::Tau, 0);
        let (Some(first), Some(last)) = (tau.first(), tau.last()) else { return 1 };
        let dtau = (last - first) / batch.len().max(2) as f64;
        let between = TAU / (self.fastest * POINTS_A_TURN);
        if dtau > 0.0 && between.is_finite() { (between / dtau).floor().clamp(1.0, 1e6) as usize } else { 1 }
    }

    /// New settings: as series, their clearances as circles, their poles as points.
    pub(super) fn settings(&mut self, revision: &Revision, at: &TimePoint) -> Chunks {
        let Revision { settings, poles, min_damping, .. } = revision;
        self.fastest = poles.iter().map(|p| p.im.abs()).fold(settings.speed.abs().max(0.1), f64::max);
        let mut chunks = Chunks::new();
        let titled = |key: &rotor::Key| match key.parameter.unit() {
            "" => settings.label(*key),
            unit => format!("{} ({unit})", settings.label(*key)),
        };
        let keys = settings.keys();
        let names: Vec<String> = keys.iter().map(titled).collect();
        if self.named != names {
            let line =
                SeriesLines::new().with_names(names.clone()).with_many_interpolation_mode(vec![StepAfter; names.len()]);
            chunks.push(row(&values_path(), TimePoint::STATIC, &line));
            self.named = names;
        }
        let values = keys.iter().map(|key| settings.get(*key).unwrap_or(f64::NAN));
        chunks.push(row(&values_path(), at.clone(), &Scalars::new(values)));
        for (mass, gap) in settings.deadband.iter().enumerate() {
            if self.drawn.get(mass) == Some(gap) {
                continue;
            }
            let circle = LineStrips2D::new([circle(*gap, |p| [p.re as f32, p.im as f32])])
                .with_colors([Color::from_rgb(200, 150, 40)])
                .with_radii([Radius::new_ui_points(0.75)]);
            chunks.push(row(&format!("{}/deadband", orbit_path(mass)), at.clone(), &circle));
        }
        if self.drawn != settings.deadband {
            let (entity, what) = self.shaft.rings(&settings.deadband);
            chunks.push(row(&entity, at.clone(), what.as_ref()));
            self.drawn.clone_from(&settings.deadband);
        }
        chunks.push(row(schema::POLES, at.clone(), &points(poles)));
        // As long as the poles reach, so that a viewer that fits all in does not shrink them to a point.
        let reach = poles.iter().map(|p| p.im.abs()).fold(0.1, f64::max) as f32 * 1.1;
        let border = LineStrips2D::new([[[0.0_f32, -reach], [0.0, reach]]])
            .with_colors([Color::from_rgb(110, 110, 110)])
            .with_radii([Radius::new_ui_points(0.75)]);
        chunks.push(row(&format!("{}/stability_border", schema::POLES), at.clone(), &border));
        if !poles.is_empty() {
            chunks.push(row(&format!("{}/min_damping", schema::POLES), at.clone(), &Scalars::single(*min_damping)));
        }
        chunks
    }
}

fn row(entity: &str, at: TimePoint, what: &dyn AsComponents) -> Result<Chunk, ChunkError> {
    Chunk::builder(entity).with_archetype_auto_row(at, what).build()
}

/// A point of a picture: viewers draw them with the second coordinate downwards, and scale no 2D view, while `z` of the
/// rotor and the imaginary axis point up.
fn upright(across: f64, up: f64) -> [f32; 2] {
    [across as f32, -up as f32]
}

/// The points of a circle, each as `drawn` has it.
pub(super) fn circle<const N: usize>(radius: f64, drawn: impl Fn(C64) -> [f32; N]) -> Vec<[f32; N]> {
    (0..=72).map(|i| drawn(C64::from_polar(radius, f64::from(i) / 72.0 * TAU))).collect()
}

fn points(poles: &[C64]) -> Points2D {
    let colour = |p: &C64| if p.re >= 0.0 { Color::from_rgb(230, 60, 60) } else { Color::from_rgb(70, 180, 90) };
    let label = |p: &C64| format!("{:.4} {:+.4}j", p.re, p.im);
    Points2D::new(poles.iter().map(|p| upright(p.re, p.im)))
        .with_colors(poles.iter().map(colour))
        .with_labels(poles.iter().map(label))
        .with_show_labels(false)
        .with_radii([Radius::new_ui_points(5.0)])
}

/// The settings in force as a text for people: which gains, by whom, and how stable.
pub(super) fn settings_text(revision: &Revision) -> TextDocument {
    let Revision { from, revision, who, why, settings, substeps: _, min_damping, poles } = revision;
    let why = if why.is_empty() { String::new() } else { format!(" ({why})") };
    let stability = match poles.first() {
        Some(pole) if pole.re == 0.0 => "**marginal**: damping is zero but for rounding".to_owned(),
        Some(pole) if pole.re > 0.0 => format!("**unstable**, minimum damping ratio {min_damping:.5}"),
        Some(_) => format!("stable, minimum damping ratio {min_damping:.5}"),
        None => "poles unknown".to_owned(),
    };
    let Settings { speed, deadband, trip, ramp, coast_down, feedback, unbalance_added } = settings;
    let rate = |rate: f64, off: f64| if rate == off { "off".to_owned() } else { rate.to_string() };
    let (ramp, coast_down) = (rate(*ramp, f64::INFINITY), rate(*coast_down, 0.0));
    TextDocument::from_markdown(format!(
        "**revision {revision}** by {who}{why}, from step {from}\n\n{stability}\n\n\
         | setting | value |\n|---|---|\n| speed | {speed} |\n| deadband | {deadband:?} |\n| trip | {trip} |\n| ramp | {ramp} |\n| coast-down after a trip | {coast_down} |\n| unbalance added | {unbalance_added:?} |\n\n\
         ```toml\n{}```\n",
        write_feedback(feedback)
    ))
}

#[cfg(test)]
mod tests {
    use rotor::builtin;

    use super::*;

    #[test]
    fn clearances_are_drawn_when_they_change_and_at_no_other_time() {
        let rotor = builtin::rotor("rig").expect("built in");
        let feedback = builtin::feedback(&rotor, "own").expect("built in");
        let mut revision = Revision {
            from: 0,
            revision: 1,
            who: String::new(),
            why: String::new(),
            settings: Settings::new(&rotor, 0.5, feedback),
            substeps: 1,
            poles: Vec::new(),
            min_damping: 0.0,
        };
        let mut scene = Scene::new(&rotor);
        // Circles, one a place, and the rings of all places in space.
        let mut drawn = |revision: &Revision| {
            let chunks = scene.settings(revision, &TimePoint::STATIC);
            let entities: Vec<String> =
                chunks.iter().map(|chunk| chunk.as_ref().expect("a chunk").entity_path().to_string()).collect();
            ["/deadband", "/clearances"].map(|end| entities.iter().filter(|entity| entity.ends_with(end)).count())
        };
        assert_eq!([drawn(&revision), drawn(&revision)], [[rotor.len(), 1], [0, 0]]);
        revision.settings.deadband[0] += 1.0;
        assert_eq!(drawn(&revision), [1, 1]);
    }
}
