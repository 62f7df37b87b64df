//! Settings that are asked for anew as long as somebody else's change comes between looking and asking.

use std::time::Duration;

use rotor::Settings;
use wire::{Answer, Change, Commander, SharedMemory, WireError};

use crate::failure::Failure;

/// How long the bench may take to answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// How often a change is tried.
const TRIES: usize = 5;

/// Who asks for settings, why, and how often it has been in vain.
pub(crate) struct SettingsRequest<'a> {
    who: &'a str,
    why: &'a str,
    tries: usize,
}

/// Why settings are not in force, as far as is known.
pub(crate) enum NotAccepted {
    /// No answer came: they may yet be.
    Unanswered(WireError),
    /// The bench says why.
    Refused(String),
    /// They could not be asked for.
    Failed(Failure),
}

impl<'a> SettingsRequest<'a> {
    pub(crate) fn new(who: &'a str, why: &'a str) -> Self {
        Self { who, why, tries: 0 }
    }

    /// Asks for `settings`, which were made of those of a revision; `None` where that is no longer in force: they are to be made anew of
    /// the newest.
    ///
    /// # Errors
    /// A refusal, which others' changes are too when they have come between too often; silence.
    pub(crate) fn ask(
        &mut self,
        commander: &mut <SharedMemory as wire::Carrier>::Commander,
        base_revision: u64,
        settings: Settings,
    ) -> Result<Option<Answer>, NotAccepted> {
        let failed = |error: WireError| NotAccepted::Failed(error.into());
        let request = Change::Settings { base_revision, settings }.request(self.who, self.why).map_err(failed)?;
        let answer = commander.ask(&request, PATIENCE).map_err(|error| match error {
            silence @ WireError::NoAnswer(_) => NotAccepted::Unanswered(silence),
            error => failed(error),
        })?;
        self.tries += 1;
        match answer.is_accepted() {
            true => Ok(Some(answer)),
            false if answer.outdated != 0 && self.tries < TRIES => Ok(None),
            false => Err(NotAccepted::Refused(answer.reason.as_str().to_owned())),
        }
    }
}
