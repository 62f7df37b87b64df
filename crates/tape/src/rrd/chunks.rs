//! Our columns as rerun's chunks, and back.

use std::sync::Arc;

use rerun::external::arrow::array::{
    Array, ArrayRef, Float64Array, ListArray, StringArray, StructArray, UInt32Array, UInt64Array,
};
use rerun::external::arrow::buffer::{OffsetBuffer, ScalarBuffer};
use rerun::external::arrow::datatypes::{DataType, Field, Fields};
use rerun::log::{Chunk, ChunkError, TimeColumn};
use rerun::{ComponentDescriptor, TimePoint, Timeline};

use super::fence::Unreadable;
use crate::batch::Batch;
use crate::schema;
use crate::snapshot::Snapshot;
use wire::{Column, Moment, StepLayout, Substitute};

/// `tau` on its timeline, where 1 is a second.
fn nanos(tau: f64) -> i64 {
    // Saturates, and takes NaN for 0: a timeline is for finding things, the exact value is in the columns.
    (tau * 1e9).round() as i64
}

fn step(seq: u64) -> i64 {
    i64::try_from(seq).unwrap_or(i64::MAX)
}

/// A moment on the three timelines.
pub(super) fn timepoint(at: Moment) -> TimePoint {
    TimePoint::default()
        .with(Timeline::new_sequence(schema::STEP), step(at.seq))
        .with(Timeline::new_duration(schema::TAU), nanos(at.tau))
        .with(Timeline::new_timestamp(schema::WALL), step(at.wall_ns))
}

/// The three timelines of many rows.
pub(super) fn timelines(at: impl Iterator<Item = Moment> + Clone) -> [TimeColumn; 3] {
    [
        TimeColumn::new_sequence(schema::STEP, at.clone().map(|m| step(m.seq))),
        TimeColumn::new_duration_nanos(schema::TAU, at.clone().map(|m| nanos(m.tau))),
        TimeColumn::new_timestamp_nanos_since_epoch(schema::WALL, at.map(|m| step(m.wall_ns))),
    ]
}

/// The component of JSON documents.
pub(super) fn document(text: &str) -> (ComponentDescriptor, ArrayRef) {
    (ComponentDescriptor::partial(schema::DOCUMENT), Arc::new(StringArray::from(vec![text])))
}

/// Every document in a chunk, row by row.
pub(super) fn documents(chunk: &Chunk) -> Vec<String> {
    let Some(list) = chunk.components().get_array(schema::DOCUMENT.into()) else { return Vec::new() };
    let Some(texts) = list.values().as_any().downcast_ref::<StringArray>() else { return Vec::new() };
    texts.iter().flatten().map(str::to_owned).collect()
}

/// Rows of `width` doubles as a component.
pub(super) fn doubles(values: Vec<f64>, width: usize) -> ListArray {
    let rows = values.len() / width.max(1);
    let field = Arc::new(Field::new("item", DataType::Float64, true));
    ListArray::new(
        field,
        OffsetBuffer::from_lengths(std::iter::repeat_n(width, rows)),
        Arc::new(Float64Array::from(values)),
        None,
    )
}

fn content(what: &str) -> Unreadable {
    Unreadable::Content(what.to_owned())
}

/// Steps as a chunk: one struct a row, its fields as [`schema::columns`] names them, then revision and flags.
pub(super) fn steps(batch: &Batch) -> Result<Chunk, ChunkError> {
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    for (column, values) in schema::columns(batch.layout()).into_iter().zip(&batch.values) {
        fields.push(Field::new(column.name, DataType::Float64, false));
        arrays.push(Arc::new(Float64Array::new(ScalarBuffer::from(values.clone()), None)));
    }
    fields.push(Field::new(schema::REVISION, DataType::UInt64, false));
    arrays.push(Arc::new(UInt64Array::from(batch.revision.clone())));
    fields.push(Field::new(schema::FLAGS, DataType::UInt32, false));
    arrays.push(Arc::new(UInt32Array::from(batch.flags.clone())));
    let rows = StructArray::new(Fields::from(fields), arrays, None);
    let field = Arc::new(Field::new("item", rows.data_type().clone(), true));
    let list =
        ListArray::new(field, OffsetBuffer::from_lengths(std::iter::repeat_n(1, batch.len())), Arc::new(rows), None);
    let times = timelines((0..batch.len()).map(|row| batch.moment(row)));
    Chunk::from_columns(schema::STEPS, times, [(ComponentDescriptor::partial(schema::ROW), list)])
}

/// How many control bearings rows of steps tell of.
fn bearings(rows: &StructArray) -> usize {
    let is_told = |bearing: &usize| {
        let (channels, index) = wire::force_channels(*bearing);
        let column = Column { channel: channels[1][0], index };
        rows.column_by_name(&column.name()).is_some()
    };
    1 + (1..rotor::MAX_BEARINGS).take_while(is_told).count()
}

