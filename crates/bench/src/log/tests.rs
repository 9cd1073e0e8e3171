//! Logs of every format: accepted content, refusals with their messages, round trips, damaged
//! files.

use super::*;
use crate::log::{Separator, TextFormat};
use crate::signals::Channel;
use proptest::prelude::*;
use std::collections::BTreeMap;

pub(super) fn own() -> LogFormat {
    LogFormat::default()
}

#[test]
fn refusals_name_file_line_and_column() {
    for (text, expected) in [
        ("", "an empty file"),
        ("t_s,journal_y_m\n0,1\n", "1 data rows"),
        ("t_s,journal_y_m\n0,1\n0,2\n", "line 3, t_s: found 0 after 0"),
        ("t_s,journal_y_m\n0,1\n1,x\n", "line 3, journal_y_m: found `x`"),
        ("t_s,journal_y_m\n0,1\n1,nan\n", "line 3, journal_y_m: found `nan`"),
        ("t_s,journal_y_m\n0,1\n1\n", "only 1 fields"),
        ("time,journal_y_m\n0,1\n1,2\n", "no column `t_s`"),
        ("t_s,apples\n0,1\n1,2\n", "no known channel"),
        ("t_s,journal_y_m\n0,\"1,5\"\n1,2\n", "set `decimal_comma = true`"),
        ("t_s,journal_y_m,journal_y_m\n0,1,1\n1,2,2\n", "twice"),
    ] {
        let error = MeasuredLog::parse("a.csv", text, &own()).unwrap_err().to_string();
        assert!(error.starts_with("a.csv") && error.contains(expected), "{error}");
    }
}

#[test]
fn a_text_in_another_format_than_described_is_refused_with_its_own() {
    let format = LogFormat { text: Some(TextFormat::default()), ..own() };
    for (text, expected) in [
        (
            "t_s;journal_y_m\n0,5;1,5\n1;2\n",
            "the file looks like `[log]` with separator = \"semicolon\", decimal_comma = true",
        ),
        ("t_s\tjournal_y_m\n0\t1\n1\t2\n", "looks like `[log]` with separator = \"tab\""),
    ] {
        let error = MeasuredLog::parse("a.csv", text, &format).unwrap_err().to_string();
        assert!(error.starts_with("a.csv: no column `t_s`") && error.contains(expected), "{error}");
    }
}

#[test]
fn a_foreign_log_is_mapped_scaled_and_shifted() {
    let columns = toml::from_str(
        "t_s = { from = 0, scale = 1e-3 }\nposition_m = { from = 2, scale = 1e-3, offset = 1.0 }\n",
    )
    .unwrap();
    let text = TextFormat { separator: Separator::Whitespace, header: false, decimal_comma: false };
    let format = LogFormat { text: Some(text), columns };
    let log = MeasuredLog::parse("x", "0.0\t7 5.0\r\n10.0  7 6.0\r\n", &format).unwrap();
    assert_eq!(log.time_s, [0.0, 0.01]);
    assert_eq!(log.channels[&Channel::Position], [1.005, 1.006]);
}

#[test]
fn decimal_commas_are_read_where_the_description_says_so() {
    let text = TextFormat { separator: Separator::Semicolon, header: true, decimal_comma: true };
    let format = LogFormat { text: Some(text), ..own() };
    let log = MeasuredLog::parse("x", "t_s;journal_y_m\n0;1,5e-3\n0,01;-2\n", &format).unwrap();
    assert_eq!(log.time_s, [0.0, 0.01]);
    assert_eq!(log.channels[&Channel::JournalY], [1.5e-3, -2.0]);
    let error = MeasuredLog::parse("x", "t_s;journal_y_m\n0;1.000,5\n1;2\n", &format).unwrap_err();
    assert!(error.to_string().contains("line 2, journal_y_m: found `1.000,5`"), "{error}");
}

