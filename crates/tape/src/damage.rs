//! What is wrong with a file: where, of what kind, and which steps are lost with it.

use serde::{Serialize, Serializer};

/// What kind of damage it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DamageKind {
    /// A message whose checksum does not fit: something in it has been changed.
    Checksum,
    /// A message that cannot be decoded, in a file without checksums or from a program with a fault.
    Unreadable,
    /// Bytes that are no message, where one should be.
    Foreign,
    /// Zeros where a message should be.
    Zeros,
    /// The beginning of a message whose end is not there.
    Cut,
    /// Messages that should be there, by the numbers of those before and after.
    Missing,
    /// The end of the recording, by which viewers find their way, is not what was written.
    End,
    /// Steps that have been read before.
    Repeated,
    /// Another recording.
    Other,
}

impl DamageKind {
    /// Its name in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Checksum => "checksum",
            Self::Unreadable => "unreadable",
            Self::Foreign => "foreign",
            Self::Zeros => "zeros",
            Self::Cut => "cut",
            Self::Missing => "missing",
            Self::End => "end",
            Self::Repeated => "repeated",
            Self::Other => "other-recording",
        }
    }

    /// The same for people.
    fn words(self) -> &'static str {
        match self {
            Self::Checksum => "a message has been changed: its checksum does not fit",
            Self::Unreadable => "a message cannot be decoded",
            Self::Foreign => "no message where one should be",
            Self::Zeros => "zeros where messages should be",
            Self::Cut => "cut off within a message",
            Self::Missing => "messages are missing",
            Self::End => "the mark at the end is not what was written",
            Self::Repeated => "steps that have been there before",
            Self::Other => "another recording",
        }
    }
}

impl Serialize for DamageKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Steps that are lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LostSteps {
    /// The first of them.
    pub from: u64,
    /// How many.
    pub count: u64,
}

/// One place where a file is not what was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Damage {
    /// The file.
    pub file: String,
    /// Where it begins in the file.
    pub byte: u64,
    /// How many bytes of the file are not read for it; 0 where something is missing.
    pub bytes: u64,
    /// What kind it is.
    pub kind: DamageKind,
    /// The steps that are missing where it is; null if none are, or if there are none on file behind it to tell.
    pub steps: Option<LostSteps>,
}

impl Damage {
    /// In a file whose name follows when it is known.
    pub(crate) fn at(byte: u64, bytes: u64, kind: DamageKind) -> Self {
        Self { file: String::new(), byte, bytes, kind, steps: None }
    }

    /// How many places are told one by one.
    const TOLD: usize = 3;

    /// All of it in as few lines as tell it, the file before each if there are several.
    pub(crate) fn notices(damage: &[Self], of_several: bool) -> Vec<String> {
        let told = |damage: &Self| if of_several { format!("{}: {damage}", damage.file) } else { damage.to_string() };
        let mut notices: Vec<String> = damage.iter().take(Self::TOLD).map(told).collect();
        let rest = &damage[notices.len()..];
        if !rest.is_empty() {
            let bytes: u64 = rest.iter().map(|damage| damage.bytes).sum();
            let places = if rest.len() == 1 { "place" } else { "places" };
            notices.push(format!("damaged at {} more {places}, {bytes} bytes in all", rest.len()));
        }
        notices
    }
}

impl std::fmt::Display for Damage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { byte, bytes, kind, steps, .. } = self;
        write!(f, "damaged at byte {byte}: {}", kind.words())?;
        if *bytes > 0 {
            write!(f, "; {bytes} bytes are not read")?;
        }
        match steps {
            Some(LostSteps { from, count: 1 }) => write!(f, "; step {from} is lost"),
            Some(LostSteps { from, count }) => write!(f, "; steps {from} to {} are lost", from + count - 1),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damage_is_told_with_its_place_and_what_is_lost() {
        let lost = |from, count| Some(LostSteps { from, count });
        let changed = Damage { steps: lost(500, 250), ..Damage::at(306_670, 4096, DamageKind::Checksum) };
        assert_eq!(
            changed.to_string(),
            "damaged at byte 306670: a message has been changed: its checksum does not fit; 4096 bytes are not read; \
             steps 500 to 749 are lost"
        );
        let missing = Damage { steps: lost(7, 1), ..Damage::at(80, 0, DamageKind::Missing) };
        assert_eq!(missing.to_string(), "damaged at byte 80: messages are missing; step 7 is lost");
        let many = vec![changed; 5];
        let notices = Damage::notices(&many, false);
        assert_eq!(notices.len(), 4);
        assert_eq!(notices[3], "damaged at 2 more places, 8192 bytes in all");
        assert_eq!(
            serde_json::to_value(&missing).unwrap(),
            serde_json::json!({"file": "", "byte": 80, "bytes": 0, "kind": "missing", "steps": {"from": 7, "count": 1}})
        );
    }
}
