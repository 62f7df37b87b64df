//! What the panels of spectra have in common: which mass and which frequencies they show, what the mouse does on them, and
//! how lines are told.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use spectrum::Peak;

use super::panel::{Panel, PanelCommand, PanelRequest};
use super::wheel_times;
use crate::axis::{PlotAxis, Scaling};
use crate::input::Mouse;
use crate::selection::ReadoutMove;
use crate::selection::SelectedItem;
use crate::view::View;
use telemetry::frame_data::FrameData;
use telemetry::units::ScreenUnits;
use text::number::{nice_ceiling, short};

/// Draws spectra along their axes.
type Draw = fn(&View<'_>, &mut Spectral, Rect, &mut Buffer);

/// A panel of spectra: a click points at a frequency, the wheel shows more or fewer of them.
pub(crate) struct SpectralPanel {
    axes: Spectral,
    draw: Draw,
}

impl SpectralPanel {
    pub(super) fn new(draw: Draw) -> Self {
        let (along, value) = (PlotAxis::default(), PlotAxis::default());
        Self { axes: Spectral { mass: None, along, shown: None, value, units: ScreenUnits::DIMENSIONLESS }, draw }
    }
}

impl Panel for SpectralPanel {
    fn draw(&mut self, view: &View<'_>, area: Rect, buffer: &mut Buffer) {
        (self.draw)(view, &mut self.axes, area, buffer);
    }

    fn mouse(&mut self, view: &View<'_>, _area: Rect, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        self.axes.mouse(view, mouse, at)
    }

    fn told_at(&self, view: &View<'_>, _area: Rect, at: Position) -> Option<String> {
        let ([low, high], area) = self.axes.shown?;
        let units = view.data.units();
        let frequency = low + (f64::from(at.x.checked_sub(area.x)?) + 0.5) / f64::from(area.width) * (high - low);
        let speed = view.data.now.map_or(0.0, |now| view.data.track.speed(now));
        let order = if speed > 0.0 { format!("  {}X", short(frequency / speed, 4)) } else { String::new() };
        area.contains(at).then(|| format!("frequency {}{order}", units.frequency.told(frequency, 5)))
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        self.axes.command(command)
    }

    fn read(&mut self, view: &View<'_>, read: ReadoutMove) -> Option<SelectedItem> {
        self.axes.read(view, read)
    }
}

/// Poles up to which axes of frequency reach, slowest first: four motions forward and backward.
const SLOWEST: usize = 8;

/// Of which mass, over which frequencies and which densities spectra are shown.
#[derive(Clone, Debug)]
pub(super) struct Spectral {
    /// The mass, counted from 0; that with the first control bearing if there is none.
    mass: Option<usize>,
    /// Frequencies, as they stand on the axis.
    along: PlotAxis,
    /// The frequencies that were last shown, in units of `w0`, where, and over how many columns.
    shown: Option<([f64; 2], Rect)>,
    /// Decades of density, as they stand on the axis.
    pub(super) value: PlotAxis,
    /// The units that the axes count in.
    pub(super) units: ScreenUnits,
}

impl Spectral {
    /// The mass that is looked at.
    pub(super) fn mass(&self, data: &FrameData) -> usize {
        self.mass.unwrap_or_else(|| data.bearing_mass()).min(data.masses().saturating_sub(1))
    }

    /// The range of frequencies to show over `area`, in units of `w0`.
    pub(super) fn over(&mut self, data: &FrameData, area: Rect) -> [f64; 2] {
        let factor = data.units().frequency.factor;
        let reach = reach(data) * factor;
        let range = self.along.over([-reach, reach]).map(|end| end / factor);
        self.shown = Some((range, area));
        range
    }

    /// The sign of a range that stands still, for a title.
    pub(super) fn word(&self) -> &'static str {
        self.along.word()
    }

    /// Half of what one column stands for.
    pub(super) fn half_column(&self) -> f64 {
        self.shown.map_or(0.0, |([low, high], area)| 0.5 * (high - low) / f64::from(area.width.max(1)))
    }

    /// What the mouse asks for: a click points at a frequency, the wheel shows more or fewer.
    fn mouse(&mut self, view: &View<'_>, mouse: Mouse, at: Position) -> Option<PanelRequest> {
        let ([low, high], area) = self.shown?;
        let along = (f64::from(at.x.checked_sub(area.x)?) + 0.5) / f64::from(area.width);
        let frequency = low + along * (high - low);
        match mouse {
            Mouse::Wheel(notches) => {
                let there = frequency * view.data.units().frequency.factor;
                // Both sides alike, unless what is pointed at lies far from the middle.
                let about = if self.along.is_fixed() { Some(there) } else { None };
                self.along.zoom(wheel_times(notches), about);
                None
            }
            Mouse::Click | Mouse::Drag(_) => {
                let within = at.x < area.right() && (area.top()..=area.bottom()).contains(&at.y);
                within.then_some(PanelRequest::Select(SelectedItem::Frequency(frequency)))
            }
        }
    }

    fn command(&mut self, command: &PanelCommand<'_>) -> Option<Result<(), String>> {
        match command {
            PanelCommand::Value(scalings) => {
                // The highest density stays where it is.
                let top = self.value.shown().map(|[_, top]| top);
                let scaling = in_decades(*scalings.first()?);
                Some(scaling.and_then(|scaling| self.value.take(scaling, top)))
            }
            PanelCommand::Along(scaling, selection) => {
                let about = selection.frequency.map(|frequency| frequency * self.units.frequency.factor);
                Some(self.along.take(*scaling, about))
            }
            PanelCommand::Frequencies(scaling) => Some(self.along.take(*scaling, None)),
            PanelCommand::Mass(mass) => {
                self.mass = *mass;
                Some(Ok(()))
            }
            _ => None,
        }
    }

    fn read(&self, view: &View<'_>, read: ReadoutMove) -> Option<SelectedItem> {
        let ([low, high], _) = self.shown?;
        let before = view.selection.frequency;
        let speed = view.data.now.map_or(0.0, |now| view.data.track.speed(now));
        let frequency = match read {
            ReadoutMove::Off => before.unwrap_or(0.0),
            ReadoutMove::At(frequency) => frequency / view.data.units().frequency.factor,
            ReadoutMove::Move(by) => before.map_or(speed, |there| there + 2.0 * f64::from(by) * self.half_column()),
        };
        Some(SelectedItem::Frequency(frequency.clamp(low, high)))
    }
}

