//! A table as Apache Parquet, a row group at a time.

use std::io;
use std::sync::Arc;

use files::Draft;
use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::column::reader::ColumnReader;
use parquet::data_type::{DoubleType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::ColumnKind;

/// Rows that are gathered before they are written: a few megabytes.
const GROUP: usize = 1 << 15;

/// A Parquet file in the making.
pub(super) struct Columns {
    writer: SerializedFileWriter<Draft>,
    doubles: Vec<Vec<f64>>,
    wholes: Vec<Wholes>,
    rows: usize,
}

enum Wholes {
    Int(Vec<i32>),
    Long(Vec<i64>),
}

impl Columns {
    /// Begins a file with these columns.
    pub(super) fn create(file: Draft, doubles: &[String], wholes: &[(&str, ColumnKind)]) -> io::Result<Self> {
        let kinds = doubles.iter().map(|name| (name.as_str(), ColumnKind::Double)).chain(wholes.iter().copied());
        let field = |(name, kind)| {
            let physical = match kind {
                ColumnKind::Double => Physical::DOUBLE,
                ColumnKind::Int => Physical::INT32,
                ColumnKind::Long => Physical::INT64,
            };
            Type::primitive_type_builder(name, physical)
                .with_repetition(Repetition::REQUIRED)
                .build()
                .map(Arc::new)
                .map_err(io::Error::other)
        };
        let fields = kinds.map(field).collect::<io::Result<Vec<_>>>()?;
        let schema = Type::group_type_builder("table").with_fields(fields).build().map_err(io::Error::other)?;
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
        let writer =
            SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).map_err(io::Error::other)?;
        let wholes = wholes.iter().map(|(_, kind)| match kind {
            ColumnKind::Long => Wholes::Long(Vec::new()),
            ColumnKind::Int | ColumnKind::Double => Wholes::Int(Vec::new()),
        });
        Ok(Self { writer, doubles: vec![Vec::new(); doubles.len()], wholes: wholes.collect(), rows: 0 })
    }

    /// Adds a row.
    pub(super) fn push(&mut self, doubles: &[f64], wholes: &[u64]) -> io::Result<()> {
        for (column, value) in self.doubles.iter_mut().zip(doubles) {
            column.push(*value);
        }
        for (column, value) in self.wholes.iter_mut().zip(wholes) {
            match column {
                Wholes::Int(column) => column.push(i32::try_from(*value).unwrap_or(i32::MAX)),
                Wholes::Long(column) => column.push(i64::try_from(*value).unwrap_or(i64::MAX)),
            }
        }
        self.rows += 1;
        if self.rows == GROUP { self.flush().map_err(io::Error::other) } else { Ok(()) }
    }

    fn flush(&mut self) -> parquet::errors::Result<()> {
        if self.rows == 0 {
            return Ok(());
        }
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.doubles {
            if let Some(mut out) = group.next_column()? {
                out.typed::<DoubleType>().write_batch(column, None, None)?;
                out.close()?;
            }
            column.clear();
        }
        for column in &mut self.wholes {
            if let Some(mut out) = group.next_column()? {
                match column {
                    Wholes::Int(column) => drop(out.typed::<Int32Type>().write_batch(column, None, None)?),
                    Wholes::Long(column) => drop(out.typed::<Int64Type>().write_batch(column, None, None)?),
                }
                out.close()?;
            }
            match column {
                Wholes::Int(column) => column.clear(),
                Wholes::Long(column) => column.clear(),
            }
        }
        self.rows = 0;
        group.close()?;
        Ok(())
    }

    /// Writes what is left and the footer.
    pub(super) fn finish(mut self) -> io::Result<Draft> {
        self.flush().map_err(io::Error::other)?;
        self.writer.into_inner().map_err(io::Error::other)
    }
}

/// How many rows a file has, as its footer says.
pub(super) fn rows(path: &std::path::Path) -> io::Result<u64> {
    let reader = SerializedFileReader::new(std::fs::File::open(path)?).map_err(io::Error::other)?;
    Ok(reader.metadata().file_metadata().num_rows().max(0) as u64)
}

/// A column of doubles, row group by row group.
pub(super) fn read(path: &std::path::Path, name: &str) -> io::Result<Vec<f64>> {
    let reader = SerializedFileReader::new(std::fs::File::open(path)?).map_err(io::Error::other)?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let at = schema.columns().iter().position(|column| column.name() == name);
    let at = at.ok_or_else(|| io::Error::other(format!("no column {name}")))?;
    let mut values = Vec::new();
    for k in 0..reader.num_row_groups() {
        let group = reader.get_row_group(k).map_err(io::Error::other)?;
        let rows = group.metadata().num_rows().max(0) as usize;
        let ColumnReader::DoubleColumnReader(mut column) = group.get_column_reader(at).map_err(io::Error::other)?
        else {
            return Err(io::Error::other(format!("column {name} has no doubles")));
        };
        let had = values.len();
        while values.len() - had < rows {
            let left = rows - (values.len() - had);
            if column.read_records(left, None, None, &mut values).map_err(io::Error::other)?.0 == 0 {
                return Err(io::Error::other(format!("column {name} ends early")));
            }
        }
    }
    Ok(values)
}
