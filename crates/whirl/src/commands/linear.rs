//! What the commands on the linear rotor share: modes as scripts read them.

use rotor::{C64, Mode, Stability, Whirl};
use serde::Serialize;

use crate::failure::Failure;
use crate::machine_args::MachineArgs;
use crate::output;

/// Why `stable` is `null`.
pub(super) const MARGINAL: &str = "the real part is zero but for rounding";

/// How something stands, as scripts read it: `stable` is `null` where rounding decides, and `marginal` says so.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct StabilityDocument {
    stable: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stable_null: Option<&'static str>,
    marginal: bool,
}

impl From<Stability> for StabilityDocument {
    fn from(stability: Stability) -> Self {
        let marginal = stability == Stability::Marginal;
        Self { stable: stability.is_stable(), stable_null: marginal.then_some(MARGINAL), marginal }
    }
}

/// The stability in a word, loud where it is not stable.
pub(super) fn word(stability: Stability) -> &'static str {
    match stability {
        Stability::Stable => "stable",
        Stability::Marginal => "MARGINAL (zero but for rounding)",
        Stability::Unstable => "UNSTABLE",
    }
}

/// Why `log_dec` is `null`.
pub(super) const REAL_POLE: &str = "the pole is real: it does not whirl";

/// Says that a clearance which was asked for plays no part: the linear rotor has none.
pub(super) fn neglects(machine: &MachineArgs) {
    if machine.deadband.is_some_and(|clearance| clearance.number() != 0.0) {
        output::warn(
            "--deadband plays no part here: the linear rotor has none. `response`, `cycles` and `run` have it",
        );
    }
}

/// A complex number, as scripts read it.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct ComplexDocument {
    re: f64,
    im: f64,
}

impl From<C64> for ComplexDocument {
    fn from(z: C64) -> Self {
        Self { re: z.re, im: z.im }
    }
}

/// A pole and what it says, as scripts read it.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct PoleDocument {
    re: f64,
    im: f64,
    damping: f64,
    /// Whether the real part is zero but for rounding; it is then exactly zero here.
    marginal: bool,
    log_dec: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    log_dec_null: Option<&'static str>,
    frequency: f64,
    whirl: Whirl,
}

impl From<&Mode> for PoleDocument {
    fn from(mode: &Mode) -> Self {
        let log_dec = Some(mode.log_decrement()).filter(|d| d.is_finite());
        Self {
            re: mode.pole.re,
            im: mode.pole.im,
            damping: mode.damping(),
            marginal: mode.stability() == Stability::Marginal,
            log_dec,
            log_dec_null: log_dec.is_none().then_some(REAL_POLE),
            frequency: mode.frequency(),
            whirl: mode.whirl(),
        }
    }
}

impl From<rotor::TraceError> for Failure {
    fn from(error: rotor::TraceError) -> Self {
        match error {
            rotor::TraceError::Speeds => Self::Usage(error.to_string()),
            rotor::TraceError::Unresolved { .. } => Self::Work(error.to_string()),
            rotor::TraceError::Poles(error) => error.into(),
        }
    }
}
