//! The columns of a trajectory as Apache Parquet, a row group at a time.

use std::io;
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::{DoubleType, Int32Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use tempfile::NamedTempFile;

/// Rows that are gathered before they are written: a few megabytes.
const GROUP: usize = 1 << 15;

/// A Parquet file in the making.
pub(super) struct Columns {
    writer: SerializedFileWriter<NamedTempFile>,
    values: Vec<Vec<f64>>,
    contact: Vec<i32>,
}

impl Columns {
    /// Begins a file whose last column is the contact mask and whose others are doubles.
    pub(super) fn create(file: NamedTempFile, names: &[String]) -> io::Result<Self> {
        let field = |(i, name): (usize, &String)| {
            let physical = if i + 1 == names.len() { Physical::INT32 } else { Physical::DOUBLE };
            Type::primitive_type_builder(name, physical)
                .with_repetition(Repetition::REQUIRED)
                .build()
                .map(Arc::new)
                .map_err(io::Error::other)
        };
        let fields = names.iter().enumerate().map(field).collect::<io::Result<Vec<_>>>()?;
        let schema = Type::group_type_builder("trajectory").with_fields(fields).build().map_err(io::Error::other)?;
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
        let writer =
            SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).map_err(io::Error::other)?;
        Ok(Self { writer, values: vec![Vec::new(); names.len() - 1], contact: Vec::new() })
    }

    /// Adds a row.
    pub(super) fn push(&mut self, row: &[f64], contact: u32) -> io::Result<()> {
        for (column, value) in self.values.iter_mut().zip(row) {
            column.push(*value);
        }
        // Sixteen masses: the mask fits.
        self.contact.push(i32::try_from(contact).unwrap_or(i32::MAX));
        if self.contact.len() == GROUP { self.flush().map_err(io::Error::other) } else { Ok(()) }
    }

    fn flush(&mut self) -> parquet::errors::Result<()> {
        if self.contact.is_empty() {
            return Ok(());
        }
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.values {
            if let Some(mut out) = group.next_column()? {
                out.typed::<DoubleType>().write_batch(column, None, None)?;
                out.close()?;
            }
            column.clear();
        }
        if let Some(mut out) = group.next_column()? {
            out.typed::<Int32Type>().write_batch(&self.contact, None, None)?;
            out.close()?;
        }
        self.contact.clear();
        group.close()?;
        Ok(())
    }

    /// Writes what is left and the footer.
    pub(super) fn finish(mut self) -> io::Result<NamedTempFile> {
        self.flush().map_err(io::Error::other)?;
        self.writer.into_inner().map_err(io::Error::other)
    }
}
