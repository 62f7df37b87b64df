//! What is told beside a map of starts and impulses: the exact orbits that they can lead to.

use std::sync::atomic::{AtomicBool, Ordering};

use rotor::Stability;
use serde::Serialize;
use study::map::{MapError, MapPlan, Reference, ReferenceKind};

use crate::failure::Failure;
use crate::output::rounded;
use crate::units::CommandUnits;

/// The exact orbits of the machine of a map, or why there are none.
#[derive(Debug, Default, Serialize)]
pub(super) struct Basins {
    /// Smallest first, of what is mapped.
    #[serde(skip_serializing_if = "Option::is_none")]
    exact: Option<Vec<ExactDocument>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    exact_null: Option<String>,
}

#[derive(Debug, Serialize)]
struct ExactDocument {
    /// `synchronous`, with the spin, or a limit `cycle` of the balanced rotor.
    kind: &'static str,
    /// The largest radius, or the control force, as the map has it.
    value: f64,
    frequency: f64,
    /// `null` where neither can be said, or it cannot be judged.
    stable: Option<bool>,
    #[serde(skip)]
    stands: &'static str,
}

impl Basins {
    /// Those of `plan`; none where the machine is not one, or something else is mapped.
    ///
    /// # Errors
    /// An interrupt.
    pub(super) fn of(plan: &MapPlan, stop: &AtomicBool) -> Result<Self, Failure> {
        match plan.references(&|| stop.load(Ordering::Relaxed)) {
            Ok(found) => {
                let exact = found.map(|all| all.iter().map(ExactDocument::of).collect());
                Ok(Self { exact, exact_null: None })
            }
            Err(_) if stop.load(Ordering::Relaxed) => Err(MapError::Interrupted.into()),
            // The map stands without them.
            Err(error) => Ok(Self { exact: None, exact_null: Some(error.to_string()) }),
        }
    }

    /// The same for people, `unit` being what one of what is mapped is in the unit that it is shown in.
    pub(super) fn text(&self, unit: f64, units: CommandUnits) -> String {
        if let Some(why) = &self.exact_null {
            return format!("exact orbits: none to compare with: {why}\n");
        }
        let Some(exact) = &self.exact else { return String::new() };
        if exact.is_empty() {
            return "exact orbits: none\n".to_owned();
        }
        let each = exact.iter().map(|orbit| {
            let stands = orbit.stands;
            let value = rounded(orbit.value * unit);
            match orbit.kind {
                "cycle" => {
                    let (frequency, unit) = (rounded(units.frequency(orbit.frequency)), units.pick("per tau", "Hz"));
                    format!("{value} {stands} (limit cycle at {frequency} {unit})")
                }
                _ => format!("{value} {stands}"),
            }
        });
        format!("exact orbits: {}\n", each.collect::<Vec<_>>().join(", "))
    }
}

impl ExactDocument {
    fn of(found: &Reference) -> Self {
        Self {
            kind: match found.kind {
                ReferenceKind::Synchronous => "synchronous",
                ReferenceKind::Cycle => "cycle",
            },
            value: found.value,
            frequency: found.frequency,
            stable: found.stability.and_then(Stability::is_stable),
            stands: match found.stability {
                Some(Stability::Stable) => "stable",
                Some(Stability::Unstable) => "unstable",
                Some(Stability::Marginal) => "marginal",
                None => "of unknown stability",
            },
        }
    }
}
