//! What the commands on the linear rotor share: modes as scripts read them.

use rotor::{C64, Mode, Whirl};
use serde::Serialize;

use crate::failure::Failure;

/// Why `log_dec` is `null`.
pub(super) const REAL_POLE: &str = "the pole is real: it does not whirl";

/// A complex number, as scripts read it.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Part {
    re: f64,
    im: f64,
}

impl From<C64> for Part {
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
