//! The checksum in every message. Rerun's format has none: a changed byte in a number reads as another number.
//!
//! A message is a protobuf message behind its length, and whoever reads protobuf passes over fields that it does not know.
//! So the checksum is one more field at the end of the message that it protects: every reader of `.rrd` files takes the file
//! as before, a message and its checksum are written in one, and files from before there were checksums stay readable.
//!
//! ```text
//! kind, length: 16 bytes | the message | tag: 3 bytes | number: u32 | CRC-32: u32
//! ```
//!
//! The CRC covers all that is before it, the length and the number too; that of the first message, number 0, the header
//! of the stream as well. Numbers rise by one, so that a message that is not there is missed.

/// Bytes of kind and length before a message.
const HEADER: usize = super::frame::HEADER as usize;
/// Field 7700 of protobuf's wire type 1, 64 bits as they are: 7700 << 3 | 1, seven bits a byte.
const TAG: [u8; 3] = [0xa1, 0xe1, 0x03];
/// All that is added to a message.
pub(super) const BYTES: usize = TAG.len() + 8;

/// What the checksum of a message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Seal {
    /// There is none.
    None,
    /// It is the message that was written, with this number.
    Fits(u32),
    /// It is not.
    Broken,
}

fn crc(stream_header: &[u8], number: u32, before: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    if number == 0 {
        crc.update(stream_header);
    }
    crc.update(before);
    crc.finalize()
}

/// Adds a checksum to an encoded message, which begins with its kind and length.
pub(crate) fn put(message: &mut Vec<u8>, number: u32, stream_header: &[u8]) {
    let length = (message.len() - HEADER + BYTES) as u64;
    message[8..HEADER].copy_from_slice(&length.to_le_bytes());
    message.extend(TAG);
    message.extend(number.to_le_bytes());
    let crc = crc(stream_header, number, message);
    message.extend(crc.to_le_bytes());
}

/// Whether the last [`BYTES`] of a message have the mark of a checksum.
pub(super) fn is_marked(last: &[u8; BYTES]) -> bool {
    last.starts_with(&TAG)
}

/// What the checksum of a message says, which begins with its kind and length, in a stream with this header.
pub(crate) fn check(message: &[u8], stream_header: &[u8]) -> Seal {
    let Some((before, crc_there)) = message.split_last_chunk::<4>() else { return Seal::None };
    let Some((rest, number)) = before.split_last_chunk::<4>() else { return Seal::None };
    if rest.len() < HEADER || !rest.ends_with(&TAG) {
        return Seal::None;
    }
    let number = u32::from_le_bytes(*number);
    if crc(stream_header, number, before) == u32::from_le_bytes(*crc_there) { Seal::Fits(number) } else { Seal::Broken }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_changed_bit_is_noticed_and_a_message_from_before_checksums_has_none() {
        let stream = *b"RRF2\x00\x24\x03\x00\x01\x02\x00\x00";
        for number in [0, 1, 70_000] {
            let mut message = [2_u64.to_le_bytes(), 5_u64.to_le_bytes()].concat();
            message.extend(b"\x0a\x03abc");
            assert_eq!(check(&message, &stream), Seal::None);
            put(&mut message, number, &stream);
            assert_eq!(message[8..16], 16_u64.to_le_bytes());
            assert_eq!(check(&message, &stream), Seal::Fits(number));
            let tag = message.len() - BYTES..message.len() - 8;
            for (byte, bit) in (0..message.len()).flat_map(|byte| (0..8).map(move |bit| (byte, bit))) {
                let mut changed = message.clone();
                changed[byte] ^= 1 << bit;
                let expected = if tag.contains(&byte) { Seal::None } else { Seal::Broken };
                assert_eq!(check(&changed, &stream), expected, "bit {bit} of byte {byte}");
            }
            let mut other = stream;
            other[5] ^= 1;
            assert_eq!(
                check(&message, &other) == Seal::Broken,
                number == 0,
                "the first one covers the stream's header"
            );
        }
    }

    /// Against the CRC-32 of zlib: `python3 -c 'import zlib; print(hex(zlib.crc32(b"123456789")))'`.
    #[test]
    fn val_it_is_the_crc_that_everybody_has() {
        assert_eq!(crc(b"", 1, b"123456789"), 0xcbf4_3926);
        assert_eq!(crc(b"1234", 0, b"56789"), 0xcbf4_3926);
    }
}
