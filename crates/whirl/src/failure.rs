//! Every way a command can fail, and the exit code it means.

use std::io::Write;
use std::process::ExitCode;

/// Every exit code, and what it means.
pub const EXIT_CODES: &[(u8, &str)] = &[
    (0, "done"),
    (1, "the work failed, or a change was refused"),
    (2, "the command line or a file is wrong"),
    (3, "no such bench, or it is taken"),
    (130, "interrupted; sim, which runs until it is ended, ends with 0"),
];

/// Every variable of the environment that counts, and what it does.
pub const ENVIRONMENT: &[(&str, &str)] = &[
    (
        "WHIRL_ROOT",
        "the folder of shared memory; else whirl in XDG_RUNTIME_DIR, else whirl-UID in the temporary folder (TMPDIR, else /tmp)",
    ),
    ("WHIRL_LOG", "a log, such as debug: of dashboards in a file that whirl status names, of the rest on stderr"),
    ("NO_COLOR", "no colours"),
    ("COLORTERM", "truecolor or 24bit: the themes full and colour-blind have all their colours"),
];

/// Why a command did not do what was asked.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The work itself failed: exit code 1.
    #[error("{0}")]
    Work(String),
    /// The command line or a file is wrong: exit code 2.
    #[error("{0}")]
    Usage(String),
    /// No such bench, or it is taken: exit code 3.
    #[error("{0}")]
    Bench(String),
    /// A signal ended it: exit code 130.
    #[error("interrupted")]
    Interrupted,
    /// The reader of our output went away, as `head` does: not an error.
    #[error("output closed")]
    OutputClosed,
}

impl Failure {
    /// The exit code that scripts rely on.
    #[must_use]
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::OutputClosed => 0,
            Self::Work(_) => 1,
            Self::Usage(_) => 2,
            Self::Bench(_) => 3,
            Self::Interrupted => 130,
        }
    }

    /// Says it on stderr, once, and gives the exit code.
    #[must_use]
    pub(crate) fn report(&self) -> ExitCode {
        if !matches!(self, Self::OutputClosed | Self::Interrupted) {
            // If stderr is gone too, the exit code still tells.
            let _ = writeln!(std::io::stderr(), "whirl: {self}");
        }
        ExitCode::from(self.code())
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            Self::OutputClosed
        } else {
            Self::Work(format!("cannot write the output: {error}"))
        }
    }
}

impl From<rotor::SettingsError> for Failure {
    fn from(error: rotor::SettingsError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<machine::ProgramError> for Failure {
    fn from(error: machine::ProgramError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<machine::PolesError> for Failure {
    fn from(error: machine::PolesError) -> Self {
        Self::Work(error.to_string())
    }
}

impl From<rotor::PoleError> for Failure {
    fn from(error: rotor::PoleError) -> Self {
        Self::Work(error.to_string())
    }
}

impl From<rotor::circular::CircularError> for Failure {
    fn from(error: rotor::circular::CircularError) -> Self {
        use rotor::circular::CircularError;
        match error {
            CircularError::Stopped => Self::Interrupted,
            CircularError::Sampled | CircularError::Feedback(_) => Self::Usage(error.to_string()),
            CircularError::Poles(_) | CircularError::Roots(_) | CircularError::NotTried(_) => {
                Self::Work(error.to_string())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_failure_has_its_code_in_the_table() {
        let told = String::new;
        let all = [
            Failure::OutputClosed,
            Failure::Work(told()),
            Failure::Usage(told()),
            Failure::Bench(told()),
            Failure::Interrupted,
        ];
        assert_eq!(
            all.map(|failure| failure.code()).as_slice(),
            EXIT_CODES.iter().map(|(code, _)| *code).collect::<Vec<_>>()
        );
    }
}
