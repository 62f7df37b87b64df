//! Messages as a file: rerun's encoder with a checksum in every message.
//!
//! Rerun's own `Encoder` counts the bytes that it writes itself, and its footer would point beside messages that have become
//! longer. Everything else is rerun's: how a message is encoded, and the table of chunks in the footer.

use std::collections::HashMap;
use std::io::Write;

use re_span::Span;
use rerun::external::re_log_encoding::{
    CrateVersion, Encodable, EncodeError, EncodingOptions, MessageHeader, MessageKind, RrdFooter, RrdManifestBuilder,
    StreamFooter, StreamHeader, ToTransport,
};
use rerun::external::re_log_types::StoreId;
use rerun::log::LogMsg;

use super::ledger::Ledger;
use crate::stream;

const OPTIONS: EncodingOptions = EncodingOptions::PROTOBUF_COMPRESSED;

/// A file being written. Every message is one write.
pub(super) struct Encoder {
    ledger: Ledger,
    stream_header: Vec<u8>,
    /// Of the next message.
    number: u32,
    manifests: HashMap<StoreId, RrdManifestBuilder>,
}

impl Encoder {
    /// Begins a stream.
    ///
    /// # Errors
    /// It cannot be written.
    pub(super) fn begin(mut ledger: Ledger) -> Result<Self, EncodeError> {
        let mut stream_header = Vec::new();
        let header = StreamHeader { fourcc: *b"RRF2", version: CrateVersion::LOCAL.to_bytes(), options: OPTIONS };
        header.to_rrd_bytes(&mut stream_header)?;
        ledger.write_all(&stream_header)?;
        Ok(Self { ledger, stream_header, number: 0, manifests: HashMap::new() })
    }

    /// Bytes written.
    pub(super) fn len(&self) -> u64 {
        self.ledger.len()
    }

    /// Writes a message, whole or not at all.
    ///
    /// # Errors
    /// It cannot be encoded or written.
    pub(super) fn append(&mut self, message: &LogMsg) -> Result<(), EncodeError> {
        let transport = message.to_transport(OPTIONS.compression)?;
        let mut encoded = Vec::new();
        transport.to_rrd_bytes(&mut encoded)?;
        stream::put(&mut encoded, self.number, &self.stream_header);
        let begins = self.ledger.len();
        self.ledger.write_all(&encoded)?;
        self.number = self.number.wrapping_add(1);
        if let LogMsg::ArrowMsg(store, message) = message {
            let span = Span {
                start: begins + MessageHeader::ENCODED_SIZE_BYTES as u64,
                len: (encoded.len() - MessageHeader::ENCODED_SIZE_BYTES) as u64,
            };
            let batch = re_sorbet::ChunkBatch::try_from(&message.batch)?;
            let manifest = self.manifests.entry(store.clone()).or_default();
            manifest.append(&batch, span, transport.byte_size_uncompressed())?;
        }
        Ok(())
    }

    /// Writes the end, from which readers find chunks without going through the file, and gives the file back.
    ///
    /// # Errors
    /// It cannot be written; the file is then as long as before.
    pub(super) fn finish(mut self) -> Result<Ledger, EncodeError> {
        let manifests = std::mem::take(&mut self.manifests).into_iter();
        let manifests = manifests.map(|(store, manifest)| Ok((store.clone(), manifest.build(store)?)));
        let footer = RrdFooter { manifests: manifests.collect::<Result<_, EncodeError>>()? };
        let mut encoded = Vec::new();
        footer.to_transport(())?.to_rrd_bytes(&mut encoded)?;
        let mut end = Vec::new();
        MessageHeader { kind: MessageKind::End, len: encoded.len() as u64 }.to_rrd_bytes(&mut end)?;
        let begins = self.ledger.len() + end.len() as u64;
        end.extend_from_slice(&encoded);
        StreamFooter::from_rrd_footer_bytes(begins, &encoded).to_rrd_bytes(&mut end)?;
        self.ledger.write_all(&end)?;
        Ok(self.ledger)
    }
}
