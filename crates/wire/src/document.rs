//! Documents: what is large and seldom changes (the rotor, the settings), sent once when it changes and named by a hash of
//! its text everywhere else.
//!
//! A document is text that other languages read too: the rotor is a rotor file, the settings are a TOML table whose
//! `feedback` is the text of a feedback file. Numbers are written so that they read back to the last bit, `inf` and `nan` too.

use iceoryx2::prelude::ZeroCopySend;

use crate::wire_struct::message;

use std::fmt::Write as _;
use std::sync::Arc;

use rotor::file::{read_feedback, read_rotor, write_feedback, write_rotor};
use rotor::{Feedback, Rotor, Settings};
use text::as_number;
use text::number::toml as number;
use toml::de::DeTable;

/// Bytes of the largest document.
pub const MAX_DOCUMENT: usize = 1 << 16;
/// Documents that reach readers that come late, and that wait for one that sleeps: all that the last events and the last
/// bench status name are among them (see [`crate::delivery`]).
pub const DOCUMENTS_KEPT: usize = 96;

message! {
    "whirl.DocumentHead"
    /// What stands before the text of a document.
    pub struct DocumentHead {
        /// Its name: FNV-1a, 64 bits, of the text.
        pub hash: u64,
        /// 1 a rotor, 2 settings.
        pub kind: u32,
        /// Always 0.
        pub reserved: u32,
    }
}

/// A document that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DocumentError {
    /// It is not UTF-8.
    #[error("a document that is no text")]
    NoText,
    /// It is not what its name says.
    #[error("a document that is damaged: its hash is {found:016x}, expected {expected:016x}")]
    OtherHash {
        /// The hash of the text.
        found: u64,
        /// The one that it was sent with.
        expected: u64,
    },
    /// The rotor, or the feedback among the settings, is not one.
    #[error("{0}")]
    Faults(text::Faults),
    /// The settings are no TOML.
    #[error("settings that are no TOML")]
    NoToml,
    /// The settings lack something.
    #[error("settings without {0}")]
    Lacks(&'static str),
}

/// What can be a document.
pub trait Content: Clone {
    /// Its number in [`DocumentHead::kind`].
    const KIND: u32;

    /// Its text.
    fn write(&self) -> String;

    /// What a text says.
    ///
    /// # Errors
    /// It is no such document.
    fn read(text: &str) -> Result<Self, DocumentError>;
}

/// A document with its name. Clones share it.
#[derive(Clone, Debug)]
pub struct Document<T> {
    hash: u64,
    text: Arc<str>,
    content: Arc<T>,
}

/// The rotor of a run.
pub type RotorDocument = Document<Rotor>;
/// Settings, whole.
pub type SettingsDocument = Document<Settings>;

impl<T: Content> Document<T> {
    /// The document of this content.
    #[must_use]
    pub fn of(content: &T) -> Self {
        let text = content.write();
        Self { hash: hash_of(text.as_bytes()), text: text.into(), content: Arc::new(content.clone()) }
    }

    /// The document that was sent as these bytes.
    ///
    /// # Errors
    /// It is damaged, or no such document.
    pub fn received(expected: u64, bytes: &[u8]) -> Result<Self, DocumentError> {
        let found = hash_of(bytes);
        if found != expected {
            return Err(DocumentError::OtherHash { found, expected });
        }
        let text = std::str::from_utf8(bytes).map_err(|_| DocumentError::NoText)?;
        Ok(Self { hash: found, text: text.into(), content: Arc::new(T::read(text)?) })
    }

    /// What it says.
    #[must_use]
    pub fn get(&self) -> &T {
        &self.content
    }

    /// Its name.
    #[must_use]
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// Its text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    pub(crate) fn head(&self) -> DocumentHead {
        DocumentHead { hash: self.hash, kind: T::KIND, reserved: 0 }
    }
}

impl<T> PartialEq for Document<T> {
    fn eq(&self, other: &Self) -> bool {
        self.hash == other.hash
    }
}