proptest! {
    #[test]
    fn csv_reads_back_exactly(values in proptest::collection::vec(-1e9..1e9_f64, 2..50)) {
        let log = MeasuredLog {
            source: "x".into(),
            time_s: (0..values.len()).map(|i| i as f64 * 1e-3).collect(),
            channels: BTreeMap::from([(Channel::JournalY, values)]),
        };
        prop_assert_eq!(MeasuredLog::parse("x", &log.to_csv(), &own()).unwrap(), log);
    }

    #[test]
    fn garbage_is_refused_without_panic(text in "\\PC{0,200}") {
        let _ = MeasuredLog::parse("x", &text, &own());
    }
}

/// Reads a log that another program wrote; see `write.py` in the same folder.
fn foreign(name: &str, columns: &str) -> Result<MeasuredLog, LogError> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign-logs").join(name);
    let columns = toml::from_str(columns).unwrap();
    MeasuredLog::read_as_found(&path, &LogFormat { columns, ..LogFormat::default() })
}

#[test]
fn mat_files_of_another_writer_are_read() {
    for name in ["v6.mat", "v7.mat"] {
        let log = foreign(
            name,
            "t_s = { from = \"data.t\" }\nspindle_angle_rad = { from = \"data.qm\", scale = 0.01 }\n\
             drive_torque_nm = { from = \"data.motor.torque\" }\n\
             spindle_speed_rad_s = { from = \"table(:,2)\" }\n",
        )
        .unwrap();
        assert_eq!(log.time_s.len(), 20);
        assert!((log.time_s[3] - 0.03).abs() < 1e-15);
        assert_eq!(log.channels[&Channel::SpindleAngle][4], -0.1);
        assert_eq!(log.channels[&Channel::DriveTorque][5], 2.5);
        assert_eq!(log.channels[&Channel::SpindleSpeed][6], 10.0);
    }
}

