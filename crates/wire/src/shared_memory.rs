//! The carrier between processes: iceoryx2 shared memory, zero-copy.
//!
//! Settings of the services that matter: safe overflow is on, so that no reader can slow the simulation down; there is
//! one publisher, which makes the state service the lock on a bench's name; sizes do not depend on the bench, so that a
//! new simulation finds the services of the old one, still held open by a reader, fit for use.

use std::time::Duration;

use iceoryx2::node::NodeView;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::publish_subscribe;

use crate::iceoryx::{Ipc, MAX_READERS, full, internal, opened, service};
use crate::ports::check_burst;
use crate::shared_commands::{CommandServices, SharedCommander, SharedInbox};
use crate::shared_news::{self, EventService, RECORDER_ROLE, RecorderService, SharedEvents, SharedRecorder};
use crate::{
    BenchName, Bulletin, BulletinSender, Carrier, Event, Host, HostState, Listener, MAX_BURST, RecorderStatus, Root,
    SCHEMA, State, StateSender, WireError,
};

/// Bursts of states a reader may fall behind by: 2 s while a simulation wakes up 1000 times a second, and longer below.
const BURSTS_BUFFERED: usize = 2048;
/// Bulletins a reader may fall behind by.
const BULLETINS_BUFFERED: usize = 32;
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
        let refuse = |problem: String| WireError::Root { path: root.path().to_owned(), problem };
        let mut config = Config::default();
        let path = iceoryx2::prelude::Path::new(root.iceoryx2().as_os_str().as_encoded_bytes())
            .map_err(|error| refuse(format!("not a path that iceoryx2 can use ({error:?})")))?;
        config.global.set_root_path(&path);
        config.global.prefix = FileName::new(root.prefix().as_bytes())
            .map_err(|error| refuse(format!("not a prefix that iceoryx2 can use ({error:?})")))?;
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
        let states: StateService = service(&node, bench, "state")?
            .publish_subscribe::<[State]>()
            .open_with_attributes(&required_schema()?)
            .map_err(|error| opened(bench, error))?;
        if host_of(&states) == HostState::Gone {
            return Err(WireError::NoBench(bench.clone()));
        }
        Ok((node, states))
    }
}

type StateService = publish_subscribe::PortFactory<Ipc, [State], ()>;
type BulletinService = publish_subscribe::PortFactory<Ipc, Bulletin, ()>;

fn schema_attribute()
-> Result<(iceoryx2::service::attribute::AttributeKey, iceoryx2::service::attribute::AttributeValue), WireError> {
    let key = "whirl.schema".try_into().map_err(internal)?;
    let value = SCHEMA.to_string().as_str().try_into().map_err(internal)?;
    Ok((key, value))
}

fn required_schema() -> Result<AttributeVerifier, WireError> {
    let (key, value) = schema_attribute()?;
    AttributeVerifier::new().require(&key, &value).map_err(internal)
}

