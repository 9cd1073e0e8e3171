//! `log info` and `log convert` with files of other programs.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn host_sim(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(directory).args(arguments).output().unwrap()
}

fn done(directory: &Path, arguments: &[&str]) -> String {
    let output = host_sim(directory, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn json(directory: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&done(directory, &[arguments, &["--json"]].concat())).unwrap()
}

fn refused(directory: &Path, arguments: &[&str]) -> String {
    let output = host_sim(directory, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// File that another program wrote.
fn log(name: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../crates/bench/tests/logs");
    folder.join(name).to_string_lossy().into_owned()
}

#[test]
fn the_content_of_a_log_is_shown_with_units_ranges_and_rate() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let text = done(here, &["log", "info", &log("mdf-4.10-deflate.mf4")]);
    assert!(text.contains("MDF, 5 columns of numbers"), "{text}");
    assert!(text.contains("time: `0/time` over 0.9900 s, interval 0.01000 (100.00 per second)"), "{text}");
    let found = json(here, &["log", "info", &log("scaled.tdms")]);
    let columns = found["columns"].as_array().unwrap();
    let force = columns.iter().find(|column| column["name"] == "force").unwrap();
    assert_eq!((&force["unit"], &force["rows"], &force["missing"]), (&"N".into(), &100.into(), &0.into()));
    let texts = "texts, complex numbers or lines of a measuring card";
    assert_eq!(found["others"][0], serde_json::json!({ "name": "note", "reason": texts }));
    assert_eq!(found["time"]["not_ascending"], 0);
}

#[test]
fn a_converted_log_reads_back_with_its_values_and_units() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let columns = |name: &str| json(here, &["log", "info", name])["columns"].clone();
    let text = done(here, &["log", "convert", &log("mdf-4.10.mf4"), "a.csv"]);
    assert!(text.contains("a.csv: 100 rows of 0/time, angle, force"), "{text}");
    assert!(text.contains("left out: 1/time (10 rows), temperature (10 rows)"), "{text}");
    done(here, &["log", "convert", "a.csv", "b.parquet"]);
    done(here, &["log", "convert", "b.parquet", "c.csv"]);
    assert_eq!(std::fs::read(here.join("a.csv")).unwrap(), std::fs::read(here.join("c.csv")).unwrap());
    assert_eq!(columns("a.csv"), columns("b.parquet"));
    let picked = ["log", "convert", "b.parquet", "d.mat", "--column", "force", "--column", "angle"];
    assert_eq!(json(here, &picked)["columns"], serde_json::json!(["force", "angle"]));
    assert_eq!(columns("d.mat")[0]["max"], columns("a.csv")[2]["max"]);
}

#[test]
fn columns_of_several_rates_are_interpolated_to_one() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let text = done(here, &["log", "convert", &log("mdf-4.10.mf4"), "a.csv", "--rate", "50"]);
    // The groups end at 0.99 s and at 0.9 s.
    assert!(text.contains("a.csv: 46 rows of t_s, angle, force, temperature"), "{text}");
    let columns = json(here, &["log", "info", "a.csv"])["columns"].clone();
    assert_eq!((&columns[0]["max"], &columns[3]["max"]), (&0.9.into(), &9.0.into()));
    assert_eq!(columns[3]["unit"], "degC");
    let alone = ["log", "convert", &log("matrix.h5"), "b.csv", "--rate", "50"];
    assert!(refused(here, &alone).contains("--rate: found log(:,1) (no time in seconds)"));
    let wrong = ["log", "convert", &log("mdf-4.10.mf4"), "b.csv", "--rate", "0"];
    assert!(refused(here, &wrong).contains("found 0; expected 1e-6 to 1e7"));
}

/// The second group begins 0.5 s after the first and has half its rate, and as many rows.
#[test]
fn columns_with_other_times_are_left_out_or_get_one_time() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    for (file, second) in [("two-times.mf4", "b"), ("two-times.tdms", "same/b")] {
        let found = json(here, &["log", "convert", &log(file), "a.csv"]);
        let columns = found["columns"].as_array().unwrap();
        assert_eq!(columns.len(), 2, "{found}");
        assert!(
            !columns.contains(&second.into()) && found["left_out"].to_string().contains(second),
            "{found}"
        );
        done(here, &["log", "convert", &log(file), "b.csv", "--rate", "50"]);
        let text = std::fs::read_to_string(here.join("b.csv")).unwrap();
        let row = |line: &str| line.split(',').map(|field| field.parse().unwrap()).collect::<Vec<f64>>();
        let rows: Vec<Vec<f64>> = text.lines().skip(2).map(row).collect();
        assert_eq!(rows.len(), 25, "0.5 to 0.99 s: {text}");
        for row in rows {
            // Both columns are their time times 100.
            assert!(row.iter().take(3).all(|value| value / row[0] < 100.0 + 1e-9), "{file}: {row:?}");
            assert!((row[1] - row[2]).abs() < 1e-6, "{file}: {row:?}");
        }
    }
}

