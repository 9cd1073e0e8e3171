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

/// Files with the names of their columns for time, angle and force, and the units of the three, as
/// `logs/make.py` states them.
fn files() -> impl Iterator<Item = (&'static str, [&'static str; 3], [&'static str; 3])> {
    include_str!("logs/files.tsv").lines().skip(1).map(|line| {
        let fields: Result<[&str; 7], _> = line.split('\t').collect::<Vec<_>>().try_into();
        let Ok([file, time, angle, force, of_time, of_angle, of_force]) = fields else { panic!("{line}") };
        (file, [time, angle, force], [of_time, of_angle, of_force])
    })
}

/// Damaged copies of each file.
const ROUNDS: usize = 500;

#[test]
fn the_files_of_other_programs_have_the_same_signals() {
    let expected = read("expected.csv");
    let expected = columns(&expected);
    for (file, names, units) in files() {
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
    for (file, [time, angle, force], _) in files() {
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

#[test]
fn conversions_of_mdf_are_those_of_their_formula_or_table_or_are_refused() {
    let log = read("conversions.mf4");
    let found = columns(&log);
    let nearest = |x: f64| match x {
        x if x <= 25.0 => 0.0,
        x if x <= 74.5 => 100.0,
        _ => 2.0,
    };
    let interpolated = |x: f64| if x <= 50.0 { 2.0 * x } else { 100.0 - 2.0 * (x - 50.0) };
    let marked = |x: f64| if x % 10.0 == 3.0 { f64::NAN } else { x };
    let status = |x: f64| if x == 99.0 { f64::NAN } else { 0.5 * x - 40.0 };
    let expected: [(&str, &dyn Fn(f64) -> f64); 9] = [
        ("linear", &|x| 0.5 * x - 40.0),
        ("rational", &|x| (2.0 * x + 1.0) / (x + 4.0)),
        ("formula", &|x| 2.0 * x + 1.0),
        ("root", &|x| x.sqrt() + 1.0),
        ("interpolated", &interpolated),
        ("nearest", &nearest),
        ("status", &status),
        ("half", &|x| x / 8.0),
        ("marked", &marked),
    ];
    for (name, reading) in expected {
        for (stored, value) in
            found.get(name).unwrap_or_else(|| panic!("{name}: {:?}", log.others)).iter().enumerate()
        {
            let expected = reading(stored as f64);
            let is_same = (value - expected).abs() < 1e-12 || value.is_nan() && expected.is_nan();
            assert!(is_same, "{name} of {stored}: {value}, {expected}");
        }
    }
    let others: BTreeMap<&str, &str> =
        log.others.iter().map(|other| (other.name.as_str(), other.reason.as_str())).collect();
    assert!(others["unknown"].contains("the formula `lookup(X)`"), "{others:?}");
    assert_eq!((others["words"], others["array"]), ("texts", "an array in each record"));
}

/// The second group of each file begins 0.5 s after the first and has half its rate.
#[test]
fn each_column_has_its_own_time_and_all_times_of_a_file_have_one_origin() {
    for file in ["two-times.mf4", "two-times.tdms"] {
        let log = read(file);
        let column = |name: &str| log.columns.iter().find(|column| column.name == name).unwrap();
        for name in ["a", "b"] {
            let column = log.columns.iter().find(|c| c.name == name || c.name == format!("same/{name}"));
            let column = column.unwrap_or_else(|| panic!("{file}: {:?}", columns(&log).keys()));
            let time = bench::template::time_of(&log, column).unwrap();
            for (time, value) in time.0.values.iter().zip(&column.values) {
                assert!((100.0 * time - value).abs() < 1e-9, "{file}: {name}: {time}, {value}");
            }
        }
        if file.ends_with("tdms") {
            assert_eq!((column("stamps/a").values[0], column("stamps/b").values[0]), (0.0, 0.5));
            assert_eq!((column("stamps/b").values[99], column("stamps/b").unit.as_str()), (2.48, "s"));
        }
    }
    let stamps = read("stamps.parquet");
    let found = columns(&stamps);
    for name in ["stamp_ms", "stamp_us", "stamp_ns", "clock"] {
        // The date of the same day began 12 h before the first stamp.
        let origin = if name == "clock" { 0.0 } else { 43_200.0 };
        assert!((found[name][99] - origin - 0.99).abs() < 1e-6, "{name}: {}", found[name][99]);
        assert!(
            stamps.columns.iter().all(|column| column.unit == if column.name == "force" { "" } else { "s" })
        );
    }
    assert_eq!((found["date"][99], found.contains_key("none")), (0.0, false));
}

#[test]
fn a_waveform_that_begins_anew_has_no_times() {
    let log = read("segments.tdms");
    let found = columns(&log);
    assert!((found["on/wf_time"][99] - 0.99).abs() < 1e-9, "{:?}", found["on/wf_time"]);
    assert_eq!((found["spectrum/wf_time"][0], found["spectrum/wf_time"][4]), (0.0, 1.0));
    let mut reversed = log.clone();
    reversed.columns.reverse();
    for log in [&log, &reversed] {
        assert_eq!(bench::template::time_column(log).unwrap().0.name, "on/wf_time");
    }
    let reason = |name: &str| log.others.iter().find(|other| other.name == name).unwrap().reason.as_str();
    for name in ["again/wf_time", "rate/wf_time"] {
        assert_eq!(reason(name), "a waveform that begins anew or changes its increment");
    }
    assert!(reason("none/wf_time").starts_with("a waveform without a start time"));
    for name in ["again", "rate", "none"] {
        let column = log.columns.iter().find(|column| column.name == name).unwrap();
        assert!(bench::template::time_of(&log, column).is_none(), "{name}");
    }
}

#[test]
fn a_log_without_readable_columns_has_the_reason() {
    let bytes = std::fs::read(path("mdf-4.10.mf4")).unwrap();
    let text =
        |bytes: &[u8], from: &[u8]| bytes.windows(from.len()).position(|window| window == from).unwrap();
    // The list of records of both groups.
    let mut damaged = bytes.clone();
    while damaged.windows(4).any(|window| window == b"##DT") {
        let at = text(&damaged, b"##DT");
        damaged[at..at + 4].copy_from_slice(b"##XX");
    }
    let refused = RawLog::from_bytes("a.mf4", damaged).unwrap_err().to_string();
    assert!(refused.contains("no columns of numbers (`0/time`: a damaged block at byte"), "{refused}");
}

#[test]
fn a_channel_with_other_times_is_refused_with_both() {
    let preset = bench::PRESETS.iter().find(|(name, _)| *name == "friction-rig").unwrap().1;
    let read = |file: &str, time: &str| {
        let columns = format!(
            "t_s = \"{time}\"\nspindle_angle_rad = \"{}\"",
            if file.ends_with("mf4") { "b" } else { "same/b" }
        );
        let bench = bench::Bench::parse("x", &format!("{preset}\n[columns]\n{columns}\n")).unwrap();
        MeasuredLog::read(&path(file), &bench.log_format()).map_err(|error| error.to_string())
    };
    for (file, own, other) in
        [("two-times.mf4", "same/time#2", "same/time"), ("two-times.tdms", "same/wf_time#2", "same/wf_time")]
    {
        assert_eq!(read(file, own).map(|log| log.time_s[0]), Ok(0.5), "{file}");
        let refused = read(file, other).unwrap_err();
        let expected = format!("with the times `{own}`; expected a column with the times `{other}`");
        assert!(refused.contains(&expected), "{file}: {refused}");
    }
}

#[test]
fn a_channel_of_many_short_segments_is_read_whole() {
    let (log, expected) = (read("fragments.tdms"), read("expected.csv"));
    let (found, expected) = (columns(&log), columns(&expected));
    assert_eq!((found["angle"], found["force"]), (expected["angle"], expected["force"]));
}

#[test]
fn objects_and_sparse_arrays_of_matlab_are_no_measured_columns() {
    let log = read("classes.mat");
    assert_eq!(columns(&log).into_keys().collect::<Vec<_>>(), ["flag", "time"]);
    let others: Vec<&str> = log.others.iter().map(|other| other.name.as_str()).collect();
    assert_eq!(others, ["complex", "label", "when", "sparse"]);
}

/// Twelve levels of ten links each have 10^12 paths.
#[test]
fn groups_that_refer_to_each_other_many_times_are_refused() {
    let refused = RawLog::read(&path("half.h5")).unwrap_err().to_string();
    assert!(refused.contains("more than 100000 groups"), "{refused}");
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
    // Missing values are equal, too.
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    for (file, ..) in files() {
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
                        let whole = whole.get(name).map(|values| bits(values));
                        assert_eq!(whole, Some(bits(values)), "{file}: {name}, cut at {part} of 200");
                    }
                }
            }
        }
        assert!(refused > 20, "{file}: {refused}");
    }
}

/// Every file with changed bytes: an error or numbers, never a panic or a run without end.
#[test]
fn a_damaged_file_is_refused_or_read() {
    let mut seed = 1_u64;
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    for (file, ..) in files() {
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
