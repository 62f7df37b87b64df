//! Requests and answers over shared memory, and the bell that tells the simulation that a request waits.

use std::time::{Duration, Instant};

use iceoryx2::port::client::Client;
use iceoryx2::port::listener::{Listener, ListenerWaitError};
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::server::Server;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::{event, request_response};

use crate::document::MAX_DOCUMENT;
use crate::iceoryx::{Ipc, MAX_NODES, MAX_PARTIES, full, internal, opened, service};
use crate::message::RequestMessage;
use crate::name_lock::NameLock;
use crate::{Answer, BenchName, Commander, Inbox, Request, Root, Topic, WireError};

/// The two services of a bench that carry requests.
#[derive(Debug)]
pub(crate) struct CommandServices {
    commands: request_response::PortFactory<Ipc, [u8], RequestMessage, Answer, ()>,
    wake: event::PortFactory<Ipc>,
}

impl CommandServices {
    /// Opens them, or makes them.
    pub(crate) fn open(node: &Node<Ipc>, bench: &BenchName) -> Result<Self, WireError> {
        let commands = opened(bench, || {
            Ok(service(node, bench, Topic::Command)?
                .request_response::<[u8], Answer>()
                .request_user_header::<RequestMessage>()
                .max_servers(1)
                .max_clients(MAX_PARTIES)
                .max_nodes(MAX_NODES)
                .max_active_requests_per_client(2)
                .max_response_buffer_size(2)
                // The request of a client that died waiting is worth nothing to anybody.
                .enable_fire_and_forget_requests(false)
                .open_or_create())
        })?;
        let wake = opened(bench, || {
            Ok(service(node, bench, Topic::Wake)?
                .event()
                .max_listeners(1)
                .max_notifiers(MAX_PARTIES)
                .max_nodes(MAX_NODES)
                .open_or_create())
        })?;
        Ok(Self { commands, wake })
    }

    /// The simulation's side.
    pub(crate) fn inbox(&self, name: NameLock) -> Result<SharedInbox, WireError> {
        let server = self.commands.server_builder().create().map_err(internal)?;
        let bell = self.wake.listener_builder().create().map_err(internal)?;
        Ok(SharedInbox { server, bell, _name: name })
    }

    /// The side of whoever asks.
    pub(crate) fn commander(&self, bench: &BenchName, root: &Root) -> Result<SharedCommander, WireError> {
        let what = "processes that ask for changes";
        let client = self
            .commands
            .client_builder()
            .initial_max_slice_len(MAX_DOCUMENT)
            .create()
            .map_err(|error| full(bench, what, MAX_PARTIES, &error))?;
        let bell = self.wake.notifier_builder().create().map_err(|error| full(bench, what, MAX_PARTIES, &error))?;
        Ok(SharedCommander { client, bell, bench: bench.clone(), _root: root.clone() })
    }
}

/// See [`Inbox`].
#[derive(Debug)]
pub struct SharedInbox {
    server: Server<Ipc, [u8], RequestMessage, Answer, ()>,
    bell: Listener<Ipc>,
    _name: NameLock,
}

impl Inbox for SharedInbox {
    fn serve(&mut self, patience: Duration, mut answer: impl FnMut(&Request) -> Answer) -> Result<usize, WireError> {
        let mut served = 0;
        let mut waited = false;
        loop {
            while let Some(request) = self.server.receive().map_err(internal)? {
                let reply = answer(&Request::received(*request.user_header(), request.payload()));
                // A client that has given up, or died, does not hear the answer: that is its own affair.
                if let Err(error) = request.send_copy(reply) {
                    tracing::debug!(?error, "an answer was not delivered");
                }
                served += 1;
            }
            if served > 0 || waited {
                return Ok(served);
            }
            match self.bell.timed_wait(|_| (), patience) {
                // A signal, such as the one that continues a stopped process, ends the wait and nothing else.
                Ok(_) | Err(ListenerWaitError::InterruptSignal) => {}
                Err(error) => return Err(internal(error)),
            }
            waited = true;
        }
    }
}

/// See [`Commander`].
#[derive(Debug)]
pub struct SharedCommander {
    client: Client<Ipc, [u8], RequestMessage, Answer, ()>,
    bell: Notifier<Ipc>,
    bench: BenchName,
    _root: Root,
}

impl Commander for SharedCommander {
    fn ask(&mut self, request: &Request, patience: Duration) -> Result<Answer, WireError> {
        let deadline = Instant::now() + patience;
        let pending = loop {
            let document = request.document.as_bytes();
            let mut loan = self.client.loan_slice(document.len()).map_err(internal)?;
            *loan.user_header_mut() = request.message();
            loan.payload_mut().copy_from_slice(document);
            let pending = loan.send().map_err(internal)?;
            if pending.number_of_server_connections() > 0 {
                break pending;
            }
            // Nobody has it: a simulation that is just starting, or restarting, may open its inbox in time.
            if Instant::now() >= deadline {
                return Err(WireError::NoAnswer(self.bench.clone()));
            }
            std::thread::sleep(Duration::from_millis(1));
        };
        if let Err(error) = self.bell.notify() {
            // The simulation also looks by itself, only later.
            tracing::debug!(?error, "the simulation could not be woken");
        }
        loop {
            if let Some(response) = pending.receive().map_err(internal)? {
                return Ok(*response.payload());
            }
            if Instant::now() >= deadline {
                return Err(WireError::NoAnswer(self.bench.clone()));
            }
            // An answer takes some tens of microseconds and one step of the simulation.
            std::thread::sleep(Duration::from_micros(100));
        }
    }
}
