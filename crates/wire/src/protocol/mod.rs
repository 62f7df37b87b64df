//! How a program that knows nothing of this crate finds and reads a bench: the table of services, with their patterns, types and sizes.
//!
//! [`page`] is the same for people: `docs/book/src/protocol.md`, which a test keeps in step with the tables.

mod page;

use iceoryx2::prelude::ipc;
use iceoryx2::service::messaging_pattern::MessagingPattern;
use iceoryx2::service::service_hash::ServiceHash;
use iceoryx2::service::service_name::ServiceName;

pub use page::page;

use crate::control::CONTROL_BUFFERED;
use crate::iceoryx::{MAX_PARTIES, MAX_READERS, internal};
use crate::{BenchName, DOCUMENTS_KEPT, EVENTS_KEPT, MAX_BURST, MAX_DOCUMENT, MAX_SNAPSHOT, Topic, WireError};

/// The version of iceoryx2 that carries the messages.
pub const ICEORYX2: &str = "0.10";
/// The attribute of the service `state` that has the schema.
pub const SCHEMA_ATTRIBUTE: &str = "whirl.schema";

/// How the messages of a service travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// From one to many.
    PublishSubscribe,
    /// A question and its answer.
    RequestResponse,
    /// A bell.
    Event,
}

impl Pattern {
    /// As iceoryx2 calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PublishSubscribe => "publish-subscribe",
            Self::RequestResponse => "request-response",
            Self::Event => "event",
        }
    }
}

