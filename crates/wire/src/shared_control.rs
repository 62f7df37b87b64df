//! Readings and commands over shared memory. The single publisher of the commands is the lock: one controller a bench.

use std::time::Duration;

use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::publish_subscribe;

use crate::control::{CONTROL_BUFFERED, ControlCommand, Readings};
use crate::iceoryx::{Ipc, MAX_NODES, MAX_READERS, full, internal, opened, port, service};
use crate::name_lock::NameLock;
use crate::shared_memory::{StateService, host_of};
use crate::{BenchName, ControlHost, Controlling, HostState, Root, Topic, WireError};

type ReadingService = publish_subscribe::PortFactory<Ipc, Readings, ()>;
type ControlService = publish_subscribe::PortFactory<Ipc, ControlCommand, ()>;

/// The two services of a bench for a controller outside.
#[derive(Debug)]
pub(crate) struct ControlServices {
    readings: ReadingService,
    commands: ControlService,
}

impl ControlServices {
    /// Opens them, or makes them.
    pub(crate) fn open(node: &Node<Ipc>, bench: &BenchName) -> Result<Self, WireError> {
        let readings = opened(bench, || {
            Ok(service(node, bench, Topic::Reading)?
                .publish_subscribe::<Readings>()
                .enable_safe_overflow(true)
                .history_size(1)
                .subscriber_max_buffer_size(CONTROL_BUFFERED)
                .subscriber_max_borrowed_samples(2)
                .max_publishers(1)
                .max_subscribers(MAX_READERS)
                .max_nodes(MAX_NODES)
                .open_or_create())
        })?;
        let commands = opened(bench, || {
            Ok(service(node, bench, Topic::Control)?
                .publish_subscribe::<ControlCommand>()
                .enable_safe_overflow(true)
                // What was meant for a bench that has ended is nothing for the next one.
                .history_size(0)
                .subscriber_max_buffer_size(CONTROL_BUFFERED)
                .subscriber_max_borrowed_samples(2)
                .max_publishers(1)
                .max_subscribers(1)
                .max_nodes(MAX_NODES)
                .open_or_create())
        })?;
        Ok(Self { readings, commands })
    }

    /// The bench's side.
    pub(crate) fn host(&self, name: NameLock) -> Result<SharedControlHost, WireError> {
        Ok(SharedControlHost {
            readings: self.readings.publisher_builder().max_loaned_samples(1).create().map_err(internal)?,
            commands: self.commands.subscriber_builder().create().map_err(internal)?,
            _name: name,
        })
    }

    /// The controller's side.
    pub(crate) fn controller(
        self,
        bench: &BenchName,
        states: StateService,
        root: &Root,
    ) -> Result<SharedController, WireError> {
        // A controller that was killed still holds its place until it is cleared away.
        let _ = self.commands.blocking_cleanup_dead_nodes(Duration::from_secs(1));
        let commands = self.commands.publisher_builder().max_loaned_samples(1).create();
        let commands = commands.map_err(|error| port(&error, || WireError::Controlled(bench.clone())))?;
        let refused = |error| full(bench, "processes that look at its readings", MAX_READERS, &error);
        let readings = self.readings.subscriber_builder().create().map_err(refused)?;
        Ok(SharedController { readings, commands, states, _root: root.clone() })
    }
}

/// See [`ControlHost`].
#[derive(Debug)]
pub struct SharedControlHost {
    readings: Publisher<Ipc, Readings, ()>,
    commands: Subscriber<Ipc, ControlCommand, ()>,
    _name: NameLock,
}

impl ControlHost for SharedControlHost {
    fn send(&mut self, readings: &Readings) -> Result<(), WireError> {
        let mut sample = self.readings.loan().map_err(internal)?;
        *sample.payload_mut() = *readings;
        sample.send().map_err(internal)?;
        Ok(())
    }

    fn commands(&mut self, mut visit: impl FnMut(&ControlCommand)) -> Result<usize, WireError> {
        let mut count = 0;
        // Not for ever: whoever sends faster than we read is no reason to stand still.
        while count < CONTROL_BUFFERED
            && let Some(sample) = self.commands.receive().map_err(internal)?
        {
            visit(sample.payload());
            count += 1;
        }
        Ok(count)
    }

    fn welcome(&mut self) -> Result<(), WireError> {
        self.readings.update_connections().map_err(internal)
    }
}

/// See [`Controlling`].
#[derive(Debug)]
pub struct SharedController {
    readings: Subscriber<Ipc, Readings, ()>,
    commands: Publisher<Ipc, ControlCommand, ()>,
    states: StateService,
    _root: Root,
}

impl Controlling for SharedController {
    fn readings(&mut self) -> Result<Option<Readings>, WireError> {
        Ok(self.readings.receive().map_err(internal)?.map(|sample| *sample.payload()))
    }

    fn command(&mut self, command: &ControlCommand) -> Result<(), WireError> {
        let mut sample = self.commands.loan().map_err(internal)?;
        *sample.payload_mut() = *command;
        sample.send().map_err(internal)?;
        Ok(())
    }

    fn host(&self) -> HostState {
        host_of(&self.states)
    }
}
