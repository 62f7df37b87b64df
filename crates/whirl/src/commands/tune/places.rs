//! Masses of a chain that carry the control bearing and the sensors, as typed.

use rotor::Rotor;
use tuner::choices;

use super::typed::Places;
use crate::failure::Failure;

/// Masses for the bearing to choose from, counted from 0.
///
/// # Errors
/// Masses that the rotor does not have, or several at once.
pub(super) fn bearings(typed: Option<&Places>, rotor: &Rotor) -> Result<Vec<usize>, Failure> {
    let bearings = masses(typed.unwrap_or(&Places::These(vec![1])), rotor, "bearing")?;
    if bearings.iter().any(|chosen| chosen.len() != 1) {
        return Err(Failure::Usage("--bearing: there is one control bearing: expected one mass, or any".into()));
    }
    Ok(bearings.into_iter().flatten().collect())
}

/// Sensor sets to choose from; empty for the default of each bearing, and with shaft elements, whose places have names.
///
/// # Errors
/// Masses that the rotor does not have.
pub(super) fn sensors(typed: Option<&Places>, rotor: &Rotor) -> Result<Vec<Vec<usize>>, Failure> {
    match typed {
        Some(typed) if rotor.is_chain() => masses(typed, rotor, "sensors"),
        _ => Ok(Vec::new()),
    }
}

/// The sensors that are taken if none are named: the bearing's own mass and the next.
pub(super) fn neighbours(bearing: usize, masses: usize) -> Vec<usize> {
    match masses {
        1 => vec![0],
        _ if bearing + 1 < masses => vec![bearing, bearing + 1],
        _ => vec![bearing - 1, bearing],
    }
}

/// Every set of masses that `typed` means, counted from 0.
fn masses(typed: &Places, rotor: &Rotor, option: &str) -> Result<Vec<Vec<usize>>, Failure> {
    let n = rotor.len();
    match typed {
        Places::These(masses) => match masses.iter().find(|&&mass| mass > n) {
            Some(mass) => {
                Err(Failure::Usage(format!("--{option}: no mass {mass}: {} has masses 1 to {n}", rotor.name())))
            }
            None => Ok(vec![masses.iter().map(|mass| mass - 1).collect()]),
        },
        Places::Named(names) => Err(Failure::Usage(format!(
            "--{option}: '{}': expected masses counted from 1 such as 1,2, or any, or any:2",
            names.join(",")
        ))),
        Places::Any(count) if *count > n => {
            Err(Failure::Usage(format!("--{option} any:{count}: {} has only {n} masses", rotor.name())))
        }
        Places::Any(count) => Ok(choices(n, *count)),
    }
}
