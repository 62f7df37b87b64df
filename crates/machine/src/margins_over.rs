//! Margins over a range of speeds: the worst of each, and where.

use rotor::{Rotor, Settings};

use crate::margins::{MachineMargins, MarginsError, margins};

/// A speed is pinned down to this part of the distance of two speeds looked at.
const PINNED: f64 = 1e-7;
/// How far inside the range, likewise, it is asked whether an end of it is the worst.
const INSIDE: f64 = 1e-3;

/// What can be worst, each where it is.
pub const WORST: [&str; 8] =
    ["delay", "gain up", "gain down", "phase", "sensitivity", "axis", "complementary", "force"];

/// How much of a margin there is: less is worse. `None` where there is no such margin.
#[must_use]
pub fn in_hand(kind: usize, found: &MachineMargins) -> Option<f64> {
    let margins = &found.margins;
    match kind {
        0 => margins.delay.map(|delay| delay.delay),
        1 => margins.gain_up.map(|gain| gain.factor),
        2 => margins.gain_down.map(|gain| -gain.factor),
        3 => margins.phase.map(|phase| phase.angle),
        4 => Some(-margins.sensitivity().amplitude),
        5 => Some(-margins.axis.amplitude),
        6 => Some(-margins.complementary.amplitude),
        _ => Some(-found.force.amplitude).filter(|value| value.is_finite()),
    }
}

/// The worst of every margin over `speeds`, which rise, and between them next to the worst: for each of [`WORST`] all margins
/// at the speed where it is, `None` where there is none at any.
///
/// # Errors
/// A speed at which the machine is not stable, or poles that cannot be had.
pub fn worst_margins(
    rotor: &Rotor,
    settings: &Settings,
    speeds: &[f64],
) -> Result<[Option<MachineMargins>; WORST.len()], MarginsError> {
    worst_among(rotor, settings, speeds, &margins_at(rotor, settings, speeds)?)
}

/// All margins at each of `speeds`.
///
/// # Errors
/// A speed at which the machine is not stable, or poles that cannot be had.
pub fn margins_at(rotor: &Rotor, settings: &Settings, speeds: &[f64]) -> Result<Vec<MachineMargins>, MarginsError> {
    speeds.iter().map(|speed| margins(rotor, settings, *speed)).collect()
}

/// [`worst_margins`], of those that [`margins_at`] has found at the same speeds.
///
/// # Errors
/// As for [`worst_margins`].
pub fn worst_among(
    rotor: &Rotor,
    settings: &Settings,
    speeds: &[f64],
    all: &[MachineMargins],
) -> Result<[Option<MachineMargins>; WORST.len()], MarginsError> {
    let mut worst = [const { None }; WORST.len()];
    for (kind, place) in worst.iter_mut().enumerate() {
        let known = all.iter().enumerate().filter_map(|(at, found)| Some((at, in_hand(kind, found)?)));
        let Some((at, value)) = known.min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
        *place = Some(all[at].clone());
        let ends = [at.saturating_sub(1), (at + 1).min(all.len() - 1)].map(|k| speeds[k]);
        let width = ends[1] - ends[0];
        if width == 0.0 {
            continue;
        }
        let mut best = value;
        let mut look = |speed: f64| -> Result<f64, MarginsError> {
            let found = margins(rotor, settings, speed)?;
            let value = in_hand(kind, &found).unwrap_or(f64::INFINITY);
            if value < best {
                (best, *place) = (value, Some(found));
            }
            Ok(value)
        };
        // Worst at an end of the range, if it is better a little inside.
        let inside = match at {
            0 => Some(ends[0] + INSIDE * width),
            _ if at + 1 == all.len() => Some(ends[1] - INSIDE * width),
            _ => None,
        };
        let is_at_end = inside.map(&mut look).transpose()?.is_some_and(|inside| inside >= value);
        if !is_at_end {
            linear::least(ends, PINNED * width, look)?;
        }
    }
    Ok(worst)
}
