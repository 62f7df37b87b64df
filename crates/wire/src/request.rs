//! What is asked of a simulation: a change as people think of it, and the message that carries it with its document.

use std::ops::{Deref, DerefMut};

use control::{ExcitationError, Multisine};
use rotor::{C64, Settings};

use crate::document::{DocumentError, SettingsDocument};
use crate::message::RequestMessage;
use crate::ports::check_document;
use crate::{Text, WireError};

/// A request as it travels: the message, with the document that it names.
#[derive(Clone, Debug, Default)]
pub struct Request {
    message: RequestMessage,
    /// The text of the new settings' document; else empty.
    pub document: String,
}

impl Request {
    pub(crate) fn received(message: RequestMessage, document: &[u8]) -> Self {
        // What is no text has another hash, and is refused for it.
        Self { message, document: String::from_utf8_lossy(document).into_owned() }
    }

    /// The message.
    #[must_use]
    pub fn message(&self) -> RequestMessage {
        self.message
    }
}

impl Deref for Request {
    type Target = RequestMessage;

    fn deref(&self) -> &RequestMessage {
        &self.message
    }
}

impl DerefMut for Request {
    fn deref_mut(&mut self) -> &mut RequestMessage {
        &mut self.message
    }
}

/// A request that cannot be understood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RequestError {
    /// A kind that this version does not know.
    #[error("unknown request {0}")]
    Kind(u32),
    /// Settings that cannot be read.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// An excitation that cannot be read.
    #[error(transparent)]
    Excitation(#[from] ExcitationError),
}

/// A change as people think of it; [`Change::request`] packs it.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// New settings, whole, based on the revision that was looked at.
    Settings {
        /// The revision that was looked at.
        base_revision: u64,
        /// What shall be in force.
        settings: Settings,
    },
    /// A change of velocity of one mass.
    Impulse {
        /// The mass, counted from 0.
        mass: usize,
        /// The change, in `e_t` per unit of `tau`.
        velocity: C64,
    },
    /// Back to rest at `tau = 0`; a trip is reset.
    Restart,
    /// A marker with a note: it changes nothing, and stands in the log of events.
    Note {
        /// What it says: one line, at most [`Change::MAX_NOTE`] bytes.
        text: String,
    },
    /// Tones added to the loop's command for a while, so that it can be measured.
    Excite(Multisine),
    /// The excitation ends before its time.
    EndExcitation,
}

/// The kinds of [`Request::kind`] by name, from 1.
const KINDS: [&str; 6] = ["settings", "impulse", "restart", "note", "excitation", "end of excitation"];

impl Change {
    /// The longest note, in bytes.
    pub const MAX_NOTE: usize = 240;

    /// The message that asks for this, in the name of `who`, for the reason `why`, which may be empty.
    ///
    /// # Errors
    /// Settings, or a note, that do not fit in a message.
    pub fn request(&self, who: &str, why: &str) -> Result<Box<Request>, WireError> {
        let mut request = Box::<Request>::default();
        (request.who, request.why) = (Text::new(who), Text::new(why));
        match self {
            Self::Settings { base_revision, settings } => {
                request.kind = 1;
                request.base_revision = *base_revision;
                let document = SettingsDocument::of(settings);
                check_document(document.text())?;
                request.settings = document.hash();
                request.document = document.text().to_owned();
            }
            Self::Impulse { mass, velocity } => {
                request.kind = 2;
                request.mass = *mass as u32;
                request.impulse = [velocity.re, velocity.im];
            }
            Self::Restart => request.kind = 3,
            Self::Note { text } => {
                if text.len() > Self::MAX_NOTE {
                    let told = format!("a note of {} bytes: expected at most {}", text.len(), Self::MAX_NOTE);
                    return Err(WireError::DoesNotFit(told));
                }
                request.kind = 4;
                request.text = Text::new(text);
            }
            Self::Excite(multisine) => {
                request.kind = 5;
                request.text = Text::new(&multisine.to_string());
            }
            Self::EndExcitation => request.kind = 6,
        }
        Ok(request)
    }

    /// What a message asks for.
    ///
    /// # Errors
    /// A kind that this version does not know, or settings that cannot be read.
    pub fn of(request: &Request) -> Result<Self, RequestError> {
        Ok(match request.kind {
            1 => Self::Settings {
                base_revision: request.base_revision,
                settings: SettingsDocument::received(request.settings, request.document.as_bytes())?.get().clone(),
            },
            2 => Self::Impulse {
                mass: request.mass as usize,
                velocity: C64::new(request.impulse[0], request.impulse[1]),
            },
            3 => Self::Restart,
            4 => Self::Note { text: request.text.as_str().to_owned() },
            5 => Self::Excite(request.text.as_str().parse()?),
            6 => Self::EndExcitation,
            kind => return Err(RequestError::Kind(kind)),
        })
    }

    /// The settings that shall be in force, if it is about settings.
    #[must_use]
    pub fn settings(&self) -> Option<&Settings> {
        if let Self::Settings { settings, .. } = self { Some(settings) } else { None }
    }

    /// What a request of this kind asks for, in a word.
    #[must_use]
    pub fn kind_name(kind: u32) -> &'static str {
        (kind as usize).checked_sub(1).and_then(|at| KINDS.get(at)).copied().unwrap_or("unknown request")
    }

    /// The kind that has this name; 0 if none has.
    pub(crate) fn kind_of_name(name: &str) -> u32 {
        KINDS.iter().position(|kind| *kind == name).map_or(0, |at| at as u32 + 1)
    }
}

#[cfg(test)]
mod tests {
    use rotor::{Gain, builtin};

    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_and_what_is_not_understood_too() {
        let rotor = builtin::rotor("jeffcott").unwrap();
        let mut settings = Settings::new(&rotor, 1.0, builtin::feedback(&rotor, "off").unwrap());
        let change = Change::Settings { base_revision: 1, settings: settings.clone() };
        let request = change.request("me", "").unwrap();
        assert_eq!(Change::of(&request), Ok(change));
        let damaged = Request { document: request.document.replace("speed", "speck"), ..*request };
        assert!(matches!(Change::of(&damaged), Err(RequestError::Document(DocumentError::OtherHash { .. }))));
        settings.feedback.first_mut().signals[0].gains[0] =
            Gain::Table((0..9000).map(|i| (f64::from(i), 0.125)).collect());
        let refused = Change::Settings { base_revision: 1, settings }.request("me", "").unwrap_err().to_string();
        assert!(refused.ends_with("expected at most 65536"), "{refused}");
        let told = RequestMessage { kind: 5, text: Text::new("seed=1"), ..RequestMessage::default() };
        assert!(matches!(Change::of(&Request::received(told, &[])), Err(RequestError::Excitation(_))));
        let foreign = Request::received(RequestMessage { kind: 9, ..RequestMessage::default() }, &[]);
        assert_eq!(Change::of(&foreign), Err(RequestError::Kind(9)));
    }
}