#[test]
fn a_missing_time_does_not_separate_the_columns() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("a.csv"), "t [s],x,y\n0,1,2\n,2,3\n2,3,4\n3,4,5\n").unwrap();
    let columns = ["--column", "t [s]", "--column", "x", "--column", "y"];
    let named = done(here, &[&["log", "convert", "a.csv", "b.csv"][..], &columns].concat());
    let all = done(here, &["log", "convert", "a.csv", "b.csv"]);
    assert!(named.contains("4 rows of t [s], x, y") && named == all, "{named}{all}");
}

#[test]
fn a_text_without_a_header_is_converted_by_the_numbers_of_its_columns() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("a.csv"), "0;1,5\n1;2,5\n2;3,5\n").unwrap();
    let text =
        done(here, &["log", "convert", "a.csv", "b.csv", "--column", "column_1", "--column", "column_0"]);
    assert!(text.contains("b.csv: 3 rows of column_1, column_0"), "{text}");
    assert!(std::fs::read_to_string(here.join("b.csv")).unwrap().starts_with("column_1,column_0\n"));
    let unknown = refused(here, &["log", "convert", "a.csv", "c.csv", "--column", "x"]);
    assert!(unknown.contains("expected columns among `column_0`, `column_1`"), "{unknown}");
}

#[test]
fn a_description_converts_a_log_to_its_signals_in_si() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let template = log("groups.h5");
    done(here, &["describe", &template, "--out", "bench.toml"]);
    let described = std::fs::read_to_string(here.join("bench.toml")).unwrap();
    assert!(described.contains("bench/angle") && described.contains("bench/time"), "{described}");
    let columns = "t_s = \"bench/time\"\nspindle_angle_rad = \"bench/angle\"\n\
                   drive_torque_nm = \"`bench/force` * 0.1\"\n";
    let rig = bench::PRESETS.iter().find(|(name, _)| *name == "friction-rig").unwrap().1;
    std::fs::write(here.join("rig.toml"), format!("{rig}\n[columns]\n{columns}")).unwrap();
    let text = done(here, &["log", "convert", &template, "si.csv", "--bench", "rig.toml"]);
    assert!(text.contains("si.csv: 100 rows of t_s, spindle_angle_rad, drive_torque_nm"), "{text}");
    let torque = json(here, &["log", "info", "si.csv"])["columns"][2]["max"].as_f64().unwrap();
    let force = json(here, &["log", "info", &template])["columns"][1]["max"].as_f64().unwrap();
    assert!((torque - 0.1 * force).abs() < 1e-9, "{torque} {force}");
}

#[test]
fn a_conversion_that_cannot_be_is_refused_and_writes_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::copy(log("mdf-4.10.mf4"), here.join("a.mf4")).unwrap();
    std::fs::write(here.join("a.csv"), "t,x\n0,1\n1,2\n").unwrap();
    for (arguments, reason) in [
        (&["a.mf4", "a.xlsx"][..], "OUT: found a.xlsx; expected a file .csv, .parquet or .mat"),
        (&["a.csv", "./a.csv"], "OUT: found ./a.csv, the log; expected another file"),
        (&["a.mf4", "b.csv", "--column", "x"], "--column: found `x`; expected columns among `0/time`"),
        (
            &["a.mf4", "b.csv", "--column", "angle", "--column", "temperature"],
            "found `angle` with the times `0/time` and `temperature` with `1/time`; expected columns",
        ),
        (&["none.mf4", "b.csv"], "none.mf4: "),
    ] {
        let message = refused(here, &[&["log", "convert"], arguments].concat());
        assert!(message.contains(reason), "{message}");
        assert!(!here.join("b.csv").exists() && !here.join("a.xlsx").exists(), "{message}");
    }
}
