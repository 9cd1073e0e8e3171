//! Binary files that this project does not write: unsigned columns of Parquet; objects and large
//! matrices in MAT-files.

use super::tests::{own, small};
use super::*;
use crate::signals::Channel;

/// Returns a Parquet file with one column of each type under a schema.
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
            "message log {{ REQUIRED DOUBLE t_s; REQUIRED INT32 position_m {short}; \
             REQUIRED INT64 velocity_m_s {long}; }}"
        );
        let bytes = parquet_of(&schema, &times, &[7, -1], &[7, -1]);
        let log = reader::from_bytes("a.parquet", bytes, &own(), true).unwrap();
        let last = (log.channels[&Channel::Position][1], log.channels[&Channel::Velocity][1]);
        assert_eq!(last, expected, "{short} {long}");
        assert_eq!(log.channels[&Channel::Position][0], 7.0);
    }
}

/// Returns an element of a MAT-file.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut out = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    out.extend(data);
    out.resize(out.len().next_multiple_of(8), 0);
    out
}

/// Returns the MAT-file of a small log, followed by further variables.
fn mat_with(variables: &[Vec<u8>]) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mat");
    small(vec![1.0, 2.0, 4.0]).write(&path).unwrap();
    let mut bytes = std::fs::read(path).unwrap();
    bytes.extend(variables.concat());
    bytes
}

/// Returns a MATLAB object as a file holds it: flags, name, "MCOS", class, reference to the last
/// variable.
fn object(name: &str, class: &str) -> Vec<u8> {
    let reference = [
        element(6, &[13_u32.to_le_bytes(), [0; 4]].concat()),
        element(5, &[6_i32.to_le_bytes(), 1_i32.to_le_bytes()].concat()),
        element(1, b""),
        element(6, &[0xdd00_0000_u32, 2, 1, 1, 1, 1].map(u32::to_le_bytes).concat()),
    ];
    let array = [
        element(6, &[17_u32.to_le_bytes(), [0; 4]].concat()),
        element(1, name.as_bytes()),
        element(1, b"MCOS"),
        element(1, class.as_bytes()),
        element(14, &reference.concat()),
    ];
    element(14, &array.concat())
}

#[test]
fn a_mat_file_with_strings_and_tables_besides_its_signals_is_read() {
    let bytes = mat_with(&[object("note", "string"), object("position_m", "table")]);
    let read = |bytes: Vec<u8>, columns: &str| {
        let columns = toml::from_str(columns).unwrap();
        reader::from_bytes("a.mat", bytes, &LogFormat { columns, ..own() }, true)
    };
    let log = read(mat_with(&[object("note", "string"), object("when", "datetime")]), "").unwrap();
    assert_eq!(log.channels[&Channel::JournalY], [1.0, 2.0, 4.0]);
    for (columns, name) in [("", "position_m"), ("velocity_m_s = { from = \"note\" }", "note")] {
        let refused = read(bytes.clone(), columns).unwrap_err().to_string();
        assert!(
            refused.contains(&format!("variable `{name}` for")) && refused.contains("no numbers"),
            "{refused}"
        );
    }
}

/// Returns a compressed matrix of doubles.
fn compressed(rows: i32, columns: i32) -> Vec<u8> {
    use std::io::Write as _;
    let array = [
        element(6, &[6_u32.to_le_bytes(), [0; 4]].concat()),
        element(5, &[rows.to_le_bytes(), columns.to_le_bytes()].concat()),
        element(1, b"all"),
        element(9, &vec![0; 8 * (rows * columns) as usize]),
    ];
    let mut zipped = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    zipped.write_all(&element(14, &array.concat())).unwrap();
    let zipped = zipped.finish().unwrap();
    [15_u32.to_le_bytes().to_vec(), (zipped.len() as u32).to_le_bytes().to_vec(), zipped].concat()
}

#[test]
fn a_mat_file_of_many_megabytes_is_read() {
    // Forty signals of 550 000 rows: 176 MB in one variable.
    let bytes = mat_with(&[compressed(550_000, 40)]);
    let columns = "t_s = { from = \"all(:,1)\" }\njournal_y_m = { from = \"all(:,40)\" }\n\
                   load_force_n = { from = \"all(:,2)\" }";
    let columns = toml::from_str(columns).unwrap();
    let log = reader::from_bytes("a.mat", bytes, &LogFormat { columns, ..own() }, false).unwrap();
    assert_eq!(log.time_s.len(), 550_000);
}
