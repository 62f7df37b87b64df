//! Events and the recorder's status over shared memory: the two services of a bench that carry news, not motion.

use std::time::Duration;

use iceoryx2::node::NodeView;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::publish_subscribe;

use crate::iceoryx::{Ipc, MAX_NODES, MAX_PARTIES, MAX_READERS, internal, opened, port, service};
use crate::name_lock::NameLock;
use crate::{BenchName, EVENTS_KEPT, Event, EventSender, RecorderSender, RecorderStatus, Root, WireError};

/// The node name of a recorder's status: its process lives as long as the node does, and the kernel drops its locks.
pub(crate) const RECORDER_ROLE: &str = "record";

/// Statuses that a reader may fall behind by: only the latest counts.
const STATUSES_BUFFERED: usize = 4;

pub(crate) type EventService = publish_subscribe::PortFactory<Ipc, Event, ()>;
pub(crate) type RecorderService = publish_subscribe::PortFactory<Ipc, RecorderStatus, ()>;

pub(crate) fn event_service(node: &Node<Ipc>, bench: &BenchName) -> Result<EventService, WireError> {
    opened(bench, || {
        Ok(service(node, bench, "event")?
            .publish_subscribe::<Event>()
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

/// Made by whoever needs it first: readers wait for recorders, and recorders for readers.
pub(crate) fn recorder_service(node: &Node<Ipc>, bench: &BenchName) -> Result<RecorderService, WireError> {
    opened(bench, || {
        Ok(service(node, bench, "recorder")?
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

/// See [`EventSender`].
#[derive(Debug)]
pub struct SharedEvents {
    publisher: Publisher<Ipc, Event, ()>,
    _name: NameLock,
}

impl SharedEvents {
    pub(crate) fn new(service: &EventService, name: NameLock) -> Result<Self, WireError> {
        let publisher = service.publisher_builder().max_loaned_samples(1).create().map_err(internal)?;
        Ok(Self { publisher, _name: name })
    }
}

impl EventSender for SharedEvents {
    fn send(&mut self, event: &Event) -> Result<(), WireError> {
        let mut sample = self.publisher.loan().map_err(internal)?;
        *sample.payload_mut() = *event;
        sample.send().map_err(internal)?;
        Ok(())
    }

    fn welcome(&mut self) -> Result<(), WireError> {
        self.publisher.update_connections().map_err(internal)
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