/// Whether a simulation that lives has the service open.
fn host_of(states: &StateService) -> HostState {
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
    type Commander = SharedCommander;
    type Recorder = SharedRecorder;

    fn host(&self, bench: &BenchName) -> Result<SharedHost, WireError> {
        // Creating a node also clears away what dead ones left.
        let node = self.node(HOST_ROLE)?;
        let (key, value) = schema_attribute()?;
        let define = || AttributeSpecifier::new().define(&key, &value).map_err(internal);
        let states: StateService = {
            let existing = service(&node, bench, "state")?
                .publish_subscribe::<[State]>()
                .open_with_attributes(&required_schema()?);
            match existing.map_err(|error| opened(bench, error)) {
                Ok(service) => service,
                Err(WireError::NoBench(_)) => service(&node, bench, "state")?
                    .publish_subscribe::<[State]>()
                    .enable_safe_overflow(true)
                    .history_size(0)
                    .subscriber_max_buffer_size(BURSTS_BUFFERED)
                    .subscriber_max_borrowed_samples(2)
                    .max_publishers(1)
                    .max_subscribers(MAX_READERS)
                    .max_nodes(4 * MAX_READERS)
                    .create_with_attributes(&define()?)
                    .map_err(|error| opened(bench, error))?,
                Err(refusal) => return Err(refusal),
            }
        };
        let _ = states.blocking_cleanup_dead_nodes(Duration::from_secs(1));
        if states.dynamic_config().number_of_publishers() > 0 {
            return Err(WireError::Taken(bench.clone()));
        }
        let bulletins = service(&node, bench, "bulletin")?
            .publish_subscribe::<Bulletin>()
            .enable_safe_overflow(true)
            .history_size(1)
            .subscriber_max_buffer_size(BULLETINS_BUFFERED)
            .subscriber_max_borrowed_samples(2)
            .max_publishers(1)
            .max_subscribers(MAX_READERS)
            .max_nodes(4 * MAX_READERS)
            .open_or_create()
            .map_err(|error| opened(bench, error))?;
        let events = shared_news::event_service(&node, bench)?;
        let commands = CommandServices::open(&node, bench)?;
        Ok(SharedHost { states, bulletins, events, commands, bench: bench.clone(), _root: self.root.clone() })
    }

    fn listen(&self, bench: &BenchName) -> Result<SharedListener, WireError> {
        let (node, state_service) = self.attach(bench)?;
        let bulletins: BulletinService = service(&node, bench, "bulletin")?
            .publish_subscribe::<Bulletin>()
            .open()
            .map_err(|error| opened(bench, error))?;
        let recorder_service = shared_news::recorder_service(&node, bench)?;
        let refused = |error| full(bench, "reader", error);
        let states = state_service.subscriber_builder().create().map_err(refused)?;
        let bulletins = bulletins.subscriber_builder().create().map_err(refused)?;
        let events = shared_news::event_service(&node, bench)?.subscriber_builder().create().map_err(refused)?;
        let recorders = recorder_service.subscriber_builder().create().map_err(refused)?;
        Ok(SharedListener {
            states,
            bulletins,
            events,
            recorders,
            recorder: None,
            state_service,
            recorder_service,
            _root: self.root.clone(),
        })
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
}

/// A bench's name, held in shared memory.
#[derive(Debug)]
pub struct SharedHost {
    states: StateService,
    bulletins: BulletinService,
    events: EventService,
    commands: CommandServices,
    bench: BenchName,
    // Last, so that everything above is closed before the lease ends.
    _root: Root,
}

impl Host for SharedHost {
    type States = SharedStates;
    type Bulletins = SharedBulletins;
    type Events = SharedEvents;
    type Inbox = SharedInbox;

    fn states(&self) -> Result<SharedStates, WireError> {
        let builder = self.states.publisher_builder().max_loaned_samples(1).initial_max_slice_len(MAX_BURST);
        let publisher = builder.create().map_err(|error| {
            if format!("{error:?}").contains("ExceedsMax") {
                WireError::Taken(self.bench.clone())
            } else {
                internal(error)
            }
        })?;
        Ok(SharedStates { publisher })
    }

    fn bulletins(&self) -> Result<SharedBulletins, WireError> {
        let publisher = self.bulletins.publisher_builder().max_loaned_samples(1).create().map_err(internal)?;
        Ok(SharedBulletins { publisher })
    }

    fn events(&self) -> Result<SharedEvents, WireError> {
        SharedEvents::new(&self.events)
    }

    fn inbox(&self) -> Result<SharedInbox, WireError> {
        self.commands.inbox()
    }

    fn listeners(&self) -> usize {
        self.states.dynamic_config().number_of_subscribers()
    }
}

/// See [`StateSender`].
#[derive(Debug)]
pub struct SharedStates {
    publisher: Publisher<Ipc, [State], ()>,
}

impl StateSender for SharedStates {
    fn send(&mut self, count: usize, mut fill: impl FnMut(usize, &mut State)) -> Result<(), WireError> {
        check_burst(count)?;
        let mut sample = self.publisher.loan_slice(count).map_err(internal)?;
        sample.payload_mut().iter_mut().enumerate().for_each(|(place, state)| fill(place, state));
        sample.send().map_err(internal)?;
        Ok(())
    }
}

/// See [`BulletinSender`].
#[derive(Debug)]
pub struct SharedBulletins {
    publisher: Publisher<Ipc, Bulletin, ()>,
}

impl BulletinSender for SharedBulletins {
    fn send(&mut self, bulletin: &Bulletin) -> Result<(), WireError> {
        let mut sample = self.publisher.loan().map_err(internal)?;
        *sample.payload_mut() = *bulletin;
        sample.send().map_err(internal)?;
        Ok(())
    }
}

/// See [`Listener`].
#[derive(Debug)]
pub struct SharedListener {
    states: Subscriber<Ipc, [State], ()>,
    bulletins: Subscriber<Ipc, Bulletin, ()>,
    events: Subscriber<Ipc, Event, ()>,
    recorders: Subscriber<Ipc, RecorderStatus, ()>,
    /// The last that was heard of a recorder.
    recorder: Option<Box<RecorderStatus>>,
    state_service: StateService,
    recorder_service: RecorderService,
    _root: Root,
}

impl Listener for SharedListener {
    fn drain(&mut self, mut visit: impl FnMut(&State)) -> Result<usize, WireError> {
        let mut count = 0;
        while let Some(sample) = self.states.receive().map_err(internal)? {
            sample.payload().iter().for_each(&mut visit);
            count += sample.payload().len();
        }
        Ok(count)
    }

    fn bulletin(&mut self) -> Result<Option<Box<Bulletin>>, WireError> {
        let mut latest = None;
        while let Some(sample) = self.bulletins.receive().map_err(internal)? {
            latest = Some(sample);
        }
        Ok(latest.map(|sample| Box::new(*sample.payload())))
    }

    fn events(&mut self, mut visit: impl FnMut(&Event)) -> Result<usize, WireError> {
        let mut count = 0;
        while let Some(sample) = self.events.receive().map_err(internal)? {
            visit(sample.payload());
            count += 1;
        }
        Ok(count)
    }

    fn recorder(&mut self) -> Result<Option<Box<RecorderStatus>>, WireError> {
        while let Some(sample) = self.recorders.receive().map_err(internal)? {
            self.recorder = Some(Box::new(*sample.payload()));
        }
        let alive = self.recorder.as_ref().is_some_and(|last| last.is_recording())
            && shared_news::has_recorder(&self.recorder_service);
        Ok(self.recorder.as_ref().map(|last| Box::new(last.seen(alive))))
    }

    fn host(&self) -> HostState {
        host_of(&self.state_service)
    }
}
