//! Parquet files with columns that this project does not write: unsigned numbers.

use super::tests::own;
use super::*;

/// A Parquet file with one column of each type under a schema.
fn parquet_of(schema: &str, times: &[f64], counts: &[i32], long: &[i64]) -> Vec<u8> {
    use ::parquet::data_type::{DoubleType, Int32Type, Int64Type};
    let schema = ::parquet::schema::parser::parse_message_type(schema).unwrap();
    let mut bytes = Vec::new();
    let mut writer = ::parquet::file::writer::SerializedFileWriter::new(
        &mut bytes,
        std::sync::Arc::new(schema),
        std::sync::Arc::default(),
    )
    .unwrap();
    let mut group = writer.next_row_group().unwrap();
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<DoubleType>().write_batch(times, None, None).unwrap();
    column.close().unwrap();
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<Int32Type>().write_batch(counts, None, None).unwrap();
    column.close().unwrap();
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<Int64Type>().write_batch(long, None, None).unwrap();
    column.close().unwrap();
    group.close().unwrap();
    writer.close().unwrap();
    bytes
}

#[test]
fn unsigned_parquet_columns_are_read_without_a_sign() {
    let times = [0.0, 1.0];
    for (short, long, expected) in [
        ("(UINT_32)", "(UINT_64)", (4_294_967_295.0, 18_446_744_073_709_551_615.0)),
        ("(INTEGER(32,false))", "(INTEGER(64,false))", (4_294_967_295.0, 18_446_744_073_709_551_615.0)),
        ("(INTEGER(32,true))", "(INTEGER(64,true))", (-1.0, -1.0)),
        ("", "", (-1.0, -1.0)),
    ] {
        let schema = format!(
            "message log {{ REQUIRED DOUBLE t_s; REQUIRED INT32 position_m {short}; REQUIRED INT64 velocity_m_s {long}; }}"
        );
        let bytes = parquet_of(&schema, &times, &[7, -1], &[7, -1]);
        let log = MeasuredLog::of_bytes("a.parquet", bytes, &own(), true).unwrap();
        let last = (log.channels[&Channel::Position][1], log.channels[&Channel::Velocity][1]);
        assert_eq!(last, expected, "{short} {long}");
        assert_eq!(log.channels[&Channel::Position][0], 7.0);
    }
}
