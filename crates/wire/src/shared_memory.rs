//! The carrier between processes: iceoryx2 shared memory, zero-copy.
//!
//! Settings of the services that matter: safe overflow is on, so that no reader can slow the simulation down; there is
//! one publisher of states, besides the lock on a bench's name; sizes do not depend on the bench, so that a new simulation
//! finds the services of the old one, still held open by a reader, fit for use. There are more places for who looks or
//! asks than for readers of the motion.

use std::time::{Duration, Instant};

use iceoryx2::node::NodeView;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::publish_subscribe;

use crate::iceoryx::{self, Ipc, MAX_NODES, MAX_READERS, full, internal, opened, port, service};
use crate::name_lock::NameLock;
use crate::ports::check_burst;
use crate::shared_commands::{CommandServices, SharedCommander, SharedInbox};
use crate::shared_control::{ControlServices, SharedControlHost, SharedController};
use crate::shared_glance::SharedGlance;
use crate::shared_news::{self, NewsServices, RECORDER_ROLE, SharedNews, SharedRecorder};
use crate::{
    BenchName, BenchStatus, Carrier, Event, EventMessage, Glance, Host, HostState, Listener, MAX_BURST, RecorderStatus,
    Root, RowMut, SCHEMA, SnapshotHead, StateSender, StepLayout, StepRow, Topic, WireError,
};

/// Bursts of states a reader may fall behind by: 2 s while a simulation wakes up 1000 times a second, and longer below.
pub(crate) const BURSTS_BUFFERED: usize = 2048;
/// How long it may take until what a killed simulation has left is cleared away.
const CLEARED: Duration = Duration::from_secs(3);
/// The node name of a simulation; readers are called by their role.
pub(crate) const HOST_ROLE: &str = "sim";

/// Carries messages between processes under one [`Root`].
#[derive(Clone, Debug)]
pub struct SharedMemory {
    config: Config,
    role: String,
    root: Root,
}

impl SharedMemory {
    /// The carrier under `root`, for a process that others see as `role` (`dash`, `tail` ...).
    ///
    /// # Errors
    /// A root that iceoryx2 cannot use as a path.
    pub fn new(root: &Root, role: &str) -> Result<Self, WireError> {
        let config = iceoryx::config(&root.iceoryx2(), root.prefix())
            .map_err(|error| WireError::Root { path: root.path().to_owned(), problem: error.to_string() })?;
        Ok(Self { config, role: role.to_owned(), root: root.clone() })
    }

    pub(crate) fn config(&self) -> &Config {
        &self.config
    }

    pub(crate) fn root(&self) -> &Root {
        &self.root
    }

    pub(crate) fn node(&self, role: &str) -> Result<Node<Ipc>, WireError> {
        let name = NodeName::new(role).map_err(internal)?;
        NodeBuilder::new()
            .name(&name)
            .config(&self.config)
            // The signals of this process are not iceoryx2's to handle.
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create()
            .map_err(|error| WireError::Root {
                path: self.root.path().to_owned(),
                problem: format!("shared memory cannot be set up there ({error:?})"),
            })
    }

    fn attach(&self, bench: &BenchName) -> Result<(Node<Ipc>, StateService), WireError> {
        let node = self.node(&self.role)?;
        let states: StateService = opened(bench, || {
            Ok(service(&node, bench, Topic::State)?
                .publish_subscribe::<[u64]>()
                .open_with_attributes(&required_schema()?))
        })?;
        if host_of(&states) == HostState::Gone {
            return Err(WireError::NoBench(bench.clone()));
        }
        Ok((node, states))
    }
}

pub(crate) type StateService = publish_subscribe::PortFactory<Ipc, [u64], ()>;

fn required_schema() -> Result<AttributeVerifier, WireError> {
    let key = "whirl.schema".try_into().map_err(internal)?;
    let value = SCHEMA.to_string().as_str().try_into().map_err(internal)?;
    AttributeVerifier::new().require(&key, &value).map_err(internal)
}

