//! Log files of other programs. `logs/make.py` writes them with libraries that are independent of
//! Pintle; all contain the same signals.

use bench::log::{MeasuredLog, RawLog};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/logs").join(name)
}

fn read(name: &str) -> RawLog {
    RawLog::read(&path(name)).unwrap_or_else(|error| panic!("{error}"))
}

/// Values by the name of the column.
fn columns(log: &RawLog) -> BTreeMap<&str, &[f64]> {
    log.columns.iter().map(|column| (column.name.as_str(), column.values.as_slice())).collect()
}

/// Files with the names of their columns for time, angle and force, and the units of the three.
const FILES: [(&str, [&str; 3], [&str; 3]); 16] = [
    ("version-5.mat", ["time", "angle", "force"], ["", "", ""]),
    ("version-7.3.mat", ["time", "data.angle", "all(:,3)"], ["", "", ""]),
    ("frame.parquet", ["time", "angle", "force"], ["", "", ""]),
    ("sheets.xlsx", ["time", "angle", "force"], ["s", "rad", "N"]),
    ("mdf-4.10.mf4", ["0/time", "angle", "force"], ["s", "rad", "N"]),
    ("mdf-4.10-deflate.mf4", ["0/time", "angle", "force"], ["s", "rad", "N"]),
    ("mdf-4.11-transposed.mf4", ["0/time", "angle", "force"], ["s", "rad", "N"]),
    ("waveform.tdms", ["wf_time", "angle", "force"], ["s", "rad", "N"]),
    ("scaled.tdms", ["time", "angle", "force"], ["s", "rad", "N"]),
    ("interleaved.tdms", ["wf_time", "angle", "force"], ["s", "rad", "N"]),
    ("big-endian.tdms", ["wf_time", "angle", "force"], ["s", "rad", "N"]),
    ("big-endian-interleaved.tdms", ["wf_time", "angle", "force"], ["s", "rad", "N"]),
    ("daqmx.tdms", ["wf_time", "angle", "force"], ["s", "", ""]),
    ("groups.h5", ["bench/time", "bench/angle", "bench/force"], ["s", "rad", "N"]),
    ("matrix.h5", ["log(:,1)", "log(:,2)", "log(:,3)"], ["", "", ""]),
    ("table.h5", ["log.time", "log.angle", "log.force"], ["", "", ""]),
];

/// Damaged copies of each file.
const ROUNDS: usize = 500;

#[test]
fn the_files_of_other_programs_have_the_same_signals() {
    let expected = read("expected.csv");
    let expected = columns(&expected);
    for (file, names, units) in FILES {
        let log = read(file);
        let found = columns(&log);
        for ((signal, name), unit) in ["time", "angle", "force"].into_iter().zip(names).zip(units) {
            let values = found.get(name).unwrap_or_else(|| panic!("{file}: no {name} among {found:?}"));
            assert_eq!(values.len(), 100, "{file}: {name}");
            // The card stores the angle in steps of 2e-5 rad; a time of a waveform is a product.
            let tolerance = match (file, signal) {
                ("daqmx.tdms", "angle") => 1e-5,
                (_, "time") => 1e-15,
                _ => 0.0,
            };
            for (value, expected) in values.iter().zip(expected[signal]) {
                assert!((value - expected).abs() <= tolerance, "{file}: {name}: {value}, {expected}");
            }
            let column = log.columns.iter().find(|column| column.name == name).unwrap();
            assert_eq!(column.unit, unit, "{file}: {name}");
        }
    }
}

#[test]
fn other_content_keeps_its_name_and_has_a_reason() {
    let reason = |file: &str, name: &str| {
        let log = read(file);
        let found = log.others.iter().find(|other| other.name == name).map(|other| other.reason.clone());
        found.unwrap_or_else(|| panic!("{file}: {name}: {:?}", log.others))
    };
    assert!(reason("groups.h5", "bench/note").contains("no numbers"));
    assert!(reason("version-7.3.mat", "note").contains("no numbers"));
    assert!(reason("scaled.tdms", "note").contains("texts"));
    assert!(reason("sheets.xlsx", "who").contains("`a name` in cell "));
    assert_eq!(columns(&read("mdf-4.10.mf4"))["temperature"].len(), 10);
    assert_eq!(columns(&read("groups.h5"))["bench/slow"][9], 9.0);
}

