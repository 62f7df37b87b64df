//! What an `.rrd` file is on the outside: the few bytes before, between and behind its messages. All numbers are
//! little-endian, as rerun's `re_log_encoding` (0.36) writes them; what is in a message is none of this module's business.

/// Bytes before a stream: `RRF2`, the version of rerun, how it is encoded.
pub(crate) const STREAM_HEADER: u64 = 12;
/// Bytes before a message: kind, length.
pub(crate) const HEADER: u64 = 16;
/// Bytes behind the table at an end: where the table is and how long, its checksum, `RRF2FOOT`, and how many there are.
pub(crate) const FOOTER: u64 = 32;
/// A message that claims to be larger than this is not one: a hundred times what a recorder puts into one.
const MOST_BYTES: u64 = 1 << 28;
/// The table at an end has a line for every message.
const MOST_TABLE: u64 = 1 << 31;

/// How the checksum of a table begins, as rerun has it.
const TABLE_SEED: u32 = 7_850_921;

/// What a message is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// None: the end of a stream, with a table of its chunks.
    End,
    /// Which recording it is.
    Store,
    /// Rows.
    Chunk,
    /// Which layout is shown.
    Layout,
}

/// Four bytes of a slice as a number; 0 where there are fewer.
fn number<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    bytes.get(at..at + N).and_then(|bytes| bytes.try_into().ok()).unwrap_or([0; N])
}

/// Kind and length of a message from its header; `None` if it is none, or of no length that it can have.
pub(crate) fn header(bytes: &[u8]) -> Option<(Kind, u64)> {
    let kind = match u64::from_le_bytes(number(bytes, 0)) {
        0 => Kind::End,
        1 => Kind::Store,
        2 => Kind::Chunk,
        3 => Kind::Layout,
        _ => return None,
    };
    let length = u64::from_le_bytes(number(bytes, 8));
    // Sixteen zeros are no end: ours have a table, even of nothing.
    let most = if kind == Kind::End { MOST_TABLE } else { MOST_BYTES };
    (1..=most).contains(&length).then_some((kind, length))
}

/// Whether bytes can be a message in protobuf: fields, of which the last ends where they end.
pub(crate) fn is_fields(mut bytes: &[u8]) -> bool {
    fn varint(bytes: &mut &[u8]) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let (byte, rest) = bytes.split_first()?;
            *bytes = rest;
            value |= u64::from(byte & 0x7f) << shift;
            if *byte < 0x80 {
                return Some(value);
            }
        }
        None
    }
    let field = |bytes: &mut &[u8]| {
        let tag = varint(bytes)?;
        let length = match tag & 7 {
            0 => varint(bytes).map(|_| 0)?,
            1 => 8,
            2 => usize::try_from(varint(bytes)?).ok()?,
            5 => 4,
            _ => return None,
        };
        *bytes = bytes.get(length..)?;
        Some(())
    };
    !bytes.is_empty()
        && std::iter::from_fn(|| (!bytes.is_empty()).then(|| field(&mut bytes))).all(|field| field.is_some())
}

/// Whether a stream begins with these bytes: compressed or not, as protobuf.
pub(crate) fn is_stream(bytes: &[u8]) -> bool {
    matches!(bytes, [b'R', b'R', b'F', b'2', _, _, _, _, 0 | 1, 2, 0, 0, ..])
}

/// Whether a footer points at its table, which begins at one of `begins`, and fits it.
pub(crate) fn footer_fits(footer: &[u8], table: &[u8], begins: [u64; 2]) -> bool {
    let [start, length] = [0, 8].map(|at| u64::from_le_bytes(number(footer, at)));
    let checksum = u32::from_le_bytes(number(footer, 16));
    footer.len() as u64 == FOOTER
        && footer[20..] == *b"RRF2FOOT\x01\0\0\0"
        && begins.contains(&start)
        && length == table.len() as u64
        && checksum == xxhash_rust::xxh32::xxh32(table, TABLE_SEED)
}