/// Whether a simulation that lives has the service open.
pub(crate) fn host_of(states: &StateService) -> HostState {
    let mut found = HostState::Gone;
    let listed = states.nodes(|node| match node {
        NodeState::Alive(view) if is_host(view.details().as_ref()) => {
            found = HostState::Alive;
            CallbackProgression::Stop
        }
        _ => CallbackProgression::Continue,
    });
    // A list that cannot be read is no evidence of death.
    if listed.is_err() { HostState::Alive } else { found }
}

pub(crate) fn is_host(details: Option<&iceoryx2::node::NodeDetails>) -> bool {
    details.is_some_and(|details| details.name().as_str() == HOST_ROLE)
}

impl Carrier for SharedMemory {
    type Host = SharedHost;
    type Listener = SharedListener;
    type Glance = SharedGlance;
    type Commander = SharedCommander;
    type Recorder = SharedRecorder;
    type Controller = SharedController;

    fn host(&self, bench: &BenchName) -> Result<SharedHost, WireError> {
        // First of all: who does not get it has made nothing that could be in the way of who does.
        let name = NameLock::take(&self.root, bench)?;
        // Creating a node also clears away what dead ones left.
        let node = self.node(HOST_ROLE)?;
        let states: StateService = opened(bench, || {
            Ok(service(&node, bench, Topic::State)?
                .publish_subscribe::<[u64]>()
                .enable_safe_overflow(true)
                .history_size(0)
                .subscriber_max_buffer_size(BURSTS_BUFFERED)
                .subscriber_max_borrowed_samples(2)
                .max_publishers(1)
                .max_subscribers(MAX_READERS)
                .max_nodes(MAX_NODES)
                .open_or_create_with_attributes(&required_schema()?))
        })?;
        let start = Instant::now();
        // The name is ours, so a publisher is what a killed simulation has left, which somebody else may be clearing away.
        while states.dynamic_config().number_of_publishers() > 0 {
            // Or else it is of a simulation that does not know the lock, such as one in another language.
            if start.elapsed() > CLEARED {
                return Err(WireError::Taken(bench.clone()));
            }
            let _ = states.blocking_cleanup_dead_nodes(Duration::from_secs(1));
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = states.blocking_cleanup_dead_nodes(Duration::from_secs(1));
        let news = NewsServices::open(&node, bench)?;
        let commands = CommandServices::open(&node, bench)?;
        let control = ControlServices::open(&node, bench)?;
        Ok(SharedHost { states, news, commands, control, bench: bench.clone(), name })
    }

    fn listen(&self, bench: &BenchName) -> Result<SharedListener, WireError> {
        let (node, state_service) = self.attach(bench)?;
        let refused = |error| full(bench, "readers", MAX_READERS, &error);
        let states = state_service.subscriber_builder().create().map_err(refused)?;
        let events = shared_news::event_service(&node, bench)?.subscriber_builder().create().map_err(refused)?;
        let snapshots = shared_news::snapshot_service(&node, bench)?.subscriber_builder().create().map_err(refused)?;
        let glance = SharedGlance::new(&node, bench, &self.root)?;
        Ok(SharedListener { states, events, snapshots, state_service, glance })
    }

    fn glance(&self, bench: &BenchName) -> Result<SharedGlance, WireError> {
        let (node, _) = self.attach(bench)?;
        SharedGlance::new(&node, bench, &self.root)
    }

    fn command(&self, bench: &BenchName) -> Result<SharedCommander, WireError> {
        let (node, _) = self.attach(bench)?;
        CommandServices::open(&node, bench)?.commander(bench, &self.root)
    }

    fn recorder(&self, bench: &BenchName) -> Result<SharedRecorder, WireError> {
        // The bench must be there, and of our version.
        drop(self.attach(bench)?);
        SharedRecorder::claim(&self.node(RECORDER_ROLE)?, bench, &self.root)
    }

    fn controller(&self, bench: &BenchName) -> Result<SharedController, WireError> {
        let (node, states) = self.attach(bench)?;
        ControlServices::open(&node, bench)?.controller(bench, states, &self.root)
    }
}

/// A bench's name, held in shared memory.
#[derive(Debug)]
pub struct SharedHost {
    states: StateService,
    news: NewsServices,
    commands: CommandServices,
    control: ControlServices,
    bench: BenchName,
    // Last, so that everything above is closed before the name is given back.
    name: NameLock,
}

impl Host for SharedHost {
    type States = SharedStates;
    type News = SharedNews;
    type Inbox = SharedInbox;
    type Control = SharedControlHost;

