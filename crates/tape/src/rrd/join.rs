//! The parts of a recording as one file: every message as it is, each thing that every part begins with only once.

use std::path::{Path, PathBuf};

use rerun::external::re_log_encoding::Decoder;
use rerun::log::LogMsg;

use super::encode::Encoder;
use super::fence::{self, Unreadable};
use super::ledger::Ledger;
use super::read;
use super::write::plain;
use crate::damage::Damage;
use crate::error::TapeError;
use crate::stream::{Kind, Met, Walk};

/// Puts `parts` together at `target`, which must not be there yet. Returns its size.
///
/// # Errors
/// A part cannot be read or is damaged, or the target not be written; no half of it is left then.
pub(crate) fn join(parts: &[PathBuf], target: &Path) -> Result<u64, TapeError> {
    let ledger = Ledger::create(target).map_err(|error| TapeError::unfit(target, &error))?;
    copy(parts, target, ledger).inspect_err(|_| {
        // The parts are all there still.
        let _ = std::fs::remove_file(target);
    })
}

fn copy(parts: &[PathBuf], target: &Path, ledger: Ledger) -> Result<u64, TapeError> {
    let stopped = |problem: String| TapeError::Stopped { path: target.to_owned(), problem, bytes: 0 };
    let mut encoder = Encoder::begin(ledger).map_err(|error| stopped(plain(&error)))?;
    for (number, part) in parts.iter().enumerate() {
        let (file, bytes) = read::file(part)?;
        let mut walk = Walk::new(&file, bytes, fence::is_message);
        while let Some(met) = walk.next().map_err(|error| TapeError::read(part, error))? {
            let Met::Message { kind, bytes, .. } = met else { continue };
            let message = decode(walk.stream_header(), kind, bytes).map_err(|error| TapeError::read(part, error))?;
            let is_layout = message.store_id().is_blueprint();
            let is_head = is_layout || matches!(message, LogMsg::SetStoreInfo(_));
            if number == 0 || !is_head {
                encoder.append(&message).map_err(|error| stopped(plain(&error)))?;
            }
        }
        // What is lost in a part must not be lost from sight too.
        if let Some(problem) = Damage::notices(&walk.damage, false).into_iter().next() {
            return Err(TapeError::read(part, problem));
        }
    }
    let ledger = encoder.finish().map_err(|error| stopped(plain(&error)))?;
    ledger.sync().map_err(|error| stopped(error.to_string()))?;
    Ok(ledger.len())
}

/// A whole message, layouts and all.
fn decode(stream_header: &[u8], kind: Kind, message: Vec<u8>) -> Result<LogMsg, Unreadable> {
    if kind == Kind::Chunk {
        // Its lengths are looked at, whatever it is about.
        fence::chunk(&message, |_| false)?;
    }
    let mut decoder = Decoder::<LogMsg>::new();
    decoder.push_byte_chunk(stream_header.to_vec());
    decoder.push_byte_chunk(message);
    let decoded = fence::quietly(|| decoder.try_read()).ok_or(Unreadable::Panic)?;
    let decoded = decoded.map_err(|error| Unreadable::Message(error.to_string()))?;
    decoded.ok_or_else(|| Unreadable::Message("not whole".to_owned()))
}
