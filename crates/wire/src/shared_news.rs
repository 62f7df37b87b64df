//! Documents, bench statuses, events and the recorder's status over shared memory: the services of a bench that carry news, not
//! motion.

use std::time::Duration;

use iceoryx2::node::NodeView;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::publish_subscribe;

use crate::delivery::SentDocuments;
use crate::document::{Content, DOCUMENTS_KEPT, Document, DocumentHead, MAX_DOCUMENT};
use crate::iceoryx::{Ipc, MAX_NODES, MAX_PARTIES, MAX_READERS, internal, opened, port, service};
use crate::message::BenchStatusMessage;
use crate::name_lock::NameLock;
use crate::ports::{check_document, check_snapshot};
use crate::snapshot::{MAX_SNAPSHOT, SNAPSHOTS_BUFFERED, SnapshotHead};
use crate::{
    BenchName, BenchStatus, EVENTS_KEPT, Event, EventMessage, NewsSender, RecorderSender, RecorderStatus, Root, Topic,
    WireError,
};

/// The node name of a recorder's status: its process lives as long as the node does, and the kernel drops its locks.
pub(crate) const RECORDER_ROLE: &str = "record";

/// Bench statuses a reader may fall behind by: only the latest counts.
const BENCH_STATUSES_BUFFERED: usize = 4;
/// Statuses that a reader may fall behind by: only the latest counts.
const STATUSES_BUFFERED: usize = 4;

pub(crate) type EventService = publish_subscribe::PortFactory<Ipc, EventMessage, ()>;
pub(crate) type DocumentService = publish_subscribe::PortFactory<Ipc, [u8], DocumentHead>;
pub(crate) type SnapshotService = publish_subscribe::PortFactory<Ipc, [u64], SnapshotHead>;
pub(crate) type BenchStatusService = publish_subscribe::PortFactory<Ipc, BenchStatusMessage, ()>;
pub(crate) type RecorderService = publish_subscribe::PortFactory<Ipc, RecorderStatus, ()>;

pub(crate) fn event_service(node: &Node<Ipc>, bench: &BenchName) -> Result<EventService, WireError> {
    opened(bench, || {
        Ok(service(node, bench, Topic::Event)?
            .publish_subscribe::<EventMessage>()
            .enable_safe_overflow(true)
            .history_size(EVENTS_KEPT)
            .subscriber_max_buffer_size(EVENTS_KEPT)
            .subscriber_max_borrowed_samples(2)
            .max_publishers(1)
            .max_subscribers(MAX_READERS)
            .max_nodes(MAX_NODES)
            .open_or_create())
    })
}

pub(crate) fn document_service(node: &Node<Ipc>, bench: &BenchName) -> Result<DocumentService, WireError> {
    opened(bench, || {
        Ok(service(node, bench, Topic::Document)?
            .publish_subscribe::<[u8]>()
            .user_header::<DocumentHead>()
            .enable_safe_overflow(true)
            .history_size(DOCUMENTS_KEPT)
            .subscriber_max_buffer_size(DOCUMENTS_KEPT)
            .subscriber_max_borrowed_samples(2)
            .max_publishers(1)
            .max_subscribers(MAX_PARTIES)
            .max_nodes(MAX_NODES)
            .open_or_create())
    })
}

pub(crate) fn snapshot_service(node: &Node<Ipc>, bench: &BenchName) -> Result<SnapshotService, WireError> {
    opened(bench, || {
        Ok(service(node, bench, Topic::Snapshot)?
            .publish_subscribe::<[u64]>()
            .user_header::<SnapshotHead>()
            .enable_safe_overflow(true)
            .history_size(1)
            .subscriber_max_buffer_size(SNAPSHOTS_BUFFERED)
            .subscriber_max_borrowed_samples(2)
            .max_publishers(1)
            .max_subscribers(MAX_READERS)
            .max_nodes(MAX_NODES)
            .open_or_create())
    })
}

pub(crate) fn bench_status_service(node: &Node<Ipc>, bench: &BenchName) -> Result<BenchStatusService, WireError> {
    opened(bench, || {
        Ok(service(node, bench, Topic::Status)?
            .publish_subscribe::<BenchStatusMessage>()
            .enable_safe_overflow(true)
            .history_size(1)
            .subscriber_max_buffer_size(BENCH_STATUSES_BUFFERED)
            .subscriber_max_borrowed_samples(2)
            .max_publishers(1)
            .max_subscribers(MAX_PARTIES)
            .max_nodes(MAX_NODES)
            .open_or_create())
    })
}

/// Made by whoever needs it first: readers wait for recorders, and recorders for readers.
pub(crate) fn recorder_service(node: &Node<Ipc>, bench: &BenchName) -> Result<RecorderService, WireError> {
    opened(bench, || {
        Ok(service(node, bench, Topic::Recorder)?
            .publish_subscribe::<RecorderStatus>()
            .enable_safe_overflow(true)
            .history_size(1)
            .subscriber_max_buffer_size(STATUSES_BUFFERED)
            .subscriber_max_borrowed_samples(2)
            .max_publishers(1)
            .max_subscribers(MAX_PARTIES)
            .max_nodes(MAX_NODES)
            .open_or_create())
    })
}