    fn states(&self, layout: StepLayout) -> Result<SharedStates, WireError> {
        let words = MAX_BURST * layout.width();
        let builder = self.states.publisher_builder().max_loaned_samples(1).initial_max_slice_len(words);
        let taken = |error| port(&error, || WireError::Taken(self.bench.clone()));
        Ok(SharedStates { layout, publisher: builder.create().map_err(taken)?, _name: self.name.clone() })
    }

    fn news(&self) -> Result<SharedNews, WireError> {
        SharedNews::new(&self.news, self.name.clone())
    }

    fn inbox(&self) -> Result<SharedInbox, WireError> {
        self.commands.inbox(self.name.clone())
    }

    fn control(&self) -> Result<SharedControlHost, WireError> {
        self.control.host(self.name.clone())
    }

    fn listeners(&self) -> usize {
        self.states.dynamic_config().number_of_subscribers()
    }
}

/// See [`StateSender`].
#[derive(Debug)]
pub struct SharedStates {
    layout: StepLayout,
    publisher: Publisher<Ipc, [u64], ()>,
    _name: NameLock,
}

impl StateSender for SharedStates {
    fn send(&mut self, count: usize, mut fill: impl FnMut(usize, &mut RowMut<'_>)) -> Result<(), WireError> {
        check_burst(count)?;
        let width = self.layout.width();
        let mut sample = self.publisher.loan_slice(count * width).map_err(internal)?;
        let rows = sample.payload_mut().chunks_exact_mut(width);
        let rows = rows.filter_map(|words| RowMut::new(self.layout, words));
        rows.enumerate().for_each(|(place, mut row)| fill(place, &mut row));
        sample.send().map_err(internal)?;
        Ok(())
    }
}

/// See [`Listener`].
#[derive(Debug)]
pub struct SharedListener {
    states: Subscriber<Ipc, [u64], ()>,
    events: Subscriber<Ipc, EventMessage, ()>,
    snapshots: Subscriber<Ipc, [u64], SnapshotHead>,
    state_service: StateService,
    // Last, because it has the lease.
    glance: SharedGlance,
}

impl Glance for SharedListener {
    fn bench_status(&mut self) -> Result<Option<Box<BenchStatus>>, WireError> {
        self.glance.bench_status()
    }

    fn recorder(&mut self) -> Result<Option<Box<RecorderStatus>>, WireError> {
        self.glance.recorder()
    }
}

impl Listener for SharedListener {
    fn drain(&mut self, mut visit: impl FnMut(StepRow<'_>)) -> Result<usize, WireError> {
        let mut count = 0;
        while let Some(sample) = self.states.receive().map_err(internal)? {
            for row in StepRow::all(sample.payload()) {
                visit(row);
                count += 1;
            }
        }
        Ok(count)
    }

    fn events(&mut self, mut visit: impl FnMut(&Event)) -> Result<usize, WireError> {
        while let Some(sample) = self.events.receive().map_err(internal)? {
            self.glance.received.hold_event(*sample.payload());
        }
        self.glance.read_documents()?;
        let mut count = 0;
        while let Some(event) = self.glance.received.event() {
            visit(&event);
            count += 1;
        }
        Ok(count)
    }

    fn snapshots(&mut self, mut visit: impl FnMut(&SnapshotHead, &[u64])) -> Result<usize, WireError> {
        let mut count = 0;
        while let Some(sample) = self.snapshots.receive().map_err(internal)? {
            visit(sample.user_header(), sample.payload());
            count += 1;
        }
        Ok(count)
    }

    fn host(&self) -> HostState {
        host_of(&self.state_service)
    }
}