/// Settings of no machine, for who has none to tell of.
impl Default for SettingsDocument {
    fn default() -> Self {
        Self::of(&Settings {
            speed: 0.0,
            deadband: vec![],
            trip: 0.0,
            ramp: f64::INFINITY,
            coast_down: 0.0,
            feedback: Feedback { bearings: vec![] },
            unbalance_added: vec![],
        })
    }
}

impl Content for Rotor {
    const KIND: u32 = 1;

    fn write(&self) -> String {
        write_rotor(self)
    }

    fn read(text: &str) -> Result<Self, DocumentError> {
        read_rotor(text, "").map_err(DocumentError::Faults)
    }
}

impl Content for Settings {
    const KIND: u32 = 2;

    fn write(&self) -> String {
        let Self { speed, trip, ramp, coast_down, deadband, feedback, unbalance_added } = self;
        let list = |numbers: &[f64]| numbers.iter().copied().map(number).collect::<Vec<_>>().join(", ");
        let clearances = list(deadband);
        // As many as the weights say: whether that fits the rotor is for who checks them.
        let masses = feedback.signals().next().map_or(deadband.len(), |signal| signal.displacement.len());
        let mut text = String::new();
        for (key, value) in [("speed", *speed), ("trip", *trip), ("ramp", *ramp)] {
            let _ = writeln!(text, "{key} = {}", number(value));
        }
        let _ = writeln!(text, "deadband = [{clearances}]");
        // What is not there is not told, so that whoever knows nothing of it can read the rest.
        if *coast_down != 0.0 {
            let _ = writeln!(text, "coast_down = {}", number(*coast_down));
        }
        if unbalance_added.len() != deadband.len() || unbalance_added.iter().any(|added| *added != 0.0) {
            let _ = writeln!(text, "unbalance_added = [{}]", list(unbalance_added));
        }
        let _ = writeln!(text, "masses = {masses}\nfeedback = '''");
        text + &write_feedback(feedback) + "'''\n"
    }

    fn read(text: &str) -> Result<Self, DocumentError> {
        let table = DeTable::parse(text).map_err(|_| DocumentError::NoToml)?;
        let table = table.get_ref();
        let value = |key: &'static str| table.get(key).ok_or(DocumentError::Lacks(key));
        let number = |key| value(key).and_then(|value| as_number(value).ok_or(DocumentError::Lacks(key)));
        let list = |key: &'static str| -> Result<Vec<f64>, DocumentError> {
            let list = value(key)?.get_ref().as_array().ok_or(DocumentError::Lacks(key))?;
            list.iter().map(|value| as_number(value).ok_or(DocumentError::Lacks(key))).collect()
        };
        let deadband = list("deadband")?;
        let unbalance_added = match table.contains_key("unbalance_added") {
            true => list("unbalance_added")?,
            false => vec![0.0; deadband.len()],
        };
        let masses = number("masses")? as usize;
        let feedback = value("feedback")?.get_ref().as_str().ok_or(DocumentError::Lacks("feedback"))?;
        Ok(Self {
            speed: number("speed")?,
            trip: number("trip")?,
            ramp: number("ramp")?,
            coast_down: if table.contains_key("coast_down") { number("coast_down")? } else { 0.0 },
            deadband,
            feedback: read_feedback(feedback, Some(masses)).map_err(DocumentError::Faults)?,
            unbalance_added,
        })
    }
}

