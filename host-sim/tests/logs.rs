//! Measured logs on the command line: three formats with the same content, refusals with a remedy,
//! named faults.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use std::path::Path;
use std::process::{Command, Output};

fn host_sim(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(directory).args(arguments).output().unwrap()
}

fn done(directory: &Path, arguments: &[&str]) -> String {
    let output = host_sim(directory, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn every_format_replays_to_the_same_estimates() {
    let directory = tempfile::tempdir().unwrap();
    let estimates: Vec<Vec<u8>> = ["log.csv", "log.parquet", "log.mat"]
        .into_iter()
        .map(|log| {
            done(directory.path(), &["record", "--seed", "3", "--out", log]);
            done(directory.path(), &["replay", log, "--out", "replayed"]);
            std::fs::read(directory.path().join("replayed/estimates.csv")).unwrap()
        })
        .collect();
    assert!(estimates[0].len() > 10_000);
    assert!(estimates.windows(2).all(|pair| pair[0] == pair[1]));
    // The format is recognised by the content, not by the file name.
    std::fs::rename(directory.path().join("log.mat"), directory.path().join("renamed.csv")).unwrap();
    done(directory.path(), &["replay", "renamed.csv"]);
}

#[test]
fn a_log_that_cannot_be_read_exits_with_2_and_says_what_to_do() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(directory.path().join(name), bytes).unwrap();
    let mut empty = b"MATLAB 7.3 MAT-file".to_vec();
    empty.resize(512, b' ');
    write("empty.mat", &empty);
    done(directory.path(), &["record", "--out", "whole.parquet"]);
    let complete = std::fs::read(directory.path().join("whole.parquet")).unwrap();
    write("cut.parquet", &complete[..complete.len() / 2]);
    write("zeros.csv", &[0; 300]);
    write("foreign.csv", b"time,force\n0,1\n1,2\n");
    for (log, expected) in [
        ("empty.mat", "expected complete HDF5"),
        ("cut.parquet", "expected complete Parquet"),
        ("zeros.csv", "zeros.csv: an unknown binary file"),
        ("foreign.csv", "foreign.csv: no column `t_s` among `time`, `force`"),
    ] {
        for command in ["diagnose", "replay"] {
            let output = host_sim(directory.path(), &[command, log]);
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains(expected), "{message}");
        }
    }
}

#[test]
fn faults_of_a_log_are_named_on_the_terminal_and_in_json() {
    let directory = tempfile::tempdir().unwrap();
    done(directory.path(), &["record", "--bench", "friction-rig", "--out", "log.csv"]);
    let text = std::fs::read_to_string(directory.path().join("log.csv")).unwrap();
    let column = text.lines().next().unwrap().split(',').position(|n| n == "drive_torque_nm").unwrap();
    let faulty: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(row, line)| {
            let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            match row {
                0 => {}
                // A missing reading, and a wrong sign.
                500 => fields[column].clear(),
                _ => fields[column] = (-fields[column].parse::<f64>().unwrap()).to_string(),
            }
            fields.join(",")
        })
        .collect();
    std::fs::write(directory.path().join("log.csv"), faulty.join("\n")).unwrap();
    let arguments = ["diagnose", "log.csv", "--bench", "friction-rig"];
    let output = done(directory.path(), &arguments);
    assert!(output.contains("verdict: none"), "{output}");
    for word in
        ["wrong", "sign", "missing-values", "drive_torque_nm = { from = \"drive_torque_nm\", scale = -1.0 }"]
    {
        assert!(output.contains(word), "{word} in {output}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&done(directory.path(), &[&arguments[..], &["--json"]].concat())).unwrap();
    let first = &json["checks"][0];
    assert_eq!(
        (&first["severity"], &first["channel"], &first["kind"]),
        (&"wrong".into(), &"drive_torque_nm".into(), &"sign".into())
    );
    assert_eq!(first["done"], "changed the sign");
}