#[test]
fn an_old_or_unfinished_file_is_refused_with_what_is_expected() {
    let refused = RawLog::read(&path("mdf-3.30.mdf")).unwrap_err().to_string();
    assert!(refused.contains(": MDF of version 3.30; expected complete MDF of version 4"), "{refused}");
    let mut bytes = std::fs::read(path("mdf-4.10.mf4")).unwrap();
    bytes[..8].copy_from_slice(b"UnFinMF ");
    let refused = RawLog::from_bytes("a.mf4", bytes).unwrap_err().to_string();
    assert!(refused.contains("that its writer did not finish"), "{refused}");
}

#[test]
fn a_description_maps_the_columns_of_every_format() {
    for (file, [time, angle, force], _) in FILES {
        let columns = format!(
            "t_s = \"{time}\"\nspindle_angle_rad = \"{angle}\"\n\
             drive_torque_nm = {{ from = \"{force}\", scale = 0.1 }}"
        );
        let preset = bench::PRESETS.iter().find(|(name, _)| *name == "friction-rig").unwrap().1;
        let bench = bench::Bench::parse("x", &format!("{preset}\n[columns]\n{columns}\n")).unwrap();
        let log =
            MeasuredLog::read(&path(file), &bench.log_format()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((log.time_s.len(), log.channels.len()), (100, 2), "{file}");
    }
}

/// LabVIEW leaves the end of the last segment open until the segment is complete.
#[test]
fn an_unfinished_tdms_file_is_read_as_far_as_it_goes() {
    let unfinished = |name: &str, missing: usize| {
        let mut bytes = std::fs::read(path(name)).unwrap();
        bytes[12..20].fill(0xff);
        bytes.truncate(bytes.len() - missing);
        RawLog::from_bytes(name, bytes).unwrap()
    };
    let expected = read("expected.csv");
    let expected = columns(&expected);
    for (file, missing, angles, forces) in [
        // 24 bytes and a piece are one row and a half.
        ("interleaved.tdms", 24, 98, 98),
        ("big-endian-interleaved.tdms", 16, 99, 99),
        // The last chunk has 50 angles and then 50 forces.
        ("big-endian.tdms", 8 * 20 + 1, 100, 79),
        ("big-endian.tdms", 8 * 60, 90, 50),
    ] {
        let log = unfinished(file, missing);
        let found = columns(&log);
        assert_eq!(found["angle"], &expected["angle"][..angles], "{file}");
        assert_eq!(found["force"], &expected["force"][..forces], "{file}");
    }
}

/// Every file cut at many places: an error, or columns that are whole.
#[test]
fn a_truncated_file_has_no_column_that_is_cut() {
    for (file, ..) in FILES {
        let bytes = std::fs::read(path(file)).unwrap();
        let whole = read(file);
        let whole = columns(&whole);
        let mut refused = 0;
        for part in 0..200 {
            let cut = bytes[..bytes.len() * part / 200].to_vec();
            match RawLog::from_bytes(file, cut) {
                Err(_) => refused += 1,
                Ok(found) => {
                    for (name, values) in columns(&found) {
                        assert_eq!(whole.get(name), Some(&values), "{file}: {name}, cut at {part} of 200");
                    }
                }
            }
        }
        assert!(refused > 20, "{file}: {refused}");
    }
}

/// Every file with changed bytes: an error or numbers, never a panic, a hang or much memory.
#[test]
fn a_damaged_file_is_refused_or_read() {
    let mut seed = 1_u64;
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    for (file, ..) in FILES {
        let bytes = std::fs::read(path(file)).unwrap();
        for _ in 0..ROUNDS {
            let mut damaged = bytes.clone();
            for _ in 0..=random(4) {
                let at = random(damaged.len());
                damaged[at] = [0, 0xff, 0x7f, 1, 0x80][random(5)];
            }
            let _ = RawLog::from_bytes(file, damaged);
        }
    }
}
