use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
#[cfg(feature = "lerobot")]
use parquet::data_type::{ByteArray, ByteArrayType, FloatType, Int64Type};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use crate::error::RecordingError;

const PAGE: usize = 8 << 20;

/// A column of a table: a value for each row, or a list of values.
#[derive(Debug)]
pub(super) struct TableColumn<'a> {
    pub(super) name: &'a str,
    /// Numbers in each row's list; `None` for values without lists.
    pub(super) list: Option<usize>,
    /// Those of one row after those of another.
    pub(super) values: TableValues<'a>,
}

#[derive(Debug)]
pub(super) enum TableValues<'a> {
    Doubles(&'a [f64]),
    #[cfg(feature = "lerobot")]
    Floats(&'a [f32]),
    #[cfg(feature = "lerobot")]
    Integers(&'a [i64]),
    #[cfg(feature = "lerobot")]
    Texts(&'a [&'a str]),
}

impl TableValues<'_> {
    fn physical(&self) -> Physical {
        match self {
            Self::Doubles(_) => Physical::DOUBLE,
            #[cfg(feature = "lerobot")]
            Self::Floats(_) => Physical::FLOAT,
            #[cfg(feature = "lerobot")]
            Self::Integers(_) => Physical::INT64,
            #[cfg(feature = "lerobot")]
            Self::Texts(_) => Physical::BYTE_ARRAY,
        }
    }
}

impl TableColumn<'_> {
    fn schema(&self) -> Result<Type, ParquetError> {
        let physical = self.values.physical();
        let value = |name: &str| {
            let text = (physical == Physical::BYTE_ARRAY).then_some(LogicalType::String);
            let value = Type::primitive_type_builder(name, physical).with_logical_type(text);
            value.with_repetition(Repetition::REQUIRED).build()
        };
        if self.list.is_none() {
            return value(self.name);
        }
        let list = Type::group_type_builder("list").with_repetition(Repetition::REPEATED);
        let list = list.with_fields(vec![Arc::new(value("element")?)]).build()?;
        let column = Type::group_type_builder(self.name).with_repetition(Repetition::REQUIRED);
        column.with_logical_type(Some(LogicalType::List)).with_fields(vec![Arc::new(list)]).build()
    }

    fn write(
        &self,
        rows: usize,
        group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    ) -> Result<(), ParquetError> {
        match &self.values {
            TableValues::Doubles(values) => self.write_values::<DoubleType>(rows, values, group),
            #[cfg(feature = "lerobot")]
            TableValues::Floats(values) => self.write_values::<FloatType>(rows, values, group),
            #[cfg(feature = "lerobot")]
            TableValues::Integers(values) => self.write_values::<Int64Type>(rows, values, group),
            #[cfg(feature = "lerobot")]
            TableValues::Texts(values) => {
                let values: Vec<ByteArray> = values.iter().map(|text| ByteArray::from(*text)).collect();
                self.write_values::<ByteArrayType>(rows, &values, group)
            }
        }
    }

    fn write_values<T: DataType>(
        &self,
        rows: usize,
        values: &[T::T],
        group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    ) -> Result<(), ParquetError> {
        let Some(mut column) = group.next_column()? else { return Ok(()) };
        let typed = column.typed::<T>();
        let values = &values[..rows * self.list.unwrap_or(1)];
        match self.list {
            None => typed.write_batch(values, None, None)?,
            Some(width) => {
                // Every value is there, and the first of each row begins a list.
                let begins: Vec<i16> = (0..values.len()).map(|k| i16::from(k % width != 0)).collect();
                typed.write_batch(values, Some(&vec![1; values.len()]), Some(&begins))?
            }
        };
        column.close()
    }
}

/// A table of named columns of one length as Apache Parquet, with texts that say where it comes from: one group of rows,
/// plain, uncompressed.
///
/// NaN stands for what is missing. Columns longer than the shortest are cut.
///
/// # Errors
/// [`RecordingError::Malformed`] for columns that Parquet cannot have; `path` is what it names.
pub fn parquet(
    path: &Path,
    columns: &[(String, &[f64])],
    facts: &[(&str, String)],
) -> Result<Vec<u8>, RecordingError> {
    let rows = columns.iter().map(|(_, values)| values.len()).min().unwrap_or(0);
    let columns: Vec<TableColumn<'_>> = columns
        .iter()
        .map(|(name, values)| TableColumn { name, list: None, values: TableValues::Doubles(values) })
        .collect();
    table(path, rows, &columns, facts)
}

/// A table whose columns have at least so many rows, as [`parquet`] writes it.
pub(super) fn table(
    path: &Path,
    rows: usize,
    columns: &[TableColumn<'_>],
    facts: &[(&str, String)],
) -> Result<Vec<u8>, RecordingError> {
    write(rows, columns, facts).map_err(|error| {
        RecordingError::malformed(path, "its columns", error.to_string(), "write CSV or MCAP")
    })
}

fn write(
    rows: usize,
    columns: &[TableColumn<'_>],
    facts: &[(&str, String)],
) -> Result<Vec<u8>, ParquetError> {
    let fields = columns.iter().map(|column| column.schema().map(Arc::new)).collect::<Result<_, _>>()?;
    let schema = Type::group_type_builder("schema").with_fields(fields).build()?;
    let facts = facts.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone())).collect();
    let properties = WriterProperties::builder()
        .set_created_by(concat!("aurt ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(facts))
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_data_page_size_limit(PAGE)
        .build();
    let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    columns.iter().try_for_each(|column| column.write(rows, &mut group))?;
    group.close()?;
    file.into_inner()
}