#[test]
fn other_content_than_a_real_vector_is_refused_by_name() {
    let time = "t_s = { from = \"data.t\" }\n";
    for (from, expected) in [
        ("phasor", "variable `phasor` for position_m: complex numbers"),
        ("note", "variable `note` for position_m: no numbers"),
        ("cell", "variable `cell` for position_m: no numbers"),
        ("missing", "no column `missing` among `data.t`"),
    ] {
        let error = foreign("v7.mat", &format!("{time}position_m = {{ from = \"{from}\" }}")).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    let log = foreign("v7.mat", &format!("{time}position_m = {{ from = \"valid\" }}")).unwrap();
    assert_eq!(log.channels[&Channel::Position][3..5], [0.0, 1.0]);
}

#[test]
fn parquet_of_another_writer_is_read_with_its_gaps() {
    let columns = "t_s = { from = \"t\" }\nspindle_angle_rad = { from = \"qm\", scale = 0.01 }\n\
                   drive_torque_nm = { from = \"motor.torque\" }\n\
                   spindle_speed_rad_s = { from = \"torque\" }\n";
    for name in ["none.parquet", "snappy.parquet", "gzip.parquet", "lz4.parquet"] {
        let log = foreign(name, columns).unwrap();
        let angle = &log.channels[&Channel::SpindleAngle];
        assert_eq!((log.time_s.len(), angle[6], angle[8]), (20, 0.1, 0.3), "{name}");
        assert!(angle[7].is_nan());
        assert_eq!(log.channels[&Channel::DriveTorque], log.channels[&Channel::SpindleSpeed]);
    }
    let columns: crate::log::Columns = toml::from_str(columns).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign-logs/snappy.parquet");
    let strict = MeasuredLog::read(&path, &LogFormat { columns, ..LogFormat::default() }).unwrap_err();
    assert!(
        strict.to_string().ends_with("row 8, spindle_angle_rad: found NaN; expected a finite number"),
        "{strict}"
    );
    for (name, from, expected) in [
        ("snappy.parquet", "label", "column `label` for position_m: BYTE_ARRAY values"),
        ("snappy.parquet", "raw.list.element", "a list in each row"),
        ("zstd.parquet", "qm", "expected complete Parquet with plain, Snappy, gzip or LZ4 pages"),
    ] {
        let columns = format!("t_s = {{ from = \"t\" }}\nposition_m = {{ from = \"{from}\" }}");
        let error = foreign(name, &columns).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn damaged_and_unknown_files_are_refused_with_advice() {
    let mut new = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".to_vec();
    new.resize(512, b' ');
    new.extend(b"\x89HDF\r\n\x1a\n");
    for (bytes, expected) in [
        (new, "expected complete HDF5 with plain"),
        (b"\x89HDF\r\n\x1a\n\0\0".to_vec(), "expected complete HDF5 with plain"),
        (vec![0; 100], "an unknown binary file"),
        (b"PAR1PAR1".to_vec(), "expected complete Parquet"),
        (b"MATLAB 5.0 MAT-file".to_vec(), "damage in the header"),
    ] {
        let error = reader::from_bytes("a.csv", bytes, &own(), false).unwrap_err().to_string();
        assert!(error.starts_with("a.csv") && error.contains(expected), "{error}");
    }
}

#[test]
fn a_text_read_as_found_keeps_its_gaps_and_its_times() {
    let text = "t_s,journal_y_m\n0,1\n0,\n-1,NaN\n2,4\n3\n";
    let log = reader::from_bytes("a.csv", text.as_bytes().to_vec(), &own(), false).unwrap();
    assert_eq!(log.time_s, [0.0, 0.0, -1.0, 2.0, 3.0]);
    let finite: Vec<bool> = log.channels[&Channel::JournalY].iter().map(|v| v.is_finite()).collect();
    assert_eq!(finite, [true, false, false, true, false]);
    let bad = reader::from_bytes("a.csv", b"t_s,journal_y_m\n0,1\n1,x\n".to_vec(), &own(), false);
    assert!(bad.unwrap_err().to_string().contains("line 3, journal_y_m: found `x`"));
}

pub(super) fn small(values: Vec<f64>) -> MeasuredLog {
    MeasuredLog {
        source: "x".into(),
        time_s: (0..values.len()).map(|i| i as f64 * 1e-3).collect(),
        channels: BTreeMap::from([
            (Channel::LoadForce, values.iter().map(|v| 0.3 * v).collect()),
            (Channel::JournalY, values),
        ]),
    }
}

#[test]
fn damaged_binary_files_are_refused_or_read_and_never_panic() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign-logs");
    let columns = "t_s = { from = \"t\" }\nspindle_angle_rad = { from = \"qm\" }\n\
                   position_m = { from = \"motor.torque\" }";
    let parquet: crate::log::Columns = toml::from_str(columns).unwrap();
    let mat: crate::log::Columns = toml::from_str(&columns.replace("= \"", "= \"data.")).unwrap();
    let mut state = 1_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for (name, columns) in [
        ("v6.mat", &mat),
        ("v7.mat", &mat),
        ("none.parquet", &parquet),
        ("gzip.parquet", &parquet),
        ("lz4.parquet", &parquet),
    ] {
        let complete = std::fs::read(folder.join(name)).unwrap();
        let format = LogFormat { columns: columns.clone(), ..LogFormat::default() };
        for length in (0..complete.len()).step_by(7) {
            let cut = complete[..length].to_vec();
            let _ = reader::from_bytes(name, cut, &format, false);
        }
        for _ in 0..3000 {
            let mut bytes = complete.clone();
            for _ in 0..=random(4) {
                let at = random(bytes.len());
                bytes[at] = if random(4) == 0 { 0xff } else { random(256) as u8 };
            }
            let _ = reader::from_bytes(name, bytes, &format, false);
        }
    }
}

proptest! {
    #[test]
    fn every_format_reads_back_exactly(values in proptest::collection::vec(-1e9..1e9_f64, 2..50)) {
        let log = small(values);
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.csv", "a.parquet", "a.mat"] {
            let path = folder.path().join(name);
            log.write(&path).unwrap();
            let mut read = MeasuredLog::read(&path, &own()).unwrap();
            read.source = "x".into();
            prop_assert_eq!(&read, &log, "{}", name);
        }
    }
}
