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
    let columns = ["--column", "column_1", "--column", "column_0"];
    let text = done(here, &[&["log", "convert", "a.csv", "b.csv"][..], &columns].concat());
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
            "found `angle` with the times `0/time` and `temperature` with `1/time`; expected columns with the",
        ),
        (&["none.mf4", "b.csv"], "none.mf4: "),
    ] {
        let message = refused(here, &[&["log", "convert"], arguments].concat());
        assert!(message.contains(reason), "{message}");
        assert!(!here.join("b.csv").exists() && !here.join("a.xlsx").exists(), "{message}");
    }
}