/// A scaling of densities, which the axis counts in decades.
fn in_decades(scaling: Scaling) -> Result<Scaling, String> {
    match scaling {
        Scaling::Fix([low, high]) if low <= 0.0 || high <= 0.0 => {
            Err(format!("{low}..{high}: expected densities above 0, such as 1e-6..1e2"))
        }
        Scaling::Fix(range) => Ok(Scaling::Fix(range.map(f64::log10))),
        other => Ok(other),
    }
}

/// Decades by which densities on the screen are higher than dimensionless ones.
pub(super) fn shift(units: &ScreenUnits) -> f64 {
    (units.length.factor.powi(2) / units.frequency.factor).log10()
}

/// How far axes of frequency reach by themselves, in units of `w0`: past 2X and past the slowest modes, which of a shaft are the
/// rigid ones and its first bendings; its fastest, at many times its speed, would press all that moves into one column.
pub(super) fn reach(data: &FrameData) -> f64 {
    let speed = data.now.map_or(0.0, |now| data.track.speed(now));
    let highest =
        data.poles().map_or(0.0, |(_, poles)| slowest(poles.iter().map(|pole| (pole.im.abs(), pole.re > 0.0))));
    let factor = data.units().frequency.factor;
    nice_ceiling((2.2 * speed).max(1.2 * highest).max(0.1) * factor) / factor
}

/// The highest of the slowest [`SLOWEST`] frequencies, and of those that grow, of which each says whether it does.
fn slowest(poles: impl Iterator<Item = (f64, bool)>) -> f64 {
    let mut poles: Vec<(f64, bool)> = poles.collect();
    poles.sort_by(|a, b| a.0.total_cmp(&b.0));
    let counts = poles.iter().enumerate().filter(|(k, (_, grows))| *k < SLOWEST || *grows);
    counts.map(|(_, (frequency, _))| *frequency).fold(0.0, f64::max)
}

/// A line in words: its frequency, its order, and the radius of its orbit.
pub(super) fn told(peak: &Peak, units: &ScreenUnits) -> String {
    let order = if peak.name.is_empty() { String::new() } else { format!("  {}", peak.name) };
    let frequency = match units.scales {
        Some(_) => units.frequency.told(peak.frequency, 5),
        None => short(peak.frequency, 4),
    };
    format!(" ┆ {frequency}{order}  {} ", units.length.told(peak.radius, 4))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_modes_of_a_shaft_do_not_set_the_axis() {
        let of = |grows: u32| slowest((1..=16).map(|k| (f64::from(k), k == grows)));
        assert_eq!(of(0), 8.0);
        assert_eq!(of(12), 12.0, "but one that grows is in sight");
        assert_eq!(slowest([(2.27, false), (0.5, false)].into_iter()), 2.27);
        assert_eq!(slowest(std::iter::empty()), 0.0);
    }
}
