//! A running Rerun viewer that is shown what is recorded. It is never waited for: what it does not take waits in a bounded queue, and what is
//! more than that is left out and counted. What came first stays first in the queue, so that a viewer that comes late knows what it is shown.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use crossbeam::channel::{Receiver, Sender, bounded};
use rerun::external::re_uri::ProxyUri;
use rerun::log::LogMsg;
use rerun::sink::{GrpcSink, GrpcSinkConnectionState, LogSink};

use crate::error::TapeError;
use crate::viewer::{AskViewer, ViewerState, ViewerStatus};

/// Messages that wait for the viewer, beside a hundred in rerun's own queue.
const WAITING: usize = 128;
/// How long the viewer may take for what waits in rerun's queue when no more comes.
const FLUSH: Duration = Duration::from_secs(1);

/// Where what is recorded is shown. Clones show it in the same viewer, which is done when the last of them goes.
#[derive(Clone)]
pub(crate) struct Viewer {
    messages: Sender<LogMsg>,
    told: Arc<EventOrRemark>,
}

#[derive(Default)]
struct EventOrRemark {
    shown: AtomicU64,
    left_out: AtomicU64,
    is_done: AtomicBool,
}

impl Viewer {
    /// Looks for a viewer at `HOST:PORT`, now and until one answers.
    ///
    /// # Errors
    /// No such address.
    pub(crate) fn at(address: &str) -> Result<(Self, AskViewer), TapeError> {
        let url = if address.contains("://") { address.to_owned() } else { format!("rerun+http://{address}/proxy") };
        let refused = |problem: String| TapeError::Viewer { address: address.to_owned(), problem };
        // Without a port it would be looked for where the web is.
        let has_port = address.rsplit_once(':').is_some_and(|(_, port)| port.parse::<u16>().is_ok());
        if !address.contains("://") && !has_port {
            return Err(refused("there is no port in it".to_owned()));
        }
        let uri: ProxyUri = url.parse().map_err(|error| refused(format!("{error}")))?;
        let sink = Arc::new(GrpcSink::new(uri));
        // When rerun's sink is dropped it waits for its viewer, for ever if need be: it ends with the process.
        std::mem::forget(sink.clone());
        let (messages, waiting) = bounded(WAITING);
        let told = Arc::new(EventOrRemark::default());
        let ask = {
            let (sink, told, waiting) = (sink.clone(), told.clone(), waiting.clone());
            AskViewer(Arc::new(move || status(&sink, &told, &waiting)))
        };
        let counts = told.clone();
        std::thread::Builder::new()
            .name("viewer".into())
            .spawn(move || show(&sink, &waiting, &counts))
            .map_err(|error| refused(format!("no thread for it: {error}")))?;
        Ok((Self { messages, told }, ask))
    }

    /// Shows a message, if it can wait.
    pub(crate) fn show(&self, message: &LogMsg) {
        if self.messages.try_send(message.clone()).is_err() {
            self.told.left_out.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// Hands on what waits, until nothing more comes.
fn show(sink: &GrpcSink, waiting: &Receiver<LogMsg>, told: &EventOrRemark) {
    for message in waiting {
        sink.send(message);
        let is_gone = matches!(sink.status(), GrpcSinkConnectionState::Disconnected(_));
        let count = if is_gone { &told.left_out } else { &told.shown };
        count.fetch_add(1, Ordering::Relaxed);
    }
    let _ = sink.flush_blocking(FLUSH);
    told.is_done.store(true, Ordering::Relaxed);
}

fn status(sink: &GrpcSink, told: &EventOrRemark, waiting: &Receiver<LogMsg>) -> ViewerStatus {
    let state = match sink.status() {
        GrpcSinkConnectionState::Connecting { .. } => ViewerState::Waiting,
        GrpcSinkConnectionState::Connected if waiting.is_full() => ViewerState::Behind,
        GrpcSinkConnectionState::Connected => ViewerState::Showing,
        GrpcSinkConnectionState::Disconnected(_) => ViewerState::Gone,
    };
    let [shown, left_out] = [&told.shown, &told.left_out].map(|count| count.load(Ordering::Relaxed));
    ViewerStatus { state, shown, left_out, is_done: told.is_done.load(Ordering::Relaxed) }
}
