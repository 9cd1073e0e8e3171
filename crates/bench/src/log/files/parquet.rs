//! Parquet logs: columns of signed or unsigned integers, floating-point numbers or booleans,
//! nullable or not, in any number of row groups.
//!
//! Columns inside groups are named with points (`motor.angle`); lists are refused when a column
//! asks for them. Time stamps and dates are in seconds since the earliest first one of a column,
//! times of day in seconds. Pages may be plain or compressed with Snappy, gzip or LZ4. Logs are
//! written as required doubles in one row group, without compression.

use super::file::{LogFile, MAX_ROWS, Written, distinct, guarded, refused};
use crate::log::LogError;
use bytes::Bytes;
use parquet::basic::{ConvertedType, LogicalType, Repetition, TimeUnit, Type as PhysicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::collections::BTreeMap;
use std::sync::Arc;

/// First bytes of a file.
pub(super) const PARQUET: &[u8] = b"PAR1";
const NS_PER_DAY: i128 = 86_400_000_000_000;
/// Rows read at a time.
const BATCH: usize = 16_384;
/// Key of the units in the metadata of a file.
const UNITS: &str = "units";
const READABLE: &str = "complete Parquet with plain, Snappy, gzip or LZ4 pages";

/// An open file.
pub(super) struct Table {
    names: Vec<String>,
    units: Vec<String>,
    /// Clock of each column that has times, and the earliest first time stamp of the file in ns.
    clocks: Vec<Option<Clock>>,
    origin_ns: i128,
    reader: SerializedFileReader<Bytes>,
}

impl Table {
    pub(super) fn open(file: &str, bytes: Vec<u8>) -> Result<Self, LogError> {
        let reader = guarded(|| SerializedFileReader::new(Bytes::from(bytes)))
            .map_err(|found| LogError::content(file, found, READABLE))?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let names: Vec<String> = schema.columns().iter().map(|c| c.path().string()).collect();
        let known = units(&reader);
        let clocks: Vec<Option<Clock>> = schema
            .columns()
            .iter()
            .map(|c| Clock::from_types(c.logical_type_ref(), c.converted_type()))
            .collect();
        let unit = |(name, clock): (&String, &Option<Clock>)| match clock {
            Some(_) => "s".to_owned(),
            None => known.get(name).cloned().unwrap_or_default(),
        };
        let units = names.iter().zip(&clocks).map(unit).collect();
        let mut out = Self { names: distinct(names), units, clocks, origin_ns: 0, reader };
        // A damaged column is refused when its values are read.
        let first = |(index, clock): (usize, &Option<Clock>)| {
            let clock = clock.as_ref().filter(|clock| clock.has_date)?;
            let first = guarded(|| out.first_stamp(index)).ok()??;
            Some(i128::from(first) * clock.ns)
        };
        out.origin_ns = out.clocks.iter().enumerate().filter_map(first).min().unwrap_or(0);
        Ok(out)
    }

    /// First time stamp of a column.
    fn first_stamp(&self, index: usize) -> Result<Option<i64>, ParquetError> {
        for group in 0..self.reader.num_row_groups() {
            let reader = self.reader.get_row_group(group)?.get_column_reader(index)?;
            let first = match reader {
                ColumnReader::Int64ColumnReader(reader) => first_value(reader)?,
                ColumnReader::Int32ColumnReader(reader) => first_value(reader)?.map(i64::from),
                _ => None,
            };
            if first.is_some() {
                return Ok(first);
            }
        }
        Ok(None)
    }
}

impl LogFile for Table {
    fn format(&self) -> &'static str {
        "Parquet"
    }

    fn names(&self) -> &[String] {
        &self.names
    }

    fn unit(&self, index: usize) -> &str {
        self.units.get(index).map_or("", String::as_str)
    }

    fn values(&self, file: &str, index: usize, wanted: &str, _: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        let column = |found: String, expected: &str| refused(file, (name, wanted), found, expected);
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
            if out.len() > MAX_ROWS {
                break;
            }
            let read = guarded(|| {
                let reader = self.reader.get_row_group(group)?.get_column_reader(index)?;
                let (max_level, out) = (description.max_def_level(), &mut out);
                let Some(clock) = self.clocks.get(index).and_then(Option::as_ref) else {
                    return append_any(reader, unsigned, max_level, out);
                };
                let origin_ns = if clock.has_date { self.origin_ns } else { 0 };
                let since = |stamp: i64| (i128::from(stamp) * clock.ns - origin_ns) as f64 / 1e9;
                match reader {
                    ColumnReader::Int64ColumnReader(reader) => append(reader, max_level, out, |v| since(*v))?,
                    ColumnReader::Int32ColumnReader(reader) => {
                        append(reader, max_level, out, |v| since((*v).into()))?
                    }
                    _ => return Ok(false),
                }
                Ok(true)
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
}

/// Unit of the times of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Clock {
    ns: i128,
    /// True for dates and time stamps, false for times of day.
    has_date: bool,
}

impl Clock {
    /// Clock of a column; `None` if it has no times.
    fn from_types(logical: Option<&LogicalType>, converted: ConvertedType) -> Option<Self> {
        let ns = |unit: &TimeUnit| match unit {
            TimeUnit::MILLIS => 1_000_000,
            TimeUnit::MICROS => 1000,
            TimeUnit::NANOS => 1,
        };
        let (ns, has_date) = match (logical, converted) {
            (Some(LogicalType::Timestamp(times)), _) => (ns(&times.unit), true),
            (Some(LogicalType::Time(times)), _) => (ns(&times.unit), false),
            (_, ConvertedType::TIMESTAMP_MILLIS) => (1_000_000, true),
            (_, ConvertedType::TIMESTAMP_MICROS) => (1000, true),
            (_, ConvertedType::TIME_MILLIS) => (1_000_000, false),
            (_, ConvertedType::TIME_MICROS) => (1000, false),
            (_, ConvertedType::DATE) => (NS_PER_DAY, true),
            _ => return None,
        };
        Some(Self { ns, has_date })
    }
}

/// First value of a column in a row group.
fn first_value<T: DataType>(mut reader: ColumnReaderImpl<T>) -> Result<Option<T::T>, ParquetError> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    while values.is_empty() && reader.read_records(BATCH, Some(&mut levels), None, &mut values)?.0 > 0 {}
    Ok(values.into_iter().next())
}

/// Units by the name of the column, which this project writes into the file.
fn units(reader: &SerializedFileReader<Bytes>) -> BTreeMap<String, String> {
    let stored = reader.metadata().file_metadata().key_value_metadata();
    let own = stored.and_then(|pairs| pairs.iter().find(|pair| pair.key == UNITS));
    own.and_then(|pair| serde_json::from_str(pair.value.as_deref()?).ok()).unwrap_or_default()
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
        // The callers refuse rows beyond the limit; here they must only not fill the memory.
        if out.len() > MAX_ROWS {
            return Ok(());
        }
    }
}

/// Returns columns as a Parquet file.
pub(super) fn bytes(columns: &[Written<'_>]) -> Result<Vec<u8>, ParquetError> {
    let field = |column: &Written<'_>| {
        let builder = Type::primitive_type_builder(column.name, PhysicalType::DOUBLE);
        Ok(Arc::new(builder.with_repetition(Repetition::REQUIRED).build()?))
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>, ParquetError>>()?;
    let schema = Type::group_type_builder("log").with_fields(fields).build()?;
    let units: BTreeMap<&str, &str> =
        columns.iter().filter(|c| !c.unit.is_empty()).map(|c| (c.name, c.unit)).collect();
    let units = serde_json::to_string(&units).map_err(|e| ParquetError::General(e.to_string()))?;
    let properties = WriterProperties::builder()
        .set_dictionary_enabled(false)
        .set_key_value_metadata(Some(vec![KeyValue::new(UNITS.to_owned(), units)]))
        .build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    let mut columns = columns.iter();
    while let (Some(mut column), Some(written)) = (group.next_column()?, columns.next()) {
        column.typed::<DoubleType>().write_batch(written.values, None, None)?;
        column.close()?;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}
