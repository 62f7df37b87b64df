//! Decodes messages whose bytes may be anything: what a damaged length could bring about is looked for first, and should
//! a library panic all the same, that is an error too. No bytes end the process.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use re_protos::common::v1alpha1::{Compression, StoreKind};
use re_protos::log_msg::v1alpha1::ArrowMsg;
use rerun::external::re_log_encoding::external::lz4_flex;
use rerun::external::re_log_encoding::{Decodable, ToApplication};
use rerun::log::Chunk;

use super::ipc;
use crate::stream::HEADER;

/// A message takes no more memory than this when it is unpacked: a hundred times what a recorder puts into one.
const MOST_BYTES: u64 = 1 << 28;
/// How many times larger LZ4 can make something: a byte for every 255 of a run.
const LZ4_MOST: u64 = 255;

/// Why a message cannot be decoded.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Unreadable {
    /// It is no message of the kind it says.
    #[error("a message of no known form: {0}")]
    Message(String),
    /// Unpacked it would be larger than it can be.
    #[error("a message that would take {0} bytes unpacked")]
    TooLarge(u64),
    /// It cannot be unpacked.
    #[error("a message that cannot be unpacked: {0}")]
    Packed(String),
    /// Its columns are no columns.
    #[error("columns that cannot be read: {0}")]
    Arrow(&'static str),
    /// They are, but not those of a chunk.
    #[error("columns that cannot be read: {0}")]
    Chunk(String),
    /// A library panicked.
    #[error("columns that cannot be read")]
    Panic,
    /// It is a chunk, and does not hold what its entity has.
    #[error("{0}")]
    Content(String),
    /// It is not the message that was written.
    #[error("the checksum does not fit")]
    Checksum,
}

/// What a message of rows is about, as far as can be told before they are decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct About {
    /// The recording that it belongs to, by its name in the stream: that of the run.
    pub(super) recording: String,
    /// Its entity, with a slash before it or without.
    pub(super) entity: String,
    /// Whether it is about a layout of the viewer.
    pub(super) is_layout: bool,
}

/// The chunk in an encoded message, which begins with its kind and length; `None` if it is about
/// something that is not wanted.
///
/// # Errors
/// Whatever is wrong with it.
pub(super) fn chunk(message: &[u8], wanted: impl FnOnce(&About) -> bool) -> Result<Option<(About, Chunk)>, Unreadable> {
    let body = message.get(HEADER as usize..).unwrap_or_default();
    let mut message = ArrowMsg::from_rrd_bytes(body).map_err(|error| Unreadable::Message(error.to_string()))?;
    let Some(store) = &message.store_id else { return Err(Unreadable::Message("no store".to_owned())) };
    let is_layout = store.kind() == StoreKind::Blueprint;
    let recording = store.recording_id.clone();
    unpack(&mut message)?;
    let about = About { recording, entity: ipc::check(&message.payload)?, is_layout };
    if !wanted(&about) {
        return Ok(None);
    }
    let decoded = quietly(|| {
        let message = message.to_application(()).map_err(|error| Unreadable::Chunk(error.to_string()))?;
        Chunk::from_arrow_msg(&message).map_err(|error| Unreadable::Chunk(error.to_string()))
    });
    decoded.unwrap_or(Err(Unreadable::Panic)).map(|chunk| Some((about, chunk)))
}

/// Whether bytes are a message of rows, as far as that can be told without decoding its columns.
pub(super) fn is_message(bytes: &[u8]) -> bool {
    chunk(bytes, |_| false).is_ok()
}

/// Unpacks what is in a message into as much memory as it can need, and no more.
fn unpack(message: &mut ArrowMsg) -> Result<(), Unreadable> {
    let (packed, unpacked) = (message.payload.len() as u64, message.uncompressed_size);
    match message.compression() {
        Compression::Unspecified | Compression::None => {}
        Compression::Lz4 => {
            if unpacked > MOST_BYTES || unpacked > LZ4_MOST * (packed + 1) {
                return Err(Unreadable::TooLarge(unpacked));
            }
            let mut bytes = vec![0; usize::try_from(unpacked).unwrap_or_default()];
            let length = lz4_flex::block::decompress_into(&message.payload, &mut bytes)
                .map_err(|error| Unreadable::Packed(error.to_string()))?;
            bytes.truncate(length);
            message.payload = bytes.into();
            message.set_compression(Compression::None);
        }
    }
    Ok(())
}

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs what may panic, and says nothing of it: the second net, behind the checks. Whoever has a panic hook with effects (a
/// screen that is given back) sets it before the first recording is opened: this one is then asked first.
pub(super) fn quietly<T>(work: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !QUIET.get() {
                report(panic);
            }
        }));
    });
    let before = QUIET.replace(true);
    // Whatever it was at work on is dropped.
    let done = catch_unwind(AssertUnwindSafe(work));
    QUIET.set(before);
    done.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_behind_the_fence_is_an_error_and_nothing_more() {
        assert_eq!(quietly(|| 1), Some(1));
        assert_eq!(quietly(|| -> u8 { panic!("as libraries do") }), None);
    }
}