/// The steps of a chunk that [`steps`] has made, by whichever version.
pub(super) fn read_steps(chunk: &Chunk, masses: usize) -> Result<Batch, Unreadable> {
    let list = chunk.components().get_array(schema::ROW.into()).ok_or_else(|| content("steps without rows"))?;
    if list.len() != list.values().len() || list.value_offsets().windows(2).any(|pair| pair[1] != pair[0] + 1) {
        return Err(content("not one step a row"));
    }
    let rows = list.values().as_any().downcast_ref::<StructArray>().ok_or_else(|| content("steps of another shape"))?;
    let column =
        |name: &str| rows.column_by_name(name).ok_or_else(|| content(&format!("steps without the column '{name}'")));
    let layout = StepLayout::new(masses).with_bearings(bearings(rows));
    let mut batch = Batch::new(layout);
    for (place, wanted) in batch.values.iter_mut().zip(layout.number_columns()) {
        let name = wanted.name();
        *place = match (rows.column_by_name(&name), wanted.channel.substitute()) {
            (Some(found), _) => doubles_of(found, &name)?,
            (None, Substitute::Zero) => vec![0.0; rows.len()],
            (None, Substitute::Channel(channel)) => {
                let name = Column { channel, ..wanted }.name();
                doubles_of(column(&name)?, &name)?
            }
            (None, Substitute::None) => return Err(content(&format!("steps without the column '{name}'"))),
        };
    }
    let revision = column(schema::REVISION)?.as_any().downcast_ref::<UInt64Array>();
    batch.revision = revision.ok_or_else(|| content("revisions of another type"))?.values().to_vec();
    let flags = column(schema::FLAGS)?.as_any().downcast_ref::<UInt32Array>();
    batch.flags = flags.ok_or_else(|| content("flags of another type"))?.values().to_vec();
    let times = |name: &'static str| {
        let column = chunk.timelines().get(&name.into());
        let column = column.ok_or_else(|| content(&format!("steps without the timeline '{name}'")))?;
        let times = column.times_raw().iter().map(|time| u64::try_from(*time).ok());
        times.collect::<Option<Vec<u64>>>().ok_or_else(|| content("times before there was time"))
    };
    batch.seq = times(schema::STEP)?;
    batch.wall_ns = times(schema::WALL)?;
    // Steps are found by their numbers.
    if batch.seq.len() != batch.revision.len() || !batch.seq.is_sorted_by(|a, b| a < b) {
        return Err(content("steps out of order"));
    }
    Ok(batch)
}

fn doubles_of(column: &ArrayRef, name: &str) -> Result<Vec<f64>, Unreadable> {
    let found = column.as_any().downcast_ref::<Float64Array>();
    Ok(found.ok_or_else(|| content(&format!("column '{name}' holds no doubles")))?.values().to_vec())
}

/// Snapshots as a chunk, a row of words each.
pub(super) fn snapshots(rows: &[(Moment, Snapshot)]) -> Result<Chunk, ChunkError> {
    let words: Vec<u64> = rows.iter().flat_map(|(_, snapshot)| snapshot.row()).collect();
    let list = ListArray::new(
        Arc::new(Field::new("item", DataType::UInt64, true)),
        OffsetBuffer::from_lengths(rows.iter().map(|(_, snapshot)| snapshot.width())),
        Arc::new(UInt64Array::from(words)),
        None,
    );
    let times = timelines(rows.iter().map(|(at, _)| *at));
    Chunk::from_columns(schema::SNAPSHOTS, times, [(ComponentDescriptor::partial(schema::SNAPSHOT), list)])
}

/// The snapshots of a chunk that [`snapshots`] has made.
pub(super) fn read_snapshots(chunk: &Chunk) -> Result<Vec<Snapshot>, Unreadable> {
    let list =
        chunk.components().get_array(schema::SNAPSHOT.into()).ok_or_else(|| content("snapshots without rows"))?;
    let read = |row: Option<ArrayRef>| {
        let row = row?;
        Snapshot::of_row(row.as_any().downcast_ref::<UInt64Array>()?.values())
    };
    list.iter().map(|row| read(row).ok_or_else(|| content("a snapshot of another shape"))).collect()
}

/// The moments of the rows of a chunk.
pub(super) fn moments(chunk: &Chunk) -> Vec<Moment> {
    let times = |name: &'static str| chunk.timelines().get(&name.into()).map_or(&[] as &[i64], TimeColumn::times_raw);
    let (seq, tau, wall) = (times(schema::STEP), times(schema::TAU), times(schema::WALL));
    let rows = seq.iter().zip(tau).zip(wall);
    rows.map(|((s, t), w)| Moment { seq: s.cast_unsigned(), tau: *t as f64 / 1e9, wall_ns: w.cast_unsigned() })
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use wire::{Channel, Step};

    use super::*;
    use crate::batch::tests::{any_layout, any_state};

    proptest! {
        #[test]
        fn steps_come_back_from_a_chunk_bit_for_bit(
            states in any_layout().prop_flat_map(|layout| proptest::collection::vec(any_state(layout), 1..20))
        ) {
            let mut batch = Batch::new(states[0].layout());
            for (i, state) in states.into_iter().enumerate() {
                let state = state.with_word(Channel::Seq, 7 + 3 * i as u64);
                batch.push(&state.with_word(Channel::WallNs, state.wall_ns() >> 1));
            }
            let read = read_steps(&steps(&batch).unwrap(), batch.layout().masses()).unwrap();
            prop_assert_eq!(read.len(), batch.len());
            for row in 0..batch.len() {
                prop_assert_eq!(read.state(row, 1), batch.state(row, 1));
            }
        }
    }
}
