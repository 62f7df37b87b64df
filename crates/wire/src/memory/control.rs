//! A controller outside, in [`super::Memory`].

use std::collections::VecDeque;
use std::sync::Arc;

use super::{Bench, lock};
use crate::control::{CONTROL_BUFFERED, ControlCommand, Readings};
use crate::{ControlHost, Controlling, HostState, WireError};

/// What waits on both sides.
#[derive(Debug, Default)]
pub(super) struct ControlBox {
    pub(super) readings: VecDeque<Readings>,
    pub(super) commands: VecDeque<ControlCommand>,
}

fn put<T>(queue: &mut VecDeque<T>, message: T) {
    if queue.len() == CONTROL_BUFFERED {
        queue.pop_front();
    }
    queue.push_back(message);
}

/// See [`super::Memory`].
#[derive(Debug)]
pub struct MemoryControlHost {
    pub(super) bench: Arc<Bench>,
    pub(super) _claim: Arc<()>,
}

impl ControlHost for MemoryControlHost {
    fn send(&mut self, readings: &Readings) -> Result<(), WireError> {
        put(&mut lock(&self.bench.control).readings, *readings);
        Ok(())
    }

    fn commands(&mut self, mut visit: impl FnMut(&ControlCommand)) -> Result<usize, WireError> {
        let arrived = std::mem::take(&mut lock(&self.bench.control).commands);
        arrived.iter().for_each(&mut visit);
        Ok(arrived.len())
    }

    fn welcome(&mut self) -> Result<(), WireError> {
        Ok(())
    }
}

/// See [`super::Memory`].
#[derive(Debug)]
pub struct MemoryController {
    pub(super) bench: Arc<Bench>,
    pub(super) _claim: Arc<()>,
}

impl Controlling for MemoryController {
    fn readings(&mut self) -> Result<Option<Readings>, WireError> {
        Ok(lock(&self.bench.control).readings.pop_front())
    }

    fn command(&mut self, command: &ControlCommand) -> Result<(), WireError> {
        put(&mut lock(&self.bench.control).commands, *command);
        Ok(())
    }

    fn host(&self) -> HostState {
        if lock(&self.bench.host).strong_count() > 0 { HostState::Alive } else { HostState::Gone }
    }
}
