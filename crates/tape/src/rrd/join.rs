//! The parts of a recording as one file: every message as it is, each thing that every part begins with only once.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use rerun::external::re_log_encoding::{CrateVersion, Decoder, Encoder, EncodingOptions};
use rerun::log::LogMsg;

use super::ledger::Ledger;
use crate::error::TapeError;

/// Puts `parts` together at `target`, which must not be there yet. Returns its size.
///
/// # Errors
/// A part cannot be read, or the target not be written; no half of it is left then.
pub(crate) fn join(parts: &[PathBuf], target: &Path) -> Result<u64, TapeError> {
    let ledger = Ledger::create(target).map_err(|error| TapeError::unfit(target, &error))?;
    copy(parts, target, ledger).inspect_err(|_| {
        // The parts are all there still.
        let _ = std::fs::remove_file(target);
    })
}

fn copy(parts: &[PathBuf], target: &Path, ledger: Ledger) -> Result<u64, TapeError> {
    let stopped = |error: String| TapeError::Stopped { path: target.to_owned(), problem: error, bytes: 0 };
    let encoder = Encoder::new_eager(CrateVersion::LOCAL, EncodingOptions::PROTOBUF_COMPRESSED, ledger);
    let mut encoder = encoder.map_err(|error| stopped(error.to_string()))?;
    for (number, part) in parts.iter().enumerate() {
        let file = File::open(part).map_err(|error| TapeError::read(part, error))?;
        for message in Decoder::<LogMsg>::decode_lazy(BufReader::with_capacity(1 << 20, file)) {
            let message = message.map_err(|error| TapeError::read(part, error))?;
            let is_layout = message.store_id().is_blueprint();
            let is_head = is_layout || matches!(message, LogMsg::SetStoreInfo(_));
            if number > 0 && is_head {
                continue;
            }
            if let Err(error) = encoder.append(&message) {
                drop(encoder.into_inner());
                return Err(stopped(error.to_string()));
            }
        }
    }
    let finished = encoder.finish();
    let ledger = encoder.into_inner().map_err(|error| stopped(error.to_string()))?;
    finished.map_err(|error| stopped(error.to_string()))?;
    ledger.sync().map_err(|error| stopped(error.to_string()))?;
    Ok(ledger.len())
}
