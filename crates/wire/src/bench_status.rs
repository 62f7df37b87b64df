//! A bench status as it is read: the message, with the documents that it names.

use std::ops::{Deref, DerefMut};

use rotor::{Rotor, RotorError};

use crate::Text;
use crate::document::{Document, RotorDocument, SettingsDocument};
use crate::message::BenchStatusMessage;

/// The whole slow picture of a bench: what the message says, the rotor and the settings. Their hashes in the message are
/// those of the documents here whenever it is sent.
#[derive(Clone, Debug, Default)]
pub struct BenchStatus {
    message: BenchStatusMessage,
    rotor: Option<RotorDocument>,
    /// The settings in force.
    pub settings: SettingsDocument,
}

impl BenchStatus {
    /// The spin speed when this was told, which may be on its way to the one that is set.
    #[must_use]
    pub fn present_speed(&self) -> f64 {
        if self.analysis.count > 0 { self.analysis.speed } else { self.settings.get().speed }
    }

    pub(crate) fn resolved(message: BenchStatusMessage, rotor: RotorDocument, settings: SettingsDocument) -> Self {
        Self { message, rotor: Some(rotor), settings }
    }

    /// The rotor that is simulated.
    ///
    /// # Errors
    /// It has not been told: a bench status that was not received.
    pub fn rotor(&self) -> Result<Rotor, RotorError> {
        match &self.rotor {
            Some(rotor) => Ok(rotor.get().clone()),
            None => Rotor::new("", vec![], vec![]),
        }
    }

    /// Its document.
    #[must_use]
    pub fn rotor_document(&self) -> Option<&RotorDocument> {
        self.rotor.as_ref()
    }

    /// Writes a rotor into it.
    pub fn set_rotor(&mut self, rotor: &Rotor) {
        self.message.rotor_name = Text::new(rotor.name());
        self.message.masses = rotor.len() as u32;
        self.message.scales = rotor.scales().map_or([0.0; 4], |s| [s.w0, s.k_t, s.m_t, s.e_t]);
        self.rotor = Some(Document::of(rotor));
    }

    /// The message, which names the documents.
    #[must_use]
    pub fn message(&self) -> BenchStatusMessage {
        let rotor = self.rotor.as_ref().map_or(0, Document::hash);
        BenchStatusMessage { rotor, settings: self.settings.hash(), ..self.message }
    }
}

impl From<BenchStatusMessage> for BenchStatus {
    fn from(message: BenchStatusMessage) -> Self {
        Self { message, ..Self::default() }
    }
}

impl Deref for BenchStatus {
    type Target = BenchStatusMessage;

    fn deref(&self) -> &BenchStatusMessage {
        &self.message
    }
}

impl DerefMut for BenchStatus {
    fn deref_mut(&mut self) -> &mut BenchStatusMessage {
        &mut self.message
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotor_survives_the_journey() {
        for name in rotor::builtin::ROTORS {
            let rotor = rotor::builtin::rotor(name).unwrap();
            let mut bench_status = BenchStatus::default();
            bench_status.set_rotor(&rotor);
            assert_eq!(bench_status.rotor().unwrap(), rotor);
            assert_eq!(bench_status.message().rotor, Document::of(&rotor).hash());
        }
        assert!(BenchStatus::default().rotor().is_err());
    }
}
