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

#[cfg(test)]
mod tests {
    use rerun::StoreKind;
    use rerun::external::arrow::array::Array;
    use rerun::external::re_log_encoding::{Encoder as Reruns, RawRrdManifest};
    use wire::{Channel, State, StepLayout};

    use super::*;
    use crate::batch::Batch;
    use crate::rrd::chunks;
    use crate::stream::{HEADER, Seal, check};

    fn messages() -> Vec<LogMsg> {
        let store = StoreId::new(StoreKind::Recording, "whirl", "run");
        let message = |first: u64| {
            let mut batch = Batch::new(StepLayout::new(1));
            (first..first + 10)
                .for_each(|seq| batch.push(&State::new(StepLayout::new(1)).with_word(Channel::Seq, seq)));
            LogMsg::ArrowMsg(store.clone(), chunks::steps(&batch).unwrap().to_arrow_msg().unwrap())
        };
        (0..20).map(|number| message(10 * number)).collect()
    }

    /// What the footer says of a column, as numbers.
    fn column(manifest: &RawRrdManifest, name: &str) -> Vec<u64> {
        let column = manifest.data.column_by_name(name).unwrap();
        let column = column.as_any().downcast_ref::<rerun::external::arrow::array::UInt64Array>();
        column.unwrap().values().to_vec()
    }

    /// The footer is the one that rerun's own encoder writes, but for where messages are that a checksum has made longer.
    #[test]
    fn val_the_footer_is_that_of_reruns_encoder_and_points_at_our_messages() {
        let (folder, messages) = (tempfile::tempdir().unwrap(), messages());
        let path = folder.path().join("a.rrd");
        let mut encoder = Encoder::begin(Ledger::create(&path).unwrap()).unwrap();
        messages.iter().for_each(|message| encoder.append(message).unwrap());
        let length = encoder.finish().unwrap().len();
        let ours = std::fs::read(&path).unwrap();
        assert_eq!(ours.len() as u64, length);
        let theirs = Reruns::encode(messages.iter().cloned().map(Ok)).unwrap();
        let manifest = |bytes: &[u8]| RawRrdManifest::from_rrd_bytes(bytes).unwrap().remove(0);
        let (our_manifest, their_manifest) = (manifest(&ours), manifest(&theirs));
        let (offset, size) = (RawRrdManifest::field_chunk_byte_offset(), RawRrdManifest::field_chunk_byte_size());
        let (offset, size) = (offset.name(), size.name());
        for (place, field) in their_manifest.data.schema().fields().iter().enumerate() {
            if ![offset, size].contains(&field.name()) {
                assert_eq!(our_manifest.data.column(place), their_manifest.data.column(place), "{}", field.name());
            }
        }
        let sizes = column(&our_manifest, size);
        assert_eq!(sizes, column(&their_manifest, size).iter().map(|size| size + 11).collect::<Vec<_>>());
        for (number, (begins, size)) in (0..).zip(column(&our_manifest, offset).into_iter().zip(sizes)) {
            let message = &ours[(begins - HEADER) as usize..(begins + size) as usize];
            assert_eq!(check(message, &ours[..12]), Seal::Fits(number));
        }
    }
}
