//! How a bench stands, over shared memory: its bulletins, and the status of its recorder.

use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::publish_subscribe;

use crate::iceoryx::{Ipc, MAX_NODES, MAX_PARTIES, full, internal, opened, service};
use crate::shared_news::{self, RecorderService};
use crate::{BenchName, Bulletin, Glance, RecorderStatus, Root, WireError};

/// Bulletins a reader may fall behind by.
const BULLETINS_BUFFERED: usize = 32;

pub(crate) type BulletinService = publish_subscribe::PortFactory<Ipc, Bulletin, ()>;

/// The service, made if it is not there.
pub(crate) fn bulletin_service(node: &Node<Ipc>, bench: &BenchName) -> Result<BulletinService, WireError> {
    opened(bench, || {
        Ok(service(node, bench, "bulletin")?
            .publish_subscribe::<Bulletin>()
            .enable_safe_overflow(true)
            .history_size(1)
            .subscriber_max_buffer_size(BULLETINS_BUFFERED)
            .subscriber_max_borrowed_samples(2)
            .max_publishers(1)
            .max_subscribers(MAX_PARTIES)
            .max_nodes(MAX_NODES)
            .open_or_create())
    })
}

/// See [`Glance`].
#[derive(Debug)]
pub struct SharedGlance {
    bulletins: Subscriber<Ipc, Bulletin, ()>,
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
            opened(bench, || Ok(service(node, bench, "bulletin")?.publish_subscribe::<Bulletin>().open()))?;
        let recorder_service = shared_news::recorder_service(node, bench)?;
        let refused = |error| full(bench, "processes that look at it", MAX_PARTIES, &error);
        let bulletins = bulletins.subscriber_builder().create().map_err(refused)?;
        let recorders = recorder_service.subscriber_builder().create().map_err(refused)?;
        Ok(Self { bulletins, recorders, recorder: None, recorder_service, _root: root.clone() })
    }
}

impl Glance for SharedGlance {
    fn bulletin(&mut self) -> Result<Option<Box<Bulletin>>, WireError> {
        let mut latest = None;
        while let Some(sample) = self.bulletins.receive().map_err(internal)? {
            latest = Some(sample);
        }
        Ok(latest.map(|sample| Box::new(*sample.payload())))
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
