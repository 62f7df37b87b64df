//! How a bench stands, over shared memory: its bulletins, and the status of its recorder.

use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::*;

use crate::document::DocumentHead;
use crate::iceoryx::{Ipc, MAX_PARTIES, full, internal, opened, service};
use crate::message::BulletinMessage;
use crate::outbox::Shelf;
use crate::shared_news::{self, BulletinService, RecorderService};
use crate::{BenchName, Bulletin, Glance, RecorderStatus, Root, WireError};

/// See [`Glance`].
#[derive(Debug)]
pub struct SharedGlance {
    /// What was read of documents, and waits for them.
    pub(crate) shelf: Shelf,
    documents: Subscriber<Ipc, [u8], DocumentHead>,
    bulletins: Subscriber<Ipc, BulletinMessage, ()>,
    recorders: Subscriber<Ipc, RecorderStatus, ()>,
    /// The last that was heard of a recorder.
    recorder: Option<Box<RecorderStatus>>,
    recorder_service: RecorderService,
    _root: Root,
}

impl SharedGlance {
    pub(crate) fn new(node: &Node<Ipc>, bench: &BenchName, root: &Root) -> Result<Self, WireError> {
        // Not made: without it the simulation has only begun, or ended.
        let bulletins: BulletinService =
            opened(bench, || Ok(service(node, bench, "bulletin")?.publish_subscribe::<BulletinMessage>().open()))?;
        let recorder_service = shared_news::recorder_service(node, bench)?;
        let refused = |error| full(bench, "processes that look at it", MAX_PARTIES, &error);
        // Before the bulletins: whose documents are then never later than they are.
        let documents = shared_news::document_service(node, bench)?.subscriber_builder().create().map_err(refused)?;
        let bulletins = bulletins.subscriber_builder().create().map_err(refused)?;
        let recorders = recorder_service.subscriber_builder().create().map_err(refused)?;
        Ok(Self {
            shelf: Shelf::default(),
            documents,
            bulletins,
            recorders,
            recorder: None,
            recorder_service,
            _root: root.clone(),
        })
    }
}

impl SharedGlance {
    /// Takes in what documents have come.
    pub(crate) fn read_documents(&mut self) -> Result<(), WireError> {
        while let Some(sample) = self.documents.receive().map_err(internal)? {
            self.shelf.put(*sample.user_header(), sample.payload());
        }
        Ok(())
    }
}

impl Glance for SharedGlance {
    fn bulletin(&mut self) -> Result<Option<Box<Bulletin>>, WireError> {
        while let Some(sample) = self.bulletins.receive().map_err(internal)? {
            self.shelf.hold_bulletin(*sample.payload());
        }
        self.read_documents()?;
        Ok(self.shelf.bulletin())
    }

    fn recorder(&mut self) -> Result<Option<Box<RecorderStatus>>, WireError> {
        while let Some(sample) = self.recorders.receive().map_err(internal)? {
            self.recorder = Some(Box::new(*sample.payload()));
        }
        let alive = self.recorder.as_ref().is_some_and(|last| last.is_recording())
            && shared_news::has_recorder(&self.recorder_service);
        Ok(self.recorder.as_ref().map(|last| Box::new(last.seen(alive))))
    }
}
