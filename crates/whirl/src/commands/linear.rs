//! What the commands on the linear rotor share: sweeps over speed, and modes as scripts read them.

use rotor::{C64, Feedback, Mode, Rotor, Whirl};
use serde::Serialize;

use crate::catalog::{self, Machine};
use crate::cli::MachineArgs;
use crate::failure::Failure;
use crate::range::Range;

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

/// The machine of a sweep, every speed of which must be allowed.
///
/// # Errors
/// A machine that cannot be made, or a speed out of range.
pub(super) fn swept(args: &MachineArgs, over: Range) -> Result<(Rotor, Feedback), Failure> {
    Machine::open(args, Some(over.from), catalog::Default::Analysis)?;
    let Machine { rotor, settings } = Machine::open(args, Some(over.to), catalog::Default::Analysis)?;
    Ok((rotor, settings.feedback))
}

impl From<rotor::TraceError> for Failure {
    fn from(error: rotor::TraceError) -> Self {
        match error {
            rotor::TraceError::Speeds => Self::Usage(error.to_string()),
            rotor::TraceError::Poles(error) => error.into(),
        }
    }
}
