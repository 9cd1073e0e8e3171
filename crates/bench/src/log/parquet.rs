//! Parquet logs: columns of signed or unsigned integers, floating-point numbers or booleans,
//! nullable or not, in any number of row groups.
//!
//! Columns inside groups are named with points (`motor.angle`); lists are refused when a column
//! asks for them. Pages may be plain or compressed with Snappy, gzip or LZ4. Logs are written as
//! required doubles in one row group, without compression.

use super::{LogError, MAX_ROWS, MeasuredLog};
use crate::log::TIME;
use bytes::Bytes;
use parquet::basic::ConvertedType;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use std::sync::Arc;

/// Rows read at a time.
const BATCH: usize = 16_384;
const READABLE: &str = "complete Parquet with plain, Snappy, gzip or LZ4 pages";

/// An open file.
pub(super) struct Table {
    pub(super) names: Vec<String>,
    reader: SerializedFileReader<Bytes>,
}

impl Table {
    pub(super) fn open(file: &str, bytes: Vec<u8>) -> Result<Self, LogError> {
        let reader = guarded(|| SerializedFileReader::new(Bytes::from(bytes)))
            .map_err(|e| LogError::content(file, e.to_string(), READABLE))?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let names = schema.columns().iter().map(|c| c.path().string()).collect();
        Ok(Self { names, reader })
    }

    pub(super) fn values(&self, file: &str, index: usize, wanted: &str) -> Result<Vec<f64>, LogError> {
        let column = |found: String, expected: &str| {
            LogError::content(file, format!("column `{}` for {wanted}: {found}", self.name(index)), expected)
        };
        let described = self.reader.metadata().file_metadata().schema_descr_ptr();
        let Some(description) = described.columns().get(index) else {
            return Err(column(format!("only {} columns", self.names.len()), "an index below that"));
        };
        if description.max_rep_level() > 0 {
            return Err(column("a list in each row".into(), "one number in each row"));
        }
        if description.converted_type() == ConvertedType::DECIMAL {
            return Err(column("decimal numbers".into(), "integers or floating-point numbers"));
        }
        // The library derives this type from the logical type if only that is written.
        let unsigned = matches!(
            description.converted_type(),
            ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64
        );
        let mut out = Vec::new();
        for group in 0..self.reader.num_row_groups() {
            let read = guarded(|| {
                let reader = self.reader.get_row_group(group)?.get_column_reader(index)?;
                append_any(reader, unsigned, description.max_def_level(), &mut out)
            });
            match read {
                Ok(true) => {}
                Ok(false) => {
                    let found = format!("{} values", description.physical_type());
                    return Err(column(found, "integers or floating-point numbers"));
                }
                Err(e) => return Err(column(format!("row group {}: {e}", group + 1), READABLE)),
            }
        }
        Ok(out)
    }

    fn name(&self, index: usize) -> String {
        self.names.get(index).cloned().unwrap_or_else(|| index.to_string())
    }
}

/// Turns a panic of the library on a damaged file into an ordinary error.
fn guarded<T>(read: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, ParquetError> {
    let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(read));
    result.unwrap_or_else(|_| Err(ParquetError::General("a damaged file".into())))
}

/// Appends the values of a column in a row group; returns `false` if they are no numbers. Integers
/// are stored as signed, also those that are `unsigned`.
fn append_any(
    reader: ColumnReader,
    unsigned: bool,
    max: i16,
    out: &mut Vec<f64>,
) -> Result<bool, ParquetError> {
    match reader {
        ColumnReader::Int32ColumnReader(r) if unsigned => {
            append(r, max, out, |v| f64::from(v.cast_unsigned()))?;
        }
        ColumnReader::Int64ColumnReader(r) if unsigned => append(r, max, out, |v| v.cast_unsigned() as f64)?,
        ColumnReader::BoolColumnReader(r) => append(r, max, out, |v| f64::from(u8::from(*v)))?,
        ColumnReader::Int32ColumnReader(r) => append(r, max, out, |v| f64::from(*v))?,
        ColumnReader::Int64ColumnReader(r) => append(r, max, out, |v| *v as f64)?,
        ColumnReader::FloatColumnReader(r) => append(r, max, out, |v| f64::from(*v))?,
        ColumnReader::DoubleColumnReader(r) => append(r, max, out, |v| *v)?,
        _ => return Ok(false),
    }
    Ok(true)
}

fn append<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    max_definition: i16,
    out: &mut Vec<f64>,
    number: impl Fn(&T::T) -> f64,
) -> Result<(), ParquetError> {
    loop {
        let (mut values, mut levels) = (Vec::new(), Vec::new());
        let levels_wanted = (max_definition > 0).then_some(&mut levels);
        let (records, ..) = reader.read_records(BATCH, levels_wanted, None, &mut values)?;
        if records == 0 {
            return Ok(());
        }
        let mut values = values.iter().map(&number);
        if max_definition > 0 {
            let mut or_missing = |&level: &i16| (level == max_definition).then(|| values.next()).flatten();
            out.extend(levels.iter().map(|level| or_missing(level).unwrap_or(f64::NAN)));
        } else {
            out.extend(values);
        }
        // The caller refuses rows beyond the limit; here they must only not fill the memory.
        if out.len() > MAX_ROWS {
            return Ok(());
        }
    }
}

/// Returns the log as a Parquet file.
pub(super) fn bytes(log: &MeasuredLog) -> Result<Vec<u8>, ParquetError> {
    let names = std::iter::once(TIME).chain(log.channels.keys().map(|c| c.name()));
    let fields: String = names.map(|name| format!("REQUIRED DOUBLE {name};\n")).collect();
    let schema = parse_message_type(&format!("message log {{\n{fields}}}"))?;
    let properties = WriterProperties::builder().set_dictionary_enabled(false).build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    let mut columns = std::iter::once(&log.time_s).chain(log.channels.values());
    while let (Some(mut column), Some(values)) = (group.next_column()?, columns.next()) {
        column.typed::<DoubleType>().write_batch(values, None, None)?;
        column.close()?;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}