/// FNV-1a, 64 bits: stable over versions and machines, unlike the standard hasher, and a few lines in any language. To tell things apart, not
/// to keep secrets.
#[must_use]
pub fn hash_of(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use control::Parts;
    use rotor::{Filter, Gain, builtin};

    use super::*;

    fn survives(settings: &Settings) {
        let sent = Document::of(settings);
        let read = SettingsDocument::received(sent.hash(), sent.text().as_bytes()).unwrap();
        assert_eq!((read.get(), read.hash()), (settings, sent.hash()), "{}", sent.text());
    }

    #[test]
    fn settings_survive_the_journey() {
        for name in builtin::ROTORS {
            let rotor = builtin::rotor(name).unwrap();
            for feedback in builtin::feedback_names(&rotor) {
                let mut settings = Settings::new(&rotor, 0.1 + 0.2, builtin::feedback(&rotor, feedback).unwrap());
                survives(&settings);
                settings.deadband[0] = 1.0 / 3.0;
                settings.feedback.first_mut().signals[0].gains[0] =
                    Gain::Linear { at_zero: -0.0, slope: f64::MIN_POSITIVE };
                settings.feedback.first_mut().signals[0].gains[1] = Gain::Table(vec![(0.0, 1.0), (2.0, 1e-17)]);
                (settings.ramp, settings.coast_down) = (0.25, 0.1 + 0.2);
                settings.unbalance_added[0] = 1.0 / 7.0;
                let read = (0..settings.deadband.len()).find(|at| settings.feedback.first().senses(*at));
                let sensor_at = read.map_or(0.0, |at| (at + 1) as f64);
                let faults = Parts { sensor_gain: 0.1, sensor_at, amplifier_y: 0.0, ..Parts::default() };
                let parts = Parts { delay: 0.02, limit: 20.0, seed: 3.0, ..faults };
                settings.feedback = settings.feedback.with_parts(parts);
                settings.feedback.first_mut().filters = vec![Filter::SynchronousNotch { width: 0.1 }];
                settings.feedback.first_mut().signals[0].filters = vec![
                    Filter::Lowpass { corner: 8.0, order: 3 },
                    Filter::Lead { zero: 1.0, pole: 2.0 },
                    Filter::Notch { frequency: 3.0, width: 0.2 },
                    Filter::Integrator { rate: 0.1 },
                    Filter::Derivative { corner: 9.0 },
                    Filter::Transfer { numerator: vec![1.0; 9], denominator: vec![2.0; 9] },
                ];
                survives(&settings);
            }
        }
    }

    #[test]
    fn what_a_check_will_refuse_arrives_to_be_refused() {
        let rotor = builtin::rotor("three-mass").unwrap();
        let mut settings = Settings::new(&rotor, f64::NAN, builtin::feedback(&rotor, "composite").unwrap());
        settings.deadband.pop();
        let sent = Document::of(&settings);
        let read = SettingsDocument::received(sent.hash(), sent.text().as_bytes()).unwrap();
        assert!(read.get().speed.is_nan() && read.get().deadband.len() == 2);
    }

    #[test]
    fn rotors_survive_the_journey_with_their_physical_numbers() {
        let mass = rotor::PhysicalMass { mass: 2.0, bearing_stiffness: 5e5, unbalance: 1e-5, ..Default::default() };
        let si = Rotor::from_si("si", vec![mass; 2], vec![1e6], None).unwrap();
        for rotor in builtin::ROTORS.into_iter().map(|name| builtin::rotor(name).unwrap()).chain([si]) {
            let sent = Document::of(&rotor);
            let read = RotorDocument::received(sent.hash(), sent.text().as_bytes()).unwrap();
            assert_eq!((read.get(), read.get().scales()), (&rotor, rotor.scales()));
        }
    }

    #[test]
    fn what_is_damaged_or_something_else_is_told() {
        let sent = SettingsDocument::default();
        let mut bytes = sent.text().as_bytes().to_vec();
        bytes[8] ^= 1;
        let told = |read: Result<SettingsDocument, DocumentError>| read.unwrap_err();
        assert!(matches!(told(Document::received(sent.hash(), &bytes)), DocumentError::OtherHash { .. }));
        let sent_as = |bytes: &[u8]| told(Document::received(hash_of(bytes), bytes));
        assert_eq!(sent_as(&[0xff]), DocumentError::NoText);
        assert_eq!(sent_as(b"speed = "), DocumentError::NoToml);
        assert_eq!(sent_as(b"speed = 1"), DocumentError::Lacks("deadband"));
        assert!(matches!(RotorDocument::received(hash_of(b""), b""), Err(DocumentError::Faults(_))));
    }
}
