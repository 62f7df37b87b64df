//! How a bench stands, over shared memory: its bench statuses, and the status of its recorder.

use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::*;

use crate::delivery::ReceivedDocuments;
use crate::document::DocumentHead;
use crate::iceoryx::{Ipc, MAX_PARTIES, full, internal, opened, service};
use crate::message::BenchStatusMessage;
use crate::shared_news::{self, BenchStatusService, RecorderService};
use crate::{BenchName, BenchStatus, Glance, RecorderStatus, Root, Topic, WireError};

/// See [`Glance`].
#[derive(Debug)]
pub struct SharedGlance {
    /// What was read of documents, and waits for them.
    pub(crate) received: ReceivedDocuments,
    documents: Subscriber<Ipc, [u8], DocumentHead>,
    bench_statuses: Subscriber<Ipc, BenchStatusMessage, ()>,
    recorders: Subscriber<Ipc, RecorderStatus, ()>,
    /// The last that was heard of a recorder.
    recorder: Option<Box<RecorderStatus>>,
    recorder_service: RecorderService,
    _root: Root,
}

impl SharedGlance {
    pub(crate) fn new(node: &Node<Ipc>, bench: &BenchName, root: &Root) -> Result<Self, WireError> {
        // Not made: without it the simulation has only begun, or ended.
        let bench_statuses: BenchStatusService = opened(bench, || {
            Ok(service(node, bench, Topic::Status)?.publish_subscribe::<BenchStatusMessage>().open())
        })?;
        let recorder_service = shared_news::recorder_service(node, bench)?;
        let refused = |error| full(bench, "processes that look at it", MAX_PARTIES, &error);
        // before the bench statuses: whose documents are then never later than they are.
        let documents = shared_news::document_service(node, bench)?.subscriber_builder().create().map_err(refused)?;
        let bench_statuses = bench_statuses.subscriber_builder().create().map_err(refused)?;
        let recorders = recorder_service.subscriber_builder().create().map_err(refused)?;
        Ok(Self {
            received: ReceivedDocuments::default(),
            documents,
            bench_statuses,
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
            self.received.put(*sample.user_header(), sample.payload());
        }
        Ok(())
    }
}

impl Glance for SharedGlance {
    fn bench_status(&mut self) -> Result<Option<Box<BenchStatus>>, WireError> {
        while let Some(sample) = self.bench_statuses.receive().map_err(internal)? {
            self.received.hold_bench_status(*sample.payload());
        }
        self.read_documents()?;
        Ok(self.received.bench_status())
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
