//! Whether arrow may be given the bytes of a message. Arrow takes lengths and types in them at their word: it panics on some,
//! and on others asks the system for as many bytes as a damaged length says, which ends the process. Files with checksums do
//! not come that far; those from before there were any do.
//!
//! Only what recordings of ours hold passes: a schema and one batch of plain columns. Whatever else there is in arrow
//! (dictionaries, unions, views, compressed bodies) is refused, not checked.

use rerun::external::arrow::ipc::{self, Field, RecordBatch, Schema, TimeUnit, Type};

use super::fence::Unreadable;

/// How deep types may lie in one another: a list of structs of numbers is three.
const DEEPEST: usize = 8;
/// The widest entry of fixed size, in bytes: an id has 16.
const WIDEST: i32 = 1 << 12;

/// Key in the metadata of a chunk's schema under which its entity stands.
const ENTITY: &str = "rerun:entity_path";

type Checked<T = ()> = Result<T, Unreadable>;

fn wrong<T>(what: &'static str) -> Checked<T> {
    Err(Unreadable::Arrow(what))
}

fn ensure(is_so: bool, what: &'static str) -> Checked {
    if is_so { Ok(()) } else { wrong(what) }
}

/// Checks a schema and a batch, as arrow's stream writer makes them. Returns the entity that they are about.
pub(super) fn check(stream: &[u8]) -> Checked<String> {
    let mut rest = stream;
    let (schema, body, after) = message(rest)?;
    let Some(schema) = schema.header_as_schema() else { return wrong("no schema at its beginning") };
    ensure(body.is_empty(), "a schema with a body")?;
    check_schema(schema)?;
    rest = after;
    let (batch, body, _) = message(rest)?;
    let Some(batch) = batch.header_as_record_batch() else { return wrong("no rows behind its schema") };
    check_batch(batch, body.len())?;
    let metadata = schema.custom_metadata().into_iter().flatten();
    let entity = metadata.filter(|pair| pair.key() == Some(ENTITY)).find_map(|pair| pair.value());
    entity.map_or_else(|| wrong("columns of nothing"), |entity| Ok(entity.to_owned()))
}

/// The first message of `bytes`, its body, and what follows.
fn message(bytes: &[u8]) -> Checked<(ipc::Message<'_>, &[u8], &[u8])> {
    let Some((&[0xff, 0xff, 0xff, 0xff], rest)) = bytes.split_first_chunk::<4>() else {
        return wrong("no message where one should be");
    };
    let Some((length, rest)) = rest.split_first_chunk::<4>() else { return wrong("a message without length") };
    let length = usize::try_from(i32::from_le_bytes(*length)).ok().filter(|length| *length <= rest.len());
    let Some(length) = length else { return wrong("a length beyond its end") };
    let (head, rest) = rest.split_at(length);
    let Ok(message) = ipc::root_as_message(head) else { return wrong("a head that is none") };
    let length = usize::try_from(message.bodyLength()).ok().filter(|length| *length <= rest.len());
    let Some(length) = length else { return wrong("a body beyond its end") };
    let (body, rest) = rest.split_at(length);
    Ok((message, body, rest))
}

fn check_schema(schema: Schema<'_>) -> Checked {
    ensure(schema.endianness() == ipc::Endianness::Little, "another byte order")?;
    let pairs = schema.custom_metadata().into_iter().flatten();
    pairs.into_iter().try_for_each(|pair| ensure(pair.key().is_some() && pair.value().is_some(), "half a pair"))?;
    let Some(fields) = schema.fields() else { return wrong("a schema without columns") };
    fields.into_iter().try_for_each(|field| check_field(field, 0))
}

fn check_field(field: Field<'_>, depth: usize) -> Checked {
    ensure(depth < DEEPEST, "types within types without end")?;
    ensure(field.name().is_some(), "a column without name")?;
    ensure(field.dictionary().is_none(), "a dictionary")?;
    let children = field.children().map_or(0, |children| children.len());
    let has = |there: bool| ensure(there, "a type without what it consists of");
    let unit = |unit: Option<TimeUnit>| {
        ensure(unit.is_some_and(|unit| (TimeUnit::SECOND..=TimeUnit::NANOSECOND).contains(&unit)), "an unknown unit")
    };
    match field.type_type() {
        Type::Null | Type::Bool | Type::Binary | Type::LargeBinary | Type::Utf8 | Type::LargeUtf8 => {
            has(children == 0)?;
        }
        Type::Int => {
            let width = field.type_as_int().map(|int| int.bitWidth());
            ensure(matches!(width, Some(8 | 16 | 32 | 64)), "whole numbers of an unknown width")?;
        }
        Type::FloatingPoint => {
            let precision = field.type_as_floating_point().map(|float| float.precision());
            let known = ipc::Precision::HALF..=ipc::Precision::DOUBLE;
            ensure(precision.is_some_and(|precision| known.contains(&precision)), "numbers of an unknown width")?;
        }
        Type::Timestamp => unit(field.type_as_timestamp().map(|time| time.unit()))?,
        Type::Duration => unit(field.type_as_duration().map(|time| time.unit()))?,
        Type::FixedSizeBinary => {
            let width = field.type_as_fixed_size_binary().map(|binary| binary.byteWidth());
            ensure(width.is_some_and(|width| (0..=WIDEST).contains(&width)), "entries of an unlikely width")?;
        }
        Type::List | Type::LargeList => has(children == 1)?,
        Type::FixedSizeList => {
            has(children == 1)?;
            let size = field.type_as_fixed_size_list().map(|list| list.listSize());
            ensure(size.is_some_and(|size| (0..=WIDEST).contains(&size)), "lists of an unlikely length")?;
        }
        Type::Struct_ => has(field.children().is_some())?,
        _ => return wrong("a type that recordings do not have"),
    }
    field.children().into_iter().flatten().try_for_each(|child| check_field(child, depth + 1))
}

fn check_batch(batch: RecordBatch<'_>, body: usize) -> Checked {
    ensure(batch.compression().is_none(), "a compressed body")?;
    // Even what is counted in bits takes an eighth of a byte an entry; only nothing at all takes no room.
    let most = 8 * body as i64 + 8;
    ensure((0..=most).contains(&batch.length()), "more rows than there is room for")?;
    for node in batch.nodes().into_iter().flatten() {
        ensure((0..=most).contains(&node.length()), "more entries than there is room for")?;
        ensure((0..=node.length()).contains(&node.null_count()), "more entries missing than there are")?;
    }
    for buffer in batch.buffers().into_iter().flatten() {
        let end = buffer.offset().checked_add(buffer.length()).filter(|_| buffer.offset() >= 0 && buffer.length() >= 0);
        ensure(end.is_some_and(|end| end <= body as i64), "a column beyond the end of its body")?;
    }
    Ok(())
}