/// What a message is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Payload {
    /// Nothing.
    None,
    /// One of this type: see [`crate::header::messages`].
    One(&'static str),
    /// A slice of these, at most so many.
    Slice(&'static str, usize),
}

/// A service of a bench, as other programs need it.
#[derive(Clone, Copy, Debug)]
pub struct Service {
    /// Which one.
    pub topic: Topic,
    /// How its messages travel.
    pub pattern: Pattern,
    /// What a message is, or a question.
    pub payload: Payload,
    /// The type of the user header before it, if there is one.
    pub header: Option<&'static str>,
    /// The type of the answer to a question.
    pub answer: Option<&'static str>,
    /// Messages that wait for a reader that sleeps: of more, the oldest are lost.
    pub buffered: usize,
    /// Messages that reach a reader that comes late.
    pub kept: usize,
    /// How many may read it, or ask.
    pub parties: usize,
    /// Who sends.
    pub from: &'static str,
    /// What it carries.
    pub meaning: &'static str,
}

/// A service from the bench to its readers.
const fn published(topic: Topic, payload: Payload, header: Option<&'static str>, meaning: &'static str) -> Service {
    Service {
        topic,
        pattern: Pattern::PublishSubscribe,
        payload,
        header,
        answer: None,
        buffered: 4,
        kept: 1,
        parties: MAX_PARTIES,
        from: "bench",
        meaning,
    }
}

/// Every service of a bench.
pub const SERVICES: [Service; 10] = [
    Service {
        buffered: crate::shared_memory::BURSTS_BUFFERED,
        kept: 0,
        parties: MAX_READERS,
        ..published(
            Topic::State,
            Payload::Slice("u64", MAX_BURST * crate::MAX_WIDTH),
            None,
            "every step, in order, a row of words each; those that fall due together in one message",
        )
    },
    Service {
        buffered: DOCUMENTS_KEPT,
        kept: DOCUMENTS_KEPT,
        ..published(
            Topic::Document,
            Payload::Slice("u8", MAX_DOCUMENT),
            Some("whirl.DocumentHead"),
            "rotor and settings as TOML text, before the first message that names them by hash",
        )
    },
    published(
        Topic::Status,
        Payload::One("whirl.BenchStatus"),
        None,
        "how the bench stands: rotor, settings, poles, pace; on change and ten times a second",
    ),
    Service {
        buffered: EVENTS_KEPT,
        kept: EVENTS_KEPT,
        parties: MAX_READERS,
        ..published(
            Topic::Event,
            Payload::One("whirl.Event"),
            None,
            "what happens, numbered, with the settings in force after it",
        )
    },
    Service {
        buffered: crate::snapshot::SNAPSHOTS_BUFFERED,
        parties: MAX_READERS,
        ..published(
            Topic::Snapshot,
            Payload::Slice("u64", MAX_SNAPSHOT),
            Some("whirl.SnapshotHead"),
            "all that decides how the machine goes on, at every change and once a second; words for a machine of the same version",
        )
    },
    Service {
        from: "recorder",
        ..published(
            Topic::Recorder,
            Payload::One("whirl.RecorderStatus"),
            None,
            "how a recorder stands, at least once a second",
        )
    },
    Service {
        pattern: Pattern::RequestResponse,
        header: Some("whirl.Request"),
        answer: Some("whirl.Answer"),
        buffered: 2,
        kept: 0,
        from: "client",
        ..published(
            Topic::Command,
            Payload::Slice("u8", MAX_DOCUMENT),
            None,
            "a change that is asked for; the text of new settings, or nothing, behind the request",
        )
    },
    Service {
        pattern: Pattern::Event,
        buffered: 0,
        kept: 0,
        from: "client",
        ..published(
            Topic::Wake,
            Payload::None,
            None,
            "tells the bench that a request waits, which it would find within a tenth of a second",
        )
    },
    Service {
        buffered: CONTROL_BUFFERED,
        parties: MAX_READERS,
        ..published(
            Topic::Reading,
            Payload::One("whirl.Readings"),
            None,
            "what the sensors read, at every sample, for a controller outside: where the loop has `external`",
        )
    },
    Service {
        buffered: CONTROL_BUFFERED,
        kept: 0,
        parties: 1,
        from: "controller",
        ..published(
            Topic::Control,
            Payload::One("whirl.ControlCommand"),
            None,
            "its commands; whoever has the one place to send them controls the bench",
        )
    },
];

impl Service {
    /// Its name for a bench: `whirl/default/state`.
    #[must_use]
    pub fn name(&self, bench: &BenchName) -> String {
        format!("whirl/{bench}/{}", self.topic)
    }

    /// The name that iceoryx2 makes of it for its files: in the folder `services` of its root, behind the prefix and before `.service`.
    ///
    /// # Errors
    /// Never for the name of a bench.
    pub fn hash(&self, bench: &BenchName) -> Result<String, WireError> {
        let name = ServiceName::new(&self.name(bench)).map_err(internal)?;
        let pattern = match self.pattern {
            Pattern::PublishSubscribe => MessagingPattern::PublishSubscribe,
            Pattern::RequestResponse => MessagingPattern::RequestResponse,
            Pattern::Event => MessagingPattern::Event,
        };
        Ok(ServiceHash::new::<<ipc::Service as iceoryx2::service::Service>::ServiceNameHasher>(&name, pattern)
            .to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::header;

    #[test]
    fn every_topic_has_its_row_and_every_type_its_table() {
        assert_eq!(SERVICES.map(|service| service.topic), Topic::ALL);
        let known: Vec<&str> = header::messages().iter().map(|message| message.name).collect();
        for service in SERVICES {
            let payload = match service.payload {
                Payload::One(name) => Some(name),
                Payload::None | Payload::Slice(..) => None,
            };
            for name in [payload, service.header, service.answer].into_iter().flatten() {
                assert!(known.contains(&name), "{name}");
            }
        }
    }

    #[test]
    fn val_a_hash_names_the_very_file_that_iceoryx2_makes() {
        use crate::{Carrier, Root, SharedMemory};

        let folder = tempfile::tempdir().unwrap();
        let root = Root::at(folder.path()).unwrap();
        let bench: BenchName = "hashed".parse().unwrap();
        let carrier = SharedMemory::new(&root, "sim").unwrap();
        let _host = carrier.host(&bench).unwrap();
        let files: Vec<String> = std::fs::read_dir(root.iceoryx2().join("services"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        // All but the recorder's, which a recorder or a reader makes.
        for service in SERVICES.iter().filter(|service| service.topic != Topic::Recorder) {
            let name = format!("{}{}.service", root.prefix(), service.hash(&bench).unwrap());
            assert!(files.contains(&name), "{name} of {}: {files:?}", service.topic);
        }
    }
}