/// Whether a recorder that lives has the service open.
pub(crate) fn has_recorder(service: &RecorderService) -> bool {
    let mut found = false;
    let listed = service.nodes(|node| match node {
        NodeState::Alive(view) if view.details().as_ref().is_some_and(|d| d.name().as_str() == RECORDER_ROLE) => {
            found = true;
            CallbackProgression::Stop
        }
        _ => CallbackProgression::Continue,
    });
    // A list that cannot be read is no evidence of death.
    listed.is_err() || found
}

/// The services of a simulation's news.
#[derive(Debug)]
pub(crate) struct NewsServices {
    documents: DocumentService,
    bench_statuses: BenchStatusService,
    events: EventService,
    snapshots: SnapshotService,
}

impl NewsServices {
    pub(crate) fn open(node: &Node<Ipc>, bench: &BenchName) -> Result<Self, WireError> {
        Ok(Self {
            documents: document_service(node, bench)?,
            bench_statuses: bench_status_service(node, bench)?,
            events: event_service(node, bench)?,
            snapshots: snapshot_service(node, bench)?,
        })
    }
}

/// See [`NewsSender`].
#[derive(Debug)]
pub struct SharedNews {
    documents: Publisher<Ipc, [u8], DocumentHead>,
    bench_statuses: Publisher<Ipc, BenchStatusMessage, ()>,
    events: Publisher<Ipc, EventMessage, ()>,
    snapshots: Publisher<Ipc, [u64], SnapshotHead>,
    sent_documents: SentDocuments,
    _name: NameLock,
}

impl SharedNews {
    pub(crate) fn new(services: &NewsServices, name: NameLock) -> Result<Self, WireError> {
        let documents = services.documents.publisher_builder().initial_max_slice_len(MAX_DOCUMENT);
        let snapshots = services.snapshots.publisher_builder().initial_max_slice_len(MAX_SNAPSHOT);
        Ok(Self {
            snapshots: snapshots.max_loaned_samples(1).create().map_err(internal)?,
            documents: documents.max_loaned_samples(1).create().map_err(internal)?,
            bench_statuses: services
                .bench_statuses
                .publisher_builder()
                .max_loaned_samples(1)
                .create()
                .map_err(internal)?,
            events: services.events.publisher_builder().max_loaned_samples(1).create().map_err(internal)?,
            sent_documents: SentDocuments::default(),
            _name: name,
        })
    }

    fn document<T: Content>(&mut self, document: &Document<T>) -> Result<(), WireError> {
        check_document(document.text())?;
        if self.sent_documents.is_due(document.hash()) {
            let bytes = document.text().as_bytes();
            let mut sample = self.documents.loan_slice(bytes.len()).map_err(internal)?;
            *sample.user_header_mut() = document.head();
            sample.payload_mut().copy_from_slice(bytes);
            sample.send().map_err(internal)?;
        }
        Ok(())
    }
}

impl NewsSender for SharedNews {
    fn bench_status(&mut self, bench_status: &BenchStatus) -> Result<(), WireError> {
        bench_status.rotor_document().map_or(Ok(()), |rotor| self.document(rotor))?;
        self.document(&bench_status.settings)?;
        let mut sample = self.bench_statuses.loan().map_err(internal)?;
        *sample.payload_mut() = bench_status.message();
        sample.send().map_err(internal)?;
        Ok(())
    }

    fn event(&mut self, event: &Event) -> Result<(), WireError> {
        self.document(&event.settings)?;
        let mut sample = self.events.loan().map_err(internal)?;
        *sample.payload_mut() = event.message();
        sample.send().map_err(internal)?;
        Ok(())
    }

    fn snapshot(&mut self, head: &SnapshotHead, words: &[u64]) -> Result<(), WireError> {
        check_snapshot(words)?;
        let mut sample = self.snapshots.loan_slice(words.len()).map_err(internal)?;
        *sample.user_header_mut() = *head;
        sample.payload_mut().copy_from_slice(words);
        sample.send().map_err(internal)?;
        Ok(())
    }

    fn welcome(&mut self) -> Result<(), WireError> {
        // Documents first: what comes then names them.
        self.documents.update_connections().map_err(internal)?;
        self.events.update_connections().map_err(internal)?;
        self.snapshots.update_connections().map_err(internal)
    }
}

/// A recorder's claim on a bench, and its voice: the single publisher of the service is the lock.
#[derive(Debug)]
pub struct SharedRecorder {
    publisher: Publisher<Ipc, RecorderStatus, ()>,
    // Kept, because readers tell by it whether we live; after the publisher, before the lease.
    _service: RecorderService,
    _root: Root,
}

impl SharedRecorder {
    /// Claims `bench` with a node called [`RECORDER_ROLE`].
    pub(crate) fn claim(node: &Node<Ipc>, bench: &BenchName, root: &Root) -> Result<Self, WireError> {
        let service = recorder_service(node, bench)?;
        // A recorder that was killed still holds its place until it is cleared away.
        let _ = service.blocking_cleanup_dead_nodes(Duration::from_secs(1));
        let publisher = service.publisher_builder().max_loaned_samples(1).create();
        let publisher = publisher.map_err(|error| port(&error, || WireError::Recorded(bench.clone())))?;
        Ok(Self { publisher, _service: service, _root: root.clone() })
    }
}

impl RecorderSender for SharedRecorder {
    fn send(&mut self, status: &mut RecorderStatus) -> Result<(), WireError> {
        status.stamp();
        let mut sample = self.publisher.loan().map_err(internal)?;
        *sample.payload_mut() = *status;
        sample.send().map_err(internal)?;
        Ok(())
    }
}
