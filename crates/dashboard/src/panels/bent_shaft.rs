//! A shaft bent as one of its modes bends it, seen from the side and turned slowly, so that it is seen in space. Not a panel: the modes
//! have it below their table.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use rotor::{C64, Mode, Rotor, ShaftLine};

use crate::drawing::{write, write_free};
use crate::plot::{Plot, Window};
use crate::theme;

/// Seconds that it takes to turn once, whatever the frequency of the mode.
const A_TURN: f64 = 4.0;
/// How far the largest displacement of a mode reaches, beside half of the height.
const REACH: f64 = 0.9;

/// Draws a mode of a shaft as it is after `seconds` of turning: forward whirl one way, backward the other. The dots are how far each
/// place goes; below stands what holds the shaft.
pub(super) fn draw(rotor: &Rotor, mode: &Mode, seconds: f64, area: Rect, buffer: &mut Buffer) {
    let (Some(beam), shaft) = (rotor.beam(), ShaftLine::of(rotor)) else { return };
    let (Some(&first), Some(&last)) = (shaft.positions().first(), shaft.positions().last()) else { return };
    if area.height < 3 || mode.shape.is_empty() || last <= first {
        return;
    }
    let turned = C64::cis(std::f64::consts::TAU * seconds / A_TURN * if mode.pole.im < 0.0 { -1.0 } else { 1.0 });
    let line = Rect { height: area.height - 1, ..area };
    let window = Window { x: [first, last], y: [-1.0 / REACH, 1.0 / REACH] };
    let mut plot = Plot::new(line, window);
    plot.line([first, 0.0], [last, 0.0], theme::GRID);
    let mut shape = shaft.deflection(&mode.shape);
    rotor::scale_to_largest(&mut shape);
    let places = || shaft.positions().iter().copied().zip(&shape);
    for side in [1.0, -1.0] {
        places().for_each(|(x, p)| plot.dot(x, side * p.norm(), theme::CLEARANCE));
    }
    let color = if mode.pole.im < 0.0 { theme::BACKWARD } else { theme::FORWARD };
    plot.path(places().map(|(x, p)| [x, (p * turned).re]), color);
    plot.paint(buffer);

    let foot = Rect { y: area.bottom() - 1, height: 1, ..area };
    for spring in beam.full().springs.iter().filter(|spring| !spring.is_touchdown()) {
        let at = shaft.positions()[spring.node];
        if let Some((column, _)) = plot.cell(at, 0.0).or_else(|| plot.cell(0.999 * last, 0.0)) {
            write(buffer, foot, column, foot.y, "▲", theme::quiet());
            let name = beam.coordinate(spring.station).map(|place| beam.place_name(place)).unwrap_or_default();
            write_free(buffer, foot, column + 2, foot.y, &name, theme::quiet());
        }
    }
}

#[cfg(test)]
mod tests {
    use machine::MachinePoles;
    use rotor::{Settings, builtin};

    use super::*;
    use crate::drawing::tests::drawn;

    /// A picture of the first bending mode of the rig, forward or backward.
    fn frame(seconds: f64, forward: bool) -> String {
        let rotor = builtin::rotor("rig").expect("built in");
        let settings = Settings::new(&rotor, 3.0, builtin::feedback(&rotor, "own").expect("its own"));
        let modes = MachinePoles::of(&rotor, &settings).expect("found").modes;
        let mode = modes.iter().find(|mode| (mode.pole.im > 5.0) == forward && mode.pole.im.abs() > 5.0).expect("one");
        drawn(60, 11, |area, buffer| draw(&rotor, mode, seconds, area, buffer))
    }

    #[test]
    fn it_turns_and_comes_back_after_a_turn() {
        assert_ne!(frame(0.0, true), frame(1.0, true));
        assert_eq!(frame(0.0, true), frame(A_TURN, true));
        // Backward whirl turns the other way: it is where forward whirl comes to.
        assert_ne!(frame(0.5, false), frame(0.5, true));
    }

    #[test]
    fn what_holds_it_stands_below() {
        let frame = frame(0.3, true);
        let foot = frame.lines().last().expect("a foot");
        assert!(foot.contains("▲ left") && foot.contains("▲ right"), "{frame}");
    }

    #[test]
    fn it_is_drawn_at_every_size() {
        let rotor = builtin::rotor("rig").expect("built in");
        let settings = Settings::new(&rotor, 3.0, builtin::feedback(&rotor, "own").expect("its own"));
        let modes = MachinePoles::of(&rotor, &settings).expect("found").modes;
        for (width, height) in [(0, 0), (1, 1), (3, 2), (5, 3), (200, 60)] {
            for mode in &modes {
                drawn(width, height, |area, buffer| draw(&rotor, mode, 0.7, area, buffer));
            }
        }
    }
}
