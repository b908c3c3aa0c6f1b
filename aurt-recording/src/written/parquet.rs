use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::error::RecordingError;

/// Bytes of a page.
const PAGE: usize = 8 << 20;

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
    write(columns, facts).map_err(|error| RecordingError::Malformed {
        path: path.to_owned(),
        place: "its columns".to_owned(),
        reason: error.to_string(),
        remedy: "write CSV or MCAP".to_owned(),
    })
}

fn write(columns: &[(String, &[f64])], facts: &[(&str, String)]) -> Result<Vec<u8>, ParquetError> {
    let rows = columns.iter().map(|(_, values)| values.len()).min().unwrap_or(0);
    let field = |(name, _): &(String, &[f64])| {
        let column = Type::primitive_type_builder(name, Physical::DOUBLE);
        column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
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
    for (_, values) in columns {
        let Some(mut column) = group.next_column()? else { break };
        column.typed::<DoubleType>().write_batch(&values[..rows], None, None)?;
        column.close()?;
    }
    group.close()?;
    file.into_inner()
}
