//! The shapes of the slowest modes as a picture: the shaft bent along its length, at the instant when the mode is widest.

use plot::{Axis, Chart, Color, Look, Note, Series, Side};
use rotor::{C64, Mode, Rotor, ShaftLine};

use crate::units::CommandUnits;

/// So many modes are drawn, one under the other.
const MOST: usize = 6;
/// A mode that turns less than this part of its size is none that has a shape.
const TURNS: f64 = 1e-6;

/// One chart a mode, the slowest first; both senses of whirl of a mode on one where they are neighbours.
pub(super) fn charts(rotor: &Rotor, modes: &[Mode], units: CommandUnits) -> Vec<Chart> {
    let shaft = ShaftLine::of(rotor);
    let mut turning: Vec<&Mode> = modes.iter().filter(|m| m.pole.im.abs() > TURNS * (1.0 + m.pole.norm())).collect();
    turning.sort_by(|a, b| a.pole.im.abs().total_cmp(&b.pole.im.abs()));
    turning.into_iter().take(MOST).map(|mode| chart(rotor, &shaft, mode, units)).collect()
}

fn chart(rotor: &Rotor, shaft: &ShaftLine, mode: &Mode, units: CommandUnits) -> Chart {
    let (at, shape) = (shaft.positions(), shaft.deflection(&mode.shape));
    // Turned so that as much as can be lies in the plane of the paper.
    let square: C64 = shape.iter().map(|p| p * p).sum();
    let turn = C64::cis(-0.5 * square.arg());
    let most = shape.iter().map(|p| p.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let seen = |part: fn(&C64) -> f64| -> Vec<(f64, f64)> {
        at.iter().zip(&shape).map(|(x, p)| (*x, part(&(p * turn / most)))).collect()
    };
    let (from, to) = (at[0], at[at.len() - 1]);
    let (from, to) = if to > from { (from, to) } else { (from - 0.5, to + 0.5) };
    let color = if mode.pole.im > 0.0 { Color::BLUE } else { Color::VERMILLION };
    let mut series = vec![
        Series::new("", Look::Thin, Color::GREY, vec![(from, 0.0), (to, 0.0)]),
        Series::new("in the plane of the paper", Look::Solid, color, seen(|p| p.re)),
        Series::new("across it", Look::Dotted, color, seen(|p| p.im)),
    ];
    if rotor.is_chain() {
        series.push(Series::new("", Look::Dots, color, seen(|p| p.re)));
    }
    let frequency = crate::output::rounded(units.frequency(mode.pole.im));
    let title = format!(
        "{}, {}{}, damping {}",
        mode.whirl(),
        frequency,
        units.pick(" rad per tau", " Hz"),
        crate::output::rounded(mode.damping())
    );
    Chart {
        title,
        x: Axis::new(if rotor.is_chain() { "mass" } else { "along the shaft (m)" }, from, to),
        y: Axis::new("of the largest", -1.1, 1.1),
        equal: false,
        series,
        notes: notes(rotor),
    }
}

/// What holds the rotor, under the line.
fn notes(rotor: &Rotor) -> Vec<Note> {
    let Some(beam) = rotor.beam() else { return Vec::new() };
    let (full, mut notes) = (beam.full(), Vec::<Note>::new());
    for spring in full.springs.iter().filter(|spring| !spring.is_touchdown()) {
        let at = (full.nodes[spring.node].position, -0.75);
        if notes.iter().any(|note| note.at == at) {
            continue;
        }
        let name = beam.coordinate(spring.station).map(|place| beam.place_name(place));
        notes.push(Note {
            at,
            text: name.unwrap_or_else(|| format!("station {}", spring.station + 1)),
            side: Side::Below,
        });
    }
    notes
}
